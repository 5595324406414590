//! One mesh solved: from its data to displacements, tractions, contact and energies.

pub(crate) mod assemble;
pub mod body;
pub(crate) mod contact;
pub mod contact_rows;
pub(crate) mod contact_solver;
pub(crate) mod equilibrium;
pub mod fields;
pub(crate) mod free_bodies;
pub(crate) mod inclusion;
pub mod medium;
pub mod one_mesh;
pub(crate) mod rotations;
pub mod solution;
pub mod stabilised;
pub(crate) mod thin;
