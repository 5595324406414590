//! Covariance functions of stationary random fields.

use crate::StochasticError;

/// Family of covariance functions of a distance r, at correlation length ℓ.
///
/// Source: Rasmussen and Williams (2006), section 4.2.1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kernel {
    /// exp(-r/ℓ): continuous, nowhere differentiable paths. On rectangles exp(-|Δx|/ℓ_1 - |Δy|/ℓ_2).
    Exponential,
    /// exp(-(r/ℓ)²): smooth paths. On rectangles exp(-(Δx/ℓ_1)² - (Δy/ℓ_2)²).
    Gaussian,
    /// (1 + √3 r/ℓ) exp(-√3 r/ℓ): once differentiable paths. On rectangles r/ℓ = √((Δx/ℓ_1)² + (Δy/ℓ_2)²).
    Matern32,
}

impl Kernel {
    /// C at the scaled distance r/ℓ ≥ 0; 1 at 0.
    pub fn value(self, scaled: f64) -> f64 {
        match self {
            Self::Exponential => (-scaled).exp(),
            Self::Gaussian => (-scaled * scaled).exp(),
            Self::Matern32 => {
                let r = 3f64.sqrt() * scaled;
                (1.0 + r) * (-r).exp()
            }
        }
    }
}

/// Covariance of a stationary field of mean 0 and variance 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Covariance {
    /// Its family.
    pub kernel: Kernel,
    /// Correlation lengths ℓ_1, ℓ_2 > 0 in the directions of x and y; on an interval only the first counts.
    pub correlation: [f64; 2],
}

impl Covariance {
    /// Covariance of two points of an interval at the distance `dx` of either sign.
    pub fn on_interval(&self, dx: f64) -> f64 {
        self.kernel.value(dx.abs() / self.correlation[0])
    }

    /// Covariance of two points of a rectangle that are (`dx`, `dy`) apart, see [`Kernel`].
    ///
    /// The exponential and the Gaussian are products of their values on the sides; the Matérn covariance is not.
    pub fn on_rectangle(&self, dx: f64, dy: f64) -> f64 {
        let (x, y) = (dx.abs() / self.correlation[0], dy.abs() / self.correlation[1]);
        match self.kernel {
            Kernel::Exponential | Kernel::Gaussian => self.kernel.value(x) * self.kernel.value(y),
            Kernel::Matern32 => self.kernel.value(x.hypot(y)),
        }
    }
}

/// Refuses a value that is not a positive, finite length.
pub(crate) fn check_length(what: &str, value: f64) -> Result<(), StochasticError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(StochasticError::Number { what: what.to_string(), value, wanted: "positive and finite" })
}
