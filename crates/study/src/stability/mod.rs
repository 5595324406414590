//! Cases in which boundary elements could fail and do not: nearly incompressible material, degenerate scales of the
//! single layer, stabilised multipliers near the limit of their parameter.
//!
//! ```text
//! settings ─► incompressible (errors over ν), single_layer (eigenvalues over size), stabilisation (γ₀) ─► Stability
//! Stability ─► report, draw
//! ```
//! Each part is a file with its computation and the columns of its table.

mod incompressible;
mod beside;
mod single_layer;
mod stabilisation;
mod report;
mod draw;

use steklov_document::Source;
use steklov_elastic::Plane;
use steklov_problem::{Method, Scene};

use crate::error::StudyError;
use crate::settings::Setting;
use crate::watch::Watch;

pub use beside::{Beside, BesideError, read_beside};
pub use draw::pictures;
pub use incompressible::{Incompressible, POISSON, Point, Truth, incompressible};
pub use report::report;
pub use single_layer::{SingleLayer, Spectrum, single_layer};
pub use stabilisation::{Critical, Stabilisation, WithGamma, stabilisation};

/// Tolerance of the scene: references with 1/50 of it are fine enough for the errors of coarse uniform meshes.
const TOLERANCE: f64 = 1e-3;

/// A finished study.
#[derive(Debug)]
pub struct Stability<'a> {
    /// The scene as it was run, settings included.
    pub scene: &'a Scene,
    /// The texts from which it was read.
    pub source: &'a Source,
    /// Errors as ν → ½.
    pub incompressible: Incompressible,
    /// Results of other methods for the same scene.
    pub beside: Vec<Beside>,
    /// Eigenvalues of the single layer matrix.
    pub single_layer: SingleLayer,
    /// Stabilised multipliers over γ₀; none without contact.
    pub stabilisation: Option<Stabilisation>,
    /// Whether the user stopped it.
    pub interrupted: bool,
}

/// The settings of the study: its tolerance and those of [`crate::settings()`]. `method` is the method of the scene,
/// overrides included.
pub fn settings(method: &Method) -> Vec<Setting> {
    let mut all = crate::settings(&Method { tolerance: Some(TOLERANCE), ..*method });
    all.push(Setting::Tolerance(TOLERANCE));
    all
}

/// All parts of the study, beside results of other methods.
///
/// # Errors
/// As [`incompressible`] and [`single_layer`].
pub fn study<'a>(
    scene: &'a Scene,
    source: &'a Source,
    beside: Vec<Beside>,
    watch: &mut Watch<'_>,
) -> Result<Stability<'a>, StudyError> {
    let incompressible = incompressible(scene, watch)?;
    let single_layer = single_layer(scene, watch)?;
    let stabilisation = stabilisation(scene, watch);
    let interrupted = watch.stopped();
    Ok(Stability { scene, source, incompressible, beside, single_layer, stabilisation, interrupted })
}

impl Stability<'_> {
    /// Whether nobody stopped it and every mesh was solved at every ratio and with every γ₀.
    pub fn complete(&self) -> bool {
        !self.interrupted
            && self.incompressible.complete()
            && self.stabilisation.as_ref().is_none_or(Stabilisation::complete)
    }

    /// A note that a reader of the results needs.
    pub fn note(&self) -> Option<&'static str> {
        (self.scene.body().material().plane == Plane::Stress).then_some(
            "plane stress: ν = 1/2 is the plane strain ratio ν/(1+ν) = 1/3, which constrains nothing; no method can lock here",
        )
    }
}

#[cfg(test)]
mod tests {
    use steklov_problem::Method;

    use super::settings;
    use crate::settings::Setting::{Degree, Elements, MaxDofs, Tolerance};

    #[test]
    fn the_studys_own_tolerance_is_not_that_of_the_scene() {
        let first = [Elements(16), Degree(1)];
        let given = Method { tolerance: Some(1e-7), max_dofs: Some(500), ..Method::default() };
        assert_eq!(settings(&given), [&first[..], &[Tolerance(1e-3)]].concat());
        assert_eq!(settings(&Method::default()), [&first[..], &[MaxDofs(1100), Tolerance(1e-3)]].concat());
    }
}
