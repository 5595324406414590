//! Which coarse cells share a basis: those whose materials, and the materials around them on which their basis depends, have
//! one pattern.

use std::collections::HashMap;

use rayon::prelude::*;

use crate::basis::{Basis, Patch};
use crate::multiscale::{BATCH, Multiscale};

impl Multiscale<'_> {
    /// Moduli of a bar along the lower, right, upper and left edge of a coarse cell: the harmonic mean of the two fine cells at
    /// each fine side, or that of the one cell in the body.
    pub(crate) fn edge_moduli(&self, cell: usize) -> [Vec<f64>; 4] {
        let grid = &self.body.grid;
        let [nx, ny] = grid.cells;
        let ([i, j], [m, n]) = (self.mesh.cells[cell].first, self.mesh.cells[cell].size);
        let young = |ix: Option<usize>, iy: Option<usize>| {
            let (ix, iy) = (ix.filter(|ix| *ix < nx)?, iy.filter(|iy| *iy < ny)?);
            grid.inside(ix, iy).then(|| self.body.bar_modulus(ix * ny + iy))
        };
        let mean = |a: Option<f64>, b: Option<f64>| match (a, b) {
            (Some(a), Some(b)) => 2.0 / (1.0 / a + 1.0 / b),
            (one, other) => one.or(other).unwrap_or_else(|| unreachable!("one of both cells is in the body")),
        };
        let row =
            |j: usize| (i..i + m).map(|i| mean(young(Some(i), j.checked_sub(1)), young(Some(i), Some(j)))).collect();
        let column =
            |i: usize| (j..j + n).map(|j| mean(young(i.checked_sub(1), Some(j)), young(Some(i), Some(j)))).collect();
        [row(j), column(i + m), row(j + n), column(i)]
    }

    /// The materials on which the basis of a cell depends.
    pub(crate) fn patch(&self, cell: usize) -> Patch {
        let grid = &self.body.grid;
        let [nx, ny] = grid.cells;
        let ([i, j], inner) = (self.mesh.cells[cell].first, self.mesh.cells[cell].size);
        let (mut low, mut high) = ([i, j], [i + inner[0], j + inner[1]]);
        if let Basis::Oversampled(extra) = self.basis {
            // first along x, then along y over the whole width; dropped cells stop it
            let column = |ix: usize| (j..j + inner[1]).all(|iy| grid.inside(ix, iy));
            while low[0] > 0 && i - low[0] < extra && column(low[0] - 1) {
                low[0] -= 1;
            }
            while high[0] < nx && high[0] - i - inner[0] < extra && column(high[0]) {
                high[0] += 1;
            }
            let [from, to] = [low[0], high[0]];
            let row = |iy: usize| (from..to).all(|ix| grid.inside(ix, iy));
            while low[1] > 0 && j - low[1] < extra && row(low[1] - 1) {
                low[1] -= 1;
            }
            while high[1] < ny && high[1] - j - inner[1] < extra && row(high[1]) {
                high[1] += 1;
            }
        }
        let size = [high[0] - low[0], high[1] - low[1]];
        let cell_at = |c: usize| (low[0] + c / size[1]) * ny + low[1] + c % size[1];
        Patch {
            size,
            cells: (0..size[0] * size[1]).map(cell_at).collect(),
            first: [i - low[0], j - low[1]],
            inner,
            edges: (self.basis == Basis::Oscillatory).then(|| self.edge_moduli(cell)),
        }
    }

    /// The common key of cells with equal bases: sizes, moduli up to a factor, and Poisson's ratios where they differ.
    fn key(&self, cell: usize) -> Vec<u64> {
        let patch = self.patch(cell);
        let reference = self.reference(cell);
        let sizes = [patch.size, patch.first, patch.inner].into_iter().flatten().map(|n| n as u64);
        let young = patch.cells.iter().map(|&c| self.body.young[c]);
        let moduli = young.chain(patch.edges.iter().flatten().flatten().copied());
        let ratios =
            self.body.poisson().into_iter().flat_map(|ratios| patch.cells.iter().map(|&c| ratios[c].to_bits()));
        sizes.chain(moduli.map(|e| (e / reference).to_bits())).chain(ratios).collect()
    }

    /// The modulus to which those of a cell are referred: that of its lower left fine cell.
    pub(crate) fn reference(&self, cell: usize) -> f64 {
        let [i, j] = self.mesh.cells[cell].first;
        self.body.young[i * self.body.grid.cells[1] + j]
    }

    /// Finds the cells of each pattern.
    pub(crate) fn find_patterns(&mut self) {
        let mut known: HashMap<Vec<u64>, usize> = HashMap::new();
        let count = self.mesh.cells.len();
        for first in (0..count).step_by(BATCH) {
            let batch: Vec<_> = (first..(first + BATCH).min(count)).into_par_iter().map(|c| self.key(c)).collect();
            for (cell, key) in (first..).zip(batch) {
                let next = known.len();
                let number = *known.entry(key).or_insert(next);
                if number == next {
                    self.patterns.push(Vec::new());
                }
                self.patterns[number].push(cell);
            }
        }
    }
}
