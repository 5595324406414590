//! Random variables restricted to an interval.

use crate::{StochasticError, discrete};
use libm::erfc;
use statrs::function::beta::beta_reg;
use statrs::function::erf::erfc_inv;
use std::f64::consts::{PI, SQRT_2};
use steklov_quadrature::gauss_legendre;

/// Intervals of less probability count as empty: further out the normal distribution leaves the range of numbers.
pub(crate) const EMPTY: f64 = 1e-300;
/// Part of the interval of a beta variable that counts as next to its end.
const NEXT: f64 = 1e-3;
/// Smallest spread of a variable relative to its size; below, its values are too few different numbers.
const SPREAD: f64 = 1e-12;

/// Law of a variable before it is restricted to an interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distribution {
    /// Constant density on the interval.
    Uniform,
    /// Normal with this mean and standard deviation.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation, > 0.
        deviation: f64,
    },
    /// exp of a normal variable; `mean` and `deviation` are those of the variable itself, not of its logarithm.
    Lognormal {
        /// Mean, > 0.
        mean: f64,
        /// Standard deviation, > 0.
        deviation: f64,
    },
    /// Density proportional to (x-low)^(alpha-1) (high-x)^(beta-1) on the interval.
    Beta {
        /// Exponent at the low end, 0.01 to 1000.
        alpha: f64,
        /// Exponent at the high end, 0.01 to 1000.
        beta: f64,
    },
}

/// A distribution conditioned on [low, high]: its density is divided by the probability of the interval, mean and variance are
/// not corrected afterwards ([`Variable::mean`] gives the resulting mean).
///
/// All numerics are in the *germ*: the logarithm of a lognormal variable, which is normal; the variable itself otherwise.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    distribution: Distribution,
    low: f64,
    high: f64,
    /// Support of the germ.
    support: [f64; 2],
    /// Probability of the interval before the restriction.
    kept: f64,
    /// ln ∫ t^(α-1) (1-t)^(β-1) dt of a beta variable, else 0.
    log_mass: f64,
}

impl Variable {
    /// The distribution restricted to [low, high].
    ///
    /// The ends may be infinite for a normal, `high` for a lognormal variable, whose `low` is 0 or more.
    ///
    /// # Errors
    /// [`StochasticError::Number`] for parameters out of range or a spread below 1e-12 of the values;
    /// [`StochasticError::NoProbability`] if the interval has less probability than 1e-300.
    pub fn new(distribution: Distribution, low: f64, high: f64) -> Result<Self, StochasticError> {
        let ends = match distribution {
            Distribution::Uniform | Distribution::Beta { .. } => "finite",
            Distribution::Normal { .. } => "a number or infinite",
            Distribution::Lognormal { .. } => "0 or above",
        };
        for (what, end) in [("the low end", low), ("the high end", high)] {
            let good = match distribution {
                Distribution::Uniform | Distribution::Beta { .. } => end.is_finite(),
                Distribution::Normal { .. } => !end.is_nan(),
                Distribution::Lognormal { .. } => end >= 0.0,
            };
            require(good, what, end, ends)?;
        }
        require(high > low, "the length of the interval of a variable", high - low, "above 0")?;
        let finite = |end: f64| if end.is_finite() { end.abs() } else { 0.0 };
        let width = (high - low) / finite(low).max(finite(high)).max(f64::MIN_POSITIVE);
        require(high - low < f64::MAX || !ends.eq("finite"), "the length of the interval", high - low, "finite")?;
        require(width > SPREAD, "the length of the interval over the size of its ends", width, "above 1e-12")?;
        match distribution {
            Distribution::Uniform => {}
            Distribution::Normal { mean, deviation } => {
                require(mean.is_finite(), "the mean", mean, "finite")?;
                require(deviation > SPREAD * mean.abs() && deviation.is_finite(), "the deviation", deviation, SPREADS)?;
            }
            Distribution::Lognormal { mean, deviation } => {
                require(mean > 0.0 && mean.is_finite(), "the mean", mean, "above 0 and finite")?;
                let good = deviation > SPREAD * mean && deviation < 1e6 * mean;
                require(good, "the deviation", deviation, "between 1e-12 and 1e6 of the mean")?;
            }
            Distribution::Beta { alpha, beta } => {
                for (what, shape) in [("alpha", alpha), ("beta", beta)] {
                    require((0.01..=1000.0).contains(&shape), what, shape, "between 0.01 and 1000")?;
                }
            }
        }
        let support =
            if let Distribution::Lognormal { .. } = distribution { [low.ln(), high.ln()] } else { [low, high] };
        let mut variable = Self { distribution, low, high, support, kept: 1.0, log_mass: 0.0 };
        if let Some([a, b]) = variable.standard(support) {
            variable.kept = normal_probability(a, b);
        }
        if let Distribution::Beta { alpha, beta } = distribution {
            let all = discrete::beta(alpha, beta, 0.0, 1.0, 0);
            variable.log_mass = all.log_scale + all.mass().ln();
        }
        if variable.kept < EMPTY {
            return Err(StochasticError::NoProbability { interval: [low, high], probability: variable.kept });
        }
        Ok(variable)
    }

