//! The accuracy and cost of coupling a body on a grid with an unbounded medium.
//!
//! ```text
//! grids: Pair (materials), Level (grid) ─► Manufactured (a known solution on the scene's body)
//!                                              │
//!      ┌────────────┬──────────────┬────────┴──────┬──────────────┐
//! Convergence   Effectivity       Costs       Conditioning       Wrongs     ─► CouplingStudy ─► report, draw
//!
//! The scene's own moduli and loads: OwnLoads (multiscale and bilinear elements over H and h) ─► CouplingStudy
//! ```
//! Each part is a file with its computation and the columns of its table.

mod distance;
mod manufactured;
mod grids;
mod convergence;
mod effectivity;
mod cost;
mod systems;
mod conditioning;
mod wrong;
mod own_loads;
mod report;
mod draw;

use steklov_document::Source;
use steklov_problem::Scene;

use crate::watch::Watch;

pub use conditioning::{Condition, Conditioning, conditioning};
pub use convergence::{Convergence, FORMS, Point, convergence};
pub use cost::{Cost, Costs, WAYS, costs};
pub use draw::pictures;
pub use effectivity::{Effectivity, INDICATED, Indicated, TERMS, effectivity};
pub use grids::{Level, coarsest, grids, largest, levels, pairs, settings};
pub use manufactured::{Manufactured, Pair, Problem};
pub use own_loads::{ELEMENTS, Own, OwnLoads, own_loads};
pub use report::report;
pub use wrong::{SYSTEMS, Wrong, Wrongs, wrongs};

/// A finished study.
pub struct CouplingStudy<'a> {
    /// The scene as it was run, [`settings`] included.
    pub scene: &'a Scene,
    /// The texts from which it was read.
    pub source: &'a Source,
    /// The materials; the scene's own last.
    pub pairs: Vec<Pair>,
    /// Errors of the forms.
    pub convergence: Convergence,
    /// Indicators over errors.
    pub effectivity: Effectivity,
    /// Seconds and entries of three ways to solve.
    pub costs: Costs,
    /// Conditions of the three-field form.
    pub conditioning: Conditioning,
    /// Errors with wrong signs and factors.
    pub wrongs: Wrongs,
    /// Multiscale and bilinear elements with the scene's own loads.
    pub own_loads: OwnLoads,
    /// Number of runs; seconds are their medians.
    pub repeat: usize,
    /// Whether the user stopped it.
    pub interrupted: bool,
}

/// All parts of the study, with [`pairs`] and [`grids`]; seconds are medians of `repeat` runs.
pub fn study<'a>(
    scene: &'a Scene,
    source: &'a Source,
    pairs: Vec<Pair>,
    [fine, middle, coarse, all]: &[Vec<Level>; 4],
    repeat: usize,
    watch: &mut Watch<'_>,
) -> CouplingStudy<'a> {
    let polygon = &scene.problem.outline;
    CouplingStudy {
        scene,
        source,
        convergence: convergence(polygon, &pairs, fine, repeat, watch),
        effectivity: effectivity(polygon, &pairs, coarse, watch),
        costs: costs(polygon, &pairs[pairs.len() - 1], all, repeat, watch),
        conditioning: conditioning(polygon, &pairs, middle, watch),
        wrongs: wrongs(polygon, &pairs[0], middle, watch),
        own_loads: own_loads(scene, fine, watch),
        interrupted: watch.stopped(),
        pairs,
        repeat,
    }
}

impl CouplingStudy<'_> {
    /// Whether nobody stopped it and everything was solved.
    pub fn complete(&self) -> bool {
        !self.interrupted && self.failures().next().is_none()
    }

    /// The failures, each with its reason.
    fn failures(&self) -> impl Iterator<Item = &(String, String)> {
        let errors = self.convergence.failures.iter().chain(&self.effectivity.failures);
        errors
            .chain(&self.costs.failures)
            .chain(&self.conditioning.failures)
            .chain(&self.wrongs.failures)
            .chain(&self.own_loads.failures)
    }
}
