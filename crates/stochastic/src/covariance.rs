//! Covariance functions of stationary random fields.

use crate::StochasticError;

/// Family of covariance functions of a distance r, at correlation length ℓ.
///
/// Source: Rasmussen and Williams (2006), section 4.2.1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kernel {
    /// exp(-r/ℓ): continuous, nowhere differentiable paths. On rectangles exp(-|Δx|/ℓ_1 - |Δy|/ℓ_2).
    Exponential,
    /// exp(-(r/ℓ)²): smooth paths. On rectangles exp(-(Δx/ℓ_1)² - (Δy/ℓ_2)²).
    Gaussian,
    /// 2^(1-ν)/Γ(ν) z^ν K_ν(z), z = √(2ν) r/ℓ: paths are n times differentiable for ν > n. On rectangles
    /// r/ℓ = √((Δx/ℓ_1)² + (Δy/ℓ_2)²).
    Matern {
        /// ν, from [`ROUGHEST`](Self::ROUGHEST) to [`SMOOTHEST`](Self::SMOOTHEST).
        smoothness: f64,
    },
}

/// exp(-this) is nothing beside 1.
const NOTHING: f64 = 40.0;
/// More terms than the rule for K_ν has at any distance.
const TERMS: i32 = 1000;

impl Kernel {
    /// (1 + √3 r/ℓ) exp(-√3 r/ℓ): once differentiable paths.
    pub const MATERN_32: Self = Self::Matern { smoothness: 1.5 };
    /// The smallest ν: that of exp(-r/ℓ). Expansions of rougher fields converge too slowly.
    pub const ROUGHEST: f64 = 0.5;
    /// The largest ν: fields are nearly those of exp(-r²/(2ℓ²)), to which they tend as ν → ∞.
    pub const SMOOTHEST: f64 = 10.0;

    /// Whether C on a rectangle is the product of its values on the sides.
    pub fn is_product(self) -> bool {
        !matches!(self, Self::Matern { .. })
    }

    /// Refuses a smoothness out of range.
    pub(crate) fn check(self) -> Result<(), StochasticError> {
        match self {
            Self::Matern { smoothness } if !(Self::ROUGHEST..=Self::SMOOTHEST).contains(&smoothness) => {
                let what = "the smoothness of the Matérn covariance".to_string();
                Err(StochasticError::Number { what, value: smoothness, wanted: "from 0.5 to 10" })
            }
            _ => Ok(()),
        }
    }

    /// C at the scaled distance r/ℓ ≥ 0; 1 at 0.
    pub fn value(self, scaled: f64) -> f64 {
        match self {
            Self::Exponential => (-scaled).exp(),
            Self::Gaussian => (-scaled * scaled).exp(),
            Self::Matern { smoothness } => matern(smoothness, (2.0 * smoothness).sqrt() * scaled),
        }
    }
}

