//! Orthogonal polynomials of a density on an interval, and their Gauss and Lobatto rules.

use crate::variable::EMPTY;
use crate::{Distribution, StochasticError, Variable, discrete};
use faer::Mat;
use steklov_algebra::symmetric_eigenvalues;
use steklov_quadrature::Rule;

/// Most coefficients of a recurrence.
const MOST: usize = 256;

/// Monic polynomials in t = (germ - shift)/scale, orthogonal for the density of a germ conditioned on an interval:
///
/// π_{k+1}(t) = (t - α_k) π_k(t) - β_k π_{k-1}(t), π_0 = 1, π_{-1} = 0.
///
/// The conditioned density has the mass 1, so that β_0 = 1 and the weights of all rules sum to 1; the probability of the
/// interval itself is in `probability`.
#[derive(Debug, Clone, PartialEq)]
pub struct Recurrence {
    /// Ends of the interval (germs; infinite where it is not bounded).
    pub interval: [f64; 2],
    /// Probability of the interval.
    pub probability: f64,
    /// Germ of t = 0.
    pub shift: f64,
    /// Germs to a unit of t, > 0.
    pub scale: f64,
    /// α_0, α_1, ..
    pub alpha: Vec<f64>,
    /// β_0 = 1, β_1, ..; β_k > 0.
    pub beta: Vec<f64>,
}

impl Recurrence {
    /// α and β to the index n-1 on an interval of germs (moved to the support): enough for [`Recurrence::gauss`] of n,
    /// [`Recurrence::lobatto`] of n+1 points and the polynomials to degree n-1.
    ///
    /// Closed forms for uniform variables (Legendre), whole normal (Hermite) and whole beta ones (Jacobi). Otherwise
    /// Stieltjes' procedure for a composite Gauss rule that is exact for the products of polynomials on each of its
    /// panels; t is then centred and scaled by mean and deviation. Errors are some 1e-14 then. Cost: n times the points of
    /// that rule, at most some ten thousand.
    ///
    /// # Errors
    /// [`StochasticError::Number`] unless 1 ≤ n ≤ 256; [`StochasticError::NoProbability`] for an interval with less
    /// probability than 1e-300, turned round or not a number.
    ///
    /// Source: Gautschi, Orthogonal Polynomials: Computation and Approximation (2004), table 1.1 and section 2.2.
    pub fn new(variable: &Variable, interval: [f64; 2], n: usize) -> Result<Self, StochasticError> {
        if !(1..=MOST).contains(&n) {
            return Err(StochasticError::Number {
                what: "the number of coefficients of a recurrence".into(),
                value: n as f64,
                wanted: "between 1 and 256",
            });
        }
        let interval = variable.clipped(interval);
        let probability = variable.probability(interval);
        if probability.is_nan() || probability < EMPTY {
            return Err(StochasticError::NoProbability { interval, probability });
        }
        let [a, b] = interval;
        let [low, high] = variable.germ_support();
        let made = |shift, scale, alpha, beta| Self { interval, probability, shift, scale, alpha, beta };
        let indices = || (0..n).map(|k| k as f64);
        let (middle, half) = (a + 0.5 * (b - a), 0.5 * (b - a));
        let cut = match (variable.distribution(), variable.standard(interval)) {
            (Distribution::Beta { alpha, beta }, _) if interval == [low, high] => {
                let (diagonal, squares) = jacobi(n, beta - 1.0, alpha - 1.0);
                return Ok(made(middle, half, diagonal, squares));
            }
            (Distribution::Beta { alpha, beta }, _) => {
                let part = |x: f64| if x == high { 1.0 } else { (x - low) / (high - low) };
                discrete::beta(alpha, beta, part(a), part(b), n)
            }
            (_, Some([a, b])) if a.is_finite() || b.is_finite() => discrete::normal(a, b, n),
            (_, Some(_)) => {
                let (mean, deviation) = variable.germ_normal().expect("an interval in its units has a normal germ");
                let beta = indices().map(|k| k.max(1.0)).collect();
                return Ok(made(mean, deviation, vec![0.0; n], beta));
            }
            (_, None) => {
                let beta = indices().map(|k| if k == 0.0 { 1.0 } else { k * k / (4.0 * k * k - 1.0) }).collect();
                return Ok(made(middle, half, vec![0.0; n], beta));
            }
        };
        let (unit, from) = variable.germ_normal().map_or((high - low, low), |(mean, deviation)| (deviation, mean));
        let mass = cut.mass();
        let weights: Vec<f64> = cut.weights.iter().map(|w| w / mass).collect();
        let sum = |f: &dyn Fn(f64) -> f64| -> f64 { cut.points.iter().zip(&weights).map(|(&x, w)| w * f(x)).sum() };
        let mean = sum(&|x| x);
        let deviation = sum(&|x| (x - mean) * (x - mean)).sqrt();
        let points: Vec<f64> = cut.points.iter().map(|x| (x - mean) / deviation).collect();
        let (alpha, beta) = stieltjes(&points, &weights, n);
        let shift = (from + unit * (cut.middle + cut.half * mean)).clamp(a, b);
        Ok(made(shift, unit * cut.half * deviation, alpha, beta))
    }

