//! Where a point or a line meets an edge: the nearest point, points on a line, pairs of contact, crossings of a ray.

use std::f64::consts::PI;

use num_complex::Complex64;
use steklov_elastic::plane::{cross, distance, dot, minus};

use crate::edge::{Edge, Path, complex};
use crate::predicates::{nearest_on_segment, orientation};

/// A root closer than this to an end of an edge is there (edge parameter).
const AT_END: f64 = 1e-11;

impl Edge {
    /// Distance of x from the edge and the parameter of the nearest point, if it is below `least`.
    pub fn nearest(&self, x: [f64; 2], mut least: f64) -> Option<(f64, f64)> {
        let [a, b] = self.listed();
        let off = self.off_box(x);
        if off[0].max(off[1]) > least * (1.0 + 1e-9) {
            return None;
        }
        if self.is_line() {
            let found = nearest_on_segment(x, a, b);
            return (found.0 <= least).then_some(found);
        }
        let mut best = None;
        let mut stack = vec![(0.0, 1.0, a, b)];
        while let Some((low, high, a, b)) = stack.pop() {
            let deviation = self.deviation(low, high);
            let (gap, along) = nearest_on_segment(x, a, b);
            if gap - deviation > least {
                continue;
            }
            let s = low + (high - low) * along;
            let here = distance(x, self.point(s));
            if here <= least {
                (least, best) = (here, Some((here, s)));
            }
            if deviation > 1e-3 * least && high - low > 1e-9 && deviation > 1e-15 * (x[0].abs() + x[1].abs()) {
                let middle = (low + high) / 2.0;
                let m = self.point(middle);
                stack.push((middle, high, m, b));
                stack.push((low, middle, a, m));
            }
        }
        best.map(|(gap, s)| self.polished(x, gap, s))
    }

    /// Distances, along both axes, of a point from a box around the edge; negative between its sides.
    fn off_box(&self, x: [f64; 2]) -> [f64; 2] {
        let (a, b) = (self.start, self.end);
        let deviation = match self.path {
            // at most half of its chord
            Path::Arc { opening } if opening.abs() <= PI => 0.51 * ((a[0] - b[0]).abs() + (a[1] - b[1]).abs()),
            _ => self.deviation(0.0, 1.0) * (1.0 + 1e-9),
        };
        [0, 1].map(|i| (a[i].min(b[i]) - x[i]).max(x[i] - a[i].max(b[i])) - deviation)
    }

    /// Newton's method for (γ - x)·γ' = 0.
    fn polished(&self, x: [f64; 2], gap: f64, s: f64) -> (f64, f64) {
        let mut best = (gap, s);
        let mut s = s;
        for _ in 0..8 {
            let (y, d) = (self.point(s), self.derivative(s));
            let r = minus(y, x);
            s = (s - dot(r, d) / dot(d, d)).clamp(0.0, 1.0);
            let gap = distance(x, self.point(s));
            if gap < best.0 {
                best = (gap, s);
            }
        }
        best
    }

    /// Where the line through x along a unit vector n meets the edge: parameters and distances along n.
    pub fn met_by(&self, x: [f64; 2], n: [f64; 2]) -> Vec<(f64, f64)> {
        let [a, b] = [self.start, self.end].map(|end| cross(minus(end, x), n));
        if a * b > 0.0 && a.abs().min(b.abs()) > 1e-9 * a.abs().max(b.abs()) + self.deviation(0.0, 1.0) * (1.0 + 1e-9) {
            return Vec::new();
        }
        if let Path::Arc { opening } = self.path {
            return self.arc_met_by(opening, x, n);
        }
        let from = |s: f64| {
            let y = self.point(s);
            minus(y, x)
        };
        let roots = self.roots(&|s| {
            let (r, d) = (from(s), self.derivative(s));
            [cross(r, n), cross(d, n)]
        });
        roots.into_iter().map(|s| (s, from(s)[0] * n[0] + from(s)[1] * n[1])).collect()
    }

    /// The same for an arc about c: |x + d n - c| = R.
    fn arc_met_by(&self, opening: f64, x: [f64; 2], n: [f64; 2]) -> Vec<(f64, f64)> {
        let (centre, arm) = self.arc_from_centre(opening);
        let (r, n, radius) = (complex(x) - centre, complex(n), arm.norm());
        // d² + 2 (r·n) d + (|r|² - R²) = 0
        let half = (r.conj() * n).re;
        let rest = (r.norm() - radius) * (r.norm() + radius);
        let discriminant = half * half - rest;
        if discriminant < 0.0 {
            return Vec::new();
        }
        let larger = -(half + discriminant.sqrt().copysign(half));
        let smaller = if larger == 0.0 { 0.0 } else { rest / larger };
        let place = |d: f64| Some((arc_parameter(opening, arm, r + d * n)?, d));
        [smaller, larger].into_iter().filter_map(place).collect()
    }

    /// Centre of an arc, and the arm from there to its first corner.
    fn arc_from_centre(&self, opening: f64) -> (Complex64, Complex64) {
        let [a, b] = self.listed().map(complex);
        let arm = Complex64::cis(-opening / 2.0) * (b - a) / Complex64::new(0.0, 2.0 * (opening / 2.0).sin());
        (a - arm, arm)
    }

