//! Mistakes in several bodies and what acts between them.

use super::Case;

/// Two blocks, one on the other.
const BODIES: &str = r#"
[[body]]
name = "upper"
corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
material = { young = 1.0, poisson = 0.3 }
[[body]]
name = "lower"
corners = [[0, -1], [2, -1], [2, 0], [0, 0]]
sides = ["bottom", "right", "top", "left"]
material = { young = 2.0, poisson = 0.2 }
[sides.lower.bottom]
displacement = ["0", "0"]
[sides.upper.top]
traction = ["0", "-1"]
[[interface]]
between = ["upper.bottom", "lower.top"]
contact = true
"#;

const fn of(
    from: &'static str,
    to: &'static str,
    line: usize,
    offending: &'static str,
    message: &'static str,
    remedy: &'static str,
) -> Case {
    Case { sound: BODIES, edit: (from, to), set: &[], line, offending, message, remedy }
}

pub const CASES: &[Case] = &[
    of("name = \"upper\"\n", "", 2, "[[body]]", "body[0].name is missing", "add name"),
    of("name = \"lower\"", "name = \"upper\"", 8, "\"upper\"", "two bodies have the name \"upper\"", "its own name"),
    of("name = \"lower\"", "name = \"low.er\"", 8, "\"low.er\"", "body[1].name is \"low.er\"", "no dots"),
    of("name = \"lower\"", "name = \"\"", 8, "\"\"", "body[1].name is \"\"", "not empty"),
    of("name = \"lower\"", "nam = \"lower\"", 8, "nam", "unknown key body[1].nam", "did you mean"),
    of(
        "between = [\"upper.bottom\", \"lower.top\"]",
        "between = [\"uper.bottom\", \"lower.top\"]",
        17,
        "\"uper.bottom\"",
        "there is no side \"uper.bottom\"",
        "did you mean upper.bottom",
    ),
    of(
        "between = [\"upper.bottom\", \"lower.top\"]",
        "between = [\"bottom\", \"lower.top\"]",
        17,
        "\"bottom\"",
        "there is no side \"bottom\"",
        "",
    ),
    of(
        "between = [\"upper.bottom\", \"lower.top\"]",
        "between = [\"upper.bottom\"]",
        17,
        "[\"upper.bottom\"]",
        "has 1 entry",
        "one for each of the two bodies that meet",
    ),
    of(
        "between = [\"upper.bottom\", \"lower.top\"]",
        "between = [\"upper.bottom\", []]",
        17,
        "[]",
        "names no side",
        "BODY.SIDE",
    ),
    of(
        "between = [\"upper.bottom\", \"lower.top\"]",
        "between = [\"upper.bottom\", \"upper.left\"]",
        17,
        "[\"upper",
        "are sides of one body, \"upper\"",
        "between two bodies",
    ),
    of(
        "between = [\"upper.bottom\", \"lower.top\"]",
        "between = [\"upper.bottom\", [\"lower.top\", \"lower.top\"]]",
        17,
        "\"lower.top\"",
        "the side \"lower.top\" is in two conditions",
        "name it once",
    ),
    of(
        "between = [\"upper.bottom\", \"lower.top\"]",
        "between = [\"upper.bottom\", \"lower.bottom\"]",
        17,
        "\"lower.bottom\"",
        "has a condition in [sides] too",
        "divide the side",
    ),
    of(
        "between = [\"upper.bottom\", \"lower.top\"]",
        "between = [\"upper.left\", \"lower.right\"]",
        17,
        "[\"upper.left\"",
        "do not face each other",
        "name the sides that meet",
    ),
    of(
        "between = [\"upper.bottom\", \"lower.top\"]",
        "between = [\"upper.right\", \"lower.top\"]",
        17,
        "[\"upper.right\"",
        "do not face each other",
        "name the sides that meet",
    ),
    of("contact = true", "", 16, "[[interface]]", "the interface has no law", "add tied = true"),
    of(
        "contact = true",
        "contact = true\ntied = true",
        19,
        "true",
        "either in contact or tied",
        "remove contact or tied",
    ),
    of("contact = true", "contact = false", 18, "false", "interface[0].contact is", "takes a table"),
    of("contact = true", "tied = false", 18, "false", "interface[0].tied is", "true, or a table"),
    of(
        "contact = true",
        "contact = { gap = \"0\", friction = { coulomb = \"-0.1\" } }",
        18,
        "\"-0.1\"",
        "friction coefficient",
        "friction cannot be negative",
    ),
    of("contact = true", "contact = { gap = \"1/x\" }", 18, "\"1/x\"", "the gap of side", "finite distance"),
    of("contact = true", "contact = { slip = \"1/x\" }", 18, "slip", "unknown key interface[0].contact.slip", ""),
    of(
        "contact = true",
        "tied = { displacement_jump = [\"1/x\", \"0\"] }",
        18,
        "\"1/x\"",
        "the displacement jump of side",
        "finite",
    ),
    of(
        "contact = true",
        "tied = { jump = [\"1\", \"0\"] }",
        18,
        "jump",
        "unknown key interface[0].tied.jump",
        "displacement_jump",
    ),
    of(
        "contact = true",
        "contact = true\nmultiplier = \"upper.top\"",
        19,
        "\"upper.top\"",
        "which is no side of the interface",
        "one of the two sides",
    ),
    of(
        "contact = true",
        "tied = { displacement_jump = [\"1\", \"0\"] }\nmultiplier = \"lower.top\"",
        17,
        "[\"upper",
        "the second place of upper.bottom-lower.top cannot carry",
        "leave multiplier out",
    ),
    of(
        "contact = true",
        "contact = true\non = \"upper.crack\"",
        17,
        "[\"upper.bottom",
        "between stands beside interface[0].on",
        "leave it out",
    ),
    of(
        "contact = true",
        "contact = true\n[[interface]]\nbetween = [\"upper.bottom\", \"lower.right\"]\ntied = true",
        20,
        "\"upper.bottom\"",
        "is in two conditions",
        "name it once",
    ),
    of(
        "corners = [[0, 0], [1, 0], [1, 1], [0, 1]]",
        "corners = [[0, -0.05], [1, -0.05], [1, 1], [0, 1]]",
        2,
        "",
        "lies 0.05 deep in body",
        "negative contact.gap, here gap = \"-0.05\"",
    ),
    of(
        "contact = true",
        "tied = true\n[[body]]\nname = \"third\"\ncorners = [[3, 0], [4, 0], [4, 1], [3, 1]]\nsides = [\"a\", \"b\", \"c\", \"d\"]\n\
         material = { young = 1.0, poisson = 0.3 }\n[[interface]]\nbetween = [\"third.a\", \"lower.right\"]\ntied = true",
        25,
        "[\"third",
        "are tied but 1e0 apart",
        "displacement_jump",
    ),
    of(
        "material = { young = 2.0, poisson = 0.2 }",
        "material = { young = 2.0, poisson = 0.2, plane = \"stress\" }",
        7,
        "",
        "in plane strain, \"lower\" in plane stress",
        "all in plane strain",
    ),
    of("material = { young = 2.0, poisson = 0.2 }\n", "", 2, "", "material is missing", "in each [[body]]"),
    of(
        "material = { young = 2.0, poisson = 0.2 }",
        "material = { young = 2.0, poisson = 0.2 }\ngrid = { coarse = [2, 2] }",
        12,
        "{ coarse",
        "cannot be solved among several bodies",
        "leave it out",
    ),
    of("[sides.lower.bottom]", "[sides.lowr.bottom]", 12, "lowr", "there is no body \"lowr\"", "did you mean lower"),
    of("[sides.lower.bottom]", "[sides.lower.botom]", 12, "botom", "has no side \"botom\"", "did you mean bottom"),
    of(
        "[[interface]]",
        "[body_force]\nvalue = [\"0\", \"-x*y\"]\n[[interface]]",
        17,
        "\"-x*y\"",
        "depends on the place",
        "among several bodies none is on a grid",
    ),
    of(
        "[[interface]]",
        "[exterior]\nyoung = 1.0\npoisson = 0.3\n[[interface]]",
        16,
        "[exterior]",
        "and several bodies cannot be solved together",
        "medium = {}",
    ),
    of(
        "material = { young = 2.0, poisson = 0.2 }",
        "material = { young = 2.0, poisson = 0.2 }\nmedium = {}",
        9,
        "[[0, -1]",
        "a medium is the whole plane but for its holes",
        "[[body.holes]]",
    ),
    of(
        "[sides.lower.bottom]",
        "[[body]]\nname = \"rock\"\nmaterial = { young = 2.0, poisson = 0.2 }\nmedium = {}\n[sides.lower.bottom]",
        12,
        "",
        "holes is missing",
        "[[body.holes]]",
    ),
    of(
        "[sides.lower.bottom]",
        "[[body]]\nname = \"rock\"\nmaterial = { young = 2.0, poisson = 0.2 }\nmedium = { remote = [0, 0, 0] }\n[sides.lower.bottom]",
        15,
        "remote",
        "body[2].medium.remote",
        "remote_stress",
    ),
    of(
        "[sides.lower.bottom]",
        "[[body]]\nname = \"rock\"\nmaterial = { young = 2.0, poisson = 0.2 }\nmedium = {}\nbody_force = [\"0\", \"1\"]\n\
         [[body.holes]]\ncircle = { centre = [0, 0], radius = 9 }\nside = \"wall\"\n[sides.lower.bottom]",
        16,
        "[\"0\", \"1\"]",
        "an unbounded medium cannot carry a body force",
        "medium.remote_stress",
    ),
    of(
        "[sides.lower.bottom]",
        "[[body]]\nname = \"a\"\nmaterial = { young = 2.0, poisson = 0.2 }\nmedium = {}\n\
         [[body.holes]]\ncircle = { centre = [0, 0], radius = 9 }\nside = \"wall\"\n\
         [[body]]\nname = \"b\"\nmaterial = { young = 2.0, poisson = 0.2 }\nmedium = {}\n\
         [[body.holes]]\ncircle = { centre = [0, 0], radius = 9 }\nside = \"wall\"\n[sides.lower.bottom]",
        20,
        "",
        "are both media",
        "a bounded body",
    ),
    of(
        "[sides.lower.bottom]",
        "[[body]]\nname = \"rock\"\nmaterial = { young = 2.0, poisson = 0.2 }\nmedium = {}\n\
         [[body.holes]]\ncircle = { centre = [0.5, 0.5], radius = 1 }\nside = \"wall\"\n[sides.lower.bottom]",
        2,
        "",
        "deep in body",
        "draw bodies that touch",
    ),
    of(
        "[[interface]]",
        "[method]\nmultiplier = \"stabilised\"\n[[interface]]",
        17,
        "\"stabilised\"",
        "several bodies have biorthogonal multipliers only",
        "leave it",
    ),
    of(
        "[[interface]]",
        "[method]\nindicator = \"residual\"\n[[interface]]",
        17,
        "\"residual\"",
        "no residual indicator",
        "leave it",
    ),
    of(
        "[[interface]]",
        "[method]\nmodel = \"fem\"\n[[interface]]",
        17,
        "\"fem\"",
        "solved by boundary elements",
        "leave it",
    ),
];
