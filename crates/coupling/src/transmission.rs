//! The transmission problem, reduced to the interface.

use faer::Mat;
use steklov_msfem::{Elimination, ReducedLoad};

use crate::balance::Balance;
use crate::dense;
use crate::{Coupled, CouplingError, Interior, Medium, Transfer};

/// Rounding errors of forces, over the largest stiffness times the largest displacement.
const ROUNDED: f64 = 1e-12;

/// A body and the medium around it; all unknowns of the body except those of its trace are eliminated.
///
/// ```text
/// -div σ(u) = f  in the body,        u - u_c = u0,   σ(u)n = σ(u_c)n + t0  on the interface
/// ```
/// *Use when* the medium around the body is homogeneous and goes on far beyond it: no mesh of it is needed and no boundary at
/// a distance. *Fails when* the body is far stiffer than the medium: its rigid motion loses one digit for each order of
/// magnitude, and ten of them are refused; the three-field form also loses digits for a far stiffer medium. *Cost*: the sparse
/// Cholesky factorisation of the body's stiffness down to n unknowns of the trace, three dense matrices of the boundary
/// elements with N unknowns, and the dense solution: n³/3 + 2.3 N³ by [`Form::Schur`](crate::Form::Schur), (n+N)³/3 by
/// [`Form::TwoField`](crate::Form::TwoField), (n+2N)³/3 by [`Form::ThreeField`](crate::Form::ThreeField).
///
/// Source: Costabel, *Symmetric methods for the coupling of finite elements and boundary elements*, 1987; Gatica and Hsiao,
/// *Boundary-field equation methods for a class of nonlinear problems*, 1995 (net forces and the behaviour at infinity).
#[derive(Debug)]
pub struct Transmission<'a> {
    /// The medium around the body.
    pub medium: &'a Medium,
    /// The map from the unknowns of the trace to the boundary elements.
    pub transfer: Transfer,
    /// The body's stiffness A_c, reduced to the unknowns of the trace (stress).
    pub stiffness: Mat<f64>,
    /// Resultant of body force and jump of tractions.
    pub balance: Balance,
    /// Load, reduced to the unknowns of the trace.
    load: Vec<f64>,
    /// The way back to the inside of a grid.
    pub(crate) inside: Inside,
}

/// A grid with all unknowns eliminated except those of its trace.
#[derive(Debug)]
pub(crate) struct Inside {
    pub(crate) elimination: Elimination,
    pub(crate) reduced: ReducedLoad,
    /// Load of all unknowns (force per thickness).
    load: Vec<f64>,
    /// Unknowns of the trace.
    kept: Vec<usize>,
}

impl<'a> Transmission<'a> {
    /// Eliminates the inside of the body.
    ///
    /// # Errors
    /// [`CouplingError::Boundary`] for boundary elements elsewhere, [`CouplingError::Msfem`] for moduli of too many magnitudes,
    /// [`CouplingError::Inconsistent`] for loads that are not finite.
    pub fn new(interior: Interior, medium: &'a Medium) -> Result<Self, CouplingError> {
        let Interior { stiffness, load, order, trace } = interior;
        if let Some((unknown, value)) = load.iter().enumerate().find(|(_, f)| !f.is_finite()) {
            let what = format!("the load of unknown {unknown} of the body is {value}: it must be finite");
            return Err(CouplingError::Inconsistent { what });
        }
        let transfer = Transfer::new(&trace, &medium.mesh, &medium.space)?;
        let balance = Balance::new(&load);
        let elimination = Elimination::new(stiffness, &order, &trace.unknowns, &[])?;
        let reduced = elimination.reduce(&load, &[]);
        let (stiffness, kept_load) = (elimination.stiffness()?, reduced.kept.clone());
        let inside = Inside { elimination, reduced, load, kept: trace.unknowns };
        Ok(Self { medium, transfer, stiffness, balance, load: kept_load, inside })
    }

    /// Load of the body, reduced to the unknowns of the trace (force per thickness).
    pub fn load(&self) -> &[f64] {
        &self.load
    }

    /// How far the forces of a solution by [`Form::TwoField`](crate::Form::TwoField) or [`Form::Schur`](crate::Form::Schur) are out of balance,
    /// max|A u + Πᵀ S(ξ - a) - F| / (max|A u| + max|F|) over all unknowns of the body: roundoff, which grows with the stiffness of
    /// the body over that of the medium. 0 where nothing acts, and where the body moves as a whole up to roundoff.
    pub fn imbalance(&self, solved: &Coupled) -> f64 {
        let of_medium = dense::apply_transposed(&self.transfer.projection, &self.medium.forces(solved).0);
        let Inside { elimination, load, kept, .. } = &self.inside;
        let mut forces = elimination.multiply(&solved.displacement);
        let largest = |values: &[f64]| values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let scale = largest(&forces) + largest(load);
        kept.iter().zip(&of_medium).for_each(|(&u, f)| forces[u] += f);
        let worst = forces.iter().zip(load).fold(0.0f64, |m, (a, f)| m.max((a - f).abs()));
        let rounding = ROUNDED * elimination.largest_diagonal() * largest(&solved.displacement);
        if worst > rounding { worst / scale } else { 0.0 }
    }

    /// Largest diagonal entry of A_c over that of W.
    pub(crate) fn contrast(&self) -> f64 {
        let largest = |m: &Mat<f64>| (0..m.nrows()).fold(0.0f64, |l, i| l.max(m[(i, i)]));
        largest(&self.stiffness) / largest(&self.medium.operators.w)
    }
}
