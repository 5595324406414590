//! The picture of a body on a grid and of the medium around it.

use steklov_picture::{Body, Picture, PictureError, body};
use steklov_result::record::Record;

use super::draw::deformed;
use crate::draw::largest_displacement;
use crate::view::View;

/// Body and medium, deformed alike, by their von Mises stress; none of other results.
///
/// # Errors
/// A picture that cannot be drawn.
pub(crate) fn medium(stored: &Record, view: &View) -> Result<Option<Picture>, PictureError> {
    let fields = &stored.grid;
    let Some(record) = stored.on_grid.as_ref().filter(|_| !fields.triangles.is_empty()) else { return Ok(None) };
    let stress = fields.cell_data.iter().find(|f| f.name == "von_mises" && f.components == 1);
    let displacement = fields.point_data.iter().find(|f| f.name == "displacement" && f.components == 3);
    let (Some(stress), Some(displacement)) = (stress, displacement) else { return Ok(None) };
    let displacement: Vec<[f64; 2]> = displacement.values.chunks_exact(3).map(|u| [u[0], u[1]]).collect();
    let mut all = deformed(stored, record, &displacement);
    // points of the medium stand behind the nodes of the grid
    let (first, offset) = (record.body.grid.nodes(), all.points.len());
    let count = fields.points.len() - first;
    let (mut sums, mut counts) = (vec![0.0; count], vec![0.0; count]);
    for (corners, value) in fields.triangles.iter().zip(&stress.values[fields.lines.len()..]) {
        for corner in corners {
            sums[corner - first] += value;
            counts[corner - first] += 1.0;
        }
    }
    all.points.extend(&fields.points[first..]);
    all.displacement.extend(&displacement[first..]);
    all.von_mises.extend(sums.iter().zip(&counts).map(|(sum, count)| sum / count));
    all.triangles.extend(fields.triangles.iter().map(|corners| corners.map(|i| i - first + offset)));
    let (points, outline) = (&all.points, &all.outline);
    body(&Body {
        title: &format!("{}: body and medium", stored.summary.title),
        points,
        displacement: &all.displacement,
        largest: largest_displacement(stored),
        triangles: &all.triangles,
        von_mises: &all.von_mises,
        colours: view.colours(),
        outline,
        obstacles: &[],
    })
    .map(Some)
}
