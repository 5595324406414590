//! Karhunen-Loève expansions on a rectangle.

use steklov_algebra::dot;

use crate::covariance::check_length;
use crate::galerkin::{orthonormal, transform};
use crate::karhunen_loeve::{LIMIT, ROUNDOFF, captured, check, kept};
use crate::spectrum::{Spectrum, folded_spectrum};
use crate::{Covariance, KarhunenLoeve, StochasticError, Truncation};
use steklov_quadrature::gauss_legendre;

/// Products of eigenvalues nearer than this are taken as equal.
const TIE: f64 = 1e-12;
/// Largest change of an eigenvalue over the largest one at the last refinement of a covariance that is no product.
const CHANGE: f64 = 4e-6;
/// Most points of a quarter of the rectangle.
const QUARTER: usize = 1600;

/// Eigenpairs of a covariance on the rectangle [0, L_1] × [0, L_2], largest first; their sum is L_1 L_2.
///
/// *Exponential and Gaussian*: products of the eigenpairs of the sides, sorted; of equal products (relative 1e-12) the one
/// with the smaller mode number in x comes first. *Matérn*: Nyström's method at tensor Gauss points, refined until no
/// kept eigenvalue changes by more than 4e-6 λ_1; of order N^(-5/2), they are then right to about 1e-6 λ_1. Modes are
/// orthonormal in L² and positive at the origin; a Matérn mode that vanishes there has a positive first large Legendre
/// coefficient.
///
/// *Fails when*: correlation lengths are short or modes many under the Matérn covariance (typed errors). *Cost*: products:
/// milliseconds; Matérn: eigenpairs of four matrices of size N/4 for N points, at most 6400.
///
/// Source: Ghanem and Spanos (1991), section 2.3, for products; Betz, Papaioannou and Straub (2014) for Nyström's method.
#[derive(Debug, Clone)]
pub struct RectangleKarhunenLoeve {
    sides: [f64; 2],
    /// λ_m/(L_1 L_2).
    pub(crate) shares: Vec<f64>,
    modes: Modes,
}

#[derive(Debug, Clone)]
enum Modes {
    /// Mode m is the product of two modes of the sides.
    Products { x: KarhunenLoeve, y: KarhunenLoeve, pairs: Vec<[usize; 2]> },
    /// Legendre coefficients of mode m, row by row in x.
    Tensor { points: [usize; 2], modes: Vec<Vec<f64>> },
}

impl RectangleKarhunenLoeve {
    /// Expansion on [0, L_1] × [0, L_2].
    ///
    /// # Errors
    /// As [`KarhunenLoeve::new`], and [`StochasticError::Unconverged`] if the Matérn covariance is not resolved.
    pub fn new(covariance: &Covariance, sides: [f64; 2], truncation: Truncation) -> Result<Self, StochasticError> {
        for (side, correlation) in sides.into_iter().zip(covariance.correlation) {
            check(side, truncation)?;
            check_length("the correlation length", correlation)?;
        }
        covariance.kernel.check()?;
        match covariance.kernel.is_product() {
            true => Self::products(covariance, sides, truncation),
            false => Self::refined(covariance, sides, truncation),
        }
    }

    fn products(covariance: &Covariance, sides: [f64; 2], truncation: Truncation) -> Result<Self, StochasticError> {
        let x = KarhunenLoeve::all(covariance.kernel, covariance.correlation[0], sides[0])?;
        let y = KarhunenLoeve::all(covariance.kernel, covariance.correlation[1], sides[1])?;
        let (a, b) = (&x.shares, &y.shares);
        // eigenpairs missing in one direction would give products up to this
        let missing = |v: &[f64]| if v.len() < LIMIT { ROUNDOFF * v[0] } else { 0.0 };
        let lowest = (missing(a) * b[0]).max(a[0] * missing(b));
        // pair (i, j) has (i+1)(j+1) products at least as large, itself among them
        let row = |i: usize| (0..b.len().min(LIMIT / (i + 1))).map(move |j| [i, j]);
        let mut pairs: Vec<[usize; 2]> = (0..a.len()).flat_map(row).filter(|&[i, j]| a[i] * b[j] > lowest).collect();
        let product = |&[i, j]: &[usize; 2]| a[i] * b[j];
        pairs.sort_by(|p, q| product(q).total_cmp(&product(p)));
        for equal in pairs.chunk_by_mut(|p, q| product(p) - product(q) <= TIE * product(p)) {
            equal.sort();
        }
        pairs.truncate(LIMIT);
        let mut shares: Vec<f64> = pairs.iter().map(product).collect();
        let count = kept(&shares, truncation)?;
        shares.truncate(count);
        pairs.truncate(count);
        let used = |d: usize| pairs.iter().map(|p| p[d] + 1).max().unwrap_or(0);
        let (x, y) = (x.truncated(used(0)), y.truncated(used(1)));
        Ok(Self { sides, shares, modes: Modes::Products { x, y, pairs } })
    }

