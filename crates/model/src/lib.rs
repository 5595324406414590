//! Problems solved: from a [`steklov_problem::Scene`] to its displacements, tractions, contact, energies and their errors.
//!
//! ```text
//! Scene ─► Layout ─► solve (mesh by mesh) ─► estimate ─► next Layout ... ─► Run ─► answer: Summary
//!                                                                          └─► all outcomes of random input
//! run::run::<BoundaryElements>, run::run::<OnGrid>: one loop, two models
//! ```

pub mod adapt;
pub mod adaptive;
pub mod answer;
mod apart;
pub mod around;
mod asperities;
mod assemble;
mod bernstein;
pub mod body;
pub mod body_load;
mod contact;
pub mod contact_rows;
mod contact_solver;
mod corners;
pub mod data;
mod data_contact;
mod data_work;
pub mod doubt;
mod elastic;
pub mod energies;
mod enriched_problem;
mod equilibrium;
pub mod error;
pub mod estimate;
mod exact;
pub mod expect;
mod facing;
pub mod fields;
pub mod first_mesh;
pub mod grid;
mod hidden;
mod inclusion;
pub mod interfaces;
pub mod joints;
mod large;
mod loose;
pub mod layout;
pub mod memory;
mod motions;
pub mod normals;
pub mod parts;
pub mod reach;
pub mod report;
pub mod residual;
mod rotations;
pub mod run;
pub mod solution;
pub mod solve;
pub mod stabilised;
pub mod stage;
pub mod stochastic;
pub mod summary;
pub mod supports;
mod thin;
mod transitions;
mod turning;
mod unbounded;
mod unseen;
mod vertices;

// the crates of whose types the input of a run is made
pub use {
    steklov_bem_operators, steklov_coupling, steklov_elastic, steklov_expression, steklov_problem, steklov_stochastic,
};
