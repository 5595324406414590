//! Body and medium with the factors of their equations, for several loads.

use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Mat, Par};
use sprs::CsMat;
use steklov_bem_operators::TractionMap;
use steklov_msfem::Elimination;

use crate::dense::{apply, apply_transposed};
use crate::{SchurFactor, Transmission};

/// Body and medium with the factors of their equations: the sparse one of the body's inside, and those of [`crate::Form::Schur`].
#[derive(Debug)]
pub struct Factored {
    elimination: Elimination,
    projection: CsMat<f64>,
    factor: SchurFactor,
}

/// The fields of a load without jumps, decaying.
#[derive(Debug, Clone)]
pub struct Response {
    /// Unknowns of the body (length).
    pub displacement: Vec<f64>,
    /// Displacement at the nodes of the boundary elements (length).
    pub trace: Vec<f64>,
    /// Traction of the medium (stress), n out of the body.
    pub traction: Vec<f64>,
}

impl Transmission<'_> {
    /// The factors alone.
    pub fn into_factored(self, factor: SchurFactor) -> Factored {
        Factored { elimination: self.inside.elimination, projection: self.transfer.projection, factor }
    }
}

impl Factored {
    /// The map from the displacement of the medium to its traction.
    pub fn traction_map(&self) -> &TractionMap {
        &self.factor.steklov.traction
    }

    /// The solution for a load on the unknowns of the body and forces at the nodes of the boundary elements (force per thickness); None if
    /// it is not finite. *Cost*: two solutions with each factor.
    pub fn solve(&self, load: &[f64], forces: &[f64]) -> Option<Response> {
        let reduced = self.elimination.reduce(load, &[]);
        let of_trace = apply_transposed(&self.projection, forces);
        let right: Vec<f64> = reduced.kept.iter().zip(of_trace).map(|(f, t)| f + t).collect();
        let interface = self.factor.apply(&right)?;
        let trace = apply(&self.projection, &interface);
        let traction = self.traction_map().apply(&trace);
        Some(Response { displacement: self.elimination.expand(&reduced, &interface), trace, traction })
    }

    /// V⁻¹ j of values of the tractions.
    pub fn inverse_single_layer(&self, j: &[f64]) -> Vec<f64> {
        let factor = self.traction_map().parts().factor.as_ref();
        let mut solved = Mat::from_fn(j.len(), 1, |i, _| j[i]);
        solve_lower_triangular_in_place(factor, solved.as_mut(), Par::Seq);
        solve_upper_triangular_in_place(factor.transpose(), solved.as_mut(), Par::Seq);
        solved.col_as_slice(0).to_vec()
    }
}
