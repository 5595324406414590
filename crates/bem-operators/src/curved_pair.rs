//! Moments of pairs of elements at least one of which is curved, and of a curved element with itself.
//!
//! They are the five tables of [`PARTS`], first element × second element, since no single one of Legendre functions holds
//! them all. The inner integrals are those of [`Inner`], exact up to roundoff at any distance; the outer element is the
//! shorter one, and its rule knows two singular points, the preimages of the ends of the inner element.

use num_complex::Complex64;
use steklov_quadrature::{bernstein, legendre_p};

use crate::curve::{Curve, INJECTIVE, evaluate, evaluate_derivative};
use crate::inner::{Inner, Weighted, divided, points_for, weighted_rule};
use crate::moments::{same, storage as line_storage};
use crate::near::{MAX_ORDER, PANEL_BERNSTEIN, gauss_points, panel_rule, panels, substitution_rule};

/// ∫∫ P_m P_n of log|x-y|, Re E, Im E with E = (x-y)/conj(x-y), (x-y)·n_y |γ'|/r² of the second element as the trial one,
/// and of the first.
pub(crate) const PARTS: usize = 5;

/// Length of the tables of a pair.
pub(crate) fn storage(rows: usize, cols: usize) -> usize {
    PARTS * rows * cols
}

/// Distance of the far end of the inner element, as a Bernstein parameter of the outer one, from which the substitution τ⁵
/// reaches roundoff at a shared vertex; then the same for τ⁷.
const FIFTH: f64 = 2.2;
const SEVENTH: f64 = 1.5;

/// The tables of two different elements.
pub(crate) fn moments(first: &Curve, second: &Curve, rows: usize, cols: usize, out: &mut [f64]) {
    let size = rows * cols;
    let outer_first = first_is_outer(first, second);
    if outer_first {
        ordered(first, second, rows, cols, out);
        return;
    }
    let mut turned = vec![0.0; storage(rows, cols)];
    ordered(second, first, cols, rows, &mut turned);
    for (part, from) in [0, 1, 2, 4, 3].into_iter().enumerate() {
        for m in 0..rows {
            for n in 0..cols {
                out[part * size + m * cols + n] = turned[from * size + n * rows + m];
            }
        }
    }
}

/// The shorter element is the outer one. If two elements that share a vertex are about equally long, the outer one is that
/// from which the far end of the other is farther away, since its rules depend on that distance.
fn first_is_outer(first: &Curve, second: &Curve) -> bool {
    let (a, b) = (first.half_length(), second.half_length());
    if (a - b).abs() > 0.1 * a.max(b) {
        return a < b;
    }
    let far = |outer: &Curve, inner: &Curve| Shared::of(outer, inner).map(|shared| shared.far);
    match (far(first, second), far(second, first)) {
        (Some(a), Some(b)) if (a - b).abs() > 1e-9 * a => a > b,
        _ => a <= b,
    }
}

/// A vertex that two elements share.
struct Shared {
    at_start: bool,
    /// Bernstein parameter of the other end of the inner element on the outer one; 1 if that is shared too.
    far: f64,
}

impl Shared {
    fn of(outer: &Curve, inner: &Curve) -> Option<Self> {
        let (o, i) = (outer.ends(), inner.ends());
        let (at_start, other) = if o.start == i.end {
            (true, i.start)
        } else if o.end == i.start {
            (false, i.end)
        } else if o.start == i.start {
            (true, i.end)
        } else if o.end == i.end {
            (false, i.start)
        } else {
            return None;
        };
        Some(Self { at_start, far: bernstein(singular_point(outer, other)) })
    }
}

/// The parameter of a point on the outer element, ±1 at its ends; for a point without a preimage any parameter on the ellipse.
fn singular_point(outer: &Curve, y: Complex64) -> Complex64 {
    let ends = outer.ends();
    if y == ends.end {
        Complex64::ONE
    } else if y == ends.start {
        -Complex64::ONE
    } else {
        let none = Complex64::new(0.0, (INJECTIVE - 1.0 / INJECTIVE) / 2.0);
        outer
            .preimage([y - ends.start, y - ends.end])
            .map_or(none, |[zm1, zp1]| if zm1.norm_sqr() < zp1.norm_sqr() { 1.0 + zm1 } else { zp1 - 1.0 })
    }
}

