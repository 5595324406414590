//! What is solved next: how fine the grid is, and which coarse cells are on it.

use steklov_bem_operators::Mesh;
use steklov_msfem::{CoarseCell, CoarseMesh, mark, refine};

use super::grid_of;
use super::solve::GridSolved;
use crate::scene::{Refine, Scene};
use crate::solve::SolveError;

/// A grid and the coarse cells on it.
#[derive(Debug, Clone, PartialEq)]
pub struct GridLayout {
    /// Parts into which each fine cell of the scene is cut along x and y.
    pub parts: usize,
    /// Coarse cells; None of bilinear elements on all fine cells.
    pub coarse: Option<Vec<CoarseCell>>,
    /// Boundary elements of the medium around the body, where they are not those between the points of its trace.
    pub around: Option<Mesh>,
}

impl GridLayout {
    /// The grid that the scene asks for.
    ///
    /// # Errors
    /// A grid that rounding errors leave without a cell in the body.
    pub fn first(scene: &Scene) -> Result<Self, SolveError> {
        let coarse = match (scene.is_multiscale(), &scene.grid) {
            (true, Some(input)) => Some(CoarseMesh::uniform(&grid_of(scene)?, input.fine)?.cells),
            _ => None,
        };
        Ok(Self { parts: 1, coarse, around: None })
    }

    /// What is solved after this: all fine cells halved, or the marked coarse cells split; None where nothing can be split.
    ///
    /// # Errors
    /// Those of a coarse mesh.
    pub(super) fn next(&self, solved: &GridSolved, refinement: Refine, theta: f64) -> Result<Option<Self>, SolveError> {
        let Some(coarse) = &solved.coarse else { return Ok(Some(Self { parts: 2 * self.parts, coarse: None, around: None })) };
        let marked = match &solved.estimate {
            Some(estimate) if !is_uniform(refinement) => {
                let cells = estimate.indicators.iter().zip(&coarse.mesh.cells);
                let of_those_that_can_be_split =
                    |(eta, c): (&f64, &CoarseCell)| if c.size == [1, 1] { 0.0 } else { *eta };
                mark(&cells.map(of_those_that_can_be_split).collect::<Vec<_>>(), theta)
            }
            _ => vec![true; coarse.mesh.cells.len()],
        };
        let cells = refine(&solved.medium.grid, &coarse.mesh, &marked)?.cells;
        Ok((cells.len() > coarse.mesh.cells.len()).then_some(Self { parts: self.parts, coarse: Some(cells), around: None }))
    }
}

/// Whether the grid is refined, and all of it at once.
pub(crate) fn is_uniform(refine: Refine) -> bool {
    matches!(refine, Refine::UniformH | Refine::UniformP)
}
