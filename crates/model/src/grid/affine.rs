//! A grid of bilinear elements whose moduli are affine in the germs: its equations for all outcomes at once.
//!
//! ```text
//! K(ξ) = K_0 + Σ_m (ξ_m - E ξ_m) K_m,  K_m the stiffness of E_m       u = Σ_a u_a ψ_a, u_a = 0 at supports but for u_0 = ū
//! projected onto ψ_a:  stress σ_a = D B (E_0 u_a + Σ_m E_m Σ_b G_m[a, b] u_b), support force r_a = (K u)_a - f δ_a0
//! strain energy ½ (f·u_a + r_a·ū), load work f·u_a: of a solution both are linear in it, for loads and ū without germs
//! ```

use steklov_msfem::{Elimination, HeterogeneousBody};
use steklov_problem::{AffineModuli, DataError, DataErrorKind, Scene};
use steklov_stochastic::{AffineFamily, AffineSolution, Coupled, TotalDegree};

use super::cells::body;
use super::layout::GridLayout;
use super::loads::{CellLoads, loads};
use super::solve::moment;
use super::trace::{GridTrace, node_at};
use crate::data::on_mesh::OnMesh;
use crate::data::supports::{Held, Supports};
use crate::error::SolveError;
use crate::solve::equilibrium::reactions;
use crate::summary::{Probe, Summary};

/// The equations of a grid in all germs.
pub(crate) struct AffineGrid<'a> {
    scene: &'a Scene,
    /// The body of the mean moduli.
    pub(crate) body: HeterogeneousBody,
    moduli: &'a AffineModuli,
    trace: GridTrace,
    held: Vec<Held>,
    /// f.
    load: Vec<f64>,
    elimination: Elimination,
    /// Held unknowns with their values.
    fixed: Vec<(usize, f64)>,
    /// The node at each node of the boundary.
    at_boundary: Vec<usize>,
}

/// What the coefficients of one polynomial give.
pub(crate) struct OfBlock {
    /// The numbers that each outcome has; places are those of the mean alone.
    pub figures: Summary,
    /// Stress xx, yy, xy in the middle of each cell of the body.
    pub stress: Vec<f64>,
    /// u_aᵀ K_0 u_a.
    pub energy: f64,
    /// Displacement of the nodes of the boundary.
    pub boundary: Vec<f64>,
}

impl<'a> AffineGrid<'a> {
    /// The equations of a scene, an outcome without random input whose moduli are the mean ones.
    ///
    /// # Errors
    /// Data that are not finite; [`DataErrorKind::Unsupported`] for a body that can move as a whole.
    pub(crate) fn new(scene: &'a Scene, layout: &GridLayout, moduli: &'a AffineModuli) -> Result<Self, SolveError> {
        let body = body(scene, layout)?;
        let trace = GridTrace::new(scene, &body.grid, |_| true)?;
        let CellLoads { loads, .. } = loads(scene, &body, &trace)?;
        let held = OnMesh { scene, mesh: &trace.mesh, space: &trace.space }.held()?;
        let at_boundary: Vec<usize> = trace.lattice.iter().map(|&p| node_at(&body.grid, p)).collect();
        let supports = Supports { space: &trace.space, held: &held };
        if !supports.free_motions(Vec::new()).is_empty() {
            let message = "galerkin on a grid needs a body that supports hold, and it can move as a whole";
            let help = "hold it by displacements on its sides, or take method = \"corrected\"";
            let keys = [vec!["stochastic", "method"], vec!["random"]];
            return Err(DataError::at(DataErrorKind::Unsupported, &keys, message, help).into());
        }
        let unknown = |dof: usize| 2 * at_boundary[dof / 2] + dof % 2;
        let fixed: Vec<(usize, f64)> = supports.dofs().into_iter().map(|(dof, u)| (unknown(dof), u)).collect();
        let numbers: Vec<usize> = fixed.iter().map(|(dof, _)| *dof).collect();
        let elimination = Elimination::new(body.stiffness(), &body.elimination_order(), &[], &numbers)?;
        let load = loads.nodal(&body);
        Ok(Self { scene, body, moduli, trace, held, load, elimination, fixed, at_boundary })
    }

    /// Σ_m K_m v_m.
    fn product(&self, vectors: &[&[f64]], out: &mut [f64]) {
        let moduli: Vec<&[f64]> = self.moduli.parts.iter().map(Vec::as_slice).collect();
        self.body.mixed_forces(&moduli, vectors, out);
    }

