//! Scenes with one mistake each: an edit of a sound scene, and what must be said about it.

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
    /// What is replaced in [`SOUND`], and by what.
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
        assert!(from.is_empty() || SOUND.matches(from).count() == 1, "{from:?} is not once in the sound scene");
        if from.is_empty() { SOUND.to_owned() + to } else { SOUND.replacen(from, to, 1) }
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
    Case { edit: (from, to), set: &[], line, offending, message, remedy }
}

const fn set(
    set: &'static [&'static str],
    offending: &'static str,
    message: &'static str,
    remedy: &'static str,
) -> Case {
    Case { edit: ("", ""), set, line: 1, offending, message, remedy }
}

const CORNERS: &str = "[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]";
const NAMES: &str = "[\"floor\", \"right\", \"top\", \"left\"]";
const CONTACT: &str = "{ gap = \"0\", friction = { tresca = \"F\" } }";
const LOAD: &str = "[\"0\", \"-1\"]";

/// All mistakes.
pub const CASES: &[Case] = &[
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
    edit("elements = 8", "elements = \"8\"", 19, "\"8\"", "method.elements is a string", "takes a whole number"),
    edit("elements = 8", "elements = 8.0", 19, "8.0", "method.elements is a number", "takes a whole number"),
    edit("1e-3", "2020-01-01", 17, "2020-01-01", "method.tolerance is a date", "without quotes"),
    edit("{ tresca = \"F\" }", "\"F\"", 11, "\"F\"", "friction is a string", "{ tresca = \"0.3\" }"),
    edit(LOAD, "\"-1\"", 13, "\"-1\"", "sides.top.traction is a string", "a list in brackets"),
    edit(LOAD, "[\"0\", \"-1\", \"0\"]", 13, "[\"0\", \"-1\", \"0\"]", "has 3 entries", "one for x and one for y"),
    edit("title = \"Sound\"", "title = 5", 1, "5", "title is an integer", "a string in quotes"),
    edit("[2.0, 1.0]", "[2.0, \"1\"]", 3, "\"1\"", "body.corners[2][1] is a string", "a number without quotes"),
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
        "[body_force]\nvalue = [\"0\", \"-9.81*y\"]\n",
        21,
        "\"-9.81*y\"",
        "depends on the place",
        "give one constant force, or add [grid] coarse = [4, 2], fine = [8, 8]",
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
    // Data along the sides
    edit(
        "gap = \"0\"",
        "gap = inf",
        11,
        "inf",
        "the gap of side \"floor\" is inf at the point (0, 0)",
        "finite distance",
    ),
    edit(
        "gap = \"0\"",
        "gap = \"1e200\"",
        11,
        "\"1e200\"",
        "the gap of side \"floor\" is 1e200 at the point (0, 0)",
        "too large for a body of diameter 2.23606797749979: more than 1e12 times",
    ),
    edit("gap = \"0\"", "gap = -3e12", 11, "-3e12", "the gap of side \"floor\" is -3e12", "too large for a body"),
    edit("gap = \"0\"", "gap = \"log(-1)\"", 11, "\"log(-1)\"", "the gap of side \"floor\" is NaN", "finite distance"),
    edit("tresca = \"F\"", "tresca = -0.1", 11, "-0.1", "the friction bound of side \"floor\" is -0.1", "max(0, ...)"),
    edit("tresca = \"F\"", "tresca = \"1.999-x\"", 11, "\"1.999-x\"", "at the point (2, 0), s = 1", "max(0, ...)"),
    edit("tresca = \"F\"", "coulomb = -1", 11, "-1", "the friction coefficient of side \"floor\" is -1", "max(0, ...)"),
    edit(
        LOAD,
        "[\"0\", \"1/(x-1)\"]",
        13,
        "\"1/(x-1)\"",
        "the traction of side \"top\" is inf at the point (1, 1), s = 0.5",
        "finite everywhere",
    ),
    edit(
        LOAD,
        "[\"0\", \"log(abs(x-0.5))\"]",
        13,
        "\"log(abs(x-0.5))\"",
        "the traction of side \"top\" is -inf",
        "finite everywhere",
    ),
    edit(
        "traction = [\"0\", \"-1\"]",
        "pressure = \"sqrt(1-x)\"",
        13,
        "\"sqrt(1-x)\"",
        "the pressure of side \"top\" is NaN",
        "finite everywhere",
    ),
    edit(
        "traction = [\"0\", \"-1\"]",
        "displacement = [\"free\", \"1/y^2/0\"]",
        13,
        "\"1/y^2/0\"",
        "the displacement of side \"top\" is inf",
        "finite everywhere",
    ),
    edit(
        "traction = [\"0\", \"-1\"]",
        "displacement = [\"sign(x-0.31)\", 0]",
        13,
        "\"sign(x-0.31)\"",
        "the displacement of side \"top\" jumps from 1 to -1 at the point (0.31",
        "a continuous displacement",
    ),
    // Expectations
    edit("", "[expect]\nenergy = 5\n", 21, "5", "expect.energy is an integer", "takes a table"),
    edit("", "[expect]\nenergy = { value = 5 }\n", 21, "{ value = 5 }", "expect.energy.tol is missing", "add tol"),
    // Overrides
    set(&["method.tolerence=1e-6"], "tolerence", "unknown key method.tolerence", "did you mean tolerance?"),
    set(&["method.refine=none"], "none", "this is not TOML", "text needs quotes"),
    set(&["method.tolerance"], "method.tolerance", "not of the form KEY=VALUE", "--set method.tolerance=1e-6"),
    set(&["method.tolerance.x=1"], "x", "method.tolerance is a number and has no key x", "set method.tolerance itself"),
    set(&["body.corners.7=[1,1]"], "7", "body.corners is a list of 4 entries and has no entry 7", "from 0 to 3"),
    set(&["method.elements=4", "method.elements=\"x\""], "\"x\"", "method.elements is a string", "a whole number"),
    // A key at a wrong place is told where it belongs.
    set(&["tolerance=1e-6"], "tolerance", "unknown key tolerance", "did you mean method.tolerance?"),
    set(&["tolerence=1e-6"], "tolerence", "unknown key tolerence", "did you mean method.tolerance?"),
    set(&["young=2"], "young", "unknown key young", "did you mean material.young?"),
    set(&["F=2"], "F", "unknown key F", "did you mean parameters.F?"),
    set(&["top.pressure=2"], "top", "unknown key top", "did you mean sides.top?"),
    set(&["gap=\"0\""], "gap", "unknown key gap", "did you mean sides.NAME.contact.gap?"),
    set(&["samples=9"], "samples", "unknown key samples", "did you mean stochastic.samples?"),
    set(&["method.fine=[2, 2]"], "fine", "unknown key method.fine", "did you mean grid.fine?"),
    set(
        &["sides.floor.contact={ tresca = 1 }"],
        "tresca",
        "unknown key",
        "did you mean sides.NAME.contact.friction.tresca?",
    ),
    // Overrides that nothing uses.
    set(&["parameters.f=0.2"], "f", "parameters.f has no effect: no expression uses f", "did you mean parameters.F?"),
    set(&["parameters.load=7"], "load", "parameters.load has no effect", "used are F"),
    set(&["parameters={ F = 0.2, load = 7 }"], "load", "parameters.load has no effect", "used are F"),
    set(
        &["sides.floor.contact={ gap = 0 }", "parameters.F=0.2"],
        "F",
        "parameters.F has no effect",
        "set the key itself",
    ),
    set(&["parameters={ F = 1, q = 7, r = \"2*q\" }"], "q", "parameters.q has no effect", "used are F"),
    set(&["stochastic.degree=5"], "stochastic", "nothing in the scene is random", "[random]"),
    set(
        &["random.xi={ distribution = \"uniform\", low = 0, high = 1 }"],
        "xi",
        "random.xi has no effect: no expression uses xi",
        "set the key itself",
    ),
    set(&["material.poisson=0.5"], "0.5", "Poisson's ratio is 0.5", "below 0.5"),
    // The full language is known, also where it is not yet available
    edit("elements = 8", "model = \"fem-bem\"", 19, "\"fem-bem\"", "no medium around the body", "[exterior]"),
    edit(
        "",
        "[random.xi]\ndistribution = \"lognormal\"\nmean = 0\ndeviation = 1\n",
        22,
        "0",
        "random.xi.mean is 0",
        "positive",
    ),
    edit(
        "",
        "[random.xi]\ndistribution = \"uniform\"\nlow = 1\nhigh = -1\n",
        23,
        "-1",
        "random.xi.high is not above low",
        "smaller than high",
    ),
    edit("", "[random.F]\ndistribution = \"uniform\"\nlow = 1\nhigh = 2\n", 20, "F", "a parameter as well", "rename"),
    edit(
        "",
        "[random.xi]\ndistribution = \"normal\"\nmean = 1\ndeviaton = 2\n",
        23,
        "deviaton",
        "unknown key",
        "did you mean deviation?",
    ),
    edit(
        "",
        "[random.r]\ncovariance = \"gaussian\"\ncorrelation = 0.3\non = \"flor\"\n",
        23,
        "\"flor\"",
        "no side \"flor\"",
        "did you mean floor?",
    ),
    Case {
        edit: (
            "sides = [\"floor\", \"right\", \"top\", \"left\"]",
            "sides = [\"floor\", \"right\", \"floor\", \"left\"]\n[random.r]\ncovariance = \"gaussian\"\ncorrelation = 0.3\non = \"floor\"",
        ),
        set: &[],
        line: 8,
        offending: "\"floor\"",
        message: "the side consists of 2 parts that do not meet",
        remedy: "sides of their own",
    },
    Case {
        edit: (
            "sides = [\"floor\", \"right\", \"top\", \"left\"]",
            "sides = [\"floor\", \"floor\", \"floor\", \"floor\"]\n[random.r]\ncovariance = \"gaussian\"\ncorrelation = 0.3\non = \"floor\"",
        ),
        set: &[],
        line: 8,
        offending: "\"floor\"",
        message: "the side is a closed loop",
        remedy: "sides of their own",
    },
    edit(
        "",
        "[stochastic]\nmethod = \"galerkn\"\n",
        21,
        "\"galerkn\"",
        "which is not a choice",
        "did you mean galerkin?",
    ),
    edit("", "[stochastic]\nsamples = 1\n", 21, "1", "stochastic.samples is 1", "from 2"),
    edit("", "[stochastic]\nquantiles = [0.5, 2]\n", 21, "2", "stochastic.quantiles[1] is 2", "below 1"),
    edit("elements = 8", "model = \"fem\"", 19, "\"fem\"", "finite elements need a [grid]", "[grid] coarse = [4, 2]"),
    edit("", "[grid]\ncoarse = [12, 2]\n", 20, "[grid]", "grid.fine is missing", "fine = [cells along x"),
    edit("", "[grid]\ncoarse = [12, 2]\nfine = 16\n", 22, "16", "grid.fine is an integer", "a list in brackets"),
    edit("", "[grid]\ncoarse = [-1, 2]\nfine = [1, 1]\n", 21, "-1", "grid.coarse[0] is -1", "from 1 to 67108864"),
    edit(
        "",
        "[grid]\ncoarse = [12, 2]\nfine = [1, 1]\nbasis = \"cupled\"\n",
        23,
        "\"cupled\"",
        "not a choice",
        "did you mean coupled?",
    ),
    edit(
        "",
        "[grid]\ncoarse = [8192, 8192]\nfine = [2, 1]\n",
        22,
        "[2, 1]",
        "8192 by 8192 coarse cells of 2 by 1 fine ones, 134217728 in all",
        "67108864 at most",
    ),
    edit(
        "",
        "[grid]\ncoarse = [67108864, 67108864]\nfine = [1, 1]\n",
        21,
        "[67108864, 67108864]",
        "4503599627370496 in all",
        "67108864 at most",
    ),
    edit("", "[grid]\ncoarse = [12, 2]\nfine = [16, 0]\n", 22, "0", "grid.fine[1] is 0", "from 1"),
    edit(
        "young = 200.0",
        "cells = { size = 0.25, young = { uniform = [2, 3], seed = 1 } }",
        6,
        "{ size",
        "differs from cell to cell needs a [grid]",
        "add [grid] coarse = [4, 2], fine = [2, 2]",
    ),
    edit("young = 200.0", "cells = { size = 0, young = 2 }", 6, "0", "material.cells.size is 0", "a positive length"),
    edit("young = 200.0", "cells = { young = 2 }", 6, "{ young = 2 }", "material.cells.size is missing", "add size"),
    edit("young = 200.0", "cells = { size = 1 }", 6, "{ size = 1 }", "material.cells.young is missing", "add young"),
    edit(
        "young = 200.0",
        "young = 200.0\ncells = { size = 1, young = 2 }",
        6,
        "200.0",
        "material.young stands beside material.cells",
        "remove one",
    ),
    edit(
        "young = 200.0",
        "cells = { size = 1, young = { file = \"a.h5\" } }",
        6,
        "{ file",
        "material.cells.young.dataset is missing",
        "dataset = \"/young\"",
    ),
    edit(
        "young = 200.0",
        "cells = { size = 1, young = { uniform = [2, 3], dataset = \"/young\" } }",
        6,
        "\"/young\"",
        "dataset stands without file",
        "remove it, or add file",
    ),
    edit(
        "young = 200.0",
        "cells = { size = 1, young = { file = \"a.h5\", dataset = \"a\", seed = 3 } }",
        6,
        "3",
        "seed stands without uniform",
        "remove it, or add uniform",
    ),
    edit("young = 200.0", "cells = { size = 1, young = \"2+s\" }", 6, "\"2+s\"", "young uses s", "use x and y"),
    Case {
        edit: ("young = 200.0", "cells = { size = 0.25, young = \"2+x\" }"),
        set: &["method.model=\"bem\""],
        line: 1,
        offending: "\"bem\"",
        message: "boundary elements need one material",
        remedy: "model = \"auto\" with a [grid]",
    },
    edit(
        "",
        "[body_force]\nvalue = [\"x\", \"s\"]\n",
        21,
        "\"s\"",
        "body_force.value[1] uses s",
        "inside of the body use x and y",
    ),
    edit(
        "",
        "[body_force]\nvalue = [\"0\", \"1/0\"]\n[grid]\ncoarse = [4, 2]\nfine = [1, 1]\n",
        21,
        "\"1/0\"",
        "body_force.value[1] is inf",
        "it must be finite",
    ),
    Case {
        edit: ("", "[body_force]\nvalue = [\"0\", \"-y\"]\n[grid]\ncoarse = [4, 2]\nfine = [1, 1]\n"),
        set: &["body_force.value.0=\"x\"", "method.model=\"bem\"", "body_force.value.0=\"y\""],
        line: 1,
        offending: "\"y\"",
        message: "body_force.value[0] depends on the place: \"y\"; with boundary elements it cannot",
        remedy: "model = \"auto\" with a [grid]",
    },
    edit(
        "young = 200.0",
        "cells = { size = 0.1, young = { uniform = [3, 2] } }",
        6,
        "[3, 2]",
        "is [3, 2]",
        "lower one first",
    ),
    edit("", "[exterior]\nyoung = 50\npoisson = 0.3\n", 10, "[sides.floor]", "meets the medium", "remove it"),
    edit("", "[exterior]\nyoung = 50\npoisson = 0.5\n", 22, "0.5", "Poisson's ratio is 0.5", "below 0.5"),
];
