//! How other languages write what expressions write otherwise.

use super::ExpressionError;

/// Spellings, their fault, and what to write: the text with another spelling in their place, or an example.
type Spelling = (&'static [&'static str], &'static str, Instead);

enum Instead {
    With(&'static str),
    Example(&'static str),
}

use Instead::{Example, With};

/// The likelier ones first: a text may have several.
const SPELLINGS: [Spelling; 10] = [
    (&["**"], "powers are written with ^", With("^")),
    (&["²"], "powers are written with ^", With("^2")),
    (&["np.", "numpy.", "math.", "Math."], "functions and pi stand alone", With("")),
    (&["else", "?"], "a choice is a function", Example("if(y > 0.5, 1, 0) is 1 where y > 0.5, and 0 elsewhere")),
    (&["and", "&&"], "both of two conditions are their product", Example("write a < x and x < b as (a < x)*(x < b)")),
    (&["or", "||"], "one of two conditions is the larger one", Example("write x < a or b < x as max(x < a, b < x)")),
    (&["not"], "the opposite of a condition is a choice", Example("write not x < a as if(x < a, 0, 1)")),
    (&["−", "–"], "this is a long minus", With("-")),
    (&["·", "×"], "products are written with *", With("*")),
    (
        &[".h5", ".hdf5", ".npy", ".csv", ".txt", ".png"],
        "a file is no expression",
        Example(
            "the moduli of cells are read from one by a table: young = { file = \"young.h5\", dataset = \"/young\" }",
        ),
    ),
];

/// Units that stand after a number.
const UNITS: [&str; 18] = [
    "Pa", "kPa", "MPa", "GPa", "psi", "ksi", "N", "kN", "MN", "m", "mm", "cm", "um", "km", "deg", "degrees", "kg", "in",
];

/// The error of a text that cannot be read, with what to write where it has a foreign spelling.
pub(super) fn translated(text: &str, error: ExpressionError) -> ExpressionError {
    let found = SPELLINGS.iter().find_map(|(spellings, wrong, instead)| {
        let (at, spelling) = spellings.iter().find_map(|s| find(text, s).map(|at| (at, *s)))?;
        let help = match instead {
            With(other) => format!("write {}", text.replace(spelling, other)),
            Example(example) => (*example).to_owned(),
        };
        Some(ExpressionError {
            message: format!("{spelling} is not known: {wrong}"),
            span: at..at + spelling.len(),
            help,
        })
    });
    found.unwrap_or_else(|| without_unit(text, &error).unwrap_or(error))
}

/// Where a spelling begins in a text; a word with none of its letters beside it.
fn find(text: &str, spelling: &str) -> Option<usize> {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let starts_word = spelling.starts_with(|c: char| c.is_ascii_alphabetic());
    let ends_word = spelling.ends_with(is_part) && starts_word;
    text.match_indices(spelling).map(|(at, _)| at).find(|at| {
        let (before, after) = (text[..*at].chars().next_back(), text[at + spelling.len()..].chars().next());
        !(starts_word && before.is_some_and(is_part) || ends_word && after.is_some_and(is_part))
    })
}

/// The error of a unit after a number.
fn without_unit(text: &str, error: &ExpressionError) -> Option<ExpressionError> {
    let unit = text.get(error.span.clone()).filter(|word| UNITS.contains(word))?;
    let number = text[..error.span.start].trim_end();
    number.ends_with(|c: char| c.is_ascii_digit() || c == '.').then(|| ExpressionError {
        message: format!("numbers have no unit, and {unit} is one"),
        span: error.span.clone(),
        help: format!(
            "write the number alone, {number}, in the units that lengths, forces and stresses of the whole scene have"
        ),
    })
}
