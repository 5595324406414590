//! Data of boundary value problems as expressions of the place: `0.3*sign(x)*exp(-10*(y+0.3)^2)`, and random fields in them.
//!
//! An [`Expression`] is read once into a flat tape and evaluated in about 0.1 µs. It knows where it is not smooth:
//! [`Expression::kinks`] finds the places along an element at which integrals of it must be split.
//!
//! ```
//! let parameters = [("F".to_owned(), 2.0)].into();
//! let load = steklov_expression::Expression::parse("-F^2 + abs(x)", &parameters)?;
//! assert_eq!(load.eval(-1.0, 0.0, 0.5), -3.0);
//! assert_eq!(load.kinks(|t| (t - 0.25, 0.0, (1.0 + t) / 2.0)), [0.25]);
//! # Ok::<(), steklov_expression::ExpressionError>(())
//! ```

mod token;
mod operation;
mod tape;
mod foreign;
mod parse;
mod fold;
mod profile;
mod interval;
mod affine;
mod range;
mod kinks;
mod survey;
mod along;
mod field;

// the crates whose types appear in the interface
pub use {steklov_bem_operators, steklov_stochastic};

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

pub use along::{Along, OnEdge};
pub use field::{FieldValue, NoChain, RandomField, Support};
pub use fold::Value;
pub use interval::Interval;
pub use parse::nearest;
pub use profile::{MOST_KNOTS, Profile, ProfileError};
pub use range::{Enclosed, Leaves, Range as Enclosure, Track, enclose, leaves};
pub use survey::{Piece, Survey, Turn};
use tape::Op;

/// What is wrong with the text of an expression.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct ExpressionError {
    /// What is wrong.
    pub message: String,
    /// The bytes of the text to which it refers.
    pub span: Range<usize>,
    /// What to change.
    pub help: String,
}

/// Bytes `start..end` of a source: 0 is the scene file, k the k-th override.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Place {
    /// Number of the source.
    pub source: usize,
    /// First byte.
    pub start: usize,
    /// The byte behind the last one.
    pub end: usize,
}

/// Where an expression has a kink or a jump: the zeros of an operand, or of the difference of two, or where an operand is a knot of a
/// profile.
#[derive(Debug, Clone, PartialEq)]
pub struct Switch {
    left: Range<usize>,
    right: Option<Range<usize>>,
    profile: Option<usize>,
}

/// A function of the point (x, y) and of the edge parameter s.
#[derive(Debug, Clone)]
pub struct Expression {
    code: Arc<Code>,
    /// Where the text stands in the scene.
    pub place: Place,
}

/// The parsed text of an expression: its tape with all names open.
#[derive(Debug)]
struct Read {
    text: String,
    ops: Vec<Op>,
    /// The names that it uses.
    names: Vec<String>,
}

/// An expression with the values of its names.
#[derive(Debug)]
struct Code {
    read: Arc<Read>,
    values: Vec<Value>,
    ops: Vec<Op>,
    height: usize,
    switches: Vec<Switch>,
    fields: Vec<Arc<FieldValue>>,
    profiles: Vec<Arc<Profile>>,
    /// The operand of each profile.
    arguments: Vec<Range<usize>>,
    known: along::Known,
}

impl Expression {
    /// Reads `text`, in which the names of `constants` may be used beside x, y, s and pi.
    ///
    /// # Errors
    /// [`ExpressionError`] with the place in the text: a name that is not known, a sign that does not belong there,
    /// a wrong number of arguments, nesting deeper than 256.
    pub fn parse(text: &str, constants: &BTreeMap<String, f64>) -> Result<Self, ExpressionError> {
        Self::with_fields(text, constants, &BTreeMap::new())
    }

    /// Reads `text`, in which profiles may be used as functions of one value: `rough(x)`.
    ///
    /// # Errors
    /// As [`Expression::parse`].
    pub fn with_profiles(
        text: &str,
        constants: &BTreeMap<String, f64>,
        fields: &BTreeMap<String, Arc<FieldValue>>,
        profiles: &BTreeMap<String, Arc<Profile>>,
    ) -> Result<Self, ExpressionError> {
        let parse::Parsed { ops, names, values } = parse::parse(text, constants, fields, profiles)?;
        Ok(Self::of(Arc::new(Read { text: text.to_owned(), ops, names }), values, Place::default()))
    }

    /// Reads `text`, in which random fields may be used as well.
    ///
    /// # Errors
    /// As [`Expression::parse`].
    pub fn with_fields(
        text: &str,
        constants: &BTreeMap<String, f64>,
        fields: &BTreeMap<String, Arc<FieldValue>>,
    ) -> Result<Self, ExpressionError> {
        Self::with_profiles(text, constants, fields, &BTreeMap::new())
    }

