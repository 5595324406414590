//! The three forms of the equations on the interface.

use crate::coupled::Unknowns;
use crate::{Coupled, CouplingError, Medium, Radiation, SchurFactor, Transmission, dense, three_field, two_field};

/// Stiffness of the body over that of the medium from which on too few digits are left.
const CONTRAST: f64 = 1e10;

/// Which fields are unknowns. v are the unknowns of the trace, Π v the trace in the displacement space of the boundary elements;
/// A_c and f_c are the body's stiffness and load, reduced to v; n points out of the body.
///
/// Source: Costabel (1987) for two fields; Carstensen and Funken (1999) and Issaoui (2014), equation (5.99), for three;
/// Issaoui (2014), equation (5.97), for the displacement alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Displacement v and traction φ of the medium; symmetric, indefinite:
    ///
    /// ```text
    /// (A_c + Πᵀ W Π) v + Πᵀ (K - ½M)ᵀ φ = f_c + Πᵀ W u0
    ///      (K - ½M) Π v            - V φ = (K - ½M) u0
    /// ```
    TwoField,
    /// Displacement v, traction φ and displacement ξ of the medium, which is determined up to a rigid motion; Z spans those:
    ///
    /// ```text
    ///  A_c v - Bᵀ φ                        = f_c
    /// -B v   - V φ + (K + ½M) ξ            = -M u0
    ///          (K + ½M)ᵀ φ + (W + Z Zᵀ) ξ  = 0
    /// ```
    /// The displacements are equal only when tested with tractions (B = ∫ ψ·v), so that its solution differs from that of the
    /// two other forms, but has the same order.
    ThreeField,
    /// Displacement v; S = W + (K - ½M)ᵀ V⁻¹ (K - ½M), positive definite: (A_c + Πᵀ S Π) v = f_c + Πᵀ S u0. The solution
    /// of the two-field form, with the traction eliminated; the cheapest.
    Schur,
}

impl Transmission<'_> {
    /// Solves for a jump u0 of displacements (length), given at the nodes of the boundary elements, interleaved.
    ///
    /// # Errors
    /// [`CouplingError::Inconsistent`] for a jump of another size or one that is not finite, [`CouplingError::Unbalanced`] for
    /// a resultant and [`Radiation::Bounded`], [`CouplingError::Contrast`], [`CouplingError::Singular`].
    pub fn solve(&self, jump: &[f64], form: Form, radiation: Radiation) -> Result<Coupled, CouplingError> {
        self.check(jump, radiation)?;
        self.check_contrast(form)?;
        let projection = &self.transfer.projection;
        let solved = match form {
            Form::TwoField => two_field::solve(self, jump)?,
            Form::ThreeField => three_field::solve(self, jump)?,
            Form::Schur => SchurFactor::new(self)?.and_then(|factor| factor.solve(projection, self.load(), jump)),
        };
        Ok(self.coupled(solved.ok_or_else(|| self.singular())?, jump, radiation))
    }

    /// The factor of [`Form::Schur`], for [`Self::solve_with`] and the solutions of other loads.
    ///
    /// # Errors
    /// [`CouplingError::Contrast`], [`CouplingError::Singular`].
    pub fn factor(&self) -> Result<SchurFactor, CouplingError> {
        self.check_contrast(Form::Schur)?;
        SchurFactor::new(self)?.ok_or_else(|| self.singular())
    }

    /// Solves [`Form::Schur`] with its factor.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn solve_with(
        &self,
        factor: &SchurFactor,
        jump: &[f64],
        radiation: Radiation,
    ) -> Result<Coupled, CouplingError> {
        self.check(jump, radiation)?;
        let solved = factor.solve(&self.transfer.projection, self.load(), jump);
        Ok(self.coupled(solved.ok_or_else(|| self.singular())?, jump, radiation))
    }

    fn check(&self, jump: &[f64], radiation: Radiation) -> Result<(), CouplingError> {
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
        Ok(())
    }

    fn check_contrast(&self, form: Form) -> Result<(), CouplingError> {
        let contrast = self.contrast();
        let lost = if form == Form::ThreeField { contrast.max(1.0 / contrast) } else { contrast };
        if lost >= CONTRAST || !lost.is_finite() {
            return Err(CouplingError::Contrast { contrast, limit: CONTRAST });
        }
        Ok(())
    }

    fn singular(&self) -> CouplingError {
        CouplingError::Singular { size: self.stiffness.nrows(), contrast: self.contrast() }
    }

    /// The fields of the unknowns of a form.
    fn coupled(&self, solved: Unknowns, jump: &[f64], radiation: Radiation) -> Coupled {
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
        coupled
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
