//! Unknown displacement of the body and traction of the medium.

use faer::Mat;

use crate::coupled::Unknowns;
use crate::dense::{apply_transposed, congruence, product, solve_indefinite, times};
use crate::{CouplingError, Transmission};

/// (K - ½M), the double layer of the medium.
pub(crate) fn double_layer(problem: &Transmission<'_>) -> Mat<f64> {
    let operators = &problem.medium.operators;
    let mut k = operators.k.clone();
    for (&value, (row, column)) in &operators.mass {
        k[(row, column)] -= 0.5 * value;
    }
    k
}

/// Solves [`crate::Form::TwoField`].
pub(crate) fn solve(problem: &Transmission<'_>, jump: &[f64]) -> Result<Option<Unknowns>, CouplingError> {
    let (operators, projection) = (&problem.medium.operators, &problem.transfer.projection);
    // tractions over E: all blocks have the magnitude of a length
    let young = problem.medium.material.young;
    let k = double_layer(problem);
    let w = congruence(operators.w.as_ref(), projection);
    let on_trace = times(k.as_ref(), projection);
    let (n, boundary) = (problem.stiffness.nrows(), jump.len());
    let matrix = Mat::from_fn(n + boundary, n + boundary, |i, j| match (i.checked_sub(n), j.checked_sub(n)) {
        (None, None) => (problem.stiffness[(i, j)] + w[(i, j)]) / young,
        (Some(i), None) => on_trace[(i, j)],
        (None, Some(j)) => on_trace[(j, i)],
        (Some(i), Some(j)) => -young * operators.v[(i, j)],
    });
    let jumped = apply_transposed(projection, &product(operators.w.as_ref(), jump));
    let mut right: Vec<f64> = problem.load().iter().zip(jumped).map(|(f, w)| (f + w) / young).collect();
    right.extend(product(k.as_ref(), jump));
    let Some(mut interface) = solve_indefinite(matrix, right)? else { return Ok(None) };
    let traction = interface.split_off(n).iter().map(|t| young * t).collect();
    Ok(Some(Unknowns { interface, traction, medium: None }))
}
