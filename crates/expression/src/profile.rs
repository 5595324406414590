//! Profiles: functions of one variable by their values at knots, with straight lines or cubics between them.
//!
//! Between knots a and b = a + h with values p and q, slopes m and n, and the secant d = (q - p)/h, a profile is
//! ```text
//! f(a + t) = p + t (m + t (c + t e)),    c = (3d - 2m - n)/h,    e = (m + n - 2d)/h²
//! ```
//! which is a straight line where m = n = d.
//!
//! Source: Fritsch and Butland, A method for constructing local monotone piecewise cubic interpolants (1984), for the
//! slopes of [`Profile::smooth`].

use super::interval::Interval;
use super::range::Range;

/// Most knots of a profile.
pub const MOST_KNOTS: usize = 100_000;

/// Part of the whole length by which a position may lie beyond an end, where the value is that of the end.
const BEYOND: f64 = 1e-9;

/// Units in the last place of the largest value by which an interpolated one may be off.
const ULPS: f64 = 8.0;

/// A jump of the second derivative is a bend where it moves values by more than this part of all values.
const CURVED: f64 = 1e-8;

/// A continuous function by its values and slopes at knots; it has none beyond the first and the last one.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Positions, rising.
    at: Vec<f64>,
    /// Values there.
    value: Vec<f64>,
    /// Slopes before and behind each knot.
    slope: Vec<[f64; 2]>,
    /// The knots at which the slope or the curvature changes.
    bends: Vec<f64>,
}

/// The cubic between two knots.
#[derive(Clone, Copy)]
struct Piece {
    /// The first knot.
    a: f64,
    /// Length.
    h: f64,
    /// Values at both knots.
    value: [f64; 2],
    /// Slopes there.
    slope: [f64; 2],
    secant: f64,
}

impl Piece {
    /// Coefficients of t² and t³.
    fn coefficients(self) -> [f64; 2] {
        let Self { h, slope: [m, n], secant: d, .. } = self;
        [(3.0 * d - 2.0 * m - n) / h, (m + n - 2.0 * d) / (h * h)]
    }

    /// The piece seen from its second knot backwards.
    fn mirrored(self) -> Self {
        let Self { a, h, value: [p, q], slope: [m, n], secant } = self;
        Self { a: a + h, h, value: [q, p], slope: [-n, -m], secant: -secant }
    }

    /// Value at a distance from the first knot.
    fn value(self, t: f64) -> f64 {
        let Self { h, value: [p, q], slope: [m, n], secant: d, .. } = self;
        if m == d && n == d {
            return p + (q - p) * (t / h);
        }
        let [c, e] = self.coefficients();
        p + t * (m + t * (c + t * e))
    }

    /// Slope at a distance from the first knot.
    fn slope(self, t: f64) -> f64 {
        let [c, e] = self.coefficients();
        self.slope[0] + t * (2.0 * c + 3.0 * t * e)
    }

    /// Enclosures of values and slopes between two distances from the first knot.
    fn range(self, [low, high]: [f64; 2]) -> [Interval; 2] {
        let Self { h, value: [p, q], slope: [m, n], secant: d, .. } = self;
        let ends = |f: &dyn Fn(f64) -> f64| Interval::point(f(low)).hull(Interval::point(f(high)));
        if m == d && n == d {
            let steep = Interval::new(d.next_down(), d.next_up());
            return [ends(&|t| self.value(t)), steep];
        }
        let [c, e] = self.coefficients();
        let (mut value, mut slope) = (ends(&|t| self.value(t)), ends(&|t| self.slope(t)));
        let inside = |t: &f64| low < *t && *t < high;
        // the slope is least or largest where the curvature is zero, the value where the slope is
        if let Some(t) = Some(-c / (3.0 * e)).filter(inside) {
            slope = slope.hull(Interval::point(self.slope(t)));
        }
        let root = (c * c - 3.0 * e * m).max(0.0).sqrt();
        let of_sign = -(c + c.signum() * root);
        for t in [of_sign / (3.0 * e), m / of_sign].into_iter().filter(inside) {
            value = value.hull(Interval::point(self.value(t)));
        }
        let size = m.abs() + n.abs() + d.abs();
        let (of_value, of_slope) = ((p.abs().max(q.abs()) + size * h) * f64::EPSILON, size * ULPS * f64::EPSILON);
        [
            Interval::new(value.low - ULPS * of_value, value.high + ULPS * of_value),
            Interval::new(slope.low - of_slope, slope.high + of_slope),
        ]
    }
}