/// 2^(1-ν)/Γ(ν) z^ν K_ν(z): closed forms for ν = 1/2, 3/2, 5/2, else K_ν(z) = ∫_0^∞ exp(-z cosh t) cosh(νt) dt by the trapezoidal
/// rule, whose error falls exponentially.
///
/// Source: DLMF, 10.32.9 and 10.39.2.
fn matern(nu: f64, z: f64) -> f64 {
    if nu == 0.5 {
        return (-z).exp();
    }
    if nu == 1.5 {
        return (1.0 + z) * (-z).exp();
    }
    if nu == 2.5 {
        return (1.0 + z + z * z / 3.0) * (-z).exp();
    }
    // below, 1 - C is less than 1e-17 for every ν > 1/2
    if z < 1e-17 {
        return 1.0;
    }
    if z > NOTHING + 20.0 * nu {
        return 0.0;
    }
    // an error of (2π/step)^(ν-1/2) exp(-π²/step) for small z, of exp(-2π²/(z step²)) for large ones
    let step = 0.6 / (z + nu + 8.0).sqrt();
    let power = nu * z.ln();
    let mut sum = 0.5 * (power - z).exp();
    for k in 1..TERMS {
        let t = f64::from(k) * step;
        let damped = power - z * t.cosh();
        let term = 0.5 * ((damped + nu * t).exp() + (damped - nu * t).exp());
        sum += term;
        // past the largest term, where z sinh t = ν
        if z * t.sinh() > nu && term < 1e-17 * sum {
            break;
        }
    }
    let value = step * sum * 2f64.powf(1.0 - nu) / libm::tgamma(nu);
    value.min(1.0)
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
    /// Refuses correlation lengths that are not positive, and a smoothness out of range.
    pub(crate) fn check(&self) -> Result<(), StochasticError> {
        self.kernel.check()?;
        self.correlation.into_iter().try_for_each(|length| check_length("the correlation length", length))
    }

    /// Covariance of two points of an interval at the distance `dx` of either sign.
    pub fn on_interval(&self, dx: f64) -> f64 {
        self.kernel.value(dx.abs() / self.correlation[0])
    }

    /// Covariance of two points of a rectangle that are (`dx`, `dy`) apart, see [`Kernel`].
    ///
    pub fn on_rectangle(&self, dx: f64, dy: f64) -> f64 {
        let (x, y) = (dx.abs() / self.correlation[0], dy.abs() / self.correlation[1]);
        match self.kernel.is_product() {
            true => self.kernel.value(x) * self.kernel.value(y),
            false => self.kernel.value(x.hypot(y)),
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of mpmath with 40 digits, and the closed form of ν = 7/2.
    #[test]
    fn matern_values_are_those_of_bessel_functions() {
        for (nu, z, value) in GOLD {
            let off = (matern(nu, z) / value - 1.0).abs();
            assert!(off < 2e-14, "{nu} {z}: {off:e}");
        }
        for z in [1e-9f64, 0.01, 0.3, 1.0, 4.0, 30.0] {
            let exact = (1.0 + z + 0.4 * z * z + z * z * z / 15.0) * (-z).exp();
            assert!((matern(3.5, z) / exact - 1.0).abs() < 2e-14, "{z}");
        }
        for nu in [0.5, 0.7, 1.5, 2.5, 10.0] {
            let near = if nu == 0.7 { 1.0 } else { nu + 1e-9 };
            assert_eq!((matern(nu, 0.0), matern(nu, 1e4)), (1.0, 0.0));
            assert!(nu == 0.7 || (matern(nu, 1.3) - matern(near, 1.3)).abs() < 1e-8, "{nu}");
        }
    }

    const GOLD: [(f64, f64, f64); 25] = [
        (0.6, 1e-6, 0.9999999318209749),
        (0.6, 0.05, 0.9718743384809059),
        (0.6, 0.7, 0.5603449312285047),
        (0.6, 3.0, 0.06270263297953381),
        (0.6, 25.0, 2.1325055554871634e-11),
        (1.0, 1e-6, 0.9999999999927843),
        (1.0, 0.05, 0.9954837162941254),
        (1.0, 0.7, 0.7351984747190425),
        (1.0, 3.0, 0.12046929338458255),
        (1.0, 25.0, 8.831945182999835e-11),
        (1.9, 1e-6, 0.9999999999997222),
        (1.9, 0.05, 0.9993081115185277),
        (1.9, 0.7, 0.8890619978414437),
        (1.9, 3.0, 0.2616362774281844),
        (1.9, 25.0, 9.384883004250391e-10),
        (4.25, 1e-6, 0.9999999999999231),
        (4.25, 0.05, 0.9998077190126449),
        (4.25, 0.7, 0.9633024074311505),
        (4.25, 3.0, 0.5376378449122864),
        (4.25, 25.0, 5.4669243324038436e-08),
        (10.0, 1e-6, 0.9999999999999722),
        (10.0, 0.05, 0.9999305582681485),
        (10.0, 0.7, 0.9864924941539175),
        (10.0, 3.0, 0.7817135566404132),
        (10.0, 25.0, 1.2358487133435035e-05),
    ];
}
