//! Intervals of real numbers, rounded outwards.
//!
//! Every operation gives an interval that holds all values of the exact operation on members of its operands. Where an
//! operand is, or may be, outside of the domain of a function the result is [`Interval::ANY`]: nothing is known.

use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::operation::{One, Two};

/// All numbers from `low` to `high`; never empty, never NaN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The least of them.
    pub low: f64,
    /// The largest.
    pub high: f64,
}

/// Units in the last place by which a function of the standard library may be off.
const ULPS: usize = 4;
/// Arguments of sine, cosine and tangent beyond this have no digits left behind the point that count.
const LARGEST_ANGLE: f64 = 1e12;

impl Interval {
    /// Nothing is known: any number, or none.
    pub const ANY: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// A single number; [`Interval::ANY`] if it is none.
    pub fn point(value: f64) -> Self {
        Self::new(value, value)
    }

    /// From `low` to `high`; [`Interval::ANY`] if one of them is NaN.
    pub fn new(low: f64, high: f64) -> Self {
        if low <= high { Self { low, high } } else { Self::ANY }
    }

    /// The smallest interval that holds both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// The intersection of both; the first if rounding leaves nothing.
    #[must_use]
    pub fn within(self, other: Self) -> Self {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        if low <= high { Self { low, high } } else { self }
    }

    /// Whether it holds the number.
    pub fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// Distance of the ends.
    pub fn width(self) -> f64 {
        self.high - self.low
    }

    /// Largest absolute value.
    pub fn magnitude(self) -> f64 {
        self.high.abs().max(self.low.abs())
    }

    /// Whether both ends are finite.
    pub fn is_bounded(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// The number, if there is only one.
    pub fn single(self) -> Option<f64> {
        (self.low == self.high).then_some(self.low)
    }

    /// Wider by some units in the last place.
    fn rounded(self, ulps: usize) -> Self {
        let (mut low, mut high) = (self.low, self.high);
        for _ in 0..ulps {
            (low, high) = (low.next_down(), high.next_up());
        }
        Self::new(low, high)
    }

    /// The hull of candidates.
    fn of(values: [f64; 4]) -> Self {
        if values.iter().any(|v| v.is_nan()) {
            return Self::ANY;
        }
        Self {
            low: values.iter().copied().fold(f64::INFINITY, f64::min),
            high: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        }
    }

    /// A function that rises.
    fn rising(self, f: impl Fn(f64) -> f64) -> Self {
        Self::new(f(self.low), f(self.high)).rounded(ULPS)
    }

    /// Square.
    #[must_use]
    pub fn square(self) -> Self {
        let square = self * self;
        if self.low >= 0.0 || self.high <= 0.0 {
            square
        } else {
            Self { low: 0.0, high: product(self.low, self.low).1.max(product(self.high, self.high).1) }
        }
    }

    /// aᵇ.
    #[must_use]
    pub fn power(self, exponent: Self) -> Self {
        match exponent.single() {
            Some(2.0) => self.square(),
            Some(b) if b.fract() == 0.0 && b.abs() < 1e9 => self.whole_power(b),
            // a power of what may be negative is defined for whole exponents only
            Some(b) if self.low >= 0.0 => {
                if b < 0.0 && self.low == 0.0 {
                    return Self::ANY;
                }
                let ends = [self.low.powf(b), self.high.powf(b)];
                Self::new(ends[0].min(ends[1]), ends[0].max(ends[1]))
                    .rounded(ULPS)
                    .within(Self { low: 0.0, high: f64::INFINITY })
            }
            None if self.low > 0.0 => (exponent * self.apply(One::Log)).apply(One::Exp),
            _ => Self::ANY,
        }
    }

    fn whole_power(self, b: f64) -> Self {
        if b < 0.0 && self.contains(0.0) {
            return Self::ANY;
        }
        let ends = [self.low.powf(b), self.high.powf(b)];
        let even = b % 2.0 == 0.0;
        let range = Self::new(ends[0].min(ends[1]), ends[0].max(ends[1])).rounded(ULPS + 2);
        match even {
            true if self.contains(0.0) => Self { low: 0.0, ..range },
            true => range.within(Self { low: 0.0, high: f64::INFINITY }),
            false => range,
        }
    }

    /// The smaller one.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.min(other.high) }
    }

