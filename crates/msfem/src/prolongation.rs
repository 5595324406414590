//! The maps from coarse unknowns to fine ones, as matrices.

use std::borrow::Cow;

use sprs::{CsMat, TriMat};

use crate::local::nodes;
use crate::{CellBasis, MsfemError, Multiscale};

impl Multiscale<'_> {
    /// The pattern of each coarse cell: cells of one pattern share a basis.
    pub fn pattern_of_cells(&self) -> Vec<usize> {
        let mut pattern = vec![0; self.mesh.cells.len()];
        for (number, cells) in self.patterns.iter().enumerate() {
            cells.iter().for_each(|&c| pattern[c] = number);
        }
        pattern
    }

    /// The coarse cells of a pattern; its basis is that of the first one.
    pub fn cells_of(&self, pattern: usize) -> &[usize] {
        &self.patterns[pattern]
    }

    /// The basis of a pattern, with K_T^H for the moduli of its first cell.
    ///
    /// # Errors
    /// As [`Self::cell_basis`].
    pub fn pattern_basis(&self, pattern: usize) -> Result<Cow<'_, CellBasis>, MsfemError> {
        match self.kept.get(pattern) {
            Some(Some(basis)) => Ok(Cow::Borrowed(basis)),
            _ => self.cell_basis(self.patterns[pattern][0]).map(Cow::Owned),
        }
    }

    /// The moduli of a coarse cell over those of the first one of its pattern: K_T^H is the pattern's times this factor.
    pub fn modulus_factor(&self, cell: usize, pattern: usize) -> f64 {
        self.reference(cell) / self.reference(self.patterns[pattern][0])
    }

    /// C: from the unknowns to the displacements 2·vertex + component of all vertices, those that hang included.
    pub fn vertex_matrix(&self) -> CsMat<f64> {
        let mut entries = TriMat::new((2 * self.mesh.vertices.len(), self.dofs()));
        for (row, combination) in self.combinations.iter().flatten().enumerate() {
            combination.iter().for_each(|&(unknown, weight)| entries.add_triplet(row, unknown, weight));
        }
        entries.to_csr()
    }

    /// P: from the unknowns to the displacement of the fine nodes; where cells meet, the mean of their values. With a
    /// conforming basis they agree, and Pᵀ K P is the coarse stiffness, K being that of the fine grid.
    ///
    /// # Errors
    /// As [`Self::cell_basis`].
    pub fn prolongation(&self) -> Result<CsMat<f64>, MsfemError> {
        let grid = &self.body.grid;
        let mut count = vec![0u8; grid.nodes()];
        self.mesh.cells.iter().flat_map(|cell| cell.fine_nodes(grid)).for_each(|node| count[node] += 1);
        let rows: usize = self.mesh.cells.iter().map(|cell| 2 * nodes(cell.size)).sum();
        let mut entries = TriMat::with_capacity((grid.dofs(), self.dofs()), 8 * rows);
        for (pattern, cells) in self.patterns.iter().enumerate() {
            let basis = self.pattern_basis(pattern)?;
            for &cell in cells {
                let corners = self.mesh.corners[cell];
                for (local, node) in self.mesh.cells[cell].fine_nodes(grid).enumerate() {
                    for k in 0..2 {
                        let row = &basis.values[2 * local + k];
                        for (a, value) in row.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                            for &(unknown, weight) in &self.combinations[corners[a / 2]][a % 2] {
                                entries.add_triplet(2 * node + k, unknown, weight * value / f64::from(count[node]));
                            }
                        }
                    }
                }
            }
        }
        Ok(entries.to_csr())
    }
}
