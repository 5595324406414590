//! The estimated error of a grid's solution, by its parts.

use std::collections::HashMap;

use steklov_msfem::{CrossingContrast, Indicators, Loads, bubble_indicators, crossing_contrast, nodal_indicators};

use super::FAILING;
use super::solve::{GridSolved, node_at};
use crate::scene::Indicator;

/// The estimated error: that of the coarse cells against bilinear elements on all fine ones, and that of these against the
/// exact solution.
#[derive(Debug, Clone, PartialEq)]
pub struct GridEstimate {
    /// η² of each coarse cell (force times length per thickness); empty without coarse cells.
    pub indicators: Vec<f64>,
    /// The terms of Theorem 5.3 of which the indicators are the sums; None of nodal residuals.
    pub residual: Option<Indicators>,
    /// Their sum: the squared multiscale error.
    pub multiscale: f64,
    /// The squared error of the fine grid.
    pub fine_grid: f64,
    /// (multiscale + fine grid)^½, energy norm.
    pub error: f64,
    /// Error over (2 strain energy)^½.
    pub relative: f64,
    /// How the moduli vary along coarse edges.
    pub crossing: Option<CrossingContrast>,
}

/// Ratio of moduli along a coarse edge from which no residual sees the error.
pub(crate) const BLIND: f64 = 1e3;

impl GridEstimate {
    /// Why it is not to be trusted.
    pub fn doubts(&self) -> Vec<String> {
        let blind = self.crossing.is_some_and(|c| c.largest >= BLIND);
        if blind { vec!["contrast".to_owned()] } else { Vec::new() }
    }
}

/// Estimates the error of a conforming solution; None of bases that do not conform, whose error no residual sees whole.
///
/// `tractions` are the means of the given ones on the fine sides (cell, side) of the boundary.
pub(super) fn estimate(
    solved: &GridSolved,
    indicator: Indicator,
    loads: &Loads,
    mut tractions: Tractions,
    held: &[bool],
) -> Option<GridEstimate> {
    let (medium, u) = (&solved.medium, &solved.displacement);
    let coarse = solved.coarse.as_ref();
    if coarse.is_some_and(|c| !c.basis.is_conforming()) {
        return None;
    }
    let mut load = loads.nodal(medium);
    for pressed in contact_sides(solved) {
        let h = pressed.length;
        let [t0, t1] = pressed.tractions;
        for (node, weights) in pressed.nodes.into_iter().zip([[2.0, 1.0], [1.0, 2.0]]) {
            (0..2).for_each(|i| load[2 * node + i] += h / 6.0 * (weights[0] * t0[i] + weights[1] * t1[i]));
        }
        tractions.insert(pressed.side, [0, 1].map(|i| (t0[i] + t1[i]) / 2.0));
    }
    let traction = |cell: usize, side: usize| tractions.get(&(cell, side)).copied().unwrap_or_default();
    let mut residual = None;
    let indicators = match (coarse, indicator) {
        (None, _) => Vec::new(),
        (Some(coarse), Indicator::Bubble) => nodal_indicators(medium, &coarse.mesh, &load, u, held),
        (Some(coarse), Indicator::Residual) => {
            // the bubbles of the solution answer the load inside of the cells
            let body = if coarse.bubbles { &[][..] } else { &loads.body };
            residual.insert(Indicators::new(medium, &coarse.mesh, body, u, held, &traction)).squared()
        }
    };
    let multiscale = indicators.iter().sum::<f64>();
    let fine_grid = bubble_indicators(medium, &loads.body, u, held, &traction).iter().sum::<f64>();
    let error = (multiscale + fine_grid).sqrt();
    let scale = (2.0 * solved.energies.strain).sqrt();
    let relative = if scale > 0.0 { error / scale } else { 0.0 };
    let crossing = coarse.map(|c| crossing_contrast(medium, &c.mesh, FAILING));
    Some(GridEstimate { indicators, residual, multiscale, fine_grid, error, relative, crossing })
}

/// Mean tractions (stress) on fine sides (cell, side) of the boundary.
pub(super) type Tractions = HashMap<(usize, usize), [f64; 2]>;

/// A fine side in contact.
struct ContactSide {
    /// Its cell and side.
    side: (usize, usize),
    /// Its fine nodes.
    nodes: [usize; 2],
    /// The traction on the body there.
    tractions: [[f64; 2]; 2],
    length: f64,
}

/// The fine sides of contact elements with the tractions on them: nodal forces over the lengths of the nodes, linear between
/// them.
fn contact_sides(solved: &GridSolved) -> Vec<ContactSide> {
    let (grid, trace) = (&solved.medium.grid, &solved.trace);
    let (mesh, next) = (&trace.mesh, &trace.mesh.next);
    let Some(contact) = &solved.contact else { return Vec::new() };
    let mut traction = vec![[0.0; 2]; trace.space.nodes()];
    for (node, force) in contact.boundary.nodal_forces(&contact.reported().multipliers) {
        (0..2).for_each(|i| traction[node][i] -= force[i]);
    }
    let sides: Vec<usize> =
        contact.boundary.nodes.iter().flat_map(|n| &n.conditions).flat_map(|c| &c.shares).map(|s| s.side).collect();
    let elements: Vec<usize> = (0..mesh.len()).filter(|&e| sides.contains(&mesh.side[e])).collect();
    let mut length = vec![0.0; traction.len()];
    for &e in &elements {
        [e, next[e]].into_iter().for_each(|node| length[node] += mesh.length(e) / 2.0);
    }
    for (traction, length) in traction.iter_mut().zip(&length).filter(|(_, length)| **length > 0.0) {
        (0..2).for_each(|i| traction[i] /= length);
    }
    let mut pressed = Vec::new();
    for e in elements {
        let points = trace.points(e);
        let count = points.len() - 1;
        let at = |step: usize| {
            let s = step as f64 / count as f64;
            [0, 1].map(|i| (1.0 - s) * traction[e][i] + s * traction[next[e]][i])
        };
        for step in 0..count {
            let ends = [points[step], points[step + 1]];
            pressed.push(ContactSide {
                side: trace.side(grid, ends),
                nodes: ends.map(|p| node_at(grid, p)),
                tractions: [at(step), at(step + 1)],
                length: mesh.length(e) / count as f64,
            });
        }
    }
    pressed
}
