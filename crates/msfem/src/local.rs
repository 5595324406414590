//! Local problems: a rectangle of m × n fine cells, some of whose displacements are given.

use faer::{Mat, Par};
use steklov_algebra::{Pattern, SparseCholesky, Structure};

use crate::MsfemError;
use crate::body::CellMatrices;
use crate::grid::NONE;
use crate::ordering::Incidence;

/// A field on the nodes of a rectangle for each of the eight coarse unknowns: row 2·node + component, column 2·corner +
/// direction; node (i, j) has the number j·(m+1) + i.
pub(crate) type Columns = Vec<[f64; 8]>;

/// Which displacements of a rectangle are free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Freedom {
    /// Those inside.
    Interior,
    /// Those inside, and on the boundary all but component k; the other one is held at the upper right corner too.
    Component(usize),
    /// All except those of the corners, equal on opposite sides.
    Periodic,
}

/// The structure of a local problem: fields u = G + P z, z the free displacements, K the stiffness of the cells.
#[derive(Debug, Clone)]
pub(crate) struct LocalProblem {
    /// Cells m, n.
    pub size: [usize; 2],
    /// The number of each displacement among the free ones, NONE if it is given.
    unknown: Vec<u32>,
    /// Number of free displacements.
    count: usize,
    structure: Option<Structure>,
    /// The places of the 64 entries of each cell, NONE for those above the diagonal or of given displacements.
    slots: Vec<[u32; 64]>,
}

/// Number of nodes of m × n cells.
pub(crate) fn nodes(size: [usize; 2]) -> usize {
    (size[0] + 1) * (size[1] + 1)
}

/// The displacements of cell (i, j) of a rectangle.
pub(crate) fn cell_dofs([m, _]: [usize; 2], i: usize, j: usize) -> [usize; 8] {
    let first = j * (m + 1) + i;
    let corners = [first, first + 1, first + m + 2, first + m + 1];
    std::array::from_fn(|a| 2 * corners[a / 2] + a % 2)
}

impl LocalProblem {
    /// The problem of a rectangle of `size` cells with these free displacements: numbers them and analyses the structure of Pᵀ K P.
    ///
    /// # Errors
    /// [`MsfemError::Memory`] if the structure of the factor does not fit into memory: take a coarser grid.
    pub fn new(size: [usize; 2], freedom: Freedom) -> Result<Self, MsfemError> {
        let [m, n] = size;
        let boundary = |i: usize, j: usize| i == 0 || j == 0 || i == m || j == n;
        let (mut unknown, mut count) = (vec![NONE; 2 * nodes(size)], 0);
        for j in 0..=n {
            for i in 0..=m {
                let node = j * (m + 1) + i;
                for k in 0..2 {
                    let free = match freedom {
                        Freedom::Interior => !boundary(i, j),
                        Freedom::Component(held) => !boundary(i, j) || k != held && (i, j) != (m, n),
                        Freedom::Periodic => (i % m, j % n) != (0, 0),
                    };
                    // the opposite point of a periodic rectangle came first
                    let master = (j % n) * (m + 1) + i % m;
                    if free && freedom == Freedom::Periodic && master != node {
                        unknown[2 * node + k] = unknown[2 * master + k];
                    } else if free {
                        unknown[2 * node + k] = count;
                        count += 1;
                    }
                }
            }
        }
        let count = count as usize;
        let mut problem = Self { size, unknown, count, structure: None, slots: Vec::new() };
        if count > 0 {
            problem.analyse()?;
        }
        Ok(problem)
    }

