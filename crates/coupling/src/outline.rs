//! The outer boundary of a body on a grid.

use std::collections::BTreeMap;

use steklov_bem_operators::{Loop, Polygon};
use steklov_elastic::plane::{distance, minus};
use steklov_msfem::{Grid, Loads};
use steklov_quadrature::gauss_legendre;

use crate::CouplingError;

/// Points of the rule on each side of a cell for the jump of tractions.
const POINTS: usize = 8;

/// The outer boundary, counter-clockwise from its lowest, then leftmost point. Boundaries of holes are no part of it.
#[derive(Debug, Clone)]
pub struct Outline {
    /// Nodes of the grid; node k is the first point of side k.
    pub nodes: Vec<usize>,
    /// Cell and its side (0 lower, 1 right, 2 upper, 3 left), one after the other.
    pub sides: Vec<(usize, usize)>,
    /// The same curve, its edges named by their numbers.
    pub polygon: Polygon,
}

impl Outline {
    /// The outer boundary of a grid.
    ///
    /// # Errors
    /// [`CouplingError::Outline`] for a body of several parts, or one that touches itself in a point only.
    pub fn new(grid: &Grid) -> Result<Self, CouplingError> {
        let mut from: BTreeMap<usize, (usize, (usize, usize))> = BTreeMap::new();
        for (cell, side) in grid.boundary() {
            let nodes = grid.cell_nodes(cell);
            if from.insert(nodes[side], (nodes[(side + 1) % 4], (cell, side))).is_some() {
                let [x, y] = grid.point(nodes[side]);
                return Err(CouplingError::Outline { what: format!("it touches itself at ({x}, {y})") });
            }
        }
        let mut outer = None;
        while let Some((&start, _)) = from.first_key_value() {
            let (mut nodes, mut sides, mut at) = (Vec::new(), Vec::new(), start);
            while let Some((next, side)) = from.remove(&at) {
                nodes.push(at);
                sides.push(side);
                at = next;
            }
            let area: f64 = (0..nodes.len())
                .map(|k| {
                    let [a, b] = [nodes[k], nodes[(k + 1) % nodes.len()]].map(|n| grid.point(n));
                    (b[0] - a[0]) * (a[1] - grid.origin[1])
                })
                .sum();
            // a hole runs clockwise
            if area < 0.0 && outer.replace((nodes, sides)).is_some() {
                return Err(CouplingError::Outline { what: "it has several parts".into() });
            }
        }
        let Some((nodes, sides)) = outer else { unreachable!("a grid has cells") };
        let n = nodes.len();
        let corners: Vec<[f64; 2]> =
            (0..n).filter(|&k| sides[k].1 != sides[(k + n - 1) % n].1).map(|k| grid.point(nodes[k])).collect();
        let names = (0..corners.len()).map(|k| k.to_string()).collect();
        let polygon = Polygon::new(Loop::straight(corners, names), Vec::new())?;
        Ok(Self { nodes, sides, polygon })
    }

    /// Adds a jump of tractions t0(x, n) (stress), n out of the body, to the loads of the grid: ∫ t0·v over each side by 8
    /// Gauss points.
    pub fn add_traction_jump(&self, grid: &Grid, loads: &mut Loads, jump: impl Fn([f64; 2], [f64; 2]) -> [f64; 2]) {
        let rule = gauss_legendre(POINTS);
        for (k, &(cell, side)) in self.sides.iter().enumerate() {
            let [a, b] = [self.nodes[k], self.nodes[(k + 1) % self.nodes.len()]].map(|n| grid.point(n));
            let (d, length) = (minus(b, a), distance(b, a));
            let mut moments = [[0.0; 2]; 2];
            for (&t, w) in rule.points.iter().zip(&rule.weights) {
                let s = (1.0 + t) / 2.0;
                let value = jump([a[0] + s * d[0], a[1] + s * d[1]], [d[1] / length, -d[0] / length]);
                for i in 0..2 {
                    moments[0][i] += 0.5 * length * w * (1.0 - s) * value[i];
                    moments[1][i] += 0.5 * length * w * s * value[i];
                }
            }
            loads.add_side(cell, side, moments);
        }
    }
}
