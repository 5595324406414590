//! Outcomes of random input: what is stored, written as tables and drawn of them.

mod tables;
mod draw;
mod draw_fields;

pub use draw::pictures;
pub use tables::{lines, tables};
pub use tables::{overlooked, shortfall};
