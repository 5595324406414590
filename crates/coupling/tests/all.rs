//! The tests of the crate, one program.

mod adaptive;
mod boundary_elements;
mod common;
mod energy;
mod identities;
mod indicators;
mod manufactured;
mod medium_residuals;
mod multiscale;
mod signs;
mod traction_error;
mod two_bodies;
