//! The dual problems of a grid in a medium: body and medium answer the load of a number together.
//!
//! ```text
//! number in the body        (A_c + Πᵀ S Π) z = -j,             traction of the medium  V⁻¹ (K - ½M) z
//! number of the medium      (A_c + Πᵀ S Π) z = -Πᵀ (j_ξ + (K - ½M)ᵀ V⁻¹ j_φ),        V⁻¹ ((K - ½M) z + j_φ)
//! ```
//! with j_ξ and j_φ the values of the representation formula at a point.

use std::f64::consts::PI;

use rayon::prelude::*;
use steklov_bem_operators::{Enriched, Mesh, SAME_PLACE, Space, distance_to_segment};
use steklov_coupling::{Coupled, Factored, Medium, MediumField, MediumLoad, MediumResiduals, Response};
use steklov_msfem::{CoarseMesh, HeterogeneousBody, Loads};
use steklov_problem::{Scene, Surroundings};
use steklov_quadrature::{gauss_legendre, legendre_p};

use super::coupled::jump_at;
use super::functionals::{GridFunctional, GridFunctionals, Number};
use super::interface_sides::{InterfaceSides, Moments};
use super::solution::GridSolved;
use super::trace::GridTrace;
use crate::error::SolveError;

/// A medium around a grid with the factors of both.
pub(super) struct InMedium {
    pub exterior: Medium,
    pub coupled: Coupled,
    pub factored: Factored,
}

/// The medium's part in a dual problem.
pub(super) struct MediumDual {
    /// η_e of the boundary elements.
    pub etas: Vec<f64>,
    /// The moments of its traction on the sides of the interface.
    pub moments: Vec<Moments>,
}

/// The medium's part in a solution and its dual problems.
pub(super) struct MediumPart {
    pub sides: InterfaceSides,
    /// The moments of the traction of the solution.
    pub moments: Vec<Moments>,
    pub duals: Vec<MediumDual>,
    plane_modulus: f64,
    /// How much J changes by the residuals of the medium, element by element.
    pub of_energy: Vec<f64>,
}

impl InMedium {
    /// The fields of the spaces of one more degree, for [`MediumField::functionals_at`].
    pub fn raised_field(&self) -> MediumField {
        let Medium { mesh, material, operators, .. } = &self.exterior;
        let raised = mesh.raised(&vec![true; mesh.len()]);
        let space = Space::new(&raised);
        let zero = vec![0.0; space.dofs()];
        MediumField::new(&raised, &space, material, operators.length, (&zero, &zero, [0.0; 2]))
    }

