//! Sums of stiffness matrices of several moduli, of either sign, times a vector for each.

use crate::HeterogeneousBody;

impl HeterogeneousBody {
    /// Σ_m E_m v_m at the eight unknowns of a cell: `moduli` has E_m of every cell, `fields` the v_m.
    pub fn mixed_values(&self, cell: usize, moduli: &[&[f64]], fields: &[&[f64]]) -> [f64; 8] {
        let nodes = self.grid.cell_nodes(cell);
        let mut mixed = [0.0; 8];
        for (young, v) in moduli.iter().zip(fields) {
            let young = young[cell];
            mixed.iter_mut().enumerate().for_each(|(a, out)| *out += young * v[2 * nodes[a / 2] + a % 2]);
        }
        mixed
    }

    /// Stress xx, yy, xy of Σ_m E_m ε(v_m) at a local point of a cell, from [`HeterogeneousBody::mixed_values`]; the moduli of
    /// the body itself do not count.
    pub fn mixed_stress(&self, cell: usize, mixed: &[f64; 8], at: [f64; 2]) -> [f64; 3] {
        self.elasticity_of(cell).stress(1.0, mixed, at, self.grid.spacing)
    }

    /// Σ_m K_m v_m (force per thickness at each unknown), K_m the stiffness of the moduli E_m, which may be negative: one product
    /// with the matrix of a cell whatever their number.
    pub fn mixed_forces(&self, moduli: &[&[f64]], fields: &[&[f64]], out: &mut [f64]) {
        out.fill(0.0);
        for cell in self.grid.body_cells() {
            let (mixed, nodes) = (self.mixed_values(cell, moduli, fields), self.grid.cell_nodes(cell));
            let mut own = [[0.0; 8]; 8];
            for (a, row) in self.unit_of(cell, &mut own).iter().enumerate() {
                out[2 * nodes[a / 2] + a % 2] += row.iter().zip(&mixed).map(|(k, v)| k * v).sum::<f64>();
            }
        }
    }
}
