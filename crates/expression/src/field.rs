//! Random fields on a side or over the body, as expressions use them.

use std::sync::Arc;

use steklov_bem_operators::{Edge, Polygon};
use steklov_elastic::plane::{dot, minus, norm};
use steklov_stochastic::{Covariance, Field, StochasticError, Truncation};

use crate::{Enclosure, Interval};

/// A field and where it lives.
#[derive(Debug, Clone)]
pub struct RandomField {
    /// Its name in expressions.
    pub name: String,
    /// Its Karhunen-Loève expansion.
    pub expansion: Field,
    /// What its coordinates are.
    pub support: Support,
}

/// Domain of a field.
#[derive(Debug, Clone, PartialEq)]
pub enum Support {
    /// A side that is one open chain: the coordinate is the arc length along it.
    Side {
        /// Name of the side.
        name: String,
        /// Its edges from one end to the other, in the order in which the corners of their loop are listed.
        edges: Vec<Edge>,
    },
    /// The bounding box of the body: coordinates from its lower left.
    Body {
        /// Lower left.
        corner: [f64; 2],
        /// Lengths along x and y.
        lengths: [f64; 2],
    },
}

/// Why a side is not one open chain of edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoChain {
    /// Its edges do not all meet end to end.
    #[error("consists of {0} parts that do not meet")]
    Parts(usize),
    /// It has no ends.
    #[error("is a closed loop")]
    Closed,
}

impl Support {
    /// The side of this name.
    ///
    /// # Errors
    /// [`NoChain`] for a side on which one arc length would jump, or would part places that meet.
    pub fn side(polygon: &Polygon, name: &str) -> Result<Self, NoChain> {
        let edges = polygon.edges();
        let is_on = |k: usize| polygon.side_names()[edges[k].side] == name;
        let mut chains = Vec::new();
        for range in polygon.loops() {
            let count = range.len();
            let place = |k: usize| range.start + k % count;
            if range.clone().all(is_on) {
                chains.push(Err(NoChain::Closed));
                continue;
            }
            for first in (0..count).filter(|&k| is_on(place(k)) && !is_on(place(k + count - 1))) {
                let chain = (first..).map(place).take_while(|&k| is_on(k));
                chains.push(Ok(chain.map(|k| edges[k].clone()).collect()));
            }
        }
        match chains.len() {
            1 => Ok(Self::Side { name: name.to_owned(), edges: chains.remove(0)? }),
            parts => Err(NoChain::Parts(parts)),
        }
    }

    /// The bounding box of a body.
    pub fn body(polygon: &Polygon) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in polygon.edges().iter().flat_map(Edge::extent) {
            for i in 0..2 {
                (low[i], high[i]) = (low[i].min(point[i]), high[i].max(point[i]));
            }
        }
        Self::Body { corner: low, lengths: minus(high, low) }
    }

    /// The expansion of a field that lives here.
    ///
    /// # Errors
    /// Those of [`Field::interval`] and [`Field::rectangle`].
    pub fn expansion(&self, covariance: &Covariance, truncation: Truncation) -> Result<Field, StochasticError> {
        match self {
            Self::Side { edges, .. } => {
                let length = edges.iter().map(Edge::length).sum();
                Field::interval(covariance, length, truncation)
            }
            Self::Body { lengths, .. } => Field::rectangle(covariance, *lengths, truncation),
        }
    }

    fn is_curved(&self) -> bool {
        matches!(self, Self::Side { edges, .. } if !edges.iter().all(Edge::is_line))
    }

    /// Coordinates of a point; for a point beside the side those of the nearest one on it.
    pub fn coordinates(&self, point: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Body { corner, .. } => minus(point, *corner),
            Self::Side { edges, .. } => {
                let (mut start, mut nearest, mut arc) = (0.0, f64::INFINITY, 0.0);
                for edge in edges {
                    if !edge.is_line() {
                        let length = edge.length();
                        if let Some((off, s)) = edge.nearest(point, nearest).filter(|found| found.0 < nearest) {
                            (nearest, arc) = (off, start + edge.arc_fraction(s) * length);
                        }
                        start += length;
                        continue;
                    }
                    let [a, b] = edge.listed();
                    let (d, to) = (minus(b, a), minus(point, a));
                    let length = norm(d);
                    let t = (dot(to, d) / (length * length)).clamp(0.0, 1.0);
                    let off = (to[0] - t * d[0]).hypot(to[1] - t * d[1]);
                    if off < nearest {
                        (nearest, arc) = (off, start + t * length);
                    }
                    start += length;
                }
                [arc, 0.0]
            }
        }
    }
}

impl RandomField {
    /// Encloses the values for germs in a box over a box of places.
    pub fn range(&self, germs: &[[f64; 2]], x: Enclosure, y: Enclosure) -> Enclosure {
        let middle = |range: Enclosure| range.value.low + range.value.width() / 2.0;
        if self.expansion.is_drawn() {
            return self.drawn_range(germs[0]);
        }
        let modes = self.expansion.modes(self.support.coordinates([middle(x), middle(y)]));
        // a curve that turns by no more than 180° in the box is at most π/2 times as long as its chord
        let longer = if self.support.is_curved() { std::f64::consts::FRAC_PI_2 } else { 1.0 };
        let reach = (x.value.width() + y.value.width()) / 2.0 * longer;
        let (mut value, mut off) = (0.0, 0.0);
        for ((mode, steepness), [a, b]) in modes.iter().zip(self.expansion.steepness()).zip(germs) {
            value += mode * 0.5 * (a + b);
            off += mode.abs() * 0.5 * (b - a) + times(*steepness, reach * a.abs().max(b.abs()));
        }
        Enclosure::fixed(Interval::new(value - off, value + off))
    }

