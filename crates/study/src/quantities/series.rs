//! A quantity over the steps of a run: its error bar over its true error.

use std::collections::BTreeMap;

use steklov_model::doubt::Doubt;
use steklov_model::quantities::Quantity;
use steklov_model::summary::Summary;

use crate::median;

/// Errors below this many uncertainties of the reference are not judged.
const OF_REFERENCE: f64 = 20.0;
/// Nor are those below this part of the value.
const RELATIVE: f64 = 1e-9;
/// An error that is smaller than this part of the geometric mean of its neighbours crosses zero by accident.
const CROSSES: f64 = 0.3;

/// A quantity at a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// The step, from 0.
    pub step: usize,
    /// Displacement unknowns.
    pub dofs: usize,
    /// Its value.
    pub value: f64,
    /// Its uncertainty.
    pub uncertainty: f64,
    /// Why that is not to be trusted.
    pub doubts: Vec<Doubt>,
    /// How far the value is from that of the reference.
    pub error: f64,
    /// Uncertainty over error: NaN where the reference does not tell the error.
    pub effectivity: f64,
    /// Uncertainty over the error smoothed over its zeros: the geometric mean of those of both neighbours where it is below 0.3 of that.
    pub smoothed: f64,
}

/// A quantity over all steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its path in the JSON object.
    pub path: String,
    /// The steps at which it has an error bar.
    pub points: Vec<Judged>,
}

impl Series {
    /// What kind of quantity it is: the first part of the path, of points the second too.
    pub fn kind(&self) -> String {
        let words: Vec<&str> = self.path.split('.').collect();
        match words[..] {
            ["probe", _, kind, ..] => format!("probe {kind}"),
            [first, ..] => first.to_owned(),
            [] => String::new(),
        }
    }
}

/// The quantities of the steps that the reference has too.
pub(super) fn all(steps: &[Summary], reference: &Summary) -> Vec<Series> {
    let mut all: BTreeMap<&str, Vec<Judged>> = BTreeMap::new();
    for (step, summary) in steps.iter().enumerate() {
        for (path, quantity) in &summary.quantities {
            if let Some(truth) = reference.quantities.get(path) {
                all.entry(path).or_default().push(judged((step, summary.dofs), quantity, truth));
            }
        }
    }
    let smoothed = |(path, mut points): (&str, Vec<Judged>)| {
        smooth(&mut points);
        Series { path: path.to_owned(), points }
    };
    all.into_iter().map(smoothed).collect()
}

fn judged((step, dofs): (usize, usize), quantity: &Quantity, truth: &Quantity) -> Judged {
    let &Quantity { value, uncertainty, .. } = quantity;
    let error = (value - truth.value).abs();
    let is_known = error > (OF_REFERENCE * truth.uncertainty).max(RELATIVE * truth.value.abs());
    let effectivity = if is_known { uncertainty / error } else { f64::NAN };
    let doubts = quantity.doubts.iter().filter_map(|word| Doubt::of_word(word)).collect();
    Judged { step, dofs, value, uncertainty, doubts, error, effectivity, smoothed: effectivity }
}

fn smooth(points: &mut [Judged]) {
    let errors: Vec<f64> = points.iter().map(|point| point.error).collect();
    for k in 1..points.len().saturating_sub(1) {
        let mean = (errors[k - 1] * errors[k + 1]).sqrt();
        if errors[k] < CROSSES * mean && points[k].effectivity.is_finite() {
            points[k].smoothed = points[k].uncertainty / mean;
        }
    }
}

/// How uncertainties compare with errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shares {
    /// Quantities times steps whose errors are known.
    pub count: usize,
    /// Median of uncertainty over error.
    pub median: f64,
    /// The smallest one.
    pub least: f64,
    /// Parts of which it is at least 0.5, 0.3 and 0.1.
    pub above: [f64; 3],
    /// Parts of which it is at most 4 and 10, errors smoothed over their zeros.
    pub below: [f64; 2],
}

impl Shares {
    /// Of these.
    pub fn new<'p>(points: impl Iterator<Item = &'p Judged>) -> Self {
        let known: Vec<[f64; 2]> =
            points.map(|point| [point.effectivity, point.smoothed]).filter(|[raw, _]| raw.is_finite()).collect();
        let part = |is: &dyn Fn(&[f64; 2]) -> bool| {
            known.iter().filter(|ratios| is(ratios)).count() as f64 / known.len() as f64
        };
        let mut raw: Vec<f64> = known.iter().map(|[raw, _]| *raw).collect();
        Self {
            count: known.len(),
            median: median(&mut raw),
            least: raw.first().copied().unwrap_or(f64::NAN),
            above: [0.5, 0.3, 0.1].map(|limit| part(&|[raw, _]| *raw >= limit)),
            below: [4.0, 10.0].map(|limit| part(&|[_, smoothed]| *smoothed <= limit)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quantity(value: f64, uncertainty: f64) -> Quantity {
        Quantity { value, uncertainty, doubts: Vec::new(), parts: BTreeMap::new() }
    }

    #[test]
    fn errors_that_the_reference_does_not_tell_are_not_judged() {
        let at = |value: f64, of_reference: f64| judged((0, 8), &quantity(value, 0.02), &quantity(1.0, of_reference));
        assert!((at(1.01, 1e-5).effectivity - 2.0).abs() < 1e-12);
        assert!(at(1.01, 6e-4).effectivity.is_nan(), "{:?}", at(1.01, 6e-4));
        assert!(at(1.0 + 1e-10, 1e-15).effectivity.is_nan());
    }

    #[test]
    fn an_error_that_crosses_zero_is_smoothed_upwards_alone() {
        let steps = [1.0, 1e-4, 1e-2].map(|error| judged((0, 8), &quantity(1.0 + error, error), &quantity(1.0, 1e-9)));
        let mut points = steps.to_vec();
        points[1].uncertainty = 0.05;
        points[1].effectivity = 500.0;
        smooth(&mut points);
        assert!((points[1].smoothed - 0.5).abs() < 1e-6 && points[1].effectivity == 500.0, "{:?}", points[1]);
        assert_eq!(points[0].smoothed, points[0].effectivity);
        let shares = Shares::new(points.iter());
        assert_eq!((shares.count, shares.above, shares.below), (3, [1.0; 3], [1.0; 2]));
        assert!((shares.median - 1.0).abs() < 1e-6 && (shares.least - 1.0).abs() < 1e-6, "{shares:?}");
    }
}
