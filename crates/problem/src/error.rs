//! What is wrong with the data of a problem: said without a document, by keys that a document can find.

use steklov_expression::{Expression, Place};

/// Sorts of errors of data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DataErrorKind {
    /// A value of the right type that is impossible.
    Value,
    /// A datum that must be there.
    Missing,
    /// A name that nothing has.
    Unknown,
    /// Two entries exclude each other.
    Conflict,
    /// The loops do not bound a body.
    Geometry,
    /// A datum has an impossible value at a point of its side or of the body.
    Data,
    /// Neither supports nor contact hold the body.
    Unsupported,
}

/// The subject of an error.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum About {
    /// A part of a text from which an expression or a value was read.
    Text(Place),
    /// The first of these paths of keys that the document has, such as `sides.floor.contact`.
    Keys(Vec<Vec<String>>),
}

/// An error of data.
#[derive(Debug, Clone, thiserror::Error)]
#[error("{message}")]
pub struct DataError {
    /// Sort of the error.
    pub kind: DataErrorKind,
    /// What is wrong.
    pub message: String,
    /// What to change.
    pub help: String,
    /// Its subject.
    pub about: About,
}

impl DataError {
    /// An error about a part of a text.
    pub fn new(kind: DataErrorKind, place: Place, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { kind, message: message.into(), help: help.into(), about: About::Text(place) }
    }

    /// An error about the value of the first of these keys that is given.
    pub fn at(kind: DataErrorKind, keys: &[Vec<&str>], message: impl Into<String>, help: impl Into<String>) -> Self {
        let keys = keys.iter().map(|path| path.iter().map(|&key| key.to_owned()).collect()).collect();
        Self { kind, message: message.into(), help: help.into(), about: About::Keys(keys) }
    }

    /// An error that the numerics find in the values of an expression.
    pub fn of_values(expression: &Expression, message: &str) -> Self {
        let message = format!("{message}: expression {:?}", expression.text());
        let help = "write jumps and kinks with abs, sign, min, max or if, and keep the values bounded";
        Self::new(DataErrorKind::Data, expression.place, message, help)
    }
}
