//! Bodies on grids of rectangles: which cells belong to the body, and what they are made of.

mod body;
mod moduli;

pub use body::grid_of;
pub(crate) use body::{check_body, fitting_grid};
pub(crate) use moduli::check_modulus_cells;
pub use moduli::moduli;
