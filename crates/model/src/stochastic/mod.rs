//! A scene with random input solved for all outcomes on one mesh, and the statistics of the answers.
//!
//! ```text
//! Body, germs ─► Outcomes: what acts, E/E₀ ─► Answer of each point: node by node, or coupled over the nodes of a cell
//! grid, germs ─► OutcomesOnGrid: a body of its own for each outcome ─► Answer of each point, one by one
//! grid, affine E(ξ) ─► of_affine: one system for the polynomials of all outcomes
//! points: StochasticMesh (Galerkin, collocation; refined until its truncation is small), sparse grid, samples,
//!         samples of differences between the grids of a family (multilevel)
//! answers ─► StochasticResult: moments, quantiles, probability of contact, effect of each germ, levels
//! ```

pub(crate) mod number;
mod outcomes;
mod stage;
mod result;
mod coupled;
mod events;
mod jumps;
mod outcome_checks;
mod surrogate;
mod check;
mod nodes;
mod effects;
mod of_surrogate;
mod samples;
mod unseen;
mod kept;
mod corrected;
mod in_body;
mod one_by_one;
mod affine;
mod on_grid;
mod multilevel;
mod spread;
mod all_outcomes;
mod watch;
mod last_mesh;
mod bars;
mod estimate;
mod json;

pub use all_outcomes::solve_stochastic;
pub(crate) use bars::with_bars;
pub(crate) use estimate::mean_estimate;
pub use in_body::{BodyMoments, InBody};
pub use json::{json, method};
pub use jumps::intervals;
pub use last_mesh::{LastMesh, Prepared};
pub use nodes::is_coupled;
pub use on_grid::solve_stochastic_on_grid;
pub use one_by_one::one_by_one;
pub(crate) use outcomes::paths_of;
pub use outcomes::{Answer, Outcomes};
pub use result::{Cells, End, FieldModes, Level, Quantity, StochasticResult};
pub use stage::{Modulus, OutcomeStage};
pub use watch::{Elsewhere, OutcomesWatch, TOGETHER};
