//! The numbers of a run on grids.

use steklov_bem_operators::Location;
use steklov_msfem::crossing_contrast;
use steklov_problem::{Condition, QuantityKind, Scene, Side, Spot};

use super::error_parts::{FAILING, GridEstimate};
use super::estimate::contrast_crossed;
use super::solution::GridSolved;
use super::trace::{GridTrace, node_at};
use crate::answer::probes;
use crate::bars::Bars;
use crate::run::report::{OfMeans, Report};
use crate::solve::medium::Around;
use crate::summary::{GridSummary, Probe, SideProbe};

/// How far beside a point the cells around it are looked for, over the spacing.
const BESIDE: f64 = 1e-6;
/// Cells within which a point is beside a point of infinite stress.
const NEAR_SINGULAR: f64 = 1.0;
/// The same of a node at which moduli cross by as much as `CROSSING`.
const NEAR_CROSSING: f64 = 0.5;
const CROSSING: f64 = 5.0;
/// Rounding errors of a factor, over those of one number, the contrast and the square of the cells across: measured up to 80.
const OF_FACTOR: f64 = 100.0;

impl GridSolved {
    /// Displacement and stress at a point of the body or its boundary.
    ///
    /// # Panics
    /// Outside of the body.
    pub fn at(&self, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        self.body.at(&self.displacement, x).unwrap_or_else(|| panic!("({}, {}) is not in the body", x[0], x[1]))
    }

    /// Displacement and stress at a point where something lies.
    pub(super) fn at_spot(&self, spot: Spot, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        match &self.around {
            Some(around) if spot.body > 0 => around.at(x),
            _ => self.at(x),
        }
    }

    /// The named quantities of the scene in their order; `fine` is the boundary of the fine grid.
    pub(super) fn named(&self, scene: &Scene, fine: &GridTrace) -> Vec<f64> {
        let (mesh, mut works) = (&fine.mesh, self.works.iter());
        let mut values = Vec::new();
        for quantity in &scene.quantities {
            match quantity.kind {
                QuantityKind::MeanDisplacement(side) => {
                    let (mut sum, mut length) = ([0.0; 2], 0.0);
                    for e in (0..mesh.len()).filter(|&e| mesh.side[e] == side) {
                        let h = mesh.length(e);
                        for node in [e, mesh.next[e]].map(|n| node_at(&self.body.grid, fine.lattice[n])) {
                            (0..2).for_each(|k| sum[k] += h / 2.0 * self.displacement[2 * node + k]);
                        }
                        length += h;
                    }
                    values.extend(sum.map(|sum| sum / length));
                }
                _ => values.push(works.next().copied().unwrap_or(f64::NAN)),
            }
        }
        values
    }

    /// Rounding errors of a solution, relative: those of its factor, by the contrast of the moduli and the cells across.
    pub(crate) fn digits(&self) -> f64 {
        let across = self.body.grid.cells.into_iter().fold(0, usize::max) as f64;
        let [low, high] = self.moduli();
        OF_FACTOR * f64::EPSILON * high / low * across * across
    }

    /// Whether moduli cross so much at a node that the error of the fine grid is not seen.
    pub(crate) fn crosses(&self) -> bool {
        contrast_crossed(&self.body) >= FAILING
    }

    /// The smallest and the largest Young's modulus of a cell.
    fn moduli(&self) -> [f64; 2] {
        let inside = self.body.grid.body_cells().map(|c| self.body.young[c]);
        inside.fold([f64::INFINITY, 0.0], |[low, high], e| [low.min(e), high.max(e)])
    }

    /// Which of these points are as near to points of infinite stress as a cell is large, or nearer than half a cell to a point where moduli
    /// cross: the cells around have little of the field there.
    pub(crate) fn near_singular(&self, points: &[[f64; 2]], singular: &[[f64; 2]]) -> Vec<usize> {
        let grid = &self.body.grid;
        let is_near = |x: [f64; 2], y: [f64; 2], cells: f64| {
            let [dx, dy] = [0, 1].map(|k| (x[k] - y[k]) / grid.spacing[k]);
            dx.hypot(dy) <= cells
        };
        let crosses = |x: [f64; 2]| {
            let near = [0, 1].map(|k| ((x[k] - grid.origin[k]) / grid.spacing[k]).round().max(0.0) as usize);
            let within = (0..2).all(|k| near[k] <= grid.cells[k]);
            let node = if within { grid.node(near[0], near[1]) } else { None };
            node.is_some_and(|node| is_near(x, grid.point(node), NEAR_CROSSING) && self.body.crossing(node) >= CROSSING)
        };
        let is_weak = |&x: &[f64; 2]| singular.iter().any(|&y| is_near(x, y, NEAR_SINGULAR)) || crosses(x);
        (0..points.len()).filter(|&k| is_weak(&points[k])).collect()
    }