    fn refined(covariance: &Covariance, sides: [f64; 2], truncation: Truncation) -> Result<Self, StochasticError> {
        let scaled = [sides[0] / covariance.correlation[0], sides[1] / covariance.correlation[1]];
        // points in proportion to what they have to resolve
        let first = |d: usize| 2 * (4.0 + scaled[d].min(1e6)).ceil() as usize;
        let (mut points, mut before) = ([first(0), first(1)], Vec::new());
        let mut change = f64::INFINITY;
        loop {
            if points[0].saturating_mul(points[1]) > 4 * QUARTER {
                return Err(StochasticError::Unconverged { points, change, tolerance: CHANGE });
            }
            let found = nystrom(covariance, scaled, points)?;
            // modes beyond a quarter of the points are not resolved
            let trusted = &found.values[..found.values.len() / 4];
            let available = trusted.iter().take_while(|&&s| s > ROUNDOFF * trusted[0]).count();
            let count = kept(&trusted[..available], truncation);
            if let Ok(count) = count
                && before.len() >= count
            {
                let differences = found.values[..count].iter().zip(&before).map(|(a, b): (&f64, &f64)| (a - b).abs());
                change = differences.fold(0.0, f64::max) / found.values[0];
                if change <= CHANGE {
                    return Ok(Self::tensor(sides, points, found, count));
                }
            }
            let next = points.map(|n| 2 * (0.7 * n as f64).ceil() as usize);
            if let Err(error) = count
                && next[0] * next[1] > 4 * QUARTER
            {
                return Err(error);
            }
            (points, before) = (next, found.values);
        }
    }

    /// The leading modes, from their values at the points to Legendre coefficients.
    fn tensor(sides: [f64; 2], points: [usize; 2], mut found: Spectrum, count: usize) -> Self {
        let [tx, ty] = points.map(transform);
        let coefficients = |values: &Vec<f64>| {
            let rows: Vec<Vec<f64>> =
                values.chunks(points[1]).map(|row| ty.iter().map(|t| dot(t, row)).collect()).collect();
            let column = |t: &Vec<f64>, j: usize| t.iter().zip(&rows).map(|(t, row)| t * row[j]).sum::<f64>();
            oriented(
                tx.iter().flat_map(|t| (0..points[1]).map(|j| column(t, j)).collect::<Vec<_>>()).collect(),
                points[1],
            )
        };
        let modes = found.vectors[..count].iter().map(coefficients).collect();
        found.values.truncate(count);
        Self { sides, shares: found.values, modes: Modes::Tensor { points, modes } }
    }

    /// L_1 and L_2.
    pub fn sides(&self) -> [f64; 2] {
        self.sides
    }

    /// Number of modes.
    pub fn len(&self) -> usize {
        self.shares.len()
    }

    /// Whether there are no modes; never true.
    pub fn is_empty(&self) -> bool {
        self.shares.is_empty()
    }

    /// λ_m, an area.
    ///
    /// # Panics
    /// If there is no mode m.
    pub fn eigenvalue(&self, m: usize) -> f64 {
        self.shares[m] * self.sides[0] * self.sides[1]
    }

    /// Share of the variance in the modes, Σ λ_m/(L_1 L_2) ≤ 1.
    pub fn captured(&self) -> f64 {
        captured(&self.shares)
    }

    /// Half waves the modes have along the sides, about.
    pub(crate) fn waves(&self) -> [usize; 2] {
        match &self.modes {
            Modes::Products { x, y, .. } => [x.len(), y.len()],
            Modes::Tensor { points, .. } => points.map(|n| self.len().min(n / 2)),
        }
    }

    /// b_m(x) of all modes; x is moved into the rectangle.
    ///
    /// # Panics
    /// If `out` has another length than the expansion.
    pub fn modes(&self, x: [f64; 2], out: &mut [f64]) {
        assert_eq!(out.len(), self.len(), "one value a mode");
        match &self.modes {
            Modes::Products { x: first, y: second, pairs } => {
                let (mut a, mut b) = (vec![0.0; first.len()], vec![0.0; second.len()]);
                first.modes(x[0], &mut a);
                second.modes(x[1], &mut b);
                out.iter_mut().zip(pairs).for_each(|(out, &[i, j])| *out = a[i] * b[j]);
            }
            Modes::Tensor { points, modes } => {
                let (mut a, mut b) = (vec![0.0; points[0]], vec![0.0; points[1]]);
                orthonormal((x[0] / self.sides[0]).clamp(0.0, 1.0), &mut a);
                orthonormal((x[1] / self.sides[1]).clamp(0.0, 1.0), &mut b);
                let scale = (self.sides[0] * self.sides[1]).sqrt().recip();
                for (out, mode) in out.iter_mut().zip(modes) {
                    let rows = mode.chunks(b.len());
                    *out = scale * rows.zip(&a).map(|(row, a)| a * dot(row, &b)).sum::<f64>();
                }
            }
        }
    }

