//! Moments of pairs of elements that outlive their mesh.

use std::collections::HashMap;

use crate::moments::Segment;
use crate::pass::Pass;

/// Doubles that a cache holds at most: 256 MiB.
const CAPACITY: usize = 1 << 25;

/// The moments of all pairs of the mesh before, found by the end points and the order of their elements.
///
/// Moments are a function of these alone, so that a run with a cache has the bits of a run without. A mesh whose moments
/// would fill more than 256 MiB is assembled without.
#[derive(Debug, Clone, Default)]
pub struct PairCache {
    /// Number of the element with these end points and this order.
    elements: HashMap<Key, usize>,
    /// As `Pass::order`, `Pass::prefix` and the base of each row.
    order: Vec<usize>,
    prefix: Vec<usize>,
    base: Vec<usize>,
    moments: Vec<f64>,
    /// Pairs that the last mesh had in common with the one before.
    reused: usize,
}

type Key = ([u64; 4], usize);

fn key(segment: Segment, order: usize) -> Key {
    let Segment { start, end } = segment;
    ([start.re, start.im, end.re, end.im].map(f64::to_bits), order)
}

impl PairCache {
    /// Pairs of the last mesh whose moments were there already.
    pub fn reused(&self) -> usize {
        self.reused
    }

    /// Whether the moments of a mesh fit.
    pub(crate) fn holds(&self, pass: &Pass<'_>) -> bool {
        (0..pass.len()).map(|a| pass.pair_offset(a, pass.len())).sum::<usize>() <= CAPACITY
    }

    /// Replaces the mesh by that of `pass`.
    pub(crate) fn update(&mut self, pass: &Pass<'_>) {
        let keys = || pass.segments.iter().zip(&pass.order).map(|(&s, &order)| key(s, order));
        let old: Vec<Option<usize>> = keys().map(|k| self.elements.get(&k).copied()).collect();
        let known = old.iter().flatten().count();
        self.reused = known * (known + 1) / 2;
        let mut moments = Vec::new();
        pass.moments(0..pass.len(), &mut moments, &|a, b| {
            let (a, b) = (old[a]?, old[b]?);
            // elements of one loop never change places, but be sure of it
            (a <= b).then(|| &self.moments[self.start(a, b)..])
        });
        self.elements = keys().zip(0..).collect();
        self.order.clone_from(&pass.order);
        self.prefix.clone_from(&pass.prefix);
        self.base = pass.pair_base(0..pass.len());
        self.moments = moments;
    }

    /// Moments of all pairs of the last mesh, row by row.
    pub(crate) fn moments(&self) -> &[f64] {
        &self.moments
    }

    fn start(&self, a: usize, b: usize) -> usize {
        let rows = self.order[a] + 1;
        self.base[a] + (2 * rows + 1) * (self.prefix[b] - self.prefix[a]) + rows * (b - a)
    }
}
