//! Densities on an interval as many weighted points.

use steklov_quadrature::{Rule, gauss_jacobi, gauss_legendre};

/// Densities below this logarithm, relative to the largest of the interval, are left out.
const NEGLIGIBLE: f64 = -720.0;
/// Largest change of the logarithm of a density within a panel.
const CHANGE: f64 = 16.0;
/// Points of a panel beyond those that a polynomial needs.
const EXTRA: usize = 16;
/// A Gauss-Jacobi rule treats powers up to this one at an end of the interval.
const POWER: f64 = 10.0;

/// ∫_a^b f g dt ≈ exp(`log_scale`) Σ `weights` f(`middle` + `half` `points`), for a density g that need not be normalised.
///
/// Points are in [-1,1]: they keep their distances also where the interval is narrow and far from 0.
pub(crate) struct Discrete {
    pub middle: f64,
    pub half: f64,
    pub points: Vec<f64>,
    pub weights: Vec<f64>,
    pub log_scale: f64,
}

impl Discrete {
    fn new(a: f64, b: f64, log_scale: f64) -> Self {
        Self { middle: 0.5 * (a + b), half: 0.5 * (b - a), points: vec![], weights: vec![], log_scale }
    }

    /// Takes the points of a panel [l, r] with weights times exp(log_density(t, share of the panel left of t)).
    fn panel(&mut self, l: f64, r: f64, rule: &Rule, log_density: impl Fn(f64, f64) -> f64) {
        let width = r - l;
        for (x, w) in rule.points.iter().zip(&rule.weights) {
            let share = 0.5 * (1.0 + x);
            let t = l + width * share;
            // from the middle of the interval, as l and r of narrow ones differ in their last digits only
            self.points.push(((l - self.middle) + width * share) / self.half);
            self.weights.push(0.5 * width * w * (log_density(t, share) - self.log_scale).exp());
        }
    }

    /// Σ of the weights: the integral of the density over exp(`log_scale`).
    pub fn mass(&self) -> f64 {
        self.weights.iter().sum()
    }

    /// Mean and variance of a function of t - `middle`, by centred sums.
    pub fn moments(&self, value: impl Fn(f64) -> f64) -> (f64, f64) {
        let values: Vec<f64> = self.points.iter().map(|x| value(self.half * x)).collect();
        let average = |f: &dyn Fn(f64) -> f64| -> f64 {
            values.iter().zip(&self.weights).map(|(&v, w)| w * f(v)).sum::<f64>() / self.mass()
        };
        let mean = average(&|v| v);
        (mean, average(&|v| (v - mean) * (v - mean)))
    }
}

/// exp(-t²/2) on [a, b], a < b, ends may be infinite; the interval of the points is cut where the density is negligible.
///
/// Good for polynomials of degree 2`degree`: panels of width 1 or less, over each of which the logarithm changes little.
pub(crate) fn normal(a: f64, b: f64, degree: usize) -> Discrete {
    let top = 0f64.clamp(a, b);
    let reach = (top * top - 2.0 * NEGLIGIBLE).sqrt();
    let (a, b) = (a.max(-reach), b.min(reach));
    let mut discrete = Discrete::new(a, b, -0.5 * top * top);
    let count = ((b - a) * (reach / CHANGE).max(1.0)).ceil().max(1.0);
    let rule = gauss_legendre(degree + EXTRA);
    let end = |k: usize| if k as f64 == count { b } else { a + (b - a) * (k as f64 / count) };
    for k in 0..count as usize {
        discrete.panel(end(k), end(k + 1), &rule, |t, _| -0.5 * t * t);
    }
    discrete
}

/// t^(α-1) (1-t)^(β-1) on [a, b] within [0, 1]; good for polynomials of degree 2`degree`.
///
/// Panels are halved until each is shorter than its distance from an end of [0, 1] that it does not touch, and the
/// logarithm changes little on it; at an end it touches the power goes to a Gauss-Jacobi rule, a high one is cut off.
pub(crate) fn beta(alpha: f64, beta: f64, a: f64, b: f64, degree: usize) -> Discrete {
    let (p, q) = (alpha - 1.0, beta - 1.0);
    // 0 ln 0 = 0: the density 1
    let times_log = |c: f64, t: f64| if c == 0.0 { 0.0 } else { c * t.ln() };
    let log_density = |t: f64, rest: f64| times_log(p, t) + times_log(q, rest);
    let top = (alpha / (alpha + beta)).clamp(a, b);
    let mut discrete = Discrete::new(a, b, log_density(top, 1.0 - top));
    let points = degree + EXTRA;
    let inner = gauss_legendre(points);
    let mut open = vec![(a, b)];
    while let Some((l, r)) = open.pop() {
        let outside = !(l..=r).contains(&top);
        let low = |t: f64| log_density(t, 1.0 - t) < discrete.log_scale + NEGLIGIBLE;
        if outside && low(l) && low(r) {
            continue;
        }
        let calm = |power: f64, near: f64, far: f64| match near {
            0.0 => power <= POWER,
            _ => far <= 2.0 * near && power.abs() * (far / near).ln() <= CHANGE,
        };
        let whole = l == 0.0 && r == 1.0;
        if whole || !(calm(p, l, r) && calm(q, 1.0 - r, 1.0 - l)) {
            let middle = 0.5 * (l + r);
            if l < middle && middle < r {
                open.push((middle, r));
                open.push((l, middle));
                continue;
            }
        }
        // the power of the touched end is in the rule: w(x) = (1 ± x)^power, t = width (1 + x)/2
        let width = r - l;
        if l == 0.0 {
            let shift = times_log(p, 0.5 * width);
            let rule = exact_mass(gauss_jacobi(points, 0.0, p), p);
            discrete.panel(l, r, &rule, |_, share| shift + times_log(q, (1.0 - r) + width * (1.0 - share)));
        } else if r == 1.0 {
            let shift = times_log(q, 0.5 * width);
            let rule = exact_mass(gauss_jacobi(points, q, 0.0), q);
            discrete.panel(l, r, &rule, |t, _| shift + times_log(p, t));
        } else {
            discrete.panel(l, r, &inner, |t, share| log_density(t, (1.0 - r) + width * (1.0 - share)));
        }
    }
    discrete
}

/// A rule for (1 ± x)^power with the mass 2^(power+1)/(power+1), which that of gamma functions misses by some 1e-13.
fn exact_mass(mut rule: Rule, power: f64) -> Rule {
    let factor = (power + 1.0).exp2() / ((power + 1.0) * rule.weights.iter().sum::<f64>());
    rule.weights.iter_mut().for_each(|w| *w *= factor);
    rule
}
