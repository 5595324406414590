//! The solution of body and medium.

use crate::balance::Balance;

/// Displacements and tractions of body and medium.
#[derive(Debug, Clone)]
pub struct Coupled {
    /// Unknowns of the body (length).
    pub displacement: Vec<f64>,
    /// Displacement u of the body at the nodes of the boundary elements (length).
    pub trace: Vec<f64>,
    /// Displacement ξ = u_c of the medium there (length).
    pub exterior_displacement: Vec<f64>,
    /// Traction φ = σ(u_c)n of the medium, n out of the body, by the traction space of the boundary elements (stress).
    pub traction: Vec<f64>,
    /// Displacement a at infinity (length).
    pub constant: [f64; 2],
    /// Resultant of body force and jump of tractions. Unless it is balanced, the displacement grows as log r and its translation
    /// depends on the length L in log(L/r).
    pub balance: Balance,
}

/// The unknowns of a form of the equations.
pub(crate) struct Unknowns {
    /// Unknowns of the trace.
    pub interface: Vec<f64>,
    /// φ.
    pub traction: Vec<f64>,
    /// ξ up to a rigid motion where it is an unknown of its own.
    pub medium: Option<Vec<f64>>,
}
