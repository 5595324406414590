//! Lagrange basis at the Gauss-Lobatto points, and its ties to Legendre coefficients.

use crate::{Series, gauss_lobatto, legendre_p};
use faer::Mat;

/// Lagrange basis φ_0, .., φ_p of degree p at the p+1 Gauss-Lobatto points of [-1,1]: φ_j(x_i) = δ_ij.
///
/// A function u = Σ_j u_j φ_j = Σ_n û_n P_n is given by nodal values u_j or Legendre coefficients û_n.
/// ∫ φ_j dt = w_j > 0 for every degree, which is why these points and no others carry contact.
#[derive(Debug, Clone)]
pub struct LobattoBasis {
    /// Degree p ≥ 1.
    pub degree: usize,
    /// Points x_j, ascending from -1 to 1, p+1 of them.
    pub nodes: Vec<f64>,
    /// Weights w_j = ∫ φ_j dt = 2/(p(p+1) P_p(x_j)²).
    pub weights: Vec<f64>,
    /// P_n(x_j) in row j, column n; (p+1)×(p+1). Nodal values = this × Legendre coefficients.
    pub vandermonde: Mat<f64>,
    /// Legendre coefficients = this × nodal values; (p+1)×(p+1), inverse of `vandermonde`.
    pub to_legendre: Mat<f64>,
    /// Nodal values of du/dt = this × nodal values of u; (p+1)×(p+1), entry φ_j'(x_i).
    pub differentiation: Mat<f64>,
    /// Legendre coefficients of du/dt = this × nodal values of u; p×(p+1).
    pub derivative_to_legendre: Mat<f64>,
}

impl LobattoBasis {
    /// Basis of the given degree; all matrices come from discrete orthogonality, none is inverted.
    ///
    /// # Panics
    /// If degree = 0.
    pub fn new(degree: usize) -> Self {
        assert!(degree >= 1, "a Lobatto basis has degree 1 or more");
        let p = degree;
        let rule = gauss_lobatto(p + 1);
        let (x, w) = (rule.points, rule.weights);
        let mut vandermonde = Mat::zeros(p + 1, p + 1);
        let mut value = vec![0.0; p + 1];
        for j in 0..=p {
            legendre_p(x[j], &mut value);
            (0..=p).for_each(|n| vandermonde[(j, n)] = value[n]);
        }
        // Σ_j w_j P_m P_n = ∫ P_m P_n except for m = n = p, where the rule gives 2/p in place of 2/(2p+1).
        let scale = |n: usize| if n < p { (2 * n + 1) as f64 / 2.0 } else { p as f64 / 2.0 };
        let to_legendre = Mat::from_fn(p + 1, p + 1, |n, j| scale(n) * w[j] * vandermonde[(j, n)]);
        let mut derivative_to_legendre = Mat::zeros(p, p + 1);
        for j in 0..=p {
            let phi = Series { coefficients: (0..=p).map(|n| to_legendre[(n, j)]).collect() };
            let slope = phi.derivative().coefficients;
            (0..p).for_each(|m| derivative_to_legendre[(m, j)] = slope[m]);
        }
        let differentiation = differentiation(&x, &vandermonde);
        Self { degree, nodes: x, weights: w, vandermonde, to_legendre, differentiation, derivative_to_legendre }
    }

    /// φ_j(t) in `out[j]`, by the barycentric formula with φ_j ∝ 1/(P_p(x_j) (t-x_j)); exactly δ_ij at the nodes.
    ///
    /// # Panics
    /// If `out.len()` is not p+1.
    ///
    /// Source: Berrut and Trefethen (2004), the second barycentric formula.
    pub fn evaluate(&self, t: f64, out: &mut [f64]) {
        let p = self.degree;
        assert_eq!(out.len(), p + 1, "a Lobatto basis of degree {p} has {} values", p + 1);
        if let Some(i) = self.nodes.iter().position(|&x| x == t) {
            out.fill(0.0);
            out[i] = 1.0;
            return;
        }
        let mut sum = 0.0;
        for j in 0..=p {
            out[j] = 1.0 / (self.vandermonde[(j, p)] * (t - self.nodes[j]));
            sum += out[j];
        }
        out.iter_mut().for_each(|value| *value /= sum);
    }
}

