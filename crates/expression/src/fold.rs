//! The tape of a text becomes that of its values: names take theirs, constants are folded, and switches are found on the way.

use std::ops::Range;
use std::sync::Arc;

use super::operation::{One, Two};
use super::tape::Op;
use super::{FieldValue, Profile, Switch};

/// What a name stands for.
#[derive(Debug, Clone)]
pub enum Value {
    /// A number.
    Constant(f64),
    /// A random field.
    Field(Arc<FieldValue>),
    /// A function of one value by its values at knots.
    Profile(Arc<Profile>),
    /// Any value: [`Expression::range`](super::Expression::range) is given its range, by this index, and
    /// [`Expression::eval`](super::Expression::eval) is NaN where it counts.
    Free(usize),
}

/// A tape that can be run.
#[derive(Default)]
pub(super) struct Folded {
    pub(super) ops: Vec<Op>,
    pub(super) switches: Vec<Switch>,
    pub(super) fields: Vec<Arc<FieldValue>>,
    pub(super) profiles: Vec<Arc<Profile>>,
    /// The operand of each profile.
    pub(super) arguments: Vec<Range<usize>>,
}

struct Folder<'a> {
    read: &'a [Op],
    values: &'a [Value],
    out: Folded,
    /// Where the operands begin that wait for their operation.
    starts: Vec<usize>,
}

/// The tape `read` of a text with the values of its names.
pub(super) fn fold(read: &[Op], values: &[Value]) -> Folded {
    let mut folder = Folder { read, values, out: Folded::default(), starts: Vec::new() };
    folder.walk(0..read.len());
    folder.out
}

impl Folder<'_> {
    /// Folds a part of the tape, which leaves one operand more.
    fn walk(&mut self, part: Range<usize>) {
        let mut next = part.start;
        while next < part.end {
            match self.read[next] {
                Op::One(function) => self.one(function, self.starts[self.starts.len() - 1]),
                Op::Call(name) => self.call(name, self.starts[self.starts.len() - 1]),
                Op::Two(function) => {
                    let right = self.starts.pop().unwrap_or_default();
                    self.two(function, self.starts[self.starts.len() - 1], right);
                }
                Op::Branch { otherwise, end } => {
                    self.conditional(next + 1..next + otherwise, next + 1 + otherwise..next + 1 + end);
                    next += end;
                }
                leaf => self.leaf(leaf),
            }
            next += 1;
        }
    }

    fn leaf(&mut self, leaf: Op) {
        let op = match leaf {
            Op::Name(name) => match &self.values[name] {
                Value::Constant(value) => Op::Constant(*value),
                Value::Free(index) => Op::Name(*index),
                Value::Field(field) => {
                    self.out.fields.push(field.clone());
                    Op::Field(self.out.fields.len() - 1)
                }
                Value::Profile(_) => Op::Constant(f64::NAN),
            },
            other => other,
        };
        self.starts.push(self.out.ops.len());
        self.out.ops.push(op);
    }

    /// The branches of an `if` whose condition ends the tape; a constant condition leaves the one that it takes.
    fn conditional(&mut self, first: Range<usize>, second: Range<usize>) {
        let start = self.starts[self.starts.len() - 1];
        if let Some(condition) = self.constant(start) {
            if condition.is_nan() {
                self.out.ops[start] = Op::Constant(f64::NAN);
                return;
            }
            self.out.ops.truncate(start);
            self.starts.pop();
            return self.walk(if condition == 0.0 { second } else { first });
        }
        let condition = &self.out.ops[start..];
        let compared = matches!(condition.last(), Some(Op::Two(two)) if two.is_comparison())
            && !condition.iter().any(|op| matches!(op, Op::Branch { .. }));
        if !compared {
            self.out.switches.push(Switch { left: start..self.out.ops.len(), right: None, profile: None });
        }
        let branch = self.out.ops.len();
        self.out.ops.push(Op::Branch { otherwise: 0, end: 0 });
        self.walk(first);
        let jump = self.out.ops.len();
        self.out.ops.push(Op::Jump(0));
        self.walk(second);
        let end = self.out.ops.len();
        self.out.ops[branch] = Op::Branch { otherwise: jump - branch, end: end - branch - 1 };
        self.out.ops[jump] = Op::Jump(end - jump - 1);
        self.starts.truncate(self.starts.len() - 2);
    }

    /// Value of the operand that starts at `start` and ends the tape, if it is constant.
    fn constant(&self, start: usize) -> Option<f64> {
        match self.out.ops[start..] {
            [Op::Constant(value)] => Some(value),
            _ => None,
        }
    }

    /// Applies a function to the operand that starts at `start`.
    fn one(&mut self, function: One, start: usize) {
        if let Some(value) = self.constant(start) {
            self.out.ops[start] = Op::Constant(function.apply(value));
            return;
        }
        if matches!(function, One::Abs | One::Sign | One::Sqrt) {
            self.out.switches.push(Switch { left: start..self.out.ops.len(), right: None, profile: None });
        }
        self.out.ops.push(Op::One(function));
    }

    /// Applies the function that a name stands for to the operand that starts at `start`.
    fn call(&mut self, name: usize, start: usize) {
        let Value::Profile(profile) = &self.values[name] else {
            self.out.ops.truncate(start);
            return self.out.ops.push(Op::Constant(f64::NAN));
        };
        if let Some(value) = self.constant(start) {
            self.out.ops[start] = Op::Constant(profile.value(value));
            return;
        }
        let index = self.out.profiles.len();
        self.out.profiles.push(profile.clone());
        self.out.arguments.push(start..self.out.ops.len());
        if profile.bends() {
            self.out.switches.push(Switch { left: start..self.out.ops.len(), right: None, profile: Some(index) });
        }
        self.out.ops.push(Op::Profile(index));
    }

    /// Applies a function to the operands that start at `left` and at `right`.
    fn two(&mut self, function: Two, left: usize, right: usize) {
        let end = self.out.ops.len();
        let exponent = self.constant(right);
        if let ([Op::Constant(a)], Some(b)) = (&self.out.ops[left..right], exponent) {
            self.out.ops[left] = Op::Constant(function.apply(*a, b));
            self.out.ops.truncate(left + 1);
            return;
        }
        let switch = match function {
            Two::Add | Two::Subtract | Two::Multiply | Two::Divide => None,
            // A whole power is smooth, or has a pole; any other has a branch point where its base is 0.
            Two::Power if exponent.is_some_and(|b| b.fract() == 0.0) => None,
            // atan2(y, x) jumps across y = 0, x < 0.
            Two::Power | Two::Atan2 => Some(Switch { left: left..right, right: None, profile: None }),
            _ => Some(Switch { left: left..right, right: Some(right..end), profile: None }),
        };
        self.out
            .switches
            .extend(switch.filter(|s| s.right.is_some() || !matches!(self.out.ops[left..right], [Op::Constant(_)])));
        self.out.ops.push(Op::Two(function));
    }
}