    /// Checks that it can be the recurrence of a density on its interval.
    ///
    /// # Errors
    /// [`StochasticError::Inconsistent`] unless there are from 1 to 256 pairs α_k, β_k, all finite, β_0 = 1 and β_k > 0, a
    /// probability above 0 and not above 1, a scale above 0, and an interval with the shift in it.
    pub fn check(&self) -> Result<(), StochasticError> {
        let wrong = |what: String| Err(StochasticError::Inconsistent { what: format!("{what} of a recurrence") });
        let [low, high] = self.interval;
        let (n, probability, scale) = (self.alpha.len(), self.probability, self.scale);
        if !(1..=MOST).contains(&n) || self.beta.len() != n {
            return wrong(format!("{n} coefficients alpha and {} coefficients beta", self.beta.len()));
        }
        if let Some(alpha) = self.alpha.iter().find(|a| !a.is_finite()) {
            return wrong(format!("the coefficient alpha {alpha}"));
        }
        if self.beta[0] != 1.0 || !self.beta.iter().all(|b| *b > 0.0 && b.is_finite()) {
            return wrong(format!("the coefficients beta {:?}", self.beta));
        }
        if !(low < high && low <= self.shift && self.shift <= high && self.shift.is_finite()) {
            return wrong(format!("the interval [{low}, {high}] around the shift {}", self.shift));
        }
        // sums of roundings may leave more than 1
        if !(EMPTY..=1.0 + 1e-9).contains(&probability) {
            return wrong(format!("the probability {probability}"));
        }
        if scale > 0.0 && scale.is_finite() { Ok(()) } else { wrong(format!("the scale {scale}")) }
    }

    /// Gauss rule of n points: ∫ f dρ to degree 2n-1, ρ the conditioned density; points are germs inside the interval,
    /// weights are positive and sum to 1. Symmetric densities have exactly symmetric rules.
    ///
    /// # Errors
    /// [`StochasticError::Number`] unless 1 ≤ n ≤ `alpha.len()`; [`StochasticError::Decomposition`].
    ///
    /// Source: Golub and Welsch, Math. Comp. 23 (1969).
    pub fn gauss(&self, n: usize) -> Result<Rule, StochasticError> {
        if n < 1 || n > self.alpha.len() {
            return Err(StochasticError::Number {
                what: format!("the number of Gauss points of a recurrence with {} coefficients", self.alpha.len()),
                value: n as f64,
                wanted: "from 1 to the number of coefficients",
            });
        }
        let (points, weights) = golub_welsch(&self.alpha[..n], &self.beta[..n])?;
        Ok(self.rule(points, weights, 2 * n - 1))
    }