    /// The larger one.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.max(other.high) }
    }

    /// A function of one value.
    pub(super) fn apply(self, function: One) -> Self {
        if self == Self::ANY {
            return Self::ANY;
        }
        match function {
            One::Negate => -self,
            One::Abs if self.low >= 0.0 => self,
            One::Abs if self.high <= 0.0 => -self,
            One::Abs => Self { low: 0.0, high: self.magnitude() },
            One::Sign => Self { low: function.apply(self.low), high: function.apply(self.high) },
            One::Sqrt if self.low < 0.0 => Self::ANY,
            One::Sqrt => self.rising(f64::sqrt).within(Self { low: 0.0, high: f64::INFINITY }),
            One::Exp => self.rising(f64::exp).within(Self { low: 0.0, high: f64::INFINITY }),
            One::Log if self.low <= 0.0 => Self::ANY,
            One::Log => self.rising(f64::ln),
            One::Sin => self.wave(f64::sin, FRAC_PI_2),
            One::Cos => self.wave(f64::cos, 0.0),
            One::Tan => {
                let poles = whole_between(self, FRAC_PI_2, PI);
                if self.magnitude() > LARGEST_ANGLE || poles { Self::ANY } else { self.rising(f64::tan) }
            }
        }
    }

    /// A function of two values; a comparison that is not decided is 0 or 1.
    pub(super) fn combine(self, function: Two, other: Self) -> Self {
        if self == Self::ANY || other == Self::ANY {
            return Self::ANY;
        }
        match function {
            Two::Add => self + other,
            Two::Subtract => self - other,
            Two::Multiply => self * other,
            Two::Divide => self / other,
            Two::Power => self.power(other),
            Two::Atan2 => self.angle(other),
            Two::Min => self.min(other),
            Two::Max => self.max(other),
            comparison => comparison
                .between(self, other)
                .map_or(Self { low: 0.0, high: 1.0 }, |t| Self::point(f64::from(u8::from(t)))),
        }
    }

    /// A wave whose maxima are at `top` + 2πk.
    fn wave(self, f: impl Fn(f64) -> f64, top: f64) -> Self {
        const UNIT: Interval = Interval { low: -1.0, high: 1.0 };
        if self.magnitude() > LARGEST_ANGLE || self.width() >= 2.0 * PI {
            return UNIT;
        }
        let (a, b) = (f(self.low), f(self.high));
        let mut range = Self::new(a.min(b), a.max(b)).rounded(ULPS).within(UNIT);
        if whole_between(self, top, 2.0 * PI) {
            range.high = 1.0;
        }
        if whole_between(self, top + PI, 2.0 * PI) {
            range.low = -1.0;
        }
        range
    }

    /// atan2 of y in `self` and of x.
    fn angle(self, x: Self) -> Self {
        let cut = x.low <= 0.0 && self.contains(0.0);
        if cut {
            return Self { low: -PI, high: PI }.rounded(ULPS);
        }
        let (y, at) = (self, f64::atan2);
        Self::of([at(y.low, x.low), at(y.low, x.high), at(y.high, x.low), at(y.high, x.high)]).rounded(ULPS)
    }
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(sum(self.low, other.low).0, sum(self.high, other.high).1)
    }
}

impl Sub for Interval {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        if self == Self::ANY || other == Self::ANY {
            return Self::ANY;
        }
        let ends = [(self.low, other.low), (self.low, other.high), (self.high, other.low), (self.high, other.high)];
        let products = ends.map(|(a, b)| product(a, b));
        let (low, high) = (Self::of(products.map(|p| p.0)), Self::of(products.map(|p| p.1)));
        Self::new(low.low, high.high)
    }
}

impl Div for Interval {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        if other.contains(0.0) {
            return Self::ANY;
        }
        if self.single() == Some(0.0) {
            return self;
        }
        let (a, b) = (self, other);
        let quotient = Self::of([a.low / b.low, a.low / b.high, a.high / b.low, a.high / b.high]).rounded(1);
        // rounding does not take a quotient of 0 beyond it
        match [a.low >= 0.0, a.high <= 0.0, b.low > 0.0] {
            [true, _, true] | [_, true, false] => quotient.within(Self { low: 0.0, high: f64::INFINITY }),
            [true, _, false] | [_, true, true] => quotient.within(Self { low: f64::NEG_INFINITY, high: 0.0 }),
            _ => quotient,
        }
    }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }
}

impl Two {
    /// The result of a comparison for all members, if it is the same for all.
    fn between(self, a: Interval, b: Interval) -> Option<bool> {
        let apart = a.high < b.low || b.high < a.low;
        let same = a.single().is_some() && a == b;
        match self {
            Two::Less if a.high < b.low => Some(true),
            Two::Less if a.low >= b.high => Some(false),
            Two::LessEqual if a.high <= b.low => Some(true),
            Two::LessEqual if a.low > b.high => Some(false),
            Two::Greater | Two::GreaterEqual => {
                let turned = if self == Two::Greater { Two::Less } else { Two::LessEqual };
                turned.between(b, a)
            }
            Two::Equal if apart || same => Some(same),
            Two::NotEqual if apart || same => Some(apart),
            _ => None,
        }
    }
}

/// Bounds of a + b; both are the sum where it is exact.
fn sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let part = s - a;
    let error = (a - (s - part)) + (b - part);
    bounds(s, error)
}

/// Bounds of a b; both are the product where it is exact.
fn product(a: f64, b: f64) -> (f64, f64) {
    if a == 0.0 || b == 0.0 {
        return (0.0, 0.0);
    }
    let p = a * b;
    if p.abs() < 1e-280 {
        return (p.next_down(), p.next_up());
    }
    // powers of two lose nothing, and the error of others is not worth its seconds
    let exact = is_power_of_two(a) || is_power_of_two(b);
    if exact { (p, p) } else { (p.next_down(), p.next_up()) }
}

fn is_power_of_two(a: f64) -> bool {
    a.is_normal() && a.to_bits() & ((1 << 52) - 1) == 0
}

fn bounds(value: f64, error: f64) -> (f64, f64) {
    match error {
        e if e > 0.0 => (value, value.next_up()),
        e if e < 0.0 => (value.next_down(), value),
        0.0 => (value, value),
        _ => (value.next_down(), value.next_up()),
    }
}

/// Whether, up to rounding, a number `first` + k `period` lies in the interval.
fn whole_between(interval: Interval, first: f64, period: f64) -> bool {
    let slack = 1e-15 * (1.0 + interval.magnitude());
    let k = ((interval.low - slack - first) / period).ceil();
    first + k * period <= interval.high + slack
}