/// Why knots make no profile.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProfileError {
    /// Fewer than two knots, more than [`MOST_KNOTS`], or positions and values of different number.
    #[error("{positions} positions and {values} values: a profile has as many of both, 2 to {MOST_KNOTS}")]
    Count {
        /// Number of positions.
        positions: usize,
        /// Number of values.
        values: usize,
    },
    /// Slopes that are not two for each knot.
    #[error("{slopes} pairs of slopes for {knots} knots: each knot has one, the slopes before and behind it")]
    Slopes {
        /// Number of pairs.
        slopes: usize,
        /// Number of knots.
        knots: usize,
    },
    /// Slopes that are NaN or infinite.
    #[error("the slopes of knot {knot} are {slopes:?}: both must be finite")]
    Steep {
        /// Its number, from 0.
        knot: usize,
        /// Its slopes.
        slopes: [f64; 2],
    },
    /// A position or a value that is NaN or infinite.
    #[error("knot {knot} is ({position}, {value}): both must be finite")]
    NotFinite {
        /// Its number, from 0.
        knot: usize,
        /// Its position.
        position: f64,
        /// Its value.
        value: f64,
    },
    /// A position that is not beyond the one before.
    #[error("knot {knot} is at {position}, not beyond {before}: list the knots by rising positions, each once")]
    NotRising {
        /// Its number, from 0.
        knot: usize,
        /// Its position.
        position: f64,
        /// The position before.
        before: f64,
    },
}

impl ProfileError {
    /// The number of the knot that is wrong, from 0.
    pub fn knot(&self) -> Option<usize> {
        match self {
            Self::Count { .. } | Self::Slopes { .. } => None,
            Self::NotFinite { knot, .. } | Self::NotRising { knot, .. } | Self::Steep { knot, .. } => Some(*knot),
        }
    }
}

impl Profile {
    /// The profile with straight lines between these values at rising positions.
    ///
    /// # Errors
    /// [`ProfileError`]: too few or too many knots, a number that is not finite, positions that do not rise.
    pub fn new(at: Vec<f64>, value: Vec<f64>) -> Result<Self, ProfileError> {
        check(&at, &value)?;
        let secants = secants(&at, &value);
        let last = secants.len() - 1;
        let slope = (0..at.len()).map(|k| [secants[k.saturating_sub(1)], secants[k.min(last)]]).collect();
        Self::with_slopes(at, value, slope)
    }

    /// The profile with cubics between these values at rising positions: its slope is continuous, and it rises and
    /// falls only where the values do.
    ///
    /// # Errors
    /// As [`Profile::new`].
    pub fn smooth(at: Vec<f64>, value: Vec<f64>) -> Result<Self, ProfileError> {
        check(&at, &value)?;
        let d = secants(&at, &value);
        let length = |k: usize| at[k + 1] - at[k];
        let inner = |k: usize| {
            let (w, v) = (2.0 * length(k) + length(k - 1), length(k) + 2.0 * length(k - 1));
            if d[k - 1] * d[k] > 0.0 { (w + v) / (w / d[k - 1] + v / d[k]) } else { 0.0 }
        };
        // the parabola through three knots, kept from turning where the values do not
        let end = |[h, g]: [f64; 2], [d, of_next]: [f64; 2]| {
            let slope = ((2.0 * h + g) * d - h * of_next) / (h + g);
            match slope * d <= 0.0 {
                true => 0.0,
                false if d * of_next <= 0.0 && slope.abs() > 3.0 * d.abs() => 3.0 * d,
                false => slope,
            }
        };
        let last = d.len() - 1;
        let slope = |k: usize| match k {
            _ if last == 0 => d[0],
            0 => end([length(0), length(1)], [d[0], d[1]]),
            k if k > last => end([length(last), length(last - 1)], [d[last], d[last - 1]]),
            k => inner(k),
        };
        let slope = (0..at.len()).map(|k| [slope(k); 2]).collect();
        Self::with_slopes(at, value, slope)
    }

