//! Karhunen-Loève expansions of the means of a field over the cells of a grid.

use crate::cell_covariance::{CellCovariance, unresolved};
use crate::karhunen_loeve::{LIMIT, ROUNDOFF, check, kept};
use crate::lanczos::largest_eigenpairs;
use crate::spectrum::{Spectrum, folded_spectrum};
use crate::{Covariance, FieldCells, RectangleKarhunenLoeve, StochasticError, Truncation};

/// Most cells of a body whose eigenpairs a dense solver finds.
const DENSE: usize = 300;
/// Most modes of a body that is no rectangle, and how many are looked for first where a share is wanted.
const MODES: usize = 400;
const FIRST: usize = 25;
/// Most cells whose values are independent.
const INDEPENDENT: usize = 2048;

/// The field g_i(ξ) = Σ_m √λ_m b_m,i ξ_m: the mean of a field of variance 1 over cell i of a grid, for germs ξ_m of mean 0 and
/// variance 1 that are not correlated.
///
/// Means fit together: that over a larger cell is the mean of those over its parts. What cells do not resolve of the field is
/// known, [`unresolved`](Self::unresolved): the variance of a mean is smaller than that of a point.
///
/// *Covariances that are products, on rectangles*: λ_m and b_m are those of [`RectangleKarhunenLoeve`], b_m,i the mean of b_m
/// over the cell. *Others*: λ_m and b_m are the eigenpairs of C_ij |c|, C_ij the covariance of the means over cells i and j and
/// |c| their area; |c| Σ_i b_m,i² = 1. Signs: the first entry of more than half the largest one is positive.
///
/// *Use when* a modulus is random in each cell. *Fails when* cells are larger than a sixth of the correlation length: a tenth
/// of the variance is not resolved then. *Cost*: products on rectangles that of [`RectangleKarhunenLoeve`]; others of N cells
/// N (2 M)² 8 operations for M modes, 16 M N bytes.
///
/// Source: Ghanem and Spanos (1991), section 2.3; Vanmarcke (1983), section 5.1, for means.
#[derive(Debug, Clone, PartialEq)]
pub struct CellKarhunenLoeve {
    cells: FieldCells,
    /// λ_m, an area.
    eigenvalues: Vec<f64>,
    /// b_m in all cells of the bounding box, 0 outside of the body (1/length).
    modes: Vec<Vec<f64>>,
    /// None: values of different cells are independent.
    covariance: Option<Covariance>,
}

impl CellKarhunenLoeve {
    /// The expansion of a covariance on cells. A captured share is that of the variance of the means, and of the field itself
    /// for products on rectangles.
    ///
    /// # Errors
    /// Those of [`RectangleKarhunenLoeve::new`] for products on rectangles; else [`StochasticError::Modes`] and
    /// [`StochasticError::Captured`] where there are not enough modes.
    /// [`StochasticError::Inconsistent`] for a mask of another size than the grid.
    pub fn new(covariance: &Covariance, cells: FieldCells, truncation: Truncation) -> Result<Self, StochasticError> {
        cells.check()?;
        covariance.check()?;
        if covariance.kernel.is_product() && cells.body().len() == cells.cells[0] * cells.cells[1] {
            let sides = [0, 1].map(|d| cells.cells[d] as f64 * cells.size[d]);
            let expansion = RectangleKarhunenLoeve::new(covariance, sides, truncation)?;
            let eigenvalues = (0..expansion.len()).map(|m| expansion.eigenvalue(m)).collect();
            let modes = expansion.cell_means(cells.cells);
            return Ok(Self { cells, eigenvalues, modes, covariance: Some(*covariance) });
        }
        Self::on_mask(covariance, cells, truncation)
    }

