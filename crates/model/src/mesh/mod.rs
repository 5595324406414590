//! Meshes of a problem: the first mesh, and the parts of a mesh.

pub mod automatic_cuts;
pub mod first_mesh;
pub mod layout;
