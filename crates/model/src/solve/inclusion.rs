//! A body in an unbounded medium, by boundary elements on both sides of its boundary.
//!
//! With u the displacement of the body, ξ = u - u0 that of the medium without the remote stress, n out of the body, S_i and S_e
//! the Steklov-Poincaré matrices of body and medium on one mesh:
//!
//! ```text
//! J(u) = ½ ⟨S_i u, u⟩ + ½ ⟨S_e (u - u0), u - u0⟩ - ⟨t0, u⟩,      (S_i + S_e) u = t0 + S_e u0,      σ(u_c)n = -S_e ξ
//! ```
//! u0 and t0 are the jumps of displacement and traction, those of the remote stress included; u0 by its nodal values.
//!
//! Source: Issaoui (2014), equation (5.97), with boundary elements inside too.

use std::collections::BTreeSet;

use faer::{Col, Mat};
use steklov_algebra::dot;
use steklov_bem_operators::{
    BemError, Datum, Domain, EnrichedSteklov, Mesh, PairCache, Site, Space, Steklov, TractionMap, side_moments,
};
use steklov_contact::oscillation;
use steklov_coupling::{Balance, Coupled, Radiation};
use steklov_elastic::Material;
use steklov_expression::Expression;
use steklov_problem::Scene;
use steklov_quadrature::legendre_p;

use crate::data::on_mesh::OnMesh;
use crate::error::SolveError;
use crate::solve::assemble::operators;
use crate::solve::medium::Around;

/// The medium around a body, on the mesh of the body, and the jump of the displacement between them.
pub struct Outside {
    /// Material of the medium.
    pub(crate) material: Material,
    /// Length in the logarithm of the kernel.
    pub(crate) length: f64,
    /// S_e.
    stiffness: Mat<f64>,
    /// The map from ξ to σ(u_c)n.
    pub(crate) traction_map: TractionMap,
    /// u0 at the nodes, interleaved.
    pub(crate) jump: Vec<f64>,
    /// S_e u0.
    pub(crate) load: Vec<f64>,
}

impl Outside {
    /// Assembles and factorises the operators of the medium; none unless the scene has one around a body. `estimated`: an estimate
    /// is to follow.
    ///
    /// # Errors
    /// Those of [`Operators::assemble`] and [`Steklov::new`]; a jump that is not finite.
    pub(crate) fn new(data: &OnMesh<'_>, estimated: bool, cache: &mut PairCache) -> Result<Option<Self>, SolveError> {
        let OnMesh { scene, mesh, space } = *data;
        let Some(medium) = scene.surroundings().filter(|_| scene.is_inclusion()) else { return Ok(None) };
        let material = medium.material;
        let domain = match medium.radiation {
            Radiation::Decaying => Domain::Exterior,
            Radiation::Bounded => Domain::ExteriorBoundedAtInfinity,
        };
        let operators = operators(mesh, space, &material, estimated, cache)?;
        let length = operators.length;
        let Steklov { matrix: stiffness, traction: traction_map } = Steklov::new(operators, domain)?;
        let jump = data.jump()?;
        let load = product(&stiffness, &jump);
        Ok(Some(Self { material, length, stiffness, traction_map, jump, load }))
    }

    /// The blocks that S₊ of the enriched spaces needs besides, and what `tractions` need where they are wanted.
    pub(crate) fn enriched(
        &self,
        mesh: &Mesh,
        space: &Space,
        cache: &mut PairCache,
        tractions: bool,
    ) -> Result<EnrichedSteklov, BemError> {
        EnrichedSteklov::new(mesh, space, &self.material, self.length, &self.traction_map, cache, tractions)
    }

    /// Adds S_e to the matrix of the body.
    pub(crate) fn stiffen(&self, matrix: &mut Mat<f64>) {
        *matrix += &self.stiffness;
    }

    /// S_e v of nodal values.
    pub(crate) fn multiply(&self, v: &[f64]) -> Vec<f64> {
        product(&self.stiffness, v)
    }

    /// R = -⟨S_e ξ, u0⟩: the work of the medium on the jump.
    pub(crate) fn work_on_jump(&self, u: &[f64]) -> f64 {
        -dot(&self.jump, &self.multiply(&self.displacement(u)))
    }

