//! Multipliers of contact and their displacements: stable pairs, pairs that need stabilisation, and stabilised pairs.
//!
//! ```text
//! settings ─► pairs (β over elements and degree), pressures (with γ and without) ─► InfSup ─► report, draw
//! ```

mod subspace;
mod pairs;
mod pressure;
mod report;
mod draw;

use steklov_document::Source;
use steklov_problem::{DataError, DataErrorKind, Scene};

use crate::error::StudyError;
use crate::settings::Setting;
use crate::watch::Watch;
use crate::{contact_sides, distinct};

pub use draw::pictures;
pub use pairs::{PAIRS, Pair, Part, Point, pairs};
pub use pressure::{Pressure, Pressures, pressures};
pub use report::report;

/// First mesh: the reference spaces have 16 times its elements.
pub const SETTINGS: [Setting; 1] = [Setting::Elements(8)];

/// A finished study.
#[derive(Debug)]
pub struct InfSup<'a> {
    /// The scene as it was run, settings included.
    pub scene: &'a Scene,
    /// The texts from which it was read.
    pub source: &'a Source,
    /// β of the pairs, mesh by mesh.
    pub points: Vec<Point>,
    /// Pressures of an unstable pair.
    pub pressures: Pressures,
    /// Whether the user stopped it.
    pub interrupted: bool,
}

/// Checks that a scene can be studied.
///
/// # Errors
/// A scene without contact.
pub fn check(scene: &Scene) -> Result<(), DataError> {
    if contact_sides(scene).is_empty() {
        let message = "inf-sup constants are about multipliers of contact, and no side is in contact".to_owned();
        let help = "give a side contact = { gap = \"0\" }, or study --what convergence or stability";
        return Err(DataError::at(DataErrorKind::Unsupported, &[vec!["sides"]], message, help));
    }
    Ok(())
}

/// Pressures and constants of a scene.
///
/// # Errors
/// As [`pressures`] and [`pairs`].
pub fn study<'a>(scene: &'a Scene, source: &'a Source, watch: &mut Watch<'_>) -> Result<InfSup<'a>, StudyError> {
    let pressures = pressures(scene, watch)?;
    let points = pairs(scene, watch)?;
    Ok(InfSup { scene, source, points, pressures, interrupted: watch.stopped() })
}

impl InfSup<'_> {
    /// Whether nobody stopped it and every β is known. The pressure without stabilisation may be anything.
    pub fn complete(&self) -> bool {
        !self.interrupted && self.points.iter().all(|p| p.failure.is_none())
    }

    /// A note that a reader of the results needs.
    pub fn note(&self) -> Option<&'static str> {
        (!self.interrupted && self.points.is_empty()).then_some(
            "the body has too many edges: reference spaces on its coarsest mesh would have more than 3200 unknowns, or \
             method.max_dofs is below those of its mesh",
        )
    }

    /// The points of a pair.
    fn of_pair(&self, pair: usize) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(move |p| p.pair == pair)
    }

    /// The degrees that were studied, rising.
    fn degrees(&self) -> Vec<usize> {
        distinct(self.points.iter().map(|p| p.degree))
    }

    /// Elements of the coarsest mesh.
    fn coarsest(&self) -> usize {
        self.points.iter().map(|p| p.elements).min().unwrap_or(0)
    }
}
