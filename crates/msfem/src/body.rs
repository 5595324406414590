//! A heterogeneous body: a grid, Young's modulus in each cell, and the bilinear elements on it.

use rayon::prelude::*;
use sprs::CsMat;

use crate::elasticity::Elasticity;
use crate::{Grid, MsfemError};

/// A body of cells with a Young's modulus each, and one Poisson's ratio or one for each cell.
#[derive(Debug, Clone)]
pub struct HeterogeneousBody {
    /// The cells.
    pub grid: Grid,
    /// E of each cell (stress), dropped ones included.
    pub young: Vec<f64>,
    /// Poisson's ratio and plane; the ratio of cells that have none of their own.
    pub elasticity: Elasticity,
    /// ν of each cell, dropped ones included, where cells differ in it.
    poisson: Option<Vec<f64>>,
    /// K₀ of a cell, and its parts of λ and μ alone.
    unit: [[f64; 8]; 8],
    parts: [[[f64; 8]; 8]; 2],
}

impl HeterogeneousBody {
    /// A body of these cells.
    ///
    /// # Errors
    /// [`MsfemError::Inconsistent`] for another number of moduli than cells, [`MsfemError::Modulus`] for one in the body
    /// that is not positive and finite.
    pub fn new(grid: Grid, young: Vec<f64>, elasticity: Elasticity) -> Result<Self, MsfemError> {
        let [nx, ny] = grid.cells;
        if young.len() != nx * ny {
            let what = format!("{} moduli for {nx} by {ny} cells", young.len());
            return Err(MsfemError::Inconsistent { what });
        }
        if let Some(cell) = grid.body_cells().find(|&c| !(young[c] >= f64::MIN_POSITIVE && young[c].is_finite())) {
            let value = young[cell];
            return Err(MsfemError::Modulus { cell: grid.cell(cell), centre: grid.centre(cell), value });
        }
        let unit = elasticity.unit_stiffness(grid.spacing);
        let parts = Elasticity::parts_of_stiffness(grid.spacing);
        Ok(Self { grid, young, elasticity, poisson: None, unit, parts })
    }

    /// The body with a Poisson's ratio of its own in each cell, dropped ones included.
    ///
    /// # Errors
    /// [`MsfemError::Inconsistent`] for another number of ratios than cells, [`MsfemError::Poisson`] for one in the body outside
    /// of (-1, 1/2).
    pub fn with_poisson(self, poisson: Vec<f64>) -> Result<Self, MsfemError> {
        if poisson.len() != self.young.len() {
            let what = format!("{} Poisson's ratios for {} cells", poisson.len(), self.young.len());
            return Err(MsfemError::Inconsistent { what });
        }
        self.grid.body_cells().try_for_each(|c| Elasticity::new(poisson[c], self.elasticity.plane).map(drop))?;
        Ok(Self { poisson: Some(poisson), ..self })
    }

    /// ν of each cell, if they differ in it.
    pub fn poisson(&self) -> Option<&[f64]> {
        self.poisson.as_deref()
    }

    /// Poisson's ratio and plane of a cell.
    pub fn elasticity_of(&self, cell: usize) -> Elasticity {
        match &self.poisson {
            Some(poisson) => Elasticity { poisson: poisson[cell], ..self.elasticity },
            None => self.elasticity,
        }
    }

    /// K₀ = λ K_λ + μ K_μ of a cell, for E = 1.
    pub(crate) fn unit_of<'a>(&'a self, cell: usize, own: &'a mut [[f64; 8]; 8]) -> &'a [[f64; 8]; 8] {
        if self.poisson.is_none() {
            return &self.unit;
        }
        let [lambda, mu] = self.elasticity_of(cell).unit_lame();
        let [of_lambda, of_mu] = &self.parts;
        *own = std::array::from_fn(|a| std::array::from_fn(|b| lambda * of_lambda[a][b] + mu * of_mu[a][b]));
        own
    }

