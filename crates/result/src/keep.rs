//! The part of a run that a result file keeps, for boundary elements and for finite elements on grids.

use steklov_fields::{bodies, cells};
use steklov_io::vtkhdf::Grid;
use steklov_io::{File, Group, IoError, invalid, vtkhdf};
use steklov_model::data::on_mesh::OnMesh;
use steklov_model::error::SolveError;
use steklov_model::grid::OnGrid;
use steklov_model::mesh::layout::Layout;
use steklov_model::run::adaptive_loop::{Model, Progress, Run, Step};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::solve::contact_rows::Trace;
use steklov_model::solve::solution::Solved;
use steklov_model::solve::solution::TieRow;
use steklov_model::stochastic::StochasticResult;
use steklov_problem::{Scene, moduli, poisson_ratios};

use crate::grid::{GridRecord, record, store as grid};
use crate::steps;

/// A model whose runs are kept in files.
pub trait Keep: Model {
    /// The beginning of a run, on the layout `first` if it is known; if steps are done already, the last one is solved again.
    ///
    /// # Errors
    /// The errors of a first grid.
    fn resume(scene: &Scene, steps: Vec<Step<Self>>, first: Option<Self::Layout>)
    -> Result<Progress<Self>, SolveError>;

    /// Writes a step into its group.
    ///
    /// # Errors
    /// When the file cannot be written.
    fn save_step(at: &Group, step: &Step<Self>) -> Result<(), IoError>;

    /// Reads the steps from which a run goes on.
    ///
    /// # Errors
    /// A file that is not one of this program's, truncated or altered, or of another scene.
    fn read_steps(file: &File, scene: &Scene) -> Result<Vec<Step<Self>>, IoError>;

    /// The fields of the last step.
    fn fields(scene: &Scene, run: &Run<Self>, outcomes: Option<&StochasticResult>) -> Fields;
}

/// The fields of a result.
pub struct Fields {
    /// Boundary lines and the body with displacement, stress and von Mises stress.
    pub grid: Grid,
    /// Points of the boundary, each with its element and the traction σ(u)n.
    pub traction: Vec<([f64; 2], usize, [f64; 2])>,
    /// The components of the traction that the scene prescribes; NaN for the others.
    pub prescribed: Vec<[f64; 2]>,
    /// The grid of finite elements.
    pub on_grid: Option<GridRecord>,
    /// Rows of the tables of ties.
    pub ties: Vec<TieRow>,
}

impl Keep for BoundaryElements {
    fn resume(scene: &Scene, steps: Vec<Step<Self>>, first: Option<Layout>) -> Result<Progress<Self>, SolveError> {
        let begin = || Progress { steps: Vec::new(), next: first.unwrap_or_else(|| Layout::first(scene)) };
        Ok(Progress::before_last(steps).unwrap_or_else(begin))
    }

    fn save_step(at: &Group, step: &Step<BoundaryElements>) -> Result<(), IoError> {
        steps::save(at, step)
    }

    fn read_steps(file: &File, scene: &Scene) -> Result<Vec<Step<BoundaryElements>>, IoError> {
        steps::load_all(file, scene)
    }

    fn fields(scene: &Scene, run: &Run<BoundaryElements>, outcomes: Option<&StochasticResult>) -> Fields {
        let solved: &Solved = &run.last;
        let data = OnMesh { scene, mesh: &solved.mesh, space: &solved.space };
        let (mut traction, mut prescribed) = (Vec::new(), Vec::new());
        for e in 0..solved.mesh.len() {
            let rule = steklov_quadrature::gauss_legendre(solved.space.degree(e));
            traction.extend(rule.points.iter().map(|&t| (solved.mesh.point(e, t), e, solved.traction(e, t))));
            prescribed
                .extend(rule.points.iter().map(|&t| or_nan(data.given_traction(e, t, solved.on_boundary(e, t).0))));
        }
        let grid = bodies(scene, run, outcomes);
        Fields { grid, traction, prescribed, on_grid: None, ties: solved.ties.clone() }
    }
}

/// A traction of which some components are given, NaN for the others.
fn or_nan(given: [Option<f64>; 2]) -> [f64; 2] {
    given.map(|component| component.unwrap_or(f64::NAN))
}

impl Keep for OnGrid {
    fn resume(scene: &Scene, steps: Vec<Step<Self>>, _: Option<Self::Layout>) -> Result<Progress<Self>, SolveError> {
        Progress::<Self>::new(scene, steps)
    }

    fn save_step(at: &Group, step: &Step<Self>) -> Result<(), IoError> {
        grid::save_step(at, step)
    }

    fn read_steps(file: &File, scene: &Scene) -> Result<Vec<Step<Self>>, IoError> {
        let steps = grid::read_steps(file)?;
        // moduli from another file may have changed since
        let stored = grid::read(file, &vtkhdf::read(file)?)?.body;
        let now = moduli(scene, &stored.grid).map_err(|e| invalid(file, "multiscale", e.to_string()))?;
        let ratios = poisson_ratios(scene, &stored.grid).map_err(|e| invalid(file, "multiscale", e.to_string()))?;
        let same = |c: usize| match (stored.poisson(), &ratios) {
            (Some(stored), Some(now)) => stored[c] == now[c],
            (stored, now) => stored.is_none() && now.is_none(),
        };
        if stored.grid.body_cells().any(|c| stored.young[c] != now[c] || !same(c)) {
            let why = "it was solved with other moduli than those that [material.cells] gives now";
            return Err(invalid(file, "multiscale", why));
        }
        Ok(steps)
    }

    fn fields(scene: &Scene, run: &Run<Self>, outcomes: Option<&StochasticResult>) -> Fields {
        let solved = &run.last;
        let Trace { mesh, space, .. } = solved.trace();
        let data = OnMesh { scene, mesh, space };
        let traction = |e: usize| {
            let (point, [nx, ny]) = (mesh.point(e, 0.0), mesh.normal(e, 0.0));
            let [xx, yy, xy] = solved.at(point).1;
            (point, e, [xx * nx + xy * ny, xy * nx + yy * ny])
        };
        Fields {
            grid: cells(solved, outcomes),
            traction: (0..mesh.len()).map(traction).collect(),
            prescribed: (0..mesh.len())
                .map(|e| or_nan(data.given_traction(e, 0.0, solved.at(mesh.point(e, 0.0)).0)))
                .collect(),
            on_grid: Some(record::grid_record(solved, run.progress.steps.clone())),
            ties: Vec::new(),
        }
    }
}
