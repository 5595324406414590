//! The coarse problem: bases of all coarse cells, their stiffness and loads, and the way back to the fine cells.

use std::collections::HashMap;

use rayon::prelude::*;
use sprs::{CsMat, TriMat};

use crate::basis::{Basis, CellBasis, Structures, bar, cell_basis};
use crate::coarse_mesh::{CoarseCell, CoarseMesh, Hanging};
use crate::local::{Freedom, cell_dofs, nodes};
use crate::ordering::Incidence;
use crate::{HeterogeneousBody, Loads, MsfemError};

/// Largest size in bytes of the bases that are kept for the way back; others are computed again.
const KEPT: usize = 128 << 20;

/// Number of coarse cells that are brought back to the fine grid at a time.
pub(crate) const BATCH: usize = 1024;

/// Displacement unknowns of a coarse vertex as combinations of those of vertices that do not hang.
type Combination = Vec<(usize, f64)>;

/// A coarse mesh with one kind of basis on a body.
///
/// Source: Issaoui (2014), equations (5.22) to (5.31).
#[derive(Debug)]
pub struct Multiscale<'a> {
    /// The body.
    pub body: &'a HeterogeneousBody,
    /// The coarse cells.
    pub mesh: CoarseMesh,
    /// The kind of basis.
    pub basis: Basis,
    /// Number of the first unknown of each vertex: its x component, then y; None for vertices that hang.
    pub unknown: Vec<Option<usize>>,
    /// Both components of every vertex, as combinations of unknowns.
    pub(crate) combinations: Vec<[Combination; 2]>,
    /// Patterns of moduli: the cells of each, all with the same basis.
    pub(crate) patterns: Vec<Vec<usize>>,
    structures: Structures,
    pub(crate) kept: Vec<Option<CellBasis>>,
}

/// All of a [`Multiscale`] but its body and mesh: what [`Multiscale::assemble`] has found.
#[derive(Debug)]
pub struct Bases {
    basis: Basis,
    unknown: Vec<Option<usize>>,
    combinations: Vec<[Combination; 2]>,
    patterns: Vec<Vec<usize>>,
    structures: Structures,
    kept: Vec<Option<CellBasis>>,
}

/// K^H and the load of a coarse problem.
#[derive(Debug, Clone)]
pub struct CoarseSystem {
    /// K^H of all unknowns, held ones included (stress).
    pub stiffness: CsMat<f64>,
    /// Σ R_Tᵀ (f_T - K_T p_T), p_T the particular fields (force per thickness).
    pub load: Vec<f64>,
}

/// Fields that are added to R U on the fine cells.
#[derive(Debug, Clone, Default)]
pub struct Extra {
    /// Whether the response of each cell's inside to the load inside is added: K_II⁻¹ f_I.
    pub bubbles: bool,
    /// Displacement of fine nodes on the boundary less that of R U there (length), two a node; empty for none. It is 0 at
    /// vertices, and the field inside follows.
    pub lift: Vec<f64>,
}

impl<'a> Multiscale<'a> {
    /// Finds the patterns of moduli. Solves nothing yet.
    ///
    /// # Errors
    /// [`MsfemError::Inconsistent`] for hanging vertices and a basis that is not conforming.
    pub fn new(body: &'a HeterogeneousBody, mesh: CoarseMesh, basis: Basis) -> Result<Self, MsfemError> {
        if !basis.is_conforming() && !mesh.hanging.is_empty() {
            let what = format!("cells of different sizes need a conforming basis, not \"{}\"", basis.word());
            return Err(MsfemError::Inconsistent { what });
        }
        let mut this = Self {
            body,
            unknown: Vec::new(),
            combinations: Vec::new(),
            patterns: Vec::new(),
            structures: Structures::default(),
            kept: Vec::new(),
            mesh,
            basis,
        };
        this.number();
        this.find_patterns();
        Ok(this)
    }

    /// The mesh and the bases, without the body.
    pub fn into_bases(self) -> (CoarseMesh, Bases) {
        let Self { basis, unknown, combinations, patterns, structures, kept, mesh, .. } = self;
        (mesh, Bases { basis, unknown, combinations, patterns, structures, kept })
    }

    /// What [`Self::into_bases`] took apart, on the same body.
    pub fn with_bases(body: &'a HeterogeneousBody, mesh: CoarseMesh, bases: Bases) -> Self {
        let Bases { basis, unknown, combinations, patterns, structures, kept } = bases;
        Self { body, mesh, basis, unknown, combinations, patterns, structures, kept }
    }

