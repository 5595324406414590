//! The strain energies of several bodies one by one, and the work of a medium on the jump u0 of the displacement between a body and it, with
//! their slopes.
//!
//! ```text
//! E_k = ½⟨S_k w, w⟩ + ⟨S_k w, u_p⟩ + ½a(u_p, u_p)      slope in w: S_k (w + u_p),      w = u - u_p; of an unbounded body the first term alone
//! R = -⟨S_e ξ, u0⟩                                     slope in ξ: -S_e u0,            ξ = u - u0
//! ```

use steklov_algebra::dot;
use steklov_bem_operators::Enriched;
use steklov_problem::{Multiplier, Scene};

use crate::data::on_mesh::OnMesh;
use crate::data::parts::Assembled;
use crate::error::SolveError;
use crate::estimate::dual::Duals;
use crate::estimate::functionals::{LinearFunctional, OfEnergy};
use crate::solve::solution::Solved;

/// Whether the strain energies of bodies are quantities: of several ones by boundary elements, without springs.
pub(crate) fn has_strain_of_bodies(scene: &Scene) -> bool {
    let of_stabilised = scene.contacts().next().is_some() && scene.method.multiplier == Multiplier::Stabilised;
    scene.problem.has_several_bodies() && !scene.is_on_grid() && !scene.problem.has_springs() && !of_stabilised
}

/// A value by the solution and by the enriched spaces, and its slope.
type WithSlope = ([f64; 2], LinearFunctional);

/// E_k of each body.
pub(crate) fn strain_of_bodies(
    data: &OnMesh<'_>,
    solved: &Solved,
    duals: &Duals<'_>,
    correction: &Enriched,
) -> Vec<WithSlope> {
    let (elastic, condensation) = (duals.system.elastic, duals.system.condensation);
    let of_body = |(k, (&strain, Assembled { piece, .. })): (usize, (&f64, &Assembled))| {
        let stiff = |v: &[f64]| condensation.multiply_body(k, v);
        let enriched = elastic.with_correction(k, correction);
        let forces = elastic.forces_of(k, &enriched, stiff(&enriched.base));
        let mut plus = 0.5 * forces.dot(&enriched);
        let mut slope_at = elastic.with_correction(k, &elastic.zero()).base;
        let bounded = data.scene.problem.bodies[piece.body].far.is_none();
        if let Some(p) = solved.particular.of(piece.part.elements[0]).filter(|_| bounded) {
            let nodal = piece.part.space.interpolate(|x| p.displacement(x));
            plus += dot(&forces.base, &nodal) + 0.5 * p.energies(&piece.part.mesh).0;
            slope_at.iter_mut().zip(&nodal).for_each(|(w, p)| *w += p);
        }
        let (load, top) = elastic.dual_load_of_forces(k, &slope_at, &stiff(&slope_at));
        let of_energy = Some(OfEnergy { piece: k, load, top, of: slope_at });
        ([strain, plus], LinearFunctional { of_energy, ..LinearFunctional::default() })
    };
    solved.strain_of_bodies.iter().zip(&duals.body.pieces).enumerate().map(of_body).collect()
}

/// R of a medium around a body; `jump` are the bubbles of u0.
///
/// # Errors
/// Data that are not finite.
pub(crate) fn work_on_jump(
    data: &OnMesh<'_>,
    solved: &Solved,
    duals: &Duals<'_>,
    (correction, jump): (&Enriched, &[f64]),
) -> Result<Option<WithSlope>, SolveError> {
    let elastic = duals.system.elastic;
    let (Some(medium), Some(outside), Some(around)) = (elastic.medium(duals.body), &duals.body.outside, &solved.around)
    else {
        return Ok(None);
    };
    let mut enriched = elastic.with_correction(medium, correction);
    enriched.extra.iter_mut().zip(jump).for_each(|(u, jump)| *u -= jump);
    let forces = elastic.forces_of(medium, &enriched, outside.multiply(&enriched.base));
    let plus = data.jump_work(around)? - dot(&forces.base, &outside.jump);
    let against: Vec<f64> = outside.jump.iter().map(|jump| -jump).collect();
    let stiff: Vec<f64> = outside.load.iter().map(|load| -load).collect();
    let (load, top) = elastic.dual_load_of_forces(medium, &against, &stiff);
    let of_energy = Some(OfEnergy { piece: medium, load, top, of: against });
    let slope = LinearFunctional { of_energy, ..LinearFunctional::default() };
    Ok(Some(([solved.reaction_work, plus], slope)))
}
