//! The flat form of an expression: operations in postfix order, run on a small stack.

use std::sync::Arc;

use super::operation::{One, Two};
use super::{FieldValue, Profile};

/// One operation; jumps are relative, so that any operand of an operation is a tape of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Op {
    Constant(f64),
    X,
    Y,
    S,
    /// Value of a random field at (x, y), by its index.
    Field(usize),
    /// A name without a value, by its index.
    Name(usize),
    One(One),
    /// A name called as a function of one value, by its index.
    Call(usize),
    /// A profile, by its index.
    Profile(usize),
    Two(Two),
    /// Takes a condition c: goes on if c is not 0, skips `otherwise` operations if c = 0, and for a NaN puts NaN and
    /// skips `end` operations.
    Branch {
        otherwise: usize,
        end: usize,
    },
    /// Skips that many operations.
    Jump(usize),
}

/// Largest height of the stack while `ops` run.
pub(super) fn height(ops: &[Op]) -> usize {
    let (mut now, mut top) = (0, 0);
    for op in ops {
        match op {
            Op::Constant(_) | Op::X | Op::Y | Op::S | Op::Field(_) | Op::Name(_) => now += 1,
            Op::One(_) | Op::Call(_) | Op::Profile(_) => {}
            // After a jump the other branch starts from where this one started.
            Op::Two(_) | Op::Branch { .. } | Op::Jump(_) => now -= 1,
        }
        top = top.max(now);
    }
    top
}

/// The fields and the profiles of a tape.
type Functions<'a> = (&'a [Arc<FieldValue>], &'a [Arc<Profile>]);

/// Value of `ops` at (x, y, s); `height` is that of the stack.
pub(super) fn run(ops: &[Op], functions: Functions<'_>, height: usize, at: (f64, f64, f64)) -> f64 {
    const USUAL: usize = 16;
    if height <= USUAL {
        run_on(ops, functions, &mut [0.0; USUAL], at)
    } else {
        run_on(ops, functions, &mut vec![0.0; height], at)
    }
}

fn run_on(ops: &[Op], (fields, profiles): Functions<'_>, stack: &mut [f64], (x, y, s): (f64, f64, f64)) -> f64 {
    let mut top = 0; // number of values on the stack
    let mut next = 0;
    while next < ops.len() {
        match ops[next] {
            Op::One(f) => stack[top - 1] = f.apply(stack[top - 1]),
            Op::Profile(k) => stack[top - 1] = profiles[k].value(stack[top - 1]),
            Op::Call(_) => stack[top - 1] = f64::NAN,
            Op::Two(f) => {
                top -= 1;
                stack[top - 1] = f.apply(stack[top - 1], stack[top]);
            }
            Op::Branch { otherwise, end } => {
                let condition = stack[top - 1];
                if condition.is_nan() {
                    next += end;
                } else {
                    top -= 1;
                    next += if condition == 0.0 { otherwise } else { 0 };
                }
            }
            Op::Jump(by) => next += by,
            Op::Constant(value) => {
                stack[top] = value;
                top += 1;
            }
            Op::X | Op::Y | Op::S | Op::Field(_) | Op::Name(_) => {
                stack[top] = match ops[next] {
                    Op::X => x,
                    Op::Y => y,
                    Op::Field(k) => fields[k].value([x, y]),
                    Op::Name(_) => f64::NAN,
                    _ => s,
                };
                top += 1;
            }
        }
        next += 1;
    }
    stack[0]
}
