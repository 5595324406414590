//! The far field of an unbounded body.

use steklov_coupling::Radiation;

/// The far field of a medium.
#[derive(Debug, Clone, PartialEq)]
pub struct FarField {
    /// Stress xx, yy, xy far away.
    pub remote_stress: [f64; 3],
    /// How the displacement behaves far away, that of the remote stress apart; `None`: as fits the supports.
    pub at_infinity: Option<Radiation>,
    /// Whether the remote stress has names in it: with random ones it may vanish in an outcome.
    pub named: bool,
}

impl Default for FarField {
    fn default() -> Self {
        Self { remote_stress: [0.0; 3], at_infinity: None, named: false }
    }
}

impl FarField {
    /// Whether it loads the bodies.
    pub fn is_loaded(&self) -> bool {
        self.named || self.remote_stress != [0.0; 3]
    }
}
