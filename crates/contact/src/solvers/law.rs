//! The contact law of one node as a proximal map.
//!
//! With v the node's unknowns and R = f - S v the force that the body exerts on it, all conditions of a node read
//!
//! ```text
//! R ∈ ∂φ(v),   φ(v) = Σ_i θ_i(d_i·v - b_i),   θ_i(s) = low_i s for s < 0, high_i s for s > 0
//! ```
//! A normal condition is the kink d = normal, b = gap, low = 0, high = ∞; friction is d = tangent, b = -slip_offset,
//! low = -D F, high = D F. With the diagonal metric C = diag(c) > 0 this is v = prox(v + C⁻¹R), where
//! prox(z) minimises φ(w) + ½ (w-z)ᵀC(w-z). The map is piecewise affine: on each [`Piece`] every kink is below, on or
//! above its line. For an ordinary node it is the minimum with the gap and a soft threshold.
//!
//! Source: Moreau (1965) for proximal maps; Alart and Curnier (1991) for the law as a projection.

use steklov_elastic::plane::{cross, dot, minus, norm, solve2, turned, unit};

use crate::ContactNode;

/// One summand θ(direction·v - at) of φ, in units of nodal force.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kink {
    pub direction: [f64; 2],
    pub at: f64,
    pub low: f64,
    pub high: f64,
}

/// Where v lies with respect to a kink.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Branch {
    /// direction·v < at, force `low`: apart, or slip along -t.
    Below,
    /// direction·v = at, force between `low` and `high`: in contact, or stick.
    On,
    /// direction·v > at, force `high`: slip along +t.
    Above,
}
use Branch::{Above, Below, On};

/// One affine piece of the proximal map: a branch for each kink. The directions of the kinks that are on are
/// linearly independent, also where more lines meet: the others then keep a force at one of their bounds.
pub(crate) type Piece = Vec<Branch>;

/// The law of a node with 1 or 2 unknowns.
#[derive(Debug, Clone)]
pub(crate) struct Law {
    pub unknowns: usize,
    pub kinks: Vec<Kink>,
    /// Condition of each kink, and whether it is the tangential one.
    pub source: Vec<(usize, bool)>,
    /// Diagonal of C (force per length).
    pub metric: [f64; 2],
    pieces: Vec<Piece>,
}

impl Law {
    /// The law of `node` under the pressures of its conditions (0 where there are none). Conditions of weight 0 and
    /// friction without bound and coefficient leave no kink.
    pub fn new(node: &ContactNode, metric: [f64; 2], pressures: &[f64]) -> Self {
        let (mut kinks, mut source) = (Vec::new(), Vec::new());
        for (k, c) in node.conditions.iter().enumerate() {
            if c.normal_weight > 0.0 {
                kinks.push(Kink { direction: c.normal, at: c.gap, low: 0.0, high: f64::INFINITY });
                source.push((k, false));
            }
            if c.tangent_weight > 0.0 && (c.bound > 0.0 || c.is_coulomb()) {
                let high = c.tangent_weight * c.limit(pressures.get(k).map_or(0.0, |p| *p));
                kinks.push(Kink { direction: c.tangent, at: -c.slip_offset, low: -high, high });
                source.push((k, true));
            }
        }
        Self::of_kinks(node.unknowns, kinks, source, metric)
    }

    pub(crate) fn of_kinks(unknowns: usize, kinks: Vec<Kink>, source: Vec<(usize, bool)>, metric: [f64; 2]) -> Self {
        let mut law = Self { unknowns, kinks, source, metric, pieces: Vec::new() };
        law.pieces = law.enumerate();
        law
    }

    /// Changes the friction bounds to those of other pressures.
    pub fn set_limits(&mut self, node: &ContactNode, pressures: &[f64]) {
        for (kink, &(k, _)) in self.kinks.iter_mut().zip(&self.source).filter(|(_, s)| s.1) {
            let c = &node.conditions[k];
            kink.high = c.tangent_weight * c.limit(pressures[k]);
            kink.low = -kink.high;
        }
    }

    /// Largest friction force of a condition; none without friction.
    pub fn limit(&self, condition: usize) -> Option<f64> {
        self.source.iter().position(|s| *s == (condition, true)).map(|i| self.kinks[i].high)
    }

    /// Whether some displacement satisfies all conditions.
    pub fn is_feasible(&self) -> bool {
        // finite friction forbids no displacement, and its forces would blur what is compared with tiny gaps
        let hard: Vec<Kink> = self.kinks.iter().filter(|k| k.high.is_infinite()).copied().collect();
        let scale = hard.iter().fold(0.0f64, |m, k| m.max(k.at.abs() / norm(k.direction)));
        let law = Self::of_kinks(self.unknowns, hard, Vec::new(), self.metric);
        !law.pieces.is_empty() && law.prox([0.0; 2]).2 <= 1e-9 * scale
    }