    /// Eigenpairs of a body that is no rectangle.
    fn on_mask(covariance: &Covariance, cells: FieldCells, truncation: Truncation) -> Result<Self, StochasticError> {
        check(cells.size[0], truncation)?;
        let operator = CellCovariance::new(covariance, &cells);
        let (size, trace) = (operator.len(), operator.len() as f64 * operator.diagonal());
        let most = size.min(MODES);
        let mut wanted = match truncation {
            Truncation::Modes(wanted) if wanted > most => {
                return Err(StochasticError::Modes { wanted, available: most });
            }
            Truncation::Modes(wanted) => wanted,
            Truncation::Captured(_) => FIRST.min(most),
        };
        loop {
            let all = size <= DENSE;
            let (values, vectors) = match all {
                true => dense(&operator)?,
                false => largest_eigenpairs(size, wanted, |b, out| operator.apply(b, out))?,
            };
            let available = values.iter().take_while(|&&v| v > ROUNDOFF * values[0]).count().min(LIMIT);
            let shares: Vec<f64> = values[..available].iter().map(|v| v / trace).collect();
            match kept(&shares, truncation) {
                Ok(count) => {
                    let body = cells.body();
                    let modes = vectors[..count].iter().map(|v| over_box(&cells, &body, v)).collect();
                    let eigenvalues = values[..count].to_vec();
                    return Ok(Self { cells, eigenvalues, modes, covariance: Some(*covariance) });
                }
                Err(error) if all || wanted == most || available < wanted => return Err(error),
                Err(_) => wanted = (2 * wanted).min(most),
            }
        }
    }

    /// Values of mean 0 and variance 1 that are independent from cell to cell, one germ for each cell of the body.
    ///
    /// # Errors
    /// [`StochasticError::Inconsistent`] for a mask of another size than the grid, [`StochasticError::Modes`] for more than
    /// 2048 cells: N² numbers are kept.
    pub fn independent(cells: FieldCells) -> Result<Self, StochasticError> {
        cells.check()?;
        let body = cells.body();
        if body.len() > INDEPENDENT {
            return Err(StochasticError::Modes { wanted: body.len(), available: INDEPENDENT });
        }
        let unit = |&own: &usize| {
            let mut mode = vec![0.0; cells.cells[0] * cells.cells[1]];
            mode[own] = cells.area().sqrt().recip();
            mode
        };
        let (eigenvalues, modes) = (vec![cells.area(); body.len()], body.iter().map(unit).collect());
        Ok(Self { cells, eigenvalues, modes, covariance: None })
    }

    /// The cells.
    pub fn cells(&self) -> &FieldCells {
        &self.cells
    }

    /// Number of modes.
    pub fn len(&self) -> usize {
        self.eigenvalues.len()
    }

    /// Whether there are no modes; never true.
    pub fn is_empty(&self) -> bool {
        self.eigenvalues.is_empty()
    }

    /// λ_m, areas, falling.
    pub fn eigenvalues(&self) -> &[f64] {
        &self.eigenvalues
    }

    /// b_m in all cells of the bounding box, 0 outside of the body.
    ///
    /// # Panics
    /// If there is no mode m.
    pub fn mode(&self, m: usize) -> &[f64] {
        &self.modes[m]
    }

    /// Share of the field's variance in the means of the modes, averaged over the body.
    pub fn captured(&self) -> f64 {
        let body = self.cells.body();
        let square = |mode: &Vec<f64>| body.iter().map(|&c| mode[c] * mode[c]).sum::<f64>() / body.len() as f64;
        self.eigenvalues.iter().zip(&self.modes).map(|(value, mode)| value * square(mode)).sum::<f64>().min(1.0)
    }

    /// Share of the field's variance that means over the cells do not have, however many modes there are; 0 of independent values.
    pub fn unresolved(&self) -> f64 {
        self.covariance.as_ref().map_or(0.0, |covariance| unresolved(covariance, self.cells.size))
    }

    /// The means over cells twice as large along both axes, for the same germs. None where cells are odd in number, or where a
    /// larger one lies in the body in part.
    pub fn coarsened(&self) -> Option<Self> {
        let cells = self.cells.coarsened()?;
        let all = 0..cells.cells[0] * cells.cells[1];
        let mean = |mode: &Vec<f64>| {
            all.clone().map(|c| self.cells.parts(c).iter().map(|&i| mode[i]).sum::<f64>() / 4.0).collect()
        };
        Some(Self { modes: self.modes.iter().map(mean).collect(), cells, ..self.clone() })
    }

