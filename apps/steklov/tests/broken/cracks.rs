//! Mistakes in cracks.

use super::Case;

/// A block with a crack.
const CRACK: &str = r#"
[body]
corners = [[0, 0], [2, 0], [2, 2], [0, 2]]
sides = ["bottom", "right", "top", "left"]
[[body.cracks]]
points = [[0.5, 1], [1.2, 1]]
side = "flaw"
[material]
young = 1.0
poisson = 0.3
[sides.bottom]
displacement = ["0", "0"]
[sides.top]
traction = ["0", "-1"]
[[interface]]
on = "flaw"
contact = { friction = { coulomb = "0.3" } }
"#;

const fn of(
    from: &'static str,
    to: &'static str,
    line: usize,
    offending: &'static str,
    message: &'static str,
    remedy: &'static str,
) -> Case {
    Case { sound: CRACK, edit: (from, to), set: &[], line, offending, message, remedy }
}

pub const CASES: &[Case] = &[
    of("points = [[0.5, 1], [1.2, 1]]", "points = [[0.5, 1]]", 5, "", "the crack has 1 points", "at least two"),
    of("[1.2, 1]]", "[0.5, 1]]", 5, "", "or some that are one", "at least two"),
    of("[1.2, 1]]", "[1.2, nan]]", 5, "", "", "finite"),
    of("[1.2, 1]]", "[2.5, 1]]", 5, "", "the crack meets the boundary at (2, 1)", "end it there"),
    of(
        "points = [[0.5, 1], [1.2, 1]]",
        "points = [[3, 1], [4, 1]]",
        5,
        "",
        "is not inside of the body",
        "move it into the body",
    ),
    of("points = [[0.5, 1], [1.2, 1]]", "points = [[0.5, 0], [1.2, 0]]", 5, "", "is not inside of the body", "move it"),
    of("points = [[0.5, 1], [1.2, 1]]\n", "", 5, "", "points is missing", "points = "),
    of("[1.2, 1]]", "[1.2, 1], [1.2, 1.5], [0.8, 0.5]]", 5, "", "the crack meets flaw", "do not branch"),
    of("side = \"flaw\"", "side = \"top\"", 5, "", "a crack has the name \"top\"", "no other side has"),
    of("side = \"flaw\"", "side = \"fl.aw\"", 5, "", "a crack has the name \"fl.aw\"", "without dots"),
    of(
        "[material]",
        "[[body.cracks]]\npoints = [[0.8, 0.5], [0.8, 1.5]]\n[material]",
        8,
        "",
        "the crack meets flaw",
        "leave a distance",
    ),
    of("on = \"flaw\"", "on = \"flow\"", 16, "\"flow\"", "there is no crack \"flow\"", "did you mean flaw"),
    of("on = \"flaw\"", "between = [\"top\", \"bottom\"]", 15, "", "no two bodies for an interface", "on = \"CRACK\""),
    of("contact = { friction = { coulomb = \"0.3\" } }", "tied = true", 17, "true", "stands beside", "leave it out"),
    of("contact = { friction = { coulomb = \"0.3\" } }\n", "", 15, "", "contact is missing", "contact = "),
    of(
        "[[interface]]",
        "[sides.flaw]\npressure = \"1\"\n[[interface]]",
        18,
        "\"flaw\"",
        "has a pressure in [sides] too",
        "leave out one of both",
    ),
    of(
        "[[interface]]",
        "[sides.flaw]\ntraction = [\"1\", \"0\"]\n[[interface]]",
        15,
        "",
        "is a crack, and the condition is no pressure",
        "give it a pressure",
    ),
    of("[sides.top]", "[sides.tip]", 13, "tip", "the body has no side \"tip\"", "did you mean top"),
    of(
        "[material]",
        "[grid]\ncoarse = [2, 2]\n[material]",
        5,
        "",
        "cannot be solved together",
        "leave one of them out",
    ),
    of(
        "[material]",
        "[exterior]\nyoung = 1.0\npoisson = 0.3\n[material]",
        5,
        "",
        "cannot be solved together",
        "leave one of them out",
    ),
    of(
        "[[interface]]",
        "[method]\nmultiplier = \"stabilised\"\n[[interface]]",
        16,
        "\"stabilised\"",
        "biorthogonal",
        "",
    ),
];
