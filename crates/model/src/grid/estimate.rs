//! The error of a grid's solution is estimated.

use std::collections::HashMap;

use steklov_coupling::CellIndicators;
use steklov_msfem::{
    Basis, CoarseCell, CoarseMesh, HeterogeneousBody, Indicators, Loads, bubble_indicators, crossing_contrast,
    nodal_indicators,
};
use steklov_problem::{Indicator, Scene};

use super::error_parts::{FAILING, GridEstimate, of_elements};
use super::interface_sides::InterfaceSides;
use super::loads::Tractions;
use super::oscillation::load_oscillation;
use super::solution::GridSolved;
use super::trace::{GridTrace, node_at};
use crate::error::SolveError;

/// Largest ratio of the softer of two opposite cells at a node to the stiffer one of the other two.
pub(super) fn contrast_crossed(body: &HeterogeneousBody) -> f64 {
    let grid = &body.grid;
    let [nx, ny] = grid.cells;
    let young = |ix: usize, iy: usize| if grid.inside(ix, iy) { body.young[ix * ny + iy] } else { f64::NAN };
    let at = |ix: usize, iy: usize| {
        let [a, b, c, d] = [young(ix, iy), young(ix + 1, iy), young(ix + 1, iy + 1), young(ix, iy + 1)];
        let whole = [a, b, c, d].iter().all(|e| e.is_finite());
        if whole { (a.min(c) / b.max(d)).max(b.min(d) / a.max(c)) } else { 1.0 }
    };
    let column = |ix: usize| (0..ny - 1).map(|iy| at(ix, iy)).fold(1.0, f64::max);
    (0..nx - 1).map(column).fold(1.0, f64::max)
}

/// Largest ratio of moduli in one coarse cell.
fn contrast_inside(body: &HeterogeneousBody, mesh: &CoarseMesh) -> f64 {
    let ratio = |cell: &CoarseCell| {
        let young = cell.fine_cells(&body.grid).map(|c| body.young[c]);
        let (low, high) = young.fold((f64::INFINITY, 0.0f64), |(low, high), e| (low.min(e), high.max(e)));
        high / low
    };
    mesh.cells.iter().map(ratio).fold(1.0, f64::max)
}

/// Estimates the error of a conforming solution; `None` for nonconforming bases, whose error no residual sees whole.
///
/// `tractions` are the means of the given ones on the fine sides (cell, side) of the boundary.
pub(super) fn estimate(
    scene: &Scene,
    solved: &GridSolved,
    loads: &Loads,
    mut tractions: Tractions,
    held: &[bool],
) -> Result<Option<GridEstimate>, SolveError> {
    let (body, u) = (&solved.body, &solved.displacement);
    let coarse = solved.coarse.as_ref();
    if coarse.is_some_and(|c| !c.basis.is_conforming()) {
        return Ok(None);
    }
    let mut load = loads.nodal(body);
    for pressed in contact_sides(solved) {
        for (node, force) in pressed.nodal_forces() {
            (0..2).for_each(|i| load[2 * node + i] += force[i]);
        }
        let [t0, t1] = pressed.tractions;
        tractions.insert(pressed.side, [0, 1].map(|i| Some((t0[i] + t1[i]) / 2.0)));
    }
    let mut of_residuals = tractions.clone();
    if let Some(around) = &solved.around {
        let fine = GridTrace::new(scene, &body.grid, |_| true)?;
        let sides = InterfaceSides::new(&body.grid, &fine, &around.mesh, around.material.young);
        let moments = sides.moments(&around.mesh, &around.space, &around.traction);
        sides.add(&moments, &mut load);
        let jump = |side: (usize, usize)| tractions.get(&side).copied().unwrap_or([Some(0.0); 2]);
        let of_sides = sides.tractions(body, u, &moments, jump);
        // the residuals there are those of the boundary elements
        of_residuals.extend(of_sides.keys().map(|side| (*side, [None; 2])));
        tractions.extend(of_sides);
        let forces = body.forces(u);
        for (node, share) in sides.shares(body) {
            for dof in [2 * node, 2 * node + 1] {
                load[dof] = forces[dof] + share * (load[dof] - forces[dof]);
            }
        }
    }
    let (residual, in_cells) =
        if scene.method.has_residuals() { residuals(scene, solved, loads, &of_residuals) } else { (None, None) };
    let steers = scene.method.indicator == Indicator::Residual;
    let indicators = match (coarse, &residual) {
        (None, _) => Vec::new(),
        (Some(_), Some(residual)) if steers => residual.squared(),
        (Some(coarse), _) => nodal_indicators(body, &coarse.mesh, &load, u, held),
    };
    let multiscale = indicators.iter().sum::<f64>();
    let fine_grid: f64 = match in_cells {
        Some(terms) if steers => terms.iter().sum(),
        _ => {
            let traction = given(if steers { &of_residuals } else { &tractions });
            let fine = GridTrace::new(scene, &body.grid, |_| true)?;
            bubble_indicators(body, &loads.body, u, &traction).iter().sum::<f64>()
                + load_oscillation(scene, body, loads, &fine)?
        }
    };
    let interface = solved.interface.clone();
    let jump = solved.jump_oscillation.clone();
    let of_medium: f64 = of_elements(interface.as_ref(), &jump, scene.method.indicator).iter().sum();
    let error = (multiscale + fine_grid + of_medium).sqrt();
    let scale = (2.0 * solved.energies.strain).sqrt();
    // nothing is strained: all that is estimated is missing
    let relative = if scale > 0.0 { error / scale } else { f64::from(u8::from(error > 0.0)) };
    let crossing = coarse.map(|c| crossing_contrast(body, &c.mesh, FAILING));
    let inside = coarse.filter(|c| c.basis == Basis::Q1).map_or(1.0, |c| contrast_inside(body, &c.mesh));
    Ok(Some(GridEstimate {
        indicators,
        residual,
        in_cells,
        multiscale,
        fine_grid,
        interface,
        jump,
        medium: of_medium,
        error,
        relative,
        crossing,
        inside,
        crossed: contrast_crossed(body),
    }))
}

