//! Scenes with one mistake each: an edit of a sound scene, and what must be said about it.

mod along_sides;
mod bodies;
mod cracks;
mod curves;
mod probes;

/// A sound scene.
pub const SOUND: &str = r#"title = "Sound"
[body]
corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]
sides = ["floor", "right", "top", "left"]
[material]
young = 200.0
poisson = 0.3
[parameters]
F = 0.3
[sides.floor]
contact = { gap = "0", friction = { tresca = "F" } }
[sides.top]
traction = ["0", "-1"]
[probe]
points = [[1.0, 0.5]]
[method]
tolerance = 1e-3
refine = "uniform-h"
elements = 8
"#;

/// One mistake.
pub struct Case {
    /// The sound scene.
    pub sound: &'static str,
    /// What is replaced in it, and by what.
    pub edit: (&'static str, &'static str),
    /// Overrides `KEY=VALUE`.
    pub set: &'static [&'static str],
    /// Line that the message must name (of the override if the mistake is there).
    pub line: usize,
    /// Text that the message must point at.
    pub offending: &'static str,
    /// Part of the message.
    pub message: &'static str,
    /// Part of the remedy.
    pub remedy: &'static str,
}

impl Case {
    /// The broken scene.
    pub fn scene(&self) -> String {
        let (from, to) = self.edit;
        assert!(from.is_empty() || self.sound.matches(from).count() == 1, "{from:?} is not once in the sound scene");
        if from.is_empty() { self.sound.to_owned() + to } else { self.sound.replacen(from, to, 1) }
    }
}

const fn edit(
    from: &'static str,
    to: &'static str,
    line: usize,
    offending: &'static str,
    message: &'static str,
    remedy: &'static str,
) -> Case {
    Case { sound: SOUND, edit: (from, to), set: &[], line, offending, message, remedy }
}

const fn set(
    set: &'static [&'static str],
    offending: &'static str,
    message: &'static str,
    remedy: &'static str,
) -> Case {
    Case { sound: SOUND, edit: ("", ""), set, line: 1, offending, message, remedy }
}

const CORNERS: &str = "[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]";
const NAMES: &str = "[\"floor\", \"right\", \"top\", \"left\"]";
const CONTACT: &str = "{ gap = \"0\", friction = { tresca = \"F\" } }";
const LOAD: &str = "[\"0\", \"-1\"]";

/// All mistakes.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    OF_FORM
        .iter()
        .chain(along_sides::CASES)
        .chain(curves::CASES)
        .chain(bodies::CASES)
        .chain(cracks::CASES)
        .chain(probes::CASES)
}

