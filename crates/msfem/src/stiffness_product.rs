//! K u without a stored K.

use rayon::prelude::*;

use crate::HeterogeneousBody;

/// Rows of cells in a band.
const ROWS: usize = 8;

/// Cells across times bands from which threads are worth their start.
const MANY: usize = 4096;

/// Some rows of cells, and the forces on the nodes of its upper row, which the next band has as well.
struct Band<'a> {
    rows: std::ops::Range<usize>,
    /// The first node.
    first: usize,
    /// The forces on the nodes below the upper row.
    own: &'a mut [f64],
    upper: Vec<f64>,
}

impl HeterogeneousBody {
    /// K u: the forces on the nodes (force per thickness) that hold the displacement u (length), two each.
    ///
    /// Cost: 130 operations a cell; the same bits for any number of threads.
    pub fn multiply(&self, u: &[f64], product: &mut [f64]) {
        let [_, ny] = self.grid.cells;
        // nodes rise along x, row by row
        let below = |row: usize| self.grid.nodes_below(row);
        product.fill(0.0);
        let (mut bands, mut rest) = (Vec::new(), &mut product[..]);
        for low in (0..ny).step_by(ROWS) {
            let rows = low..(low + ROWS).min(ny);
            let first = below(low);
            let (own, behind) = rest.split_at_mut(2 * (below(rows.end) - first));
            let upper = vec![0.0; 2 * (below(rows.end + 1) - below(rows.end))];
            bands.push(Band { rows, first, own, upper });
            rest = behind;
        }
        let arch = pulp::Arch::new();
        let add = |band: &mut Band<'_>| arch.dispatch(|| self.add_band(u, band));
        if bands.len() * self.grid.cells[0] < MANY {
            bands.iter_mut().for_each(add);
        } else {
            bands.par_iter_mut().for_each(add);
        }
        let upper: Vec<Vec<f64>> = bands.into_iter().map(|band| band.upper).collect();
        for (low, forces) in (0..ny).step_by(ROWS).zip(upper) {
            let first = 2 * below((low + ROWS).min(ny));
            product[first..].iter_mut().zip(forces).for_each(|(sum, force)| *sum += force);
        }
    }

    /// cᵀ (K u) at one node as weights of the nodal values of u in the cells around it.
    pub fn weights_at(&self, node: usize, c: [f64; 2]) -> Vec<([usize; 4], [f64; 8])> {
        let of_cell = |(cell, a): (usize, usize)| {
            let mut own = [[0.0; 8]; 8];
            let (unit, young) = (self.unit_of(cell, &mut own), self.young[cell]);
            let weight = |b: usize| young * (c[0] * unit[2 * a][b] + c[1] * unit[2 * a + 1][b]);
            (self.grid.cell_nodes(cell), std::array::from_fn(weight))
        };
        self.around(node).into_iter().flatten().map(of_cell).collect()
    }

    #[inline(always)]
    fn add_band(&self, u: &[f64], band: &mut Band<'_>) {
        let [nx, ny] = self.grid.cells;
        for iy in band.rows.clone() {
            for cell in (0..nx).filter(|&ix| self.grid.inside(ix, iy)).map(|ix| ix * ny + iy) {
                let (nodes, mut own) = (self.grid.cell_nodes(cell), [[0.0; 8]; 8]);
                let (unit, young) = (self.unit_of(cell, &mut own), self.young[cell]);
                // by columns, whose eight sums go on side by side; K is symmetric
                let mut forces = [0.0; 8];
                for (a, column) in unit.iter().enumerate() {
                    let value = young * u[2 * nodes[a / 2] + a % 2];
                    forces.iter_mut().zip(column).for_each(|(force, k)| *force += k * value);
                }
                for (node, force) in nodes.iter().zip(forces.chunks_exact(2)) {
                    let at = 2 * (node - band.first);
                    let inside = band.own.len();
                    let sum = if at < inside { &mut band.own[at..at + 2] } else { &mut band.upper[at - inside..][..2] };
                    sum.iter_mut().zip(force).for_each(|(sum, force)| *sum += force);
                }
            }
        }
    }
}