    /// Lobatto rule of n points, both ends of the interval among them: ∫ f dρ to degree 2n-3; weights are positive and
    /// sum to 1.
    ///
    /// The last row of the Jacobi matrix is changed so that the ends are eigenvalues.
    ///
    /// # Errors
    /// [`StochasticError::Number`] if an end is infinite, or unless 2 ≤ n ≤ `alpha.len()` + 1;
    /// [`StochasticError::Decomposition`].
    ///
    /// Source: Golub, Some modified matrix eigenvalue problems, SIAM Review 15 (1973).
    pub fn lobatto(&self, n: usize) -> Result<Rule, StochasticError> {
        if let Some(&end) = self.interval.iter().find(|end| !end.is_finite()) {
            return Err(StochasticError::Number {
                what: "an end of the interval of a Lobatto rule".into(),
                value: end,
                wanted: "finite: use Gauss nodes, or restrict the variable",
            });
        }
        if n < 2 || n > self.alpha.len() + 1 {
            return Err(StochasticError::Number {
                what: format!("the number of Lobatto points of a recurrence with {} coefficients", self.alpha.len()),
                value: n as f64,
                wanted: "from 2 to the number of coefficients + 1",
            });
        }
        let [a, b] = self.interval.map(|x| (x - self.shift) / self.scale);
        // π_{n-1}/π_{n-2} at an end
        let ratio = |x: f64| {
            let first = x - self.alpha[0];
            (1..n - 1).fold(first, |r, k| x - self.alpha[k] - self.beta[k] / r)
        };
        let (at_a, at_b) = (ratio(a), ratio(b));
        let last = (b - a) / (1.0 / at_b - 1.0 / at_a);
        let mut alpha = self.alpha[..n - 1].to_vec();
        alpha.push(a - last / at_a);
        let mut beta = self.beta[..n - 1].to_vec();
        beta.push(last);
        let (points, weights) = golub_welsch(&alpha, &beta)?;
        let mut rule = self.rule(points, weights, 2 * n - 3);
        (rule.points[0], rule.points[n - 1]) = (self.interval[0], self.interval[1]);
        Ok(rule)
    }

    /// Orthonormal polynomials p_k = π_k/√(β_1 .. β_k) at a germ, degrees 0 to `values.len()` - 1; ∫ p_k p_l dρ = δ_kl.
    ///
    /// # Panics
    /// If `values` is longer than the recurrence.
    pub fn evaluate(&self, germ: f64, values: &mut [f64]) {
        assert!(values.len() <= self.beta.len(), "a recurrence of {} cannot give {}", self.beta.len(), values.len());
        let t = (germ - self.shift) / self.scale;
        let (mut p, mut before) = (1.0, 0.0);
        for k in 0..values.len() {
            if k > 0 {
                let next = ((t - self.alpha[k - 1]) * p - self.beta[k - 1].sqrt() * before) / self.beta[k].sqrt();
                (before, p) = (p, next);
            }
            values[k] = p;
        }
    }

    fn rule(&self, points: Vec<f64>, weights: Vec<f64>, degree: usize) -> Rule {
        let [a, b] = self.interval;
        let points = points.iter().map(|t| (self.shift + self.scale * t).clamp(a, b)).collect();
        Rule { points, weights, degree }
    }
}