    /// Which of these points are where cells of different moduli meet: the stress there has several values, or none.
    pub(crate) fn at_jumps(&self, points: &[[f64; 2]]) -> Vec<usize> {
        let (body, grid) = (&self.body, &self.body.grid);
        let jumps = |&x: &[f64; 2]| {
            // the cells around it
            let mut near = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].into_iter().filter_map(|by| {
                let beside: [f64; 2] = std::array::from_fn(|k| x[k] + BESIDE * by[k] * grid.spacing[k]);
                let (cell, _) = grid.locate(beside)?;
                Some((body.young[cell], body.elasticity_of(cell).poisson))
            });
            let first = near.next();
            near.any(|other| Some(other) != first)
        };
        (0..points.len()).filter(|&k| jumps(&points[k])).collect()
    }

    /// Displacement, traction and stress at the middles of the sides of fine cells along sides of the body.
    pub(super) fn along_sides(&self, scene: &Scene, sides: &[usize]) -> Vec<SideProbe> {
        let mesh = self.trace().mesh;
        let middles = |e: usize| {
            let cells = self.trace.points(e).len() - 1;
            (0..cells).map(|k| (2 * k + 1) as f64 / cells as f64 - 1.0).collect()
        };
        let at = |e: usize, t: f64| {
            let state @ (_, [xx, yy, xy]) = self.at(mesh.point(e, t));
            let [nx, ny] = mesh.normal(e, t);
            (state, [xx * nx + xy * ny, xy * nx + yy * ny])
        };
        probes::along_sides(scene, mesh, sides, middles, at)
    }
}

/// The report of finite elements.
pub(super) fn report<'a>(scene: &Scene, solved: &'a GridSolved) -> Report<'a> {
    let estimate = solved.estimate.as_ref();
    // J(u_h) - J(u) = ½ ‖u - u_h‖² for data that the elements have; where they lock, half of the squared estimate is more than
    // that, but not less: the exact J lies between
    let constant = |side: &Side| match &side.condition {
        Condition::Displacement { values, .. } => values.iter().flatten().all(|v| v.constant().is_some()),
        _ => true,
    };
    // prescribed displacements that vary are interpolated, and reactions do work on the interpolation error
    let applies = solved.coarse.is_none() && solved.around.is_none() && scene.problem.sides.iter().all(constant);
    let correction = estimate.filter(|e| applies && e.doubts().is_empty()).map(|e| e.fine_grid / 2.0);
    let probe = |&point: &[f64; 2]| {
        let (displacement, stress) = match &solved.around {
            Some(around) if scene.problem.outline.contains(point) == Location::Outside => around.at(point),
            _ => solved.at(point),
        };
        Probe::new(point, displacement, stress)
    };
    let trace = solved.trace();
    let named = match scene.quantities.is_empty() {
        true => Vec::new(),
        false => {
            GridTrace::new(scene, &solved.body.grid, |_| true).map_or(Vec::new(), |fine| solved.named(scene, &fine))
        }
    };
    Report {
        energies: solved.energies,
        energy: correction.map(|c| [solved.energies.total - c, c]),
        error: estimate.map(|e| [e.error, e.relative]),
        doubts: estimate.map_or(Vec::new(), GridEstimate::doubts),
        estimators: scene
            .method
            .has_residuals()
            .then(|| estimate.map_or_else(Default::default, GridEstimate::estimators)),
        trace,
        contact: solved.contact.as_ref(),
        located: None,
        off: None,
        reactions: &solved.reactions,
        probe: scene.probe.iter().map(probe).collect(),
        named,
        near: Vec::new(),
        bars: Bars::on_grid(scene, solved),
        largest_stress: None,
        over_outcomes: solved.over_outcomes.clone().map(|bars| OfMeans { bars, energy: None, lengths: None }),
        lines: probes::lines(scene, |spot, x| solved.at_spot(spot, x)),
        sides: solved.along_sides(scene, &scene.probe_sides),
        grid: Some(grid_summary(solved)),
        around: solved.around.as_ref(),
        exterior: solved.around.as_ref().map(Around::summary),
        bodies: Vec::new(),
        interfaces: Vec::new(),
        reach: Vec::new(),
    }
}

fn grid_summary(solved: &GridSolved) -> GridSummary {
    let (body, estimate) = (&solved.body, solved.estimate.as_ref());
    let coarse = solved.coarse.as_ref();
    let crossing = coarse.map(|c| crossing_contrast(body, &c.mesh, FAILING));
    let [low, high] = solved.moduli();
    GridSummary {
        cells: body.grid.cells,
        fine_dofs: body.grid.dofs(),
        basis: coarse.map(|c| c.basis.word().to_owned()),
        coarse_cells: coarse.map(|c| c.mesh.cells.len()),
        patterns: coarse.map(|c| c.patterns),
        estimate_multiscale: estimate.filter(|_| coarse.is_some()).map(|e| e.multiscale.sqrt()),
        estimate_fine_grid: estimate.map(|e| e.fine_grid.sqrt()),
        estimate_medium: estimate.filter(|_| solved.around.is_some()).map(|e| e.medium.sqrt()),
        boundary_elements: solved.around.as_ref().map(|around| around.mesh.len()),
        contrast: high / low,
        crossing_contrast: crossing.map(|c| c.largest),
        crossing_at: crossing.map(|c| c.at),
        crossing_share: crossing.map(|c| c.share),
    }
}
