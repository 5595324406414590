//! Frictional contact of a linear elastic body with a rigid obstacle, condensed to the contact nodes.
//!
//! ```text
//! Mesh, Space, gap, friction bound ─► ContactSides (weights, frames, conditions) ─┐
//!                                     condensed stiffness and load ──────────────┴─► Problem ─► newton | active_set | uzawa ─► Solution ─► kkt
//! ```
//! Solvers see a [`Problem`] only: a symmetric matrix, a load, and for each contact node the conditions on its two
//! (or one) unknowns. They never see a mesh.
//!
//! Signs: λ := -σ(u)n is the multiplier, λ_n ≥ 0 in compression; the tangent is the normal turned by +90°;
//! u_n ≤ g; S u + Bᵀλ = f.

mod error;
mod problem;

pub use error::ContactError;
pub use problem::{Condition, ContactNode, Problem, Solution, Status};
