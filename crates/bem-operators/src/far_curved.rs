//! Tables of well separated pairs at least one element of which is curved: Gauss-Legendre in both parameters.
//!
//! The kernels are analytic in the parameter of one element within a Bernstein ellipse whose image does not meet the other
//! element. All points of such an image have a sum of distances to both end points below the largest such sum on the ellipse;
//! the distances of the other element from these end points therefore determine the rule.

use std::sync::OnceLock;

use num_complex::Complex64;

use crate::curve::{Curve, evaluate};
use crate::curved_pair::PARTS;
use crate::inner::{Weighted, weighted_rule};
use crate::moments::LANES;
use crate::near::{MAX_ORDER, gauss_points};

/// Numbers of Gauss points that are used: the needed one is rounded up to the next of these.
const RULES: [usize; 16] = [6, 8, 10, 12, 14, 16, 18, 20, 24, 28, 32, 36, 40, 48, 56, 64];
/// Number of points on an ellipse at which the sum of distances is taken, and a factor for the points between them.
const ELLIPSE_POINTS: usize = 32;
const BETWEEN: f64 = 1.02;

/// An element with the data that the rules for far pairs need.
pub(crate) struct Reach {
    curve: Curve,
    /// Start, middle, end.
    points: [Complex64; 3],
    half_length: f64,
    /// Distances from the two ends must add up to this for each rule.
    sums: [f64; RULES.len()],
    nodes: [OnceLock<Nodes>; RULES.len()],
}

/// Points of a rule on a curve, their number a multiple of [`LANES`]: γ - v₀ and γ'.
struct Nodes {
    points: [Vec<f64>; 2],
    slopes: [Vec<f64>; 2],
}

impl Reach {
    /// The rules for test and trial functions of `rows` degrees.
    pub(crate) fn new(curve: Curve, rows: usize) -> Self {
        let base = gauss_points(rows, f64::INFINITY);
        let ends = curve.ends();
        let sums = RULES.map(|points| match points.checked_sub(base) {
            None | Some(0) => f64::INFINITY,
            Some(more) => largest_sum(&curve, 19.0 / more as f64),
        });
        let points = [ends.start, curve.point(0.0), ends.end];
        let half_length = curve.half_length();
        Self { curve, points, half_length, sums, nodes: Default::default() }
    }

    /// The rule that reaches roundoff on this element at the distance of another one.
    fn rule(&self, other: &Self) -> Option<usize> {
        let [start, _, end] = self.points;
        let distance = |a: Complex64, b: Complex64| (a - b).norm_sqr().sqrt();
        let [a, b, c] = other.points.map(|y| distance(y, start) + distance(y, end));
        // two points of the other element are no farther apart than its length between them
        let least = (a + b).min(b + c) / 2.0 - other.half_length;
        self.sums.iter().position(|&sum| least >= sum)
    }

    fn nodes(&self, rule: usize) -> &Nodes {
        self.nodes[rule].get_or_init(|| {
            let points = &weighted_rule(RULES[rule]).rule.points;
            let last = points[points.len() - 1];
            let padded =
                points.iter().copied().chain(std::iter::repeat(last)).take(points.len().next_multiple_of(LANES));
            let at: Vec<(Complex64, Complex64)> = padded
                .map(|t| (self.curve.from_ends((1.0 + t) / 2.0, (1.0 - t) / 2.0)[0], self.curve.derivative(t)))
                .collect();
            let parts = |of: &dyn Fn(&(Complex64, Complex64)) -> Complex64| {
                [at.iter().map(|z| of(z).re).collect(), at.iter().map(|z| of(z).im).collect()]
            };
            Nodes { points: parts(&|z| z.0), slopes: parts(&|z| z.1) }
        })
    }
}