/// φ_j'(x_i) = P_p(x_i) / (P_p(x_j) (x_i-x_j)); the diagonal makes each row sum zero, so constants have slope 0.
fn differentiation(x: &[f64], vandermonde: &Mat<f64>) -> Mat<f64> {
    let p = x.len() - 1;
    let mut d = Mat::zeros(p + 1, p + 1);
    for i in 0..=p {
        for j in (0..=p).filter(|&j| j != i) {
            d[(i, j)] = vandermonde[(i, p)] / (vandermonde[(j, p)] * (x[i] - x[j]));
            d[(i, i)] -= d[(i, j)];
        }
    }
    d
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{gauss_legendre, legendre_dp};
    use proptest::prelude::*;

    const TOP: usize = 64;

    /// Points rounded to 1e-16 times slopes of φ_j up to p²/4 bound what products can reach at high degree.
    ///
    /// Largest |(AB - expected)_ij| relative to Σ_k |a_ik| |b_kj| + 1.
    fn product_error(a: &Mat<f64>, b: &Mat<f64>, expected: impl Fn(usize, usize) -> f64) -> f64 {
        let mut worst = 0.0f64;
        for i in 0..a.nrows() {
            for j in 0..b.ncols() {
                let terms = (0..a.ncols()).map(|k| a[(i, k)] * b[(k, j)]);
                let (sum, scale) = terms.fold((0.0, 1.0), |(s, m): (f64, f64), t| (s + t, m + t.abs()));
                worst = worst.max((sum - expected(i, j)).abs() / scale);
            }
        }
        worst
    }

    type Row = (usize, f64, f64, [(usize, f64); 3]);

    /// Degree 64 by mpmath with 50 digits: point j, x_j (Newton's method on P_64'), w_j, and row entries (n, C_nj) with
    /// C_nj = (2n+1)/2 w_j P_n(x_j), but p/2 for n = p.
    const TRUTH: [Row; 3] = [
        (
            1,
            -0.9982358589851682,
            0.002962032541256216,
            [(20, 0.04021742198257607), (63, 0.07564324255377498), (64, -0.038186796211860156)],
        ),
        (
            5,
            -0.9675708302669136,
            0.012320671119444298,
            [(20, -0.02490520056735906), (63, 0.14953470811108488), (64, -0.07788171265769427)],
        ),
        (
            31,
            -0.048691995482555116,
            0.048653484433821795,
            [(20, 0.09517415964265127), (63, 0.014953973449629789), (64, -0.15476590271872884)],
        ),
    ];

    #[test]
    fn entries_of_50_digits() {
        let basis = LobattoBasis::new(64);
        for (j, x, w, entries) in TRUTH {
            assert!((basis.nodes[j] - x).abs() < 2e-16 && (basis.weights[j] / w - 1.0).abs() < 2e-15, "point {j}");
            for (n, c) in entries {
                assert!((basis.to_legendre[(n, j)] - c).abs() < 1e-14, "C_{n},{j} = {}", basis.to_legendre[(n, j)]);
            }
        }
    }

    #[test]
    fn to_legendre_inverts_the_vandermonde_matrix() {
        let mut tmp = [0.0f64; 2];
        for p in 1..=TOP {
            let basis = LobattoBasis::new(p);
            assert_eq!((basis.degree, basis.nodes.len(), basis.weights.len()), (p, p + 1, p + 1));
            let identity = |i: usize, j: usize| f64::from(u8::from(i == j));
            let left = product_error(&basis.to_legendre, &basis.vandermonde, identity);
            let right = product_error(&basis.vandermonde, &basis.to_legendre, identity);
            tmp = [tmp[0].max(left), tmp[1].max(right)];
            assert!(left < 2e-14 && right < 2e-14, "p {p}: {left:e}, {right:e}");
        }
    }

    #[test]
    fn derivatives_are_exact_on_legendre_polynomials() {
        let mut tmp = [0.0f64; 2];
        for p in 1..=TOP {
            let basis = LobattoBasis::new(p);
            let (mut value, mut slope) = (vec![0.0; p + 1], Mat::<f64>::zeros(p + 1, p + 1));
            let mut row = vec![0.0; p + 1];
            for j in 0..=p {
                legendre_dp(basis.nodes[j], &mut value, &mut row);
                (0..=p).for_each(|n| slope[(j, n)] = row[n]);
            }
            let nodal = product_error(&basis.differentiation, &basis.vandermonde, |j, n| slope[(j, n)]);
            // P_n' = Σ (2m+1) P_m over m = n-1, n-3, ..
            let exact = |m: usize, n: usize| if n > m && (n - m) % 2 == 1 { (2 * m + 1) as f64 } else { 0.0 };
            let modal = product_error(&basis.derivative_to_legendre, &basis.vandermonde, exact);
            tmp = [tmp[0].max(nodal), tmp[1].max(modal)];
            let bound = 1e-14 * (1.0 + (p as f64 / 25.0).powi(2));
            assert!(nodal < bound && modal < bound, "p {p}: {nodal:e}, {modal:e}");
        }
    }

    #[test]
    fn weights_are_integrals_of_the_basis() {
        for p in 1..=TOP {
            let basis = LobattoBasis::new(p);
            let rule = gauss_legendre(p / 2 + 1);
            for j in 0..=p {
                let mut phi = vec![0.0; p + 1];
                let integral = rule.integrate(|t| {
                    basis.evaluate(t, &mut phi);
                    phi[j]
                });
                assert!((integral - basis.weights[j]).abs() < 1e-14, "p {p}, j {j}");
            }
        }
    }

    #[test]
    fn linear_basis_in_closed_form() {
        let basis = LobattoBasis::new(1);
        let expected = |a: &Mat<f64>, rows: [[f64; 2]; 2]| assert_eq!(*a, Mat::from_fn(2, 2, |i, j| rows[i][j]));
        expected(&basis.vandermonde, [[1.0, -1.0], [1.0, 1.0]]);
        expected(&basis.to_legendre, [[0.5, 0.5], [-0.5, 0.5]]);
        expected(&basis.differentiation, [[-0.5, 0.5], [-0.5, 0.5]]);
        assert_eq!(basis.derivative_to_legendre, Mat::from_fn(1, 2, |_, j| [-0.5, 0.5][j]));
    }

    proptest! {
        /// Exact at the nodes, sum 1, reproduces P_n to degree p and no higher, also a rounding away from a node.
        #[test]
        fn interpolation(p in 1..=TOP, t in -1.0..=1.0f64, node in 0..=TOP, exponent in -17.0..-2.0f64) {
            let basis = LobattoBasis::new(p);
            let x = basis.nodes[node % (p + 1)];
            let mut phi = vec![0.0; p + 1];
            basis.evaluate(x, &mut phi);
            let delta = |j: usize| f64::from(u8::from(j == node % (p + 1)));
            prop_assert!((0..=p).all(|j| phi[j] == delta(j)));
            for t in [t, x + 10f64.powf(exponent) * if x > 0.0 { -1.0 } else { 1.0 }] {
                basis.evaluate(t, &mut phi);
                prop_assert!((phi.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                let mut exact = vec![0.0; p + 2];
                legendre_p(t, &mut exact);
                for n in 0..=p {
                    let value: f64 = (0..=p).map(|j| basis.vandermonde[(j, n)] * phi[j]).sum();
                    prop_assert!((value - exact[n]).abs() < 1e-14, "p {} n {} t {}: {:e}", p, n, t, value - exact[n]);
                }
            }
        }

        /// P_{p+1} is out of reach: its interpolant differs by P_{p+1} - P_{p-1}, a multiple of (1-t²) P_p'.
        #[test]
        fn degree_is_no_higher(p in 1..=TOP, t in -0.9..0.9f64) {
            let basis = LobattoBasis::new(p);
            let (mut phi, mut exact) = (vec![0.0; p + 1], vec![0.0; p + 2]);
            basis.evaluate(t, &mut phi);
            legendre_p(t, &mut exact);
            let mut at_node = vec![0.0; p + 2];
            let value: f64 = (0..=p)
                .map(|j| {
                    legendre_p(basis.nodes[j], &mut at_node);
                    at_node[p + 1] * phi[j]
                })
                .sum();
            prop_assert!((value - exact[p - 1]).abs() < 1e-14);
        }
    }
}
