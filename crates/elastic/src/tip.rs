//! The fields at a point where a zone of contact ends: one half of its line is held along y, without friction, the other one is free.
//!
//! ```text
//! (r, θ): θ = 0 is held along y, θ = π is free, the body is 0 < θ < π
//! 2μ u_x = r^λ ((κ - Q(λ+1)) cos λθ - λ cos (λ-2)θ)      σ_xx = λ r^(λ-1) ((2 - Q(λ+1)) cos (λ-1)θ - (λ-1) cos (λ-3)θ)
//! 2μ u_y = r^λ ((κ + Q(λ+1)) sin λθ + λ sin (λ-2)θ)      σ_yy = λ r^(λ-1) ((2 + Q(λ+1)) cos (λ-1)θ + (λ-1) cos (λ-3)θ)
//!                                                        σ_xy = λ r^(λ-1) ((λ-1) sin (λ-3)θ + Q(λ+1) sin (λ-1)θ)
//! λ = ±1/2, ±3/2, ...: Q = (1-λ)/(1+λ)
//! ```
//! By Betti's theorem ∮ (t·u* - t*·u) ds is the same around the tip on every path from one half line to the other; with the field of
//! exponent -λ as u*, t* it is c times the amplitude of that of exponent λ in u, and nothing of the others.
//!
//! Source: Williams (1952), stress singularities at corners; Bueckner (1970), weight functions.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::Material;
use crate::plane::{dot, minus};

/// The field of one exponent.
#[derive(Debug, Clone, Copy)]
pub struct TipField {
    exponent: f64,
    mu: f64,
    kappa: f64,
}

/// Points of the trapezoidal rule on a circle: it is exact for the products of these fields.
const POINTS: usize = 32;

impl TipField {
    /// The field of amplitude 1 with the exponent ±1/2, ±3/2, ...
    pub fn new(material: &Material, exponent: f64) -> Self {
        Self { exponent, mu: material.mu(), kappa: material.kappa() }
    }

    /// Displacement and stress at a point, the tip in the origin; the half line x = 0, y < 0 is outside of the body.
    pub fn at(&self, [x, y]: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        let angle = y.atan2(x);
        self.polar(x.hypot(y), if angle < -FRAC_PI_2 { angle + 2.0 * PI } else { angle })
    }

    fn polar(&self, r: f64, angle: f64) -> ([f64; 2], [f64; 3]) {
        let l = self.exponent;
        // Q (λ + 1)
        let q = 1.0 - l;
        let (sin, cos) = (|k: f64| (k * angle).sin(), |k: f64| (k * angle).cos());
        let (size, stress) = (r.powf(l) / (2.0 * self.mu), l * r.powf(l - 1.0));
        let u = [(self.kappa - q) * cos(l) - l * cos(l - 2.0), (self.kappa + q) * sin(l) + l * sin(l - 2.0)];
        let s = [
            (2.0 - q) * cos(l - 1.0) - (l - 1.0) * cos(l - 3.0),
            (2.0 + q) * cos(l - 1.0) + (l - 1.0) * cos(l - 3.0),
            (l - 1.0) * sin(l - 3.0) + q * sin(l - 1.0),
        ];
        (u.map(|u| size * u), s.map(|s| stress * s))
    }

    /// u_y on the free half line at the distance 1.
    pub fn opening(&self) -> f64 {
        self.polar(1.0, PI).0[1]
    }

    /// ∫ (t·u* - t*·u) over the half circle 0 < θ < π with its normal away from the tip, of this field and that of the opposite exponent.
    pub fn norm(&self) -> f64 {
        let dual = Self { exponent: -self.exponent, ..*self };
        let at = |k: usize| {
            let angle = (k as f64 + 0.5) * PI / POINTS as f64;
            let n = [angle.cos(), angle.sin()];
            betti(n, self.polar(1.0, angle), dual.polar(1.0, angle))
        };
        (0..POINTS).map(at).sum::<f64>() * PI / POINTS as f64
    }
}