    /// The stiffness matrices of some cells.
    pub(crate) fn matrices(&self, cells: &[usize]) -> CellMatrices {
        let own = |&cell: &usize| *self.unit_of(cell, &mut [[0.0; 8]; 8]);
        let units = if self.poisson.is_some() { cells.iter().map(own).collect() } else { vec![self.unit] };
        CellMatrices { young: cells.iter().map(|&cell| self.young[cell]).collect(), units }
    }

    /// The modulus of a bar along a side of a cell: E/(1-ν²) where cells differ in ν, else E, which differs from it by one factor
    /// for all.
    pub(crate) fn bar_modulus(&self, cell: usize) -> f64 {
        match &self.poisson {
            Some(poisson) => self.young[cell] / (1.0 - poisson[cell] * poisson[cell]),
            None => self.young[cell],
        }
    }

    /// The stress at a local point of a cell with these displacements.
    pub fn stress(&self, cell: usize, u: &[f64; 8], at: [f64; 2]) -> [f64; 3] {
        self.elasticity_of(cell).stress(self.young[cell], u, at, self.grid.spacing)
    }

    /// The eight displacements of a cell.
    pub fn cell_values(&self, u: &[f64], cell: usize) -> [f64; 8] {
        let n = self.grid.cell_nodes(cell);
        std::array::from_fn(|a| u[2 * n[a / 2] + a % 2])
    }

    /// K_e u of a cell.
    pub(crate) fn cell_forces(&self, cell: usize, u: &[f64; 8]) -> [f64; 8] {
        let mut own = [[0.0; 8]; 8];
        self.unit_of(cell, &mut own).map(|row| self.young[cell] * row.iter().zip(u).map(|(k, u)| k * u).sum::<f64>())
    }

    /// a(u, u) on a cell (force times length per thickness), u its eight displacements.
    pub fn cell_energy(&self, cell: usize, u: &[f64; 8]) -> f64 {
        self.cell_work(cell, u, u)
    }

    /// a(u, v) on a cell.
    pub fn cell_work(&self, cell: usize, u: &[f64; 8], v: &[f64; 8]) -> f64 {
        self.cell_forces(cell, u).iter().zip(v).map(|(f, v)| f * v).sum()
    }

    /// The cells around a node with its local number in each: left below, right below, right above, left above.
    pub(crate) fn around(&self, node: usize) -> [Option<(usize, usize)>; 4] {
        let [i, j] = self.grid.lattice(node);
        let [nx, ny] = self.grid.cells;
        let cell = |left: bool, below: bool, local: usize| {
            let (ix, iy) = (i.checked_sub(usize::from(left))?, j.checked_sub(usize::from(below))?);
            (ix < nx && iy < ny && self.grid.inside(ix, iy)).then(|| (ix * ny + iy, local))
        };
        [cell(true, true, 2), cell(false, true, 3), cell(false, false, 0), cell(true, false, 1)]
    }

    /// The stiffness matrix of all unknowns (stress: force per thickness per displacement), both triangles.
    ///
    /// Cost: 18 entries a row; the same bits for any number of threads, each row being summed by one.
    pub fn stiffness(&self) -> CsMat<f64> {
        let grid = &self.grid;
        let rows: Vec<Row> = (0..grid.nodes()).into_par_iter().map(|node| self.row(node)).collect();
        let mut indptr = Vec::with_capacity(grid.dofs() + 1);
        indptr.push(0);
        for row in &rows {
            let last = indptr[indptr.len() - 1];
            indptr.extend([last + 2 * row.len, last + 4 * row.len]);
        }
        let entries = indptr[grid.dofs()];
        let (mut indices, mut data) = (vec![0; entries], vec![0.0; entries]);
        // nodes in groups, each with its part of both arrays
        const GROUP: usize = 1024;
        let mut parts = Vec::new();
        let (mut left, mut right) = (&mut indices[..], &mut data[..]);
        for first in (0..grid.nodes()).step_by(GROUP) {
            let last = (first + GROUP).min(grid.nodes());
            let (a, b) = left.split_at_mut(indptr[2 * last] - indptr[2 * first]);
            let (c, d) = right.split_at_mut(a.len());
            parts.push((first..last, a, c));
            (left, right) = (b, d);
        }
        parts.into_par_iter().for_each(|(nodes, indices, data)| {
            let mut at = 0;
            for row in &rows[nodes] {
                for component in 0..2 {
                    for &(node, block) in &row.blocks[..row.len] {
                        for d in 0..2 {
                            indices[at] = 2 * node as usize + d;
                            data[at] = block[component][d];
                            at += 1;
                        }
                    }
                }
            }
        });
        CsMat::new((grid.dofs(), grid.dofs()), indptr, indices, data)
    }

