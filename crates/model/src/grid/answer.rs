//! The numbers of a run on grids.

use steklov_bem_operators::Location;
use steklov_msfem::crossing_contrast;
use steklov_problem::{Condition, Scene, Side};

use super::estimate::GridEstimate;
use super::run::GridRun;
use super::solve::GridSolved;
use crate::answer::audit_summary;
use crate::around::Around;
use crate::report::{ContactRow, contact_summary};
use crate::summary::{GridSummary, MediumSummary, Probe, SecondsSummary, Summary, peak_memory_bytes};
use crate::vertices::tell_unbounded;

/// Contrast along coarse edges from which linear traces fail.
pub const FAILING: f64 = 1e2;

impl GridSolved {
    /// Displacement and stress at a point of the body or its boundary.
    ///
    /// # Panics
    /// Outside of the body.
    pub fn at(&self, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        self.body.at(&self.displacement, x).unwrap_or_else(|| panic!("({}, {}) is not in the body", x[0], x[1]))
    }
}

/// The numbers of a run on grids; `rows` are those of the contact table.
pub fn answer_of_grid(scene: &Scene, run: &GridRun, rows: &[ContactRow]) -> Summary {
    let solved = &run.last;
    let contact = solved.contact.as_ref();
    let estimate = solved.estimate.as_ref();
    // J(u_h) - J(u) = ½ ‖u - u_h‖² for data that the elements have; where they lock, half of the squared estimate is more than
    // that, but not less: the exact J lies between
    let constant = |side: &Side| match &side.condition {
        Condition::Displacement { values, .. } => values.iter().flatten().all(|v| v.constant().is_some()),
        _ => true,
    };
    // prescribed displacements that vary are interpolated, and reactions do work on what that leaves
    let applies = solved.coarse.is_none() && solved.around.is_none() && scene.body().sides.iter().all(constant);
    let correction = estimate.filter(|e| applies && e.doubts().is_empty()).map(|e| e.fine_grid / 2.0);
    let extrapolated = correction.map(|c| (solved.energies.total - c, c));
    let part = |k: usize| run.steps.iter().map(|s| s.seconds[k]).sum::<f64>();
    let probe = |&point: &[f64; 2]| {
        let (displacement, stress) = match &solved.around {
            Some(around) if scene.body().outline.contains(point) == Location::Outside => around.at(point),
            _ => solved.at(point),
        };
        Probe { point, displacement, stress, stress_unbounded: false }
    };
    let mut probe: Vec<Probe> = scene.probe.iter().map(probe).collect();
    tell_unbounded(scene, rows, &mut probe, false);
    let exterior = solved.around.as_ref().map(Around::summary);
    let of_estimate = estimate.map_or(Vec::new(), GridEstimate::doubts);
    Summary {
        title: scene.title.clone(),
        model: scene.model().word().into(),
        file: String::new(),
        converged: run.converged(),
        reason: run.reason.word().into(),
        failure: run.error.as_ref().map(ToString::to_string),
        dofs: solved.dofs,
        steps: run.steps.len(),
        energy: solved.energies.total,
        energy_extrapolated: extrapolated.map(|(energy, _)| energy),
        energy_uncertainty: extrapolated.map(|(_, uncertainty)| uncertainty),
        strain_energy: solved.energies.strain,
        load_work: solved.energies.load_work,
        friction_work: solved.energies.friction_work,
        estimate: estimate.map(|e| e.error),
        estimate_relative: estimate.map(|e| e.relative),
        estimate_doubts: of_estimate.into_iter().chain(exterior.iter().filter_map(MediumSummary::doubt)).collect(),
        iterations: contact.map_or(0, |c| c.reported().iterations),
        contact: contact.map(|c| contact_summary(scene, solved.trace(), c, rows, None)),
        audit: contact.map(|c| audit_summary(&c.audit)),
        reactions: solved.reactions.iter().cloned().collect(),
        probe,
        seconds: SecondsSummary {
            set_up: part(0),
            assemble: part(1),
            factorise: part(2),
            solve: part(3),
            estimate: part(4),
            ..Default::default()
        },
        grid: Some(grid_summary(solved)),
        exterior,
        peak_memory_bytes: peak_memory_bytes(),
        ..Summary::default()
    }
}

fn grid_summary(solved: &GridSolved) -> GridSummary {
    let (body, estimate) = (&solved.body, solved.estimate.as_ref());
    let coarse = solved.coarse.as_ref();
    let crossing = coarse.map(|c| crossing_contrast(body, &c.mesh, FAILING));
    let inside = body.grid.body_cells().map(|c| body.young[c]);
    let (low, high) = inside.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), e| (low.min(e), high.max(e)));
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