    fn of(read: Arc<Read>, values: Vec<Value>, place: Place) -> Self {
        let fold::Folded { ops, switches, fields, profiles, arguments } = fold::fold(&read.ops, &values);
        let (height, known) = (tape::height(&ops), along::Known::default());
        Self { code: Arc::new(Code { read, values, ops, height, switches, fields, profiles, arguments, known }), place }
    }

    /// The expression with these values of names, and with its own values of the others, as if its text were read with them.
    pub fn with_values(&self, values: &BTreeMap<String, Value>) -> Self {
        if !self.names().iter().any(|name| values.contains_key(name)) {
            return self.clone();
        }
        let own = self.names().iter().zip(&self.code.values);
        let all = own.map(|(name, own)| values.get(name).unwrap_or(own).clone()).collect();
        Self::of(self.code.read.clone(), all, self.place)
    }

    /// The constant function.
    pub fn number(value: f64) -> Self {
        let read = Read { text: value.to_string(), ops: vec![Op::Constant(value)], names: Vec::new() };
        Self::of(Arc::new(read), Vec::new(), Place::default())
    }

    /// Value at (x, y, s); NaN or infinite where the expression has no finite value. The branch of an `if` that is not
    /// taken is not evaluated; a comparison, `min` or `max` of NaN is NaN.
    pub fn eval(&self, x: f64, y: f64, s: f64) -> f64 {
        self.run_part(0..self.code.ops.len(), (x, y, s))
    }

    /// A profile that the point (x, y, s) takes beyond its ends: its name, the position, and the ends.
    pub fn beyond(&self, x: f64, y: f64, s: f64) -> Option<(&str, f64, [f64; 2])> {
        let Code { profiles, arguments, values, .. } = &*self.code;
        profiles.iter().zip(arguments).find_map(|(profile, argument)| {
            let position = self.run_part(argument.clone(), (x, y, s));
            let is_it = |value: &Value| matches!(value, Value::Profile(own) if Arc::ptr_eq(own, profile));
            let name = &self.names()[values.iter().position(is_it)?];
            (position.is_finite() && !profile.reaches(position)).then_some((name.as_str(), position, profile.ends()))
        })
    }

    /// The text as it was written.
    pub fn text(&self) -> &str {
        &self.code.read.text
    }

    /// Whether it uses the name of a parameter or random input.
    pub fn uses(&self, name: &str) -> bool {
        self.names().iter().any(|n| n == name)
    }

    /// The names of parameters and random input that it uses.
    pub fn names(&self) -> &[String] {
        &self.code.read.names
    }

    /// The values of these names, in the same order.
    pub fn values(&self) -> &[Value] {
        &self.code.values
    }

    /// The value, if the expression depends on none of x, y, s.
    pub fn constant(&self) -> Option<f64> {
        match self.code.ops[..] {
            [Op::Constant(value)] => Some(value),
            _ => None,
        }
    }

    /// Whether it uses s, which only the points of an edge have.
    pub fn uses_edge(&self) -> bool {
        self.code.ops.contains(&Op::S)
    }

    /// The parts whose change of sign makes a kink or a jump: the arguments of `abs`, `sign` and `sqrt`, the difference
    /// of the operands of `min`, `max` and comparisons, other conditions of `if`, the base of a power that is not whole,
    /// the first argument of `atan2`, and the knots of profiles. Parts that are constant are not counted.
    pub fn switches(&self) -> &[Switch] {
        &self.code.switches
    }

    /// Value of a switch at (x, y, s).
    pub fn switch_value(&self, switch: &Switch, x: f64, y: f64, s: f64) -> f64 {
        let value = |range: &Range<usize>| self.run_part(range.clone(), (x, y, s));
        let left = value(&switch.left);
        match switch.profile {
            Some(k) => self.code.profiles[k].bend(left),
            None => left - switch.right.as_ref().map_or(0.0, value),
        }
    }

    /// Value of a part of the tape, an operand.
    fn run_part(&self, part: Range<usize>, at: (f64, f64, f64)) -> f64 {
        let Code { ops, fields, profiles, height, .. } = &*self.code;
        tape::run(&ops[part], (fields, profiles), *height, at)
    }
}

/// Whether `name` has a meaning in expressions of its own, so that no parameter can have it.
pub fn is_reserved(name: &str) -> bool {
    parse::VARIABLES.contains(&name) || parse::FUNCTIONS.contains(&name)
}

/// Whether `name` can be written in an expression.
pub fn is_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_alphabetic() || c == '_') && name.chars().all(|c| c.is_alphanumeric() || c == '_')
}