    /// The coefficients of the displacement of all fine unknowns.
    ///
    /// # Errors
    /// Those of [`TotalDegree::solve`].
    pub(crate) fn solve(&self, basis: &TotalDegree, tolerance: f64) -> Result<AffineSolution, SolveError> {
        let n = self.load.len();
        let free = |v: &mut [f64]| self.fixed.iter().for_each(|&(dof, _)| v[dof] = 0.0);
        let none = vec![0.0; self.fixed.len()];
        let solve = |columns: &mut [f64]| {
            for column in columns.chunks_mut(n) {
                let reduced = self.elimination.reduce(column, &none);
                column.copy_from_slice(&self.elimination.expand(&reduced, &[]));
            }
        };
        let product = |vectors: &[&[f64]], out: &mut [f64]| {
            self.product(vectors, out);
            free(out);
        };
        let mut loads = vec![self.load.clone()];
        loads.resize(self.moduli.parts.len(), Vec::new());
        if self.fixed.iter().any(|&(_, u)| u != 0.0) {
            let mut lift = vec![0.0; n];
            self.fixed.iter().for_each(|&(dof, u)| lift[dof] = u);
            for (load, young) in loads.iter_mut().zip(&self.moduli.parts) {
                load.resize(n, 0.0);
                let mut forces = vec![0.0; n];
                self.body.mixed_forces(&[young], &[&lift], &mut forces);
                load.iter_mut().zip(&forces).for_each(|(f, k)| *f -= k);
            }
        }
        loads.iter_mut().filter(|load| !load.is_empty()).for_each(|load| free(load));
        let mut solved = basis.solve(&AffineFamily { product: &product, solve: &solve, loads }, tolerance)?;
        self.fixed.iter().for_each(|&(dof, u)| solved.blocks[dof] = u);
        Ok(solved)
    }

    /// What the block a of a solution gives; `row` is that of a in [`TotalDegree::products`].
    pub(crate) fn of_block(&self, basis: &TotalDegree, row: &[Coupled], blocks: &[f64], a: usize) -> OfBlock {
        let (n, grid) = (self.load.len(), &self.body.grid);
        let u = &blocks[a * n..(a + 1) * n];
        let mixed = basis.mixed(row, blocks);
        let vectors: Vec<&[f64]> = std::iter::once(u).chain(mixed.iter().map(Vec::as_slice)).collect();
        let moduli: Vec<&[f64]> = self.moduli.parts.iter().map(Vec::as_slice).collect();
        let mut forces = vec![0.0; n];
        self.product(&vectors, &mut forces);
        let stress = |cell: usize, at: [f64; 2]| {
            self.body.mixed_stress(cell, &self.body.mixed_values(cell, &moduli, &vectors), at)
        };
        let energy = self.body.energy(u, u);
        let load_work: f64 = self.load.iter().zip(u).map(|(f, u)| f * u).sum();
        if a == 0 {
            forces.iter_mut().zip(&self.load).for_each(|(r, f)| *r -= f);
        }
        let held_work: f64 = self.fixed.iter().map(|&(dof, u)| forces[dof] * u).sum();
        let on_boundary = |values: &[f64]| -> Vec<f64> {
            self.at_boundary.iter().flat_map(|n| [values[2 * n], values[2 * n + 1]]).collect()
        };
        let supports = Supports { space: &self.trace.space, held: &self.held };
        let corner = |e: usize, _: usize| moment(stress(self.trace.cell(grid, e).0, [0.5; 2]), &self.trace, e);
        let reactions =
            reactions(self.scene, (&supports, &self.trace.mesh), &on_boundary(&forces), (None, Vec::new()), corner);
        let probe = |&point: &[f64; 2]| {
            let at = grid.locate(point).map(|(cell, local)| stress(cell, local));
            let displacement = self.body.at(u, point).map_or([f64::NAN; 2], |(displacement, _)| displacement);
            let place = if a == 0 { point } else { [0.0; 2] };
            Probe::new(place, displacement, at.unwrap_or([f64::NAN; 3]))
        };
        let strain = 0.5 * (load_work + held_work);
        let figures = Summary {
            energy: strain - load_work,
            strain_energy: strain,
            load_work,
            reactions: reactions.into_iter().collect(),
            probe: self.scene.probe.iter().map(probe).collect(),
            ..Summary::default()
        };
        let stress = grid.body_cells().flat_map(|cell| stress(cell, [0.5; 2])).collect();
        OfBlock { figures, stress, energy, boundary: on_boundary(u) }
    }
}
