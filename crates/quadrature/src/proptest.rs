//! Strategies for property tests of this crate and of those above it.

use num_complex::Complex64;
use proptest::prelude::*;
use std::f64::consts::PI;

/// Points z off the cut [-1,1], from 1e-12 to 1e6 away, as (log ϱ, z-1, z+1): see [`crate::legendre_q`].
///
/// z = cosh(log ϱ + iθ) with log ϱ spread evenly over the decades and every second θ within a few decades of an axis.
pub fn off_cut() -> impl Strategy<Value = (f64, Complex64, Complex64)> {
    let log_rho = (-12.0..1.1f64).prop_map(|e| 10f64.powf(e));
    let next_to_axis =
        ((-12.0..-1.0f64), 0..4u8).prop_map(|(e, quarter)| f64::from(quarter) * PI / 2.0 + 10f64.powf(e));
    let angle = prop_oneof![-PI..PI, next_to_axis];
    (log_rho, angle).prop_map(|(log_rho, angle)| {
        let s = (0.5 * log_rho).sinh();
        let common = 2.0 * s * s * angle.cos();
        let (sin, cos) = (0.5 * angle).sin_cos();
        let im = log_rho.sinh() * angle.sin();
        (log_rho, Complex64::new(common - 2.0 * sin * sin, im), Complex64::new(common + 2.0 * cos * cos, im))
    })
}