/// The mean traction on a side of the boundary, 0 where nothing is given.
fn given(tractions: &Tractions) -> impl Fn(usize, usize) -> [Option<f64>; 2] + Sync + '_ {
    |cell, side| tractions.get(&(cell, side)).copied().unwrap_or([Some(0.0); 2])
}

/// The residuals in coarse cells whose bases solve the equations inside, or in fine cells next to a medium, whose terms are
/// summed: volume, jumps, tractions.
fn residuals(
    scene: &Scene,
    solved: &GridSolved,
    loads: &Loads,
    tractions: &Tractions,
) -> (Option<Indicators>, Option<[f64; 3]>) {
    let (body, u, traction) = (&solved.body, &solved.displacement, given(tractions));
    match &solved.coarse {
        Some(coarse) if !matches!(coarse.basis, Basis::Q1 | Basis::Linear) => {
            // the bubbles of the solution answer the load inside of the cells
            let force = if coarse.bubbles { &[][..] } else { &loads.body };
            (Some(Indicators::new(body, &coarse.mesh, force, u, &traction)), None)
        }
        None if solved.around.is_some() => {
            let force = |x: [f64; 2]| scene.force_at(x).unwrap_or([f64::NAN; 2]);
            let cells = CellIndicators::new(body, u, &force, &traction);
            let sum = |terms: &[f64]| terms.iter().sum();
            (None, Some([sum(&cells.volume), sum(&cells.jump), sum(&cells.neumann)]))
        }
        _ => (None, None),
    }
}

/// A fine side in contact.
pub(super) struct ContactSide {
    /// The contact element, and where the side begins and ends on it in [-1, 1].
    pub element: usize,
    pub t: [f64; 2],
    /// Its cell and side.
    pub side: (usize, usize),
    /// Its fine nodes.
    pub nodes: [usize; 2],
    /// The traction on the body there.
    pub tractions: [[f64; 2]; 2],
    length: f64,
}

impl ContactSide {
    /// The forces of its tractions at its nodes.
    pub fn nodal_forces(&self) -> [(usize, [f64; 2]); 2] {
        let [t0, t1] = self.tractions;
        [0, 1].map(|k| {
            let [a, b] = [[2.0, 1.0], [1.0, 2.0]][k];
            (self.nodes[k], [0, 1].map(|i| self.length / 6.0 * (a * t0[i] + b * t1[i])))
        })
    }
}

/// The fine sides of contact elements with the tractions on them: the multipliers of the nodes, linear between them. A held end
/// has that of its neighbour.
pub(super) fn contact_sides(solved: &GridSolved) -> Vec<ContactSide> {
    let (grid, trace) = (&solved.body.grid, &solved.trace);
    let (mesh, next) = (&trace.mesh, &trace.mesh.next);
    let Some(contact) = &solved.contact else { return Vec::new() };
    let mut known: HashMap<(usize, usize), [f64; 2]> = HashMap::new();
    let mut multipliers = contact.reported().multipliers.iter();
    for node in &contact.boundary.nodes {
        for (condition, [pressure, shear]) in node.conditions.iter().zip(&mut multipliers) {
            for share in &condition.shares {
                let part = |weight: f64, value: f64| if weight > 0.0 { value } else { 0.0 };
                let (n, t) = (part(share.normal, *pressure), part(share.tangent, *shear));
                let traction = known.entry((node.node, share.side)).or_default();
                (0..2).for_each(|i| traction[i] -= n * condition.normal[i] + t * condition.tangent[i]);
            }
        }
    }
    let touches = |e: &usize| [*e, next[*e]].iter().any(|&node| known.contains_key(&(node, mesh.side[*e])));
    let elements: Vec<usize> = (0..mesh.len()).filter(touches).collect();
    let mut pressed = Vec::new();
    for e in elements {
        let points = trace.points(e);
        let count = points.len() - 1;
        let [a, b] = [e, next[e]].map(|node| known.get(&(node, mesh.side[e])).copied());
        let (a, b) = (a.or(b).unwrap_or_default(), b.or(a).unwrap_or_default());
        let at = |step: usize| {
            let s = step as f64 / count as f64;
            [0, 1].map(|i| (1.0 - s) * a[i] + s * b[i])
        };
        for step in 0..count {
            let ends = [points[step], points[step + 1]];
            let t = [step, step + 1].map(|k| (2 * k) as f64 / count as f64 - 1.0);
            pressed.push(ContactSide {
                element: e,
                t,
                side: trace.side(grid, ends),
                nodes: ends.map(|p| node_at(grid, p)),
                tractions: [at(step), at(step + 1)],
                length: mesh.length(e) / count as f64,
            });
        }
    }
    pressed
}
