//! Plane elasticity of heterogeneous bodies on grids of rectangles: bilinear and extended multiscale finite elements.

mod error;
mod grid;
mod elasticity;
mod medium;
mod load;
mod ordering;
mod cholesky;
mod local;
mod basis;
mod coarse_mesh;
mod multiscale;
mod elimination;
mod indicators;
mod fine_error;
mod refinement;
mod contrast;

pub use basis::{Basis, CellBasis};
pub use coarse_mesh::{CoarseCell, CoarseMesh, Hanging};
pub use contrast::{CrossingContrast, crossing_contrast};
pub use elasticity::{Elasticity, Plane};
pub use elimination::{Elimination, ReducedLoad};
pub use error::MsfemError;
pub use fine_error::bubble_indicators;
pub use grid::Grid;
pub use indicators::{Indicators, nodal_indicators};
pub use load::Loads;
pub use medium::Medium;
pub use multiscale::{CoarseSystem, Extra, Multiscale};
pub use refinement::{mark, refine};
