//! Eigenvalues and modes of the exponential covariance in closed form.

use std::f64::consts::{FRAC_PI_2, PI};

/// Eigenpairs of exp(-|x-y|/ℓ) on the unit interval, for q = 1/(2ℓ).
///
/// With z = kπ/2 + θ, 0 < θ < π/2, both classical equations (q = z tan z for the even modes k = 0, 2, .., z = -q tan z for
/// the odd ones) are z tan θ = q, and mode and eigenvalue are b(x) = √(2/(1+λ)) cos(2zx - θ), λ = q/(z² + q²), for
/// every k.
#[derive(Debug, Clone)]
pub(crate) struct Exponential {
    pub q: f64,
    /// z_k, ascending.
    pub roots: Vec<f64>,
}

impl Exponential {
    pub fn new(q: f64, count: usize) -> Self {
        Self { q, roots: (0..count).map(|k| root(q, k)).collect() }
    }

    pub fn eigenvalue(&self, k: usize) -> f64 {
        let h = self.roots[k].hypot(self.q);
        self.q / h / h
    }

    /// b_k(x); cos θ = z/√(z²+q²) and sin θ = q/√(z²+q²) keep their digits where θ is next to 0 or π/2.
    pub fn mode(&self, k: usize, x: f64) -> f64 {
        let z = self.roots[k];
        let h = z.hypot(self.q);
        let (sin, cos) = (2.0 * z * x).sin_cos();
        (2.0 / (1.0 + self.q / h / h)).sqrt() * (z / h * cos + self.q / h * sin)
    }
}

/// The z = kπ/2 + θ with z tan θ = q and 0 < θ < π/2: Newton's method for z sin θ - q cos θ, which increases, kept inside
/// its bracket by bisection.
fn root(q: f64, k: usize) -> f64 {
    let base = k as f64 * FRAC_PI_2;
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    // exact for q → 0 and q → ∞
    let mut theta =
        if k == 0 { (1.0 / (1.0 / q + 4.0 / (PI * PI))).sqrt() } else { (q / (base + FRAC_PI_2 / 2.0)).atan() };
    for _ in 0..100 {
        let (sin, cos) = theta.sin_cos();
        let z = base + theta;
        // divided by the larger of z and q: nothing overflows
        let scale = z.max(q);
        let value = z / scale * sin - q / scale * cos;
        if value > 0.0 {
            high = theta;
        } else {
            low = theta;
        }
        let slope = sin / scale + z / scale * cos + q / scale * sin;
        let step = value / slope;
        if step.abs() <= f64::EPSILON * theta {
            break;
        }
        let next = theta - step;
        theta = if next > low && next < high { next } else { 0.5 * (low + high) };
    }
    base + theta
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn roots_solve_the_classical_equations(exponent in -12.0..12.0f64, k in 0usize..200) {
            let q = 10f64.powf(exponent);
            let z = root(q, k);
            let base = k as f64 * FRAC_PI_2;
            prop_assert!(z >= base && z <= base + FRAC_PI_2 && z > 0.0);
            // 1e-13 z to either side the sign has changed, up to the rounding of the function itself
            let f = |z: f64| {
                let (sin, cos) = z.sin_cos();
                let value = if k.is_multiple_of(2) { z * sin - q * cos } else { -z * cos - q * sin };
                let flip = if k / 2 % 2 == 0 { 1.0 } else { -1.0 };
                flip * value
            };
            let room = 1e-12 * z;
            prop_assert!(f(z - room) < 0.0 && f(z + room) > 0.0, "{} {}", f(z - room), f(z + room));
        }
    }

    #[test]
    fn extreme_lengths_do_not_overflow() {
        for q in [1e-300, 1e-17, 1e17, 1e300] {
            let modes = Exponential::new(q, 50);
            for k in 0..50 {
                let (lambda, b) = (modes.eigenvalue(k), modes.mode(k, 0.0));
                assert!(lambda > 0.0 && lambda <= 1.0, "{lambda} of {k} at {q}");
                assert!(b > 0.0 && b < 1.5, "{b} of {k} at {q}");
            }
        }
        // z² = q - q²/3 + .. and λ_0 = 1 - 2q/3 + ..
        assert!(((1.0 - Exponential::new(1e-6, 1).eigenvalue(0)) / (2e-6 / 3.0) - 1.0).abs() < 1e-6);
        assert!((Exponential::new(1e-300, 1).roots[0] / 1e-150 - 1.0).abs() < 1e-14);
        assert!((Exponential::new(1e300, 4).roots[3] / (2.0 * PI) - 1.0).abs() < 1e-14);
    }
}
