//! How far a solution continues analytically beyond the boundary and across cuts, and the degrees that follow from it.
//!
//! A displacement that is analytic up to the singular points is approximated like ρ^-p on an element, ρ the smallest Bernstein
//! parameter of these points: corners, and circles inside of holes, up to which the solution continues.
//!
//! Source: Trefethen (2013), theorem 8.2, for the error.

use std::f64::consts::PI;

use num_complex::Complex64;
use steklov_quadrature::bernstein;

use crate::Curve;
use crate::edge::complex;

/// Smallest Bernstein parameter of an element of a cut, and of what degrees are foreseen with.
pub(crate) const RHO: f64 = 2.5;
/// That of points without a preimage on a polynomial curve, at least.
const BEYOND: f64 = 3.0;

/// How far a solution continues analytically.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Continuation {
    /// Points at which it is singular: corners that are re-entrant, or at which conditions change.
    pub singular: Vec<[f64; 2]>,
    /// Circles inside of holes up to which it continues: centre and radius.
    pub circles: Vec<([f64; 2], f64)>,
}

impl Continuation {
    /// The smallest Bernstein parameter of a curve over all singular points and circles.
    pub fn rho(&self, curve: &Curve) -> f64 {
        let ends = curve.ends();
        let half = ends.half().norm();
        // (ρ + 1/ρ)/2 of a point: of a line from its distances from both ends
        let of = |x: [f64; 2]| {
            let [to_start, to_end] = [complex(x) - ends.start, complex(x) - ends.end];
            if curve.is_line() {
                let relative = |r: Complex64| (r / half).norm_sqr().sqrt();
                return (relative(to_start) + relative(to_end)) / 2.0;
            }
            let parameter = curve.preimage([to_start, to_end]).map_or(BEYOND, |[a, b]| bernstein((a + b) / 2.0));
            (parameter + 1.0 / parameter) / 2.0
        };
        let mut least = self.singular.iter().map(|&x| of(x)).fold(f64::INFINITY, f64::min);
        let middle = curve.point(0.0);
        let mut reach = reach(curve, least);
        // the nearest one first: most others are beyond its reach
        let apart = |c: [f64; 2]| ((complex(c) - middle) / half).norm_sqr();
        let nearest = self.circles.iter().min_by(|a, b| apart(a.0).total_cmp(&apart(b.0)));
        for &(c, r) in nearest.into_iter().chain(&self.circles) {
            if apart(c) >= ((reach + r) / half).powi(2) {
                continue;
            }
            let at = |k: usize| {
                let (sin, cos) = (2.0 * PI * k as f64 / 12.0).sin_cos();
                [c[0] + r * cos, c[1] + r * sin]
            };
            least = (0..12).map(|k| of(at(k))).fold(least, f64::min);
            reach = self::reach(curve, least);
        }
        // 1 + what may be small
        let beyond = (least - 1.0).max(0.0);
        1.0 + beyond + (beyond * (beyond + 2.0)).sqrt()
    }

    /// The degree of an element at which its error is below `wanted`: 1 + ln(1/wanted)/ln ρ.
    pub fn degree(&self, curve: &Curve, wanted: f64) -> usize {
        let rho = self.rho(curve).clamp(RHO, 1e3);
        1 + (-wanted.ln() / rho.ln()).ceil().max(1.0) as usize
    }
}

/// Distance from the middle of a curve beyond which (ρ + 1/ρ)/2 ≥ |z| is larger than `least`; on an arc of half opening α
/// |z| ≥ log(1 + d/R)/α.
fn reach(curve: &Curve, least: f64) -> f64 {
    match curve {
        Curve::Line(ends) => least * ends.half().norm(),
        Curve::Arc(arc) => arc.radius * (arc.half_opening.abs() * least).exp_m1(),
        Curve::Polynomial(_) => f64::INFINITY,
    }
}

/// κ of a hole of radius R with a gap to the next boundary: the solution continues into the hole up to the circle of radius κ R,
/// the limit of reflections at both.
pub fn continued_radius(radius: f64, gap: f64) -> f64 {
    let c = radius + gap / 2.0;
    c - (c * c - radius * radius).sqrt()
}
