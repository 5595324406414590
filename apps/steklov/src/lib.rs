//! The command `steklov` as a library: from a scene file to a result file and its pictures.
//!
//! ```text
//! Scene ─► plan ─► run ─► solve (mesh by mesh) ─► Record ─► store (HDF5), summary (JSON), pictures
//!                                                   ▲
//!                                    show ─► read ──┘
//! Scene ─► Reference, then run by run (strategy by strategy) ─► Study ─► HDF5, CSV, JSON, charts and meshes
//! ```

pub mod around;
pub mod grid;
pub mod plan;
mod data;
mod data_contact;
mod data_work;
mod hidden;
mod supports;
mod body_load;
mod motions;
pub mod contact;
pub mod inclusion;
pub mod body;
pub mod stabilised;
pub mod solve;
pub mod stochastic;
mod elastic;
mod enriched_problem;
pub mod estimate;
mod transitions;
mod exact;
mod apart;
mod asperities;
pub mod first_mesh;
pub mod adapt;
pub mod run;
pub mod reference;
pub mod study;
pub mod triangulate;
pub mod summary;
mod unbounded;
mod unseen;
mod large;
mod vertices;
mod wedge;
pub mod report;
pub mod record;
mod steps;
pub mod store;
pub mod draw;
mod explain;
pub mod cli;
