//! The cells of the medium in `/VTKHDF`, beside those of the body.

use steklov_model::solve::medium::Around;
use steklov_unstructured::{Field, Grid};

use crate::window::Window;

/// The cell field that distinguishes body and medium.
const REGION: &str = "region";

/// Adds the triangles of a window of the medium after those of the body, and the cell field `region`: 0 of the body, 1
/// of the medium. A point field gets the medium's values at its points, a cell field the means over the corners.
pub fn add_medium(grid: &mut Grid, around: &Around, window: &Window) {
    let first = grid.points.len();
    // cells are lines, triangles, quadrilaterals
    let before = grid.lines.len() + grid.triangles.len();
    let mut region = vec![0.0; before + grid.quads.len()];
    region.splice(before..before, vec![1.0; window.triangles.len()]);
    let means = window.triangles.iter().map(|corners| {
        let mean = |value: &dyn Fn(usize) -> f64| corners.iter().map(|&i| value(i)).sum::<f64>() / 3.0;
        let displacement = [0, 1].map(|k| mean(&|i| window.values[i].0[k]));
        (displacement, [0, 1, 2].map(|k| mean(&|i| window.values[i].1[k])))
    });
    let means: Vec<_> = means.collect();
    for field in &mut grid.point_data {
        field.values.extend(values(around, &field.name, &window.values));
    }
    for field in &mut grid.cell_data {
        let at = field.components * before;
        field.values.splice(at..at, values(around, &field.name, &means));
    }
    grid.points.extend(&window.points);
    grid.triangles.extend(window.triangles.iter().map(|corners| corners.map(|i| first + i)));
    let unit = "0 body, 1 medium around it".into();
    grid.cell_data.push(Field { name: REGION.into(), unit, components: 1, values: region });
}

/// Number of points and the triangles of the body, without those of the medium around it.
pub fn body_part(grid: &Grid) -> (usize, &[[usize; 3]]) {
    let region = Grid::field(&grid.cell_data, REGION, 1);
    let of_medium = |k: &usize| region.and_then(|r| r.values.get(grid.lines.len() + k)).is_some_and(|&r| r != 0.0);
    let first = (0..grid.triangles.len()).find(of_medium).unwrap_or(grid.triangles.len());
    let (body, medium) = grid.triangles.split_at(first);
    (medium.iter().flatten().copied().min().unwrap_or(grid.points.len()), body)
}

/// The values of a field by its name: displacement, stress, von Mises stress, else Young's modulus.
fn values(around: &Around, name: &str, at: &[([f64; 2], [f64; 3])]) -> Vec<f64> {
    match name {
        "displacement" => at.iter().flat_map(|(u, _)| [u[0], u[1], 0.0]).collect(),
        "stress" => at.iter().flat_map(|(_, s)| *s).collect(),
        "von_mises" => at.iter().map(|(_, s)| around.material.von_mises(*s)).collect(),
        _ => vec![around.material.young; at.len()],
    }
}
