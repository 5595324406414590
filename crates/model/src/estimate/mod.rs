//! The error of a solved mesh: bubbles, residuals, what the nodes do not see, and the changes of J by data, rotations and
//! rounding.

pub(crate) mod contact_ends;
pub(crate) mod data_work;
pub(crate) mod dual;
pub(crate) mod elastic;
pub(crate) mod enriched_problem;
pub(crate) mod enriched_solution;
pub mod error_estimate;
pub(crate) mod functionals;
pub(crate) mod interface_residual;
pub(crate) mod multiplier_difference;
pub(crate) mod nonconformity;
pub(crate) mod on_springs;
pub(crate) mod penetration;
pub(crate) mod reaction_work;
pub mod residual;
pub(crate) mod rotation_work;
pub(crate) mod rounding;
pub(crate) mod slip_reversals;
pub(crate) mod strain_of_bodies;
pub(crate) mod unseen;
