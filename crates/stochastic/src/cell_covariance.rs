//! The covariance of the means of a field over the cells of a grid.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use rayon::prelude::*;
use steklov_quadrature::gauss_legendre;

use crate::circulant::Circulant;
use crate::covariance::check_length;
use crate::{Covariance, Kernel, StochasticError};

/// Points of a Gauss rule on a stretch of one correlation length or less.
const POINTS: usize = 12;
/// Halvings of a stretch towards a point where a kernel may be rough.
const GRADES: i32 = 14;
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

    /// Cells twice as large along both axes. None where cells are odd in number, or where a larger one lies in the body in part.
    pub(crate) fn coarsened(&self) -> Option<Self> {
        let Self { cells: [nx, ny], size, inside } = self;
        if !(nx.is_multiple_of(2) && ny.is_multiple_of(2)) {
            return None;
        }
        let whole = |c: usize| -> Option<bool> {
            let own = self.parts(c).map(|i| inside.as_ref().is_none_or(|inside| inside[i]));
            own.iter().all(|&i| i == own[0]).then_some(own[0])
        };
        let inside = Some((0..nx * ny / 4).map(whole).collect::<Option<Vec<bool>>>()?);
        Some(Self { cells: [nx / 2, ny / 2], size: size.map(|h| 2.0 * h), inside })
    }

    /// The four cells in a cell twice as large.
    pub(crate) fn parts(&self, larger: usize) -> [usize; 4] {
        let ny = self.cells[1];
        let (ix, iy) = (larger / (ny / 2), larger % (ny / 2));
        [[0, 0], [0, 1], [1, 0], [1, 1]].map(|[a, b]| (2 * ix + a) * ny + 2 * iy + b)
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

/// Covariance of the means over two cells that are i and j of them apart along x and y, i < `counts`[0], at i·`counts`[1] + j:
/// ∫_{-1}^{1} ∫_{-1}^{1} (1 - |s|)(1 - |t|) C(h_x |i + s|, h_y |j + t|) ds dt.
pub(crate) fn means_table(covariance: &Covariance, size: [f64; 2], counts: [usize; 2]) -> Vec<f64> {
    if covariance.kernel.is_product() {
        let [x, y] = [0, 1].map(|d| interval_means(covariance.kernel, covariance.correlation[d], size[d], counts[d]));
        return x.iter().flat_map(|x| y.iter().map(move |y| x * y)).collect();
    }
    let scaled = [0, 1].map(|d| size[d] / covariance.correlation[d]);
    let entry = |i: usize, j: usize| {
        let (nodes, far) = ([i, j], i.max(j));
        let [x, y] = [0, 1].map(|d| weighted(nodes[d], scaled[d], far));
        let at = |(r, v): &(f64, f64)| -> f64 {
            y.iter().map(|(t, w)| v * w * covariance.kernel.value((scaled[0] * r).hypot(scaled[1] * t))).sum()
        };
        x.iter().map(at).sum::<f64>()
    };
    let rows: Vec<Vec<f64>> =
        (0..counts[0]).into_par_iter().map(|i| (0..counts[1]).map(|j| entry(i, j)).collect()).collect();
    rows.concat()
}

/// Points r in cells and weights for ∫_{-1}^{1} (1 - |t|) f(|k + t|) dt, where cells are q correlation lengths long; `far` is the
/// larger distance along both axes: towards r = 0 stretches become shorter where the kernel may be rough there.
fn weighted(k: usize, q: f64, far: usize) -> Vec<(f64, f64)> {
    let points = match far {
        0..=2 => POINTS,
        3..=4 => POINTS - 4,
        _ => POINTS / 2,
    };
    let rule = gauss_legendre(points).mapped(0.0, 1.0);
    let step = (1.0 / q).min(1.0);
    let count = q.ceil().clamp(1.0, REACH) as usize;
    let even: Vec<f64> = (0..count).map(|i| i as f64 * step).chain([(count as f64 * step).min(1.0)]).collect();
    let graded = || -> Vec<f64> {
        let first = even[1];
        std::iter::once(0.0)
            .chain((1..=GRADES).rev().map(|i| first * 0.5f64.powi(i)))
            .chain(even[1..].iter().copied())
            .collect()
    };
    let mut nodes = Vec::new();
    let mut stretch = |from: f64, ends: &[f64], weight: &dyn Fn(f64) -> f64| {
        for pair in ends.windows(2) {
            let h = pair[1] - pair[0];
            let at = rule.points.iter().map(|t| pair[0] + h * t);
            nodes.extend(at.zip(&rule.weights).map(|(r, w)| (from + r, h * w * weight(r))));
        }
    };
    let rough = far <= 1;
    match k {
        0 if rough => stretch(0.0, &graded(), &|r| 2.0 * (1.0 - r)),
        0 => stretch(0.0, &even, &|r| 2.0 * (1.0 - r)),
        _ => {
            match rough {
                true => stretch(0.0, &graded(), &|r| r),
                false => stretch((k - 1) as f64, &even, &|r| r),
            }
            stretch(k as f64, &even, &|r| 1.0 - r);
        }
    }
    nodes
}

/// 1 less the variance of the mean over a cell.
pub(crate) fn unresolved(covariance: &Covariance, size: [f64; 2]) -> f64 {
    1.0 - means_table(covariance, size, [1, 1])[0]
}

/// The operator b ↦ Σ_j C_ij |c| b_j: C_ij the covariance of the means over cells i and j of the body, |c| the area of a cell. Its
/// eigenvalues are those of the covariance operator on constants in each cell.
///
/// *Cost*: of a covariance that is a product 2 NX NY (NX + NY) operations, two dense products on the bounding box; else two
/// transforms on a torus twice as long as the box.
pub(crate) struct CellCovariance<'a> {
    cells: &'a FieldCells,
    body: Vec<usize>,
    matrix: OverBox,
}

