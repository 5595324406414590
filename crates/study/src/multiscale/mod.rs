//! The accuracy and cost of multiscale elements on a scene with a grid.
//!
//! ```text
//! the scene: FineGrid (bilinear elements on the fine grid and finer ones)     ─┐
//!            Convergence (bases on smaller and smaller coarse cells)           ├─► MultiscaleStudy ─► report, draw
//! examples:  Laminates (resonance), Contrast (stiff parts across coarse edges) ─┘
//! ```
//! Each part is a file with its computation and the columns of its table.

mod measure;
mod plate;
mod fine_grid;
mod convergence;
mod laminates;
mod contrast;
mod rates;
mod report;
mod draw;

use steklov_document::Source;
use steklov_problem::Scene;

use crate::error::StudyError;
use crate::watch::Watch;

pub use contrast::{Contrast, PARTS, Stiff, contrast};
pub use convergence::{Convergence, Point, coarse_cells, convergence};
pub use draw::pictures;
pub use fine_grid::{FineGrid, Level, MOST_DOFS, fine_grid};
pub use laminates::{LAMINATES, Laminates, Layers, laminates};
pub use measure::{BASES, FITTED};
pub(crate) use measure::{on_all_cells, on_coarse_cells};
pub use rates::{Rate, rates};
pub use report::report;

/// A finished study.
pub struct MultiscaleStudy<'a> {
    /// The scene as it was run.
    pub scene: &'a Scene,
    /// The texts from which it was read.
    pub source: &'a Source,
    /// Bilinear elements on all cells.
    pub fine_grid: FineGrid,
    /// Multiscale elements on the scene.
    pub convergence: Convergence,
    /// Resonance on laminates.
    pub laminates: Laminates,
    /// Stiff parts inside of coarse cells and across their edges.
    pub contrast: Contrast,
    /// Number of runs; seconds are their medians.
    pub repeat: usize,
    /// Whether the user stopped it.
    pub interrupted: bool,
}

/// All parts of the study, the scene on coarse cells of these sizes; seconds are medians of `repeat` runs.
///
/// # Errors
/// As [`fine_grid`].
pub fn study<'a>(
    scene: &'a Scene,
    source: &'a Source,
    sizes: &[[usize; 2]],
    repeat: usize,
    watch: &mut Watch<'_>,
) -> Result<MultiscaleStudy<'a>, StudyError> {
    let fine_grid = fine_grid(scene, repeat, watch)?;
    let convergence = convergence(scene, &fine_grid, sizes, repeat, watch);
    let laminates = laminates(watch);
    let contrast = contrast(watch);
    let interrupted = watch.stopped();
    Ok(MultiscaleStudy { scene, source, fine_grid, convergence, laminates, contrast, repeat, interrupted })
}

impl MultiscaleStudy<'_> {
    /// Whether nobody stopped it and everything was solved.
    pub fn complete(&self) -> bool {
        !self.interrupted && self.failures().next().is_none()
    }

    /// The rates of the errors on the scene and on the laminates.
    pub fn rates(&self) -> Vec<Rate> {
        rates(&self.convergence, &self.laminates)
    }

    /// The failures, each with its reason.
    fn failures(&self) -> impl Iterator<Item = &(String, String)> {
        let examples = self.laminates.failures.iter().chain(&self.contrast.failures);
        self.fine_grid.failures.iter().chain(&self.convergence.failures).chain(examples)
    }
}