/// t·u* - t*·u of two states of displacement and stress, on a line with the normal n.
fn betti(n: [f64; 2], state: ([f64; 2], [f64; 3]), other: ([f64; 2], [f64; 3])) -> f64 {
    let traction = |[xx, yy, xy]: [f64; 3]| [xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]];
    dot(traction(state.1), other.0) - dot(traction(other.1), state.0)
}

/// A frame whose origin is the end of a zone of contact: x along the zone, y into the body. It may be left-handed: a field that is mirrored
/// is one.
#[derive(Debug, Clone, Copy)]
pub struct TipFrame {
    /// The end.
    pub origin: [f64; 2],
    /// Unit vector along the zone.
    pub along: [f64; 2],
    /// Unit vector into the body.
    pub inward: [f64; 2],
}

impl TipFrame {
    /// The components of a vector.
    pub fn components(&self, v: [f64; 2]) -> [f64; 2] {
        [dot(v, self.along), dot(v, self.inward)]
    }

    /// The coordinates of a point.
    pub fn coordinates(&self, x: [f64; 2]) -> [f64; 2] {
        self.components(minus(x, self.origin))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Plane;

    fn material(nu: f64, plane: Plane) -> Material {
        Material::new(3.0, nu, plane).unwrap()
    }

    #[test]
    fn stresses_are_those_of_the_displacement_and_the_half_lines_are_held_and_free() {
        for (nu, plane) in [(0.0, Plane::Strain), (0.3, Plane::Strain), (0.45, Plane::Stress)] {
            let material = material(nu, plane);
            for exponent in [-1.5, -0.5, 0.5, 1.5, 2.5] {
                let field = TipField::new(&material, exponent);
                for x in [[0.7, 0.4], [-0.3, 0.8], [0.9, -0.2], [-0.6, -0.5]] {
                    let step = 1e-5;
                    let slope = |i: usize| {
                        let moved = |sign: f64| {
                            field.at(if i == 0 { [x[0] + sign * step, x[1]] } else { [x[0], x[1] + sign * step] }).0
                        };
                        minus(moved(1.0), moved(-1.0)).map(|d| d / (2.0 * step))
                    };
                    let (dx, dy) = (slope(0), slope(1));
                    let stress = material.stress([[dx[0], dy[0]], [dx[1], dy[1]]]);
                    let told = field.at(x).1;
                    let size = told.iter().fold(0.0, |m: f64, s| m.max(s.abs()));
                    assert!(
                        (0..3).all(|i| (stress[i] - told[i]).abs() < 1e-8 * size),
                        "{exponent} {x:?}: {stress:?} {told:?}"
                    );
                }
                let (u, [_, _, shear]) = field.at([0.5, 0.0]);
                let (_, [_, normal, free_shear]) = field.polar(0.5, PI);
                assert!([u[1], shear, normal, free_shear].iter().all(|v| v.abs() < 1e-13), "{exponent}");
            }
        }
    }

    /// Betti's integral on half circles of any radius, by a Gauss-like midpoint rule of many points, tells fields apart.
    #[test]
    fn the_integral_of_two_fields_is_zero_but_for_opposite_exponents() {
        let material = material(0.3, Plane::Strain);
        let fields = [-1.5, -0.5, 0.5, 1.5, 2.5, 3.5];
        for own in fields {
            for other in fields {
                for radius in [0.2, 1.0, 3.0] {
                    let (a, b) = (TipField::new(&material, own), TipField::new(&material, other));
                    let points = 400;
                    let at = |k: usize| {
                        let angle = (k as f64 + 0.5) * PI / points as f64;
                        let n = [angle.cos(), angle.sin()];
                        betti(n, a.polar(radius, angle), b.polar(radius, angle)) * radius * PI / points as f64
                    };
                    let sum: f64 = (0..points).map(at).sum();
                    let exact = if own == -other { a.norm() } else { 0.0 };
                    let size = radius.powf(own + other);
                    assert!(
                        (sum - exact).abs() < 1e-10 * size && (own != -other || exact.abs() > 0.1),
                        "{own} {other}: {sum} {exact}"
                    );
                }
            }
        }
    }
}
