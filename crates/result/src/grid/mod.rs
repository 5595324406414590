//! Results on grids.

mod record;
pub(crate) mod store;

pub use record::GridRecord;
pub use store::of_quads;