    /// √λ_m b_m of a cell, for all modes.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn at(&self, cell: usize) -> Vec<f64> {
        self.eigenvalues.iter().zip(&self.modes).map(|(value, mode)| value.sqrt() * mode[cell]).collect()
    }

    /// g_i(ξ) of all cells of the bounding box.
    ///
    /// # Panics
    /// If there is not one germ a mode.
    pub fn values(&self, germs: &[f64]) -> Vec<f64> {
        assert_eq!(germs.len(), self.len(), "one germ a mode");
        let mut values = vec![0.0; self.cells.cells[0] * self.cells.cells[1]];
        for ((value, mode), germ) in self.eigenvalues.iter().zip(&self.modes).zip(germs) {
            let factor = value.sqrt() * germ;
            values.iter_mut().zip(mode).for_each(|(v, b)| *v += factor * b);
        }
        values
    }
}

/// All eigenpairs, of length 1.
fn dense(operator: &CellCovariance<'_>) -> Result<(Vec<f64>, Vec<Vec<f64>>), StochasticError> {
    let images: Vec<_> = (0..operator.len()).map(|i| vec![(i, 1.0)]).collect();
    let Spectrum { values, vectors } = folded_spectrum(&images, |i, j| operator.entry(i, j))?;
    Ok((values, vectors))
}

