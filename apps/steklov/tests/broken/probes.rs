//! Mistakes in the lines and sides of `[probe]`.

use super::{Case, SOUND, edit};

const POINTS: &str = "points = [[1.0, 0.5]]";

const fn line(to: &'static str, offending: &'static str, message: &'static str, remedy: &'static str) -> Case {
    Case { sound: SOUND, edit: (POINTS, to), set: &[], line: 15, offending, message, remedy }
}

pub const CASES: &[Case] = &[
    line("lines = [{ from = [0, 0], to = [1, 1], points = 1 }]", "1", "probe.lines[0].points is 1", "from 2 to 10000"),
    line("lines = [{ from = [0, 0], to = [1, 1], points = 10001 }]", "10001", "points is 10001", "from 2 to 10000"),
    line("lines = [{ from = [0, 0], to = [1, 1], points = 2.5 }]", "2.5", "points is a number", "a whole number"),
    line("lines = [{ from = [0, 0] }]", "{ from", "probe.lines[0].to is missing", "add to = [x, y]"),
    line("lines = [{ to = [1, 1] }]", "{ to", "probe.lines[0].from is missing", "add from = [x, y]"),
    line("lines = [{ from = [0, 0], to = [1, 1, 1] }]", "[1, 1, 1]", "lines[0].to has 3 entries", "one for x"),
    line(
        "lines = [{ from = [0, 0], to = [1, 1], pionts = 5 }]",
        "pionts",
        "unknown key probe.lines[0].pionts",
        "did you mean points?",
    ),
    line("lines = { from = [0, 0], to = [1, 1] }", "{ from", "probe.lines is a table", "[[probe.lines]]"),
    line("lines = [{ from = [0, nan], to = [1, 1] }]", "{ from", "from (0, NaN) to (1, 1)", "finite coordinates"),
    line("lines = [{ from = [0, 0], to = [1, inf] }]", "{ from", "to (1, inf)", "finite coordinates"),
    line("lines = [{ from = [-1.5e308, 0], to = [1.5e308, 0] }]", "{ from", "the line runs from", "finite coordinates"),
    line("lines = [{ from = [1, 1], to = [1, 1] }]", "{ from", "from (1, 1) has no length", "in probe.points"),
    line(
        "lines = [{ from = [0, 0], to = [1, 1] }, { from = [0, 1.5], to = [2, 1.5] }]",
        "{ from = [0, 1.5]",
        "none of the 101 points of the line from (0, 1.5) to (2, 1.5) is in a body",
        "move it into a body",
    ),
    line("sides = [\"floor\", \"rigth\"]", "\"rigth\"", "there is no side \"rigth\"", "did you mean right?"),
    line("sides = [\"floor\", \"top\", \"floor\"]", "\"floor\"", "the side \"floor\" is named twice", "name it once"),
    line("sides = \"floor\"", "\"floor\"", "probe.sides is a string", "a list in brackets"),
    line("sides = [1]", "1", "probe.sides[0] is an integer", "a string in quotes"),
    edit("[probe]", "[probe]\nline = []", 15, "line", "unknown key probe.line", "did you mean lines?"),
];
