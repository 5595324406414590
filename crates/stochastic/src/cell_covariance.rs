//! The covariance of the means of a field over the cells of a grid.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use steklov_quadrature::gauss_legendre;

use crate::covariance::check_length;
use crate::{Covariance, Kernel, StochasticError};

/// Points of a Gauss rule on a stretch of one correlation length or less.
const POINTS: usize = 12;
/// Correlation lengths beyond which a kernel is below 1e-17.
const REACH: f64 = 40.0;

/// Cells of a grid of NX × NY rectangles; number ix·NY + iy is that of cell ix, iy, counted from the lower left.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldCells {
    /// NX, NY.
    pub cells: [usize; 2],
    /// Lengths of a cell along x and y.
    pub size: [f64; 2],
    /// Whether each cell belongs to the body; none given: all of them.
    pub inside: Option<Vec<bool>>,
}

impl FieldCells {
    /// Refuses lengths, numbers and masks that make no grid.
    pub(crate) fn check(&self) -> Result<(), StochasticError> {
        for size in self.size {
            check_length("the length of a cell", size)?;
        }
        let [nx, ny] = self.cells;
        let wrong = match &self.inside {
            _ if nx == 0 || ny == 0 => true,
            Some(inside) => inside.len() != nx * ny || !inside.contains(&true),
            None => false,
        };
        if wrong {
            let given = self.inside.as_ref().map_or(nx * ny, Vec::len);
            let what = format!("a mask of {given} cells for {nx} by {ny} of them, at least one inside");
            return Err(StochasticError::Inconsistent { what });
        }
        Ok(())
    }

    /// Numbers of the cells that belong to the body, rising.
    pub fn body(&self) -> Vec<usize> {
        let all = 0..self.cells[0] * self.cells[1];
        all.filter(|&c| self.inside.as_ref().is_none_or(|inside| inside[c])).collect()
    }

    /// The number of the cell with a point, measured from the lower left; of the next one for points outside.
    pub fn containing(&self, x: [f64; 2]) -> usize {
        let [ix, iy] = [0, 1].map(|d| ((x[d] / self.size[d]).max(0.0) as usize).min(self.cells[d] - 1));
        ix * self.cells[1] + iy
    }

    /// Area of a cell.
    pub fn area(&self) -> f64 {
        self.size[0] * self.size[1]
    }
}

/// Covariance of the means over two intervals of length `h` that are k of them apart, k = 0 .. count - 1:
/// ∫_{-1}^{1} (1 - |t|) C(h |k + t|) dt, by Gauss rules on stretches of one correlation length or less.
///
/// Source: Vanmarcke, Random Fields (1983), section 5.1.
pub(crate) fn interval_means(kernel: Kernel, correlation: f64, h: f64, count: usize) -> Vec<f64> {
    let (rule, q) = (gauss_legendre(POINTS).mapped(0.0, 1.0), h / correlation);
    // ∫_from^{from+1} weight(r) C(q r) dr, r the distance in cells
    let half = |from: f64, weight: &dyn Fn(f64) -> f64| {
        let stretches = q.ceil().clamp(1.0, REACH) as usize;
        let step = (1.0 / q).min(1.0);
        let mut sum = 0.0;
        for k in 0..stretches {
            let (a, b) = (k as f64 * step, ((k + 1) as f64 * step).min(1.0));
            for (t, w) in rule.points.iter().zip(&rule.weights) {
                let r = from + a + (b - a) * t;
                sum += w * (b - a) * weight(r) * kernel.value(q * r);
            }
        }
        sum
    };
    let entry = |k: usize| {
        let at = k as f64;
        let beyond = half(at, &|r| 1.0 - (r - at));
        if k == 0 { 2.0 * beyond } else { half(at - 1.0, &|r| 1.0 - (at - r)) + beyond }
    };
    (0..count).map(entry).collect()
}

/// The operator b ↦ Σ_j C_ij |c| b_j of a covariance that is a product: C_ij the covariance of the means over cells i and j of
/// the body, |c| the area of a cell. Its eigenvalues are those of the covariance operator on constants in each cell.
///
/// *Cost*: a product takes 2 NX NY (NX + NY) operations, two dense products on the bounding box.
pub(crate) struct CellCovariance<'a> {
    cells: &'a FieldCells,
    body: Vec<usize>,
    /// Toeplitz matrices along x and y, the first one times the area of a cell.
    factors: [Mat<f64>; 2],
}

impl<'a> CellCovariance<'a> {
    /// The operator of the exponential or the Gaussian covariance.
    pub(crate) fn new(covariance: &Covariance, cells: &'a FieldCells) -> Self {
        let means =
            |d: usize| interval_means(covariance.kernel, covariance.correlation[d], cells.size[d], cells.cells[d]);
        let toeplitz = |d: usize, scale: f64| {
            let table = means(d);
            Mat::from_fn(table.len(), table.len(), |i, j| scale * table[i.abs_diff(j)])
        };
        Self { cells, body: cells.body(), factors: [toeplitz(0, cells.area()), toeplitz(1, 1.0)] }
    }

    /// Number of cells of the body.
    pub(crate) fn len(&self) -> usize {
        self.body.len()
    }

    /// The variance of a cell's mean times its area; the sum over all cells is the trace.
    pub(crate) fn diagonal(&self) -> f64 {
        self.factors[0][(0, 0)] * self.factors[1][(0, 0)]
    }

    /// The entry of two cells of the body.
    pub(crate) fn entry(&self, i: usize, j: usize) -> f64 {
        let ny = self.cells.cells[1];
        let (a, b) = (self.body[i], self.body[j]);
        self.factors[0][(a / ny, b / ny)] * self.factors[1][(a % ny, b % ny)]
    }

    /// The operator on a vector of the cells of the body, on one thread.
    pub(crate) fn apply(&self, b: &[f64], out: &mut [f64]) {
        let [nx, ny] = self.cells.cells;
        let mut full = vec![0.0; nx * ny];
        self.body.iter().zip(b).for_each(|(&c, b)| full[c] = *b);
        // cells lie by rows of constant ix: the transpose is column-major
        let given = MatRef::from_column_major_slice(&full, ny, nx);
        let mut half = Mat::zeros(ny, nx);
        matmul(half.as_mut(), Accum::Replace, self.factors[1].as_ref(), given, 1.0, Par::Seq);
        let mut product = vec![0.0; nx * ny];
        let whole = MatMut::from_column_major_slice_mut(&mut product, ny, nx);
        matmul(whole, Accum::Replace, half.as_ref(), self.factors[0].as_ref(), 1.0, Par::Seq);
        self.body.iter().zip(out).for_each(|(&c, out)| *out = product[c]);
    }
}
