//! Results on grids.

pub(crate) mod record;
pub(crate) mod store;

pub use record::GridRecord;
pub use store::of_quads;
