//! How the answers of a scene with random input converge, in chance and in space, and what its solvers cost.
//!
//! ```text
//! settings ─► Chance (rules on the last mesh against a finer one)     ─┐
//!             Space (strategies against the end of an hp one)          ├─► Stochastic ─► report, draw
//!             Solvers (Uzawa, active set, interior point, by the mesh) ─┘
//! ```
//! Each part is a file: what it computes, and the columns of its table.

mod chance;
mod rules;
mod space;
mod solvers;
mod report;
mod draw;

use steklov_problem::{Scene, Source};

pub use chance::{Chance, Cost, Measured, Quantity, chance};
pub use draw::pictures;
pub use report::report;
pub use rules::FAMILIES;
pub use solvers::{Method, SOLVERS, Solvers, solvers};
pub use space::{CURVES, Point, Space, space};

/// A finished study.
#[derive(Debug)]
pub struct Stochastic<'a> {
    /// The scene as it was run, settings included.
    pub scene: &'a Scene,
    /// The texts from which it was read.
    pub source: &'a Source,
    /// Errors in chance.
    pub chance: &'a Chance,
    /// Errors in space.
    pub space: &'a Space,
    /// What solvers cost; none without contact.
    pub solvers: Option<&'a Solvers>,
    /// Whether the user stopped it.
    pub interrupted: bool,
}

impl Stochastic<'_> {
    /// Whether nobody stopped it and every rule and every mesh was solved. Solvers may fail: that is a result.
    pub fn complete(&self) -> bool {
        !self.interrupted && self.failures().next().is_none()
    }

    /// What failed, and why.
    fn failures(&self) -> impl Iterator<Item = &(String, String)> {
        self.chance.failures.iter().chain(&self.space.failures)
    }
}

/// |a - b|/scale, or NaN of what has no size.
fn relative(a: f64, b: f64, scale: f64) -> f64 {
    if scale > 0.0 { (a - b).abs() / scale } else { f64::NAN }
}
