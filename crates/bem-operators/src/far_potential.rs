//! The field of an element at a distant point, by a Gauss-Legendre rule whose nodes and values are known beforehand.
//!
//! With r = x - γ(t), F = 1/r, e = r/r̄, vectors as complex numbers, A = c_V ½|γ| ψ - h_rr J u', B = -κ c_V ½|γ| ψ - h_log J u' and
//! the primitive b of B, b(±1) = ±b₀,
//!
//! ```text
//! u = ½∫(A + e Ā)dt + b₀ (log|x-v₀| + log|x-v₁| - 2 log L) + ∫ (Re(γ'F) b - Im(γ'F) û/2π) dt
//! ∂_x u = ½∫(1-e) F̄ Ā dt + ∫ (Re F B - Im F u'/2π) dt       ∂_y u = ½i∫(1+e) F̄ Ā dt - ∫ (Im F B + Re F u'/2π) dt
//! ```
//! A node costs one division and no logarithm, whatever the degree.

use std::f64::consts::PI;

use num_complex::Complex64;
use steklov_quadrature::legendre_p;

use crate::curve::{AXIS, Curve, INJECTIVE};
use crate::inner::{points_for, weighted_rule};
use crate::near::MAX_ORDER;

/// log ϱ from which each rule holds.
const LOG_RHO: [f64; 3] = [0.5, 1.0, 2.0];

/// Legendre coefficients of the functions on an element.
pub(crate) struct Series {
    /// A and B, as many as tractions.
    pub(crate) a: Vec<[f64; 2]>,
    pub(crate) b: Vec<[f64; 2]>,
    /// u', and û of one degree more.
    pub(crate) derivative: Vec<[f64; 2]>,
    pub(crate) displacement: Vec<[f64; 2]>,
}

/// Nodes of a rule and the weighted values there.
#[derive(Debug, Clone)]
pub(crate) struct Nodes {
    ends: [Complex64; 2],
    /// 2 log L.
    log_length: f64,
    /// ½∫A dt and b₀.
    constant: [f64; 2],
    resultant: [f64; 2],
    fours: Vec<Four>,
}

/// x and y components at four nodes: weights are 0 beyond the last one.
#[derive(Debug, Clone, Default)]
struct Four {
    point: [[f64; 4]; 2],
    /// γ'.
    slope: [[f64; 4]; 2],
    a: [[f64; 4]; 2],
    b: [[f64; 4]; 2],
    primitive: [[f64; 4]; 2],
    /// u'/2π and û/2π.
    derivative: [[f64; 4]; 2],
    displacement: [[f64; 4]; 2],
}

/// The number of the rule of fewest nodes that holds at a point, from squared distances of [`reach`].
pub(crate) fn rule_at(reach: [f64; 3], distance_squared: f64) -> Option<usize> {
    (0..3).rev().find(|&k| distance_squared > reach[k])
}

/// Squared distances from γ(0) beyond which each rule holds: |z| ≥ (ϱ + 1/ϱ)/2 of the preimage z, which on an arc of half opening α is at least
/// log(1 + d/R)/α; on a polynomial curve ϱ ≥ 3 of a point without a preimage.
pub(crate) fn reach(curve: &Curve) -> [f64; 3] {
    LOG_RHO.map(|log_rho| {
        let least = match curve {
            Curve::Line(ends) => ends.half().norm() * log_rho.cosh(),
            Curve::Arc(arc) => arc.radius * (arc.half_opening.abs() * log_rho.cosh()).exp_m1(),
            Curve::Polynomial(_) if log_rho > INJECTIVE.ln() => f64::INFINITY,
            Curve::Polynomial(curve) => {
                let far: f64 = curve.of.middle.iter().skip(1).rev().fold(0.0, |sum, a| (sum + a.norm()) * AXIS);
                curve.slope.norm() * far
            }
        };
        least * least
    })
}

