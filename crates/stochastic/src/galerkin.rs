//! Discrete eigenpairs of a covariance on the unit interval.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use steklov_quadrature::{gauss_legendre, legendre_p};

use crate::StochasticError;
use crate::karhunen_loeve::ROUNDOFF;
use crate::spectrum::folded_spectrum;

/// Piecewise polynomials on equal elements of the unit interval, by orthonormal Legendre polynomials.
#[derive(Debug, Clone)]
pub(crate) struct Piecewise {
    pub elements: usize,
    pub degree: usize,
    /// One mode a row, (degree + 1) coefficients an element.
    pub modes: Vec<Vec<f64>>,
}

impl Piecewise {
    /// All modes at x.
    pub fn evaluate(&self, x: f64, out: &mut [f64]) {
        let element = ((x * self.elements as f64) as usize).min(self.elements - 1);
        let mut phi = vec![0.0; self.degree + 1];
        orthonormal(x * self.elements as f64 - element as f64, &mut phi);
        let scale = (self.elements as f64).sqrt();
        for (out, mode) in out.iter_mut().zip(&self.modes) {
            let own = &mode[element * phi.len()..][..phi.len()];
            *out = scale * own.iter().zip(&phi).map(|(c, p)| c * p).sum::<f64>();
        }
    }

    /// Turns every mode so that it starts with a positive value.
    fn orient(mut self) -> Self {
        let mut start = vec![0.0; self.modes.len()];
        self.evaluate(0.0, &mut start);
        for (mode, start) in self.modes.iter_mut().zip(start) {
            if start < 0.0 {
                mode.iter_mut().for_each(|c| *c = -*c);
            }
        }
        self
    }
}

/// √(2k+1) P_k(2x-1), orthonormal on the unit interval.
pub(crate) fn orthonormal(x: f64, out: &mut [f64]) {
    legendre_p(2.0 * x - 1.0, out);
    for (k, value) in out.iter_mut().enumerate() {
        *value *= ((2 * k + 1) as f64).sqrt();
    }
}

/// Galerkin's method with discontinuous elements: λ_m and the modes of the operator b ↦ ∫_0^1 C(|x-y|) b(y) dy.
///
/// The kernel may have a kink at 0: an element with itself is integrated on two triangles, by Gauss rules after
/// (s, t) ↦ (s², s²(1-t²)), which r^2ν of any ν ≥ 1/2 suits; two elements are integrated by a product rule. Equal elements make
/// the blocks functions of the distance.
pub(crate) fn galerkin(
    kernel: impl Fn(f64) -> f64 + Sync,
    elements: usize,
    degree: usize,
) -> Result<(Vec<f64>, Piecewise), StochasticError> {
    let (n, h) = (degree + 1, 1.0 / elements as f64);
    let rule = gauss_legendre(degree + 10).mapped(0.0, 1.0);
    let phi: Vec<Vec<f64>> = rule.points.iter().map(|&x| polynomials(x, n)).collect();
    // block[d][i n + j] = h ∫∫ C(h |d + y - x|) φ_i(x) φ_j(y) dx dy over the unit square
    let mut blocks = vec![vec![0.0; n * n]; elements];
    let triangle = gauss_legendre(2 * degree + 10).mapped(0.0, 1.0);
    let squares = || triangle.points.iter().zip(&triangle.weights).map(|(s, w)| (s * s, 2.0 * s * w));
    for (s, ws) in squares() {
        let outer = polynomials(s, n);
        let mut inner = vec![0.0; n];
        for (off, wt) in squares() {
            let value = h * ws * s * wt * kernel(h * s * off);
            orthonormal(s * (1.0 - off), &mut inner);
            for i in 0..n {
                for j in 0..n {
                    blocks[0][i * n + j] += value * (outer[i] * inner[j] + inner[i] * outer[j]);
                }
            }
        }
    }
    for (d, block) in blocks.iter_mut().enumerate().skip(1) {
        for (x, &s) in rule.points.iter().enumerate() {
            let mut row = vec![0.0; n];
            for (y, &t) in rule.points.iter().enumerate() {
                let value = h * rule.weights[x] * rule.weights[y] * kernel(h * (d as f64 + t - s));
                row.iter_mut().zip(&phi[y]).for_each(|(r, p)| *r += value * p);
            }
            for i in 0..n {
                for j in 0..n {
                    block[i * n + j] += phi[x][i] * row[j];
                }
            }
        }
    }
    // φ_j mirrored is (-1)^j φ_j on the mirrored element
    let sign = |j: usize| if j.is_multiple_of(2) { 1.0 } else { -1.0 };
    let entry = |a: usize, b: usize| {
        let (e, i, f, j) = (a / n, a % n, b / n, b % n);
        if e <= f { blocks[f - e][i * n + j] } else { blocks[e - f][j * n + i] }
    };
    let half = (0..elements / 2).flat_map(|e| (0..n).map(move |j| (e, j)));
    let images: Vec<_> = half.map(|(e, j)| vec![(e * n + j, 1.0), ((elements - 1 - e) * n + j, sign(j))]).collect();
    let spectrum = folded_spectrum(&images, entry)?;
    Ok((spectrum.values, Piecewise { elements, degree, modes: spectrum.vectors }.orient()))
}

/// Nyström's method at an even number of Gauss points: all λ_m, and the modes above roundoff as the polynomials through their values there.
///
/// These polynomials are orthonormal to roundoff, as the rule is exact for their products, and lose no digits where λ_m is
/// small, as (1/λ_m) Σ w_j C(x, x_j) b_m(x_j) would.
pub(crate) fn nystrom(
    kernel: impl Fn(f64) -> f64 + Sync,
    points: usize,
) -> Result<(Vec<f64>, Piecewise), StochasticError> {
    let rule = gauss_legendre(points).mapped(0.0, 1.0);
    let root: Vec<f64> = rule.weights.iter().map(|w| w.sqrt()).collect();
    let entry = |i: usize, j: usize| root[i] * root[j] * kernel((rule.points[i] - rule.points[j]).abs());
    let images: Vec<_> = (0..points / 2).map(|i| vec![(i, 1.0), (points - 1 - i, 1.0)]).collect();
    let spectrum = folded_spectrum(&images, entry)?;
    let largest = spectrum.values[0];
    let count = spectrum.values.iter().take_while(|&&s| s > ROUNDOFF * largest).count();
    let phi = transform(points);
    let (phi, values) =
        (Mat::from_fn(points, points, |k, j| phi[k][j]), Mat::from_fn(points, count, |j, m| spectrum.vectors[m][j]));
    let mut coefficients = Mat::zeros(points, count);
    matmul(coefficients.as_mut(), Accum::Replace, phi.as_ref(), values.as_ref(), 1.0, Par::Seq);
    let modes = (0..count).map(|m| coefficients.col_as_slice(m).to_vec()).collect();
    Ok((spectrum.values, Piecewise { elements: 1, degree: points - 1, modes }.orient()))
}

/// √w_j φ_k(x_j), row k, at the Gauss points of the unit interval: an orthogonal matrix.
pub(crate) fn transform(points: usize) -> Vec<Vec<f64>> {
    let rule = gauss_legendre(points).mapped(0.0, 1.0);
    let values: Vec<Vec<f64>> = rule.points.iter().map(|&x| polynomials(x, points)).collect();
    (0..points).map(|k| (0..points).map(|j| rule.weights[j].sqrt() * values[j][k]).collect()).collect()
}

fn polynomials(x: f64, count: usize) -> Vec<f64> {
    let mut out = vec![0.0; count];
    orthonormal(x, &mut out);
    out
}
