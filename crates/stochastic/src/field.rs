//! Random fields of finitely many germs.

use std::sync::OnceLock;

use rayon::prelude::*;

use crate::{Covariance, KarhunenLoeve, RectangleKarhunenLoeve, StochasticError, Truncation};

/// Samples a half wave where the bound is looked for.
const SAMPLES: usize = 12;
/// Most values of modes to look for the bound.
const WORK: usize = 2_000_000_000;

/// The random field g(x, ξ) = Σ_m √λ_m b_m(x) ξ_m of mean 0 and, up to truncation, variance 1, for germs ξ_m with mean 0
/// and variance 1 that are not correlated.
///
/// Points are [x, y] in the rectangle, or [s, anything] on an interval with the arc length s.
#[derive(Debug, Clone)]
pub struct Field {
    expansion: Expansion,
    /// √λ_m.
    roots: Vec<f64>,
    /// [`Field::steepness`], once it was asked for.
    steepness: OnceLock<Vec<f64>>,
}

#[derive(Debug, Clone)]
enum Expansion {
    Interval(KarhunenLoeve),
    Rectangle(RectangleKarhunenLoeve),
}

impl From<KarhunenLoeve> for Field {
    fn from(kl: KarhunenLoeve) -> Self {
        let roots = (0..kl.len()).map(|m| kl.eigenvalue(m).sqrt()).collect();
        Self { expansion: Expansion::Interval(kl), roots, steepness: OnceLock::new() }
    }
}

impl From<RectangleKarhunenLoeve> for Field {
    fn from(kl: RectangleKarhunenLoeve) -> Self {
        let roots = (0..kl.len()).map(|m| kl.eigenvalue(m).sqrt()).collect();
        Self { expansion: Expansion::Rectangle(kl), roots, steepness: OnceLock::new() }
    }
}

impl Field {
    /// Field on [0, `length`], the arc length of a side.
    ///
    /// # Errors
    /// Those of [`KarhunenLoeve::new`].
    pub fn interval(covariance: &Covariance, length: f64, truncation: Truncation) -> Result<Self, StochasticError> {
        Ok(KarhunenLoeve::new(covariance, length, truncation)?.into())
    }

    /// Field on [0, L_1] × [0, L_2].
    ///
    /// # Errors
    /// Those of [`RectangleKarhunenLoeve::new`].
    pub fn rectangle(
        covariance: &Covariance,
        sides: [f64; 2],
        truncation: Truncation,
    ) -> Result<Self, StochasticError> {
        Ok(RectangleKarhunenLoeve::new(covariance, sides, truncation)?.into())
    }

    /// Number of germs.
    pub fn len(&self) -> usize {
        self.roots.len()
    }

    /// Whether there are no germs; never true.
    pub fn is_empty(&self) -> bool {
        self.roots.is_empty()
    }

    /// Eigenvalues of the covariance, falling.
    pub fn eigenvalues(&self) -> Vec<f64> {
        self.roots.iter().map(|r| r * r).collect()
    }

    /// Lengths of the domain: one of an interval, two of a rectangle.
    pub fn sides(&self) -> Vec<f64> {
        match &self.expansion {
            Expansion::Interval(kl) => vec![kl.length()],
            Expansion::Rectangle(kl) => kl.sides().to_vec(),
        }
    }

    /// Share of the variance that is kept, the mean of [`deviation`](Self::deviation)² over the domain.
    pub fn captured(&self) -> f64 {
        match &self.expansion {
            Expansion::Interval(kl) => kl.captured(),
            Expansion::Rectangle(kl) => kl.captured(),
        }
    }

    /// √λ_m b_m(x) of all modes; x is moved into the domain.
    pub fn modes(&self, x: [f64; 2]) -> Vec<f64> {
        let mut out = vec![0.0; self.len()];
        match &self.expansion {
            Expansion::Interval(kl) => kl.modes(x[0], &mut out),
            Expansion::Rectangle(kl) => kl.modes(x, &mut out),
        }
        out.iter_mut().zip(&self.roots).for_each(|(b, root)| *b *= root);
        out
    }

