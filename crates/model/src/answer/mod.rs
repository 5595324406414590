//! The reported results of a solved mesh: contact in numbers, interfaces, singular points, and how far the model holds.

pub(crate) mod bernstein;
pub(crate) mod borne;
pub(crate) mod data_jumps;
pub mod interfaces;
pub(crate) mod largest_stress;
pub mod normals;
pub(crate) mod probes;
pub mod reach;
pub mod report;
pub(crate) mod singular_points;
pub(crate) mod small_strain;
pub(crate) mod wedges;
