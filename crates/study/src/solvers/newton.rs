//! The superlinear convergence of the semi-smooth Newton method: ‖e_{k+1}‖/‖e_k‖ tends to 0.
//!
//! Source: Issaoui (2014), theorem 2.4.

use steklov_contact::newton_watched;

use super::compare::{OnMesh, gave_way};
use crate::quadratic;
use crate::table::Column;

/// Relative errors below this are rounding errors.
const ROUNDED: f64 = 1e-13;

/// An iterate of the method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Iterate {
    /// Elements of the uniform mesh.
    pub elements: usize,
    /// Its number; 0 is the start.
    pub number: usize,
    /// ⟨S e, e⟩^½ over ⟨S u, u⟩^½ of the solution u, with e the displacement of the contact unknowns minus u.
    pub error: f64,
    /// Error of the next iterate over this one; NaN for the last iterate, and if the next error is rounding.
    pub ratio: f64,
}

/// The iterates on a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Newton {
    /// Elements of the uniform mesh.
    pub elements: usize,
    /// The iterates; none if the method was replaced by the active set method at once.
    pub iterates: Vec<Iterate>,
    /// Why they do not end in the solution: there is none, or the active set method found it.
    pub failure: Option<String>,
}

/// Columns of the iterates.
pub(super) const ITERATES: [Column<Iterate>; 4] = [
    ("elements", "1", "elements of the uniform mesh, degree of the scene", |i| i.elements as f64),
    ("iterate", "1", "number of the iterate, 0 is the start", |i| i.number as f64),
    ("error", "1", "<S e, e>^(1/2) over that of the solution, e the error of the contact unknowns", |i| i.error),
    ("ratio", "1", "error of the next iterate over that; NaN of the last one, and where it is rounding", |i| i.ratio),
];

impl Newton {
    /// Solves a problem and compares the iterates with the solution, which is exact on its contact sets.
    pub(super) fn new(OnMesh { elements, problem, .. }: &OnMesh) -> Self {
        let mut unknowns: Vec<Vec<f64>> = Vec::new();
        let solved = newton_watched(problem, None, &mut |v| unknowns.push(v.to_vec()));
        let (solution, failure) = match solved {
            Err(error) => {
                return Self { elements: *elements, iterates: Vec::new(), failure: Some(error.to_string()) };
            }
            Ok(solution) => {
                let failure = gave_way(unknowns.len(), &solution);
                (solution.displacement, failure)
            }
        };
        let norm = quadratic(&problem.stiffness.full(), &solution).sqrt();
        let error = |v: &Vec<f64>| {
            let e: Vec<f64> = v.iter().zip(&solution).map(|(a, b)| a - b).collect();
            let error = quadratic(&problem.stiffness.full(), &e).max(0.0).sqrt();
            if norm > 0.0 { error / norm } else { error }
        };
        let errors: Vec<f64> = unknowns.iter().map(error).collect();
        let iterate = |k: usize| {
            let next = errors.get(k + 1).copied().filter(|next| *next > ROUNDED);
            let ratio = next.map_or(f64::NAN, |next| next / errors[k]);
            Iterate { elements: *elements, number: k, error: errors[k], ratio }
        };
        Self { elements: *elements, iterates: (0..errors.len()).map(iterate).collect(), failure }
    }
}
