//! All pairs of elements in blocks of rows, and their moments.

use rayon::prelude::*;
use steklov_elastic::Material;

use crate::curve::Curve;
use crate::curved_pair;
use crate::far::{Batch, Classifier, KINDS, flush, kind_index};
use crate::far_curved::{FarCurved, Reach};
use crate::kernel::Constants;
use crate::local_functions::Local;
use crate::moments::{LANES, Segment, first_is_outer, same, storage};
use crate::near;
use crate::{Mesh, Space};

/// Largest number of doubles for the moments of one block of pairs: 8 MiB.
const BLOCK_STORAGE: usize = 1 << 20;
/// Pairs that one task computes, so that batches fill up.
const TASK_PAIRS: usize = 1024;

/// The moments of the pairs (a, b), a in `rows`, b ≥ a; those of row a start at `base[a - rows.start]`.
pub(crate) struct Block<'a> {
    pub(crate) rows: std::ops::Range<usize>,
    pub(crate) base: Vec<usize>,
    pub(crate) moments: &'a [f64],
}

/// What a pass fills.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// V, K, W.
    Plain,
    /// V, K, W of a space that is to be enriched, from the moments of its enrichment.
    Base,
    /// Bubbles and top tractions.
    Extra,
}

/// A mesh as the assembly sees it.
pub(crate) struct Pass<'a> {
    pub(crate) space: &'a Space,
    pub(crate) segments: Vec<Segment>,
    pub(crate) curves: Vec<Curve>,
    /// How near other elements may come to each; empty if all elements are straight.
    reach: Vec<Reach>,
    /// Half of the length of each element.
    pub(crate) half: Vec<f64>,
    /// log L.
    pub(crate) log_length: f64,
    /// Degree p of each element.
    pub(crate) degree: Vec<usize>,
    /// Highest degree of the moments of each element, at least p, or p + 1 for an enrichment.
    pub(crate) order: Vec<usize>,
    pub(crate) purpose: Purpose,
    /// Degrees of the tables beyond those of each element: 1 for a bubble and a top traction.
    pub(crate) more: usize,
    pub(crate) previous: Vec<usize>,
    /// log(|d|/L) of each element.
    pub(crate) log_half: Vec<f64>,
    pub(crate) places: Places,
    /// Position of each degree in `locals`.
    pub(crate) local_of: Vec<usize>,
    pub(crate) locals: Vec<Local>,
    /// Position of each order in `classifiers`.
    order_of: Vec<usize>,
    classifiers: Vec<Classifier>,
    pub(crate) constants: Constants,
}

