//! Whether an expression is affine in some of its names, or in the place.

use std::collections::BTreeMap;

use super::operation::{One, Two};
use super::tape::Op;
use super::{Expression, Value};

/// How a part of an expression depends on the names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// Not at all.
    Free,
    /// As b + Σ a_n n, with a_n and b of the place.
    Affine,
    /// Otherwise, or it is not known how.
    Other,
}

impl Expression {
    /// Whether the value is b + Σ_n a_n n in the names at every place, a_n and b functions of the place alone: by the form of the
    /// text, in which a product or quotient of names, a function of one, or a choice that depends on one is not affine, even where
    /// its value is (`g*g/g`).
    pub fn is_affine_in<'a>(&self, names: impl IntoIterator<Item = &'a str>) -> bool {
        let open: BTreeMap<String, Value> = names.into_iter().map(|name| (name.to_owned(), Value::Free(0))).collect();
        kind(&self.with_values(&open).code.ops) < Kind::Other
    }

    /// c, a and b, if the value is c + a x + b y at every place: by the form of the text, in which only sums and differences, and
    /// products and quotients with numbers, are affine. `None` for others, also where their value is (`x*x/x`), and for those of
    /// s, of random fields and of names without values. A number of the text that is not finite leaves one that is not.
    pub fn affine_in_place(&self) -> Option<[f64; 3]> {
        plane(&self.code.ops)
    }
}

/// The kind of the value of a tape.
fn kind(ops: &[Op]) -> Kind {
    let mut stack: Vec<Kind> = Vec::new();
    let mut next = 0;
    while next < ops.len() {
        match ops[next] {
            Op::Constant(_) | Op::X | Op::Y | Op::S | Op::Field(_) => stack.push(Kind::Free),
            Op::Name(_) => stack.push(Kind::Affine),
            Op::One(function) => {
                if let Some(top) = stack.last_mut().filter(|top| **top != Kind::Free && function != One::Negate) {
                    *top = Kind::Other;
                }
            }
            Op::Profile(_) | Op::Call(_) => {
                if let Some(top) = stack.last_mut().filter(|top| **top != Kind::Free) {
                    *top = Kind::Other;
                }
            }
            Op::Two(function) => {
                if let (Some(b), Some(a)) = (stack.pop(), stack.last_mut()) {
                    *a = both(function, *a, b);
                }
            }
            Op::Branch { otherwise, end } => {
                let condition = stack.pop().unwrap_or(Kind::Other);
                let (first, second) = (&ops[next + 1..next + otherwise], &ops[next + 1 + otherwise..=next + end]);
                stack.push(if condition == Kind::Free { kind(first).max(kind(second)) } else { Kind::Other });
                next += end;
            }
            // the jumps are those at the ends of first branches, which are looked at by themselves
            Op::Jump(_) => {}
        }
        next += 1;
    }
    stack.pop().unwrap_or(Kind::Other)
}

fn both(function: Two, a: Kind, b: Kind) -> Kind {
    match (function, a, b) {
        (_, Kind::Free, Kind::Free) => Kind::Free,
        (Two::Add | Two::Subtract, ..) => a.max(b),
        (Two::Multiply, Kind::Free, other) | (Two::Multiply | Two::Divide, other, Kind::Free) => other,
        _ => Kind::Other,
    }
}

/// A value c + a x + b y: c, a, b.
type Plane = [f64; 3];

/// The value of a tape, if it is affine in the place by its form.
fn plane(ops: &[Op]) -> Option<Plane> {
    let mut stack: Vec<Plane> = Vec::new();
    for op in ops {
        match *op {
            Op::Constant(value) => stack.push([value, 0.0, 0.0]),
            Op::X => stack.push([0.0, 1.0, 0.0]),
            Op::Y => stack.push([0.0, 0.0, 1.0]),
            Op::One(One::Negate) => stack.last_mut()?.iter_mut().for_each(|v| *v = -*v),
            Op::Two(function) => {
                let (b, a) = (stack.pop()?, stack.pop()?);
                stack.push(joined(function, a, b)?);
            }
            Op::S
            | Op::Field(_)
            | Op::Name(_)
            | Op::One(_)
            | Op::Call(_)
            | Op::Profile(_)
            | Op::Branch { .. }
            | Op::Jump(_) => return None,
        }
    }
    stack.pop()
}

fn joined(function: Two, a: Plane, b: Plane) -> Option<Plane> {
    let number = |[value, slopes @ ..]: Plane| (slopes == [0.0; 2]).then_some(value);
    Some(match (function, number(a), number(b)) {
        (Two::Add, ..) => [0, 1, 2].map(|k| a[k] + b[k]),
        (Two::Subtract, ..) => [0, 1, 2].map(|k| a[k] - b[k]),
        (Two::Multiply, Some(factor), _) => b.map(|v| factor * v),
        (Two::Multiply, _, Some(factor)) => a.map(|v| v * factor),
        (Two::Divide, _, Some(divisor)) => a.map(|v| v / divisor),
        (Two::Power, _, Some(1.0)) => a,
        _ => return None,
    })
}
