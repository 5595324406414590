//! Tables and pictures of outcomes of random input.

mod tables;
mod draw;
mod draw_fields;

pub use draw::pictures;
pub use tables::{lines, tables};
pub use tables::{overlooked, shortfall};