    /// The values of a field that is drawn for germs of an interval: 0 for the germ 0, else any.
    fn drawn_range(&self, [a, b]: [f64; 2]) -> Enclosure {
        let off = if a == 0.0 && b == 0.0 { 0.0 } else { f64::INFINITY };
        Enclosure::fixed(Interval::new(-off, off))
    }
}

/// A steepness, infinite for values that jump, times a reach: nothing changes over a reach of 0.
fn times(steepness: f64, reach: f64) -> f64 {
    if reach == 0.0 { 0.0 } else { steepness * reach }
}

/// One outcome of a field; without a field the mean outcome, 0.
#[derive(Debug, Clone, Default)]
pub struct FieldValue {
    outcome: Option<(Arc<RandomField>, Vec<f64>)>,
    /// Its values in all cells, if it is one of cells.
    in_cells: Vec<f64>,
}

impl FieldValue {
    /// The outcome for the germs of the field's modes.
    pub fn new(field: Arc<RandomField>, germs: Vec<f64>) -> Self {
        let in_cells = field.expansion.cell_values(&germs).unwrap_or_default();
        Self { outcome: Some((field, germs)), in_cells }
    }

    /// Value at a point.
    pub fn value(&self, point: [f64; 2]) -> f64 {
        let Some((field, germs)) = &self.outcome else { return 0.0 };
        let place = field.support.coordinates(point);
        match field.expansion.cells() {
            Some(cells) => self.in_cells[cells.containing(place)],
            None => field.expansion.value(place, germs),
        }
    }

    /// Enclosures over a box: the value in its middle, and what it may change by up to the ends.
    ///
    /// Modes are as smooth as their number of half waves lets them be: their steepness is that of samples, not a bound.
    pub fn range(&self, x: Enclosure, y: Enclosure) -> Enclosure {
        let Some((field, germs)) = &self.outcome else { return Enclosure::fixed(Interval::point(0.0)) };
        let middle = |range: Enclosure| range.value.low + range.value.width() / 2.0;
        let value = self.value([middle(x), middle(y)]);
        let steepest: f64 = field.expansion.steepness().iter().zip(germs).map(|(s, g)| times(*s, g.abs())).sum();
        let off = times(steepest, (x.value.width() + y.value.width()) / 2.0);
        let slope = times(steepest, x.slope.magnitude() + y.slope.magnitude());
        Enclosure { value: Interval::new(value - off, value + off), slope: Interval::new(-slope, slope) }
    }
}

#[cfg(test)]
mod tests {
    use steklov_bem_operators::Loop;
    use steklov_elastic::plane::distance;

    use super::*;

    /// A slab with a square hole, its corners counter-clockwise or not; a letter names the side of each edge.
    fn slab(outer: &str, hole: &str, reversed: bool) -> Polygon {
        let sides = |letters: &str| letters.chars().map(String::from).collect();
        let corners = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]];
        let mut inner = vec![[1.0, 1.0], [1.0, 2.0], [2.0, 2.0], [2.0, 1.0]];
        if reversed {
            inner.reverse();
        }
        let hole = Loop::straight(inner, sides(hole));
        Polygon::new(Loop::straight(corners, sides(outer)), vec![hole]).unwrap()
    }

    /// Along a chain the arc length rises as fast as the point moves, wherever on the loop the chain begins.
    #[test]
    fn arc_length_is_continuous_along_a_side() {
        for (outer, hole, reversed, start, expected) in [
            ("abcd", "efgh", false, 0, 4.0),
            ("xbcx", "efgh", false, 3, 7.0),
            ("xbxx", "efgh", false, 2, 11.0),
            ("xxxd", "efgh", true, 0, 11.0),
            ("abcd", "xfgx", false, 7, 2.0),
            ("abcd", "xxgx", true, 7, 3.0),
        ] {
            let polygon = slab(outer, hole, reversed);
            let name = if outer.contains('x') || hole.contains('x') { "x" } else { "a" };
            let support = Support::side(&polygon, name).unwrap();
            let Support::Side { edges, .. } = &support else { panic!("{support:?}") };
            assert_eq!(edges[0], polygon.edges()[start], "{outer} {hole}");
            let mut along = 0.0;
            for [a, b] in edges.iter().map(Edge::listed) {
                let length = distance(b, a);
                for k in 0..=16 {
                    let t = f64::from(k) / 16.0;
                    let point = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
                    let [arc, other] = support.coordinates(point);
                    assert!(
                        (arc - along - t * length).abs() < 1e-14 && other == 0.0,
                        "{outer} {hole}: {point:?} {arc}"
                    );
                }
                along += length;
            }
            assert_eq!(along, expected);
        }
    }

    #[test]
    fn a_side_without_one_arc_length_is_refused() {
        for (outer, hole, expected) in [
            ("xbxd", "efgh", NoChain::Parts(2)),
            ("abcd", "xfxh", NoChain::Parts(2)),
            ("xxcd", "xxgh", NoChain::Parts(2)),
            ("xbxd", "xxxx", NoChain::Parts(3)),
            ("xxxx", "efgh", NoChain::Closed),
            ("abcd", "xxxx", NoChain::Closed),
        ] {
            for reversed in [false, true] {
                assert_eq!(Support::side(&slab(outer, hole, reversed), "x"), Err(expected), "{outer} {hole}");
            }
        }
    }
}