/// C_ij |c| of all cells of the bounding box.
enum OverBox {
    /// Toeplitz matrices along x and y, the first one times the area of a cell.
    Product([Mat<f64>; 2]),
    /// A torus that has the entries of the box, and its table of NX × NY entries.
    Embedded { circulant: Circulant, table: Vec<f64> },
}

impl<'a> CellCovariance<'a> {
    /// The operator of a covariance.
    pub(crate) fn new(covariance: &Covariance, cells: &'a FieldCells) -> Self {
        let [nx, ny] = cells.cells;
        let matrix = if covariance.kernel.is_product() {
            let means =
                |d: usize| interval_means(covariance.kernel, covariance.correlation[d], cells.size[d], cells.cells[d]);
            let toeplitz = |d: usize, scale: f64| {
                let table = means(d);
                Mat::from_fn(table.len(), table.len(), |i, j| scale * table[i.abs_diff(j)])
            };
            OverBox::Product([toeplitz(0, cells.area()), toeplitz(1, 1.0)])
        } else {
            let mut table = means_table(covariance, cells.size, [nx, ny]);
            table.iter_mut().for_each(|entry| *entry *= cells.area());
            // places half of the way around are those of no two cells
            let entry = |i: usize, j: usize| if i < nx && j < ny { table[i * ny + j] } else { 0.0 };
            OverBox::Embedded { circulant: Circulant::new([2 * nx, 2 * ny], entry), table }
        };
        Self { cells, body: cells.body(), matrix }
    }

    /// Number of cells of the body.
    pub(crate) fn len(&self) -> usize {
        self.body.len()
    }

    /// The variance of a cell's mean times its area; the sum over all cells is the trace.
    pub(crate) fn diagonal(&self) -> f64 {
        self.entry(0, 0)
    }

    /// The entry of two cells of the body.
    pub(crate) fn entry(&self, i: usize, j: usize) -> f64 {
        let ny = self.cells.cells[1];
        let (a, b) = (self.body[i], self.body[j]);
        match &self.matrix {
            OverBox::Product([x, y]) => x[(a / ny, b / ny)] * y[(a % ny, b % ny)],
            OverBox::Embedded { table, .. } => table[(a / ny).abs_diff(b / ny) * ny + (a % ny).abs_diff(b % ny)],
        }
    }

    /// The operator on a vector of the cells of the body, on one thread.
    pub(crate) fn apply(&self, b: &[f64], out: &mut [f64]) {
        let [nx, ny] = self.cells.cells;
        match &self.matrix {
            OverBox::Product([x, y]) => {
                let mut full = vec![0.0; nx * ny];
                self.body.iter().zip(b).for_each(|(&c, b)| full[c] = *b);
                // cells lie by rows of constant ix: the transpose is column-major
                let given = MatRef::from_column_major_slice(&full, ny, nx);
                let mut half = Mat::zeros(ny, nx);
                matmul(half.as_mut(), Accum::Replace, y.as_ref(), given, 1.0, Par::Seq);
                let mut product = vec![0.0; nx * ny];
                let whole = MatMut::from_column_major_slice_mut(&mut product, ny, nx);
                matmul(whole, Accum::Replace, half.as_ref(), x.as_ref(), 1.0, Par::Seq);
                self.body.iter().zip(out).for_each(|(&c, out)| *out = product[c]);
            }
            OverBox::Embedded { circulant, .. } => {
                let place = |c: usize| c / ny * 2 * ny + c % ny;
                let mut full = vec![0.0; 4 * nx * ny];
                self.body.iter().zip(b).for_each(|(&c, b)| full[place(c)] = *b);
                let product = circulant.multiply(&full);
                self.body.iter().zip(out).for_each(|(&c, out)| *out = product[place(c)]);
            }
        }
    }
}