impl Nodes {
    /// The nodes of rule `rule` of an element.
    pub(crate) fn new(curve: &Curve, rule: usize, of: &Series, log_length: f64) -> Self {
        let count = of.displacement.len();
        let weighted = weighted_rule(points_for(count + 2, LOG_RHO[rule]));
        let points = &weighted.rule.points;
        let mut fours = vec![Four::default(); points.len().div_ceil(4)];
        let ends = curve.ends();
        for k in 0..4 * fours.len() {
            let (four, lane) = (&mut fours[k / 4], k % 4);
            let t = points[k.min(points.len() - 1)];
            let w = if k < points.len() { weighted.rule.weights[k] } else { 0.0 };
            let mut p = [0.0; MAX_ORDER];
            legendre_p(t, &mut p[..count + 1]);
            let sum = |c: &[[f64; 2]], factor: f64| {
                [0, 1].map(|i| factor * c.iter().zip(&p).map(|(c, p)| c[i] * p).sum::<f64>())
            };
            let primitive = |n: usize| if n == 0 { p[1] } else { (p[n + 1] - p[n - 1]) / (2 * n + 1) as f64 };
            let of_b = [0, 1].map(|i| w * of.b.iter().enumerate().map(|(n, b)| b[i] * primitive(n)).sum::<f64>());
            let (x, slope) = (curve.point(t), curve.derivative(t));
            let values = [
                (&mut four.point, [x.re, x.im]),
                (&mut four.slope, [slope.re, slope.im]),
                (&mut four.a, sum(&of.a, w)),
                (&mut four.b, sum(&of.b, w)),
                (&mut four.primitive, of_b),
                (&mut four.derivative, sum(&of.derivative, w / (2.0 * PI))),
                (&mut four.displacement, sum(&of.displacement, w / (2.0 * PI))),
            ];
            for (of, value) in values {
                (0..2).for_each(|i| of[i][lane] = value[i]);
            }
        }
        let first = |c: &[[f64; 2]]| c.first().copied().unwrap_or_default();
        Self {
            ends: [ends.start, ends.end],
            log_length: 2.0 * log_length,
            constant: first(&of.a),
            resultant: first(&of.b),
            fours,
        }
    }

    /// Adds the displacement and its gradient at a distant point.
    pub(crate) fn add(&self, x: Complex64, u: &mut [f64; 2], gradient: &mut [[f64; 2]; 2]) {
        let sums = pulp::Arch::new().dispatch(Sums { fours: &self.fours, x });
        let [ux, uy, gx, gy, hx, hy, xx, xy, yx, yy] = sums.map(|[a, b, c, d]| (a + b) + (c + d));
        let log = 0.5 * ((x - self.ends[0]).norm_sqr().ln() + (x - self.ends[1]).norm_sqr().ln()) - self.log_length;
        u[0] += self.constant[0] + log * self.resultant[0] + ux;
        u[1] += self.constant[1] + log * self.resultant[1] + uy;
        gradient[0][0] += 0.5 * (gx - hx) + xx;
        gradient[1][0] += 0.5 * (gy - hy) + xy;
        gradient[0][1] += yx - 0.5 * (gy + hy);
        gradient[1][1] += yy + 0.5 * (gx + hx);
    }
}

/// u, ∫F̄Ā, ∫e F̄Ā and the other parts of the slopes along x and y at x, by lanes.
struct Sums<'a> {
    fours: &'a [Four],
    x: Complex64,
}

