//! All values of an expression along a path, known within bounds: enclosures cover the values between the points.

use super::Expression;
use super::interval::Interval;
use super::range::{Track, enclose, leaves};

/// A stretch of a path and what the expression is there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// First and last t.
    pub ends: [f64; 2],
    /// Holds all values.
    pub value: Interval,
    /// Largest difference of the values at its ends and its middle.
    pub change: f64,
    /// Whether the values at the ends and the middle determine all values.
    pub known: bool,
    /// Whether a kink or a jump lies in it, or at its ends.
    pub kink: bool,
}

/// The pieces of a path, one after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// Pieces in the order of t.
    pub pieces: Vec<Piece>,
    /// Holds the values at the ends and middles of all pieces.
    pub sampled: Interval,
    /// The ends of all pieces and the values there.
    pub samples: Vec<(f64, f64)>,
}

/// Largest error of the values that are sampled, as part of the largest value that was met.
const SMALL: f64 = 1e-3;
/// Largest width of an enclosure over that of the samples.
const WIDER: f64 = 2.0;
/// Values may change this many times as steeply as the samples of a piece do over its length.
const STEEPER: f64 = 16.0;
/// Largest number of pieces of a path.
const MOST_PIECES: usize = 20_000;
/// Pieces of one peak differ by less than this factor in length.
const ALIKE: f64 = 4.0;
/// A piece is not halved below this part of the path.
pub(super) const SHORTEST: f64 = 1e-12;
/// Nor below this one where a kink lies in it.
const SHORTEST_AT_KINK: f64 = 1e-6;

impl Survey {
    /// Halves [a, b] until the values at both ends and the middle of every piece determine its behaviour: nothing in it is 16
    /// times steeper than these, so that a peak on one of them shows how narrow it is (where slopes are not bounded: its
    /// values are within twice those); or all of its values are within 1e-3 of the largest one that was met, or a kink lies in
    /// a piece of 1e-6. `kinks` has these, rising.
    pub fn new(expression: &Expression, path: &dyn Track, [a, b]: [f64; 2], kinks: &[f64]) -> Self {
        // the largest value first: the tails of a peak are as steep as its flanks, for their own size
        let met = Self::halved(expression, path, [a, b], kinks, None).1;
        Self::halved(expression, path, [a, b], kinks, met).0
    }

    /// Halves [a, b] until enclosures determine all values; where some values have been `met`, until samples determine their
    /// changes.
    fn halved(
        expression: &Expression,
        path: &dyn Track,
        [a, b]: [f64; 2],
        kinks: &[f64],
        mut met: Option<Interval>,
    ) -> (Self, Option<Interval>) {
        let value = |t: f64| {
            let (x, y, s) = path.at(t);
            expression.eval(x, y, s)
        };
        let values_only = met.is_none();
        let mut survey = Self { pieces: Vec::new(), sampled: Interval::ANY, samples: vec![(a, value(a))] };
        let mut stack = vec![[(a, value(a)), (b, value(b))]];
        let mut looked = 0;
        while let Some([a, b]) = stack.pop() {
            looked += 1;
            let m = a.0 + (b.0 - a.0) / 2.0;
            let middle = (m, value(m));
            let mut seen: Option<Interval> = None;
            for v in [a.1, middle.1, b.1].into_iter().filter(|v| v.is_finite()) {
                let point = Interval::point(v);
                seen = Some(seen.map_or(point, |seen| seen.hull(point)));
                met = Some(met.map_or(point, |met| met.hull(point)));
            }
            let enclosed = enclose([a.0, b.0], &|p, q| expression.range(&leaves(path, p, q)));
            let width = enclosed.value.width();
            let known = seen.zip(met).is_some_and(|(seen, met)| {
                let steepest = enclosed.slope.magnitude() * (b.0 - a.0);
                let told = match values_only || !enclosed.slope.is_bounded() {
                    true => enclosed.monotone || width <= WIDER * seen.width(),
                    false => steepest <= STEEPER * seen.width(),
                };
                told || width <= SMALL * met.magnitude()
            });
            let first = kinks.partition_point(|k| *k < a.0);
            let kink = kinks.get(first).is_some_and(|k| *k <= b.0);
            let shortest = b.0 - a.0 < if kink { SHORTEST_AT_KINK } else { SHORTEST } || m <= a.0 || m >= b.0;
            if known || shortest || looked > MOST_PIECES {
                // a jump between two neighbouring numbers is what both ends say
                let value = if shortest && !enclosed.value.is_bounded() {
                    seen.unwrap_or(Interval::ANY)
                } else {
                    enclosed.value
                };
                survey.samples.extend([middle, b].into_iter().filter(|p| p.1.is_finite()));
                survey.pieces.push(Piece {
                    ends: [a.0, b.0],
                    value,
                    change: seen.map_or(0.0, Interval::width),
                    known: known || shortest,
                    kink,
                });
            } else {
                stack.extend([[middle, b], [a, middle]]);
            }
        }
        survey.sampled = met.unwrap_or(Interval::ANY);
        (survey, met)
    }

