//! Fields on the cells of a grid of rectangles: moduli, stresses, error indicators.

use super::body::Bounds;
use super::fields::{FieldPanel, ends, field_panels};
use super::raster::{Raster, shown};
use super::{Picture, PictureError};

/// One number in each of nx × ny equal rectangles.
#[derive(Debug, Clone, Copy)]
pub struct CellField<'a> {
    /// What stands above the panel, for instance the name of a run; may be empty.
    pub caption: &'a str,
    /// What the values are, with their unit.
    pub label: &'a str,
    /// Lower left corner.
    pub origin: [f64; 2],
    /// Sides of a cell.
    pub spacing: [f64; 2],
    /// Cells nx, ny along x and y.
    pub cells: [usize; 2],
    /// Values (nx·ny), that of cell (ix, iy) at ix·ny + iy; NaN where there is no cell.
    pub values: &'a [f64],
    /// Rectangles drawn over the cells as thin lines, for instance the coarse cells: lower left and upper right corners.
    /// One with a side below three units of the picture is left out.
    pub coarse: &'a [[[f64; 2]; 2]],
}

/// Draws fields on grids with equal scales in x and y, below or beside each other, whichever draws them larger; with
/// `shared` all are coloured alike, under the label of the first.
///
/// All panels show the part of the plane that contains every grid. Where cells are smaller than a pixel, a pixel has the mean
/// of its cells (and none if most of them are NaN). The colours run from 0 to the largest value, from the smallest one if
/// the values vary by less than half of the largest, or from the smallest one if it is negative. A body flatter than
/// 1:1200 is drawn one pixel high.
///
/// A million cells take about a tenth of a second.
///
/// # Errors
/// [`PictureError::Raster`] if the pixels cannot be made.
///
/// # Panics
/// If a grid has no cell, a side that is not positive, or not a value for each cell.
pub fn cell_fields(title: &str, fields: &[CellField<'_>], shared: bool) -> Result<Picture, PictureError> {
    let panels: Vec<FieldPanel<'_>> = fields.iter().map(panel).collect();
    field_panels(title, &panels, 1..=fields.len().max(1), shared)
}

fn panel<'a>(field: &'a CellField<'a>) -> FieldPanel<'a> {
    let &CellField { caption, label, origin, spacing, cells, values, coarse } = field;
    assert!(cells[0] > 0 && cells[1] > 0 && values.len() == cells[0] * cells[1], "a value for each of some cells");
    assert!(spacing[0] > 0.0 && spacing[1] > 0.0, "positive sides");
    let high = [0, 1].map(|i| origin[i] + spacing[i] * cells[i] as f64);
    let pixels = move |size, ends| Raster::new(size, ends, |i, j| mean(field, size, [i, j]));
    FieldPanel {
        caption,
        label,
        bounds: Bounds { low: origin, high },
        ends: ends(values.iter().copied()),
        pixels: Box::new(pixels),
        overlay: coarse,
    }
}

/// Mean over the cells of a pixel, rows counted from the bottom.
fn mean(field: &CellField<'_>, size: [usize; 2], at: [usize; 2]) -> f64 {
    let [columns, rows] = [0, 1].map(|i| shown(at[i], size[i], field.cells[i]));
    let (mut sum, mut count, all) = (0.0, 0, columns.len() * rows.len());
    for ix in columns {
        let column = &field.values[ix * field.cells[1]..][rows.clone()];
        for v in column.iter().filter(|v| !v.is_nan()) {
            sum += v;
            count += 1;
        }
    }
    if 2 * count >= all { sum / f64::from(count as u32) } else { f64::NAN }
}
