//! All pairs of elements in blocks of rows: which there are, and their moments.

use rayon::prelude::*;

use crate::columns::Local;
use crate::far::{Batch, Classifier, KINDS, LANES, flush, kind_index};
use crate::kernel::Constants;
use crate::moments::{Segment, first_is_outer, same, storage};
use crate::near;
use crate::{Material, Mesh, Space};

/// Doubles that the moments of one block of pairs may take: 32 MiB.
const BLOCK_STORAGE: usize = 1 << 22;
/// Pairs that one task computes, so that batches fill up.
const TASK_PAIRS: usize = 1024;

/// The moments of the pairs (a, b), a in `rows`, b ≥ a; those of row a start at `base[a - rows.start]`.
pub(crate) struct Block<'a> {
    pub(crate) rows: std::ops::Range<usize>,
    pub(crate) base: Vec<usize>,
    pub(crate) moments: &'a [f64],
}

/// A mesh as the assembly sees it.
pub(crate) struct Pass<'a> {
    pub(crate) space: &'a Space,
    pub(crate) segments: Vec<Segment>,
    pub(crate) degree: Vec<usize>,
    pub(crate) previous: Vec<usize>,
    /// log(|d|/L) of each element.
    pub(crate) log_half: Vec<f64>,
    /// Σ (p+1) over the elements before e.
    pub(crate) prefix: Vec<usize>,
    /// Position of each degree in `locals`, and the classifiers by it.
    pub(crate) local_of: Vec<usize>,
    pub(crate) locals: Vec<Local>,
    pub(crate) classifiers: Vec<Classifier>,
    pub(crate) constants: Constants,
}

impl<'a> Pass<'a> {
    pub(crate) fn new(mesh: &Mesh, space: &'a Space, material: &Material, length: f64) -> Self {
        let segments: Vec<Segment> = (0..mesh.len()).map(|e| mesh.segment(e)).collect();
        let log_half = segments.iter().map(|s| (s.half().norm() / length).ln()).collect();
        let degree = mesh.degree.clone();
        let mut prefix = vec![0];
        let mut degrees = degree.clone();
        degrees.sort_unstable();
        degrees.dedup();
        for &p in &degree {
            prefix.push(prefix[prefix.len() - 1] + p + 1);
        }
        let local_of = degree.iter().map(|p| degrees.binary_search(p).unwrap_or(0)).collect();
        let first_with = |p: usize| degree.iter().position(|&q| q == p).unwrap_or(0);
        let locals = degrees.iter().map(|&p| Local::new(space, first_with(p))).collect();
        let classifiers = degrees.iter().map(|&p| Classifier::new(p + 1)).collect();
        let previous = mesh.previous();
        let constants = Constants::new(material);
        Self { space, segments, degree, previous, log_half, prefix, local_of, locals, classifiers, constants }
    }

    pub(crate) fn len(&self) -> usize {
        self.segments.len()
    }

    /// Where the moments of the pair (a, b), b ≥ a, start behind those of (a, a).
    pub(crate) fn pair_offset(&self, a: usize, b: usize) -> usize {
        let rows = self.degree[a] + 1;
        (2 * rows + 1) * (self.prefix[b] - self.prefix[a]) + rows * (b - a)
    }

    /// Consecutive ranges of first elements whose pairs fit the buffer.
    pub(crate) fn blocks(&self) -> Vec<std::ops::Range<usize>> {
        let n = self.len();
        let mut blocks = Vec::new();
        let (mut start, mut used) = (0, 0);
        for a in 0..n {
            let size = self.pair_offset(a, n);
            if used > 0 && used + size > BLOCK_STORAGE {
                blocks.push(start..a);
                (start, used) = (a, 0);
            }
            used += size;
        }
        blocks.push(start..n);
        blocks
    }

    /// Moments of all pairs (a, b), a in `rows`, b ≥ a.
    pub(crate) fn moments(&self, rows: std::ops::Range<usize>, buffer: &mut Vec<f64>) {
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
        tasks.into_par_iter().for_each(|task| self.moments_of_rows(task));
    }

    fn moments_of_rows(&self, mut rows: Vec<(usize, &mut [f64])>) {
        let arch = pulp::Arch::new();
        let kinds = self.locals.len();
        let mut open = vec![u32::MAX; kinds * kinds * KINDS];
        let mut batches: Vec<(Batch, [(usize, usize); LANES])> = Vec::new();
        let mut sums = Vec::new();
        for r in 0..rows.len() {
            let a = rows[r].0;
            let pa = self.degree[a];
            same(pa + 1, pa + 1, &mut rows[r].1[..storage(pa, pa)]);
            for b in a + 1..self.len() {
                let start = self.pair_offset(a, b);
                let (outer, inner) = if first_is_outer(self.segments[a], self.segments[b]) { (a, b) } else { (b, a) };
                let (so, si) = (self.segments[outer], self.segments[inner]);
                let touching = self.previous[a] == b || self.previous[b] == a;
                let kind = if touching { None } else { self.classifiers[self.local_of[outer]].kind(so, si) };
                let (m, n) = (self.degree[outer] + 1, self.degree[inner] + 1);
                let Some(kind) = kind else {
                    near::moments(so, si, m, n, &mut rows[r].1[start..start + storage(m - 1, n - 1)]);
                    continue;
                };
                let key = (self.local_of[outer] * kinds + self.local_of[inner]) * KINDS + kind_index(kind);
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
