//! Plane elasticity of heterogeneous bodies on grids of rectangles: bilinear and extended multiscale finite elements.

mod error;
mod grid;

pub use error::MsfemError;
pub use grid::Grid;
