//! Data that jump or bend in the germs where no point of a cell is: enclosed over boxes of germs, halved until they are found or
//! excluded.

use std::collections::VecDeque;

use steklov_expression::Interval;
use steklov_problem::{Random, Scene, Signal};
use steklov_stochastic::{StochasticMesh, Variable};

/// Most boxes that are examined for a signal in a cell.
const BOXES: usize = 3000;
/// Part of the probability of a cell below which a box is left as it is.
const SMALLEST: f64 = 1e-9;
/// Number of parts of an edge in which points are examined.
const PARTS: usize = 32;
/// Most points of a cell that are compared with.
const POINTS: usize = 500;
/// Most germs of data whose values are compared, not their switches alone.
const FEW: usize = 3;
/// How far values may leave those of the points, in their width and in their size.
const WIDTHS: f64 = 1.0;
const SIZE: f64 = 1e-3;

/// The data of a scene in its germs.
pub(crate) struct InGerms<'a> {
    random: &'a Random,
    signals: Vec<Signal>,
}

/// Data that differ somewhere in a cell from those at all of its points.
pub(super) struct Overlooked {
    /// An outcome with them.
    pub(super) germ: Vec<f64>,
    /// Their part of the probability of the cell, about.
    pub(super) share: f64,
    /// Where to split to separate them from most of the rest: direction and germ.
    pub(super) cut: Option<(usize, f64)>,
}

/// The data that the points of a cell leave open.
#[derive(Default)]
pub(super) struct Open {
    pub(super) found: Vec<Overlooked>,
    /// Part of its probability in which kinks and jumps are neither found nor excluded.
    pub(super) undecided: f64,
}

/// A box of germs and a part of a path.
struct Part {
    germs: Vec<[f64; 2]>,
    path: usize,
    part: [f64; 2],
}

impl<'a> InGerms<'a> {
    pub(crate) fn new(scene: &Scene, random: &'a Random) -> Self {
        Self { random, signals: scene.signals(random) }
    }

    /// The range of each signal where it is as at the points; none if they say nothing.
    pub(super) fn seen(&self, points: &[Vec<f64>]) -> Vec<Option<Interval>> {
        let step = points.len().div_ceil(POINTS).max(1);
        let of = |signal: &Signal| {
            if !signal.is_switch() && signal.germs.len() > FEW {
                return None;
            }
            let mut seen: Option<Interval> = None;
            for point in points.iter().step_by(step) {
                let value = self.at(signal, point);
                seen = Some(seen.map_or(value, |s| s.hull(value)));
            }
            let seen = seen?;
            match signal.is_switch() {
                true if seen.low > 0.0 => Some(Interval { low: 0.0, high: f64::INFINITY }),
                true if seen.high < 0.0 => Some(Interval { low: f64::NEG_INFINITY, high: 0.0 }),
                false if seen.is_bounded() => {
                    let off = WIDTHS * seen.width() + SIZE * seen.magnitude();
                    Some(Interval { low: seen.low - off, high: seen.high + off })
                }
                _ => None,
            }
        };
        self.signals.iter().map(of).collect()
    }

    /// All values of a signal at a germ.
    fn at(&self, signal: &Signal, germ: &[f64]) -> Interval {
        let point: Vec<[f64; 2]> = germ.iter().map(|&xi| [xi, xi]).collect();
        let mut all: Option<Interval> = None;
        for (path, [start, end]) in signal.paths.iter().enumerate() {
            let parts = if start == end { 1 } else { PARTS };
            for k in 0..parts {
                let part = [k as f64 / parts as f64, (k + 1) as f64 / parts as f64];
                let value = signal.range(self.random, &point, path, part);
                all = Some(all.map_or(value, |a| a.hull(value)));
            }
        }
        all.unwrap_or(Interval::ANY)
    }

    /// Whether data at a germ differ from those at the points, whose signals are in `seen`.
    pub(super) fn differ(&self, seen: &[Option<Interval>], germ: &[f64]) -> bool {
        self.signals.iter().zip(seen).any(|(signal, seen)| {
            seen.is_some_and(|seen| {
                let value = self.at(signal, germ);
                value.low < seen.low || value.high > seen.high
            })
        })
    }

    /// Looks for data in a box that differ from those at the points.
    pub(super) fn open(&self, seen: &[Option<Interval>], ends: &[[f64; 2]], variables: &[Variable]) -> Open {
        let mut open = Open::default();
        for (signal, seen) in self.signals.iter().zip(seen) {
            if let Some(seen) = seen {
                let (found, undecided) = self.search(signal, *seen, ends, variables);
                open.found.extend(found);
                // values that vary a lot are no kinks
                open.undecided += if signal.is_switch() { undecided } else { 0.0 };
            }
        }
        open.undecided = open.undecided.min(1.0);
        open
    }