/// A vector of the body's cells as a mode of the bounding box, with its sign and length.
fn over_box(cells: &FieldCells, body: &[usize], vector: &[f64]) -> Vec<f64> {
    let largest = vector.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let first = vector.iter().copied().find(|v| v.abs() > 0.5 * largest).unwrap_or(1.0);
    let scale = first.signum() / cells.area().sqrt();
    let mut mode = vec![0.0; cells.cells[0] * cells.cells[1]];
    body.iter().zip(vector).for_each(|(&c, v)| mode[c] = scale * v);
    mode
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use steklov_algebra::dot;

    use super::*;
    use crate::Kernel;

    const KERNELS: [Kernel; 3] = [Kernel::Exponential, Kernel::Gaussian, Kernel::Matern { smoothness: 1.0 }];

    /// The unit square without its upper right quarter, of n × n cells.
    fn corner(n: usize) -> FieldCells {
        let inside = (0..n * n).map(|c| c / n < n / 2 || c % n < n / 2).collect();
        FieldCells { cells: [n; 2], size: [1.0 / n as f64; 2], inside: Some(inside) }
    }

    fn covariance(kernel: Kernel, correlation: f64) -> Covariance {
        Covariance { kernel, correlation: [correlation; 2] }
    }

    /// On rectangles the same as the expansion on larger cells; larger cells that lie in the body in part have no means.
    #[test]
    fn coarsened_fields_are_those_of_larger_cells() {
        for kernel in [Kernel::Exponential, Kernel::Gaussian] {
            let own = Covariance { kernel, correlation: [0.7, 0.3] };
            let cells =
                |n: usize| FieldCells { cells: [3 * n, 2 * n], size: [0.25 / n as f64, 0.5 / n as f64], inside: None };
            let fine = CellKarhunenLoeve::new(&own, cells(4), Truncation::Modes(7)).unwrap();
            let coarse = CellKarhunenLoeve::new(&own, cells(2), Truncation::Modes(7)).unwrap();
            let means = fine.coarsened().expect("even numbers of cells");
            assert_eq!(means.cells().cells, [6, 4]);
            assert!((means.unresolved() - coarse.unresolved()).abs() < 1e-12, "{kernel:?}");
            for (a, b) in means.modes.iter().zip(&coarse.modes) {
                assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-11), "{kernel:?}: {a:?} {b:?}");
            }
            assert!(means.coarsened().is_some_and(|m| m.cells().cells == [3, 2] && m.coarsened().is_none()));
        }
        let cells = corner(4);
        let corner =
            CellKarhunenLoeve::new(&covariance(Kernel::Exponential, 0.5), cells, Truncation::Modes(3)).unwrap();
        let two = corner.coarsened().expect("a quarter of four");
        assert_eq!(two.cells().inside, Some(vec![true, true, true, false]));
        assert!(two.coarsened().is_none(), "one cell is in the body in part");
    }

    #[test]
    fn lanczos_finds_the_pairs_of_a_dense_solver() {
        for (kernel, correlation) in KERNELS.into_iter().flat_map(|k| [(k, 0.5), (k, 0.1)]) {
            let cells = corner(32);
            let operator = CellCovariance::new(&covariance(kernel, correlation), &cells);
            let (all, _) = dense(&operator).unwrap();
            let (few, vectors) = largest_eigenpairs(operator.len(), 100, |b, out| operator.apply(b, out)).unwrap();
            for (m, (a, b)) in all.iter().zip(&few).enumerate() {
                assert!((a - b).abs() < 1e-12 * all[0], "{kernel:?} {correlation}: {a} {b} of mode {m}");
            }
            for (i, v) in vectors.iter().enumerate() {
                for (j, w) in vectors.iter().enumerate() {
                    assert!((dot(v, w) - f64::from(u8::from(i == j))).abs() < 1e-12, "{i} {j}");
                }
            }
        }
    }

    /// On 128 × 128 cells every pair has a small residual, and the values are those of an independent computation by FFT and
    /// ARPACK.
    #[test]
    fn pairs_of_a_fine_grid_have_small_residuals() {
        let cells = corner(128);
        let given = covariance(Kernel::Exponential, 0.5);
        let kl = CellKarhunenLoeve::new(&given, cells.clone(), Truncation::Modes(100)).unwrap();
        let expected = [
            (1, 0.26666730819437845),
            (2, 0.10705777001231684),
            (3, 0.06464549080321812),
            (10, 0.010995256464000038),
            (50, 0.0008011453671299252),
            (100, 0.0002435452173361201),
        ];
        for (m, value) in expected {
            assert!((kl.eigenvalues()[m - 1] - value).abs() < 1e-12, "{m}: {}", kl.eigenvalues()[m - 1]);
        }
        assert!(
            (kl.captured() - 0.9541960437762755).abs() < 1e-11
                && (kl.unresolved() - 0.010349187508293056).abs() < 1e-14
        );
        let operator = CellCovariance::new(&given, &cells);
        let body = cells.body();
        for m in 0..100 {
            let mode: Vec<f64> = body.iter().map(|&c| kl.mode(m)[c] * cells.area().sqrt()).collect();
            let mut product = vec![0.0; mode.len()];
            operator.apply(&mode, &mut product);
            let off: f64 = product.iter().zip(&mode).map(|(p, b)| (p - kl.eigenvalues()[m] * b).powi(2)).sum();
            assert!(off.sqrt() < 1e-10 * kl.eigenvalues()[0], "mode {m}: {}", off.sqrt());
        }
    }

    /// A square ring has eigenvalues of multiplicity two; so have two equal bodies far from each other.
    #[test]
    fn equal_eigenvalues_are_all_found() {
        let n = 24;
        let hole = |c: usize| [c / n, c % n].iter().all(|k| (8..16).contains(k));
        let ring = FieldCells {
            cells: [n; 2],
            size: [1.0 / n as f64; 2],
            inside: Some((0..n * n).map(|c| !hole(c)).collect()),
        };
        let halves = FieldCells {
            cells: [200, 4],
            size: [0.01; 2],
            inside: Some((0..800).map(|c| !(80..120).contains(&(c / 4))).collect()),
        };
        for (cells, correlation) in [(ring, 0.3), (halves, 0.02)] {
            let operator = CellCovariance::new(&covariance(Kernel::Exponential, correlation), &cells);
            let (all, _) = dense(&operator).unwrap();
            let (few, _) = largest_eigenpairs(operator.len(), 60, |b, out| operator.apply(b, out)).unwrap();
            let off = all.iter().zip(&few).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-12 * all[0], "{off}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        /// A smooth covariance has an operator of low rank: the basis runs out of directions.
        #[test]
        fn any_number_of_pairs_can_be_had(n in 4usize..24, wanted in 1usize..200, correlation in 0.05..50.0) {
            let cells = corner(2 * (n / 2));
            let operator = CellCovariance::new(&covariance(Kernel::Gaussian, correlation), &cells);
            let (all, _) = dense(&operator).unwrap();
            let (few, vectors) = largest_eigenpairs(operator.len(), wanted, |b, out| operator.apply(b, out)).unwrap();
            prop_assert_eq!(few.len(), wanted.min(operator.len()));
            prop_assert_eq!(vectors.len(), few.len());
            for (a, b) in all.iter().zip(&few) {
                prop_assert!((a - b).abs() < 1e-11 * all[0], "{} {}", a, b);
            }
        }
    }
}
