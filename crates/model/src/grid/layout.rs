//! What is solved next: how fine the grid is, and which coarse cells are on it.

use steklov_bem_operators::Mesh;
use steklov_msfem::{CoarseCell, CoarseMesh};
use steklov_problem::{Scene, grid_of};

use crate::error::SolveError;

/// A grid and the coarse cells on it.
#[derive(Debug, Clone, PartialEq)]
pub struct GridLayout {
    /// Parts into which each fine cell of the scene is cut along x and y.
    pub parts: usize,
    /// Coarse cells; `None` for bilinear elements on all fine cells.
    pub coarse: Option<Vec<CoarseCell>>,
    /// Boundary elements of the medium around the body, if they are not those between the points of its trace.
    pub around: Option<Mesh>,
}

impl GridLayout {
    /// The grid that the scene asks for.
    ///
    /// # Errors
    /// A grid that rounding errors leave without a cell in the body.
    pub fn first(scene: &Scene) -> Result<Self, SolveError> {
        let coarse = match (scene.is_multiscale(), &scene.body().grid) {
            (true, Some(input)) => Some(CoarseMesh::uniform(&grid_of(scene)?, input.fine)?.cells),
            _ => None,
        };
        Ok(Self { parts: 1, coarse, around: None })
    }
}