    /// √λ_m b_m(x), the coefficient of ξ_m.
    ///
    /// # Panics
    /// If there is no mode m.
    pub fn mode(&self, m: usize, x: [f64; 2]) -> f64 {
        self.modes(x)[m]
    }

    /// g(x, ξ).
    ///
    /// # Panics
    /// If there is not one germ a mode.
    pub fn value(&self, x: [f64; 2], germs: &[f64]) -> f64 {
        assert_eq!(germs.len(), self.len(), "one germ a mode");
        self.modes(x).iter().zip(germs).map(|(b, xi)| b * xi).sum()
    }

    /// Standard deviation √(Σ λ_m b_m(x)²) of the truncated field at x, at most 1 up to the error of the eigenpairs.
    pub fn deviation(&self, x: [f64; 2]) -> f64 {
        self.modes(x).iter().map(|b| b * b).sum::<f64>().sqrt()
    }

    /// Largest steepness max |∂_x √λ_m b_m|, |∂_y √λ_m b_m| of each mode (1/length), from differences of samples at 12 points
    /// a half wave of the last mode, and a tenth more. *Cost*: M values of modes at 12 (M + 4) points on an interval, at the
    /// product of those of both directions on a rectangle; taken once.
    pub fn steepness(&self) -> &[f64] {
        self.steepness.get_or_init(|| {
            let (sides, waves) = match &self.expansion {
                Expansion::Interval(kl) => ([kl.length(), 0.0], [kl.len(), 0]),
                Expansion::Rectangle(kl) => (kl.sides(), kl.waves()),
            };
            let samples = waves.map(|w| if w == 0 { 1 } else { SAMPLES * (w + 4) });
            let step = [0, 1].map(|d| sides[d] / samples[d] as f64);
            let row = |i: usize| -> Vec<Vec<f64>> {
                let x = i as f64 * step[0];
                (0..=samples[1]).map(|j| self.modes([x, j as f64 * step[1]])).collect()
            };
            let mut steepest = vec![0.0f64; self.len()];
            let mut take = |a: &[f64], b: &[f64], step: f64| {
                if step > 0.0 {
                    let slopes = a.iter().zip(b).map(|(a, b)| 1.1 * (a - b).abs() / step);
                    steepest.iter_mut().zip(slopes).for_each(|(s, slope)| *s = s.max(slope));
                }
            };
            let mut before = row(0);
            for i in 1..=samples[0] {
                let here = row(i);
                before.iter().zip(&here).for_each(|(a, b)| take(a, b, step[0]));
                here.windows(2).for_each(|pair| take(&pair[0], &pair[1], step[1]));
                before = here;
            }
            steepest
        })
    }

    /// sup_x Σ √(3λ_m) |b_m(x)|: the largest |g| for germs uniform on [-√3, √3].
    ///
    /// Sampled at 12 points a half wave of the last mode on half of the domain (modes are even or odd), then refined from
    /// every sampled maximum within 2 % of the largest. Between zeros of modes the sum is nearly concave, so no maximum of
    /// that size is missed. *Cost*: M values of modes at 6 M points on an interval, at 36 times the modes in x times those
    /// in y on a rectangle; thinner samples beyond 2·10⁹ values.
    pub fn bound(&self) -> f64 {
        let (sides, waves) = match &self.expansion {
            Expansion::Interval(kl) => ([kl.length(), 0.0], [kl.len(), 0]),
            Expansion::Rectangle(kl) => (kl.sides(), kl.waves()),
        };
        let total = |x: [f64; 2]| 3f64.sqrt() * self.modes(x).iter().map(|b| b.abs()).sum::<f64>();
        let mut samples = waves.map(|w| if w == 0 { 0 } else { SAMPLES / 2 * (w + 4) });
        while (samples[0] + 1).saturating_mul(samples[1] + 1).saturating_mul(self.len()) > WORK {
            samples = samples.map(|n| n / 2);
        }
        let step: [f64; 2] =
            std::array::from_fn(|d| if samples[d] == 0 { 0.0 } else { 0.5 * sides[d] / samples[d] as f64 });
        let columns = samples[1] + 1;
        let point = |k: usize| [(k / columns) as f64 * step[0], (k % columns) as f64 * step[1]];
        let values: Vec<f64> = (0..(samples[0] + 1) * columns).into_par_iter().map(|k| total(point(k))).collect();
        let largest = values.iter().copied().fold(0.0, f64::max);
        let peak = |&k: &usize| {
            let (i, j) = (k / columns, k % columns);
            let rows = i.saturating_sub(1)..=(i + 1).min(samples[0]);
            let near = rows.flat_map(|i| (j.saturating_sub(1)..=(j + 1).min(samples[1])).map(move |j| (i, j)));
            values[k] >= 0.98 * largest && near.into_iter().all(|(i, j)| values[i * columns + j] <= values[k])
        };
        let peaks: Vec<usize> = (0..values.len()).filter(peak).collect();
        let refined: Vec<f64> = peaks.par_iter().map(|&k| climb(total, point(k), step, sides)).collect();
        refined.into_iter().fold(largest, f64::max)
    }

