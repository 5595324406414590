//! The data of a result that are stored and shown.

use std::path::Path;

use steklov_bem_operators::Mesh;
use steklov_fields::steklov_picture::Largest;
use steklov_fields::{Deformed, Window, add_medium, largest_factor, window};
use steklov_io::vtkhdf::Grid;
use steklov_model::run::adaptive_loop::Run;
use steklov_model::run::answer::answer;
use steklov_model::solve::contact_rows::{ContactRow, contact_rows};
use steklov_model::solve::medium::Around;
use steklov_model::solve::solution::TieRow;
use steklov_model::stochastic::StochasticResult;
use steklov_model::summary::Summary;
use steklov_plan::Plan;
use steklov_problem::Scene;

use crate::grid::GridRecord;
use crate::keep::{Fields, Keep};

/// A result: the arrays of the result file and the numbers of its summary.
#[derive(Debug, Clone)]
pub struct Record {
    /// The numbers.
    pub summary: Summary,
    /// The plan of the model.
    pub plan: Plan,
    /// The last mesh.
    pub mesh: Mesh,
    /// Nodal points.
    pub points: Vec<[f64; 2]>,
    /// Nodal displacement.
    pub displacement: Vec<[f64; 2]>,
    /// Points of each element: the Gauss points of its degree; on a grid the middle.
    pub traction_points: Vec<[f64; 2]>,
    /// The element of each traction point.
    pub traction_element: Vec<usize>,
    /// Traction σ(u)n at these points.
    pub traction: Vec<[f64; 2]>,
    /// The components of the traction that the scene prescribes; NaN for the others.
    pub prescribed: Vec<[f64; 2]>,
    /// Rows of the contact table.
    pub contact: Vec<ContactRow>,
    /// Rows of the tables of ties.
    pub ties: Vec<TieRow>,
    /// Boundary lines and the body with displacement, stress and von Mises stress.
    pub grid: Grid,
    /// All outcomes of random input.
    pub stochastic: Option<StochasticResult>,
    /// The grid of finite elements.
    pub on_grid: Option<GridRecord>,
    /// The medium around the body and a window of it. None without a medium, and for a result that was read: its fields
    /// are in the file alone.
    pub around: Option<(Around, Window)>,
}

impl Record {
    /// Gathers a run. `file` is the name of the result file, `reading` the seconds before the run began.
    pub fn new<M: Keep>(
        scene: &Scene,
        plan: Plan,
        run: &Run<M>,
        stochastic: Option<StochasticResult>,
        file: &Path,
        reading: f64,
    ) -> Self {
        let clock = std::time::Instant::now();
        let Fields { mut grid, traction, prescribed, on_grid, ties } = M::fields(scene, run, stochastic.as_ref());
        let report = M::report(scene, run);
        let around = report.around.cloned().map(|around| {
            let window = window(&scene.problem.outline, &around);
            (around, window)
        });
        if let Some((around, window)) = &around {
            add_medium(&mut grid, around, window);
        }
        let trace = report.trace;
        let contact = report.contact.map_or(Vec::new(), |c| contact_rows(trace, c));
        let mut summary = answer(scene, run, report, &contact, stochastic.as_ref());
        summary.file = file.display().to_string();
        summary.seconds.write = clock.elapsed().as_secs_f64();
        summary.seconds.total = reading + run.clock.elapsed().as_secs_f64();
        Self {
            summary,
            plan,
            points: trace.space.points.clone(),
            displacement: trace.displacement.chunks_exact(2).map(|u| [u[0], u[1]]).collect(),
            traction_points: traction.iter().map(|t| t.0).collect(),
            traction_element: traction.iter().map(|t| t.1).collect(),
            traction: traction.iter().map(|t| t.2).collect(),
            prescribed,
            contact,
            ties,
            grid,
            mesh: trace.mesh.clone(),
            stochastic,
            on_grid,
            around,
        }
    }

    /// The largest factor at which its displacements may be drawn.
    pub fn largest_factor(&self) -> Largest {
        largest_factor(&Deformed {
            points: &self.points,
            displacement: &self.displacement,
            side_names: &self.mesh.side_names,
            interfaces: &self.summary.interfaces,
            contact: &self.contact,
            ties: &self.ties,
            grid: &self.grid,
        })
    }
}