    /// All pieces: every choice of branches with finite forces off the lines and independent directions on them.
    fn enumerate(&self) -> Vec<Piece> {
        let mut pieces = vec![Vec::new()];
        for kink in &self.kinks {
            let mut longer = Vec::new();
            for piece in &pieces {
                for (branch, allowed) in [(On, true), (Below, kink.low.is_finite()), (Above, kink.high.is_finite())] {
                    if allowed {
                        longer.push([piece.as_slice(), &[branch]].concat());
                    }
                }
            }
            pieces = longer;
        }
        pieces.retain(|piece| match self.on(piece).as_slice() {
            [] | [_] => true,
            &[i, j] => self.independent(i, j),
            _ => false,
        });
        pieces
    }

    /// Indices of the kinks that are on.
    pub fn on(&self, piece: &[Branch]) -> Vec<usize> {
        (0..piece.len()).filter(|&i| piece[i] == On).collect()
    }

    /// Force of the kinks that are off their lines, Σ low d or Σ high d.
    pub fn off_force(&self, piece: &[Branch]) -> [f64; 2] {
        let mut r = [0.0; 2];
        for (kink, branch) in self.kinks.iter().zip(piece) {
            let x = match branch {
                Below => kink.low,
                Above => kink.high,
                On => continue,
            };
            r[0] += x * kink.direction[0];
            r[1] += x * kink.direction[1];
        }
        r
    }

    /// The displacements that `piece` leaves free: a point on its lines (0 in the free directions) and the free unit
    /// directions.
    pub fn free(&self, piece: &[Branch]) -> ([f64; 2], Vec<[f64; 2]>) {
        match self.on(piece).as_slice() {
            [] if self.unknowns == 1 => ([0.0; 2], vec![[1.0, 0.0]]),
            [] => ([0.0; 2], vec![[1.0, 0.0], [0.0, 1.0]]),
            &[i] => {
                let Kink { direction: d, at, .. } = self.kinks[i];
                if self.unknowns == 1 {
                    return ([at / d[0], 0.0], Vec::new());
                }
                let r = norm(d);
                ([at * d[0] / (r * r), at * d[1] / (r * r)], vec![turned(unit(d))])
            }
            &[i, j] => (self.intersection(i, j), Vec::new()),
            _ => unreachable!("a piece has at most two kinks on"),
        }
    }

    fn intersection(&self, i: usize, j: usize) -> [f64; 2] {
        let (a, b) = (self.kinks[i], self.kinks[j]);
        solve2([a.direction, b.direction], [a.at, b.at])
    }

    /// Force of each kink under `piece` when the whole nodal force is R: the bounds off the lines, and on them the
    /// solution of Σ x_i d_i = R (its part along d for one line).
    pub fn forces(&self, piece: &[Branch], r: [f64; 2]) -> Vec<f64> {
        let off = self.off_force(piece);
        let rest = minus(r, off);
        let mut x: Vec<f64> =
            (self.kinks.iter().zip(piece)).map(|(k, b)| if *b == Below { k.low } else { k.high }).collect();
        match self.on(piece).as_slice() {
            [] => {}
            &[i] => {
                let d = self.kinks[i].direction;
                x[i] = dot(d, rest) / dot(d, d);
            }
            &[i, j] => {
                let (a, b) = (self.kinks[i].direction, self.kinks[j].direction);
                x[i] = cross(rest, b) / cross(a, b);
                x[j] = cross(a, rest) / cross(a, b);
            }
            _ => unreachable!("a piece has at most two kinks on"),
        }
        x
    }

    /// How far (v, R) is from `piece`: the largest wrong-sided distance of a kink that is off (length) and the largest
    /// force out of bounds of a kink that is on (force).
    pub fn violation(&self, piece: &[Branch], v: [f64; 2], r: [f64; 2]) -> (f64, f64) {
        let forces = self.forces(piece, r);
        let (mut length, mut force) = (0.0f64, 0.0f64);
        for ((kink, branch), x) in self.kinks.iter().zip(piece).zip(forces) {
            let distance = (dot(kink.direction, v) - kink.at) / norm(kink.direction);
            match branch {
                Below => length = length.max(distance),
                Above => length = length.max(-distance),
                On => force = force.max(x - kink.high).max(kink.low - x),
            }
        }
        (length, force)
    }

    /// Whether `piece` is one of the law's: finite forces off the lines and independent directions on them.
    pub fn allows(&self, piece: &Piece) -> bool {
        self.pieces.contains(piece)
    }

    /// Whether the lines of kinks i and j meet in one point.
    fn independent(&self, i: usize, j: usize) -> bool {
        let (a, b) = (self.kinks[i].direction, self.kinks[j].direction);
        self.unknowns == 2 && cross(a, b).abs() > 1e-12 * norm(a) * norm(b)
    }

