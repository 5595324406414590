//! Tensor products of two rules.

use crate::Rule;

/// Quadrature rule in the plane: ∫∫ f dx dy ≈ Σ_i `weights[i]` f(`points[i]`).
#[derive(Debug, Clone, PartialEq)]
pub struct Rule2 {
    /// Points (x, y).
    pub points: Vec<[f64; 2]>,
    /// Weights.
    pub weights: Vec<f64>,
}

/// Product of a rule in x and a rule in y, exact for x^i y^j with i to `x.degree` and j to `y.degree`.
///
/// Point number i·`y.len()` + j is (x_i, y_j).
pub fn tensor(x: &Rule, y: &Rule) -> Rule2 {
    let pairs = || (0..x.len()).flat_map(|i| (0..y.len()).map(move |j| (i, j)));
    Rule2 {
        points: pairs().map(|(i, j)| [x.points[i], y.points[j]]).collect(),
        weights: pairs().map(|(i, j)| x.weights[i] * y.weights[j]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use crate::{gauss_legendre, tensor};

    #[test]
    fn degrees_multiply_and_end_where_they_say() {
        let (x, y) = (gauss_legendre(3), gauss_legendre(2));
        let rule = tensor(&x, &y);
        assert_eq!((rule.points.len(), rule.points[1]), (6, [x.points[0], y.points[1]]));
        let moment = |i: i32, j: i32| -> f64 {
            rule.points.iter().zip(&rule.weights).map(|(p, w)| w * p[0].powi(i) * p[1].powi(j)).sum()
        };
        let side = |k: i32| if k % 2 == 0 { 2.0 / f64::from(k + 1) } else { 0.0 };
        for i in 0..=5 {
            for j in 0..=3 {
                assert!((moment(i, j) - side(i) * side(j)).abs() < 1e-15, "x^{i} y^{j}");
            }
        }
        assert!((moment(6, 0) - side(6) * 2.0).abs() > 1e-3);
        assert!((moment(0, 4) - side(4) * 2.0).abs() > 1e-3);
    }
}
