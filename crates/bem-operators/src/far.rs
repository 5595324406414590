//! Moments of well separated pairs, many at a time.
//!
//! Nearly all pairs of a mesh are far: a few Gauss points on the outer element, and Q_n by the continued fraction
//! Q_k/Q_(k-1) = k/((2k+1)z - (k+1) Q_(k+1)/Q_k) of few steps, from which Q_0 = 1/(z - Q_1/Q_0) follows without a
//! logarithm. Pairs with the same degrees, rule and number of steps are computed side by side, [`LANES`] at a time; a
//! pair's result does not depend on its neighbours in the batch.

use std::sync::OnceLock;

use crate::moments::{LANES, Segment};
use crate::near::{MAX_ORDER, gauss_points, panel_rule};
use steklov_quadrature::legendre_p;

/// One number of each of the pairs that are computed side by side.
pub(crate) type Lane = [f64; LANES];

/// Computes a batch and hands each lane's place to `store`.
pub(crate) fn flush<T: Copy>(
    arch: pulp::Arch,
    batch: &mut Batch,
    places: &[T; LANES],
    sums: &mut Vec<Lane>,
    mut store: impl FnMut(T, &Batch, usize, &[Lane]),
) {
    if batch.filled > 0 {
        arch.dispatch(|| batch.compute(sums));
        for (lane, &place) in places[..batch.filled].iter().enumerate() {
            store(place, batch, lane, sums);
        }
        batch.filled = 0;
    }
}

/// Numbers of Gauss points that are used: the needed one is rounded up to the next of these.
const RULES: [usize; 18] = [3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 16, 18, 20, 24, 28, 34, 42];
/// Extra steps of the continued fraction that are used.
const STEPS: [usize; 10] = [2, 3, 4, 5, 6, 8, 10, 14, 20, 32];

/// Batch key: index into [`RULES`] and [`STEPS`].
pub(crate) type Kind = (u8, u8);
/// Number of different kinds.
pub(crate) const KINDS: usize = RULES.len() * STEPS.len();

pub(crate) fn kind_index(kind: Kind) -> usize {
    kind.0 as usize * STEPS.len() + kind.1 as usize
}

/// Chooses the cheapest rule that reaches roundoff, or none: then the pair is near.
#[derive(Debug)]
pub(crate) struct Classifier {
    /// Smallest ϱ + 1/ϱ of the outer quadrature for each rule.
    rule_sum: [f64; RULES.len()],
    /// Smallest ϱ + 1/ϱ of z for each number of steps.
    step_sum: [f64; STEPS.len()],
}

impl Classifier {
    pub(crate) fn new(rows: usize) -> Self {
        let sum = |log_rho: f64| 2.0 * log_rho.cosh();
        let base = gauss_points(rows, f64::INFINITY);
        let rule_sum =
            RULES.map(|n| if n > base { sum((19.0 / (n - base) as f64).max(2.2f64.ln())) } else { f64::INFINITY });
        let step_sum = STEPS.map(|k| sum(19.0 / k as f64));
        Self { rule_sum, step_sum }
    }

    /// ϱ + 1/ϱ of a point is its distance to both ends over half the length; for z(s) the mean of its values at both
    /// ends less the Lipschitz bound is a lower bound along the outer element.
    pub(crate) fn kind(&self, outer: Segment, inner: Segment) -> Option<Kind> {
        let r00 = (outer.start - inner.start).norm_sqr().sqrt();
        let r01 = (outer.start - inner.end).norm_sqr().sqrt();
        let r10 = (outer.end - inner.start).norm_sqr().sqrt();
        let r11 = (outer.end - inner.end).norm_sqr().sqrt();
        let (da, db) = (outer.half().norm_sqr().sqrt(), inner.half().norm_sqr().sqrt());
        let outer_sum = (r00 + r10).min(r01 + r11) / da;
        let inner_sum = ((r00 + r01 + r10 + r11) * 0.5 - 2.0 * da) / db;
        let rule = self.rule_sum.iter().position(|&s| outer_sum >= s)?;
        let step = self.step_sum.iter().position(|&s| inner_sum >= s)?;
        Some((rule as u8, step as u8))
    }
}

/// Weights times Legendre polynomials at the points of a rule: `points[k]`, `weighted[k*MAX + m]` = w_k P_m(s_k).
struct OuterRule {
    points: Vec<f64>,
    weighted: Vec<f64>,
}

fn outer_rule(index: usize) -> &'static OuterRule {
    static TABLE: [OnceLock<OuterRule>; RULES.len()] = [const { OnceLock::new() }; RULES.len()];
    TABLE[index].get_or_init(|| {
        let rule = panel_rule(RULES[index]);
        let mut weighted = vec![0.0; rule.len() * MAX_ORDER];
        for (row, (&s, &w)) in weighted.chunks_exact_mut(MAX_ORDER).zip(rule.points.iter().zip(&rule.weights)) {
            legendre_p(s, row);
            row.iter_mut().for_each(|v| *v *= w);
        }
        OuterRule { points: rule.points.clone(), weighted }
    })
}

/// Up to [`LANES`] pairs of one kind, rows × cols degrees; result of lane i into `out[i]` as `moments::storage` says.
pub(crate) struct Batch {
    pub(crate) kind: Kind,
    pub(crate) rows: usize,
    pub(crate) cols: usize,
    middle_re: Lane,
    middle_im: Lane,
    slope_re: Lane,
    slope_im: Lane,
    filled: usize,
}

