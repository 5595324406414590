//! Convergence of the answers of a scene with random input, in chance and in space, and the cost of its solvers.
//!
//! ```text
//! settings ─► Chance (rules on the last mesh or grid against a finer rule) ─┐
//!             Space (strategies against the end of an hp one)              ├─► Stochastic ─► report, draw
//!             Solvers (of contact, mesh by mesh)                           ─┘
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

pub use chance::{Chance, Cost, Measured, Quantity, chance, chance_on_grid};
pub use draw::pictures;
pub use report::report;
pub use rules::{FAMILIES, Family, Kind};
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
    /// Errors in space; nothing on grids.
    pub space: Space,
    /// The cost of solvers; none without contact, and on grids.
    pub solvers: Option<Solvers>,
    /// Whether the user stopped it.
    pub interrupted: bool,
}

/// The random input of a scene.
///
/// # Errors
/// A scene without random input.
pub fn random(scene: &Scene) -> Result<&Random, DataError> {
    scene.random.as_ref().ok_or_else(|| {
        let message = "the study is about random input, and no datum of the scene uses any".to_owned();
        let help =
            "declare a name under [random] and use it in the modulus, a load or a gap, or study --what convergence";
        let keys = &[vec!["random"], vec!["material", "young"]];
        DataError::at(DataErrorKind::Unsupported, keys, message, help)
    })
}

/// All parts of the study: chance on the last mesh or grid of an adaptive run; of boundary elements space and solvers too.
///
/// # Errors
/// The errors of the run, of [`chance`], [`space`] and [`solvers`].
pub fn study<'a>(
    scene: &'a Scene,
    source: &'a Source,
    random: &Random,
    watch: &mut Watch<'_>,
) -> Result<Stochastic<'a>, StudyError> {
    let on_grid = scene.is_on_grid();
    let chance = if on_grid {
        let last = run(scene, Progress::new(scene, Vec::new())?, watch.interrupts, &mut |step, event| {
            watch.tell_step("grid", "", step, &event);
            Ok(())
        })?;
        chance_on_grid(scene, random, &last, watch)?
    } else {
        let mut last = run(scene, Progress::first(scene), watch.interrupts, &mut |step, event| {
            watch.tell_step("mesh", "", step, &event);
            Ok(())
        })?;
        chance(scene, random, &mut last, watch)?
    };
    let space = if on_grid { Space::default() } else { space(scene, random, watch)? };
    let solvers = if on_grid { None } else { solvers(scene, watch)? };
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