    /// Parameters of the points y for which y - x is along `pull` - `push` n(y): for pull = E₁n₁(x) and push = E₂ the points
    /// that a point x of another body meets when both surfaces give way according to their moduli, for push = 0 the points on
    /// the line through x along `pull`.
    pub fn paired(&self, x: [f64; 2], pull: [f64; 2], push: f64) -> Vec<f64> {
        if let Path::Arc { opening } = self.path {
            return self.arc_paired(opening, x, pull, push);
        }
        self.roots(&|s| {
            let (y, d, n) = (self.point(s), self.derivative(s), self.normal(s));
            let (r, along) = (minus(y, x), [0, 1].map(|i| pull[i] - push * n[i]));
            // the derivative of n is left out: the slope is that of small distances
            [cross(r, along), cross(d, along)]
        })
    }

    /// The same for an arc: with r = c - x, y = c + R e and n = ±e, (r × pull) + e × (± push r + R pull) = 0.
    fn arc_paired(&self, opening: f64, x: [f64; 2], pull: [f64; 2], push: f64) -> Vec<f64> {
        let (centre, arm) = self.arc_from_centre(opening);
        let outward = if (opening > 0.0) == self.reversed { -1.0 } else { 1.0 };
        let (r, pull) = (centre - complex(x), complex(pull));
        let to = outward * push * r + arm.norm() * pull;
        let sine = (r.conj() * pull).im / to.norm();
        if sine.is_nan() || sine.abs() > 1.0 {
            return Vec::new();
        }
        let turn = sine.asin();
        let along = |angle: f64| arc_parameter(opening, arm, to * Complex64::cis(angle));
        [turn, PI - turn].into_iter().filter_map(along).collect()
    }

    /// Roots in [0, 1] of a function with its slope, ends included: one in each part of the edge in which it changes its sign.
    fn roots(&self, f: &dyn Fn(f64) -> [f64; 2]) -> Vec<f64> {
        let parts = if self.is_line() { 1 } else { 32 };
        let knot = |k: usize| k as f64 / parts as f64;
        let values: Vec<[f64; 2]> = (0..=parts).map(|k| f(knot(k))).collect();
        let is_root = |k: &usize| values[*k][0].abs() <= AT_END * values[*k][1].abs();
        let mut roots: Vec<f64> = [0, parts].into_iter().filter(is_root).map(knot).collect();
        for (k, pair) in values.windows(2).enumerate() {
            let ([mut low, mut high], [at_low, at_high]) = ([knot(k), knot(k + 1)], [pair[0][0], pair[1][0]]);
            if at_low * at_high > 0.0 || at_low == at_high {
                continue;
            }
            let mut s = low + (high - low) * at_low / (at_low - at_high);
            for _ in 0..80 {
                let [value, slope] = f(s);
                if value == 0.0 || high - low < 1e-16 {
                    break;
                }
                if (value > 0.0) == (at_low > 0.0) {
                    low = s
                } else {
                    high = s
                }
                let next = s - value / slope;
                let next = if low < next && next < high { next } else { (low + high) / 2.0 };
                if (next - s).abs() < 1e-17 {
                    break;
                }
                s = next;
            }
            roots.push(if s < AT_END {
                0.0
            } else if s > 1.0 - AT_END {
                1.0
            } else {
                s
            });
        }
        roots.sort_by(f64::total_cmp);
        roots.dedup_by(|b, a| *b - *a < AT_END);
        roots
    }

    /// How often the edge, in the direction of traversal, crosses the ray from x to the right, upwards less downwards; x does
    /// not lie on it.
    pub fn crossings(&self, x: [f64; 2]) -> i32 {
        let sign = if self.reversed { -1 } else { 1 };
        let [a, b] = self.listed();
        let off = self.off_box(x);
        if off[1] > 0.0 || off[0] > 0.0 && x[0] > a[0] {
            return 0;
        }
        let mut sum = 0;
        let mut stack = vec![(0.0, 1.0, a, b)];
        while let Some((low, high, a, b)) = stack.pop() {
            let deviation = self.deviation(low, high);
            let (gap, _) = nearest_on_segment(x, a, b);
            if gap > deviation || high - low < 1e-12 {
                // the piece can be drawn to its chord without passing x
                if a[1] <= x[1] && b[1] > x[1] && orientation(a, b, x) > 0.0 {
                    sum += 1;
                } else if a[1] > x[1] && b[1] <= x[1] && orientation(a, b, x) < 0.0 {
                    sum -= 1;
                }
                continue;
            }
            let middle = (low + high) / 2.0;
            let m = self.point(middle);
            stack.push((middle, high, m, b));
            stack.push((low, middle, a, m));
        }
        sign * sum
    }
}

/// Parameter of an arc with this arm to its first corner in a direction from its centre, if it is on the arc.
fn arc_parameter(opening: f64, arm: Complex64, from_centre: Complex64) -> Option<f64> {
    // from the middle of the arc, so that no angle is beyond ±180°
    let middle = Complex64::cis(opening / 2.0) * arm;
    let s = 0.5 + (from_centre * middle.conj()).arg() / opening;
    let s = if s.abs() < AT_END {
        0.0
    } else if (s - 1.0).abs() < AT_END {
        1.0
    } else {
        s
    };
    (0.0..=1.0).contains(&s).then_some(s)
}
