//! Residual estimators as numbers, part by part.
//!
//! ```text
//! η² = Σ over elements of ON_BOUNDARY                               one body by boundary elements
//!    = Σ over outcomes of their probability times that + TRUNCATION  random input
//!    = Σ over coarse cells of IN_COARSE_CELLS                       multiscale elements against bilinear ones
//!    = Σ of IN_CELLS or IN_COARSE_CELLS + ON_INTERFACE              a body on a grid and the medium around it
//! ```
//! All squared parts are energies (force times length per thickness). An estimator follows the error times a constant of its own;
//! the estimate of a run ([`crate::estimate::error_estimate`]) has none and is another one.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Name and meaning of a part.
pub type Part = (&'static str, &'static str);

/// The parts of a boundary element of length h and degree p, E Young's modulus; the terms of contact are in
/// `steklov_contact::ContactResidual`.
pub const ON_BOUNDARY: [Part; 10] = [
    ("neumann", "h/(pE) |t - S u|^2 where t is prescribed"),
    ("equation", "hE/p |d/ds((K+1/2)u - V psi)|^2"),
    ("contact", "h/(pE) |lambda + S u|^2"),
    (STABILISATION, "h/(p^2 E) |lambda + S u|^2 of stabilised multipliers"),
    ("complementarity", "pressure where the gap is open"),
    ("tension", "negative pressure"),
    ("penetration", "overlap"),
    ("bound", "shear beyond the friction bound"),
    ("friction", "slip below the bound or against the shear"),
    ("held", "E/(2(1-nu^2)) |w| |dw/ds| of what the nodes leave of a held displacement"),
];
/// The part of stabilised multipliers.
pub const STABILISATION: &str = "stabilisation";

/// The part of random input: the truncation error of polynomials of the germs in the displacement.
pub const TRUNCATION: &str = "truncation";

/// The parts of a coarse cell of extent H.
pub const IN_COARSE_CELLS: [Part; 5] = [
    ("volume_mean", "H^2/E of the mean body force"),
    ("volume_oscillation", "H^2/E of the rest of the body force"),
    ("jump_mean", "H/E of the mean jumps of the traction between coarse cells"),
    ("jump_oscillation", "H/E of the rest of these jumps"),
    ("neumann", "H/E of the given traction less that of the solution"),
];

/// The parts of the cells of a grid, against the exact solution.
pub const IN_CELLS: [&str; 3] = ["volume", "jump", "neumann"];

/// The parts of a boundary element between body and medium.
pub const ON_INTERFACE: [&str; 3] = ["interface_traction", "interface_displacement", "interface_oscillation"];

/// Residual estimators of the last solution by kind, each null if it does not apply.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimators {
    /// Boundary elements with biorthogonal multipliers, or without contact; of random input for its nominal outcome.
    pub contact: Option<Estimator>,
    /// Boundary elements with stabilised multipliers.
    pub stabilised: Option<Estimator>,
    /// Boundary elements, in the mean over all outcomes of random input.
    pub stochastic: Option<Estimator>,
    /// Multiscale elements against bilinear elements on all fine cells.
    pub multiscale: Option<Estimator>,
    /// A body on a grid and the medium around it.
    pub coupling: Option<Estimator>,
}

/// A residual estimator.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimator {
    /// η, the root of the sum of the squared parts (energy norm): the error times a constant that no residual knows.
    pub value: f64,
    /// η over (2 strain energy)^½.
    pub relative: f64,
    /// Its parts, each the root of a sum over elements (energy norm).
    pub parts: BTreeMap<String, f64>,
}

impl Estimators {
    /// Name and estimator of each kind.
    pub fn named(&self) -> [(&'static str, Option<&Estimator>); 5] {
        [
            ("contact", self.contact.as_ref()),
            ("stabilised", self.stabilised.as_ref()),
            ("stochastic", self.stochastic.as_ref()),
            ("multiscale", self.multiscale.as_ref()),
            ("coupling", self.coupling.as_ref()),
        ]
    }
}

impl Estimator {
    /// The same over another norm: value and parts are relative then.
    pub fn over(&self, norm: f64) -> Self {
        let parts = self.parts.iter().map(|(name, part)| (name.clone(), part / norm)).collect();
        Self { value: self.value / norm, relative: self.value / norm, parts }
    }

    /// The estimator with these squared parts (energies), relative to (2 strain energy)^½.
    pub fn new<'a>(squared: impl IntoIterator<Item = (&'a str, f64)>, scale: f64) -> Self {
        let (mut sum, mut parts) = (0.0, BTreeMap::new());
        for (name, part) in squared {
            sum += part;
            parts.insert(name.to_owned(), part.sqrt());
        }
        let value = sum.sqrt();
        // nothing is strained: all that is estimated is missing
        let relative = if scale > 0.0 { value / scale } else { f64::from(u8::from(value > 0.0)) };
        Self { value, relative, parts }
    }
}