    /// Number of unknowns, held ones included.
    pub fn dofs(&self) -> usize {
        2 * (self.mesh.vertices.len() - self.hanging_vertices())
    }

    /// Number of different bases.
    pub fn patterns(&self) -> usize {
        self.patterns.len()
    }

    fn hanging_vertices(&self) -> usize {
        self.unknown.iter().filter(|u| u.is_none()).count()
    }

    fn number(&mut self) {
        let mut hanging: HashMap<usize, Hanging> = HashMap::new();
        for h in &self.mesh.hanging {
            hanging.entry(h.vertex).or_insert(*h);
        }
        let mut count = 0;
        for vertex in 0..self.mesh.vertices.len() {
            let free = !hanging.contains_key(&vertex);
            self.unknown.push(free.then_some(count));
            count += if free { 2 } else { 0 };
        }
        let weights: HashMap<usize, [[f64; 2]; 2]> = hanging.values().map(|h| (h.vertex, self.weights(h))).collect();
        let resolve = |vertex: usize, k: usize| -> Combination {
            let mut open = vec![(vertex, 1.0)];
            let mut found: Combination = Vec::new();
            while let Some((vertex, weight)) = open.pop() {
                match (self.unknown[vertex], hanging.get(&vertex)) {
                    (Some(unknown), _) => match found.iter_mut().find(|(u, _)| *u == unknown + k) {
                        Some((_, sum)) => *sum += weight,
                        None => found.push((unknown + k, weight)),
                    },
                    (None, Some(h)) => {
                        // the ends belong to larger cells: this comes to an end
                        (0..2).for_each(|end| open.push((h.ends[end], weight * weights[&vertex][k][end])));
                    }
                    (None, None) => unreachable!("a vertex hangs or has unknowns"),
                }
            }
            found
        };
        self.combinations = (0..self.mesh.vertices.len()).map(|v| [resolve(v, 0), resolve(v, 1)]).collect();
    }

    /// Weights of the two ends in both components of a hanging vertex: the trace of the larger cell's functions.
    fn weights(&self, h: &Hanging) -> [[f64; 2]; 2] {
        let [a, v, b] = [h.ends[0], h.vertex, h.ends[1]].map(|v| self.mesh.vertices[v]);
        let along = usize::from(a[0] == b[0]);
        let at = v[along] - a[along];
        let linear = 1.0 - at as f64 / (b[along] - a[along]) as f64;
        let mut weights = [[linear, 1.0 - linear]; 2];
        if self.basis == Basis::Oscillatory {
            let phi = bar(&self.edge_moduli(h.cell)[h.side])[at];
            weights[along] = [phi, 1.0 - phi];
        }
        weights
    }

    /// Weights of the lower or left end, at all fine nodes of a side of the coarse cell around a fine one, in the trace of the
    /// component along the side; that across it is linear. Sides as in [`crate::Grid::boundary`].
    ///
    /// # Panics
    /// For a fine cell that is not in the body.
    pub fn trace_weights(&self, fine_cell: usize, side: usize) -> Vec<f64> {
        let at = self.body.grid.cell(fine_cell);
        let around = |c: &CoarseCell| (0..2).all(|k| (c.first[k]..c.first[k] + c.size[k]).contains(&at[k]));
        let cell = self.mesh.cells.iter().position(around);
        let cell = cell.unwrap_or_else(|| panic!("fine cell {fine_cell} is in no coarse cell"));
        match self.basis {
            Basis::Oscillatory => bar(&self.edge_moduli(cell)[side]),
            _ => {
                let count = self.mesh.cells[cell].size[side % 2];
                (0..=count).map(|step| 1.0 - step as f64 / count as f64).collect()
            }
        }
    }

    /// The basis of a coarse cell and K_T^H for its own moduli.
    ///
    /// # Errors
    /// [`MsfemError::Singular`] where moduli of too many magnitudes meet.
    pub fn cell_basis(&self, cell: usize) -> Result<CellBasis, MsfemError> {
        cell_basis(self.basis, &self.patch(cell), self.body, &self.structures)
    }