    /// Refuses a coefficient s with which 1 + s g(x, ξ) is not positive for all x and all germs in [-√3, √3].
    ///
    /// # Errors
    /// [`StochasticError::NotPositive`] if |s| [`bound`](Self::bound) ≥ 1, [`StochasticError::Number`] if s is not finite.
    pub fn check_positive(&self, s: f64) -> Result<(), StochasticError> {
        if !s.is_finite() {
            let what = "the coefficient of the field".to_string();
            return Err(StochasticError::Number { what, value: s, wanted: "finite" });
        }
        let largest = 1.0 / self.bound();
        if s.abs() < largest { Ok(()) } else { Err(StochasticError::NotPositive { coefficient: s, largest }) }
    }
}

/// The largest value of f near x: one coordinate after the other, by golden sections of one step to either side.
fn climb(f: impl Fn([f64; 2]) -> f64, mut x: [f64; 2], step: [f64; 2], sides: [f64; 2]) -> f64 {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let mut best = f(x);
    for _ in 0..if step[1] == 0.0 { 1 } else { 4 } {
        for d in (0..2).filter(|&d| step[d] > 0.0) {
            let at = |t: f64| f(std::array::from_fn(|e| if e == d { t } else { x[e] }));
            let (mut a, mut b) = ((x[d] - step[d]).max(0.0), (x[d] + step[d]).min(sides[d]));
            let (mut left, mut right) = (b - golden * (b - a), a + golden * (b - a));
            let (mut low, mut high) = (at(left), at(right));
            while b - a > 1e-8 * step[d] {
                if low > high {
                    (b, right, high) = (right, left, low);
                    left = b - golden * (b - a);
                    low = at(left);
                } else {
                    (a, left, low) = (left, right, high);
                    right = a + golden * (b - a);
                    high = at(right);
                }
            }
            let middle = 0.5 * (a + b);
            let value = at(middle);
            if value > best {
                (x[d], best) = (middle, value);
            }
        }
    }
    best
}

/// μ and σ of ln E for a lognormal E of given mean and coefficient of variation (standard deviation over mean):
/// σ² = ln(1 + v²), μ = ln mean - σ²/2.
///
/// With a [`Field`] g of Gaussian germs E = exp(μ + σ g) is a lognormal field, never zero or negative. Where g has the
/// standard deviation d instead of 1 by truncation, the mean is that of E times exp(σ²(d² - 1)/2).
///
/// # Errors
/// [`StochasticError::Number`] if the mean is not positive or the coefficient of variation negative.
pub fn lognormal(mean: f64, variation: f64) -> Result<(f64, f64), StochasticError> {
    crate::covariance::check_length("the mean of a lognormal field", mean)?;
    if !(variation >= 0.0 && (variation * variation).is_finite()) {
        let what = "the coefficient of variation of a lognormal field".to_string();
        return Err(StochasticError::Number { what, value: variation, wanted: "finite and not negative" });
    }
    let variance = (variation * variation).ln_1p();
    Ok((mean.ln() - 0.5 * variance, variance.sqrt()))
}
