//! Piecewise linear functions of one variable: measured heights between which straight lines run.

use super::interval::Interval;
use super::range::Range;

/// Most knots of a profile.
pub const MOST_KNOTS: usize = 100_000;

/// Part of the whole length by which a position may lie beyond an end, where the value is that of the end.
const BEYOND: f64 = 1e-9;

/// Units in the last place of the largest value by which an interpolated one may be off.
const ULPS: f64 = 4.0;

/// A piecewise linear function by its values at knots; it has none beyond the first and the last one.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Positions, rising.
    at: Vec<f64>,
    /// Values there.
    value: Vec<f64>,
    /// The knots at which the slope changes.
    bends: Vec<f64>,
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
            Self::Count { .. } => None,
            Self::NotFinite { knot, .. } | Self::NotRising { knot, .. } => Some(*knot),
        }
    }
}

impl Profile {
    /// The profile with these values at rising positions.
    ///
    /// # Errors
    /// [`ProfileError`]: too few or too many knots, a number that is not finite, positions that do not rise.
    pub fn new(at: Vec<f64>, value: Vec<f64>) -> Result<Self, ProfileError> {
        let (positions, values) = (at.len(), value.len());
        if positions != values || !(2..=MOST_KNOTS).contains(&positions) {
            return Err(ProfileError::Count { positions, values });
        }
        for (knot, (&position, &value)) in at.iter().zip(&value).enumerate() {
            if !(position.is_finite() && value.is_finite()) {
                return Err(ProfileError::NotFinite { knot, position, value });
            }
        }
        if let Some(k) = (1..positions).find(|&k| at[k] <= at[k - 1]) {
            return Err(ProfileError::NotRising { knot: k, position: at[k], before: at[k - 1] });
        }
        let mut profile = Self { at, value, bends: Vec::new() };
        let bends = |k: &usize| profile.slope(*k) != profile.slope(k - 1);
        profile.bends = (1..positions - 1).filter(bends).map(|k| profile.at[k]).collect();
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

    /// Slope between knots k and k + 1.
    fn slope(&self, k: usize) -> f64 {
        (self.value[k + 1] - self.value[k]) / (self.at[k + 1] - self.at[k])
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
        let (t, k) = (t.clamp(first, last), self.before(t));
        let ([a, b], [u, v]) = ([self.at[k], self.at[k + 1]], [self.value[k], self.value[k + 1]]);
        // from the nearer knot, so that it has its value
        if t - a <= b - t { u + (v - u) * ((t - a) / (b - a)) } else { v - (v - u) * ((b - t) / (b - a)) }
    }

    /// Enclosures of the values where the position has these.
    pub(super) fn range(&self, position: Range) -> Range {
        let Interval { low, high } = position.value;
        if !(self.reaches(low) && self.reaches(high)) {
            return Range { value: Interval::ANY, slope: Interval::ANY };
        }
        let (first, last) = (self.before(low), self.before(high));
        let ends = [self.value(low), self.value(high)];
        let (mut least, mut most) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        let mut steep = Interval::point(self.slope(first));
        // a position at a knot has the slopes of both sides
        let start = if low == self.at[first] && first > 0 { first - 1 } else { first };
        for k in start..=last {
            steep = steep.hull(Interval::point(self.slope(k)));
            if k > first {
                (least, most) = (least.min(self.value[k]), most.max(self.value[k]));
            }
        }
        let slack = if least == most { 0.0 } else { ULPS * f64::EPSILON * least.abs().max(most.abs()) };
        let slope = match position.slope {
            Interval { low: 0.0, high: 0.0 } => position.slope,
            along => along * Interval::new(steep.low.next_down(), steep.high.next_up()),
        };
        Range { value: Interval::new(least - slack, most + slack), slope }
    }

    /// Whether there are knots at which the slope changes.
    pub(super) fn bends(&self) -> bool {
        !self.bends.is_empty()
    }

    /// A function that changes its sign at the knots at which the slope changes, and there alone: the distance from the nearest one.
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
