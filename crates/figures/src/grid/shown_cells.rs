//! The cells of a grid that a window shows.

use std::ops::Range;

use steklov_msfem::Grid;
use steklov_picture::{CellField, Colours, Picture, PictureError, cell_fields};

/// Lower left and upper right corner.
type Rectangle = [[f64; 2]; 2];

/// Ranges of the columns and rows of cells that a window meets; all cells without a window.
fn met(grid: &Grid, window: Option<Rectangle>) -> [Range<usize>; 2] {
    [0, 1].map(|i| match window {
        None => 0..grid.cells[i],
        Some([low, high]) => {
            let place = |x: f64| ((x - grid.origin[i]) / grid.spacing[i]).clamp(0.0, grid.cells[i] as f64);
            place(low[i]).floor() as usize..place(high[i]).ceil() as usize
        }
    })
}

/// Draws a number for each cell of the bounding box under the coarse cells; None if the window has no cells.
pub(super) fn picture(
    (title, label, length): (&str, &str, Option<&str>),
    grid: &Grid,
    (values, colours): (&[f64], Colours),
    coarse: &[Rectangle],
    window: Option<Rectangle>,
) -> Result<Option<Picture>, PictureError> {
    let [columns, rows] = met(grid, window);
    if columns.is_empty() || rows.is_empty() {
        return Ok(None);
    }
    let [low, high] = [[columns.start, rows.start], [columns.end, rows.end]].map(|p| grid.lattice_point(p));
    let column = |ix: usize| &values[ix * grid.cells[1]..][rows.clone()];
    let values: Vec<f64> = columns.clone().flat_map(column).copied().collect();
    let part = |[a, b]: &Rectangle| [[0, 1].map(|i| a[i].max(low[i])), [0, 1].map(|i| b[i].min(high[i]))];
    let coarse: Vec<Rectangle> = coarse.iter().map(part).filter(|[a, b]| a[0] < b[0] && a[1] < b[1]).collect();
    let (spacing, cells) = (grid.spacing, [columns.len(), rows.len()]);
    let field = CellField {
        caption: "",
        label,
        length,
        origin: low,
        spacing,
        cells,
        values: &values,
        colours,
        coarse: &coarse,
    };
    cell_fields(title, &[field], false).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_meets_the_cells_of_which_it_shows_something() {
        let grid = Grid::new([1.0, -1.0], [0.5, 0.25], [6, 8], |_, _| true).unwrap();
        assert_eq!(met(&grid, None), [0..6, 0..8]);
        assert_eq!(met(&grid, Some([[1.6, -0.5], [2.0, 0.1]])), [1..2, 2..5]);
        assert_eq!(met(&grid, Some([[-9.0, -9.0], [9.0, 9.0]])), [0..6, 0..8]);
        assert!(met(&grid, Some([[5.0, -9.0], [9.0, 9.0]]))[0].is_empty());
    }
}