/// The tables with the outer element first.
fn ordered(outer: &Curve, inner: &Curve, rows: usize, cols: usize, out: &mut [f64]) {
    assert!(rows <= MAX_ORDER && cols < MAX_ORDER, "degrees above {} are not supported", MAX_ORDER - 2);
    out[..storage(rows, cols)].fill(0.0);
    let mut sum = PairSum { outer, inner, rows, cols, at: Inner::default(), out };
    let shared = Shared::of(outer, inner);
    let extra = rows.saturating_sub(10);
    let substitution = shared.as_ref().and_then(|s| match s.far {
        far if far >= FIFTH => Some((5, 40 + 3 * extra)),
        far if far >= SEVENTH => Some((7, 80 + 2 * extra)),
        _ => None,
    });
    if let Some((power, points)) = substitution {
        let at_start = shared.is_some_and(|s| s.at_start);
        let rule = substitution_rule(points, power);
        for (&sigma, &w) in rule.points.iter().zip(&rule.weights) {
            let (before, after) = if at_start { (sigma, 1.0 - sigma) } else { (1.0 - sigma, sigma) };
            sum.add(before, after, 2.0 * w);
        }
        return;
    }
    let ends = inner.ends();
    let [s1, s2] = [ends.start, ends.end].map(|y| singular_point(outer, y));
    let rho = bernstein(s1).min(bernstein(s2));
    if shared.is_none() && rho >= PANEL_BERNSTEIN {
        let rule = panel_rule(gauss_points(rows, rho.ln()));
        for (&g, &w) in rule.points.iter().zip(&rule.weights) {
            sum.add((1.0 + g) / 2.0, (1.0 - g) / 2.0, w);
        }
        return;
    }
    let rule = panel_rule(gauss_points(rows, PANEL_BERNSTEIN.ln()));
    for [low, high] in panels(s1, s2) {
        let half = (high - low) / 2.0;
        for (&g, &w) in rule.points.iter().zip(&rule.weights) {
            let before = ((1.0 + low) + half * (1.0 + g)) / 2.0;
            let after = ((1.0 - high) + half * (1.0 - g)) / 2.0;
            sum.add(before, after, half * w);
        }
    }
}

/// Adds points of the outer rule to the tables.
struct PairSum<'a> {
    outer: &'a Curve,
    inner: &'a Curve,
    rows: usize,
    cols: usize,
    at: Inner,
    out: &'a mut [f64],
}

impl PairSum<'_> {
    /// The point at the fraction `before` = (1+s)/2 from the start, `after` = (1-s)/2 from the end, each accurate by itself.
    fn add(&mut self, before: f64, after: f64, weight: f64) {
        let (rows, cols) = (self.rows, self.cols);
        let ends = self.inner.ends();
        let from = self.outer.differences(before, after, [ends.start, ends.end]);
        self.at.off_curve(self.inner, from, cols, false);
        let s = if before < after { 2.0 * before - 1.0 } else { 1.0 - 2.0 * after };
        let slope = self.outer.derivative(s);
        let mut p = [0.0; MAX_ORDER];
        legendre_p(s, &mut p[..rows]);
        let mut values = [[0.0; MAX_ORDER]; PARTS];
        for n in 0..cols {
            let (d, e) = (self.at.d[n], self.at.e[n]);
            let reverse = -(slope * self.at.f[n]).im;
            for (value, part) in values.iter_mut().zip([self.at.log(n), e.re, e.im, d.im, reverse]) {
                value[n] = part;
            }
        }
        for (table, value) in self.out.chunks_exact_mut(rows * cols).zip(&values) {
            for (row, &p) in table.chunks_exact_mut(cols).zip(&p) {
                let wp = weight * p;
                row.iter_mut().zip(value).for_each(|(sum, v)| *sum += wp * v);
            }
        }
    }
}