impl<'a> Pass<'a> {
    pub(crate) fn new(mesh: &Mesh, space: &'a Space, material: &Material, length: f64, purpose: Purpose) -> Self {
        let segments: Vec<Segment> = (0..mesh.len()).map(|e| mesh.segment(e)).collect();
        let log_half = segments.iter().map(|s| (s.half().norm() / length).ln()).collect();
        let degree = mesh.degree.clone();
        let plain = purpose == Purpose::Plain;
        let order: Vec<usize> = degree.iter().map(|&p| if plain { p } else { enriched_order(p) }).collect();
        let curves: Vec<Curve> = (0..mesh.len()).map(|e| mesh.curve(e)).collect();
        let reach = match curves.iter().all(Curve::is_line) {
            true => Vec::new(),
            false => curves.par_iter().zip(&order).map(|(curve, p)| Reach::new(curve.clone(), p + 1)).collect(),
        };
        let half = curves.iter().map(Curve::half_length).collect();
        let places = Places::new(&order, curves.iter().map(Curve::is_line));
        let (degrees, local_of) = distinct(&degree);
        let (orders, order_of) = distinct(&order);
        let first_with = |p: usize| degree.iter().position(|&q| q == p).unwrap_or(0);
        let extra = purpose == Purpose::Extra;
        let locals = degrees.iter().map(|&p| Local::new(space, first_with(p), extra)).collect();
        let classifiers = orders.iter().map(|&p| Classifier::new(p + 1)).collect();
        let previous = mesh.previous();
        let constants = Constants::new(material);
        Self {
            space,
            segments,
            curves,
            reach,
            half,
            log_length: length.ln(),
            degree,
            order,
            purpose,
            more: usize::from(extra),
            previous,
            log_half,
            places,
            local_of,
            locals,
            order_of,
            classifiers,
            constants,
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.segments.len()
    }

    /// Where the moments of the pair (a, b), b ≥ a, start behind those of (a, a).
    pub(crate) fn pair_offset(&self, a: usize, b: usize) -> usize {
        self.places.offset(a, b)
    }

    /// Whether both elements of a pair are straight.
    pub(crate) fn is_straight(&self, a: usize, b: usize) -> bool {
        self.curves[a].is_line() && self.curves[b].is_line()
    }

    /// Length of the moments of a pair.
    pub(crate) fn pair_size(&self, a: usize, b: usize) -> usize {
        self.places.offset(a, b + 1) - self.places.offset(a, b)
    }

    /// Consecutive ranges of first elements whose pairs fit the buffer, and the doubles that the largest of them takes.
    pub(crate) fn blocks(&self) -> (Vec<std::ops::Range<usize>>, usize) {
        let n = self.len();
        let mut blocks = Vec::new();
        let (mut start, mut used, mut largest) = (0, 0, 0);
        for a in 0..n {
            let size = self.pair_offset(a, n);
            if used > 0 && used + size > BLOCK_STORAGE {
                blocks.push(start..a);
                (start, used) = (a, 0);
            }
            used += size;
            largest = largest.max(used);
        }
        blocks.push(start..n);
        (blocks, largest)
    }

    /// Moments of all pairs (a, b), a in `rows`, b ≥ a; `known` gives those that need not be computed.
    pub(crate) fn moments<'k>(
        &self,
        rows: std::ops::Range<usize>,
        buffer: &mut Vec<f64>,
        known: &(dyn Fn(usize, usize) -> Option<&'k [f64]> + Sync),
    ) {
        let n = self.len();
        buffer.resize(rows.clone().map(|a| self.pair_offset(a, n)).sum(), 0.0);
        let mut tasks: Vec<Vec<(usize, &mut [f64])>> = vec![Vec::new()];
        let (mut rest, mut pairs) = (&mut buffer[..], 0);
        for a in rows {
            let (row, tail) = rest.split_at_mut(self.pair_offset(a, n));
            rest = tail;
            if pairs >= TASK_PAIRS {
                tasks.push(Vec::new());
                pairs = 0;
            }
            pairs += n - a;
            let last = tasks.len() - 1;
            tasks[last].push((a, row));
        }
        tasks.into_par_iter().for_each(|task| self.moments_of_rows(task, known));
    }

    fn moments_of_rows<'k>(
        &self,
        mut rows: Vec<(usize, &mut [f64])>,
        known: &(dyn Fn(usize, usize) -> Option<&'k [f64]> + Sync),
    ) {
        let arch = pulp::Arch::new();
        let kinds = self.classifiers.len();
        let mut open = vec![u32::MAX; kinds * kinds * KINDS];
        let mut batches: Vec<(Batch, [(usize, usize); LANES])> = Vec::new();
        let mut sums = Vec::new();
        for r in 0..rows.len() {
            let a = rows[r].0;
            let pa = self.order[a];
            let row = &mut rows[r].1[..self.pair_size(a, a)];
            match self.curves[a].is_line() {
                true => same(pa + 1, pa + 1, row),
                false => curved_pair::own(&self.curves[a], pa + 1, row),
            }
            for b in a + 1..self.len() {
                let start = self.pair_offset(a, b);
                if let Some(moments) = known(a, b) {
                    let size = self.pair_size(a, b);
                    rows[r].1[start..start + size].copy_from_slice(&moments[..size]);
                    continue;
                }
                if !self.is_straight(a, b) {
                    let (m, n) = (self.order[a] + 1, self.order[b] + 1);
                    let out = &mut rows[r].1[start..start + curved_pair::storage(m, n)];
                    if !arch.dispatch(FarCurved {
                        first: &self.reach[a],
                        second: &self.reach[b],
                        rows: m,
                        cols: n,
                        out,
                    }) {
                        curved_pair::moments(&self.curves[a], &self.curves[b], m, n, out);
                    }
                    continue;
                }
                let (outer, inner) = if first_is_outer(self.segments[a], self.segments[b]) { (a, b) } else { (b, a) };
                let (so, si) = (self.segments[outer], self.segments[inner]);
                let touching = self.previous[a] == b || self.previous[b] == a;
                let kind = if touching { None } else { self.classifiers[self.order_of[outer]].kind(so, si) };
                let (m, n) = (self.order[outer] + 1, self.order[inner] + 1);
                let Some(kind) = kind else {
                    near::moments(so, si, m, n, &mut rows[r].1[start..start + storage(m - 1, n - 1)]);
                    continue;
                };
                let key = (self.order_of[outer] * kinds + self.order_of[inner]) * KINDS + kind_index(kind);
                if open[key] == u32::MAX {
                    open[key] = batches.len() as u32;
                    batches.push((Batch::new(kind, m, n), [(0, 0); LANES]));
                }
                let (batch, places) = &mut batches[open[key] as usize];
                places[batch.len()] = (r, start);
                if batch.push(so, si) {
                    flush(arch, batch, places, &mut sums, |(r, start): (usize, usize), batch, lane, sums| {
                        batch.extract(sums, lane, &mut rows[r].1[start..]);
                    });
                }
            }
        }
        for (batch, places) in &mut batches {
            flush(arch, batch, places, &mut sums, |(r, start): (usize, usize), batch, lane, sums| {
                batch.extract(sums, lane, &mut rows[r].1[start..]);
            });
        }
    }

    /// Start of each row's moments in a block's buffer.
    pub(crate) fn pair_base(&self, rows: std::ops::Range<usize>) -> Vec<usize> {
        let mut base = Vec::with_capacity(rows.len());
        let mut start = 0;
        for a in rows {
            base.push(start);
            start += self.pair_offset(a, self.len());
        }
        base
    }
}

/// Where the moments of each pair lie: those of two straight elements are one complex table, with a curve there are five real ones.
#[derive(Debug, Clone, Default)]
pub(crate) struct Places {
    rows: Vec<usize>,
    straight: Vec<bool>,
    /// Σ (order+1) over the straight elements before e, their number, and the sum over the curved ones.
    before: Vec<[usize; 3]>,
}

impl Places {
    fn new(order: &[usize], straight: impl Iterator<Item = bool>) -> Self {
        let rows: Vec<usize> = order.iter().map(|p| p + 1).collect();
        let straight: Vec<bool> = straight.collect();
        let mut before = vec![[0; 3]];
        for (&rows, &straight) in rows.iter().zip(&straight) {
            let [lines, count, curves] = before[before.len() - 1];
            before.push(if straight { [lines + rows, count + 1, curves] } else { [lines, count, curves + rows] });
        }
        Self { rows, straight, before }
    }

    /// Where the moments of the pair (a, b), b ≥ a, start behind those of (a, a).
    pub(crate) fn offset(&self, a: usize, b: usize) -> usize {
        let rows = self.rows[a];
        let [lines, count, curves] = [0, 1, 2].map(|k| self.before[b][k] - self.before[a][k]);
        let tables = curved_pair::storage(rows, 1);
        match self.straight[a] {
            true => (2 * rows + 1) * lines + rows * count + tables * curves,
            false => tables * (lines + curves),
        }
    }
}

/// The orders of moments are even, so that every second rise of a degree keeps the moments.
pub(crate) fn enriched_order(degree: usize) -> usize {
    (degree + 1).next_multiple_of(2)
}

/// The distinct values, rising, and the position of each value among them.
fn distinct(values: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let mut sorted = values.to_vec();
    sorted.sort_unstable();
    sorted.dedup();
    let position = values.iter().map(|v| sorted.binary_search(v).unwrap_or(0)).collect();
    (sorted, position)
}
