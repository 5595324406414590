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

mod adjoint;
mod affine;
mod answer;
mod cells;
mod coupled;
mod dual_solutions;
mod duals;
mod error_parts;
mod estimate;
mod frozen_contact;
mod functionals;
mod in_medium;
mod interface_sides;
mod layout;
mod loads;
mod oscillation;
mod refine;
mod run;
mod solution;
mod solve;
mod solve_coarse;
mod system;
mod trace;
mod works;

pub use adjoint::modulus_derivatives;
pub(crate) use affine::{AffineGrid, OfBlock};
pub use duals::GridQuantity;
pub use error_parts::{FAILING, GridEstimate};
pub(crate) use frozen_contact::doubts_of_contact;
pub(crate) use in_medium::has_jump_work;
pub use layout::GridLayout;
pub use run::{MARKING, OnGrid};
pub use solution::{CoarseSolved, GridSolved};
pub use solve::solve_grid;
pub(crate) use solve::{Acting, solve_once};
pub(crate) use works::knows_friction_work;
