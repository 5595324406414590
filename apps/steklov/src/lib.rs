//! The command `steklov` as a library: from a scene file to a result file and its pictures.
//!
//! ```text
//! Scene ─► plan ─► run ─► solve (mesh by mesh) ─► Record ─► store (HDF5), summary (JSON), pictures
//!                                                   ▲
//!                                    show ─► read ──┘
//! Scene ─► Reference, then run by run (strategy by strategy) ─► Study ─► HDF5, CSV, JSON, charts and meshes
//! ```

mod explain;
pub mod cli;