    /// The unknowns of the body of all dual problems from their loads there, and the medium's part.
    ///
    /// # Errors
    /// Those of the spaces of one more degree.
    pub fn solve(
        &self,
        scene: &Scene,
        (body, fine): (&HeterogeneousBody, &GridTrace),
        functionals: &[GridFunctional<'_>],
        loads: &[Vec<f64>],
    ) -> Result<(Vec<Vec<f64>>, MediumPart), SolveError> {
        let Self { exterior, coupled, factored } = self;
        let Medium { mesh, space, material, .. } = exterior;
        let jump = |x: [f64; 2]| jump_at(scene, x);
        let outside = functionals.iter().any(|functional| functional.outside.is_some());
        let residuals = MediumResiduals::new(exterior, factored.traction_map(), coupled, &jump, outside)?;
        let sides = InterfaceSides::new(&body.grid, fine, mesh, material.young);
        let of = |(functional, load): (&GridFunctional<'_>, &Vec<f64>)| {
            let values = &functional.outside;
            let own = values.as_ref().map(|values| residuals.load(factored.traction_map(), values));
            let forces = own.as_ref().map_or(vec![0.0; space.dofs()], MediumLoad::opposite);
            let Response { displacement, trace, mut traction } =
                factored.solve(load, &forces).ok_or(SolveError::NotFinite { energy: f64::NAN })?;
            if let Some([_, of_traction]) = values {
                let more = factored.inverse_single_layer(&of_traction.base);
                traction.iter_mut().zip(more).for_each(|(t, more)| *t += more);
            }
            let etas = residuals.weighted(&trace, own.as_ref());
            Ok::<_, SolveError>((displacement, MediumDual { etas, moments: sides.moments(mesh, space, &traction) }))
        };
        let all: Vec<_> = functionals.par_iter().zip(loads).map(of).collect::<Result<_, _>>()?;
        let (solutions, duals) = all.into_iter().unzip();
        let moments = sides.moments(mesh, space, &coupled.traction);
        let of_energy = residuals.of_energy(coupled);
        Ok((solutions, MediumPart { sides, moments, duals, plane_modulus: material.plane_modulus(), of_energy }))
    }
}

/// Whether displacements jump between a body on a grid and the medium around it, or the stress far away makes them.
pub(crate) fn has_jump_work(scene: &Scene) -> bool {
    let jumps = |around: &Surroundings<'_>| around.tie.displacement_jump.is_some() || scene.remote_stress().is_some();
    scene.is_on_grid() && scene.surroundings().is_some_and(|around| jumps(&around))
}

impl GridFunctionals<'_> {
    /// Adds ∫ φ·u0, the work R of the traction of the medium on the jump: 2E = L + R.
    pub fn add_jump_work(&mut self, scene: &Scene, solved: &GridSolved, medium: &InMedium) {
        if !has_jump_work(scene) {
            return;
        }
        let Medium { mesh, space, .. } = &medium.exterior;
        let zero = || Enriched { base: vec![0.0; space.dofs()], extra: vec![0.0; 2 * mesh.len()] };
        let (mut of_traction, mut missed) = (zero(), 0.0);
        let (mut phi, mut legendre) = (vec![0.0; Mesh::MAX_DEGREE + 1], vec![0.0; Mesh::MAX_DEGREE + 1]);
        for e in 0..mesh.len() {
            let (basis, p) = (space.basis(e), space.degree(e));
            let nodal: Vec<[f64; 2]> = basis.nodes.iter().map(|&t| jump_at(scene, mesh.point(e, t))).collect();
            let rule = gauss_legendre(p + MORE_POINTS);
            for (&t, w) in rule.points.iter().zip(&rule.weights) {
                let (phi, legendre) = (&mut phi[..=p], &mut legendre[..=p]);
                basis.evaluate(t, phi);
                legendre_p(t, legendre);
                let (weight, value) = (w * mesh.speed(e, t), jump_at(scene, mesh.point(e, t)));
                for i in 0..2 {
                    let at = |m: usize| 2 * (space.offset[e] + m) + i;
                    (0..p).for_each(|m| of_traction.base[at(m)] += weight * legendre[m] * value[i]);
                    of_traction.extra[2 * e + i] += weight * legendre[p] * value[i];
                    let interpolant: f64 = phi.iter().zip(&nodal).map(|(phi, u)| phi * u[i]).sum();
                    let traction: f64 = (0..p).map(|m| legendre[m] * medium.coupled.traction[at(m)]).sum();
                    missed += weight * traction * (value[i] - interpolant);
                }
            }
        }
        let first = self.functionals.len();
        let of_body = GridFunctional::of_load(f64::NAN, Loads::default());
        self.functionals.push(GridFunctional { outside: Some([zero(), of_traction]), ..of_body });
        let value = 2.0 * solved.energies.strain - solved.energies.load_work;
        self.numbers.push(Number { value, sum: vec![(first, 1.0)], off: f64::abs(missed) });
    }
}

/// Gauss points for a jump, more than the degree.
const MORE_POINTS: usize = 6;

impl MediumPart {
    /// η_e of all numbers, those of an element one after the other.
    pub fn of_elements(&self) -> Vec<f64> {
        (0..self.of_energy.len()).flat_map(|e| self.duals.iter().map(move |dual| dual.etas[e])).collect()
    }

    /// How much the medium resists the displacement of a fine node between two coarse vertices, for each fine unknown: a half plane resists
    /// sin(πx/H) by πE'/(2H), here times the length that belongs to the node.
    pub fn resistance(&self, body: &HeterogeneousBody, mesh: &CoarseMesh) -> Vec<f64> {
        let mut resistance = vec![0.0; body.grid.dofs()];
        let largest = mesh.cells.iter().flat_map(|cell| cell.size).fold(1, usize::max);
        for side in &self.sides.sides {
            for node in side.nodes {
                let own = PI * self.plane_modulus / (4.0 * largest as f64);
                (0..2).for_each(|i| resistance[2 * node + i] += own);
            }
        }
        resistance
    }
}

/// Boundary elements up to which there are few.
const FEW: usize = 4;

impl GridSolved {
    /// Whether the boundary elements of a medium are few, or longer than the pieces of the trace: the fields are then equal in the mean alone,
    /// and what is between is not seen.
    pub(crate) fn has_coarse_medium(&self) -> bool {
        let Some(around) = &self.around else { return false };
        let longest = |mesh: &Mesh| (0..mesh.len()).map(|e| mesh.length(e)).fold(0.0, f64::max);
        around.mesh.len() <= FEW || longest(&around.mesh) > (1.0 + SAME_PLACE) * longest(&self.trace.mesh)
    }

    /// Which of these points are in the medium nearer to a boundary element than it is long: stresses have the error of its tractions there.
    pub(crate) fn beside_medium(&self, points: &[[f64; 2]]) -> Vec<usize> {
        let Some(around) = &self.around else { return Vec::new() };
        let mesh = &around.mesh;
        let is_near = |x: [f64; 2]| (0..mesh.len()).any(|e| distance_to_segment(x, mesh.ends(e)) < mesh.length(e));
        let is_outside = |x: [f64; 2]| self.body.grid.locate(x).is_none();
        (0..points.len()).filter(|&k| is_outside(points[k]) && is_near(points[k])).collect()
    }
}
