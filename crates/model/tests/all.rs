//! The tests of the crate, one program.

mod random_input;
mod springs;
