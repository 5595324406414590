//! Pictures and tables of results.
//!
//! ```text
//! Record ─► pictures (SVG, PNG)          Record ─► tables (CSV)
//! ```

mod draw;
mod grid;
pub mod stochastic;

pub use draw::{contact_pictures, pictures, positions, side_file, tables};
