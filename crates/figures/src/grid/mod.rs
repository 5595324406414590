//! Tables and pictures of results on grids.

mod tables;
mod difference;
mod draw;
mod draw_medium;
mod shown_cells;

pub use difference::{Difference, difference, difference_picture};
pub(crate) use draw::{deformed, pictures};
pub(crate) use draw_medium::medium;
pub(crate) use tables::tables;
