//! The tests of the crate, one program.

mod bar;
mod cell;
mod common;
mod contrast;
mod fine_correction;
mod fine_error;
mod indicators;
mod poisson;
mod refinement;
