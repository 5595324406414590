//! Moments of pairs of elements that outlive their mesh.

use std::collections::HashMap;

use crate::curve::Curve;
use crate::pass::{Pass, Places, Purpose};

/// Largest number of doubles in a cache, 32 MiB; it holds the moments of a mesh and of the mesh before at once. Moments take
/// about as much as half of a matrix, and beyond 2000 unknowns hundreds of times less work than the factorisations.
const CAPACITY: usize = 1 << 22;
/// The same where there are curves, 128 MiB: their moments take up to ten times the work.
const CAPACITY_OF_CURVES: usize = 1 << 24;

/// The moments of all pairs of the mesh before, found by the curve and the order of their elements.
///
/// Moments are a function of these alone, so that a run with a cache has the bits of a run without. A mesh whose moments
/// would fill more than 32 MiB, with curves 128 MiB, is assembled without.
#[derive(Debug, Clone, Default)]
pub struct PairCache {
    /// Number of the element with this curve and this order.
    elements: HashMap<Key, usize>,
    /// As `Pass::places` and the base of each row.
    places: Places,
    base: Vec<usize>,
    moments: Vec<f64>,
    /// Pairs that the last mesh had in common with the one before.
    reused: usize,
}

/// Bits of the end points and of the other parameters of the curve, and the order.
type Key = (Vec<u64>, usize);

fn key(curve: &Curve, order: usize) -> Key {
    let ends = curve.ends();
    let mut numbers = vec![ends.start.re, ends.start.im, ends.end.re, ends.end.im];
    match curve {
        Curve::Line(_) => {}
        Curve::Arc(arc) => numbers.push(arc.half_opening),
        Curve::Polynomial(curve) => numbers.extend(curve.of.middle.iter().flat_map(|a| [a.re, a.im])),
    }
    (numbers.into_iter().map(f64::to_bits).collect(), order)
}

fn keys<'a>(pass: &'a Pass<'_>) -> impl Iterator<Item = Key> + 'a {
    pass.curves.iter().zip(&pass.order).map(|(curve, &order)| key(curve, order))
}

impl PairCache {
    /// Pairs of the last mesh whose moments were there already.
    pub fn reused(&self) -> usize {
        self.reused
    }

    /// The moments of all pairs of the mesh of `pass`, row by row; this mesh replaces the last one. None if the moments would
    /// not fit, or if no enrichment is assembled.
    pub(crate) fn moments(&mut self, pass: &Pass<'_>) -> Option<&[f64]> {
        if !self.holds(pass) {
            *self = Self::default();
            return None;
        }
        let old = self.known(pass);
        if self.elements.len() != pass.len() || old.iter().enumerate().any(|(e, place)| *place != Some(e)) {
            self.replace(pass, &old);
        }
        Some(&self.moments)
    }

    /// Counts the pairs of a mesh whose moments are there.
    pub(crate) fn count(&mut self, pass: &Pass<'_>) {
        let known = self.known(pass).iter().flatten().count();
        self.reused = known * (known + 1) / 2;
    }

    /// Whether the moments of a mesh are to be kept.
    pub(crate) fn holds(&self, pass: &Pass<'_>) -> bool {
        let capacity = if pass.curves.iter().all(Curve::is_line) { CAPACITY } else { CAPACITY_OF_CURVES };
        pass.purpose != Purpose::Plain
            && (0..pass.len()).map(|a| pass.pair_offset(a, pass.len())).sum::<usize>() <= capacity
    }

    /// The number that each element of a mesh has here.
    fn known(&self, pass: &Pass<'_>) -> Vec<Option<usize>> {
        keys(pass).map(|k| self.elements.get(&k).copied()).collect()
    }

    fn replace(&mut self, pass: &Pass<'_>, old: &[Option<usize>]) {
        let mut moments = Vec::new();
        pass.moments(0..pass.len(), &mut moments, &|a, b| {
            let (a, b) = (old[a]?, old[b]?);
            // elements of one loop never change places, but be sure of it
            (a <= b).then(|| &self.moments[self.start(a, b)..])
        });
        self.elements = keys(pass).zip(0..).collect();
        self.places.clone_from(&pass.places);
        self.base = pass.pair_base(0..pass.len());
        self.moments = moments;
    }

    fn start(&self, a: usize, b: usize) -> usize {
        self.base[a] + self.places.offset(a, b)
    }
}
