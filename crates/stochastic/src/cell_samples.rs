//! Fields of cells that are drawn as a whole, without truncation.

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::cell_covariance::{means_table, unresolved};
use crate::circulant::Circulant;
use crate::sampling::uniform;
use crate::{Covariance, FieldCells, StochasticError};

/// Share of the eigenvalues of an embedding that may be negative.
const NEGATIVE: f64 = 1e-8;
/// Most places of an embedding along one axis, over the cells there, and most of all places.
const LONGEST: usize = 16;
const PLACES: usize = 1 << 24;

/// The means of a field over the cells of a grid, or values that are independent from cell to cell, as outcomes that are drawn
/// as a whole. An outcome has one germ, any draw from the law of a value over its deviation: the field is a function of its
/// bits. The germ 0 stands for the mean, 0 in every cell.
///
/// *Correlated values* are normal: H √(λ/M) ξ for the covariance of the means on a torus of M places, at least twice as long as
/// the grid, and M independent normal numbers ξ. *Independent values* are normal or uniform.
///
/// *Use when* samples are taken and a Karhunen-Loève expansion would need very many modes. *Fails when* the answer is to be a
/// polynomial of the germs. Long correlation of a smooth field takes a torus of up to 16 times the grid; then few modes suffice.
/// *Cost*: an outcome two transforms, about 100 M operations.
///
/// Source: Dietrich and Newsam, SIAM J. Sci. Comput. 18 (1997), section 2.
#[derive(Debug, Clone)]
pub struct CellSamples {
    cells: FieldCells,
    drawn: Arc<Drawn>,
    /// Cells that are drawn along either side of one of the cells.
    parts: usize,
    unresolved: f64,
}

/// The cells of which values are drawn.
#[derive(Debug)]
enum Drawn {
    Embedded { circulant: Circulant, covariance: Covariance },
    Independent { normal: bool },
}

impl CellSamples {
    /// Normal means of a covariance over cells.
    ///
    /// # Errors
    /// [`StochasticError::Number`] for lengths that are not positive, [`StochasticError::Inconsistent`] for a mask of another size
    /// than the grid, [`StochasticError::Embedding`] where no torus within the limits has a covariance.
    pub fn new(covariance: &Covariance, cells: FieldCells) -> Result<Self, StochasticError> {
        cells.check()?;
        covariance.check()?;
        let mut times = 2;
        loop {
            let size = cells.cells.map(|n| times * n);
            if times > LONGEST || size[0].saturating_mul(size[1]) > PLACES {
                return Err(StochasticError::Embedding { times: times / 2 });
            }
            let half = size.map(|m| m / 2 + 1);
            let table = means_table(covariance, cells.size, half);
            let circulant = Circulant::new(size, |i, j| table[i * half[1] + j]);
            let of_sign = |sign: f64| circulant.eigenvalues().iter().map(|v| (sign * v).max(0.0)).sum::<f64>();
            if of_sign(-1.0) <= NEGATIVE * of_sign(1.0) {
                let drawn = Arc::new(Drawn::Embedded { circulant, covariance: *covariance });
                let unresolved = unresolved(covariance, cells.size);
                return Ok(Self { cells, drawn, parts: 1, unresolved });
            }
            times *= 2;
        }
    }

    /// Independent values of mean 0 and variance 1, normal or uniform between -√3 and √3.
    ///
    /// # Errors
    /// [`StochasticError::Inconsistent`] for a mask of another size than the grid, [`StochasticError::Number`] for lengths that
    /// are not positive.
    pub fn independent(cells: FieldCells, normal: bool) -> Result<Self, StochasticError> {
        cells.check()?;
        Ok(Self { cells, drawn: Arc::new(Drawn::Independent { normal }), parts: 1, unresolved: 0.0 })
    }

    /// The cells.
    pub fn cells(&self) -> &FieldCells {
        &self.cells
    }

    /// Share of the field's variance that the values do not have: that of means over cells, or over several independent values.
    pub fn unresolved(&self) -> f64 {
        self.unresolved
    }

    /// The values in all cells of the bounding box.
    pub fn values(&self, germ: f64) -> Vec<f64> {
        let [nx, ny] = self.cells.cells.map(|n| n * self.parts);
        let drawn = if germ == 0.0 { vec![0.0; nx * ny] } else { self.draw(germ.to_bits(), [nx, ny]) };
        let mut values = vec![0.0; self.cells.cells[0] * self.cells.cells[1]];
        let share = 1.0 / (self.parts * self.parts) as f64;
        for (k, value) in drawn.into_iter().enumerate() {
            values[k / ny / self.parts * self.cells.cells[1] + k % ny / self.parts] += share * value;
        }
        values
    }

    fn draw(&self, seed: u64, [nx, ny]: [usize; 2]) -> Vec<f64> {
        match &*self.drawn {
            Drawn::Independent { normal: true } => normals(seed, nx * ny),
            Drawn::Independent { normal: false } => {
                let bound = 3f64.sqrt();
                (0..(nx * ny) as u64).map(|k| bound * (2.0 * uniform(seed, k, 0) - 1.0)).collect()
            }
            Drawn::Embedded { circulant, .. } => {
                let eigenvalues = circulant.eigenvalues();
                let places = eigenvalues.len();
                let mut xi = normals(seed, places);
                let root = |value: f64| (value.max(0.0) / places as f64).sqrt();
                xi.iter_mut().zip(eigenvalues).for_each(|(xi, value)| *xi *= root(*value));
                let all = circulant.hartley(&xi);
                let along = circulant.size()[1];
                (0..nx).flat_map(|i| all[i * along..][..ny].iter().copied()).collect()
            }
        }
    }

    /// The means over cells twice as large along both axes, for the same germs. None where cells are odd in number, or where a
    /// larger one lies in the body in part.
    pub fn coarsened(&self) -> Option<Self> {
        let (cells, parts) = (self.cells.coarsened()?, 2 * self.parts);
        let unresolved = match &*self.drawn {
            Drawn::Embedded { covariance, .. } => unresolved(covariance, cells.size),
            Drawn::Independent { .. } => 1.0 - 1.0 / (parts * parts) as f64,
        };
        Some(Self { cells, drawn: self.drawn.clone(), parts, unresolved })
    }

    /// The same law of values, drawn on a torus of their own cells instead of the smaller ones whose means they are: other outcomes
    /// of the germs at a lower cost. None for values that are no such means, or where there is no torus.
    pub fn redrawn(&self) -> Option<Self> {
        match &*self.drawn {
            Drawn::Embedded { covariance, .. } if self.parts > 1 => Self::new(covariance, self.cells.clone()).ok(),
            _ => None,
        }
    }
}

/// Independent normal numbers.
///
/// Source: Box and Muller, Ann. Math. Statist. 29 (1958).
fn normals(seed: u64, count: usize) -> Vec<f64> {
    let pair = |k: u64| {
        let radius = (-2.0 * libm::log(uniform(seed, k, 0))).sqrt();
        let (sine, cosine) = libm::sincos(TAU * uniform(seed, k, 1));
        [radius * cosine, radius * sine]
    };
    (0..count.div_ceil(2) as u64).flat_map(pair).take(count).collect()
}
