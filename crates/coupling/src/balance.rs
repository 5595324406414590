//! Whether the loads have a resultant, and what then happens at infinity.

use crate::CouplingError;

/// Resultant of a load over the sum of its absolute values up to which it counts as zero: quadrature of body forces leaves a
/// small one.
const TOLERANCE: f64 = 1e-6;

/// How the displacement behaves at infinity.
///
/// Source: Issaoui (2014), equation (5.90); Hsiao and Wendland (2008), section 2.2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Radiation {
    /// u_c = G_L F + O(1/r) with F the resultant of the loads, so that u_c → 0 without one. With a resultant u_c grows as
    /// log(L/r), and L selects a translation.
    Decaying,
    /// u_c = a + O(1/r) with the mean of u over the interface zero and a unknown. Needs loads without a resultant; does not
    /// depend on L.
    Bounded,
}

/// Resultant ∫ f + ∫ t0 of all loads. A moment is allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance {
    /// The resultant (force per thickness).
    pub force: [f64; 2],
    /// Sum of the absolute values of the nodal loads (force per thickness).
    pub scale: f64,
}

impl Balance {
    pub(crate) fn new(load: &[f64]) -> Self {
        let force = [0, 1].map(|i| load.iter().skip(i).step_by(2).sum());
        Self { force, scale: load.iter().map(|f| f.abs()).sum() }
    }

    /// |∫ f + ∫ t0| over the sum of absolute values; 0 without loads.
    pub fn relative(&self) -> f64 {
        let [x, y] = self.force;
        if self.scale == 0.0 { 0.0 } else { x.hypot(y) / self.scale }
    }

    /// Whether the resultant is below 1e-6 of the loads.
    pub fn is_balanced(&self) -> bool {
        self.relative() <= TOLERANCE
    }

    /// # Errors
    /// [`CouplingError::Unbalanced`].
    pub(crate) fn check(&self) -> Result<(), CouplingError> {
        if self.is_balanced() {
            return Ok(());
        }
        Err(CouplingError::Unbalanced { force: self.force, relative: self.relative(), tolerance: TOLERANCE })
    }
}
