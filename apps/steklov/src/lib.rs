//! The command `steklov` as a library: from a scene file to a result file and its pictures.
//!
//! ```text
//! Scene ─► plan ─► run ─► solve (mesh by mesh) ─► Record ─► store (HDF5), summary (JSON), pictures
//!                                                   ▲
//!                                    show ─► read ──┘
//! Scene ─► Reference, then run by run (strategy by strategy) ─► Study ─► HDF5, CSV, JSON, charts and meshes
//! ```

pub mod medium;
pub mod grid;
pub mod plan;
pub mod stochastic;
pub mod study;
pub mod triangulate;
pub mod record;
mod steps;
pub mod store;
pub mod draw;
mod explain;
pub mod cli;
