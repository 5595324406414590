//! What is stored and shown of a body on a grid.

use std::path::Path;

use steklov_bem_operators::{Location, Mesh};
use steklov_io::vtkhdf::{Field, Grid as VtkGrid};
use steklov_msfem::{CoarseMesh, HeterogeneousBody, crossing_contrast};

use super::estimate::GridEstimate;
use super::run::{GridRun, GridStep};
use super::solve::GridSolved;
use crate::around::{Around, add_medium, window};
use crate::plan::Plan;
use crate::record::{Record, audit_summary};
use crate::report::{ContactRow, contact_rows, contact_summary};
use crate::summary::{GridSummary, MediumSummary, Probe, SecondsSummary, Summary, peak_memory_bytes};
use crate::vertices::tell_unbounded;
use steklov_problem::{Condition, Scene, Side};

/// The grid of a result. The cells of the body are the quadrilaterals of the result and its nodes the points, both in their
/// order.
#[derive(Debug, Clone)]
pub struct GridRecord {
    /// Fine cells, moduli, Poisson's ratio.
    pub body: HeterogeneousBody,
    /// Coarse cells; None of bilinear elements on the fine grid.
    pub coarse: Option<CoarseMesh>,
    /// Displacement of the coarse vertices (length), those that hang included.
    pub vertex_displacement: Vec<[f64; 2]>,
    /// The steps.
    pub steps: Vec<GridStep>,
}

/// Contrast along coarse edges from which linear traces fail.
pub(crate) const FAILING: f64 = 1e2;

impl Record {
    /// Gathers a run on grids; see [`Record::new`].
    pub fn of_grid(scene: &Scene, plan: Plan, run: GridRun, file: &Path, reading: f64) -> Self {
        let clock = std::time::Instant::now();
        let solved = &run.last;
        let trace = solved.trace();
        let contact = solved.contact.as_ref().map_or(Vec::new(), |c| contact_rows(trace, c));
        let around = solved.around.clone().map(|around| {
            let window = window(&scene.polygon, &around);
            (around, window)
        });
        let mut grid = vtk(solved);
        if let Some((around, window)) = &around {
            add_medium(&mut grid, around, window);
        }
        let mesh: &Mesh = trace.mesh;
        let traction_points: Vec<[f64; 2]> = (0..mesh.len()).map(|e| mesh.point(e, 0.0)).collect();
        let traction = (0..mesh.len())
            .map(|e| {
                let [xx, yy, xy] = solved.at(traction_points[e]).1;
                let [nx, ny] = mesh.normal(e);
                [xx * nx + xy * ny, xy * nx + yy * ny]
            })
            .collect();
        let mut summary = summary(scene, &run, &contact, file);
        let pairs = |u: &[f64]| -> Vec<[f64; 2]> { u.chunks_exact(2).map(|u| [u[0], u[1]]).collect() };
        let displacement = pairs(trace.displacement);
        let (points, mesh) = (trace.space.points.clone(), mesh.clone());
        let on_grid = grid_record(solved, run.steps);
        summary.seconds.write = clock.elapsed().as_secs_f64();
        summary.seconds.total = reading + run.clock.elapsed().as_secs_f64();
        Self {
            summary,
            plan,
            points,
            displacement,
            traction_element: (0..mesh.len()).collect(),
            traction_points,
            traction,
            contact,
            steps: Vec::new(),
            grid,
            mesh,
            stochastic: None,
            on_grid: Some(on_grid),
            around,
        }
    }
}

impl GridSolved {
    /// Displacement and stress at a point of the body or its boundary.
    ///
    /// # Panics
    /// Outside of the body.
    pub fn at(&self, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        self.body.at(&self.displacement, x).unwrap_or_else(|| panic!("({}, {}) is not in the body", x[0], x[1]))
    }
}

fn grid_record(solved: &GridSolved, steps: Vec<GridStep>) -> GridRecord {
    let coarse = solved.coarse.as_ref();
    GridRecord {
        body: solved.body.clone(),
        coarse: coarse.map(|c| c.mesh.clone()),
        vertex_displacement: coarse.map_or(Vec::new(), |c| c.displacement.clone()),
        steps,
    }
}

/// The fine cells with displacement, stress and moduli; the boundary as lines.
fn vtk(solved: &GridSolved) -> VtkGrid {
    let body = &solved.body;
    let grid = &body.grid;
    let stresses = body.stresses(&solved.displacement);
    let boundary = grid.boundary();
    let lines = boundary.iter().map(|&(cell, side)| {
        let nodes = grid.cell_nodes(cell);
        [nodes[side], nodes[(side + 1) % 4]]
    });
    // lines have the values of the cells inside of them
    let cells: Vec<usize> = boundary.iter().map(|(cell, _)| *cell).chain(grid.body_cells()).collect();
    let field = |name: &str, unit: &str, components: usize, values: Vec<f64>| Field {
        name: name.into(),
        unit: unit.into(),
        components,
        values,
    };
    VtkGrid {
        points: (0..grid.nodes()).map(|n| grid.point(n)).collect(),
        lines: lines.collect(),
        quads: grid.body_cells().map(|c| grid.cell_nodes(c)).collect(),
        triangles: Vec::new(),
        point_data: vec![field(
            "displacement",
            "length",
            3,
            solved.displacement.chunks_exact(2).flat_map(|u| [u[0], u[1], 0.0]).collect(),
        )],
        cell_data: vec![
            field("stress", "stress", 3, cells.iter().flat_map(|&c| stresses[c]).collect()),
            field("von_mises", "stress", 1, cells.iter().map(|&c| body.elasticity.von_mises(stresses[c])).collect()),
            field("young", "stress", 1, cells.iter().map(|&c| body.young[c]).collect()),
        ],
    }
}

fn summary(scene: &Scene, run: &GridRun, rows: &[ContactRow], file: &Path) -> Summary {
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
    let applies = solved.coarse.is_none() && solved.around.is_none() && scene.sides.iter().all(constant);
    let correction = estimate.filter(|e| applies && e.doubts().is_empty()).map(|e| e.fine_grid / 2.0);
    let extrapolated = correction.map(|c| (solved.energies.total - c, c));
    let part = |k: usize| run.steps.iter().map(|s| s.seconds[k]).sum::<f64>();
    let probe = |&point: &[f64; 2]| {
        let (displacement, stress) = match &solved.around {
            Some(around) if scene.polygon.contains(point) == Location::Outside => around.at(point),
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
        file: file.display().to_string(),
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
