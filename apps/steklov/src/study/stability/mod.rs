//! Where boundary elements could fail and do not: nearly incompressible material, degenerate scales of the single layer.
//!
//! ```text
//! settings ─► incompressible (errors over ν), single_layer (eigenvalues over size) ─► Stability ─► store, table, draw
//! ```
//! Each part is a file: what it computes, and the columns of its table.

mod incompressible;
mod beside;
mod single_layer;
mod columns;
mod table;
mod store;
mod draw;

use steklov_bem_operators::Plane;

use crate::scene::Scene;

pub use beside::{Beside, BesideError, read_beside};
pub use draw::pictures;
pub use incompressible::{Incompressible, POISSON, Point, Truth, incompressible};
pub use single_layer::{SingleLayer, Spectrum, single_layer};
pub use store::write;
pub use table::{csv, json, text};

/// First mesh and tolerance of the scene where the user sets nothing else: the errors of coarse uniform meshes are
/// measured, for which references of 1/50 of this tolerance are fine enough.
const FIRST: [&str; 3] = ["method.elements=16", "method.degree=1", "method.tolerance=1e-3"];

/// A finished study.
#[derive(Debug)]
pub struct Stability<'a> {
    /// The scene as it was run, settings included.
    pub scene: &'a Scene,
    /// Errors as ν → ½.
    pub incompressible: &'a Incompressible,
    /// Results of other methods for the same scene.
    pub beside: &'a [Beside],
    /// Eigenvalues of the single layer matrix.
    pub single_layer: &'a SingleLayer,
    /// Whether the user stopped it.
    pub interrupted: bool,
}

impl Stability<'_> {
    /// Whether nobody stopped it and every mesh was solved at every ratio.
    pub fn complete(&self) -> bool {
        !self.interrupted && self.incompressible.complete()
    }

    /// What a reader of the results must know.
    pub fn note(&self) -> Option<&'static str> {
        (self.scene.material.plane == Plane::Stress).then_some(
            "plane stress: ν = 1/2 is the plane strain ratio ν/(1+ν) = 1/3, which constrains nothing; no method can lock here",
        )
    }
}

/// The overrides of a study: a coarse first mesh and a tolerance where the user sets nothing else, then those of the user.
pub fn settings(user: &[String]) -> Vec<String> {
    let key = |o: &str| o.split('=').next().unwrap_or_default().trim().to_owned();
    let first = FIRST.iter().filter(|o| user.iter().all(|u| key(u) != key(o))).map(|&o| o.to_owned());
    first.chain(user.iter().cloned()).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn settings_of_the_user_win() {
        let user = ["method.degree = 3".to_owned(), "title=\"a\"".to_owned()];
        let expected = ["method.elements=16", "method.tolerance=1e-3", "method.degree = 3", "title=\"a\""];
        assert_eq!(super::settings(&user), expected);
    }
}
