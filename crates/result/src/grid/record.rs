//! What is stored and shown of a body on a grid.

use std::path::Path;

use steklov_bem_operators::Mesh;
use steklov_io::vtkhdf::{Field, Grid as VtkGrid};
use steklov_model::grid::{GridRun, GridSolved, GridStep, answer_of_grid};
use steklov_model::report::contact_rows;
use steklov_msfem::{CoarseMesh, HeterogeneousBody};
use steklov_plan::Plan;
use steklov_problem::Scene;

use crate::medium::{add_medium, window};
use crate::record::Record;

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

impl Record {
    /// Gathers a run on grids; see [`Record::new`].
    pub fn of_grid(scene: &Scene, plan: Plan, run: GridRun, file: &Path, reading: f64) -> Self {
        let clock = std::time::Instant::now();
        let solved = &run.last;
        let trace = solved.trace();
        let contact = solved.contact.as_ref().map_or(Vec::new(), |c| contact_rows(trace, c));
        let around = solved.around.clone().map(|around| {
            let window = window(&scene.body().outline, &around);
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
        let mut summary = answer_of_grid(scene, &run, &contact);
        summary.file = file.display().to_string();
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
