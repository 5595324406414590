//! Symmetric circulant matrices of two dimensions, by fast Fourier transforms.

use std::sync::Arc;

use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

/// The matrix C_(x-z) of a torus of m_1 × m_2 places for a table C that is even: C = H diag(λ) H/(m_1 m_2), H the Hartley
/// transform H_kx = cos θ - sin θ, θ = -2π Σ_d k_d x_d/m_d, which is symmetric and of square m_1 m_2.
///
/// *Cost*: a transform takes 5 M log₂ M operations for M = m_1 m_2, 32 M bytes.
///
/// Source: Bracewell, J. Opt. Soc. Am. 73 (1983), for the transform; Dietrich and Newsam, SIAM J. Sci. Comput. 18 (1997), for
/// embedding.
#[derive(Clone)]
pub(crate) struct Circulant {
    size: [usize; 2],
    eigenvalues: Vec<f64>,
    along: [Arc<dyn Fft<f64>>; 2],
}

impl std::fmt::Debug for Circulant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Circulant").field("size", &self.size).finish_non_exhaustive()
    }
}

impl Circulant {
    /// The matrix with the entry `table(i, j)` for places that are i and j steps apart, at most half of the way around.
    pub(crate) fn new(size: [usize; 2], table: impl Fn(usize, usize) -> f64) -> Self {
        let [mx, my] = size;
        let mut planner = FftPlanner::new();
        let along = size.map(|m| planner.plan_fft_forward(m));
        let mut own = Self { size, eigenvalues: Vec::new(), along };
        let entries = (0..mx).flat_map(|i| (0..my).map(move |j| (i.min(mx - i), j.min(my - j))));
        own.eigenvalues = own.hartley(&entries.map(|(i, j)| table(i, j)).collect::<Vec<_>>());
        own
    }

    /// m_1, m_2.
    pub(crate) fn size(&self) -> [usize; 2] {
        self.size
    }

    /// λ.
    pub(crate) fn eigenvalues(&self) -> &[f64] {
        &self.eigenvalues
    }

    /// H x.
    pub(crate) fn hartley(&self, x: &[f64]) -> Vec<f64> {
        let [mx, my] = self.size;
        let mut rows: Vec<Complex<f64>> = x.iter().map(|x| Complex::new(*x, 0.0)).collect();
        self.along[1].process(&mut rows);
        let mut columns: Vec<Complex<f64>> =
            (0..my).flat_map(|j| (0..mx).map(move |i| (i, j))).map(|(i, j)| rows[i * my + j]).collect();
        self.along[0].process(&mut columns);
        (0..mx).flat_map(|i| (0..my).map(move |j| j * mx + i)).map(|at| columns[at].re - columns[at].im).collect()
    }

    /// C x.
    pub(crate) fn multiply(&self, x: &[f64]) -> Vec<f64> {
        let mut spectrum = self.hartley(x);
        let scale = 1.0 / self.eigenvalues.len() as f64;
        spectrum.iter_mut().zip(&self.eigenvalues).for_each(|(s, value)| *s *= scale * value);
        self.hartley(&spectrum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Products with a matrix that is written out.
    #[test]
    fn products_are_those_of_the_matrix() {
        for size in [[4, 6], [1, 8], [10, 2], [6, 15]] {
            let entry = |i: usize, j: usize| (-(i as f64) * 0.7 - (j as f64) * 0.4).exp();
            let circulant = Circulant::new(size, entry);
            let [mx, my] = size;
            let around = |a: usize, b: usize, m: usize| a.abs_diff(b).min(m - a.abs_diff(b));
            let x: Vec<f64> = (0..mx * my).map(|k| ((k * k + 3 * k) % 17) as f64 - 8.0).collect();
            let expected: Vec<f64> = (0..mx * my)
                .map(|a| {
                    let to = |b: usize| entry(around(a / my, b / my, mx), around(a % my, b % my, my));
                    x.iter().enumerate().map(|(b, x)| to(b) * x).sum()
                })
                .collect();
            for (a, b) in circulant.multiply(&x).iter().zip(&expected) {
                assert!((a - b).abs() < 1e-12, "{size:?}: {a} {b}");
            }
            assert_eq!(circulant.size(), size);
        }
    }
}
