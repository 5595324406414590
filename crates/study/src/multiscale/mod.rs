//! What multiscale elements are worth on a scene with a grid.
//!
//! ```text
//! the scene: FineGrid (bilinear elements on the fine grid and finer ones)     ─┐
//!            Convergence (bases on smaller and smaller coarse cells)           ├─► MultiscaleStudy ─► report, draw
//! examples:  Laminates (resonance), Contrast (stiff parts across coarse edges) ─┘
//! ```
//! Each part is a file: what it computes, and the columns of its table.

mod measure;
mod plate;
mod fine_grid;
mod convergence;
mod laminates;
mod contrast;
mod report;
mod draw;

use steklov_problem::{Scene, Source};

pub use contrast::{Contrast, PARTS, Stiff, contrast};
pub use convergence::{Convergence, Point, coarse_cells, convergence};
pub use draw::pictures;
pub use fine_grid::{FineGrid, Level, MOST_DOFS, fine_grid};
pub use laminates::{LAMINATES, Laminates, Layers, laminates};
pub use measure::{BASES, FITTED};
pub use report::report;

/// A finished study.
pub struct MultiscaleStudy<'a> {
    /// The scene as it was run.
    pub scene: &'a Scene,
    /// The texts from which it was read.
    pub source: &'a Source,
    /// Bilinear elements on all cells.
    pub fine_grid: &'a FineGrid,
    /// Multiscale elements on the scene.
    pub convergence: &'a Convergence,
    /// Resonance on laminates.
    pub laminates: &'a Laminates,
    /// Stiff parts inside of coarse cells and across their edges.
    pub contrast: &'a Contrast,
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
        let examples = self.laminates.failures.iter().chain(&self.contrast.failures);
        self.fine_grid.failures.iter().chain(&self.convergence.failures).chain(examples)
    }
}