    /// The 2×2 blocks of a node's rows, by rising node.
    fn row(&self, node: usize) -> Row {
        let mut row = Row { len: 0, blocks: [(0, [[0.0; 2]; 2]); 9] };
        for (cell, a) in self.around(node).into_iter().flatten() {
            let young = self.young[cell];
            let mut own = [[0.0; 8]; 8];
            let unit = self.unit_of(cell, &mut own);
            for (b, &other) in self.grid.cell_nodes(cell).iter().enumerate() {
                let found = row.blocks[..row.len].iter().position(|(n, _)| *n as usize == other);
                let at = found.unwrap_or_else(|| {
                    row.blocks[row.len] = (other as u32, [[0.0; 2]; 2]);
                    row.len += 1;
                    row.len - 1
                });
                for c in 0..2 {
                    for d in 0..2 {
                        row.blocks[at].1[c][d] += young * unit[2 * a + c][2 * b + d];
                    }
                }
            }
        }
        row.blocks[..row.len].sort_unstable_by_key(|(node, _)| *node);
        row
    }

    /// K u without the matrix (force per thickness at each unknown).
    pub fn forces(&self, u: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; u.len()];
        self.multiply(u, &mut forces);
        forces
    }

    /// a(u, v) = uᵀ K v.
    pub fn energy(&self, u: &[f64], v: &[f64]) -> f64 {
        self.forces(v).iter().zip(u).map(|(f, u)| f * u).sum()
    }

    /// (σ_xx, σ_yy, σ_xy) at the centre of each cell of the bounding box; NaN in dropped ones.
    pub fn stresses(&self, u: &[f64]) -> Vec<[f64; 3]> {
        let [nx, ny] = self.grid.cells;
        let at = |cell: usize| {
            if !self.grid.inside(cell / ny, cell % ny) {
                return [f64::NAN; 3];
            }
            let u = self.cell_values(u, cell);
            self.stress(cell, &u, [0.5; 2])
        };
        (0..nx * ny).into_par_iter().map(at).collect()
    }

    /// Displacement and stress at a point of the body; None outside of it.
    pub fn at(&self, u: &[f64], x: [f64; 2]) -> Option<([f64; 2], [f64; 3])> {
        let (cell, local) = self.grid.locate(x)?;
        let values = self.cell_values(u, cell);
        let shape = crate::elasticity::shape(local);
        let displacement = [0, 1].map(|i| (0..4).map(|a| shape[a] * values[2 * a + i]).sum());
        Some((displacement, self.stress(cell, &values, local)))
    }
}

/// E K₀ of some cells.
pub(crate) struct CellMatrices {
    young: Vec<f64>,
    /// K₀ of each cell, or one of all.
    units: Vec<[[f64; 8]; 8]>,
}

impl CellMatrices {
    /// E and K₀ of a cell.
    pub fn of(&self, cell: usize) -> (f64, &[[f64; 8]; 8]) {
        (self.young[cell], &self.units[if self.units.len() == 1 { 0 } else { cell }])
    }
}

/// Blocks of a node's two rows.
struct Row {
    len: usize,
    blocks: [(u32, [[f64; 2]; 2]); 9],
}
