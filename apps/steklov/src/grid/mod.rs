//! Bodies on grids of rectangles: bilinear and multiscale finite elements.
//!
//! ```text
//! scene ─► GridLayout (how fine, which coarse cells) ─► HeterogeneousBody (cells and moduli) + Loads + GridTrace (the boundary)
//!            ▲                                                      │
//!            │                    fem: K of all fine nodes ─────────┤
//!            │                  msfem: bases ─► K_H of the vertices ┤
//!            │                                                      ▼
//!       next ◄── GridEstimate ◄── GridSolved ◄── System: supports, elimination to the contact nodes, contact, reactions
//!                                     └─► Record ─► result file, summary, pictures
//! ```
//! The boundary of the grid is a boundary mesh of degree 1, so that loads, supports and contact are set up by the same code as
//! those of boundary elements.

mod layout;
mod trace;
mod loads;
mod system;
mod solve;
mod coupled;
mod estimate;
mod oscillation;
mod run;
mod plan;
mod record;
pub(crate) mod store;
mod tables;
mod draw;
mod draw_medium;

pub(crate) use draw::{deformed, pictures};
pub(crate) use draw_medium::medium;
pub(crate) use estimate::BLIND;
pub use estimate::GridEstimate;
pub use layout::GridLayout;
pub(crate) use plan::plan;
pub(crate) use record::FAILING;
pub use record::GridRecord;
pub use run::{GridProgress, GridRun, GridStep, run_grid};
pub(crate) use solve::solve_grid;
pub use solve::{CoarseSolved, GridSolved};
pub(crate) use tables::tables;
