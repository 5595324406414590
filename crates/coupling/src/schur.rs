//! Unknown displacement of the body; the traction of the medium by its Steklov-Poincaré operator.

use faer::Mat;
use steklov_bem_operators::{Domain, Steklov};

use crate::coupled::Unknowns;
use crate::dense::{apply, apply_transposed, congruence, product, solve_definite};
use crate::{CouplingError, Transmission};

/// Solves [`crate::Form::Schur`].
pub(crate) fn solve(problem: &Transmission<'_>, jump: &[f64]) -> Result<Option<Unknowns>, CouplingError> {
    let projection = &problem.transfer.projection;
    let steklov = Steklov::new(problem.medium.operators.clone(), Domain::Exterior)?;
    let matrix = &problem.stiffness + congruence(steklov.matrix.as_ref(), projection);
    let jumped = apply_transposed(projection, &product(steklov.matrix.as_ref(), jump));
    let right = Mat::from_fn(jumped.len(), 1, |i, _| problem.load()[i] + jumped[i]);
    let Some(interface) = solve_definite(matrix, right)? else { return Ok(None) };
    let interface = interface.col_as_slice(0).to_vec();
    let medium: Vec<f64> = apply(projection, &interface).iter().zip(jump).map(|(u, u0)| u - u0).collect();
    Ok(Some(Unknowns { interface, traction: steklov.traction.apply(&medium), medium: None }))
}