/// The tables of a curved element with itself: the logarithm of the distance of the parameters in closed form, the rest is
/// smooth, with γ[s,t] = (γ(s)-γ(t))/(s-t) for which |x-y| = |s-t||γ[s,t]|.
pub(crate) fn own(curve: &Curve, rows: usize, out: &mut [f64]) {
    let size = rows * rows;
    out[..storage(rows, rows)].fill(0.0);
    let mut straight = vec![0.0; line_storage(rows, rows)];
    // one more degree, for the logarithm of the last one
    same(rows + 1, rows + 1, &mut straight);
    let (l0, q) = straight.split_at(rows + 1);
    let q = |m: usize, n: usize| q[2 * (m * (rows + 1) + n)];
    for m in 0..rows {
        out[m * rows] = l0[m];
        for n in 1..rows {
            out[m * rows + n] = 2.0 / (2 * n + 1) as f64 * (q(m, n + 1) - q(m, n - 1));
        }
    }
    let rule = match curve {
        Curve::Arc(arc) => arc.rest_rule(rows + 1),
        _ => weighted_rule(points_for(rows + 1, INJECTIVE.ln())),
    };
    for (i, &s) in rule.rule.points.iter().enumerate() {
        let quotient = Quotient::new(curve, s);
        let mut inner = vec![0.0; 4 * rows];
        for (j, &t) in rule.rule.points.iter().enumerate() {
            let (g, d) = quotient.at(t);
            let e = g * g / g.norm_sqr();
            for (k, value) in [g.norm().ln(), e.re, e.im, d].into_iter().enumerate() {
                inner[k * rows..].iter_mut().zip(rule.row(j, rows)).for_each(|(sum, w)| *sum += w * value);
            }
        }
        add_outer(rule, i, rows, &inner, &mut out[..4 * size]);
    }
    // test and trial are one element
    let (parts, reverse) = out.split_at_mut(4 * size);
    for m in 0..rows {
        for n in 0..rows {
            reverse[m * rows + n] = parts[3 * size + n * rows + m];
        }
    }
}

fn add_outer(rule: &Weighted, i: usize, rows: usize, inner: &[f64], out: &mut [f64]) {
    for (table, inner) in out.chunks_exact_mut(rows * rows).zip(inner.chunks_exact(rows)) {
        for (row, &w) in table.chunks_exact_mut(rows).zip(rule.row(i, rows)) {
            row.iter_mut().zip(inner).for_each(|(sum, v)| *sum += w * v);
        }
    }
}

/// γ[s,t] for one s, and Im γ'(t)/(γ(s)-γ(t)) where t → s leaves it finite.
enum Quotient {
    Line(Complex64),
    /// iα A exp(iα(s+t)/2) sin(w)/w, w = α(s-t)/2.
    Arc {
        factor: Complex64,
        half_opening: f64,
        s: f64,
    },
    /// γ'(0), and the rest in units of it.
    Polynomial(Complex64, Vec<Complex64>),
}

impl Quotient {
    fn new(curve: &Curve, s: f64) -> Self {
        match curve {
            Curve::Line(ends) => Self::Line(ends.half()),
            Curve::Arc(arc) => {
                let turn = Complex64::cis(arc.half_opening * (1.0 + s / 2.0));
                let factor = Complex64::new(0.0, arc.half_opening) * arc.arms[0] * turn;
                Self::Arc { factor, half_opening: arc.half_opening, s }
            }
            Curve::Polynomial(curve) => Self::Polynomial(curve.slope, divided(&curve.of.middle, s.into())),
        }
    }

    fn at(&self, t: f64) -> (Complex64, f64) {
        match self {
            Self::Line(half) => (*half, 0.0),
            Self::Arc { factor, half_opening, s } => {
                let w = half_opening * (s - t) / 2.0;
                let sinc = if w == 0.0 { 1.0 } else { w.sin() / w };
                (factor * Complex64::cis(half_opening * t / 2.0) * sinc, -half_opening / 2.0)
            }
            Self::Polynomial(slope, quotient) => {
                let g = evaluate(quotient, t.into());
                (slope * g, -(evaluate_derivative(quotient, t.into()) / g).im)
            }
        }
    }
}

#[cfg(test)]
mod tests;
