//! Moments of element pairs by general outer rules: pairs that touch, nearly touch, or lie anywhere.

use std::sync::OnceLock;

use num_complex::Complex64;
use steklov_quadrature::{Rule, bernstein, gauss_legendre, legendre_p, legendre_q, substituted};

use crate::moments::Segment;

/// Bernstein parameter from which plain Gauss-Legendre on a panel is used.
pub(crate) const PANEL_BERNSTEIN: f64 = 2.2;
/// Ratio of successive panels towards a singular point.
const PANEL_RATIO: f64 = 0.15;
/// Shortest panel: what lies beyond contributes less than roundoff.
const PANEL_MIN: f64 = 1e-15;
/// Largest number of rows or columns that fit the fixed buffers of the inner loop, in whole lanes.
pub(crate) const MAX_ORDER: usize = 72;

/// Points needed so that ϱ^(-2n + degree) is below 1e-16: Gauss-Legendre for P_m Q_n, m < rows, at Bernstein parameter ϱ.
pub(crate) fn gauss_points(rows: usize, log_rho: f64) -> usize {
    rows / 2 + 1 + (19.0 / log_rho).ceil() as usize
}

/// l0 and q of the pair into `out` (layout of `moments::storage`), rows × cols degrees, for any two different elements.
pub(crate) fn moments(outer: Segment, inner: Segment, rows: usize, cols: usize, out: &mut [f64]) {
    assert!(rows <= MAX_ORDER && cols <= MAX_ORDER, "degrees above {} are not supported", MAX_ORDER - 2);
    out[..rows + 2 * rows * cols].fill(0.0);
    let point = PointSum::new(outer, inner, rows, cols);
    if let Some(shared) = Shared::of(outer, inner)
        && let Some((power, n)) = shared.substitution(outer, inner, rows)
    {
        let rule = substitution_rule(n, power);
        for (&sigma, &w) in rule.points.iter().zip(&rule.weights) {
            let (before, after) = match shared.outer_end {
                End::Start => (sigma, 1.0 - sigma),
                End::End => (1.0 - sigma, sigma),
            };
            point.add(before, after, 2.0 * w, out);
        }
        return;
    }
    let [s1, s2] = singular_points(outer, inner);
    let n = gauss_points(rows, PANEL_BERNSTEIN.ln());
    let rule = panel_rule(n);
    for [low, high] in panels(s1, s2) {
        let half = (high - low) / 2.0;
        for (&g, &w) in rule.points.iter().zip(&rule.weights) {
            // (1+s)/2 and (1-s)/2 from the panel's own ends
            let before = ((1.0 + low) + half * (1.0 + g)) / 2.0;
            let after = ((1.0 - high) + half * (1.0 - g)) / 2.0;
            point.add(before, after, half * w, out);
        }
    }
}

/// Positions in the outer parameter where z = -1 and z = +1, exactly ∓1 at a shared end point.
fn singular_points(outer: Segment, inner: Segment) -> [Complex64; 2] {
    let d = outer.half();
    [inner.start, inner.end].map(|y| {
        if y == outer.end {
            Complex64::new(1.0, 0.0)
        } else if y == outer.start {
            Complex64::new(-1.0, 0.0)
        } else {
            ((y - outer.start) + (y - outer.end)) / (2.0 * d)
        }
    })
}

/// Panels of [-1, 1] on each of which both singular points lie outside the Bernstein ellipse of `PANEL_BERNSTEIN`,
/// or that are as short as roundoff next to a singular point on the element.
pub(crate) fn panels(s1: Complex64, s2: Complex64) -> Vec<[f64; 2]> {
    let mut stack = vec![[-1.0, 1.0]];
    let mut done = Vec::new();
    while let Some([low, high]) = stack.pop() {
        let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let parameter = |s: Complex64| bernstein((s - middle) / half);
        let (r1, r2) = (parameter(s1), parameter(s2));
        let (rho, s) = if r1 <= r2 { (r1, s1) } else { (r2, s2) };
        let length = high - low;
        if rho >= PANEL_BERNSTEIN || length < PANEL_MIN {
            done.push([low, high]);
            continue;
        }
        let x = s.re.clamp(low, high);
        let cut = if x - low < 0.05 * length {
            low + PANEL_RATIO * length
        } else if high - x < 0.05 * length {
            high - PANEL_RATIO * length
        } else {
            x
        };
        if cut <= low || cut >= high {
            done.push([low, high]);
            continue;
        }
        stack.push([cut, high]);
        stack.push([low, cut]);
    }
    done
}

/// Which end of the outer element touches the inner one.
#[derive(Clone, Copy)]
enum End {
    Start,
    End,
}

