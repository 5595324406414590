//! Unknown displacement of the body; the traction of the medium by its Steklov-Poincaré operator.

use faer::Mat;
use sprs::CsMat;
use steklov_bem_operators::{Domain, Steklov};

use crate::coupled::Unknowns;
use crate::dense::{Definite, apply, apply_transposed, congruence, product};
use crate::{CouplingError, Transmission};

/// The factor of A_c + Πᵀ S Π, and S.
#[derive(Debug)]
pub struct SchurFactor {
    pub(crate) steklov: Steklov,
    factor: Definite,
}

impl SchurFactor {
    /// None if the matrix is not definite.
    pub(crate) fn new(problem: &Transmission<'_>) -> Result<Option<Self>, CouplingError> {
        let steklov = Steklov::new(problem.medium.operators.clone(), Domain::Exterior)?;
        let matrix = &problem.stiffness + congruence(steklov.matrix.as_ref(), &problem.transfer.projection);
        Ok(Definite::new(matrix)?.map(|factor| Self { steklov, factor }))
    }

    /// (A_c + Πᵀ S Π)⁻¹ f; None if it is not finite.
    pub(crate) fn apply(&self, load: &[f64]) -> Option<Vec<f64>> {
        let solved = self.factor.solve(Mat::from_fn(load.len(), 1, |i, _| load[i]))?;
        Some(solved.col_as_slice(0).to_vec())
    }

    /// Solves [`crate::Form::Schur`] for a load of the trace and a jump.
    pub(crate) fn solve(&self, projection: &CsMat<f64>, load: &[f64], jump: &[f64]) -> Option<Unknowns> {
        let jumped = apply_transposed(projection, &product(self.steklov.matrix.as_ref(), jump));
        let right: Vec<f64> = load.iter().zip(jumped).map(|(f, s)| f + s).collect();
        let interface = self.apply(&right)?;
        let medium: Vec<f64> = apply(projection, &interface).iter().zip(jump).map(|(u, u0)| u - u0).collect();
        Some(Unknowns { interface, traction: self.steklov.traction.apply(&medium), medium: None })
    }
}
