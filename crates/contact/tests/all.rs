//! The tests of the crate, one program.

mod clamped;
mod frictionless;
mod graded;
mod motions;
mod residual;
mod solved;
mod stabilised;
mod uniform_pressure;