/// α and β of the Jacobi polynomials, weight (1-x)^a (1+x)^b over its mass.
fn jacobi(n: usize, a: f64, b: f64) -> (Vec<f64>, Vec<f64>) {
    let s = a + b;
    let alpha = |k: usize| match k {
        0 => (b - a) / (s + 2.0),
        _ => {
            let m = 2.0 * k as f64 + s;
            (b - a) * s / (m * (m + 2.0))
        }
    };
    let beta = |k: usize| match k {
        0 => 1.0,
        // the general term is 0/0 for s = -1
        1 => 4.0 * (1.0 + a) * (1.0 + b) / ((2.0 + s) * (2.0 + s) * (3.0 + s)),
        _ => {
            let (k, m) = (k as f64, 2.0 * k as f64 + s);
            4.0 * k * (k + a) * (k + b) * (k + s) / (m * m * (m + 1.0) * (m - 1.0))
        }
    };
    ((0..n).map(alpha).collect(), (0..n).map(beta).collect())
}

/// α and β of a discrete density: α_k = ∫ t p_k², β_{k+1} = ‖(t - α_k) p_k - √β_k p_{k-1}‖², with orthonormal p_k.
fn stieltjes(points: &[f64], weights: &[f64], n: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut alpha, mut beta) = (vec![], vec![1.0]);
    let (mut p, mut before) = (vec![1.0; points.len()], vec![0.0; points.len()]);
    loop {
        let moment = |i: usize| weights[i] * points[i] * p[i] * p[i];
        let mean: f64 = (0..points.len()).map(moment).sum();
        alpha.push(mean);
        if alpha.len() == n {
            return (alpha, beta);
        }
        let root = beta[alpha.len() - 1].sqrt();
        for i in 0..points.len() {
            before[i] = (points[i] - mean) * p[i] - root * before[i];
        }
        std::mem::swap(&mut p, &mut before);
        let square: f64 = (0..points.len()).map(|i| weights[i] * p[i] * p[i]).sum();
        beta.push(square);
        let scale = 1.0 / square.sqrt();
        p.iter_mut().for_each(|x| *x *= scale);
    }
}

/// Points, ascending, and weights of the rule of a Jacobi matrix: eigenvalues refined by Newton, weights 1/Σ_{k<n} p_k².
fn golub_welsch(alpha: &[f64], beta: &[f64]) -> Result<(Vec<f64>, Vec<f64>), StochasticError> {
    let n = alpha.len();
    let matrix = Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => alpha[i],
        1 => beta[i.max(j)].sqrt(),
        _ => 0.0,
    });
    let failed = |_| StochasticError::Decomposition { size: n };
    let mut points = symmetric_eigenvalues(matrix.as_ref()).map_err(failed)?;
    let mut weights = vec![0.0; n];
    for (x, w) in points.iter_mut().zip(&mut weights) {
        for _ in 0..2 {
            let (value, derivative, _) = last_orthonormal(alpha, beta, *x);
            *x -= value / derivative;
        }
        *w = 1.0 / last_orthonormal(alpha, beta, *x).2;
    }
    if alpha.iter().all(|&a| a == 0.0) {
        for i in 0..n.div_ceil(2) {
            let j = n - 1 - i;
            let x = 0.5 * (points[j] - points[i]);
            (points[i], points[j]) = (-x, x);
            let w = 0.5 * (weights[i] + weights[j]);
            (weights[i], weights[j]) = (w, w);
        }
    }
    Ok((points, weights))
}

/// A multiple of π_n(t), that of π_n'(t), and Σ_{k<n} p_k(t)².
fn last_orthonormal(alpha: &[f64], beta: &[f64], t: f64) -> (f64, f64, f64) {
    let n = alpha.len();
    let (mut p, mut before) = (1.0, 0.0);
    let (mut dp, mut dbefore) = (0.0, 0.0);
    let mut squares = 0.0;
    for k in 0..n {
        squares += p * p;
        let back = if k == 0 { 0.0 } else { beta[k].sqrt() };
        let forward = if k + 1 < n { beta[k + 1].sqrt() } else { 1.0 };
        let next = ((t - alpha[k]) * p - back * before) / forward;
        let dnext = (p + (t - alpha[k]) * dp - back * dbefore) / forward;
        (before, p, dbefore, dp) = (p, next, dp, dnext);
    }
    (p, dp, squares)
}
