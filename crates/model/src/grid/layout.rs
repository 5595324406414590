//! What is solved next: how fine the grid is, and which coarse cells are on it.

use steklov_bem_operators::Mesh;
use steklov_msfem::{CoarseCell, CoarseMesh, mark, refine};
use steklov_problem::{Refine, Scene, grid_of};

use super::solution::GridSolved;
use crate::error::SolveError;

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
        let coarse = match (scene.is_multiscale(), &scene.body().grid) {
            (true, Some(input)) => Some(CoarseMesh::uniform(&grid_of(scene)?, input.fine)?.cells),
            _ => None,
        };
        Ok(Self { parts: 1, coarse, around: None })
    }

    /// What is solved after this: all fine cells halved, or the marked coarse cells split, and the marked boundary elements of
    /// the medium around the body halved; None where nothing can be refined.
    ///
    /// # Errors
    /// Those of a coarse mesh.
    pub(super) fn next(&self, solved: &GridSolved, scene: &Scene, theta: f64) -> Result<Option<Self>, SolveError> {
        let marked = Marked::new(solved, scene, theta);
        let around = match &solved.around {
            Some(around) if marked.elements.contains(&true) => Some(around.mesh.bisected(&marked.elements).0),
            _ => self.around.clone(),
        };
        let refined = around != self.around;
        let Some(coarse) = &solved.coarse else {
            let parts = if marked.cells.contains(&true) { 2 * self.parts } else { self.parts };
            return Ok((refined || parts > self.parts).then_some(Self { parts, coarse: None, around }));
        };
        let cells = refine(&solved.body.grid, &coarse.mesh, &marked.cells)?.cells;
        let split = cells.len() > coarse.mesh.cells.len();
        Ok((refined || split).then_some(Self { parts: self.parts, coarse: Some(cells), around }))
    }
}

/// What is refined.
struct Marked {
    /// Coarse cells; one entry for all cells of a grid without.
    cells: Vec<bool>,
    /// Boundary elements of the medium.
    elements: Vec<bool>,
}

impl Marked {
    fn new(solved: &GridSolved, scene: &Scene, theta: f64) -> Self {
        let cells = solved.coarse.as_ref().map_or(1, |coarse| coarse.mesh.cells.len());
        let elements = solved.around.as_ref().map_or(0, |around| around.mesh.len());
        let (Some(estimate), false) = (&solved.estimate, is_uniform(scene.method.refine)) else {
            // elements between the points of the trace follow it
            let own = scene.method.elements.is_some();
            return Self { cells: vec![true; cells], elements: vec![own; elements] };
        };
        let mut squared = match &solved.coarse {
            Some(coarse) => {
                let cells = estimate.indicators.iter().zip(&coarse.mesh.cells);
                cells.map(|(eta, c): (&f64, &CoarseCell)| if c.size == [1, 1] { 0.0 } else { *eta }).collect()
            }
            None => vec![estimate.fine_grid],
        };
        squared.extend(estimate.of_elements(scene.method.indicator));
        let mut marked = mark(&squared, theta);
        let elements = marked.split_off(cells);
        Self { cells: marked, elements }
    }
}

/// Whether the grid is refined, and all of it at once.
pub(crate) fn is_uniform(refine: Refine) -> bool {
    matches!(refine, Refine::UniformH | Refine::UniformP)
}
