//! The integrals over one curve against panels that are graded towards the target, on random curves.

use num_complex::Complex64;
use proptest::prelude::*;
use steklov_quadrature::{gauss_legendre, legendre_p};

use super::Inner;
use crate::curve::{Curve, Shape};
use crate::moments::Segment;

const COUNT: usize = 9;

/// Panels of [-1, 1], halved while they are longer than their distance from x.
fn panels(curve: &Curve, x: Complex64) -> Vec<[f64; 2]> {
    let (mut stack, mut done) = (vec![[-1.0, 1.0]], Vec::new());
    while let Some([a, b]) = stack.pop() {
        let middle: f64 = (a + b) / 2.0;
        let points = [a, middle, b].map(|t| (curve.point(t) - x).norm());
        let length = (b - a) * curve.half_length();
        if length < points.into_iter().fold(f64::INFINITY, f64::min) || b - a < 1e-13 {
            done.push([a, b]);
        } else {
            stack.extend([[a, middle], [middle, b]]);
        }
    }
    done
}

/// ∫P_n log, F, E, D and X by their definitions.
fn by_panels(curve: &Curve, x: Complex64) -> [[Complex64; COUNT]; 5] {
    let rule = gauss_legendre(24);
    let mut sums = [[Complex64::ZERO; COUNT]; 5];
    for [a, b] in panels(curve, x) {
        let panel = rule.mapped(a, b);
        for (&t, &w) in panel.points.iter().zip(&panel.weights) {
            let (r, mut p) = (x - curve.point(t), [0.0; COUNT]);
            legendre_p(t, &mut p);
            let f = r.inv();
            let values = [r.norm().ln().into(), f, r / r.conj(), curve.derivative(t) * f, -r / (r.conj() * r.conj())];
            for (sum, value) in sums.iter_mut().zip(values) {
                sum.iter_mut().zip(p).for_each(|(sum, p)| *sum += w * p * value);
            }
        }
    }
    sums
}

fn admissible() -> impl Strategy<Value = Curve> {
    let arc = (-1.57..1.57f64).prop_filter("an arc", |a| a.abs() > 1e-6).prop_map(Shape::Arc);
    let b = prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 2..=8);
    let polynomial = (b, 0.02..0.6f64).prop_map(|(b, size)| {
        let scaled = |(k, (x, y)): (usize, &(f64, f64))| Complex64::new(*x, *y) * size.powi(k as i32 + 1);
        Shape::of_coefficients(b.iter().enumerate().map(scaled).collect::<Vec<_>>().into_iter())
    });
    (prop_oneof![arc, polynomial], -2.0..2.0f64, 0.1..3.0f64).prop_filter_map("admissible", |(shape, x, y)| {
        let ends = Segment { start: Complex64::new(x, 0.3), end: Complex64::new(-x, y) };
        let curve = Curve::new(ends, &shape);
        ((ends.end - ends.start).norm() > 0.1 && curve.is_admissible()).then_some(curve)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// At every distance, beside the curve and beyond its ends.
    #[test]
    fn integrals_are_those_of_panels_at_any_distance(
        curve in admissible(),
        t in -1.3..1.3f64,
        exponent in -6.0..1.0f64,
        left: bool,
    ) {
        let normal = Complex64::I * curve.derivative(t.clamp(-1.0, 1.0));
        let normal = normal / normal.norm();
        let size = curve.half_length();
        let along = (t - t.clamp(-1.0, 1.0)) * curve.derivative(t.clamp(-1.0, 1.0));
        let distance = size * 10f64.powf(exponent) * if left { 1.0 } else { -1.0 };
        let x = curve.point(t.clamp(-1.0, 1.0)) + along + distance * normal;
        let ends = curve.ends();
        let mut inner = Inner::default();
        inner.off_curve(&curve, [x - ends.start, x - ends.end], COUNT, true);
        let want = by_panels(&curve, x);
        // rounding of x, over the distance to the curve
        let off = panels(&curve, x).into_iter().flatten().map(|t| (curve.point(t) - x).norm()).fold(f64::INFINITY, f64::min);
        let rounding = 1e-15 * (x.norm() + 4.0) / off.max(1e-12);
        for n in 0..COUNT {
            let got = [inner.log(n).into(), inner.f[n], inner.e[n], inner.d[n], inner.x[n]];
            for (k, got) in got.into_iter().enumerate() {
                let largest = want[k].iter().fold(0.0, |m: f64, v| m.max(v.norm()));
                let error = (got - want[k][n]).norm();
                prop_assert!(error <= (3e-12 + 40.0 * rounding) * largest.max(1e-3), "{k} {n}: {got} {} {error:e} of {largest:e}, {off:e} off {curve:?}", want[k][n]);
            }
        }
    }
}