impl Batch {
    pub(crate) fn new(kind: Kind, rows: usize, cols: usize) -> Self {
        let one = [1.0; LANES];
        Self { kind, rows, cols, middle_re: [9.0; LANES], middle_im: one, slope_re: one, slope_im: one, filled: 0 }
    }

    /// Adds a pair; true when the batch is full.
    pub(crate) fn push(&mut self, outer: Segment, inner: Segment) -> bool {
        let db = inner.half();
        let inverse = db.conj() / db.norm_sqr();
        let i = self.filled;
        let middle = ((outer.start - inner.start) + (outer.end - inner.end)) * 0.5 * inverse;
        let slope = outer.half() * inverse;
        (self.middle_re[i], self.middle_im[i]) = (middle.re, middle.im);
        (self.slope_re[i], self.slope_im[i]) = (slope.re, slope.im);
        self.filled += 1;
        self.filled == LANES
    }

    pub(crate) fn len(&self) -> usize {
        self.filled
    }

    /// Computes all lanes; `sums` holds re and im of q(m,n) and then l0(m), one [`Lane`] each.
    #[inline(always)]
    pub(crate) fn compute(&self, sums: &mut Vec<Lane>) {
        let (rows, cols) = (self.rows, self.cols);
        let rule = outer_rule(self.kind.0 as usize);
        let steps = STEPS[self.kind.1 as usize];
        sums.clear();
        sums.resize(rows * (2 * cols + 1), [0.0; LANES]);
        let (q_sums, l_sums) = sums.split_at_mut(2 * rows * cols);
        let mut ratio_re = [[0.0; LANES]; MAX_ORDER];
        let mut ratio_im = [[0.0; LANES]; MAX_ORDER];
        // Q_1 is needed for the logarithm even when cols = 1
        let top = (cols - 1).max(1);
        for (k, &s) in rule.points.iter().enumerate() {
            let mut z_re = [0.0; LANES];
            let mut z_im = [0.0; LANES];
            for i in 0..LANES {
                z_re[i] = self.middle_re[i] + s * self.slope_re[i];
                z_im[i] = self.middle_im[i] + s * self.slope_im[i];
            }
            let mut r_re = [0.0; LANES];
            let mut r_im = [0.0; LANES];
            for j in (1..=top + steps).rev() {
                let (a, b, c) = ((2 * j + 1) as f64, (j + 1) as f64, j as f64);
                for i in 0..LANES {
                    let d_re = a * z_re[i] - b * r_re[i];
                    let d_im = a * z_im[i] - b * r_im[i];
                    let f = c / (d_re * d_re + d_im * d_im);
                    r_re[i] = d_re * f;
                    r_im[i] = -d_im * f;
                }
                if j <= top {
                    ratio_re[j] = r_re;
                    ratio_im[j] = r_im;
                }
            }
            // Q_0 = 1/(z - Q_1/Q_0)
            let mut q_re = [0.0; LANES];
            let mut q_im = [0.0; LANES];
            for i in 0..LANES {
                let d_re = z_re[i] - r_re[i];
                let d_im = z_im[i] - r_im[i];
                let f = 1.0 / (d_re * d_re + d_im * d_im);
                q_re[i] = d_re * f;
                q_im[i] = -d_im * f;
            }
            let weighted = &rule.weighted[k * MAX_ORDER..][..rows];
            let mut log = [0.0; LANES];
            for i in 0..LANES {
                // |z² - 1|²
                let (x, y) = (z_re[i], z_im[i]);
                let (a, b) = (x * x - y * y - 1.0, 2.0 * x * y);
                log[i] = a * a + b * b;
            }
            for i in 0..LANES {
                log[i] = 0.5 * log[i].ln();
            }
            for n in 0..=top {
                if n > 0 {
                    for i in 0..LANES {
                        let (a, b) = (q_re[i], q_im[i]);
                        q_re[i] = a * ratio_re[n][i] - b * ratio_im[n][i];
                        q_im[i] = a * ratio_im[n][i] + b * ratio_re[n][i];
                    }
                }
                if n == 1 {
                    for i in 0..LANES {
                        log[i] += 2.0 * q_re[i];
                    }
                }
                if n < cols {
                    for (m, &wp) in weighted.iter().enumerate() {
                        let [re, im] = &mut q_sums[2 * (m * cols + n)..][..2] else { unreachable!() };
                        for i in 0..LANES {
                            re[i] += wp * q_re[i];
                            im[i] += wp * q_im[i];
                        }
                    }
                }
            }
            for (m, &wp) in weighted.iter().enumerate() {
                for i in 0..LANES {
                    l_sums[m][i] += wp * log[i];
                }
            }
        }
    }

    /// Copies lane i of `sums` into a buffer laid out as `moments::storage` says.
    pub(crate) fn extract(&self, sums: &[Lane], lane: usize, out: &mut [f64]) {
        let size = 2 * self.rows * self.cols;
        for (m, sum) in sums[size..].iter().enumerate() {
            out[m] = sum[lane];
        }
        for (k, sum) in sums[..size].iter().enumerate() {
            out[self.rows + k] = sum[lane];
        }
    }
}