    /// Means of all modes over the cells of NX × NY equal ones, that of cell ix, iy at ix·NY + iy; by Gauss rules of 12 points and
    /// two more for each half wave of a cell.
    ///
    /// # Panics
    /// If there are no cells.
    pub fn cell_means(&self, cells: [usize; 2]) -> Vec<Vec<f64>> {
        assert!(cells.iter().all(|&n| n > 0), "at least one cell along each side");
        // rows of means over the cells of a side: one for each of `count` functions that `values` gives at a point
        let means = |d: usize, count: usize, values: &dyn Fn(f64, &mut [f64])| -> Vec<Vec<f64>> {
            let rule = gauss_legendre(12 + 2 * count.div_ceil(cells[d])).mapped(0.0, 1.0);
            let h = self.sides[d] / cells[d] as f64;
            let mut all = vec![vec![0.0; cells[d]]; count];
            let mut at = vec![0.0; count];
            for i in 0..cells[d] {
                for (t, w) in rule.points.iter().zip(&rule.weights) {
                    values((i as f64 + t) * h, &mut at);
                    all.iter_mut().zip(&at).for_each(|(row, value)| row[i] += w * value);
                }
            }
            all
        };
        let product =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().flat_map(|a| b.iter().map(move |b| a * b)).collect() };
        match &self.modes {
            Modes::Products { x, y, pairs } => {
                let a = means(0, x.len(), &|at, out| x.modes(at, out));
                let b = means(1, y.len(), &|at, out| y.modes(at, out));
                pairs.iter().map(|&[i, j]| product(&a[i], &b[j])).collect()
            }
            Modes::Tensor { points, modes } => {
                let polynomials =
                    |d: usize| means(d, points[d], &|at, out| orthonormal((at / self.sides[d]).clamp(0.0, 1.0), out));
                let (a, b) = (polynomials(0), polynomials(1));
                let scale = (self.sides[0] * self.sides[1]).sqrt().recip();
                let of_mode = |mode: &Vec<f64>| {
                    let mut sum = vec![0.0; cells[0] * cells[1]];
                    for (row, a) in mode.chunks(points[1]).zip(&a) {
                        let mut along = vec![0.0; cells[1]];
                        for (c, b) in row.iter().zip(&b) {
                            along.iter_mut().zip(b).for_each(|(s, b)| *s += scale * c * b);
                        }
                        sum.iter_mut().zip(product(a, &along)).for_each(|(s, p)| *s += p);
                    }
                    sum
                };
                modes.iter().map(of_mode).collect()
            }
        }
    }
}

/// Nyström's method for a covariance on the unit square, the sides measured in correlation lengths.
fn nystrom(covariance: &Covariance, scaled: [f64; 2], points: [usize; 2]) -> Result<Spectrum, StochasticError> {
    let unit = Covariance { correlation: [1.0; 2], ..*covariance };
    let [x, y] = points.map(|n| gauss_legendre(n).mapped(0.0, 1.0));
    let ny = points[1];
    let entry = |a: usize, b: usize| {
        let (i, j, k, l) = (a / ny, a % ny, b / ny, b % ny);
        let weight = x.weights[i] * x.weights[k] * y.weights[j] * y.weights[l];
        let (dx, dy) = (x.points[i] - x.points[k], y.points[j] - y.points[l]);
        weight.sqrt() * unit.on_rectangle(scaled[0] * dx, scaled[1] * dy)
    };
    let images = |i: usize, j: usize| {
        let (k, l) = (points[0] - 1 - i, ny - 1 - j);
        [[i, j], [k, j], [i, l], [k, l]].map(|[i, j]| (i * ny + j, 1.0)).to_vec()
    };
    let quarter: Vec<_> = (0..points[0] / 2).flat_map(|i| (0..ny / 2).map(move |j| images(i, j))).collect();
    folded_spectrum(&quarter, entry)
}

/// The coefficients with the sign that makes the mode positive at the origin, or the first large coefficient positive.
fn oriented(mut coefficients: Vec<f64>, ny: usize) -> Vec<f64> {
    let end = |n: usize| if n.is_multiple_of(2) { 1.0 } else { -1.0 } * ((2 * n + 1) as f64).sqrt();
    let corner: f64 = coefficients.iter().enumerate().map(|(k, c)| end(k / ny) * end(k % ny) * c).sum();
    let largest = coefficients.iter().fold(0.0f64, |m, c| m.max(c.abs()));
    let sign = if corner.abs() > 1e-3 {
        corner
    } else {
        coefficients.iter().copied().find(|c| c.abs() > 0.5 * largest).unwrap_or(1.0)
    };
    if sign < 0.0 {
        coefficients.iter_mut().for_each(|c| *c = -*c);
    }
    coefficients
}
