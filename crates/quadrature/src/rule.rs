//! Points and weights of a quadrature rule.

/// Quadrature rule ∫ f ω dx ≈ Σ_i `weights[i]` f(`points[i]`), on [-1,1] with ω = 1 unless the function that makes it says
/// otherwise.
///
/// Points ascend; all rules of this crate have positive weights.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// Points x_i, ascending.
    pub points: Vec<f64>,
    /// Weights w_i > 0, with the weight function ω included.
    pub weights: Vec<f64>,
    /// Highest degree of f integrated exactly (all degrees 0..=degree are).
    pub degree: usize,
}

impl Rule {
    /// Number of points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether the rule has no points; never true for the rules of this crate.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Σ_i w_i f(x_i).
    pub fn integrate(&self, mut f: impl FnMut(f64) -> f64) -> f64 {
        self.points.iter().zip(&self.weights).map(|(&x, &w)| w * f(x)).sum()
    }

    /// The rule moved from [-1,1] to `[a,b]` by x ↦ (a+b)/2 + x (b-a)/2; weights are multiplied by (b-a)/2.
    ///
    /// Meant for ω = 1 and a < b. For another ω the moved rule has the weight function ω(x(y)).
    pub fn mapped(&self, a: f64, b: f64) -> Rule {
        let half = 0.5 * (b - a);
        // Written from both ends, so that a point next to an end keeps its distance to it.
        let point = |&x: &f64| if x < 0.0 { a + half * (1.0 + x) } else { b - half * (1.0 - x) };
        Rule {
            points: self.points.iter().map(point).collect(),
            weights: self.weights.iter().map(|w| half * w).collect(),
            degree: self.degree,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::gauss_legendre;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn mapping_keeps_the_degree_on_any_interval(n in 1usize..20, a in -3.0..3.0f64, h in 0.1..4.0f64) {
            let b = a + h;
            let rule = gauss_legendre(n).mapped(a, b);
            let power = |k: usize| rule.integrate(|x| (x - a).powi(k as i32));
            let exact = |k: usize| h.powi(k as i32 + 1) / (k + 1) as f64;
            for k in 0..=rule.degree {
                prop_assert!((power(k) - exact(k)).abs() <= 1e-13 * exact(k).max(1e-300));
            }
            // The error at degree 2n relative to the integral is about 4^(-2n): visible for small n only.
            if n <= 8 {
                prop_assert!((power(2 * n) - exact(2 * n)).abs() > 1e-13 * exact(2 * n));
            }
        }
    }

    #[test]
    fn lengths() {
        let rule = gauss_legendre(3);
        assert_eq!(rule.len(), 3);
        assert!(!rule.is_empty());
    }
}
