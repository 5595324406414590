//! `/coupling`: the unbounded medium around a body, its boundary elements and fields, and a window of it.

use faer::Mat;
use steklov_bem_operators::{Mesh, Space};
use steklov_elastic::Material;
use steklov_io::{
    File, Group, IoError, create_group, invalid, label, load, load_dense, load_points, load_vector, open_group, save,
    save_dense, save_points, save_vector, vtkhdf,
};
use steklov_model::solve::medium::Around;
use steklov_model::summary::MediumSummary;

use steklov_fields::Window;

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

/// Reads `/coupling` of a body in a medium, and checks that it fits the summary and the fields of the result.
///
/// # Errors
/// A file that is not one of this program's, truncated or altered.
pub(crate) fn check(file: &File, told: Option<&MediumSummary>, fields: &vtkhdf::Grid) -> Result<(), IoError> {
    let shown = fields.cell_data.iter().any(|field| field.name == "region");
    if !shown && !file.link_exists("coupling") {
        return Ok(());
    }
    let at = open_group(file, "coupling")?;
    let mesh: Mesh = load(&at, "mesh")?;
    load::<Material>(&at, "material")?;
    let space = Space::new(&mesh);
    if load_points(&at, "points")? != space.points {
        return Err(invalid(&at, "points", "they are not the displacement nodes of its mesh"));
    }
    for name in ["displacement", "traction"] {
        check_numbers(&at, name, load_points(&at, name)?.as_flattened(), space.dofs())?;
    }
    let numbers = |name: &str, n: usize| {
        let values = load_vector(&at, name)?;
        check_numbers(&at, name, &values, n).map(|()| values)
    };
    let [constant, resultant, length] = [numbers("constant", 2)?, numbers("resultant", 2)?, numbers("length", 1)?];
    numbers("remote_stress", 3)?;
    let told = told.ok_or_else(|| invalid(&at, "", "the summary tells of no medium"))?;
    for (name, values, told) in [
        ("constant", constant, &told.constant[..]),
        ("resultant", resultant, &told.resultant[..]),
        ("length", length, &[told.length]),
    ] {
        if values != told {
            return Err(invalid(&at, name, format!("{values:?} is not {told:?}, which the summary tells")));
        }
    }
    check_window(&open_group(&at, "exterior")?, fields)
}

/// Demands `n` finite numbers.
fn check_numbers(at: &Group, name: &str, values: &[f64], n: usize) -> Result<(), IoError> {
    if values.len() != n {
        return Err(invalid(at, name, format!("{} numbers, not {n}", values.len())));
    }
    match values.iter().find(|value| !value.is_finite()) {
        Some(value) => Err(invalid(at, name, format!("{value} is not finite"))),
        None => Ok(()),
    }
}

/// The window of the medium: the last points and triangles of the fields.
fn check_window(at: &Group, fields: &vtkhdf::Grid) -> Result<(), IoError> {
    let points = load_points(at, "points")?;
    let other = |name: &str| invalid(at, name, "it is not that of the medium in /VTKHDF");
    if !fields.points.ends_with(&points) {
        return Err(other("points"));
    }
    let first = fields.points.len() - points.len();
    let shown = vtkhdf::Grid::field(&fields.point_data, "displacement", 3);
    let shown = shown.and_then(|field| field.values.get(3 * first..)).ok_or_else(|| other("displacement"))?;
    let displacement = load_points(at, "displacement")?;
    let plane = shown.chunks_exact(3).map(|u| [u[0], u[1]].map(f64::to_bits));
    if !plane.eq(displacement.iter().map(|u| u.map(f64::to_bits))) {
        return Err(other("displacement"));
    }
    let stress = load_dense(at, "stress")?;
    if (stress.nrows(), stress.ncols()) != (points.len(), 3) {
        return Err(invalid(at, "stress", format!("{}×{}, not {}×3", stress.nrows(), stress.ncols(), points.len())));
    }
    let triangles = load_dense(at, "triangles")?;
    let last = fields.triangles.len().checked_sub(triangles.nrows()).map(|k| &fields.triangles[k..]);
    let same = |(row, corners): (usize, &[usize; 3])| {
        (0..3).all(|k| corners[k].checked_sub(first).is_some_and(|corner| corner as f64 == triangles[(row, k)]))
    };
    if triangles.ncols() != 3 || !last.is_some_and(|last| last.iter().enumerate().all(same)) {
        return Err(other("triangles"));
    }
    Ok(())
}