    /// The profile with cubics between these values at rising positions, by the slopes before and behind each knot.
    ///
    /// # Errors
    /// As [`Profile::new`]; slopes that are not a pair for each knot, or not finite.
    pub fn with_slopes(at: Vec<f64>, value: Vec<f64>, slope: Vec<[f64; 2]>) -> Result<Self, ProfileError> {
        check(&at, &value)?;
        if slope.len() != at.len() {
            return Err(ProfileError::Slopes { slopes: slope.len(), knots: at.len() });
        }
        if let Some(knot) = slope.iter().position(|pair| !pair.iter().all(|m| m.is_finite())) {
            return Err(ProfileError::Steep { knot, slopes: slope[knot] });
        }
        let mut profile = Self { at, value, slope, bends: Vec::new() };
        let values = profile
            .value
            .iter()
            .copied()
            .fold(Interval::point(profile.value[0]), |all, v| all.hull(Interval::point(v)));
        let bends = |k: &usize| {
            let (before, behind) = (profile.piece(k - 1), profile.piece(*k));
            let curvature = |piece: Piece| 2.0 * piece.coefficients()[0];
            let jump = curvature(behind) - curvature(before.mirrored());
            before.slope[1] != behind.slope[0] || jump.abs() * before.h.max(behind.h).powi(2) > CURVED * values.width()
        };
        profile.bends = (1..profile.at.len() - 1).filter(bends).map(|k| profile.at[k]).collect();
        Ok(profile)
    }

    /// The positions of the knots, rising.
    pub fn positions(&self) -> &[f64] {
        &self.at
    }

    /// The values at the knots.
    pub fn values(&self) -> &[f64] {
        &self.value
    }

    /// The first and the last position.
    pub fn ends(&self) -> [f64; 2] {
        [self.at[0], self.at[self.at.len() - 1]]
    }

    /// The slopes before and behind each knot.
    pub fn slopes(&self) -> &[[f64; 2]] {
        &self.slope
    }

    /// The cubic between knots k and k + 1.
    fn piece(&self, k: usize) -> Piece {
        let (a, h) = (self.at[k], self.at[k + 1] - self.at[k]);
        let (value, slope) = ([self.value[k], self.value[k + 1]], [self.slope[k][1], self.slope[k + 1][0]]);
        Piece { a, h, value, slope, secant: (value[1] - value[0]) / h }
    }

    /// The knot before a position between the ends, not the last one.
    fn before(&self, t: f64) -> usize {
        self.at.partition_point(|knot| *knot <= t).clamp(1, self.at.len() - 1) - 1
    }

    /// Whether a position is between the ends, or nearly.
    pub(super) fn reaches(&self, t: f64) -> bool {
        let [first, last] = self.ends();
        let beyond = BEYOND * (last - first);
        first - beyond <= t && t <= last + beyond
    }

    /// Value at a position; NaN beyond the ends.
    pub fn value(&self, t: f64) -> f64 {
        if !self.reaches(t) {
            return f64::NAN;
        }
        let [first, last] = self.ends();
        let t = t.clamp(first, last);
        let k = self.before(t);
        // from the nearer knot, so that it has its value
        let (piece, [a, b]) = (self.piece(k), [self.at[k], self.at[k + 1]]);
        if t - a <= b - t { piece.value(t - a) } else { piece.mirrored().value(b - t) }
    }

