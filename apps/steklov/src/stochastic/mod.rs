//! Outcomes of random input: what is stored, written as tables and drawn of them.

mod store;
mod tables;
mod draw;
mod draw_fields;

pub use draw::pictures;
pub use store::{read, write};
pub use tables::{lines, tables};
pub(crate) use tables::{overlooked, shortfall};
