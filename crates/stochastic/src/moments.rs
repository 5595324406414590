//! Mean and variance of answers.

use crate::StochasticError;

/// Mean and variance of each component of vector answers.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Moments {
    /// Means.
    pub mean: Vec<f64>,
    /// Variances ≥ 0.
    pub variance: Vec<f64>,
}

/// Moments of the answers at the nodes of a rule: mean m = Σ_j w_j u_j/Σ_j w_j, variance Σ_j w_j (u_j - m)²/Σ_j w_j.
///
/// Centred sums: second moment less squared mean would lose the digits of a small variance. Weights may be negative; a
/// variance that comes out negative is 0.
///
/// # Errors
/// [`StochasticError::Inconsistent`] for no answers or answers of different lengths; [`StochasticError::Number`] for
/// weights whose sum is not positive.
pub fn moments(weights: &[f64], answers: &[Vec<f64>]) -> Result<Moments, StochasticError> {
    let n = answers.first().map_or(0, Vec::len);
    if answers.is_empty() || weights.len() != answers.len() || answers.iter().any(|u| u.len() != n) {
        let what = format!("{} answers, the first of length {n}, with {} weights", answers.len(), weights.len());
        return Err(StochasticError::Inconsistent { what });
    }
    let total: f64 = weights.iter().sum();
    if total.is_nan() || total <= 0.0 {
        return Err(StochasticError::Number { what: "the sum of the weights".into(), value: total, wanted: "above 0" });
    }
    let average = |f: &dyn Fn(&[f64]) -> f64| weights.iter().zip(answers).map(|(w, u)| w * f(u)).sum::<f64>() / total;
    // relative to the first answer, so that a common part of all answers keeps its digits
    let mean: Vec<f64> = (0..n).map(|i| answers[0][i] + average(&|u| u[i] - answers[0][i])).collect();
    let variance = (0..n).map(|i| average(&|u| (u[i] - mean[i]).powi(2)).max(0.0)).collect();
    Ok(Moments { mean, variance })
}

/// Moments of answers that come one after the other, to the fourth.
///
/// Same bits for the same pushes and merges in the same order: give each thread its block of samples and merge the blocks
/// in their order.
///
/// Source: Chan, Golub and LeVeque (1983); Pébay, Sandia report SAND2008-6212.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Accumulator {
    weight: f64,
    /// Σ w².
    squared: f64,
    mean: Vec<f64>,
    /// Σ w (u - mean)^k for k = 2, 3, 4.
    central: [Vec<f64>; 3],
}

impl Accumulator {
    /// Takes an answer with its weight (1 for samples).
    ///
    /// # Errors
    /// [`StochasticError::Number`] for a negative or infinite weight, [`StochasticError::Inconsistent`] for an answer of
    /// another length than those before.
    pub fn push(&mut self, weight: f64, values: &[f64]) -> Result<(), StochasticError> {
        if !(weight >= 0.0 && weight.is_finite()) {
            let what = "the weight of an answer".into();
            return Err(StochasticError::Number { what, value: weight, wanted: "0 or above and finite" });
        }
        let none = vec![0.0; values.len()];
        let central = [none.clone(), none.clone(), none];
        self.merge(&Self { weight, squared: weight * weight, mean: values.to_vec(), central })
    }

    /// Takes the answers of another accumulator.
    ///
    /// # Errors
    /// [`StochasticError::Inconsistent`] for answers of another length.
    pub fn merge(&mut self, other: &Self) -> Result<(), StochasticError> {
        if other.weight == 0.0 {
            return Ok(());
        }
        if self.weight == 0.0 {
            *self = other.clone();
            return Ok(());
        }
        if self.mean.len() != other.mean.len() {
            let what = format!("answers of length {} after those of length {}", other.mean.len(), self.mean.len());
            return Err(StochasticError::Inconsistent { what });
        }
        let total = self.weight + other.weight;
        let (a, b) = (self.weight / total, other.weight / total);
        for i in 0..self.mean.len() {
            let [m2, m3, m4] = [0, 1, 2].map(|k| self.central[k][i]);
            let [n2, n3, n4] = [0, 1, 2].map(|k| other.central[k][i]);
            let d = other.mean[i] - self.mean[i];
            let between = total * a * b * d * d;
            self.mean[i] += d * b;
            self.central[0][i] = m2 + n2 + between;
            self.central[1][i] = m3 + n3 + between * d * (a - b) + 3.0 * d * (a * n2 - b * m2);
            self.central[2][i] = m4
                + n4
                + between * d * d * (a * a - a * b + b * b)
                + 6.0 * d * d * (a * a * n2 + b * b * m2)
                + 4.0 * d * (a * n3 - b * m3);
        }
        self.weight = total;
        self.squared += other.squared;
        Ok(())
    }

    /// Sum of the weights.
    pub fn weight(&self) -> f64 {
        self.weight
    }

    /// Mean and variance with the weights as probabilities; empty without answers.
    ///
    /// For samples the expected variance is n/(n-1) times that.
    pub fn moments(&self) -> Moments {
        let variance = self.central[0].iter().map(|m| (m / self.weight).max(0.0)).collect();
        Moments { mean: self.mean.clone(), variance }
    }

    /// Standard errors of mean and variance, estimated from independent samples, in the fields of a `Moments`.
    ///
    /// √(s²/n) and √((m_4 - (n-3)/(n-1) s⁴)/n), s² = n/(n-1) of the variance, m_4 the fourth central moment, n = (Σw)²/Σw²,
    /// the number of samples if all weigh the same. Infinite for less than two. They are meaningless for answers at the nodes
    /// of a rule.
    pub fn standard_errors(&self) -> Moments {
        let n = self.weight * self.weight / self.squared;
        // rounded weights: two samples are two
        let few = n.is_nan() || n < 2.0 - 1e-9;
        let of = |i: usize| -> [f64; 2] {
            if few {
                return [f64::INFINITY; 2];
            }
            let square = self.central[0][i] / self.weight * n / (n - 1.0);
            let fourth = self.central[2][i] / self.weight;
            let variance = (fourth - (n - 3.0) / (n - 1.0) * square * square) / n;
            [(square.max(0.0) / n).sqrt(), variance.max(0.0).sqrt()]
        };
        let all: Vec<[f64; 2]> = (0..self.mean.len()).map(of).collect();
        Moments { mean: all.iter().map(|x| x[0]).collect(), variance: all.iter().map(|x| x[1]).collect() }
    }
}
