//! What multiscale elements are worth on a scene with a grid.
//!
//! ```text
//! FineGrid (bilinear elements on the fine grid and finer ones) ─► Convergence (bases on smaller and smaller coarse cells)
//!                                          └────────────────► MultiscaleStudy ◄────┘ ─► store, table, draw
//! ```
//! Each part is a file: what it computes, and the columns of its table.

mod measure;
mod fine_grid;
mod convergence;
mod table;
mod store;
mod draw;

use super::columns;
use crate::scene::Scene;

pub use convergence::{Convergence, Point, coarse_cells, convergence};
pub use draw::pictures;
pub use fine_grid::{FineGrid, Level, MOST_DOFS, fine_grid};
pub use measure::BASES;
pub use store::write;
pub use table::{csv, json, text};

/// A finished study.
pub struct MultiscaleStudy<'a> {
    /// The scene as it was run.
    pub scene: &'a Scene,
    /// Bilinear elements on all cells.
    pub fine_grid: &'a FineGrid,
    /// Multiscale elements on the scene.
    pub convergence: &'a Convergence,
    /// Runs of which seconds are medians.
    pub repeat: usize,
    /// Whether the user stopped it.
    pub interrupted: bool,
}

impl MultiscaleStudy<'_> {
    /// Whether nobody stopped it and everything was solved.
    pub fn complete(&self) -> bool {
        !self.interrupted && self.failures().next().is_none()
    }

    /// What failed, and why.
    fn failures(&self) -> impl Iterator<Item = &(String, String)> {
        self.fine_grid.failures.iter().chain(&self.convergence.failures)
    }
}
