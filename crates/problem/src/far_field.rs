//! What an unbounded body does far away.

use steklov_coupling::Radiation;

/// What a medium does far away.
#[derive(Debug, Clone, PartialEq)]
pub struct FarField {
    /// Stress xx, yy, xy far away.
    pub remote_stress: [f64; 3],
    /// What the displacement does far away, that of the remote stress apart; `None`: what fits the supports.
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
