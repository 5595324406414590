//! Mistakes in curves.

use super::{CORNERS, Case, NAMES, edit};

/// A line of `[body]`, what the message points at, says, and helps with.
const fn of_body(line: &'static str, offending: &'static str, message: &'static str, remedy: &'static str) -> Case {
    edit("[material]", line, 5, offending, message, remedy)
}

/// The whole outline in place of corners and sides.
const fn outline(
    text: &'static str,
    line: usize,
    offending: &'static str,
    message: &'static str,
    remedy: &'static str,
) -> Case {
    edit(OUTLINE, text, line, offending, message, remedy)
}

const OUTLINE: &str =
    "corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]\nsides = [\"floor\", \"right\", \"top\", \"left\"]";

pub const CASES: &[Case] = &[
    of_body("arcs = { right = { centre = [1, 0.4] } }\n[material]", "[1, 0.4]", "is 1.077", "both must be the radius"),
    of_body(
        "arcs = { right = { radius = 0.3 } }\n[material]",
        "0.3",
        "half the chord of its edge, 0.5",
        "a larger radius",
    ),
    of_body("arcs = { right = { radius = 0 } }\n[material]", "0", "radius is 0", "not 0"),
    of_body("arcs = { right = { radius = 1, large = 1 } }\n[material]", "1", "is an integer", "true or false"),
    of_body("arcs = { right = { bulge = nan } }\n[material]", "nan", "bulge is NaN", "finite"),
    of_body("arcs = { right = { bulge = inf } }\n[material]", "inf", "bulge is inf", "finite"),
    of_body("arcs = { right = {} }\n[material]", "{}", "has no shape", "bulge, centre, radius and through"),
    of_body(
        "arcs = { right = { bulge = 1, radius = 2 } }\n[material]",
        "{ bulge",
        "has bulge and radius",
        "give one of",
    ),
    of_body(
        "arcs = { right = { bulg = 1 } }\n[material]",
        "bulg",
        "unknown key body.arcs.right.bulg",
        "did you mean bulge?",
    ),
    of_body(
        "arcs = { roof = { bulge = 1 } }\n[material]",
        "roof",
        "names no side of this loop",
        "floor, right, top, left",
    ),
    of_body("arcs = [{ edge = 4, bulge = 1 }]\n[material]", "4", "there is no edge 4", "the edges are 0 to 3"),
    of_body("arcs = [{ bulge = 1 }]\n[material]", "{ bulge", "edge is missing", "the number of the edge"),
    of_body(
        "arcs = { 1 = { bulge = 1 }, right = { bulge = 1 } }\n[material]",
        "{ bulge",
        "is given two curves",
        "remove one",
    ),
    of_body(
        "arcs = { right = { through = [2, 0] } }\n[material]",
        "[2, 0]",
        "no arc goes through (2, 0)",
        "beside the chord",
    ),
    of_body(
        "arcs = { right = { through = [2, 3] } }\n[material]",
        "[2, 3]",
        "no arc goes through (2, 3)",
        "beside the chord",
    ),
    of_body(
        "arcs = { right = { centre = [0, 0], radii = [1, 2] } }\n[material]",
        "[1, 2]",
        "the corner (2, 0) is not on the ellipse",
        "correct radii, centre or angle",
    ),
    of_body(
        "arcs = { right = { centre = [0, 0], radii = [1, -2] } }\n[material]",
        "[1, -2]",
        "half axes are 1 and -2",
        "positive",
    ),
    of_body("curves = { top = { control = [[1, 2]] } }\n[material]", "[[1, 2]]", "control", "two"),
    of_body("curves = { top = {} }\n[material]", "{}", "control is missing", "add control = [[x, y], [x, y]]"),
    of_body("fillet = { 4 = 0.1 }\n[material]", "4", "names no corner", "the corners are 0 to 3"),
    of_body("fillet = { 1 = -0.1 }\n[material]", "-0.1", "is -0.1", "positive"),
    of_body("fillet = { 1 = 0.6, 2 = 0.6 }\n[material]", "0.6", "needs 1.", "a smaller radius"),
    edit(
        "[material]",
        "arcs = { right = { bulge = 0.1 } }\nfillet = { 1 = 0.1 }\n[material]",
        6,
        "0.1",
        "an edge at corner 1 is curved",
        "write the arc with",
    ),
    // what the numbers make
    edit(
        NAMES,
        "[\"floor\", \"right\", \"top\", \"left\"]\narcs = { right = { bulge = 1e6 } }",
        3,
        "[2.0, 0.0]",
        "opens by 359.99",
        "correct the curve",
    ),
    edit(
        NAMES,
        "[\"floor\", \"right\", \"top\", \"left\"]\narcs = { floor = { bulge = -1.2 } }",
        3,
        "[2.0, 0.0]",
        "cross at",
        "list the corners",
    ),
    edit(
        NAMES,
        "[\"floor\", \"right\", \"top\", \"left\"]\ncurves = { floor = { control = [[4, -1], [-2, -1]] } }",
        3,
        "[0.0, 0.0]",
        "crosses or touches itself",
        "correct the curve",
    ),
    edit(
        NAMES,
        "[\"floor\", \"right\", \"top\", \"left\"]\ncurves = { floor = { control = [[2, -1], [0, -1]] } }",
        3,
        "[0.0, 0.0]",
        "comes to a cusp",
        "correct the curve",
    ),
    edit(
        NAMES,
        "[\"floor\", \"right\", \"top\", \"left\"]\ncurves = { floor = { control = [[nan, -1], [0, -1]] } }",
        3,
        "[0.0, 0.0]",
        "must be finite",
        "correct the curve",
    ),
    edit(
        CORNERS,
        "[[0, 0], [2, 0]]\narcs = { floor = { bulge = 0.5 }, right = { bulge = -0.5 } }",
        3,
        "[[0, 0]",
        "has 2 corners",
        "three corners",
    ),
    outline("corners = [[0, 0], [2, 0]]\nsides = [\"floor\", \"top\"]", 3, "[[0, 0]", "has 2 corners", "three corners"),
    outline(
        "corners = [[0, 0], [2, 0]]\nsides = [\"floor\", \"top\"]\narcs = { floor = { bulge = 0.5 }, top = { bulge = -0.5 } }",
        3,
        "[2, 0]",
        "fold back",
        "a width",
    ),
    outline("circle = { centre = [0, 0], radius = 0 }\nside = \"top\"", 3, "0", "radius is 0", "positive"),
    outline(
        "circle = { centre = [0, nan], radius = 1 }\nside = \"top\"",
        3,
        "{ centre",
        "coordinates must be finite",
        "finite",
    ),
    outline(
        "circle = { centre = [0, 0], radius = 1 }",
        2,
        "[body]",
        "body.side is missing",
        "the name of the whole loop",
    ),
    outline(
        "ellipse = { centre = [0, 0], radii = [1, 0] }\nside = \"top\"",
        3,
        "[1, 0]",
        "half axes are 1 and 0",
        "positive",
    ),
    outline(
        "circle = { centre = [0, 0], radius = 1 }\nellipse = { centre = [0, 0], radii = [1, 2] }\nside = \"top\"",
        3,
        "{ centre",
        "for one loop",
        "remove one",
    ),
    edit(
        "[material]",
        "circle = { centre = [0, 0], radius = 1 }\n[material]",
        3,
        "[[0.0, 0.0]",
        "is given beside body.circle",
        "has corners or is a circle",
    ),
    edit(
        "[material]",
        "[[body.holes]]\ncircle = { centre = [1, 0.5], radius = 0.5 }\nside = \"hole\"\n[material]",
        6,
        "{ centre",
        "cross at",
        "move the hole",
    ),
    edit(
        "[material]",
        "[[body.holes]]\ncircle = { centre = [5, 0.5], radius = 0.5 }\nside = \"hole\"\n[material]",
        6,
        "{ centre",
        "outside of the outer loop",
        "into the body",
    ),
];
