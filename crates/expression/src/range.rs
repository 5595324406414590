//! Values of an expression and of its derivative over a stretch of a path, enclosed.
//!
//! ```text
//! leaves x, y, s, names over t ∈ [a, b] ─► tape ─► { f(t) } ⊂ value, { f'(t) } ⊂ slope
//! mean value form: f(t) ∈ f(m) + slope (t - m)        monotone: f(t) ∈ [f(a), f(b)]
//! ```

use std::ops::Sub;

use super::interval::Interval;
use super::operation::{One, Two};
use super::tape::Op;
use super::{Expression, Switch};

/// Enclosures of the values of a function and of its derivative by the parameter of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Enclosure of the values.
    pub value: Interval,
    /// Enclosure of the derivative; [`Interval::ANY`] also where the function jumps.
    pub slope: Interval,
}

/// The arguments of an evaluation: a box, and the direction of the path in it.
#[derive(Debug, Clone, Copy)]
pub struct Leaves<'a> {
    /// x.
    pub x: Range,
    /// y.
    pub y: Range,
    /// Edge parameter.
    pub s: Range,
    /// The names that were left free, in their order.
    pub names: &'a [Range],
}

const ZERO: Interval = Interval { low: 0.0, high: 0.0 };

impl Range {
    /// Values that do not change along the path.
    pub fn fixed(value: Interval) -> Self {
        Self { value, slope: ZERO }
    }

    /// Values from a to b, linear over a path of the given length.
    pub fn linear(a: f64, b: f64, length: f64) -> Self {
        let ends = Interval::new(a.min(b), a.max(b));
        Self { value: ends, slope: (Interval::point(b) - Interval::point(a)) / Interval::point(length) }
    }

    fn one(self, function: One) -> Self {
        let Self { value, slope } = self;
        let image = value.apply(function);
        let slope = match function {
            _ if slope == ZERO => ZERO,
            One::Negate => -slope,
            One::Abs if value.low >= 0.0 => slope,
            One::Abs if value.high <= 0.0 => -slope,
            One::Abs => slope.hull(-slope),
            One::Sign if image.single().is_some() => ZERO,
            One::Sign => Interval::ANY,
            One::Sqrt => slope / (image + image),
            One::Exp => slope * image,
            One::Log => slope / value,
            One::Sin => slope * value.apply(One::Cos),
            One::Cos => -(slope * value.apply(One::Sin)),
            One::Tan => slope * (image.square() + Interval::point(1.0)),
        };
        Self::told(image, slope)
    }

    fn two(self, function: Two, other: Self) -> Self {
        let (a, b) = (self, other);
        let value = a.value.combine(function, b.value);
        let slope = match function {
            _ if a.slope == ZERO && b.slope == ZERO => ZERO,
            Two::Add => a.slope + b.slope,
            Two::Subtract => a.slope - b.slope,
            Two::Multiply => a.slope * b.value + a.value * b.slope,
            Two::Divide => (a.slope - value * b.slope) / b.value,
            Two::Power => a.power_slope(b, value),
            Two::Atan2 => {
                let radius = a.value.square() + b.value.square();
                match a.value.contains(0.0) && b.value.low <= 0.0 {
                    true => Interval::ANY,
                    false => (a.slope * b.value - a.value * b.slope) / radius,
                }
            }
            Two::Min if a.value.high <= b.value.low => a.slope,
            Two::Min if b.value.high <= a.value.low => b.slope,
            Two::Max if a.value.low >= b.value.high => a.slope,
            Two::Max if b.value.low >= a.value.high => b.slope,
            Two::Min | Two::Max => a.slope.hull(b.slope),
            _ if value.single().is_some() => ZERO,
            _ => Interval::ANY,
        };
        Self::told(value, slope)
    }

    /// Where nothing is known of the values, nothing is known of the slope: between two poles tan rises, and falls across each.
    fn told(value: Interval, slope: Interval) -> Self {
        Self { value, slope: if value == Interval::ANY { Interval::ANY } else { slope } }
    }

    /// Derivative of aᵇ, whose values are `value`.
    fn power_slope(self, exponent: Self, value: Interval) -> Interval {
        match exponent.value.single() {
            Some(b) if exponent.slope == ZERO => {
                let factor = match b {
                    2.0 => self.value + self.value,
                    _ => Interval::point(b) * self.value.power(Interval::point(b - 1.0)),
                };
                factor * self.slope
            }
            _ => {
                let growth = exponent.slope * self.value.apply(One::Log);
                value * (growth + exponent.value * self.slope / self.value)
            }
        }
    }
}

