//! A problem on a mesh: its data, supports, ties and contact, and its bodies one by one.

pub mod body_load;
pub(crate) mod contact_data;
pub mod joints;
pub(crate) mod motions;
pub mod on_mesh;
pub mod parts;
pub mod springs;
pub mod supports;
