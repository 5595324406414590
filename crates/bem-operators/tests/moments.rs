//! Moments of difficult pairs of elements against quadratures that use no Legendre function of the second kind.

use std::f64::consts::PI;

use crate::common::max_abs;
use num_complex::Complex64;
use steklov_bem_operators::{PairMoments, Segment, Tables};
use steklov_quadrature::{Rule, gauss_legendre, legendre_p, substituted};

/// LOG, XX, XY, YY, DAB, DBA as `Tables` defines them, row m on a and column n on b, `order`² values each.
struct Moments {
    order: usize,
    tables: [Vec<f64>; 6],
}

const NAMES: [&str; 4] = ["LOG", "rr", "DAB", "DBA"];

impl Moments {
    fn zero(order: usize) -> Self {
        Self { order, tables: std::array::from_fn(|_| vec![0.0; order * order]) }
    }

    /// Those of the lowest degrees.
    fn leading(&self, order: usize) -> Self {
        let part = |table: &Vec<f64>| (0..order * order).map(|k| table[k / order * self.order + k % order]).collect();
        Self { order, tables: self.tables.each_ref().map(part) }
    }

    /// The tables of the library for degrees 0..order.
    fn of_library(a: Segment, b: Segment, order: usize) -> Self {
        let pair = PairMoments::new(a, b, order, order);
        let (ab, ba) = if pair.outer == a {
            (Tables::outer_test(&pair, order, order), Tables::inner_test(&pair, order, order))
        } else {
            (Tables::inner_test(&pair, order, order), Tables::outer_test(&pair, order, order))
        };
        let one = |k: usize| if k == 0 { 4.0 } else { 0.0 };
        let of = |t: &Tables, table: &[f64], m: usize, n: usize| table[n * t.stride + m];
        let rows = |table: &[f64]| (0..order * order).map(|k| of(&ab, table, k / order, k % order)).collect();
        let [log, xx, xy, dab]: [Vec<f64>; 4] = [&ab.log, &ab.xx, &ab.xy, &ab.d].map(|table| rows(table));
        let yy = xx.iter().enumerate().map(|(k, xx)| one(k) - xx).collect();
        let dba = (0..order * order).map(|k| of(&ba, &ba.d, k % order, k / order)).collect();
        Self { order, tables: [log, xx, xy, yy, dab, dba] }
    }

    /// Largest differences of LOG, of XX, XY, YY together, of DAB and of DBA, over the largest value of each. DAB and DBA,
    /// which vanish on a line, stand beside XX, XY, YY in K: their scale is at least a hundredth of those.
    fn errors(&self, want: &Self) -> [f64; 4] {
        let floor = 1e-2 * max_abs(&want.tables[1..4].concat());
        [0..1, 1..4, 4..5, 5..6].map(|group| {
            let (got, want) = (self.tables[group.clone()].concat(), want.tables[group].concat());
            let difference: Vec<f64> = got.iter().zip(&want).map(|(a, b)| a - b).collect();
            max_abs(&difference) / max_abs(&want).max(floor)
        })
    }
}

/// Adds all products of the entries of p and q, those with one of p in a row.
fn add_products(table: &mut [f64], p: &[f64], q: &[f64]) {
    for (row, p) in table.chunks_exact_mut(q.len()).zip(p) {
        row.iter_mut().zip(q).for_each(|(sum, q)| *sum += p * q);
    }
}

/// log r, r_x r_x/r², r_x r_y/r², r_y r_y/r² of r = x - y, and the two double layer kernels times r-free factors.
fn kernels(r: Complex64, da: Complex64, db: Complex64) -> [f64; 6] {
    let square = r.norm_sqr();
    // n is the tangent turned by -90°: r·n |d| = -Im(r conj d)
    let (dab, dba) = (-(r * db.conj()).im / square, (r * da.conj()).im / square);
    [0.5 * square.ln(), r.re * r.re / square, r.re * r.im / square, r.im * r.im / square, dab, dba]
}

/// Panels of [low, high] no longer than `share` times their distance to each of the points.
fn panels(low: f64, high: f64, points: &[Complex64], share: f64) -> Vec<[f64; 2]> {
    let (mut stack, mut done) = (vec![[low, high]], Vec::new());
    while let Some([a, b]) = stack.pop() {
        let close = |p: &Complex64| (p.re - p.re.clamp(a, b)).hypot(p.im) * share < b - a;
        let middle = (a + b) / 2.0;
        if points.iter().any(close) && b - a > 1e-18 && middle > a && middle < b {
            stack.extend([[middle, b], [a, middle]]);
        } else {
            done.push([a, b]);
        }
    }
    done
}

