//! The picture of a body on a grid and of the medium around it.

use steklov_io::vtkhdf::Grid;
use steklov_picture::{Body, Picture, PictureError, body};
use steklov_result::record::Record;

use super::draw::deformed;
use crate::draw::{infinite, largest_displacement, units};
use crate::view::View;

/// Body and medium, deformed by the same factor and coloured by a field; None for other results.
///
/// # Errors
/// A picture that cannot be drawn.
pub(crate) fn medium(stored: &Record, view: &View) -> Result<Option<Picture>, PictureError> {
    let fields = &stored.grid;
    let Some(record) = stored.on_grid.as_ref().filter(|_| !fields.triangles.is_empty()) else { return Ok(None) };
    let of_cells = |name: &str, n: usize| Grid::field(&fields.cell_data, name, n);
    let displacement = Grid::field(&fields.point_data, "displacement", 3);
    let (Some(stress), Some(von_mises), Some(displacement)) =
        (of_cells("stress", 3), of_cells("von_mises", 1), displacement)
    else {
        return Ok(None);
    };
    let displacement: Vec<[f64; 2]> = displacement.values.chunks_exact(3).map(|u| [u[0], u[1]]).collect();
    let mut all = deformed(stored, record, &displacement, view.scalar);
    // points of the medium follow the nodes of the grid
    let (first, offset) = (record.body.grid.nodes(), all.points.len());
    let count = fields.points.len() - first;
    let (mut sums, mut counts) = (vec![0.0; count], vec![0.0; count]);
    let (stress, von_mises) = (stress.values.as_chunks().0, &von_mises.values);
    for (k, corners) in fields.triangles.iter().enumerate() {
        let cell = fields.lines.len() + k;
        for corner in corners {
            let value = view.scalar.of(displacement[*corner], stress[cell], von_mises[cell]);
            sums[corner - first] += value;
            counts[corner - first] += 1.0;
        }
    }
    all.points.extend(&fields.points[first..]);
    all.displacement.extend(&displacement[first..]);
    all.values.extend(sums.iter().zip(&counts).map(|(sum, count)| sum / count));
    all.triangles.extend(fields.triangles.iter().map(|corners| corners.map(|i| i - first + offset)));
    let (points, outline) = (&all.points, &all.outline);
    body(&Body {
        title: &format!("{}: body and medium", stored.summary.title),
        points,
        displacement: &all.displacement,
        largest: largest_displacement(stored),
        triangles: &all.triangles,
        values: &all.values,
        infinite: infinite(stored, view.scalar),
        label: view.scalar.label(),
        noun: view.scalar.noun(),
        colours: view.colours(),
        outline,
        obstacles: &[],
        window: view.window,
        most: stored.largest_factor(),
        enlarge: view.enlarge,
        units: units(stored, view.scalar),
    })
    .map(Some)
}
