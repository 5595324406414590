//! Problems solved: from a [`steklov_problem::Scene`] to its displacements, tractions, contact, energies and their errors.
//!
//! ```text
//! Scene ─► Layout ─► solve (mesh by mesh) ─► estimate ─► next Layout ... ─► Run ─► answer: Summary
//!                                                                          └─► all outcomes of random input
//! Scene with a [grid] ─► GridLayout ─► ... ─► Run<OnGrid> ─► answer_of_grid: Summary
//! ```

pub mod adapt;
pub mod adaptive;
pub mod answer;
pub mod apart;
pub mod around;
pub mod asperities;
pub mod body;
pub mod body_load;
pub mod contact;
pub mod data;
pub mod data_contact;
pub mod data_work;
pub mod elastic;
pub mod enriched_problem;
mod equilibrium;
pub mod estimate;
pub mod exact;
pub mod fields;
pub mod first_mesh;
pub mod hidden;
pub mod inclusion;
pub mod large;
pub mod memory;
pub mod motions;
pub mod report;
pub mod run;
pub mod solve;
pub mod stabilised;
pub mod summary;
pub mod supports;
pub mod transitions;
pub mod unbounded;
pub mod unseen;
pub mod vertices;
pub mod grid;
pub mod stochastic;

// the crates of whose types the input of a run is made
pub use {
    steklov_bem_operators, steklov_coupling, steklov_elastic, steklov_expression, steklov_problem, steklov_stochastic,
};