/// Largest sum of the distances from both end points on the Bernstein ellipse of parameter ϱ.
fn largest_sum(curve: &Curve, log_rho: f64) -> f64 {
    let ends = curve.ends();
    let whole = ends.end - ends.start;
    let sum = |k: usize| {
        let w = Complex64::cis(std::f64::consts::TAU * k as f64 / ELLIPSE_POINTS as f64) * log_rho.exp();
        let z = (w + w.inv()) / 2.0;
        let from_start = match curve {
            Curve::Line(_) => ends.half() * (z + 1.0),
            Curve::Arc(arc) => arc.arms[0] * ((Complex64::I * arc.half_opening * (z + 1.0)).exp() - 1.0),
            Curve::Polynomial(curve) => {
                curve.slope * (evaluate(&curve.of.middle, z) - evaluate(&curve.of.middle, (-1.0).into()))
            }
        };
        let sum = from_start.norm() + (from_start - whole).norm();
        // exp may leave the range of floating point: nothing is that far away
        if sum.is_nan() { f64::INFINITY } else { sum }
    };
    BETWEEN * (0..ELLIPSE_POINTS).map(sum).fold(0.0, f64::max)
}

/// Fills the tables of [`PARTS`], first × second; false where the elements are too near.
pub(crate) struct FarCurved<'a> {
    pub(crate) first: &'a Reach,
    pub(crate) second: &'a Reach,
    pub(crate) rows: usize,
    pub(crate) cols: usize,
    pub(crate) out: &'a mut [f64],
}

impl pulp::NullaryFnOnce for FarCurved<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let Self { first, second, rows, cols, out } = self;
        let (Some(outer), Some(inner)) = (first.rule(second), second.rule(first)) else { return false };
        let (outer_rule, inner_rule) = (weighted_rule(RULES[outer]), weighted_rule(RULES[inner]));
        let (x, y) = (first.nodes(outer), second.nodes(inner));
        let between = first.points[0] - second.points[0];
        let whole = second.points[2] - second.points[0];
        out[..PARTS * rows * cols].fill(0.0);
        let mut kernels = [[0.0; MAX_POINTS]; PARTS];
        // one moment of Re D more than there are columns
        let mut inner_moments = [[0.0; MAX_ORDER]; PARTS];
        for i in 0..outer_rule.rule.len() {
            let slope = [x.slopes[0][i], x.slopes[1][i]];
            let point = Complex64::new(between.re + x.points[0][i], between.im + x.points[1][i]);
            fill_kernels(&mut kernels, point, slope, y);
            contract(&mut inner_moments, &kernels, inner_rule, cols + 1);
            let log_ends = 0.5 * (point.norm_sqr().ln() + (point - whole).norm_sqr().ln());
            log_moments(&mut inner_moments[0], log_ends, cols);
            let weights = outer_rule.row(i, rows);
            for (table, values) in out.chunks_exact_mut(rows * cols).zip(&inner_moments) {
                for (row, &w) in table.chunks_exact_mut(cols).zip(weights) {
                    row.iter_mut().zip(values).for_each(|(sum, v)| *sum += w * v);
                }
            }
        }
        true
    }
}

const MAX_POINTS: usize = RULES[RULES.len() - 1];

/// Re and Im of γ_b'/r, Re and Im of r/r̄, and -Im γ_a'/r, at all points of the second element; Im γ_b'/r comes fourth.
#[inline(always)]
fn fill_kernels(kernels: &mut [[f64; MAX_POINTS]; PARTS], point: Complex64, slope: [f64; 2], y: &Nodes) {
    let [re, turn_re, turn_im, double, reverse] = kernels;
    let count = y.points[0].len();
    for j in 0..count {
        let (rx, ry) = (point.re - y.points[0][j], point.im - y.points[1][j]);
        let inverse = 1.0 / (rx * rx + ry * ry);
        let (sx, sy) = (y.slopes[0][j] * inverse, y.slopes[1][j] * inverse);
        re[j] = sx * rx + sy * ry;
        double[j] = sy * rx - sx * ry;
        turn_re[j] = (rx * rx - ry * ry) * inverse;
        turn_im[j] = 2.0 * rx * ry * inverse;
        reverse[j] = (slope[0] * ry - slope[1] * rx) * inverse;
    }
}

