//! Quantiles and densities of a scalar answer.

use crate::StochasticError;

/// Most bins of a histogram.
const BINS: usize = 1_000_000;

/// Piecewise constant density.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Ends of the bins, ascending, one more than bins.
    pub edges: Vec<f64>,
    /// Probability of each bin over its width: Σ `density` width = 1.
    pub density: Vec<f64>,
}

/// Quantiles of weighted values: the smallest of them with Σ of the weights to it at least p of the total.
///
/// *Use when*: values are samples, or the nodes of so many cells that they are as good as samples. *Fails when*: weights are
/// negative, or the nodes of a rule are few: quantiles jump from one to the next. *Cost*: a sort.
///
/// # Errors
/// [`StochasticError::Inconsistent`] and [`StochasticError::Number`] for no values, different numbers of values and
/// weights, values that are not finite, negative weights, weights without a sum or a p outside of [0, 1].
pub fn quantiles(values: &[f64], weights: &[f64], probabilities: &[f64]) -> Result<Vec<f64>, StochasticError> {
    let total = check(values, weights)?;
    let mut order: Vec<usize> = (0..values.len()).filter(|&i| weights[i] > 0.0).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let mut sum = 0.0;
    let below: Vec<f64> = order
        .iter()
        .map(|&i| {
            sum += weights[i];
            sum
        })
        .collect();
    let quantile = |&p: &f64| {
        if !(0.0..=1.0).contains(&p) {
            return Err(number("the probability of a quantile", p, "between 0 and 1"));
        }
        // sums of equal weights reach p total up to rounding
        let wanted = p * total * (1.0 - 4.0 * f64::EPSILON);
        let at = below.partition_point(|&s| s < wanted).min(order.len() - 1);
        Ok(values[order[at]])
    };
    probabilities.iter().map(quantile).collect()
}

/// Density of weighted values by a number of equal bins from the smallest to the largest.
///
/// # Errors
/// As [`quantiles`]; [`StochasticError::Number`] unless there are 1 to a million bins, and for values that are all the
/// same, which have no density.
pub fn density(values: &[f64], weights: &[f64], bins: usize) -> Result<Histogram, StochasticError> {
    let total = check(values, weights)?;
    if !(1..=BINS).contains(&bins) {
        return Err(number("the number of bins", bins as f64, "from 1 to 1e6"));
    }
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let width = (high - low) / bins as f64;
    if !(width.is_finite() && width > f64::EPSILON * low.abs().max(high.abs())) {
        return Err(number("the width of a bin", width, "above the rounding of the values and finite: use fewer bins"));
    }
    let mut density = vec![0.0; bins];
    for (x, w) in values.iter().zip(weights) {
        density[(((x - low) / width) as usize).min(bins - 1)] += w / (total * width);
    }
    let edge = |k: usize| if k == bins { high } else { low + k as f64 * width };
    Ok(Histogram { edges: (0..=bins).map(edge).collect(), density })
}

/// Sum of the weights.
fn check(values: &[f64], weights: &[f64]) -> Result<f64, StochasticError> {
    if values.is_empty() || values.len() != weights.len() {
        let what = format!("{} values with {} weights: each value needs one", values.len(), weights.len());
        return Err(StochasticError::Inconsistent { what });
    }
    if let Some(&value) = values.iter().find(|x| !x.is_finite()) {
        return Err(number("a value", value, "finite"));
    }
    if let Some(&weight) = weights.iter().find(|&&w| w.is_nan() || w < 0.0) {
        return Err(number("a weight", weight, "0 or above"));
    }
    let total: f64 = weights.iter().sum();
    if total > 0.0 && total.is_finite() { Ok(total) } else { Err(number("the sum of the weights", total, "above 0")) }
}

fn number(what: &str, value: f64, wanted: &'static str) -> StochasticError {
    StochasticError::Number { what: what.into(), value, wanted }
}
