//! Dual basis of the contact multiplier.

use crate::LobattoBasis;
use faer::Mat;

/// Basis ψ_0, .., ψ_p of degree p with ∫ ψ_i φ_j dt = δ_ij ∫ φ_j dt on [-1,1], φ_j the Lobatto basis.
///
/// ψ_i = Σ_j c_ij φ_j with c = diag(w) M̂⁻¹, M̂_ij = ∫ φ_i φ_j. As the Lobatto rule misses M̂ in the single mode P_p only,
/// c_ij = δ_ij + P_p(x_j)/(p P_p(x_i)): no inversion. Σ_i ψ_i = 1. The ψ_i change sign and do not vanish at element ends.
///
/// Source: Wohlmuth (2000) for dual bases; Issaoui (2014), equation (2.20), at Gauss-Lobatto points.
#[derive(Debug, Clone)]
pub struct BiorthogonalBasis {
    /// Degree p ≥ 1.
    pub degree: usize,
    /// c_ij in row i, column j; (p+1)×(p+1): ψ_i = Σ_j c_ij φ_j, so c_ij = ψ_i(x_j).
    pub coefficients: Mat<f64>,
}

impl BiorthogonalBasis {
    /// Dual of a Lobatto basis.
    pub fn new(basis: &LobattoBasis) -> Self {
        let p = basis.degree;
        let top = |j: usize| basis.vandermonde[(j, p)];
        let coefficients = Mat::from_fn(p + 1, p + 1, |i, j| {
            let identity = if i == j { 1.0 } else { 0.0 };
            identity + top(j) / (p as f64 * top(i))
        });
        Self { degree: p, coefficients }
    }

    /// ψ_i(t) in `out[i]` from the values φ_j(t) of [`LobattoBasis::evaluate`].
    ///
    /// # Panics
    /// If a slice does not have p+1 entries.
    pub fn evaluate(&self, phi: &[f64], out: &mut [f64]) {
        let p = self.degree;
        assert!(phi.len() == p + 1 && out.len() == p + 1, "a basis of degree {p} has {} values", p + 1);
        for i in 0..=p {
            out[i] = (0..=p).map(|j| self.coefficients[(i, j)] * phi[j]).sum();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gauss_legendre;
    use faer::Side;
    use faer::prelude::*;

    #[test]
    fn dual_to_the_lobatto_basis_and_sums_to_one() {
        for p in 1..=64 {
            let basis = LobattoBasis::new(p);
            let dual = BiorthogonalBasis::new(&basis);
            let mut pairing = Mat::<f64>::zeros(p + 1, p + 1);
            let (mut phi, mut psi) = (vec![0.0; p + 1], vec![0.0; p + 1]);
            let rule = gauss_legendre(p + 1);
            for (&t, w) in rule.points.iter().zip(&rule.weights) {
                basis.evaluate(t, &mut phi);
                dual.evaluate(&phi, &mut psi);
                assert!((psi.iter().sum::<f64>() - 1.0).abs() < 1e-14, "p {p}");
                for i in 0..=p {
                    for j in 0..=p {
                        pairing[(i, j)] += w * psi[i] * phi[j];
                    }
                }
            }
            for i in 0..=p {
                for j in 0..=p {
                    let expected = if i == j { basis.weights[j] } else { 0.0 };
                    assert!((pairing[(i, j)] - expected).abs() < 1e-14, "p {p} ({i}, {j}): {:e}", pairing[(i, j)]);
                }
            }
        }
    }

    #[test]
    fn coefficients_are_the_scaled_inverse_of_the_mass_matrix() {
        for p in [1, 2, 3, 8, 16] {
            let basis = LobattoBasis::new(p);
            let dual = BiorthogonalBasis::new(&basis);
            let mut mass = Mat::<f64>::zeros(p + 1, p + 1);
            let mut phi = vec![0.0; p + 1];
            let rule = gauss_legendre(p + 1);
            for (&t, w) in rule.points.iter().zip(&rule.weights) {
                basis.evaluate(t, &mut phi);
                for i in 0..=p {
                    for j in 0..=p {
                        mass[(i, j)] += w * phi[i] * phi[j];
                    }
                }
            }
            let inverse = mass.llt(Side::Lower).unwrap().solve(Mat::<f64>::identity(p + 1, p + 1));
            for i in 0..=p {
                for j in 0..=p {
                    let expected = basis.weights[i] * inverse[(i, j)];
                    assert!((dual.coefficients[(i, j)] - expected).abs() < 1e-13 * (1.0 + expected.abs()));
                }
            }
        }
    }

    #[test]
    fn linear_dual_in_closed_form() {
        let dual = BiorthogonalBasis::new(&LobattoBasis::new(1));
        assert_eq!(dual.coefficients, Mat::from_fn(2, 2, |i, j| if i == j { 2.0 } else { -1.0 }));
    }
}
