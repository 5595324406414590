//! Results on grids: what is stored and drawn of them.

mod tables;
mod draw;
mod draw_medium;
mod shown_cells;

pub(crate) use draw::{deformed, pictures};
pub(crate) use draw_medium::medium;
pub(crate) use tables::tables;
