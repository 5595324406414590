//! Convergence of the answers of a scene with random input, in chance and in space, and the cost of its solvers.
//!
//! ```text
//! settings ─► Chance (rules on the last mesh against a finer one)     ─┐
//!             Space (strategies against the end of an hp one)          ├─► Stochastic ─► report, draw
//!             Solvers (of contact, mesh by mesh)                       ─┘
//! ```
//! Each part is a file with its computation and the columns of its table.

mod chance;
mod rules;
mod space;
mod report;
mod draw;

use steklov_document::Source;
use steklov_model::run::adaptive_loop::{Progress, run};
use steklov_problem::{DataError, DataErrorKind, Random, Scene};

use crate::error::StudyError;
use crate::solvers::{Solvers, solvers};
use crate::watch::Watch;

pub use chance::{Chance, Cost, Measured, Quantity, chance};
pub use draw::pictures;
pub use report::report;
pub use rules::FAMILIES;
pub use space::{CURVES, Point, Space, space};

/// A finished study.
#[derive(Debug)]
pub struct Stochastic<'a> {
    /// The scene as it was run, settings included.
    pub scene: &'a Scene,
    /// The texts from which it was read.
    pub source: &'a Source,
    /// Errors in chance.
    pub chance: Chance,
    /// Errors in space.
    pub space: Space,
    /// The cost of solvers; none without contact.
    pub solvers: Option<Solvers>,
    /// Whether the user stopped it.
    pub interrupted: bool,
}

/// The random input of a scene.
///
/// # Errors
/// A scene without random input, or on a grid.
pub fn random(scene: &Scene) -> Result<&Random, DataError> {
    if scene.is_on_grid() {
        let message = "the study of random input is of boundary elements, and the body of the scene is on a grid";
        let help =
            "solve it with one method after the other: stochastic.method = \"sparse\", \"multilevel\", \"monte-carlo\"";
        let keys = &[vec!["material", "cells"], vec!["method", "model"], vec!["random"]];
        return Err(DataError::at(DataErrorKind::Unsupported, keys, message.to_owned(), help));
    }
    scene.random.as_ref().ok_or_else(|| {
        let message = "the study is about random input, and no datum of the scene uses any".to_owned();
        let help =
            "declare a name under [random] and use it in the modulus, a load or a gap, or study --what convergence";
        let keys = &[vec!["random"], vec!["material", "young"]];
        DataError::at(DataErrorKind::Unsupported, keys, message, help)
    })
}

/// All parts of the study: chance on the last mesh of an adaptive run, space, solvers.
///
/// # Errors
/// The errors of the run, of [`chance`], [`space`] and [`solvers`].
pub fn study<'a>(
    scene: &'a Scene,
    source: &'a Source,
    random: &Random,
    watch: &mut Watch<'_>,
) -> Result<Stochastic<'a>, StudyError> {
    let mut last = run(scene, Progress::first(scene), watch.interrupts, &mut |step, event| {
        watch.tell_step("mesh", "", step, &event);
        Ok(())
    })?;
    let chance = chance(scene, random, &mut last, watch)?;
    let space = space(scene, random, watch)?;
    let solvers = solvers(scene, watch)?;
    Ok(Stochastic { scene, source, chance, space, solvers, interrupted: watch.stopped() })
}

impl Stochastic<'_> {
    /// Whether nobody stopped it and every rule and every mesh was solved. Solvers may fail: that is a result.
    pub fn complete(&self) -> bool {
        !self.interrupted && self.failures().next().is_none()
    }

    /// The failures, each with its reason.
    fn failures(&self) -> impl Iterator<Item = &(String, String)> {
        self.chance.failures.iter().chain(&self.space.failures)
    }
}

/// |a - b|/scale, or NaN without a scale.
fn relative(a: f64, b: f64, scale: f64) -> f64 {
    if scale > 0.0 { (a - b).abs() / scale } else { f64::NAN }
}