    /// Enclosures of the values where the position has these.
    pub(super) fn range(&self, position: Range) -> Range {
        let Interval { low, high } = position.value;
        if !(self.reaches(low) && self.reaches(high)) {
            return Range { value: Interval::ANY, slope: Interval::ANY };
        }
        let [begin, end] = self.ends();
        let (low, high) = (low.clamp(begin, end), high.clamp(begin, end));
        let (first, last) = (self.before(low), self.before(high));
        // a position at a knot has the slopes of both sides
        let start = if low == self.at[first] && first > 0 { first - 1 } else { first };
        let (mut value, mut steep) = (Interval::point(self.value(low)).hull(Interval::point(self.value(high))), None);
        for k in start..=last {
            let piece = self.piece(k);
            let of_piece = piece.range([(low - piece.a).clamp(0.0, piece.h), (high - piece.a).clamp(0.0, piece.h)]);
            value = value.hull(of_piece[0]);
            steep = Some(steep.map_or(of_piece[1], |steep: Interval| steep.hull(of_piece[1])));
        }
        let slack =
            if value.low == value.high { 0.0 } else { ULPS * f64::EPSILON * value.low.abs().max(value.high.abs()) };
        let slope = match (position.slope, steep) {
            (Interval { low: 0.0, high: 0.0 }, _) => position.slope,
            (along, steep) => along * steep.unwrap_or(Interval::ANY),
        };
        Range { value: Interval::new(value.low - slack, value.high + slack), slope }
    }

    /// Whether there are knots at which the slope or the curvature changes.
    pub(super) fn bends(&self) -> bool {
        !self.bends.is_empty()
    }

    /// A function that changes its sign at the bends, and there alone: the distance from the nearest one.
    pub(super) fn bend(&self, t: f64) -> f64 {
        let k = self.bends.partition_point(|bend| *bend <= t);
        let before = k.checked_sub(1).map(|k| t - self.bends[k]);
        let after = self.bends.get(k).map(|bend| bend - t);
        let distance = match (before, after) {
            (Some(before), Some(after)) => before.min(after),
            (Some(only), None) | (None, Some(only)) => only,
            (None, None) => f64::NAN,
        };
        if k % 2 == 0 { distance } else { -distance }
    }

    /// Its enclosures where the position has these.
    pub(super) fn bend_range(&self, position: Range) -> Range {
        let Interval { low, high } = position.value;
        if !(low.is_finite() && high.is_finite()) {
            return Range { value: Interval::ANY, slope: Interval::ANY };
        }
        let mut value = Interval::point(self.bend(low)).hull(Interval::point(self.bend(high)));
        let first = self.bends.partition_point(|bend| *bend < low);
        let last = self.bends.partition_point(|bend| *bend <= high);
        // between two knots it turns in the middle
        let mut turns = false;
        for k in first.max(1)..=last.min(self.bends.len() - 1) {
            let middle = self.bends[k - 1] + (self.bends[k] - self.bends[k - 1]) / 2.0;
            if low <= middle && middle <= high {
                value = value.hull(Interval::point(self.bend(middle)));
                turns = true;
            }
        }
        let slack = ULPS * f64::EPSILON * low.abs().max(high.abs());
        let value = Interval::new(value.low - slack, value.high + slack);
        let unit = match turns {
            true => Interval::new(-1.0, 1.0),
            false => {
                // the nearest knot, to which it falls or from which it rises
                let near = self.bends.partition_point(|bend| *bend <= low);
                let k = match (near.checked_sub(1), self.bends.get(near)) {
                    (Some(k), Some(after)) if low - self.bends[k] <= after - low => k,
                    (Some(k), None) => k,
                    _ => near,
                };
                Interval::point(if k % 2 == 0 { -1.0 } else { 1.0 })
            }
        };
        Range { value, slope: position.slope * unit }
    }
}

/// Refuses knots that make no profile.
fn check(at: &[f64], value: &[f64]) -> Result<(), ProfileError> {
    let (positions, values) = (at.len(), value.len());
    if positions != values || !(2..=MOST_KNOTS).contains(&positions) {
        return Err(ProfileError::Count { positions, values });
    }
    for (knot, (&position, &value)) in at.iter().zip(value).enumerate() {
        if !(position.is_finite() && value.is_finite()) {
            return Err(ProfileError::NotFinite { knot, position, value });
        }
    }
    match (1..positions).find(|&k| at[k] <= at[k - 1]) {
        Some(k) => Err(ProfileError::NotRising { knot: k, position: at[k], before: at[k - 1] }),
        None => Ok(()),
    }
}

/// The slopes of the straight lines between knots.
fn secants(at: &[f64], value: &[f64]) -> Vec<f64> {
    (1..at.len()).map(|k| (value[k] - value[k - 1]) / (at[k] - at[k - 1])).collect()
}