/// A shared vertex, seen from both elements.
struct Shared {
    outer_end: End,
    /// Vectors from the shared vertex along the outer and the inner element.
    along_outer: Complex64,
    along_inner: Complex64,
}

impl Shared {
    fn of(outer: Segment, inner: Segment) -> Option<Self> {
        let (o, i) = (outer.end - outer.start, inner.end - inner.start);
        if outer.start == inner.end {
            Some(Self { outer_end: End::Start, along_outer: o, along_inner: -i })
        } else if outer.end == inner.start {
            Some(Self { outer_end: End::End, along_outer: -o, along_inner: i })
        } else if outer.start == inner.start {
            Some(Self { outer_end: End::Start, along_outer: o, along_inner: i })
        } else if outer.end == inner.end {
            Some(Self { outer_end: End::End, along_outer: -o, along_inner: -i })
        } else {
            None
        }
    }

    /// Power k of σ = τ^k and number of points where that rule reaches roundoff; none for very acute corners.
    ///
    /// The integrand is A(σ) + B(σ) log σ with σ the distance to the shared vertex over the outer length. A is analytic
    /// up to the far end of the inner element, so the rule needs that end well away from the outer element.
    fn substitution(&self, outer: Segment, inner: Segment, rows: usize) -> Option<(u32, usize)> {
        let cosine =
            (self.along_outer * self.along_inner.conj()).re / (self.along_outer.norm() * self.along_inner.norm());
        let ratio = outer.half().norm() / inner.half().norm();
        let extra = rows.saturating_sub(10);
        // cos 45°, cos 20°
        if cosine < std::f64::consts::FRAC_1_SQRT_2 || ratio <= 0.25 {
            Some((5, 40 + 3 * extra))
        } else if cosine < 0.94 {
            Some((7, 80 + 2 * extra))
        } else {
            None
        }
    }
}

/// Adds points of the outer rule to the sums l0 and q.
struct PointSum {
    outer: Segment,
    inner: Segment,
    rows: usize,
    cols: usize,
}

impl PointSum {
    fn new(outer: Segment, inner: Segment, rows: usize, cols: usize) -> Self {
        Self { outer, inner, rows, cols }
    }

    /// The point at the fraction `before` = (1+s)/2 from the start, `after` = (1-s)/2 from the end, each accurate by itself.
    fn add(&self, before: f64, after: f64, weight: f64, out: &mut [f64]) {
        let (rows, cols) = (self.rows, self.cols);
        let inverse = 1.0 / self.inner.half();
        // exact vertex differences keep full relative accuracy next to the inner end points
        let from_end =
            ((self.outer.start - self.inner.end) * after + (self.outer.end - self.inner.end) * before) * inverse;
        let from_start =
            ((self.outer.start - self.inner.start) * after + (self.outer.end - self.inner.start) * before) * inverse;
        let mut q = [Complex64::ZERO; MAX_ORDER];
        let q = &mut q[..cols.max(2)];
        legendre_q(from_end, from_start, q);
        let mut p = [0.0; MAX_ORDER];
        let p = &mut p[..rows];
        legendre_p(if before < after { 2.0 * before - 1.0 } else { 1.0 - 2.0 * after }, p);
        let log = 2.0 * q[1].re + from_end.norm().ln() + from_start.norm().ln();
        let (l0, sums) = out.split_at_mut(rows);
        for m in 0..rows {
            let wp = weight * p[m];
            l0[m] += wp * log;
            for (sum, q) in sums[2 * m * cols..].chunks_exact_mut(2).zip(&q[..cols]) {
                sum[0] += wp * q.re;
                sum[1] += wp * q.im;
            }
        }
    }
}

/// One more than the points of the largest rule, that of a load on an element of degree 64.
const CACHED_RULES: usize = 257;

/// Gauss-Legendre rules, made once.
pub(crate) fn panel_rule(n: usize) -> &'static Rule {
    static RULES: [OnceLock<Rule>; CACHED_RULES] = [const { OnceLock::new() }; CACHED_RULES];
    RULES[n].get_or_init(|| gauss_legendre(n))
}

pub(crate) fn substitution_rule(n: usize, power: u32) -> &'static Rule {
    static FIFTH: [OnceLock<Rule>; CACHED_RULES] = [const { OnceLock::new() }; CACHED_RULES];
    static SEVENTH: [OnceLock<Rule>; CACHED_RULES] = [const { OnceLock::new() }; CACHED_RULES];
    let rules = if power == 5 { &FIFTH } else { &SEVENTH };
    rules[n].get_or_init(|| substituted(n, power))
}