    /// The lines, in their order, on which a piece may be: all except those that depend on earlier ones.
    pub fn basis(&self, lines: impl Iterator<Item = usize>) -> Vec<usize> {
        let mut basis: Vec<usize> = Vec::new();
        for i in lines {
            match basis.as_slice() {
                [] => basis.push(i),
                &[j] if self.independent(i, j) => basis.push(i),
                _ => {}
            }
        }
        basis
    }

    /// `target`, except that a kink which would pass from one side of its line to the other stays on the line, if that is a
    /// piece.
    pub fn towards(&self, piece: &[Branch], target: &Piece) -> Piece {
        let passes = |(a, b): (&Branch, &Branch)| if *a != *b && *a != On && *b != On { On } else { *b };
        let halfway: Piece = piece.iter().zip(target).map(passes).collect();
        if self.allows(&halfway) { halfway } else { target.clone() }
    }

    /// The neighbouring piece across the last line that (v, R) violates: a kink that is off goes on, one that is on
    /// goes off to the side of its force. None if that would put too many lines on.
    pub fn neighbour(&self, piece: &[Branch], v: [f64; 2], r: [f64; 2]) -> Option<Piece> {
        let forces = self.forces(piece, r);
        let moves = |i: usize| {
            let (kink, x) = (self.kinks[i], forces[i]);
            let distance = dot(kink.direction, v) - kink.at;
            match piece[i] {
                Below => (distance > 0.0).then_some(On),
                Above => (distance < 0.0).then_some(On),
                On if x > kink.high => Some(Above),
                On if x < kink.low => Some(Below),
                On => None,
            }
        };
        let (i, branch) = (0..piece.len()).rev().find_map(|i| Some((i, moves(i)?)))?;
        let mut next = piece.to_vec();
        next[i] = branch;
        self.allows(&next).then_some(next)
    }

    /// The value w of the affine map of `piece` at z.
    fn apply(&self, piece: &[Branch], z: [f64; 2]) -> [f64; 2] {
        let (c, off) = (self.metric, self.off_force(piece));
        let y = [z[0] - off[0] / c[0], z[1] - off[1] / c[1]];
        match self.on(piece).as_slice() {
            [] => y,
            &[i] => {
                let Kink { direction: d, at, .. } = self.kinks[i];
                let x = (dot(d, y) - at) / (d[0] * d[0] / c[0] + d[1] * d[1] / c[1]);
                [y[0] - x * d[0] / c[0], y[1] - x * d[1] / c[1]]
            }
            &[i, j] => self.intersection(i, j),
            _ => unreachable!("a piece has at most two kinks on"),
        }
    }

    /// prox(z) and the piece on which z lies, and by how much (a length) that piece is missed: roundoff, unless no
    /// displacement satisfies all conditions.
    pub fn prox(&self, z: [f64; 2]) -> ([f64; 2], &Piece, f64) {
        let c = self.metric;
        let mut best: Option<([f64; 2], &Piece, f64)> = None;
        for piece in &self.pieces {
            let w = self.apply(piece, z);
            let force = [c[0] * (z[0] - w[0]), c[1] * (z[1] - w[1])];
            let (length, excess) = self.violation(piece, w, force);
            let missed = length.max(excess / c[0].max(c[1]));
            if best.as_ref().is_none_or(|b| missed < b.2) {
                best = Some((w, piece, missed));
            }
        }
        best.expect("the law of a node has at least one piece, and z is finite")
    }

    /// Derivative C P C⁻¹ of C prox(C⁻¹ ·) on `piece`: P is the C-orthogonal projection on the free directions.
    pub fn derivative(&self, piece: &[Branch]) -> [[f64; 2]; 2] {
        let c = self.metric;
        match self.on(piece).as_slice() {
            [] => [[1.0, 0.0], [0.0, 1.0]],
            &[i] => {
                let d = self.kinks[i].direction;
                let s = d[0] * d[0] / c[0] + d[1] * d[1] / c[1];
                [
                    [1.0 - d[0] * d[0] / (s * c[0]), -d[0] * d[1] / (s * c[1])],
                    [-d[0] * d[1] / (s * c[0]), 1.0 - d[1] * d[1] / (s * c[1])],
                ]
            }
            _ => [[0.0; 2]; 2],
        }
    }

    /// The piece with as much as possible on: full stick first, then contact, then friction.
    pub fn closed(&self) -> &Piece {
        let rank = |piece: &Piece| {
            let count = |pick: fn(&Kink) -> bool| self.on(piece).iter().filter(|&&i| pick(&self.kinks[i])).count();
            let sided = |i: usize| {
                let (v, _) = self.free(piece);
                let s = dot(self.kinks[i].direction, v) - self.kinks[i].at;
                piece[i] == On || (s <= 0.0) == (piece[i] == Below)
            };
            let right = (0..piece.len()).filter(|&i| sided(i)).count();
            (self.on(piece).len(), count(|k| k.low.is_infinite()), count(|k| k.high.is_infinite()), right)
        };
        self.pieces.iter().max_by_key(|piece| rank(piece)).expect("the law of a node has at least one piece")
    }
}