/// Points and weights of a rule on all panels.
fn composite<'a>(rule: &'a Rule, panels: &'a [[f64; 2]]) -> impl Iterator<Item = (f64, f64)> + 'a {
    panels.iter().flat_map(move |&[a, b]| {
        let half = (b - a) / 2.0;
        rule.points.iter().zip(&rule.weights).map(move |(t, w)| (a + half * (1.0 + t), half * w))
    })
}

/// Elements that share the origin, by x = ρ A, y = ρ v B and x = ρ v A, y = ρ B with 0 < ρ, v < 1, which leaves
/// polynomials and log ρ in ρ and a function of v that is analytic but at the corner's image.
fn touching(a: Segment, b: Segment, order: usize) -> Moments {
    let (a_starts, b_starts) = (a.start == Complex64::ZERO, b.start == Complex64::ZERO);
    let (far_a, far_b) = (if a_starts { a.end } else { a.start }, if b_starts { b.end } else { b.start });
    let along = |starts: bool, sigma: f64| if starts { 2.0 * sigma - 1.0 } else { 1.0 - 2.0 * sigma };
    let (radial, angular) = (gauss_legendre(order + 2).mapped(0.0, 1.0), gauss_legendre(24));
    let logarithmic = substituted(6 * order, 5);
    let mut moments = Moments::zero(order);
    for first in [true, false] {
        let (fixed, moving) = if first { (far_a, far_b) } else { (far_b, far_a) };
        let image = fixed / moving;
        // polynomials of both elements times a weight, along ρ
        let integral = |rule: &Rule, v: f64, weight: &dyn Fn(f64) -> f64| {
            let (mut p, mut q, mut sum) = (vec![0.0; order], vec![0.0; order], vec![0.0; order * order]);
            for (&rho, &w) in rule.points.iter().zip(&rule.weights) {
                let (sigma, tau) = if first { (rho, rho * v) } else { (rho * v, rho) };
                legendre_p(along(a_starts, sigma), &mut p);
                legendre_p(along(b_starts, tau), &mut q);
                p.iter_mut().for_each(|p| *p *= w * weight(rho));
                add_products(&mut sum, &p, &q);
            }
            sum
        };
        let mut add = |k: usize, factor: f64, integral: &[f64]| {
            moments.tables[k].iter_mut().zip(integral).for_each(|(sum, value)| *sum += factor * value);
        };
        for (v, weight) in composite(&angular, &panels(0.0, 1.0, &[image], 1.0)) {
            // relative to the image, so that r keeps its digits next to it
            let r = moving * Complex64::new(image.re - v, image.im) * if first { 1.0 } else { -1.0 };
            let of_kernels = kernels(r, a.half(), b.half()).map(|kernel| 4.0 * weight * kernel);
            let (area, edge) = (integral(&radial, v, &|rho| rho), integral(&radial, v, &|_| 1.0));
            (0..4).for_each(|k| add(k, of_kernels[k], &area));
            (4..6).for_each(|k| add(k, of_kernels[k], &edge));
        }
        for (v, weight) in composite(&angular, &[[0.0, 1.0]]) {
            add(0, 4.0 * weight, &integral(&logarithmic, v, &|rho| rho * rho.ln()));
        }
    }
    moments
}

/// Elements that do not touch, a not the longer one, both rules bisected towards the near points; y is measured from
/// the foot of x on b.
fn apart(a: Segment, b: Segment, order: usize) -> Moments {
    let (da, db) = (a.half(), b.half());
    let rule = gauss_legendre(24);
    let (mut p, mut q) = (vec![0.0; order], vec![0.0; order]);
    let mut moments = Moments::zero(order);
    let ends = [b.start, b.end].map(|y| ((y - a.start) + (y - a.end)) / (2.0 * da));
    for (s, w) in composite(&rule, &panels(-1.0, 1.0, &ends, 1.0)) {
        let blend = |y: Complex64| ((a.start - y) * (1.0 - s) + (a.end - y) * (1.0 + s)) / (2.0 * db);
        let (from_start, from_end) = (blend(b.start), blend(b.end));
        let height = if s < 0.0 { from_start.im } else { from_end.im };
        legendre_p(s, &mut p);
        let foot = Complex64::new(0.0, height);
        let mut along_b: [Vec<f64>; 6] = std::array::from_fn(|_| vec![0.0; order]);
        for (u, v) in composite(&rule, &panels(-from_start.re, -from_end.re, &[foot], 1.0)) {
            legendre_p((from_start.re + from_end.re) / 2.0 + u, &mut q);
            for (sum, kernel) in along_b.iter_mut().zip(kernels(db * Complex64::new(-u, height), da, db)) {
                add_products(sum, &[v * kernel], &q);
            }
        }
        p.iter_mut().for_each(|p| *p *= w);
        moments.tables.iter_mut().zip(&along_b).for_each(|(table, along_b)| add_products(table, &p, along_b));
    }
    moments
}

fn segment(start: Complex64, end: Complex64) -> Segment {
    Segment { start, end }
}

