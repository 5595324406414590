//! Frictional contact of a linear elastic body with a rigid obstacle, condensed to the contact nodes.
//!
//! ```text
//! Mesh, Space, gap, friction bound ─► ContactBoundary (weights, frames, conditions) ─┐
//!                                        condensed stiffness and load ──────────────┴─► Problem
//! Problem ─► interior_point | newton | active_set | uzawa | fixed_point ─► Solution ─► kkt
//!
//! Mesh, Space, MultiplierSpace ─► StabilisedForms (σ^h, γ, critical γ) ──────────────┐
//!                                        condensed stiffness and load ──────────────┴─► Problem
//! ```
//! Multipliers are biorthogonal to the displacement's trace ([`contact_boundary`]) or stabilised, on a mesh of their own
//! ([`StabilisedForms`], also of almost incompressible bodies: the constant pressure, which would let γ fall with 1-2ν, is
//! damped); [`inf_sup`] tells whether a pair of spaces is stable without stabilisation. Solvers see a [`Problem`] only: a
//! symmetric matrix, a load, and for each contact node the conditions on its two (or one) unknowns. They never see a mesh.
//!
//! Friction is Tresca's (bound F), Coulomb's (bound μ λ_n) or their sum. Tresca problems have one solution up to rigid
//! motions. Under Coulomb's law there may be several or none: [`contraction`] and [`other_solution`] tell how safe one is.
//!
//! Signs: λ := -σ(u)n is the multiplier, λ_n ≥ 0 in compression; the tangent is the normal turned by +90°;
//! u_n ≤ g; S u + Bᵀλ = f.
//!
//! ```
//! use steklov_contact::faer::Mat;
//! use steklov_contact::{Condition, ContactNode, Problem, active_set, kkt};
//!
//! // a spring of stiffness 4 in both directions, pushed with (6, 1.5) against a wall at distance 1
//! let wall = Condition {
//!     normal: [1.0, 0.0],
//!     tangent: [0.0, 1.0],
//!     normal_weight: 1.0,
//!     tangent_weight: 1.0,
//!     gap: 1.0,
//!     slip_offset: 0.0,
//!     bound: 0.5,
//!     coefficient: 0.0,
//! };
//! let problem = Problem {
//!     stiffness: Mat::from_fn(2, 2, |i, j| if i == j { 4.0 } else { 0.0 }).into(),
//!     load: vec![6.0, 1.5],
//!     nodes: vec![ContactNode { first: 0, unknowns: 2, conditions: vec![wall] }],
//! };
//! let solution = active_set(&problem, None)?;
//! assert_eq!(solution.displacement, [1.0, 0.25]); // it touches, and slips under the friction 0.5
//! assert_eq!(solution.multipliers, [[2.0, 0.5]]);
//! assert!(kkt(&problem, &solution).worst() < 1e-15);
//! # Ok::<(), steklov_contact::ContactError>(())
//! ```

mod error;
mod on_mesh;
mod solvers;
#[cfg(any(test, feature = "proptest"))]
pub mod proptest;
#[cfg(test)]
mod tests;

// the crates whose types appear in the interface
pub use {faer, steklov_algebra, steklov_bem_operators};

pub use error::ContactError;
pub use on_mesh::boundary::{BoundaryCondition, BoundaryNode, ContactBoundary, Row, Share, Transfer};
pub use on_mesh::bubbles::{ContactBubble, contact_bubbles, missed, oscillation};
pub use on_mesh::conditions::contact_boundary;
pub use on_mesh::decided::{Decided, Least, decided};
pub use on_mesh::inf_sup::{InfSup, dual_form, inf_sup};
pub use on_mesh::lines::{ContactLine, ElementConditions, LinePoint};
pub use on_mesh::moved_ends::{MovedEnd, moved_ends};
pub use on_mesh::multiplier_space::{
    MultiplierCell, MultiplierDegree, MultiplierElement, MultiplierMesh, MultiplierNode, MultiplierSpace,
};
pub use on_mesh::multiplier_trace::multiplier_trace;
pub use on_mesh::residual::{ContactResidual, ContactSolution, Multiplier, contact_residuals, contact_residuals_of};
pub use on_mesh::sides::{Beyond, SideData};
pub use on_mesh::stabilised::{LEAST_GAMMA, Loading, Stabilised, StabilisedForms, pairing};
pub use on_mesh::stabilised_parts::StabilisedParts;
pub use on_mesh::tips::{KnownEnd, Located, Obstacle, Solved, Tip, relocate, unlocated};
pub use on_mesh::transitions::{TipFit, TipKind, TipVertex, Transition, first_guess, tip_fits, transitions};
pub use solvers::active_set::active_set;
pub use solvers::fixed_point::fixed_point;
pub use solvers::frozen::{Frozen, FrozenDual, Sets};
pub use solvers::interior_point::interior_point;
pub use solvers::kkt::{Kkt, kkt, kkt_in_body};
pub use solvers::motions::{ContactEdge, lifting_motion, resisted_motions};
pub use solvers::newton::{newton, newton_watched};
pub use solvers::problem::{Condition, ContactNode, Outcome, Problem, Solution, Status};
pub use solvers::rows::{MultiplierRow, multiplier_rows};
pub use solvers::several::{Contraction, contraction, other_solution};
pub use solvers::start::Start;
pub use solvers::uzawa::uzawa;