/// Σ_j w_j P_n(t_j) f(t_j), n < `count`.
#[inline(always)]
fn contract(sums: &mut [[f64; MAX_ORDER]; PARTS], kernels: &[[f64; MAX_POINTS]; PARTS], rule: &Weighted, count: usize) {
    for start in (0..count).step_by(LANES) {
        let mut part = [[0.0; LANES]; PARTS];
        for (j, row) in rule.weighted.chunks_exact(MAX_ORDER).enumerate() {
            for (part, kernel) in part.iter_mut().zip(kernels) {
                for (sum, w) in part.iter_mut().zip(&row[start..start + LANES]) {
                    *sum += w * kernel[j];
                }
            }
        }
        for (sums, part) in sums.iter_mut().zip(part) {
            sums[start..start + LANES].copy_from_slice(&part);
        }
    }
}

/// ∫ P_n log|x-γ| dt = Re(D_(n+1) - D_(n-1))/(2n+1), and with the logarithms of the ends for n = 0, in the place of Re D_n.
#[inline(always)]
fn log_moments(d: &mut [f64; MAX_ORDER], log_ends: f64, cols: usize) {
    let mut before = d[0];
    d[0] = log_ends + d[1];
    for n in 1..cols {
        let here = d[n];
        d[n] = (d[n + 1] - before) / (2 * n + 1) as f64;
        before = here;
    }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;
    use proptest::prelude::*;

    use super::{FarCurved, Reach};
    use crate::curve::{Curve, Shape};
    use crate::curved_pair::{self, storage};
    use crate::moments::Segment;

    fn curve(straight: bool) -> impl Strategy<Value = Curve> {
        let shape = prop_oneof![
            if straight { Just(Shape::Line).boxed() } else { (0.1..0.5).prop_map(Shape::Arc).boxed() },
            (-1.5..1.5).prop_map(Shape::Arc),
            Just(Shape::Arc(std::f64::consts::FRAC_PI_4)),
            prop::collection::vec(-0.08..0.08, 4).prop_map(|b| Shape::polynomial(&b)),
        ];
        // axes and diagonals too, where numbers are 0
        let within = |r: f64| {
            let even = (-4i32..=4, -4i32..=4).prop_map(move |(x, y)| 0.25 * r * Complex64::new(x.into(), y.into()));
            prop_oneof![(-r..r, -r..r).prop_map(|(x, y)| Complex64::new(x, y)), even]
        };
        (within(3.0), within(1.0), shape)
            .prop_map(|(start, whole, shape)| Curve::new(Segment { start, end: start + whole }, &shape))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]
        /// Where the rules say that two curves are far from each other they agree with the exact inner integrals.
        #[test]
        fn far_pairs_agree_with_exact_inner_integrals(a in curve(false), b in curve(true), p in 1usize..=16, q in 1usize..=16) {
            let (rows, cols) = (p + 1, q + 1);
            let [mut far, mut near] = [(); 2].map(|()| vec![0.0; storage(rows, cols)]);
            let (ra, rb) = (Reach::new(a.clone(), rows), Reach::new(b.clone(), cols));
            prop_assume!(a.half_length() > 0.0 && b.half_length() > 0.0 && a.is_admissible() && b.is_admissible());
            let pair = FarCurved { first: &ra, second: &rb, rows, cols, out: &mut far };
            prop_assume!(pulp::Arch::new().dispatch(pair));
            curved_pair::moments(&a, &b, rows, cols, &mut near);
            for (far, near) in far.chunks_exact(rows * cols).zip(near.chunks_exact(rows * cols)) {
                let largest = near.iter().fold(0.0f64, |m, v| m.max(v.abs())).max(1.0);
                for (f, n) in far.iter().zip(near) {
                    prop_assert!((f - n).abs() < 3e-14 * largest, "{f} {n}, of {largest}");
                }
            }
        }
    }
}
