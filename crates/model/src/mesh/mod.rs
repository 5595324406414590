//! Meshes of a problem: the first one, and what a mesh is made of.

pub mod first_mesh;
pub mod layout;