/// Mistakes of form, values, geometry and conditions.
const OF_FORM: &[Case] = &[
    // Syntax
    edit("young = 200.0", "young = ", 6, "", "this is not TOML", "key = value"),
    edit("[material]", "[material", 5, "", "this is not TOML", "each table header once"),
    edit("poisson = 0.3", "poisson = 0.3\npoisson = 0.2", 8, "poisson", "duplicate key", "keep one"),
    edit("refine = \"uniform-h\"", "refine = uniform-h", 18, "uniform-h", "this is not TOML", "text in quotes"),
    edit("elements = 8", "elements = 99999999999999999999", 19, "99999999999999999999", "does not fit", "1e20"),
    // Keys
    edit("[method]", "[metod]", 16, "metod", "unknown key metod", "did you mean method?"),
    edit("tolerance", "tolerence", 17, "tolerence", "unknown key method.tolerence", "did you mean tolerance?"),
    edit("young", "youngs", 6, "youngs", "unknown key material.youngs", "did you mean young?"),
    edit("gap", "gp", 11, "gp", "unknown key sides.floor.contact.gp", "did you mean gap?"),
    edit("tresca", "tresco", 11, "tresco", "unknown key sides.floor.contact.friction.tresco", "did you mean tresca?"),
    edit("[sides.top]", "[sides.roof]", 12, "roof", "no side \"roof\"", "known here: floor, right, top, left"),
    edit("[sides.top]", "[sides.tpo]", 12, "tpo", "no side \"tpo\"", "did you mean top?"),
    edit("poisson = 0.3", "", 5, "[material]", "material.poisson is missing", "add poisson = 0.3"),
    edit("young = 200.0", "", 5, "[material]", "material.young is missing", "add young = 200.0"),
    edit("points = [[1.0, 0.5]]", "", 14, "[probe]", "probe.points is missing", "add points"),
    // Types
    edit("young = 200.0", "young = true", 6, "true", "material.young is a boolean", "takes a number or an expression"),
    edit("elements = 8", "elements = \"n\"", 19, "n", "in the expression of method.elements: unknown name n", "F"),
    edit("elements = 8", "elements = \"8*F\"", 19, "\"8*F\"", "method.elements is 2.4", "must be a whole number"),
    edit("elements = 8", "elements = 8.0", 19, "8.0", "method.elements is a number", "takes a whole number"),
    edit("1e-3", "2020-01-01", 17, "2020-01-01", "method.tolerance is a date", "takes a number"),
    edit("{ tresca = \"F\" }", "\"F\"", 11, "\"F\"", "friction is a string", "{ tresca = \"0.3\" }"),
    edit(LOAD, "\"-1\"", 13, "\"-1\"", "sides.top.traction is a string", "a list in brackets"),
    edit(LOAD, "[\"0\", \"-1\", \"0\"]", 13, "[\"0\", \"-1\", \"0\"]", "has 3 entries", "one for x and one for y"),
    edit("title = \"Sound\"", "title = 5", 1, "5", "title is an integer", "a string in quotes"),
    edit(
        "[2.0, 1.0]",
        "[2.0, \"y\"]",
        3,
        "\"y\"",
        "body.corners[2][1] depends on the place",
        "the names in [parameters]",
    ),
    edit("[probe]", "[[probe]]", 14, "[[probe]]", "probe is a list", "probe takes a table"),
    // Values
    edit("1e-3", "0.0", 17, "0.0", "method.tolerance is 0", "above 0 and below 1"),
    edit("1e-3", "1.0", 17, "1.0", "method.tolerance is 1", "above 0 and below 1"),
    edit("1e-3", "nan", 17, "nan", "method.tolerance is NaN", "above 0 and below 1"),
    edit("elements = 8", "elements = 0", 19, "0", "method.elements is 0", "a whole number from 1"),
    edit("elements = 8", "degree = 65", 19, "65", "method.degree is 65", "from 1 to 64"),
    edit("elements = 8", "max_dofs = -1", 19, "-1", "method.max_dofs is -1", "from 1"),
    edit("elements = 8", "marking = 1.5", 19, "1.5", "method.marking is 1.5", "at most 1"),
    edit("elements = 8", "smoothness = 0", 19, "0", "method.smoothness is 0", "above 0"),
    edit("elements = 8", "gamma = \"big\"", 19, "\"big\"", "method.gamma is \"big\"", "\"auto\", or a number"),
    edit("elements = 8", "gamma = 1e-4", 19, "gamma", "method.gamma has no effect", "multiplier = \"stabilised\""),
    edit("elements = 8", "multiplier_mesh = \"finer\"", 19, "multiplier_mesh", "biorthogonal", "or remove it"),
    set(&["method.multiplier_degree=0"], "multiplier_degree", "method.multiplier_degree has no effect", "or remove it"),
    edit("uniform-h", "unifrom-h", 18, "\"unifrom-h\"", "not a choice", "did you mean uniform-h?"),
    edit("elements = 8", "solver = \"cg\"", 19, "\"cg\"", "not a choice", "newton, active-set, uzawa"),
    edit("young = 200.0", "young = 0", 6, "0", "Young's modulus is 0", "a positive number"),
    edit("young = 200.0", "young = -200", 6, "-200", "Young's modulus is -200", "a positive number"),
    edit("young = 200.0", "young = inf", 6, "inf", "Young's modulus is inf", "a positive number"),
    edit("young = 200.0", "young = \"200*x\"", 6, "\"200*x\"", "depends on the place", "[parameters]"),
    edit("poisson = 0.3", "poisson = 0.5", 7, "0.5", "Poisson's ratio is 0.5", "below 0.5"),
    edit("poisson = 0.3", "poisson = -1", 7, "-1", "Poisson's ratio is -1", "above -1"),
    edit("F = 0.3", "F = \"1/0\"", 9, "\"1/0\"", "the parameter F is inf", "finite"),
    edit("F = 0.3", "F = 0.3\nx = 1", 10, "x", "has a meaning of its own", "choose another name"),
    edit("F = 0.3", "F = 0.3\na-b = 1", 10, "a-b", "cannot be written in an expression", "letters, digits and _"),
    edit("[1.0, 0.5]", "[1.0, 1.5]", 15, "[1.0, 1.5]", "(1, 1.5) is not in the body", "move it into the body"),
    edit(
        "",
        "[body_force]\nvalue = [\"0\", \"-9.81*y^2\"]\n",
        21,
        "\"-9.81*y^2\"",
        "depends on the place",
        "give a force a + b*x + c*y, or add [grid] coarse = [4, 2], fine = [8, 8]",
    ),
    // Geometry
    edit(
        CORNERS,
        "[[0.0, 0.0], [0.0, 1.0], [2.0, 1.0], [2.0, 0.0]]",
        3,
        "[[0.0, 0.0], [0.0",
        "clockwise",
        "reverse the corners",
    ),
    edit(
        CORNERS,
        "[[0.0, 0.0], [2.0, 1.0], [2.0, 0.0], [0.0, 1.5]]",
        3,
        "[2.0, 0.0]",
        "cross",
        "order in which the boundary",
    ),
    edit(CORNERS, "[[0.0, 0.0], [2.0, 0.0]]", 3, "[[0.0, 0.0], [2.0, 0.0]]", "at least 3", "at least three corners"),
    edit(CORNERS, "[[0.0, 0.0], [0.0, 0.0], [2.0, 1.0], [0.0, 1.0]]", 3, "[0.0, 0.0]", "length 0", "remove one"),
    edit(CORNERS, "[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]", 3, "[[0.0", "line", "off the line"),
    edit(
        CORNERS,
        "[[0.0, 0.0], [inf, 0.0], [2.0, 1.0], [0.0, 1.0]]",
        3,
        "[inf, 0.0]",
        "must be finite",
        "finite coordinates",
    ),
    edit(
        NAMES,
        "[\"floor\", \"right\", \"top\"]",
        4,
        "[\"floor\", \"right\", \"top\"]",
        "4 corners but 3 sides",
        "side k runs",
    ),
    edit(NAMES, "[\"floor\", \"\", \"top\", \"left\"]", 4, "\"\"", "empty name", "every side a name"),
    edit(
        "",
        "[[body.holes]]\ncorners = [[5, 5], [6, 5], [6, 6]]\nsides = [\"h\", \"h\", \"h\"]\n",
        21,
        "[[5, 5]",
        "outside",
        "into the body",
    ),
    // Expressions
    edit("tresca = \"F\"", "tresca = \"2*G\"", 11, "G", "unknown name G", "define it in [parameters]"),
    edit(LOAD, "[\"0\", \"sqr(x)\"]", 13, "sqr", "unknown function sqr", "did you mean sqrt?"),
    edit(LOAD, "[\"0\", \"2x\"]", 13, "x", "sides.top.traction[1]: an operator is missing", "2*x"),
    edit(LOAD, "[\"\", \"1\"]", 13, "\"\"", "the expression is empty", "\"0\""),
    edit(LOAD, "[\"(1\", \"1\"]", 13, "\"(1\"", "\")\" is expected", "close the parenthesis"),
    // Conditions
    edit(
        LOAD,
        "[\"0\", \"-1\"]\npressure = 1",
        13,
        "[\"0\", \"-1\"]",
        "both pressure and traction",
        "remove pressure or traction",
    ),
    edit(
        CONTACT,
        "{ gap = 0 }\ntraction = [0, 0]",
        12,
        "[0, 0]",
        "both contact and traction",
        "remove contact or traction",
    ),
    edit(
        "[sides.floor]\ncontact",
        "[sides.floor]\ndisplacement = [0, 0]\ncontact",
        11,
        "[0, 0]",
        "both contact and displacement",
        "remove contact or displacement",
    ),
    edit("{ tresca = \"F\" }", "{ tresca = \"F\", coulomb = 0.2 }", 11, "0.2", "two laws of friction", "not both"),
    edit("{ tresca = \"F\" }", "{}", 11, "{}", "names no law", "leave friction out"),
    edit(LOAD, "[1, 2]\ndisplacement = [\"free\", 0]", 13, "2", "holds this component", "write \"0\""),
    edit(LOAD, "[0, 0]\ndisplacement = [0, 0]", 13, "[0, 0]", "holds both components", "remove the traction"),
    edit(
        "[sides.floor]\ncontact = { gap = \"0\", friction = { tresca = \"F\" } }\n[sides.top]\ntraction = [\"0\", \"-1\"]",
        "",
        1,
        "title",
        "nothing loads, holds or touches",
        "[sides.NAME]",
    ),
];
