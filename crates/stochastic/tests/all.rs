//! The tests of the crate, one program.

mod affine_galerkin;
mod cell_karhunen_loeve;
mod cell_samples;
mod chains;
mod contact_reference;
mod field;
mod karhunen_loeve;
mod orthogonal;
mod rectangle;
mod smolyak;
mod square;
mod statistics;
mod stochastic_mesh;
mod tensor;
mod truncation;
mod variable;
