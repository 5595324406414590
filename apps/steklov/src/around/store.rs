//! `/coupling`: boundary elements of the medium, their fields, and a window of it.

use faer::Mat;
use steklov_io::{File, IoError, Label, create_group, save, save_dense, save_points, save_vector};

use super::{Around, Window};

fn label<'a>(unit: &'a str, meaning: &'a str, axes: &'a [&'a str]) -> Label<'a> {
    Label { unit, meaning, axes }
}

/// Writes `/coupling`.
///
/// # Errors
/// When the file cannot be written.
pub(crate) fn write(file: &File, around: &Around, window: &Window) -> Result<(), IoError> {
    let at = create_group(file, "coupling")?;
    let pairs = |values: &[f64]| -> Vec<[f64; 2]> { values.chunks_exact(2).map(|u| [u[0], u[1]]).collect() };
    let (node, axis) = (&["node", "component"], &["component"]);
    save(&at, "mesh", &around.mesh)?;
    save(&at, "material", &around.material)?;
    save_points(
        &at,
        "points",
        &around.space.points,
        &label("length", "displacement nodes of the boundary elements", node),
    )?;
    let meaning = "displacement of the medium there, that of the remote stress apart";
    save_points(&at, "displacement", &pairs(&around.displacement), &label("length", meaning, node))?;
    let meaning = "traction sigma(u_c) n of the medium, n out of the body: Legendre coefficients element by element, that of the remote stress apart";
    save_points(&at, "traction", &pairs(&around.traction), &label("stress", meaning, &["coefficient", "component"]))?;
    let meaning = "displacement at infinity, that of the remote stress apart";
    save_vector(&at, "constant", &around.constant, &label("length", meaning, axis))?;
    let meaning = "resultant of the loads, the remote stress apart";
    save_vector(&at, "resultant", &around.balance.force, &label("force/thickness", meaning, axis))?;
    let stress = &["xx, yy, xy"];
    save_vector(&at, "remote_stress", &around.remote_stress, &label("stress", "stress far away", stress))?;
    save_vector(&at, "length", &[around.length], &label("length", "L in log(L/r)", &["value"]))?;

    let at = create_group(&at, "exterior")?;
    let point = &["point", "component"];
    save_points(&at, "points", &window.points, &label("length", "points of a window of the medium", point))?;
    let u: Vec<[f64; 2]> = window.values.iter().map(|(u, _)| *u).collect();
    save_points(&at, "displacement", &u, &label("length", "displacement, that of the remote stress included", point))?;
    let sigma = Mat::from_fn(window.values.len(), 3, |i, k| window.values[i].1[k]);
    let meaning = label("stress", "sigma_xx, sigma_yy, sigma_xy, the remote stress included", point);
    save_dense(&at, "stress", sigma.as_ref(), &meaning)?;
    let corner = |i: usize, k: usize| window.triangles[i][k] as f64;
    let triangles = Mat::from_fn(window.triangles.len(), 3, corner);
    save_dense(&at, "triangles", triangles.as_ref(), &label("1", "points of each triangle", &["triangle", "corner"]))
}
