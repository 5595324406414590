//! Fields on the cells of a grid of rectangles: moduli, stresses, error indicators.

use super::body::Bounds;
use super::colours::{Colours, beyond};
use super::fields::{FieldPanel, ends, field_panels};
use super::raster::{Raster, shown};
use super::{Picture, PictureError};

/// One number in each of nx × ny equal rectangles.
#[derive(Debug, Clone, Copy)]
pub struct CellField<'a> {
    /// Text above the panel, for instance the name of a run; may be empty.
    pub caption: &'a str,
    /// Name of the values with their unit.
    pub label: &'a str,
    /// Name of the unit of lengths.
    pub length: Option<&'a str>,
    /// Lower left corner.
    pub origin: [f64; 2],
    /// Sides of a cell.
    pub spacing: [f64; 2],
    /// Cells nx, ny along x and y.
    pub cells: [usize; 2],
    /// Values (nx·ny); cell (ix, iy) has the index ix·ny + iy. NaN where there is no cell.
    pub values: &'a [f64],
    /// Values of the outer colours.
    pub colours: Colours,
    /// Rectangles drawn over the cells as thin lines, for instance the coarse cells: lower left and upper right corners.
    /// One with a side below three units of the picture or a thirtieth of the body is left out.
    pub coarse: &'a [[[f64; 2]; 2]],
}

/// Draws fields on grids with equal scales in x and y, below or beside each other, whichever draws them larger. With
/// `shared` all have the same colours, with the label of the first.
///
/// All panels show the part of the plane that contains every grid. Where cells are smaller than a pixel, a pixel has
/// the mean of its cells (and none if most of them are NaN). Unless they are given, the colours run from 0 to the
/// largest value, or from the smallest value if it is negative or if the values vary by less than half of the largest.
/// A body flatter than 1:1200 is drawn one pixel high.
///
/// A million cells take about a tenth of a second, up to a second if neighbouring pixels all differ.
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
    let &CellField { caption, label, length, origin, spacing, cells, values, colours, coarse } = field;
    assert!(cells[0] > 0 && cells[1] > 0 && values.len() == cells[0] * cells[1], "a value for each of some cells");
    assert!(spacing[0] > 0.0 && spacing[1] > 0.0, "positive sides");
    let high = [0, 1].map(|i| origin[i] + spacing[i] * cells[i] as f64);
    let pixels = move |size, ends| Raster::new(size, ends, |i, j| mean(field, size, [i, j]));
    let alike: Vec<(f64, f64)> = values.iter().map(|&v| (v, 1.0)).collect();
    let ends = colours.ends(&alike, |values| ends(values.iter().map(|v| v.0)));
    FieldPanel {
        caption,
        label,
        length,
        bounds: Bounds { low: origin, high },
        ends,
        beyond: beyond(values.iter().copied(), ends),
        pixels: Box::new(pixels),
        overlay: coarse,
    }
}

/// Mean over the cells of a pixel; rows are counted from the bottom.
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
    if 2 * count >= all { sum / count as f64 } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn field<'a>(cells: [usize; 2], values: &'a [f64]) -> CellField<'a> {
        let colours = Colours::Automatic;
        CellField {
            caption: "",
            label: "",
            length: None,
            origin: [0.0; 2],
            spacing: [1.0; 2],
            cells,
            values,
            colours,
            coarse: &[],
        }
    }

    #[test]
    fn a_pixel_is_empty_if_most_of_its_cells_are() {
        let (n, values) = (f64::NAN, [f64::NAN, 1.0, 4.0, 2.0, f64::NAN, f64::NAN]);
        let pixels = |size: [usize; 2]| -> Vec<f64> {
            let at = (0..size[1]).flat_map(|j| (0..size[0]).map(move |i| [i, j]));
            at.map(|at| mean(&field([3, 2], &values), size, at)).collect()
        };
        let same = |a: Vec<f64>, b: &[f64]| assert_eq!(format!("{a:?}"), format!("{b:?}"));
        same(pixels([3, 2]), &[n, 4.0, n, 1.0, 2.0, n]);
        same(pixels([3, 1]), &[1.0, 3.0, n]);
        same(pixels([1, 2]), &[n, 1.5]);
        same(pixels([1, 1]), &[7.0 / 3.0]);
        same(pixels([3, 4]), &[n, 4.0, n, n, 4.0, n, 1.0, 2.0, n, 1.0, 2.0, n]);
    }

    proptest! {
        #[test]
        fn means_of_equal_blocks_keep_the_mean(
            values in prop::collection::vec(-1.0f64..1.0, 240), w in prop::sample::select(vec![1, 2, 4, 5, 10, 20])
        ) {
            let field = field([20, 12], &values);
            let pixels = (0..w).flat_map(|i| (0..4).map(move |j| [i, j]));
            let sum: f64 = pixels.map(|at| mean(&field, [w, 4], at)).sum();
            prop_assert!((sum / (4 * w) as f64 - values.iter().sum::<f64>() / 240.0).abs() < 1e-14);
        }
    }
}