    /// Whether every piece is known.
    pub fn is_complete(&self) -> bool {
        self.pieces.iter().all(|p| p.known)
    }

    /// The stretches, rising, where values change by more than `part` of the largest within pieces shorter than `shortest`,
    /// kinks apart. Two stretches with a gap shorter than the longer of them are one, unless their pieces are of another
    /// scale: a peak on a slope.
    pub fn stretches(&self, shortest: f64, part: f64) -> Vec<[f64; 2]> {
        let least = part * self.sampled.magnitude();
        let narrow = |p: &&Piece| p.ends[1] - p.ends[0] < shortest && !p.kink && p.change > least;
        let mut stretches: Vec<[f64; 2]> = self.pieces.iter().filter(narrow).map(|p| p.ends).collect();
        stretches.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut merged: Vec<[f64; 2]> = Vec::new();
        let mut last = 0.0;
        for [a, b] in stretches {
            let length: f64 = b - a;
            let alike = length.max(last) <= ALIKE * length.min(last);
            match merged.last_mut() {
                Some([from, to]) if alike && a - *to <= (*to - *from).max(length) => *to = b,
                _ => merged.push([a, b]),
            }
            last = length;
        }
        merged
    }

    /// The ends inside of (a, b) of pieces that are narrow: shorter than `shortest`, with values that change by more than `part`
    /// of the largest, kinks apart.
    pub fn narrow(&self, [a, b]: [f64; 2], shortest: f64, part: f64) -> Vec<f64> {
        let least = part * self.sampled.magnitude();
        let mut ends = Vec::new();
        for piece in &self.pieces {
            let [from, to] = piece.ends;
            if to - from < shortest && !piece.kink && piece.change > least {
                ends.extend([from, to].into_iter().filter(|t| a < *t && *t < b));
            }
        }
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        ends
    }
}

/// Where the values of an expression turn along [a, b]: a maximum, or a minimum, of which the values before and behind it differ
/// by more than a thousandth of the range that the survey met. Pieces are halved until each is monotone or changes by less.
pub(super) fn turns(expression: &Expression, path: &dyn Track, [a, b]: [f64; 2], range: Interval) -> Vec<Turn> {
    let least = SMALL * range.width();
    let mut turns = Vec::new();
    if least == 0.0 {
        return turns;
    }
    let sample = |t: f64| {
        let (x, y, s) = path.at(t);
        (t, expression.eval(x, y, s))
    };
    let first = sample(a);
    let (mut highest, mut lowest, mut rising) = (first, first, None);
    let mut stack = vec![[a, b]];
    let mut looked = 0;
    while let Some([a, b]) = stack.pop() {
        looked += 1;
        let m = a + (b - a) / 2.0;
        let enclosed = enclose([a, b], &|p, q| expression.range(&leaves(path, p, q)));
        let flat = enclosed.monotone || enclosed.value.width() <= least;
        if !flat && looked <= MOST_PIECES && b - a > SHORTEST_AT_KINK {
            stack.extend([[m, b], [a, m]]);
            continue;
        }
        for at in [m, b].map(sample).into_iter().filter(|at| at.1.is_finite()) {
            highest = if at.1 > highest.1 { at } else { highest };
            lowest = if at.1 < lowest.1 { at } else { lowest };
            if rising != Some(false) && at.1 < highest.1 - least {
                turns.extend(rising.map(|_| Turn { at: highest.0, maximum: true }));
                (lowest, rising) = (at, Some(false));
            } else if rising != Some(true) && at.1 > lowest.1 + least {
                turns.extend(rising.map(|_| Turn { at: lowest.0, maximum: false }));
                (highest, rising) = (at, Some(true));
            }
        }
    }
    turns
}

/// A place where values turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// Where.
    pub at: f64,
    /// Whether they are largest there, not smallest.
    pub maximum: bool,
}
