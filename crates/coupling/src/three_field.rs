//! Unknown displacement of the body, traction and displacement of the medium.

use faer::Mat;
use steklov_algebra::Lu;

use crate::coupled::Unknowns;
use crate::dense::solve_indefinite;
use crate::{CouplingError, Medium, Transmission};

/// Two translations and the rotation about the mean node, each of norm 1; W and K + ½M vanish on all three.
fn rigid_motions(medium: &Medium) -> Mat<f64> {
    let points = &medium.space.points;
    let centre = [0, 1].map(|i| points.iter().map(|x| x[i]).sum::<f64>() / points.len() as f64);
    let mut z = Mat::from_fn(2 * points.len(), 3, |row, k| {
        let x = points[row / 2];
        match (k, row % 2) {
            (2, 0) => centre[1] - x[1],
            (2, _) => x[0] - centre[0],
            (k, i) => f64::from(u8::from(k == i)),
        }
    });
    for k in 0..3 {
        let norm = z.col(k).norm_l2();
        (0..z.nrows()).for_each(|i| z[(i, k)] /= norm);
    }
    z
}

/// Solves [`crate::Form::ThreeField`]; ξ has no rigid motion at the nodes.
pub(crate) fn solve(problem: &Transmission<'_>, jump: &[f64]) -> Result<Option<Unknowns>, CouplingError> {
    let operators = &problem.medium.operators;
    // tractions over E: all blocks have the magnitude of a length
    let young = problem.medium.material.young;
    let z = rigid_motions(problem.medium);
    let rigid = &z * z.transpose();
    let size = jump.len();
    let scale = (0..size).fold(0.0f64, |m, i| m.max(operators.w[(i, i)])) / young;
    let n = problem.stiffness.nrows();
    let mut matrix = Mat::<f64>::zeros(n + 2 * size, n + 2 * size);
    matrix.get_mut(..n, ..n).copy_from(&problem.stiffness * faer::Scale(1.0 / young));
    // the lower triangle is enough
    for (&value, (row, column)) in &problem.transfer.mass {
        matrix[(n + row, column)] = -value;
    }
    for j in 0..size {
        for i in 0..size {
            matrix[(n + i, n + j)] = -young * operators.v[(i, j)];
            matrix[(n + size + i, n + size + j)] = operators.w[(i, j)] / young + scale * rigid[(i, j)];
            matrix[(n + size + j, n + i)] = operators.k[(i, j)];
        }
    }
    for (&value, (row, column)) in &operators.mass {
        matrix[(n + size + column, n + row)] += 0.5 * value;
    }
    let mut right: Vec<f64> = problem.load().iter().map(|f| f / young).collect();
    right.extend(operators.mass.outer_iterator().map(|row| -row.iter().map(|(j, m)| m * jump[j]).sum::<f64>()));
    right.resize(n + 2 * size, 0.0);
    let Some(mut interface) = solve_indefinite(matrix, right)? else { return Ok(None) };
    let mut traction = interface.split_off(n);
    let medium = traction.split_off(size);
    traction.iter_mut().for_each(|t| *t *= young);
    Ok(Some(Unknowns { interface, traction, medium: Some(medium) }))
}

/// ξ plus the rigid motion that brings it closest to another field, by least squares at the nodes.
pub(crate) fn with_rigid_motion_of(field: &[f64], mut xi: Vec<f64>, medium: &Medium) -> Vec<f64> {
    let z = rigid_motions(medium);
    let difference = Mat::from_fn(xi.len(), 1, |i, _| field[i] - xi[i]);
    let coefficients = Lu::new((z.transpose() * &z).as_ref()).solve((z.transpose() * difference).as_ref());
    let motion = z * coefficients;
    xi.iter_mut().enumerate().for_each(|(i, x)| *x += motion[(i, 0)]);
    xi
}
