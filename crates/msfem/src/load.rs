//! Loads, cell by cell: what a coarse cell carries of them must not depend on its neighbours.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::Medium;
use crate::elasticity::{GAUSS, shape};

/// Nodal forces of cells (force per thickness), in the order of the local unknowns. A node's load is the sum over its cells.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Loads {
    /// Tractions: cells at the boundary.
    pub boundary: BTreeMap<usize, [f64; 8]>,
    /// Body force: every cell of the bounding box, or none of them.
    pub body: Vec<[f64; 8]>,
}

impl Loads {
    /// Adds the moments ∫ t φ over one side of a cell (0 lower, 1 right, 2 upper, 3 left) against the functions of its two
    /// ends, the end first that comes first counter-clockwise.
    pub fn add_side(&mut self, cell: usize, side: usize, moments: [[f64; 2]; 2]) {
        let load = self.boundary.entry(cell).or_default();
        for (local, moment) in [side, (side + 1) % 4].into_iter().zip(moments) {
            (0..2).for_each(|i| load[2 * local + i] += moment[i]);
        }
    }

    /// A body force (force per area), integrated by 2×2 Gauss points a cell.
    pub fn set_body_force(&mut self, medium: &Medium, force: impl Fn([f64; 2]) -> [f64; 2] + Sync) {
        let grid = &medium.grid;
        let [hx, hy] = grid.spacing;
        let ny = grid.cells[1];
        let at = |cell: usize| {
            let mut load = [0.0; 8];
            if grid.inside(cell / ny, cell % ny) {
                let [x, y] = grid.lattice_point(grid.cell(cell));
                for xi in GAUSS {
                    for eta in GAUSS {
                        let f = force([x + hx * xi, y + hy * eta]);
                        for (a, phi) in shape([xi, eta]).into_iter().enumerate() {
                            (0..2).for_each(|i| load[2 * a + i] += 0.25 * hx * hy * phi * f[i]);
                        }
                    }
                }
            }
            load
        };
        self.body = (0..grid.cells[0] * ny).into_par_iter().map(at).collect();
    }

    /// The load of a cell; zero where nothing acts.
    pub fn cell(&self, cell: usize) -> [f64; 8] {
        let mut load = self.body.get(cell).copied().unwrap_or_default();
        if let Some(boundary) = self.boundary.get(&cell) {
            (0..8).for_each(|i| load[i] += boundary[i]);
        }
        load
    }

    /// The load of all unknowns of the fine grid.
    pub fn nodal(&self, medium: &Medium) -> Vec<f64> {
        let mut nodal = vec![0.0; medium.grid.dofs()];
        let mut add = |cell: usize, load: &[f64; 8]| {
            for (a, node) in medium.grid.cell_nodes(cell).into_iter().enumerate() {
                (0..2).for_each(|i| nodal[2 * node + i] += load[2 * a + i]);
            }
        };
        if !self.body.is_empty() {
            medium.grid.body_cells().for_each(|cell| add(cell, &self.body[cell]));
        }
        self.boundary.iter().for_each(|(cell, load)| add(*cell, load));
        nodal
    }
}
