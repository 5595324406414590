//! Values that are stored as words from a table.

use hdf5::Group;

use crate::error::{IoError, invalid, mismatch};
use crate::text::{load_text, save_text};

/// Writes the word of a value; [`invalid`] for a value that has none.
pub(crate) fn save_word<T: PartialEq>(
    at: &Group,
    name: &str,
    table: &[(&str, T)],
    value: &T,
    meaning: &str,
) -> Result<(), IoError> {
    let word = table.iter().find(|(_, known)| known == value);
    save_text(at, name, word.ok_or_else(|| invalid(at, name, "a value without a word"))?.0, meaning)
}

/// The value of a word.
pub(crate) fn load_word<T: Clone>(at: &Group, name: &str, table: &[(&str, T)]) -> Result<T, IoError> {
    let word = load_text(at, name)?;
    let known = table.iter().find(|(known, _)| *known == word);
    let words = || table.iter().map(|(word, _)| *word).collect::<Vec<_>>().join(", ");
    Ok(known.ok_or_else(|| mismatch(at, name, words(), &word))?.1.clone())
}