    /// Uniform on [low, high].
    ///
    /// # Errors
    /// As [`Variable::new`].
    pub fn uniform(low: f64, high: f64) -> Result<Self, StochasticError> {
        Self::new(Distribution::Uniform, low, high)
    }

    /// Normal, not restricted.
    ///
    /// # Errors
    /// As [`Variable::new`].
    pub fn normal(mean: f64, deviation: f64) -> Result<Self, StochasticError> {
        Self::new(Distribution::Normal { mean, deviation }, f64::NEG_INFINITY, f64::INFINITY)
    }

    /// Lognormal of this mean and standard deviation, not restricted.
    ///
    /// # Errors
    /// As [`Variable::new`].
    pub fn lognormal(mean: f64, deviation: f64) -> Result<Self, StochasticError> {
        Self::new(Distribution::Lognormal { mean, deviation }, 0.0, f64::INFINITY)
    }

    /// Beta on [low, high].
    ///
    /// # Errors
    /// As [`Variable::new`].
    pub fn beta(alpha: f64, beta: f64, low: f64, high: f64) -> Result<Self, StochasticError> {
        Self::new(Distribution::Beta { alpha, beta }, low, high)
    }

    /// Law before the restriction.
    pub fn distribution(&self) -> Distribution {
        self.distribution
    }