impl pulp::NullaryFnOnce for Sums<'_> {
    type Output = [[f64; 4]; 10];

    #[inline(always)]
    fn call(self) -> [[f64; 4]; 10] {
        let x = self.x;
        let mut sums = [[0.0; 4]; 10];
        for four in self.fours {
            let [y, slope, a, b, primitive, d, v] =
                [&four.point, &four.slope, &four.a, &four.b, &four.primitive, &four.derivative, &four.displacement];
            for k in 0..4 {
                let (rx, ry) = (x.re - y[0][k], x.im - y[1][k]);
                let inverse = 1.0 / (rx * rx + ry * ry);
                let (fx, fy) = (rx * inverse, ry * inverse);
                let (ex, ey) = (rx * fx - ry * fy, rx * fy + ry * fx);
                let (re, im) = (slope[0][k] * fx + slope[1][k] * fy, slope[1][k] * fx - slope[0][k] * fy);
                sums[0][k] += 0.5 * (ex * a[0][k] + ey * a[1][k]) + re * primitive[0][k] - im * v[0][k];
                sums[1][k] += 0.5 * (ey * a[0][k] - ex * a[1][k]) + re * primitive[1][k] - im * v[1][k];
                let (gx, gy) = (fx * a[0][k] + fy * a[1][k], fy * a[0][k] - fx * a[1][k]);
                sums[2][k] += gx;
                sums[3][k] += gy;
                sums[4][k] += ex * gx - ey * gy;
                sums[5][k] += ex * gy + ey * gx;
                sums[6][k] += fx * b[0][k] + fy * d[0][k];
                sums[7][k] += fx * b[1][k] + fy * d[1][k];
                sums[8][k] += fy * b[0][k] - fx * d[0][k];
                sums[9][k] += fy * b[1][k] - fx * d[1][k];
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use proptest::collection::vec;
    use proptest::prelude::*;
    use steklov_elastic::{Material, Plane};

    use crate::{BoundaryField, Loop, Mesh, Polygon, Space};

    /// A square with a circular and an elliptic hole, coefficients of a field on it, and a point.
    fn fields() -> impl Strategy<Value = (BoundaryField, [f64; 2], f64)> {
        let data = (2usize..9, 1usize..3, -4.0f64..4.0, vec(-1.0f64..1.0, 4096), [-2.0f64..2.0, -2.0f64..2.0]);
        data.prop_map(|(degree, arcs, exponent, values, x)| {
            let size = 10f64.powf(exponent);
            let corners = [[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]].map(|x| x.map(|x| size * x)).to_vec();
            let holes = vec![
                Loop::circle([-size, 0.0], 0.6 * size, 2 * arcs, "c"),
                Loop::ellipse([0.8 * size, 0.3 * size], [0.7 * size, 0.4 * size], 0.4, 4 * arcs, "e"),
            ];
            let polygon = Polygon::new(Loop::straight(corners, vec!["s".to_owned(); 4]), holes).unwrap();
            let mesh = Mesh::uniform(&polygon, 8 * arcs + 4, degree);
            let space = Space::new(&mesh);
            let material = Material::new(1.0, 0.3, Plane::Strain).unwrap();
            let (u, t) = (&values[..space.dofs()], &values[2048..2048 + 2 * space.offset[mesh.len()]]);
            let u: Vec<f64> = u.iter().map(|u| size * u).collect();
            (BoundaryField::new(&mesh, &space, &material, &u, t, size), x.map(|x| size * x), size)
        })
    }

    proptest! {
        #[test]
        fn rules_give_what_exact_integrals_give((field, x, size) in fields()) {
            let (by_rules, exact) = (field.inside(x), field.clone().by_exact_integrals().inside(x));
            // rules are used: some element is far from every point
            prop_assert_ne!(by_rules, exact);
            for i in 0..2 {
                let off = (by_rules.displacement[i] - exact.displacement[i]).abs() / size;
                prop_assert!(off < 2e-12, "displacement {i} at {x:?}: {off:e}");
                for j in 0..2 {
                    let (a, b) = (by_rules.gradient[i][j], exact.gradient[i][j]);
                    // elements that are near have slopes of 1/distance, which both have
                    prop_assert!((a - b).abs() < 2e-12 * (1.0 + b.abs()), "slope {i}{j} at {x:?}: {a:e} for {b:e}");
                }
            }
        }
    }
}
