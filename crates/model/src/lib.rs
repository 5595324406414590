//! Problems solved: from a [`steklov_problem::Scene`] to its displacements, tractions, contact, energies and their errors.
//!
//! ```text
//! Scene ─► Layout ─► solve (mesh by mesh) ─► estimate ─► next Layout ... ─► Run ─► answer: Summary
//!                                                                          └─► all outcomes of random input
//! run::adaptive_loop::run of BoundaryElements, of OnGrid: one loop, two models
//! ```

pub mod answer;
pub mod data;
pub mod doubt;
pub mod energies;
pub mod error;
pub mod estimate;
pub mod grid;
pub mod mesh;
pub mod refine;
pub mod run;
pub mod solve;
pub mod stage;
pub mod stochastic;
pub mod summary;

// the crates of whose types the input of a run is made
pub use {
    steklov_bem_operators, steklov_coupling, steklov_elastic, steklov_expression, steklov_problem, steklov_stochastic,
};
