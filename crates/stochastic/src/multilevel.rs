//! How many outcomes each level of multilevel Monte Carlo needs.

/// Numbers of outcomes N_l of the levels for which the mean Σ_l mean(Y_l) has the standard error ε at the least cost Σ N_l C_l,
/// not rounded: N_l = ε⁻² √(V_l/C_l) Σ_k √(V_k C_k), so that Σ V_l/N_l = ε².
///
/// Y_l is the difference of a quantity between level l and the coarser one, of the variance V_l; an outcome of it costs C_l.
///
/// Source: Giles, Operations Research 56 (2008), equation (12).
pub fn outcomes_of_levels(variances: &[f64], costs: &[f64], error: f64) -> Vec<f64> {
    let sum: f64 = variances.iter().zip(costs).map(|(v, c)| (v * c).sqrt()).sum();
    variances.iter().zip(costs).map(|(v, c)| (v / c).sqrt() * sum / (error * error)).collect()
}

/// The cost of [`outcomes_of_levels`] times ε²: (Σ √(V_l C_l))². That of plain sampling is V C of one level.
pub fn cost_of_levels(variances: &[f64], costs: &[f64]) -> f64 {
    variances.iter().zip(costs).map(|(v, c)| (v * c).sqrt()).sum::<f64>().powi(2)
}

#[cfg(test)]
mod tests {
    use steklov_quadrature::unit_uniform;

    use super::*;

    /// The variance is met, the cost is the told one, and no other numbers of the same variance cost less.
    #[test]
    fn numbers_of_outcomes_are_the_cheapest() {
        for trial in 0..200 {
            let uniform = |k: u64| unit_uniform(11, 40 * trial + k);
            let levels = 1 + trial as usize % 5;
            let variances: Vec<f64> = (0..levels).map(|l| 10.0f64.powf(-4.0 * uniform(l as u64))).collect();
            let costs: Vec<f64> = (0..levels).map(|l| 10.0f64.powf(3.0 * uniform(10 + l as u64))).collect();
            let error = 10.0f64.powf(-3.0 * uniform(20));
            let counts = outcomes_of_levels(&variances, &costs, error);
            let variance = |n: &[f64]| variances.iter().zip(n).map(|(v, n)| v / n).sum::<f64>();
            let cost = |n: &[f64]| costs.iter().zip(n).map(|(c, n)| c * n).sum::<f64>();
            assert!((variance(&counts) / (error * error) - 1.0).abs() < 1e-12);
            assert!((cost(&counts) * error * error / cost_of_levels(&variances, &costs) - 1.0).abs() < 1e-12);
            let other: Vec<f64> = counts.iter().enumerate().map(|(l, n)| n * (0.5 + uniform(30 + l as u64))).collect();
            let scale = variance(&other) / (error * error);
            let other: Vec<f64> = other.iter().map(|n| n * scale).collect();
            assert!(cost(&other) >= cost(&counts) * (1.0 - 1e-12), "{trial}");
        }
    }
}
