//! The next grid: which cells and boundary elements are refined.

use steklov_msfem::{CoarseCell, mark, refine};
use steklov_problem::{Refine, Scene};

use super::layout::GridLayout;
use super::solution::GridSolved;
use crate::error::SolveError;

/// The layout after this one: all fine cells halved, or the marked coarse cells split, and the marked boundary elements of the
/// medium around the body halved; None where nothing can be refined.
///
/// # Errors
/// Those of a coarse mesh.
pub(super) fn next_layout(
    layout: &GridLayout,
    solved: &GridSolved,
    scene: &Scene,
    theta: f64,
) -> Result<Option<GridLayout>, SolveError> {
    let marked = Marked::new(solved, scene, theta);
    let around = match &solved.around {
        Some(around) if marked.elements.contains(&true) => Some(around.mesh.bisected(&marked.elements).0),
        _ => layout.around.clone(),
    };
    let refined = around != layout.around;
    let Some(coarse) = &solved.coarse else {
        let parts = if marked.cells.contains(&true) { 2 * layout.parts } else { layout.parts };
        return Ok((refined || parts > layout.parts).then_some(GridLayout { parts, coarse: None, around }));
    };
    let cells = refine(&solved.body.grid, &coarse.mesh, &marked.cells)?.cells;
    let split = cells.len() > coarse.mesh.cells.len();
    Ok((refined || split).then_some(GridLayout { parts: layout.parts, coarse: Some(cells), around }))
}

/// The parts that are refined.
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
        let (Some(estimate), false) =
            (&solved.estimate, matches!(scene.method.refine, Refine::UniformH | Refine::UniformP))
        else {
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