    /// ξ at the nodes.
    pub fn displacement(&self, u: &[f64]) -> Vec<f64> {
        u.iter().zip(&self.jump).map(|(u, jump)| u - jump).collect()
    }

    /// ½⟨S_i u, u⟩ + ½⟨S_e ξ, ξ⟩ of displacements of the body and of the medium; `forces` = (S_i + S_e) u.
    pub fn strain_energy(&self, u: &[f64], xi: &[f64], forces: &[f64]) -> f64 {
        let of_medium = product(&self.stiffness, u);
        let inside: Vec<f64> = forces.iter().zip(&of_medium).map(|(all, medium)| all - medium).collect();
        0.5 * (dot(u, &inside) + dot(xi, &product(&self.stiffness, xi)))
    }

    /// The medium of a solution; `loads` are the nodal values of t0.
    pub(crate) fn around(&self, data: &OnMesh<'_>, u: &[f64], loads: &[f64]) -> Option<Around> {
        let xi = self.displacement(u);
        let force = [0, 1].map(|i| loads.iter().skip(i).step_by(2).sum());
        let balance = Balance { force, scale: loads.iter().map(|f| f.abs()).sum() };
        let coupled = Coupled {
            displacement: Vec::new(),
            trace: u.to_vec(),
            traction: self.traction_map.apply(&xi),
            constant: self.traction_map.at_infinity(&xi),
            exterior_displacement: xi,
            balance,
        };
        let (mesh, space) = (data.mesh.clone(), data.space.clone());
        Some(Around::new(data.scene.surroundings()?, mesh, space, self.length, &coupled))
    }
}

