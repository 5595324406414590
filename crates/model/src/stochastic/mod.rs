//! A scene with random input solved for all outcomes on one mesh, and the statistics of the answers.
//!
//! ```text
//! Body, germs ─► Outcomes: what acts, E/E₀ ─► Answer of each point: node by node, or coupled over the nodes of a cell
//! points: StochasticMesh (Galerkin, collocation; refined until its truncation is small), sparse grid, samples
//! answers ─► StochasticResult: moments, quantiles, probability of contact, effect of each germ
//! ```

mod number;
mod outcomes;
mod coupled;
mod events;
mod jumps;
mod outcome_checks;
mod check;
mod of_surrogate;
mod samples;
mod unseen;
mod nodes;
mod effects;
mod result;
mod spread;
mod estimate;
mod json;

pub(crate) use estimate::mean_estimate;
pub use json::{json, method};
pub use jumps::intervals;
pub use nodes::{End, is_coupled};
pub use outcomes::Outcomes;
pub(crate) use result::paths_of;
pub use result::{Cells, FieldModes, Quantity, StochasticResult, solve_stochastic};
