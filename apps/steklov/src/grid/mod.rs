//! Results on grids: what is stored and drawn of them.

mod record;
pub(crate) mod store;
mod tables;
mod draw;
mod draw_medium;

pub(crate) use draw::{deformed, pictures};
pub(crate) use draw_medium::medium;
pub use record::GridRecord;
pub(crate) use tables::tables;