/// Prints the errors of the library's tables and returns what is above the tolerance.
fn judge(name: &str, a: Segment, b: Segment, want: &Moments, tolerance: f64) -> Vec<String> {
    let errors = Moments::of_library(a, b, want.order).errors(want);
    println!("{name:44} {:.0e} {}", a.half().norm() / b.half().norm(), errors.map(|e| format!("{e:.0e}")).join(" "));
    let bad = NAMES.iter().zip(errors).filter(|(_, e)| e.is_nan() || *e > tolerance);
    bad.map(|(table, e)| format!("{name}: {table} {e:.1e}")).collect()
}

#[test]
fn the_two_references_agree_on_a_corner_moved_apart_by_roundoff() {
    // identity of the references, so that neither can be wrong alone: a corner moved apart by 1e-14 of its size
    let (a, b) = (Complex64::new(-1.0, 0.0), Complex64::from_polar(0.7, 2.0));
    let (one, two) = (segment(a, Complex64::ZERO), segment(Complex64::ZERO, b));
    let shift = Complex64::new(1e-14, 0.0);
    let moved = segment(a - shift, -shift);
    let errors = apart(moved, two, 8).errors(&touching(one, two, 8));
    assert!(errors.iter().all(|e| *e < 1e-11), "{errors:?}");
}

#[test]
fn corners_of_any_angle_and_ratio() {
    let mut bad = Vec::new();
    for degrees in [0.5, 1.0, 5.0, 10.0, 19.0, 21.0, 30.0, 44.0, 45.1, 46.0, 90.0, 179.0, 181.0, 300.0, 359.0] {
        for ratio in [1.0, 0.8, 0.3, 0.26, 0.24, 0.2, 1e-3, 1e-6] {
            let turn = Complex64::from_polar(1.0, 0.3);
            let far_a = turn * if degrees < 100.0 { 1.0 } else { 0.013 };
            let far_b = far_a * Complex64::from_polar(ratio, degrees * PI / 180.0);
            // b follows a, and the other way round
            for (one, two) in [
                (segment(far_a, Complex64::ZERO), segment(Complex64::ZERO, far_b)),
                (segment(far_b, Complex64::ZERO), segment(Complex64::ZERO, far_a)),
            ] {
                let want = touching(one, two, 18);
                for order in [3, 13, 18] {
                    let name = format!("corner of {degrees}°, degree {}", order - 1);
                    bad.extend(judge(&name, one, two, &want.leading(order), 1e-13));
                }
            }
        }
    }
    assert!(bad.is_empty(), "{} tables: {bad:#?}", bad.len());
}

#[test]
fn elements_that_nearly_touch_or_differ_in_length_by_a_million() {
    let at = Complex64::new;
    let unit = segment(at(-0.5, 0.0), at(0.5, 0.0));
    let turned = |s: Segment, angle: f64| {
        let turn = Complex64::from_polar(1.0, angle);
        segment(s.start * turn, s.end * turn)
    };
    let mut pairs = Vec::new();
    for gap in [1e-1, 1e-3, 1e-6] {
        pairs.push(("opposite sides of a slit", unit, segment(at(0.5, gap), at(-0.5, gap))));
        pairs.push(("parallel, half overlapping", unit, segment(at(0.0, gap), at(1.0, gap))));
        pairs.push(("end above the middle", segment(at(0.1, gap), at(0.1, 0.8)), unit));
        pairs.push(("end beside the end", segment(at(0.5 + gap, 0.0), at(0.7, 0.4)), unit));
        pairs.push(("on one line", unit, segment(at(0.5 + gap, 0.0), at(1.5, 0.0))));
        pairs.push(("sliver of a small angle", unit, segment(at(0.5, 3.0 * gap), at(-0.5, gap))));
        pairs.push(("short above the middle", segment(at(0.1, gap), at(0.1 + 1e-6, gap)), unit));
        pairs.push(("short above the end", segment(at(0.5 + 1e-6, gap), at(0.5, gap + 1e-6)), unit));
        pairs.push(("short and shorter", segment(at(0.0, 0.0), at(gap, 0.0)), segment(at(0.3, 1e-6), at(0.9, 0.2))));
    }
    let mut bad = Vec::new();
    for (name, a, b) in pairs {
        // turned coordinates are rounded, which moves a gap of 1e-6 by 1e-10 of itself
        for (angle, tolerance) in [(0.0, 2e-13), (0.7, 1e-11)] {
            let (a, b) = (turned(a, angle), turned(b, angle));
            let want = apart(a, b, 18);
            for order in [3, 18] {
                let name = format!("{name}, degree {}", order - 1);
                bad.extend(judge(&name, a, b, &want.leading(order), tolerance));
            }
        }
    }
    assert!(bad.is_empty(), "{} tables: {bad:#?}", bad.len());
}
