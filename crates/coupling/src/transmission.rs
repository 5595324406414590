//! The transmission problem, reduced to the interface.

use faer::Mat;
use steklov_msfem::{Elimination, ReducedLoad};

use crate::balance::Balance;
use crate::{CouplingError, Form, Interior, Medium, Radiation, Transfer, three_field, two_field};
use crate::{dense, schur};

/// Stiffness of the body over that of the medium from which too few digits are left.
const CONTRAST: f64 = 1e10;

/// A body and the medium around it; all unknowns of the body but those of its trace are eliminated.
///
/// ```text
/// -div σ(u) = f  in the body,        u - u_c = u0,   σ(u)n = σ(u_c)n + t0  on the interface
/// ```
/// *Use when* the medium around the body is homogeneous and goes on far beyond it: no mesh of it is needed and no boundary at a
/// distance. *Fails when* the body is far stiffer than the medium: its rigid motion loses as many digits as it is stiffer by
/// magnitudes, and by ten of them it is refused; the three-field form loses digits the other way, too. *Cost*: the sparse Cholesky
/// factorisation of the body's stiffness down to n unknowns of the trace, three dense matrices of the boundary elements with
/// N unknowns, and the dense solution: n³/3 + 2.3 N³ by [`Form::Schur`], (n+N)³/3 by [`Form::TwoField`], (n+2N)³/3 by
/// [`Form::ThreeField`].
///
/// # Source
/// Costabel, *Symmetric methods for the coupling of finite elements and boundary elements*, 1987; Gatica and Hsiao,
/// *Boundary-field equation methods for a class of nonlinear problems*, 1995 (net forces and the behaviour at infinity).
#[derive(Debug)]
pub struct Transmission<'a> {
    /// The medium around the body.
    pub medium: &'a Medium,
    /// From the unknowns of the trace to the boundary elements.
    pub transfer: Transfer,
    /// The body's stiffness A_c, reduced to the unknowns of the trace (stress).
    pub stiffness: Mat<f64>,
    /// Resultant of body force and jump of tractions.
    pub balance: Balance,
    /// Load, reduced to the unknowns of the trace.
    load: Vec<f64>,
    /// The way back to the inside of a grid.
    inside: Inside,
}

/// A grid whose unknowns are eliminated but for those of its trace.
#[derive(Debug)]
struct Inside {
    elimination: Elimination,
    reduced: ReducedLoad,
    /// Load of all unknowns (force per thickness).
    load: Vec<f64>,
    /// Unknowns of the trace.
    kept: Vec<usize>,
}

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

/// What a form of the equations is solved for.
pub(crate) struct Unknowns {
    /// Unknowns of the trace.
    pub interface: Vec<f64>,
    /// φ.
    pub traction: Vec<f64>,
    /// ξ up to a rigid motion where it is an unknown of its own.
    pub medium: Option<Vec<f64>>,
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