    /// Ends [low, high] of the values.
    pub fn interval(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Ends of the germ, infinite where the germ is not bounded.
    pub fn germ_support(&self) -> [f64; 2] {
        self.support
    }

    /// Value of the variable at a germ.
    pub fn value(&self, germ: f64) -> f64 {
        if self.is_affine() { germ } else { germ.exp() }
    }

    /// Whether the value is an affine function of the germ: all but lognormal variables.
    pub fn is_affine(&self) -> bool {
        !matches!(self.distribution, Distribution::Lognormal { .. })
    }

    /// Density of the germ, ∫ = 1 over the support, 0 outside.
    pub fn density(&self, germ: f64) -> f64 {
        let [low, high] = self.support;
        if !(low..=high).contains(&germ) {
            return 0.0;
        }
        match self.distribution {
            Distribution::Beta { alpha, beta } => {
                let power = |exponent: f64, t: f64| if exponent == 0.0 { 0.0 } else { exponent * t.ln() };
                let width = high - low;
                let t = power(alpha - 1.0, (germ - low) / width) + power(beta - 1.0, (high - germ) / width);
                (t - self.log_mass).exp() / width
            }
            _ => match self.germ_normal() {
                Some((mean, deviation)) => normal_density((germ - mean) / deviation) / (deviation * self.kept),
                None => 1.0 / (high - low),
            },
        }
    }

    /// Probability that the germ lies in [a, b]; ends outside of the support are moved to it.
    ///
    /// Relative errors of some 1e-14 in narrow intervals too, and of some t² roundings t deviations out in a normal tail.
    pub fn probability(&self, interval: [f64; 2]) -> f64 {
        let [a, b] = self.clipped(interval);
        if a.is_nan() || b.is_nan() || a >= b {
            return 0.0;
        }
        if [a, b] == self.support {
            return 1.0;
        }
        let [low, high] = self.support;
        match self.distribution {
            Distribution::Beta { alpha, beta } => {
                let part = |x: f64| if x == high { 1.0 } else { (x - low) / (high - low) };
                if part(a) >= part(b) {
                    return 0.0; // so close that only germs differ
                }
                let cell = discrete::beta(alpha, beta, part(a), part(b), 0);
                (cell.log_scale - self.log_mass).exp() * cell.mass()
            }
            _ => match self.standard([a, b]) {
                Some([a, b]) => normal_probability(a, b) / self.kept,
                None => (b - a) / (high - low),
            },
        }
    }

    /// Germ below which the germ lies with probability p; p is moved to [0, 1], whose ends give those of the support.
    ///
    /// Errors are those of a p that is right to some 1e-15 of the smaller of p and 1-p.
    pub fn quantile(&self, p: f64) -> f64 {
        let [low, high] = self.support;
        if p <= 0.0 {
            return low;
        }
        if p >= 1.0 {
            return high;
        }
        match self.distribution {
            Distribution::Beta { alpha, beta } => {
                // from the end of the smaller probability, which is known to more digits, unless the quantile is next to
                // the other end, where only the distance from that one is resolved
                let next_to_other = if p <= 0.5 { 1.0 - NEXT } else { NEXT };
                if p <= beta_reg(alpha, beta, next_to_other) {
                    low + (high - low) * self.beta_quantile(alpha, beta, p)
                } else {
                    high - (high - low) * self.beta_quantile(beta, alpha, 1.0 - p)
                }
            }
            _ => match (self.germ_normal(), self.standard(self.support)) {
                (Some((mean, deviation)), Some([a, b])) => {
                    (mean + deviation * normal_quantile(a, b, self.kept, p)).clamp(low, high)
                }
                _ if p <= 0.5 => low + (high - low) * p,
                _ => high - (high - low) * (1.0 - p),
            },
        }
    }

    /// Mean of the value.
    pub fn mean(&self) -> f64 {
        self.moments().0
    }

    /// Variance of the value.
    pub fn variance(&self) -> f64 {
        self.moments().1
    }

    /// Probability that the restriction cut off; 0 for uniform and beta variables.
    pub fn lost(&self) -> f64 {
        match self.standard(self.support) {
            Some([a, b]) => 0.5 * (erfc(-a / SQRT_2) + erfc(b / SQRT_2)),
            None => 0.0,
        }
    }

    fn moments(&self) -> (f64, f64) {
        let width = self.high - self.low;
        match self.distribution {
            Distribution::Uniform => (0.5 * (self.low + self.high), width * width / 12.0),
            Distribution::Beta { alpha, beta } => {
                let s = alpha + beta;
                (self.low + width * (alpha / s), width * width * (alpha * beta / (s * s * (s + 1.0))))
            }
            Distribution::Normal { mean, deviation } | Distribution::Lognormal { mean, deviation } => {
                match (self.germ_normal(), self.standard(self.support)) {
                    (Some((m, s)), Some([a, b])) if a.is_finite() || b.is_finite() => {
                        // values relative to that of the mean germ, so that narrow intervals keep their digits
                        let cut = discrete::normal(a, b, 0);
                        let centre = cut.moments(|offset| offset).0;
                        let from_centre = |offset: f64| s * (offset - centre);
                        let at_centre = m + s * (cut.middle + centre);
                        if self.is_affine() {
                            (at_centre, cut.moments(from_centre).1)
                        } else {
                            let (relative, variance) = cut.moments(|offset| from_centre(offset).exp_m1());
                            let scale = at_centre.exp();
                            (scale + scale * relative, scale * scale * variance)
                        }
                    }
                    _ => (mean, deviation * deviation),
                }
            }
        }
    }

    /// Mean and standard deviation of a normal germ.
    pub(crate) fn germ_normal(&self) -> Option<(f64, f64)> {
        match self.distribution {
            Distribution::Normal { mean, deviation } => Some((mean, deviation)),
            Distribution::Lognormal { mean, deviation } => {
                let ratio = deviation / mean;
                let variance = (ratio * ratio).ln_1p();
                Some((mean.ln() - 0.5 * variance, variance.sqrt()))
            }
            _ => None,
        }
    }

    /// Ends of an interval of a normal germ, from its mean, over its deviation.
    pub(crate) fn standard(&self, interval: [f64; 2]) -> Option<[f64; 2]> {
        self.germ_normal().map(|(mean, deviation)| interval.map(|x| (x - mean) / deviation))
    }

    /// An interval moved to the support.
    pub(crate) fn clipped(&self, interval: [f64; 2]) -> [f64; 2] {
        let [low, high] = self.support;
        if interval.iter().any(|x| x.is_nan()) { interval } else { interval.map(|x| x.clamp(low, high)) }
    }

    /// t in [0, 1] with ∫_0^t = p ∫_0^1 of t^(α-1) (1-t)^(β-1): Newton on ln p as a function of ln t,
    /// which is a straight line in the tail, within a bracket; the last step with the exact probability.
    fn beta_quantile(&self, alpha: f64, beta: f64, p: f64) -> f64 {
        let (mut below, mut above) = (f64::MIN_POSITIVE.ln(), 0.0);
        let step = |y: f64, probability: f64| {
            let log_density = alpha * y + (beta - 1.0) * (-y.exp()).ln_1p() - self.log_mass;
            y - (probability / p).ln() * probability / log_density.exp()
        };
        let mut y = (alpha / (alpha + beta)).ln();
        for _ in 0..100 {
            let probability = beta_reg(alpha, beta, y.exp());
            if probability < p {
                below = y;
            } else {
                above = y;
            }
            let newton = step(y, probability);
            let next = if newton > below && newton < above { newton } else { 0.5 * (below + above) };
            let change = (next - y).abs();
            y = next;
            if change < 1e-10 {
                break;
            }
        }
        let cell = discrete::beta(alpha, beta, 0.0, y.exp(), 0);
        let newton = step(y, (cell.log_scale - self.log_mass).exp() * cell.mass());
        if newton.is_finite() { newton.min(0.0).exp() } else { y.exp() }
    }
}

const SPREADS: &str = "finite and above 1e-12 of the mean";

fn require(good: bool, what: &str, value: f64, wanted: &'static str) -> Result<(), StochasticError> {
    if good { Ok(()) } else { Err(StochasticError::Number { what: format!("{what} of a variable"), value, wanted }) }
}

fn normal_density(t: f64) -> f64 {
    (-0.5 * t * t).exp() / (2.0 * PI).sqrt()
}

/// Φ(b) - Φ(a).
fn normal_probability(a: f64, b: f64) -> f64 {
    if a > 0.0 {
        return normal_probability(-b, -a);
    }
    if (b - a) * a.abs().max(1.0) < 1.0 {
        // the difference would cancel
        return gauss_legendre(20).mapped(a, b).integrate(normal_density);
    }
    if b <= 0.0 {
        0.5 * (erfc(-b / SQRT_2) - erfc(-a / SQRT_2))
    } else {
        1.0 - 0.5 * (erfc(-a / SQRT_2) + erfc(b / SQRT_2))
    }
}

/// t with Φ(t) - Φ(a) = p (Φ(b) - Φ(a)): the inverse from the nearer tail, then Newton.
fn normal_quantile(a: f64, b: f64, kept: f64, p: f64) -> f64 {
    let below = 0.5 * erfc(-a / SQRT_2) + p * kept;
    let above = 0.5 * erfc(b / SQRT_2) + (1.0 - p) * kept;
    let start = if below < above { -erfc_inv(2.0 * below) } else { erfc_inv(2.0 * above) };
    let mut t = (SQRT_2 * start).clamp(a, b);
    for _ in 0..2 {
        let excess =
            if p <= 0.5 { normal_probability(a, t) - p * kept } else { (1.0 - p) * kept - normal_probability(t, b) };
        t = (t - excess / normal_density(t)).clamp(a, b);
    }
    t
}
