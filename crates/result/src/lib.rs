//! Results of problems: what is known of a run, and the HDF5 file that holds it, which h5py and ParaView read.
//!
//! ```text
//! Run ─► Record (fields, contact table, steps, summary, plan) ─► store::write ─► file
//! file ─► store::read ─► Record          file ─► Keep::read_steps ─► steps from which a run goes on
//! ```

mod body_grid;
pub mod grid;
pub mod keep;
pub mod medium;
pub mod outcomes;
pub mod record;
pub mod stages;
mod steps;
pub mod store;
pub mod triangulate;