impl Sub for Range {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl Expression {
    /// Indices of the names that were left free and count, in one of its switches or in all of it.
    pub fn free_names(&self, switch: Option<&Switch>) -> Vec<usize> {
        let mut names: Vec<usize> = self
            .ops_of(switch)
            .filter_map(|op| match op {
                Op::Name(k) => Some(*k),
                _ => None,
            })
            .collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Whether the place counts, in one of its switches or in all of it.
    pub fn uses_place(&self, switch: Option<&Switch>) -> bool {
        self.ops_of(switch).any(|op| matches!(op, Op::X | Op::Y | Op::S | Op::Field(_)))
    }

    fn ops_of(&self, switch: Option<&Switch>) -> impl Iterator<Item = &Op> {
        let (first, second) = match switch {
            Some(Switch { left, right, .. }) => (left.clone(), right.clone().unwrap_or(0..0)),
            None => (0..self.code.ops.len(), 0..0),
        };
        self.code.ops[first].iter().chain(&self.code.ops[second])
    }

    /// Enclosures over a box.
    pub fn range(&self, leaves: &Leaves<'_>) -> Range {
        self.run(&self.code.ops, leaves)
    }

    /// Enclosures of a switch over a box.
    pub fn switch_range(&self, switch: &Switch, leaves: &Leaves<'_>) -> Range {
        let left = self.run(&self.code.ops[switch.left.clone()], leaves);
        match (&switch.right, switch.profile) {
            (Some(right), _) => left - self.run(&self.code.ops[right.clone()], leaves),
            (None, Some(k)) => self.code.profiles[k].bend_range(left),
            (None, None) => left,
        }
    }

    fn run(&self, ops: &[Op], leaves: &Leaves<'_>) -> Range {
        let mut stack: Vec<Range> = Vec::with_capacity(self.code.height);
        let mut next = 0;
        while next < ops.len() {
            match ops[next] {
                Op::Constant(value) => stack.push(Range::fixed(Interval::point(value))),
                Op::X => stack.push(leaves.x),
                Op::Y => stack.push(leaves.y),
                Op::S => stack.push(leaves.s),
                Op::Name(k) => stack.push(leaves.names.get(k).copied().unwrap_or(Range::fixed(Interval::ANY))),
                Op::Field(k) => stack.push(self.code.fields[k].range(leaves.x, leaves.y)),
                Op::One(function) => {
                    if let Some(top) = stack.last_mut() {
                        *top = top.one(function);
                    }
                }
                Op::Profile(k) => {
                    if let Some(top) = stack.last_mut() {
                        *top = self.code.profiles[k].range(*top);
                    }
                }
                Op::Two(function) => {
                    if let (Some(b), Some(a)) = (stack.pop(), stack.last_mut()) {
                        *a = a.two(function, b);
                    }
                }
                Op::Branch { otherwise, end } => {
                    let condition = stack.pop().map_or(Interval::ANY, |c| c.value);
                    let first = &ops[next + 1..next + otherwise];
                    let second = &ops[next + 1 + otherwise..=next + end];
                    stack.push(match condition {
                        Interval::ANY => Range { value: Interval::ANY, slope: Interval::ANY },
                        c if c.single() == Some(0.0) => self.run(second, leaves),
                        c if !c.contains(0.0) => self.run(first, leaves),
                        _ => {
                            let (a, b) = (self.run(first, leaves), self.run(second, leaves));
                            Range { value: a.value.hull(b.value), slope: Interval::ANY }
                        }
                    });
                    next += end;
                }
                // the jumps are those at the ends of first branches, which are run by themselves
                // calls are profiles since the values of names are known
                Op::Jump(_) | Op::Call(_) => {}
            }
            next += 1;
        }
        stack.pop().unwrap_or(Range { value: Interval::ANY, slope: Interval::ANY })
    }
}

/// The enclosures of a function on a stretch of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Enclosed {
    /// Holds all of its values.
    pub value: Interval,
    /// Holds all of its slopes.
    pub slope: Interval,
    /// Whether it rises or falls all along, so that its extrema are those of the ends.
    pub monotone: bool,
}

/// A path in the plane: an affine function of its parameter, or a curve with a bound of how it bends.
pub trait Track {
    /// x, y and s.
    fn at(&self, t: f64) -> (f64, f64, f64);

    /// Bounds of the second derivatives of x and y, and of s.
    fn bend(&self) -> [f64; 2] {
        [0.0; 2]
    }
}

impl<F: Fn(f64) -> (f64, f64, f64)> Track for F {
    fn at(&self, t: f64) -> (f64, f64, f64) {
        self(t)
    }
}

/// The leaves on the stretch from a to b of a path: a curve leaves its chord by at most (b-a)²/8 times its second derivative,
/// and its slope differs from that of the chord by at most (b-a)/2 times it.
pub fn leaves(path: &dyn Track, a: f64, b: f64) -> Leaves<'static> {
    let ((x0, y0, s0), (x1, y1, s1)) = (path.at(a), path.at(b));
    let leaf = |u: f64, v: f64, bend: f64| {
        if a == b {
            return Range::fixed(Interval::point(u));
        }
        let Range { value, slope } = Range::linear(u, v, b - a);
        if bend == 0.0 {
            return Range { value, slope };
        }
        let wider = |range: Interval, by: f64| range + Interval::new(-by, by);
        Range { value: wider(value, bend * (b - a) * (b - a) / 8.0), slope: wider(slope, bend * (b - a) / 2.0) }
    };
    let [point, arc] = path.bend();
    Leaves { x: leaf(x0, x1, point), y: leaf(y0, y1, point), s: leaf(s0, s1, arc), names: &[] }
}

/// Encloses the values of a function on [a, b]; `over(p, q)` encloses its values and slopes on [p, q].
pub fn enclose([a, b]: [f64; 2], over: &dyn Fn(f64, f64) -> Range) -> Enclosed {
    let Range { value, slope } = over(a, b);
    if slope.low >= 0.0 || slope.high <= 0.0 {
        let ends = over(a, a).value.hull(over(b, b).value);
        return Enclosed { value: ends.within(value), slope, monotone: true };
    }
    if !slope.is_bounded() {
        return Enclosed { value, slope, monotone: false };
    }
    let m = a + (b - a) / 2.0;
    let about = slope * Interval::new(a - m, b - m);
    Enclosed { value: (over(m, m).value + about).within(value), slope, monotone: false }
}