    fn search(
        &self,
        signal: &Signal,
        seen: Interval,
        ends: &[[f64; 2]],
        variables: &[Variable],
    ) -> (Option<Overlooked>, f64) {
        let whole: Vec<f64> = ends.iter().zip(variables).map(|(&e, v)| v.probability(e)).collect();
        let share = |germs: &[[f64; 2]]| -> f64 {
            signal.germs.iter().map(|&d| variables[d].probability(germs[d]) / whole[d]).product()
        };
        let mut parts: VecDeque<Part> =
            (0..signal.paths.len()).map(|path| Part { germs: ends.to_vec(), path, part: [0.0, 1.0] }).collect();
        let (mut looked, mut undecided, mut beyond) = (0, 0.0, 0.0);
        let mut hull: Option<Vec<[f64; 2]>> = None;
        let mut largest: Option<(f64, Vec<f64>)> = None;
        while let Some(Part { germs, path, part }) = parts.pop_front() {
            let value = signal.range(self.random, &germs, path, part);
            if seen.low <= value.low && value.high <= seen.high {
                continue;
            }
            looked += 1;
            let probability = share(&germs);
            if value.high < seen.low || value.low > seen.high {
                beyond += probability;
                let middle = germs.iter().map(|[a, b]| a + 0.5 * (b - a)).collect();
                if largest.as_ref().is_none_or(|l| probability > l.0) {
                    largest = Some((probability, middle));
                }
                let both = hull.get_or_insert_with(|| germs.clone());
                both.iter_mut().zip(&germs).for_each(|(h, g)| *h = [h[0].min(g[0]), h[1].max(g[1])]);
            } else if looked > BOXES || probability < SMALLEST {
                undecided += probability;
            } else {
                parts.extend(halves(signal, Part { germs, path, part }, ends));
            }
        }
        let found = largest.zip(hull).map(|((_, germ), hull)| Overlooked {
            germ,
            share: (beyond + undecided).min(1.0),
            cut: cut(&hull, ends, variables),
        });
        (found, undecided)
    }
}

/// Both halves in the direction that is longest, as part of the cell or of the path.
fn halves(signal: &Signal, whole: Part, ends: &[[f64; 2]]) -> [Part; 2] {
    let longest = signal
        .germs
        .iter()
        .map(|&d| (d, (whole.germs[d][1] - whole.germs[d][0]) / (ends[d][1] - ends[d][0])))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    let [a, b] = whole.part;
    let [start, end] = signal.paths[whole.path];
    let copy = Part { germs: whole.germs.clone(), ..whole };
    let mut both = [whole, copy];
    match longest {
        Some((d, length)) if start == end || length >= b - a => {
            let [low, high] = both[0].germs[d];
            let middle = low + 0.5 * (high - low);
            (both[0].germs[d][1], both[1].germs[d][0]) = (middle, middle);
        }
        _ => (both[0].part[1], both[1].part[0]) = (0.5 * (a + b), 0.5 * (a + b)),
    }
    both
}

/// The direction in which a box is the smallest part of the cell, and the end of it to split at.
fn cut(hull: &[[f64; 2]], ends: &[[f64; 2]], variables: &[Variable]) -> Option<(usize, f64)> {
    let share = |d: usize| variables[d].probability(hull[d]) / variables[d].probability(ends[d]);
    let inside = |d: usize| hull[d].into_iter().find(|&h| ends[d][0] < h && h < ends[d][1]);
    let cuts = (0..hull.len()).filter_map(|d| inside(d).map(|at| (d, at)));
    cuts.min_by(|a, b| share(a.0).total_cmp(&share(b.0)))
}

/// Splits the cells of a mesh at the cuts of each germ.
pub(super) fn split_at_cuts(
    mesh: &mut StochasticMesh,
    cuts: Vec<Vec<f64>>,
) -> Result<(), steklov_stochastic::StochasticError> {
    for (direction, cuts) in cuts.into_iter().enumerate() {
        for at in cuts {
            for cell in 0..mesh.cells.len() {
                let [a, b] = mesh.cells[cell].bounds[direction];
                if a < at && at < b {
                    mesh.split(cell, direction, at)?;
                }
            }
        }
    }
    Ok(())
}

/// Number of intervals of a germ with this many elements, after the cuts.
pub fn intervals(variable: &Variable, cuts: &[f64], elements: usize) -> usize {
    let is_end = |cut: f64| (1..elements).any(|k| variable.quantile(k as f64 / elements as f64) == cut);
    elements + cuts.iter().filter(|&&cut| !is_end(cut)).count()
}