    /// The coarse problem of some loads. `go_on` gets the share of the patterns that are done, and stops the work by returning
    /// false.
    ///
    /// Cost: one local factorisation a pattern, of about 8 m⁴ operations for m × m fine cells.
    ///
    /// # Errors
    /// As [`Self::cell_basis`]; [`MsfemError::Stopped`].
    pub fn assemble(
        &mut self,
        loads: &Loads,
        extra: &Extra,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Result<CoarseSystem, MsfemError> {
        let bytes = |cells: &Vec<usize>| 64 * 2 * nodes(self.mesh.cells[cells[0]].size);
        let keep = self.patterns.iter().map(bytes).sum::<usize>() <= KEPT;
        let one = |cells: &Vec<usize>| -> Result<(Vec<CellSystem>, Option<CellBasis>), MsfemError> {
            let basis = self.cell_basis(cells[0])?;
            let reference = self.reference(cells[0]);
            let system = |&cell: &usize| self.cell_system(cell, &basis, self.reference(cell) / reference, loads, extra);
            let systems = cells.par_iter().map(system).collect::<Result<_, MsfemError>>()?;
            Ok((systems, keep.then_some(basis)))
        };
        let (mut systems, mut kept) = (Vec::with_capacity(self.mesh.cells.len()), Vec::new());
        for batch in self.patterns.chunks(BATCH) {
            if !go_on(kept.len() as f64 / self.patterns.len() as f64) {
                return Err(MsfemError::Stopped);
            }
            let solved: Vec<_> = batch.par_iter().map(one).collect::<Result<_, MsfemError>>()?;
            for (of_pattern, basis) in solved {
                systems.extend(of_pattern);
                kept.push(basis);
            }
        }
        systems.sort_unstable_by_key(|s| s.cell);
        let size = self.dofs();
        let mut load = vec![0.0; size];
        let mut entries = TriMat::with_capacity((size, size), 64 * systems.len());
        for system in &systems {
            let corner = |a: usize| &self.combinations[self.mesh.corners[system.cell][a / 2]][a % 2];
            for a in 0..8 {
                for &(i, wi) in corner(a) {
                    load[i] += wi * system.load[a];
                    for b in 0..8 {
                        for &(j, wj) in corner(b) {
                            entries.add_triplet(i, j, wi * wj * system.stiffness[a][b]);
                        }
                    }
                }
            }
        }
        self.kept = kept;
        Ok(CoarseSystem { stiffness: entries.to_csr(), load })
    }

    /// The load alone of a coarse problem that [`Self::assemble`] has the bases of.
    ///
    /// # Errors
    /// As [`Self::cell_basis`].
    pub fn load(&self, loads: &Loads, extra: &Extra) -> Result<Vec<f64>, MsfemError> {
        let pattern = self.pattern_of_cells();
        let acts = |&cell: &usize| {
            let lifted = |node: usize| extra.lift[2 * node..2 * node + 2] != [0.0; 2];
            self.is_loaded(cell, loads)
                || !extra.lift.is_empty() && self.mesh.cells[cell].fine_nodes(&self.body.grid).any(lifted)
        };
        let cells: Vec<usize> = (0..self.mesh.cells.len()).filter(acts).collect();
        let of_cell = |&cell: &usize| match self.kept.get(pattern[cell]) {
            Some(Some(basis)) => self.cell_load(cell, basis, loads, extra),
            _ => self.cell_load(cell, &self.cell_basis(cell)?, loads, extra),
        };
        let of_cells: Vec<[f64; 8]> = cells.par_iter().map(of_cell).collect::<Result<_, _>>()?;
        let mut load = vec![0.0; self.dofs()];
        for (cell, own) in cells.into_iter().zip(of_cells) {
            for a in 0..8 {
                for &(i, weight) in &self.combinations[self.mesh.corners[cell][a / 2]][a % 2] {
                    load[i] += weight * own[a];
                }
            }
        }
        Ok(load)
    }

    /// K_T^H and the load of one cell.
    fn cell_system(
        &self,
        cell: usize,
        basis: &CellBasis,
        factor: f64,
        loads: &Loads,
        extra: &Extra,
    ) -> Result<CellSystem, MsfemError> {
        let load = self.cell_load(cell, basis, loads, extra)?;
        Ok(CellSystem { cell, stiffness: basis.stiffness.map(|row| row.map(|k| factor * k)), load })
    }

    /// R_Tᵀ (f_T - K_T p_T).
    fn cell_load(&self, cell: usize, basis: &CellBasis, loads: &Loads, extra: &Extra) -> Result<[f64; 8], MsfemError> {
        let mut load = [0.0; 8];
        let coarse = self.mesh.cells[cell];
        let mut add = |local: usize, force: &[f64; 8]| {
            let [_, n] = coarse.size;
            for (a, dof) in cell_dofs(coarse.size, local / n, local % n).into_iter().enumerate() {
                (0..8).for_each(|c| load[c] += basis.values[dof][c] * force[a]);
            }
        };
        if self.is_loaded(cell, loads) {
            for (local, fine) in coarse.fine_cells(&self.body.grid).enumerate() {
                add(local, &loads.cell(fine));
            }
        }
        if let Some(particular) = self.particular(cell, loads, extra)? {
            for (local, fine) in coarse.fine_cells(&self.body.grid).enumerate() {
                let [_, n] = coarse.size;
                let u = cell_dofs(coarse.size, local / n, local % n).map(|d| particular[d]);
                add(local, &self.body.cell_forces(fine, &u).map(|f| -f));
            }
        }
        Ok(load)
    }

    fn is_loaded(&self, cell: usize, loads: &Loads) -> bool {
        !loads.body.is_empty()
            || self.mesh.cells[cell].fine_cells(&self.body.grid).any(|c| loads.boundary.contains_key(&c))
    }

    /// p_T: the lift on the boundary and, with bubbles, the response to the load inside; None where both vanish.
    fn particular(&self, cell: usize, loads: &Loads, extra: &Extra) -> Result<Option<Vec<f64>>, MsfemError> {
        let coarse = self.mesh.cells[cell];
        let [m, n] = coarse.size;
        let grid = &self.body.grid;
        let mut field = vec![[0.0; 8]; 2 * nodes(coarse.size)];
        let mut lifted = false;
        if !extra.lift.is_empty() {
            for (local, node) in coarse.fine_nodes(grid).enumerate() {
                let (i, j) = (local % (m + 1), local / (m + 1));
                if i == 0 || j == 0 || i == m || j == n {
                    (0..2).for_each(|k| field[2 * local + k][0] = extra.lift[2 * node + k]);
                    lifted |= extra.lift[2 * node..2 * node + 2] != [0.0; 2];
                }
            }
        }
        let loaded = extra.bubbles && self.is_loaded(cell, loads);
        if !lifted && !loaded {
            return Ok(None);
        }
        let mut load = Vec::new();
        if loaded {
            load.resize(field.len(), 0.0);
            for (local, fine) in coarse.fine_cells(grid).enumerate() {
                let force = loads.cell(fine);
                for (a, dof) in cell_dofs(coarse.size, local / n, local % n).into_iter().enumerate() {
                    load[dof] += force[a];
                }
            }
        }
        let problem = self.structures.get(coarse.size, Freedom::Interior)?;
        let cells = self.body.matrices(&coarse.fine_cells(grid).collect::<Vec<_>>());
        let factor = problem.factorise(&cells)?;
        let load = loaded.then_some(&load[..]);
        problem.solve(factor.as_ref(), &cells, &mut field, &[0], load);
        Ok(Some(field.iter().map(|row| row[0]).collect()))
    }

    /// Displacement of the fine nodes of one cell, two a node, j·(m+1) + i: R_T U_T + p_T.
    fn cell_field(
        &self,
        cell: usize,
        basis: &CellBasis,
        coarse: &[f64],
        loads: &Loads,
        extra: &Extra,
    ) -> Result<Vec<f64>, MsfemError> {
        let corner = |a: usize| -> f64 {
            self.combinations[self.mesh.corners[cell][a / 2]][a % 2].iter().map(|(i, w)| w * coarse[*i]).sum()
        };
        let u: [f64; 8] = std::array::from_fn(corner);
        let mut field: Vec<f64> = basis.values.iter().map(|row| row.iter().zip(&u).map(|(r, u)| r * u).sum()).collect();
        if let Some(particular) = self.particular(cell, loads, extra)? {
            field.iter_mut().zip(particular).for_each(|(u, p)| *u += p);
        }
        Ok(field)
    }

    /// Calls `each` with the displacement of the fine nodes of each coarse cell, cell by cell; nothing is averaged. Before
    /// each batch of cells `go_on` gets the share that is done and says whether to go on.
    ///
    /// # Errors
    /// As [`Self::cell_basis`]; [`MsfemError::Stopped`].
    pub fn downscale_cells(
        &self,
        coarse: &[f64],
        loads: &Loads,
        extra: &Extra,
        go_on: &mut dyn FnMut(f64) -> bool,
        mut each: impl FnMut(usize, &[f64]),
    ) -> Result<(), MsfemError> {
        let pattern = self.pattern_of_cells();
        let cells: Vec<usize> = (0..self.mesh.cells.len()).collect();
        for batch in cells.chunks(BATCH) {
            if !go_on(batch[0] as f64 / cells.len() as f64) {
                return Err(MsfemError::Stopped);
            }
            let field = |&cell: &usize| match self.kept.get(pattern[cell]) {
                Some(Some(basis)) => self.cell_field(cell, basis, coarse, loads, extra),
                _ => self.cell_field(cell, &self.cell_basis(cell)?, coarse, loads, extra),
            };
            let fields: Vec<Vec<f64>> = batch.par_iter().map(field).collect::<Result<_, MsfemError>>()?;
            batch.iter().zip(&fields).for_each(|(&cell, field)| each(cell, field));
        }
        Ok(())
    }

    /// The fine cells of a coarse one and their eight displacements, from a field that [`Self::downscale_cells`] gives.
    pub fn fine_values<'f>(&'f self, cell: usize, field: &'f [f64]) -> impl Iterator<Item = (usize, [f64; 8])> + 'f {
        let coarse = &self.mesh.cells[cell];
        let n = coarse.size[1];
        let values = move |local: usize| cell_dofs(coarse.size, local / n, local % n).map(|dof| field[dof]);
        coarse.fine_cells(&self.body.grid).enumerate().map(move |(local, fine)| (fine, values(local)))
    }

    /// Displacement of all fine nodes; where cells meet, the mean of theirs (they differ for bases that do not conform).
    ///
    /// # Errors
    /// As [`Self::downscale_cells`].
    pub fn downscale(
        &self,
        coarse: &[f64],
        loads: &Loads,
        extra: &Extra,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Vec<f64>, MsfemError> {
        let grid = &self.body.grid;
        let (mut sum, mut count) = (vec![0.0; grid.dofs()], vec![0u8; grid.nodes()]);
        self.downscale_cells(coarse, loads, extra, go_on, |cell, field| {
            for (node, u) in self.mesh.cells[cell].fine_nodes(grid).zip(field.chunks_exact(2)) {
                (sum[2 * node], sum[2 * node + 1]) = (sum[2 * node] + u[0], sum[2 * node + 1] + u[1]);
                count[node] += 1;
            }
        })?;
        for (u, count) in sum.chunks_exact_mut(2).zip(count) {
            u.iter_mut().for_each(|u| *u /= f64::from(count));
        }
        Ok(sum)
    }

    /// Displacement of all vertices, those that hang included (length).
    pub fn vertex_displacement(&self, coarse: &[f64]) -> Vec<[f64; 2]> {
        let value = |combination: &Combination| combination.iter().map(|(i, w)| w * coarse[*i]).sum();
        self.combinations.iter().map(|[x, y]| [value(x), value(y)]).collect()
    }

    /// An order in which the unknowns are eliminated with little fill.
    pub fn elimination_order(&self) -> Vec<usize> {
        let mut incidence = Incidence::default();
        for (cell, corners) in self.mesh.cells.iter().zip(&self.mesh.corners) {
            let centre = [0, 1].map(|k| (2 * cell.first[k] + cell.size[k]) as u32);
            let unknowns = corners.iter().flat_map(|&v| self.combinations[v].iter().flatten().map(|(u, _)| u / 2));
            incidence.push(centre, unknowns);
        }
        incidence.nested_dissection(self.dofs() / 2)
    }
}

/// The contribution of one cell to the coarse problem.
struct CellSystem {
    cell: usize,
    stiffness: [[f64; 8]; 8],
    load: [f64; 8],
}

impl HeterogeneousBody {
    /// An order in which the nodes of the fine grid are eliminated with little fill.
    pub fn elimination_order(&self) -> Vec<usize> {
        let mut incidence = Incidence::default();
        for cell in self.grid.body_cells() {
            let [ix, iy] = self.grid.cell(cell);
            incidence.push([ix as u32, iy as u32], self.grid.cell_nodes(cell));
        }
        incidence.nested_dissection(self.grid.nodes())
    }
}