    /// Cells in the order of their moduli.
    fn cells(&self) -> impl Iterator<Item = (usize, [usize; 8])> + '_ {
        let [m, n] = self.size;
        (0..m * n).map(move |c| (c, cell_dofs(self.size, c / n, c % n)))
    }

    fn analyse(&mut self) -> Result<(), MsfemError> {
        let mut columns: Vec<Vec<usize>> = vec![Vec::new(); self.count];
        let mut incidence = Incidence::default();
        for (cell, dofs) in self.cells() {
            let free: Vec<usize> =
                dofs.iter().map(|&d| self.unknown[d]).filter(|&u| u != NONE).map(|u| u as usize).collect();
            for &column in &free {
                columns[column].extend(free.iter().filter(|&&row| row >= column));
            }
            let [i, j] = [cell / self.size[1], cell % self.size[1]];
            incidence.push([i as u32, j as u32], free);
        }
        let mut pattern = Pattern { start: vec![0], rows: Vec::new() };
        for column in &mut columns {
            column.sort_unstable();
            column.dedup();
            pattern.rows.extend_from_slice(column);
            pattern.start.push(pattern.rows.len());
        }
        let slot = |row: u32, column: u32| -> u32 {
            if row == NONE || column == NONE || row < column {
                return NONE;
            }
            let first = pattern.start[column as usize];
            let rows = &pattern.rows[first..pattern.start[column as usize + 1]];
            let at = rows.binary_search(&(row as usize)).unwrap_or_else(|_| unreachable!("the cell made this entry"));
            (first + at) as u32
        };
        let slots = self
            .cells()
            .map(|(_, dofs)| std::array::from_fn(|k| slot(self.unknown[dofs[k / 8]], self.unknown[dofs[k % 8]])));
        self.slots = slots.collect();
        let order = incidence.nested_dissection(self.count);
        self.structure = Some(Structure::new(pattern, &order).map_err(|none| MsfemError::of_factor(none, self.count))?);
        Ok(())
    }

    /// The factor of Pᵀ K P; None without free displacements. `cells` has the matrices of the cells, (i, j) at i·n + j.
    ///
    /// # Errors
    /// As [`Structure::factorise`].
    pub fn factorise(&self, cells: &CellMatrices) -> Result<Option<SparseCholesky>, MsfemError> {
        let Some(structure) = &self.structure else { return Ok(None) };
        let mut entries = vec![0.0; structure.pattern.rows.len()];
        for (cell, slots) in self.slots.iter().enumerate() {
            let (young, unit) = cells.of(cell);
            for (k, &slot) in slots.iter().enumerate() {
                if slot != NONE {
                    entries[slot as usize] += young * unit[k / 8][k % 8];
                }
            }
        }
        structure.factorise(&entries, Par::Seq).map(Some).map_err(|none| MsfemError::of_factor(none, self.count))
    }

    /// G + P z with Pᵀ K (G + P z) = Pᵀ f for the columns listed; the other columns stay. `f` is a load of the first of them.
    pub fn solve(
        &self,
        factor: Option<&SparseCholesky>,
        cells: &CellMatrices,
        given: &mut Columns,
        columns: &[usize],
        load: Option<&[f64]>,
    ) {
        let Some(factor) = factor else { return };
        let mut rhs = Mat::<f64>::zeros(self.count, columns.len());
        for (cell, dofs) in self.cells() {
            let values = dofs.map(|d| given[d]);
            if values == [[0.0; 8]; 8] {
                continue;
            }
            let (young, unit) = cells.of(cell);
            for (a, row) in unit.iter().enumerate() {
                let unknown = self.unknown[dofs[a]];
                if unknown == NONE {
                    continue;
                }
                let mut force = [0.0; 8];
                for (k, g) in row.iter().zip(&values) {
                    (0..8).for_each(|c| force[c] += k * g[c]);
                }
                for (k, &c) in columns.iter().enumerate() {
                    rhs[(unknown as usize, k)] -= young * force[c];
                }
            }
        }
        let free = self.unknown.iter().enumerate().filter(|(_, u)| **u != NONE);
        if let Some(load) = load {
            free.clone().for_each(|(dof, &u)| rhs[(u as usize, 0)] += load[dof]);
        }
        factor.solve(rhs.as_mut(), Par::Seq);
        for (dof, &unknown) in free {
            for (k, &c) in columns.iter().enumerate() {
                given[dof][c] += rhs[(unknown as usize, k)];
            }
        }
    }
}
