//! What can go wrong in a contact problem.

use steklov_bem_operators::BemError;
use steklov_elastic::RigidMotion;

/// Errors of this crate; each carries the numbers that show what to change.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// Linear algebra that went wrong.
    #[error("{0}")]
    Fault(#[from] steklov_algebra::Fault),
    /// The parts of a problem do not fit together.
    #[error("the contact problem is inconsistent: {what}")]
    Inconsistent {
        /// What does not fit.
        what: String,
    },
    /// What supports hold contradicts contact with another body.
    #[error("supports contradict contact with another body: {what}")]
    Supports {
        /// What they hold, and where.
        what: String,
        /// What to change.
        remedy: &'static str,
    },
    /// A gap or friction bound is not finite somewhere, or cannot be integrated.
    #[error(transparent)]
    Data(#[from] BemError),
    /// The load does work on a motion that needs no energy and that neither contact nor friction stops.
    #[error(
        "the load does work {work:.3e} on a motion that nothing stops (the scale of that work is {scale:.3e}): \
         hold a displacement, balance the load, or raise the friction bound or coefficient"
    )]
    NotHeld {
        /// The motion, one value for each unknown, largest entry 1.
        motion: Vec<f64>,
        /// Work of the load and of the contact forces on it.
        work: f64,
        /// Sum of |load|·|motion|.
        scale: f64,
    },
    /// Nothing holds the body against a rigid motion: neither supports nor contact nor friction.
    #[error(
        "nothing holds the body against {motion}: the loads do work {work:.3e} on it (of a scale of {scale:.3e}){}; \
         hold a displacement, balance the loads, or raise the friction bound or coefficient",
        resisting(*resistance)
    )]
    RigidMotion {
        /// The motion.
        motion: RigidMotion,
        /// Work of the loads on it, L(r).
        work: f64,
        /// Work of full Tresca friction on it, j(r). Coulomb friction shows in the motion: one along which the body leaves
        /// the obstacle at the angle of friction.
        resistance: f64,
        /// Sum of |load|·|motion|.
        scale: f64,
    },
    /// Uzawa's iteration needs a positive definite stiffness.
    #[error(
        "Uzawa's iteration needs a positive definite stiffness, but its eigenvalues run from {smallest:.3e} to \
         {largest:.3e}: a rigid motion is free; hold a displacement, or choose newton or active-set"
    )]
    NotCoercive {
        /// Smallest eigenvalue of S.
        smallest: f64,
        /// Largest eigenvalue of S.
        largest: f64,
    },
    /// The stabilisation takes more energy than the body has, or next to none.
    #[error(
        "the stabilisation γ₀ = {gamma:.6e} is not below its critical value {critical:.6e} on this mesh, beyond which the \
         stabilised form is not coercive, nor above a millionth of it, below which it drowns in rounding errors: change \
         gamma, or leave it at \"auto\", half of the critical value"
    )]
    StabilisationNotCoercive {
        /// γ₀ in γ = γ₀ h/p² (1/stress).
        gamma: f64,
        /// The largest γ₀ for which <S v, v> - ∫ γ |σ^h(v)|² is not negative.
        critical: f64,
    },
    /// An eigenvalue or singular value iteration of a dense matrix failed.
    #[error(
        "the eigenvalues of a {size}×{size} matrix were not found; its entries are probably too large or too small"
    )]
    Decomposition {
        /// Number of rows.
        size: usize,
    },
}

/// The resistance of friction against a motion in words, if there is any.
fn resisting(resistance: f64) -> String {
    if resistance > 0.0 { format!(" and friction resists with {resistance:.3e}") } else { String::new() }
}
