//! The last mesh of a run, by which other processes answer outcomes without the steps that led to it.

use serde::{Deserialize, Serialize};
use steklov_bem_operators::{Mark, Mesh, PairCache, Piece, Subdivision};
use steklov_contact::Solution;
use steklov_msfem::CoarseCell;
use steklov_problem::{Random, Scene};
use steklov_stochastic::solve_points;

use super::number::numbers;
use super::on_grid::{OutcomesOnGrid, kept};
use super::outcomes::{Answer, Outcomes};
use crate::error::SolveError;
use crate::estimate::error_estimate::is_estimated;
use crate::grid::GridLayout;
use crate::solve::body::Body;
use crate::solve::one_mesh::solve;

/// The last mesh of a run, without what the scene says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum LastMesh {
    /// Edge parameters at the start and at the end of the boundary elements of each edge, and their degrees.
    Elements(Vec<Vec<(f64, f64, usize)>>),
    /// Parts into which each fine cell of the scene is cut along x and y; the first fine cell and the size of each coarse cell,
    /// if there are any.
    Grid(usize, Option<Vec<[[usize; 2]; 2]>>),
}

impl LastMesh {
    pub(crate) fn of_elements(mesh: &Mesh) -> Self {
        let Subdivision { edges } = Subdivision::new(mesh, &vec![Mark::Keep; mesh.len()]);
        let plain = |pieces: &Vec<Piece>| pieces.iter().map(|piece| (piece.start, piece.end, piece.degree)).collect();
        Self::Elements(edges.iter().map(plain).collect())
    }

    pub(crate) fn of_grid(layout: &GridLayout) -> Self {
        let plain = |cells: &Vec<CoarseCell>| cells.iter().map(|cell| [cell.first, cell.size]).collect();
        Self::Grid(layout.parts, layout.coarse.as_ref().map(plain))
    }
}

/// What outcomes on a last mesh are answered with.
pub enum Prepared {
    /// The matrices of boundary elements.
    Body(Box<Body>),
    /// A grid, whose matrices each outcome has for itself.
    Grid(Box<GridLayout>),
}

impl Prepared {
    /// A scene on the last mesh of its run.
    ///
    /// *Cost*: of boundary elements that of a single mesh.
    ///
    /// # Errors
    /// [`SolveError::Bem`] for a mesh of another scene; those of [`solve`](crate::solve()) for a single mesh.
    pub fn new(scene: &Scene, last: &LastMesh) -> Result<Self, SolveError> {
        match last {
            LastMesh::Elements(edges) => {
                let piece = |&(start, end, degree): &_| Piece { start, end, degree, mark: Mark::Keep };
                let edges = edges.iter().map(|pieces| pieces.iter().map(piece).collect()).collect();
                let subdivision = Subdivision { edges };
                let mesh = subdivision.mesh(&scene.problem.outline)?;
                let estimated = is_estimated(scene, subdivision.dofs());
                let (_, body, _) = solve(scene, (mesh, None), estimated, &mut PairCache::default(), &mut |_| Ok(()))?;
                Ok(Self::Body(Box::new(body)))
            }
            LastMesh::Grid(parts, coarse) => {
                let cell = |&[first, size]: &[[usize; 2]; 2]| CoarseCell { first, size };
                let coarse = coarse.as_ref().map(|cells| cells.iter().map(cell).collect());
                Ok(Self::Grid(Box::new(GridLayout { parts: *parts, coarse, around: None })))
            }
        }
    }

    /// The answers to outcomes by their germs, in the order of these.
    ///
    /// # Errors
    /// As [`solve_stochastic`](super::solve_stochastic).
    pub fn answers(&self, scene: &Scene, random: &Random, germs: &[Vec<f64>]) -> Result<Vec<Answer>, SolveError> {
        match self {
            Self::Body(body) => {
                let outcomes = Outcomes::new(scene, random, body)?;
                solve_points(germs.len(), |i, warm: &mut Option<Solution>| outcomes.answer(&germs[i], warm))
            }
            Self::Grid(layout) => {
                let numbers = numbers(scene, random)?;
                let outcomes = OutcomesOnGrid::new(scene.clone(), random, (**layout).clone())?;
                solve_points(germs.len(), |i, _: &mut Option<Solution>| {
                    outcomes.solve(&germs[i]).map(|(scene, solved)| kept(&scene, &solved, &numbers))
                })
            }
        }
    }
}
