//! Where boundary elements could fail and do not: nearly incompressible material, degenerate scales of the single layer,
//! stabilised multipliers near the limit of their parameter.
//!
//! ```text
//! settings ─► incompressible (errors over ν), single_layer (eigenvalues over size), stabilisation (γ₀) ─► Stability
//! Stability ─► report, draw
//! ```
//! Each part is a file: what it computes, and the columns of its table.

mod incompressible;
mod beside;
mod single_layer;
mod stabilisation;
mod report;
mod draw;

use steklov_elastic::Plane;
use steklov_problem::{Method, Scene, Source};

use crate::settings::unless_set;

pub use beside::{Beside, BesideError, read_beside};
pub use draw::pictures;
pub use incompressible::{Incompressible, POISSON, Point, Truth, incompressible};
pub use report::report;
pub use single_layer::{SingleLayer, Spectrum, single_layer};
pub use stabilisation::{Critical, Stabilisation, WithGamma, stabilisation};

/// Tolerance of the scene: the errors of coarse uniform meshes are measured, for which references of 1/50 of it are fine
/// enough.
const TOLERANCE: &str = "method.tolerance=1e-3";

/// A finished study.
#[derive(Debug)]
pub struct Stability<'a> {
    /// The scene as it was run, settings included.
    pub scene: &'a Scene,
    /// The texts from which it was read.
    pub source: &'a Source,
    /// Errors as ν → ½.
    pub incompressible: &'a Incompressible,
    /// Results of other methods for the same scene.
    pub beside: &'a [Beside],
    /// Eigenvalues of the single layer matrix.
    pub single_layer: &'a SingleLayer,
    /// Stabilised multipliers over γ₀; none without contact.
    pub stabilisation: Option<&'a Stabilisation>,
    /// Whether the user stopped it.
    pub interrupted: bool,
}

impl Stability<'_> {
    /// Whether nobody stopped it and every mesh was solved at every ratio and with every γ₀.
    pub fn complete(&self) -> bool {
        !self.interrupted && self.incompressible.complete() && self.stabilisation.is_none_or(Stabilisation::complete)
    }

    /// What a reader of the results must know.
    pub fn note(&self) -> Option<&'static str> {
        (self.scene.body().material().plane == Plane::Stress).then_some(
            "plane stress: ν = 1/2 is the plane strain ratio ν/(1+ν) = 1/3, which constrains nothing; no method can lock here",
        )
    }
}

/// The overrides of a study: its tolerance and those of [`crate::settings()`] where the user sets nothing else, then those of
/// the user. `method` is that of the scene.
pub fn settings(method: &Method, user: &[String]) -> Vec<String> {
    crate::settings(method, &unless_set(TOLERANCE, user))
}

#[cfg(test)]
mod tests {
    use steklov_problem::Method;

    #[test]
    fn the_studys_own_tolerance_is_not_that_of_the_scene() {
        let of = |user: &[&str]| {
            let user: Vec<String> = user.iter().map(|&o| o.to_owned()).collect();
            let given = Method { tolerance: Some(1e-7), max_dofs: Some(500), ..Method::default() };
            super::settings(&given, &user)
        };
        let first = ["method.elements=16", "method.degree=1"];
        assert_eq!(of(&["title=\"a\""]), [first[0], first[1], "method.tolerance=1e-3", "title=\"a\""]);
        assert_eq!(of(&["method.degree = 3"]), [first[0], "method.tolerance=1e-3", "method.degree = 3"]);
        assert_eq!(of(&["method.tolerance = 1e-4"]), [first[0], first[1], "method.tolerance = 1e-4"]);
    }
}