    /// Solves for a jump u0 of displacements (length), given at the nodes of the boundary elements, interleaved.
    ///
    /// # Errors
    /// [`CouplingError::Inconsistent`] for a jump of another size or one that is not finite, [`CouplingError::Unbalanced`] for
    /// a resultant and [`Radiation::Bounded`], [`CouplingError::Contrast`], [`CouplingError::Singular`].
    pub fn solve(&self, jump: &[f64], form: Form, radiation: Radiation) -> Result<Coupled, CouplingError> {
        let needed = self.medium.space.dofs();
        if jump.len() != needed {
            let what =
                format!("the jump of displacements has {} values, and the boundary elements {needed}", jump.len());
            return Err(CouplingError::Inconsistent { what });
        }
        if let Some((k, value)) = jump.iter().enumerate().find(|(_, u)| !u.is_finite()) {
            let [x, y] = self.medium.space.points[k / 2];
            let what = format!("the jump of displacements is {value} at ({x}, {y}): it must be finite");
            return Err(CouplingError::Inconsistent { what });
        }
        if radiation == Radiation::Bounded {
            self.balance.check()?;
        }
        let contrast = self.contrast();
        let lost = if form == Form::ThreeField { contrast.max(1.0 / contrast) } else { contrast };
        if lost >= CONTRAST || !lost.is_finite() {
            return Err(CouplingError::Contrast { contrast, limit: CONTRAST });
        }
        let solved = match form {
            Form::TwoField => two_field::solve(self, jump)?,
            Form::ThreeField => three_field::solve(self, jump)?,
            Form::Schur => schur::solve(self, jump)?,
        };
        let solved = solved.ok_or(CouplingError::Singular { size: self.stiffness.nrows(), contrast })?;
        let displacement = self.inside.elimination.expand(&self.inside.reduced, &solved.interface);
        let trace = dense::apply(&self.transfer.projection, &solved.interface);
        let exterior_displacement: Vec<f64> = trace.iter().zip(jump).map(|(u, u0)| u - u0).collect();
        let exterior_displacement = match solved.medium {
            Some(medium) => three_field::with_rigid_motion_of(&exterior_displacement, medium, self.medium),
            None => exterior_displacement,
        };
        let mut coupled = Coupled {
            displacement,
            trace,
            exterior_displacement,
            traction: solved.traction,
            constant: [0.0; 2],
            balance: self.balance,
        };
        if radiation == Radiation::Bounded {
            coupled.remove_mean(self.medium);
        }
        Ok(coupled)
    }

    /// How far the forces of a solution by [`Form::TwoField`] or [`Form::Schur`] are out of balance,
    /// max|A u + Πᵀ S(ξ - a) - F| / (max|A u| + max|F|) over all unknowns of the body: roundoff, which grows with the stiffness of
    /// the body over that of the medium. 0 where nothing acts.
    pub fn imbalance(&self, solved: &Coupled) -> f64 {
        let of_medium = dense::apply_transposed(&self.transfer.projection, &self.medium.forces(solved).0);
        let Inside { elimination, load, kept, .. } = &self.inside;
        let mut forces = elimination.multiply(&solved.displacement);
        let largest = |values: &[f64]| values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let scale = largest(&forces) + largest(load);
        kept.iter().zip(&of_medium).for_each(|(&u, f)| forces[u] += f);
        let worst = forces.iter().zip(load).fold(0.0f64, |m, (a, f)| m.max((a - f).abs()));
        if scale > 0.0 { worst / scale } else { 0.0 }
    }

    /// Largest diagonal entry of A_c over that of W.
    fn contrast(&self) -> f64 {
        let largest = |m: &Mat<f64>| (0..m.nrows()).fold(0.0f64, |l, i| l.max(m[(i, i)]));
        largest(&self.stiffness) / largest(&self.medium.operators.w)
    }
}

impl Coupled {
    /// Moves body and medium so that the mean of u over the interface vanishes.
    ///
    /// With a free, u, u_c and a have one constant in common: V φ = (K - ½) ξ + a is unchanged, (K - ½) 1 being -1, and where
    /// the loads have no resultant φ has none, so that the decaying solution is one of the bounded ones.
    fn remove_mean(&mut self, medium: &Medium) {
        let (mut integral, mut length) = ([0.0; 2], 0.0);
        for e in 0..medium.mesh.len() {
            let scale = medium.mesh.length(e);
            length += scale;
            let mean = medium.space.basis(e).to_legendre.row(0);
            for (node, weight) in medium.space.element_nodes(e).zip(mean.iter()) {
                (0..2).for_each(|i| integral[i] += scale * weight * self.trace[2 * node + i]);
            }
        }
        let mean = integral.map(|m| m / length);
        for field in [&mut self.displacement, &mut self.trace, &mut self.exterior_displacement] {
            field.chunks_exact_mut(2).for_each(|u| (0..2).for_each(|i| u[i] -= mean[i]));
        }
        self.constant = mean.map(|m| -m);
    }
}
