//! The difference of the stresses of two results on grids.

use steklov_picture::{Colours, Picture, PictureError, in_unit};
use steklov_result::record::Record;

use super::draw::on_cells;
use super::shown_cells;
use crate::draw::units;
use crate::view::Scalar;

/// The difference of the von Mises stresses of two results, on the cells of the first.
pub struct Difference {
    /// On each cell of the bounding box: the value of the first result minus the mean of the other over the cell; NaN
    /// outside of the body.
    pub values: Vec<f64>,
    /// Its root mean square over the cells.
    pub root_mean_square: f64,
    /// Root mean square of the other stress itself.
    pub of_stress: f64,
}

/// Compares two results on grids; None unless both have the same rectangle and the other's cells divide the cells of
/// the first into equal parts.
pub fn difference(first: &Record, other: &Record) -> Option<Difference> {
    let (grid, finer) = (&first.on_grid.as_ref()?.body.grid, &other.on_grid.as_ref()?.body.grid);
    let [fine, coarse] = [other, first].map(|record| {
        let of_grid = record.on_grid.as_ref();
        of_grid.map_or(Vec::new(), |of_grid| on_cells(record, of_grid, Scalar::VonMises))
    });
    let parts = [0, 1].map(|i| finer.cells[i] / grid.cells[i]);
    let fits = |i: usize| {
        let near = 1e-9 * grid.spacing[i];
        finer.cells[i] == parts[i] * grid.cells[i]
            && (finer.spacing[i] * parts[i] as f64 - grid.spacing[i]).abs() < near
            && (finer.origin[i] - grid.origin[i]).abs() < near
    };
    if !(0..2).all(fits) {
        return None;
    }
    let mean = |cell: usize| {
        let (ix, iy) = (cell / grid.cells[1], cell % grid.cells[1]);
        let of = |k: usize| fine[(ix * parts[0] + k / parts[1]) * finer.cells[1] + iy * parts[1] + k % parts[1]];
        (0..parts[0] * parts[1]).map(of).sum::<f64>() / (parts[0] * parts[1]) as f64
    };
    let means: Vec<f64> = (0..coarse.len()).map(mean).collect();
    let values: Vec<f64> = coarse.iter().zip(&means).map(|(a, b)| a - b).collect();
    let square = |values: &[f64]| {
        let known = values.iter().filter(|v| v.is_finite());
        (known.clone().map(|v| v * v).sum::<f64>() / known.count().max(1) as f64).sqrt()
    };
    Some(Difference { root_mean_square: square(&values), of_stress: square(&means), values })
}

/// Draws a difference from `-largest` to `largest`; None if there is nothing to draw.
///
/// # Errors
/// A picture that cannot be drawn.
pub fn difference_picture(
    title: &str,
    first: &Record,
    difference: &Difference,
    largest: f64,
) -> Result<Option<Picture>, PictureError> {
    let Some(record) = &first.on_grid else { return Ok(None) };
    let [length, unit] = units(first, Scalar::VonMises);
    let label = in_unit("difference of the von Mises stress", unit);
    let colours = Colours::Range([-largest, largest]);
    shown_cells::picture((title, &label, length), &record.body.grid, (&difference.values, colours), &[], None)
}
