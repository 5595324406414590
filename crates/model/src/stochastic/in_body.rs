//! Mean and variance of the fields in a body on a grid, as its outcomes stream by.

use serde::{Deserialize, Serialize};
use steklov_stochastic::Moments;

/// The fields of one outcome in the body.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct InBody {
    /// Displacement of the fine nodes, component fastest.
    pub displacement: Vec<f64>,
    /// Stress xx, yy, xy in the middle of each fine cell of the body.
    pub stress: Vec<f64>,
    /// Young's modulus of each of them.
    pub young: Vec<f64>,
}

/// Their moments over all outcomes.
#[derive(Debug, Clone, Default)]
pub struct BodyMoments {
    /// Displacement of the fine nodes.
    pub displacement: Moments,
    /// Stress xx, yy, xy in the middle of each fine cell of the body.
    pub stress: Moments,
    /// Young's modulus of each of them.
    pub young: Moments,
}

/// Sums of one field less that of the first outcome: Σ w, Σ w d and Σ w d², with weights of either sign.
#[derive(Default)]
struct Sums {
    first: Vec<f64>,
    weight: f64,
    linear: Vec<f64>,
    squared: Vec<f64>,
}

impl Sums {
    fn push(&mut self, weight: f64, values: &[f64]) {
        if self.first.is_empty() {
            self.first = values.to_vec();
            (self.linear, self.squared) = (vec![0.0; values.len()], vec![0.0; values.len()]);
        }
        self.weight += weight;
        let sums = self.linear.iter_mut().zip(&mut self.squared);
        for ((linear, squared), (value, first)) in sums.zip(values.iter().zip(&self.first)) {
            let d = value - first;
            *linear += weight * d;
            *squared += weight * d * d;
        }
    }

    /// Variances that come out negative, from weights of both signs or by rounding, are 0.
    fn moments(&self) -> Moments {
        let of_linear: Vec<f64> = self.linear.iter().map(|s| s / self.weight).collect();
        let variance = self.squared.iter().zip(&of_linear).map(|(s, d)| (s / self.weight - d * d).max(0.0));
        Moments { variance: variance.collect(), mean: self.first.iter().zip(&of_linear).map(|(u, d)| u + d).collect() }
    }
}

/// Sums over the outcomes of a body on a grid; nothing for boundary elements, whose fields follow from the boundary.
#[derive(Default)]
pub(super) struct BodySums {
    displacement: Sums,
    stress: Sums,
    young: Sums,
}

impl BodySums {
    /// Takes the fields of an outcome with its weight.
    pub(super) fn push(&mut self, weight: f64, fields: &InBody) {
        self.displacement.push(weight, &fields.displacement);
        self.stress.push(weight, &fields.stress);
        self.young.push(weight, &fields.young);
    }

    /// The moments; none without fields.
    pub(super) fn moments(&self) -> Option<BodyMoments> {
        let Self { displacement, stress, young } = self;
        (!young.first.is_empty()).then(|| BodyMoments {
            displacement: displacement.moments(),
            stress: stress.moments(),
            young: young.moments(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weights of both signs as in a sparse grid: the moments of 1, x and x² at x = 3 ± δ, δ far below x.
    #[test]
    fn moments_keep_their_digits_with_negative_weights() {
        let delta = 1e-6;
        let mut sums = Sums::default();
        for (weight, x) in [(-1.0, 3.0), (1.0, 3.0 - delta), (1.0, 3.0 + delta)] {
            sums.push(weight, &[x, 7.0]);
        }
        let moments = sums.moments();
        let exact = 2.0 * delta * delta;
        assert!((moments.mean[0] - 3.0).abs() < 1e-15 && (moments.variance[0] - exact).abs() < 1e-9 * exact);
        assert_eq!((moments.mean[1], moments.variance[1]), (7.0, 0.0));
    }
}