impl OnMesh<'_> {
    /// The jump u0 of the displacement from the medium to the body at every node, that of the remote stress included; interleaved.
    ///
    /// # Errors
    /// [`SolveError::Data`] for a jump of the displacement that is not finite or has a pole between two nodes: correct its
    /// expression.
    pub fn jump(&self) -> Result<Vec<f64>, SolveError> {
        let (scene, mesh, space) = (self.scene, self.mesh, self.space);
        let jumps = displacement_jump(scene);
        for expression in jumps.filter(|jump| jump.constant().is_none()) {
            // only for its errors: the nodes alone do not see a pole between them
            let function = self.function(expression);
            for side in self.interface_sides() {
                let moments = side_moments(mesh, space, side, &function.datum("displacement jump"));
                moments.map_err(|error| self.located(error, expression))?;
            }
        }
        let mut jump = vec![0.0; space.dofs()];
        for e in 0..mesh.len() {
            for (j, node) in space.element_nodes(e).enumerate() {
                let s = mesh.edge_parameter(e, space.basis(e).nodes[j]);
                let value = scene.displacement_jump(mesh.edge[e], s);
                (0..2).for_each(|i| jump[2 * node + i] = value[i]);
            }
        }
        Ok(jump)
    }

    /// E*/2 ‖w‖ ‖dw/ds‖ of the part w of the jump of the displacement between body and medium that the nodes miss, for each of
    /// its components: (element, energy). Both sides deform under w: 1/E* is the sum of both.
    pub(crate) fn jump_oscillation(&self) -> Result<Vec<(usize, f64)>, SolveError> {
        let mut found = Vec::new();
        let Some(around) = self.scene.surroundings() else { return Ok(found) };
        let compliance = 1.0 / self.scene.body().material().plane_modulus() + 1.0 / around.material.plane_modulus();
        let jumps = displacement_jump(self.scene);
        for expression in jumps.filter(|jump| jump.constant().is_none()) {
            let function = self.function(expression);
            for e in 0..self.mesh.len() {
                let oscillation = oscillation(self.mesh, self.space, e, &function.datum("displacement jump"))?;
                found.push((e, oscillation / (2.0 * compliance)));
            }
        }
        // nodes represent a linear displacement except on curves
        let remote = around.remote();
        for e in (0..self.mesh.len()).filter(|&e| !self.mesh.is_line(e)) {
            for i in 0..2 {
                let value = |site: &Site| remote.displacement(site.point)[i];
                let datum =
                    Datum { name: "remote displacement", value: &value, kinks: &|_| Vec::new(), rounding: None };
                found.push((e, oscillation(self.mesh, self.space, e, &datum)? / (2.0 * compliance)));
            }
        }
        Ok(found)
    }

    /// The coefficients of the bubbles in the jump of the displacement less its interpolant, two for each element.
    pub(crate) fn missed_of_jump(&self) -> Result<Vec<f64>, SolveError> {
        let mut missed = vec![0.0; 2 * self.mesh.len()];
        let Some(around) = self.scene.surroundings() else { return Ok(missed) };
        let mut add = |e: usize, i: usize, datum: &Datum<'_>| -> Result<(), SolveError> {
            missed[2 * e + i] += steklov_contact::missed(self.mesh, self.space, e, datum)?;
            Ok(())
        };
        for (i, jump) in displacement_jump(self.scene).enumerate().filter(|(_, jump)| jump.constant().is_none()) {
            let function = self.function(jump);
            for e in 0..self.mesh.len() {
                add(e, i % 2, &function.datum("displacement jump"))?;
            }
        }
        // nodes have a linear displacement except on curves; that of the remote stress is the medium's
        let remote = around.remote();
        for (e, i) in (0..self.mesh.len()).filter(|&e| !self.mesh.is_line(e)).flat_map(|e| [(e, 0), (e, 1)]) {
            let value = |site: &Site| remote.displacement(site.point)[i];
            add(e, i, &Datum { name: "remote displacement", value: &value, kinks: &|_| Vec::new(), rounding: None })?;
        }
        Ok(missed)
    }

    /// ∮ φ·(u0 - I_p u0): the first-order gain of J from the part of the jump that the nodes miss.
    pub(crate) fn jump_work(&self, around: &Around) -> Result<f64, SolveError> {
        let space = self.space;
        let mut work = 0.0;
        let jumps = displacement_jump(self.scene);
        for (i, expression) in jumps.enumerate().filter(|(_, jump)| jump.constant().is_none()) {
            let function = self.function(expression);
            let traction = |e: usize, t: f64| -> f64 {
                let mut legendre = vec![0.0; space.degree(e)];
                legendre_p(t, &mut legendre);
                legendre.iter().zip(space.offset[e]..).map(|(p, m)| p * around.traction[2 * m + i]).sum()
            };
            for side in self.interface_sides() {
                work += self.work_on_rest(side, Some(expression), &function.datum("displacement jump"), &traction)?;
            }
        }
        let remote = self.scene.surroundings().map(|s| s.remote()).filter(|_| self.scene.problem.outline.is_curved());
        for (i, remote) in remote.iter().flat_map(|r| [(0, r), (1, r)]) {
            let traction = |e: usize, t: f64| -> f64 {
                let mut legendre = vec![0.0; space.degree(e)];
                legendre_p(t, &mut legendre);
                let sum: f64 =
                    legendre.iter().zip(space.offset[e]..).map(|(p, m)| p * around.traction[2 * m + i]).sum();
                sum * self.mesh.length(e) / 2.0 / self.mesh.speed(e, t)
            };
            let value =
                |site: &Site| if self.mesh.is_line(site.element) { 0.0 } else { remote.displacement(site.point)[i] };
            let datum = Datum { name: "remote displacement", value: &value, kinks: &|_| Vec::new(), rounding: None };
            for side in self.interface_sides() {
                work += self.work_on_rest(side, None, &datum, &traction)?;
            }
        }
        Ok(work)
    }

    /// The sides where body and medium meet.
    pub(crate) fn interface_sides(&self) -> BTreeSet<usize> {
        self.scene.interface().map(|(_, edge)| edge.side).collect()
    }
}

/// The expressions of the jump of the displacement.
fn displacement_jump(scene: &Scene) -> impl Iterator<Item = &Expression> {
    scene.problem.tie().into_iter().flat_map(|tie| tie.displacement_jump.iter().flatten())
}

fn product(matrix: &Mat<f64>, v: &[f64]) -> Vec<f64> {
    (matrix * Col::from_fn(v.len(), |i| v[i])).iter().copied().collect()
}
