//! Effects of single germs on a quantity.

use steklov_stochastic::CellBasis;

/// Total effects Σ_(α_d > 0) c_α²/Σ_(α ≠ 0) c_α² of the germs from the coefficients of a polynomial, the last index fastest.
///
/// Source: Sudret (2008).
pub(super) fn exact_effects(basis: &CellBasis, values: &[f64]) -> Vec<f64> {
    let squares: Vec<f64> = basis.coefficients(values).iter().map(|c| c * c).collect();
    let variance: f64 = squares[1..].iter().sum();
    let mut stride = squares.len();
    let effect = |q: usize| {
        stride /= q + 1;
        let depends = squares.iter().enumerate().filter(|(k, _)| !(k / stride).is_multiple_of(q + 1));
        depends.map(|(_, s)| s).sum::<f64>() / variance
    };
    basis.degrees().into_iter().map(effect).collect()
}

/// Jansen's formula ½ E[(f - f')²]/Var f, with the variance of the pairs.
///
/// Source: Jansen (1999).
pub(super) fn sampled_effect(pairs: &[[f64; 2]]) -> f64 {
    let mean = pairs.iter().map(|[a, b]| 0.5 * (a + b)).sum::<f64>() / pairs.len() as f64;
    let variance: f64 = pairs.iter().map(|[a, b]| 0.5 * ((a - mean).powi(2) + (b - mean).powi(2))).sum();
    let half: f64 = pairs.iter().map(|[a, b]| 0.5 * (a - b).powi(2)).sum();
    if half > 0.0 { (half / variance).min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use steklov_stochastic::{Nodes, StochasticMesh, Variable, sample};

    use super::*;

    fn variables() -> Vec<Variable> {
        vec![Variable::uniform(0.0, 2.0).unwrap(), Variable::uniform(0.0, 2.0).unwrap()]
    }

    fn of_cell(f: &dyn Fn(f64, f64) -> f64) -> Vec<f64> {
        let basis = StochasticMesh::uniform(variables(), &[1, 1], &[3, 2]).unwrap().basis(0, Nodes::Gauss).unwrap();
        exact_effects(&basis, &basis.points.iter().map(|p| f(p[0], p[1])).collect::<Vec<_>>())
    }

    #[test]
    fn effects_are_those_of_a_product_and_of_a_sum() {
        // a b of means 1 and variances 1/3: Var = (4/3)² - 1 = 7/9, of each given the other E[b²] Var a = 4/9
        for effect in of_cell(&|a, b| a * b) {
            assert!((effect - 4.0 / 7.0).abs() < 1e-14, "{effect}");
        }
        // what is added has no interaction: Var a and 9 Var b, beside a large mean
        let effects = of_cell(&|a, b| 1e3 + a + 3.0 * b);
        assert!((effects[0] - 0.1).abs() < 1e-11 && (effects[1] - 0.9).abs() < 1e-11, "{effects:?}");
        let effects = of_cell(&|a, _| a * a * a);
        assert!((effects[0] - 1.0).abs() < 1e-14 && effects[1] < 1e-28, "{effects:?}");
    }

    #[test]
    fn samples_give_them_but_for_their_noise() {
        let pairs = |f: &dyn Fn(f64, f64) -> f64| -> Vec<[f64; 2]> {
            let draw = |i: u64| sample(&variables(), 1, i);
            (0..20_000).map(|i| [f(draw(i)[0], draw(i)[1]), f(draw(20_000 + i)[0], draw(i)[1])]).collect()
        };
        assert!((sampled_effect(&pairs(&|a, b| a * b)) - 4.0 / 7.0).abs() < 0.02);
        assert!((sampled_effect(&pairs(&|a, b| a + 3.0 * b)) - 0.1).abs() < 0.005);
        assert!((sampled_effect(&pairs(&|a, _| a)) - 1.0).abs() < 0.02);
        assert!(sampled_effect(&pairs(&|_, b| b)) == 0.0);
    }
}
