//! The estimated error of a grid's solution, by its parts.

use steklov_msfem::{Loads, nodal_indicators};

use super::solve::GridSolved;

/// The estimated error: that of the coarse cells against bilinear elements on all fine ones, and that of these against the
/// exact solution.
#[derive(Debug, Clone, PartialEq)]
pub struct GridEstimate {
    /// η² of each coarse cell (force times length per thickness); empty without coarse cells.
    pub indicators: Vec<f64>,
    /// Their sum: the squared multiscale error.
    pub multiscale: f64,
    /// The squared error of the fine grid.
    pub fine_grid: f64,
    /// (multiscale + fine grid)^½, energy norm.
    pub error: f64,
    /// Error over (2 strain energy)^½.
    pub relative: f64,
}

/// Estimates the error of a conforming solution; None of bases that do not conform, whose error no residual sees whole.
pub(super) fn estimate(solved: &GridSolved, loads: &Loads, held: &[bool]) -> Option<GridEstimate> {
    let load = load(solved, loads);
    let (medium, u) = (&solved.medium, &solved.displacement);
    let indicators = match &solved.coarse {
        Some(coarse) if !coarse.basis.is_conforming() => return None,
        Some(coarse) => nodal_indicators(medium, &coarse.mesh, &load, u, held),
        None => Vec::new(),
    };
    let multiscale = indicators.iter().sum::<f64>();
    let fine_grid = 0.0;
    let error = (multiscale + fine_grid).sqrt();
    let scale = (2.0 * solved.energies.strain).sqrt();
    let relative = if scale > 0.0 { error / scale } else { 0.0 };
    Some(GridEstimate { indicators, multiscale, fine_grid, error, relative })
}

/// The load of the fine nodes, that of contact included.
fn load(solved: &GridSolved, loads: &Loads) -> Vec<f64> {
    let (medium, trace) = (&solved.medium, &solved.trace);
    let mut load = loads.nodal(medium);
    let Some(contact) = &solved.contact else { return load };
    let grid = &medium.grid;
    // nodal forces over the lengths of the nodes: the traction, which is linear from node to node
    let mut traction = vec![[0.0; 2]; trace.space.nodes()];
    for (node, force) in contact.boundary.nodal_forces(&contact.reported().multipliers) {
        (0..2).for_each(|i| traction[node][i] -= force[i]);
    }
    let mut length = vec![0.0; traction.len()];
    let on_contact: Vec<usize> =
        (0..trace.mesh.len()).filter(|&e| contact.boundary.nodes.iter().any(|n| n.node == e || n.node == trace.mesh.next[e])).collect();
    for &e in &on_contact {
        [e, trace.mesh.next[e]].into_iter().for_each(|node| length[node] += trace.mesh.length(e) / 2.0);
    }
    for (traction, length) in traction.iter_mut().zip(&length).filter(|(_, length)| **length > 0.0) {
        (0..2).for_each(|i| traction[i] /= length);
    }
    for &e in &on_contact {
        let (start, end) = (trace.lattice[e], trace.lattice[trace.mesh.next[e]]);
        let along = usize::from(start[0] == end[0]);
        let count = start[along].abs_diff(end[along]);
        let h = trace.mesh.length(e) / count as f64;
        let at = |step: usize| {
            let s = step as f64 / count as f64;
            [0, 1].map(|i| (1.0 - s) * traction[e][i] + s * traction[trace.mesh.next[e]][i])
        };
        let node = |step: usize| {
            let mut point = start;
            point[along] = if end[along] > start[along] { start[along] + step } else { start[along] - step };
            grid.node(point[0], point[1])
        };
        for step in 0..count {
            let (t0, t1) = (at(step), at(step + 1));
            for (node, weights) in [(node(step), [2.0, 1.0]), (node(step + 1), [1.0, 2.0])] {
                let Some(node) = node else { continue };
                (0..2).for_each(|i| load[2 * node + i] += h / 6.0 * (weights[0] * t0[i] + weights[1] * t1[i]));
            }
        }
    }
    load
}
