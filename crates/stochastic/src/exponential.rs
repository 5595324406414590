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
        let mut next = theta - value / slope;
        if !(next > low && next < high) {
            next = 0.5 * (low + high);
        }
        let step = (next - theta).abs();
        theta = next;
        if step <= f64::EPSILON * theta {
            break;
        }
    }
    base + theta
}
