//! Whether an answer is exact, or only looks so to the functions of its mesh.

use std::ops::Range;

use steklov_bem_operators::{BoundaryResidual, Look, Site, Subdomain, boundary_residuals_of};
use steklov_problem::Scene;

use crate::data::on_mesh::OnMesh;
use crate::doubt::Doubt;
use crate::error::SolveError;
use crate::estimate::error_estimate::{Estimate, ROUNDOFF};
use crate::estimate::residual::Residual;
use crate::solve::body::Body;
use crate::solve::equilibrium::UNBALANCED;
use crate::solve::solution::Solved;

impl Estimate {
    /// Withdraws the doubts about an exact answer: its residuals at all points, not only against bubbles, are down at rounding
    /// errors as well. The doubt that Coulomb's law has several solutions stays.
    pub(crate) fn settle_exact(&mut self, scene: &Scene, solved: &Solved, body: &Body) -> Result<(), SolveError> {
        let unbalanced = solved.contact.as_ref().is_some_and(|c| c.audit.equilibrium > UNBALANCED);
        let judged = self.relative < ROUNDOFF;
        // residuals do not cover a medium around a body, nor other bodies, nor contact and body forces of subdomains
        let alone = solved.around.is_none() && !scene.problem.has_several_bodies();
        let covered = !solved.field.is_cut() || solved.contact.is_none() && solved.particular.is_empty();
        if !judged || unbalanced || !alone || !covered || self.doubts.contains(&Doubt::Data) {
            return Ok(());
        }
        if leaves_less(scene, solved, body, ROUNDOFF * self.scale)? {
            self.doubts.retain(|doubt| *doubt == Doubt::Several);
        }
        Ok(())
    }
}

/// Number of elements that are examined before it is decided whether the others matter.
const GROUP: usize = 64;

/// Whether residuals at a few points of every element add up to no more than an error (energy norm); to zero if the answer is
/// 0. A residual above rounding errors anywhere mostly shows in the first group: residuals of polynomials reach everywhere.
fn leaves_less(scene: &Scene, solved: &Solved, body: &Body, error: f64) -> Result<bool, SolveError> {
    let Solved { mesh, space, .. } = solved;
    let data = OnMesh { scene, mesh, space };
    let mut left = 0.0;
    for (k, piece) in body.pieces.iter().enumerate() {
        let elements = piece.piece.part.mesh.len();
        for start in (0..elements).step_by(GROUP) {
            let group = start..(start + GROUP).min(elements);
            left += match solved.field.is_cut() {
                false => data.residuals(solved, group, Look::Quick)?.iter().map(Residual::total).sum::<f64>(),
                true => {
                    let of_subdomain = data.residuals_of_subdomain(solved, body, k, group)?;
                    of_subdomain.iter().map(BoundaryResidual::total).sum()
                }
            };
            if left.sqrt() > error {
                return Ok(false);
            }
        }
    }
    Ok(left.sqrt() <= error)
}

impl OnMesh<'_> {
    /// Residuals of some elements of a subdomain, which bears the traction of the other side on its cuts.
    fn residuals_of_subdomain(
        &self,
        solved: &Solved,
        body: &Body,
        k: usize,
        elements: Range<usize>,
    ) -> Result<Vec<BoundaryResidual>, SolveError> {
        let part = &body.pieces[k].piece.part;
        let parts = || body.pieces.iter().map(|body| &body.piece.part).enumerate();
        let other_side = |e: usize| {
            let of = |(other, part): (usize, &Subdomain)| Some((other, part.elements.iter().position(|&f| f == e)?));
            parts().filter(|(other, _)| *other != k).find_map(of)
        };
        let others: Vec<Option<(usize, usize)>> =
            part.elements.iter().map(|&e| if e < self.mesh.len() { None } else { other_side(e) }).collect();
        let traction = |site: &Site| match others[site.element] {
            // which is traversed the other way
            Some((other, local)) => solved.field.of_piece(other).trace(local, -site.t).traction.map(|t| Some(-t)),
            None => {
                let (e, t) = (part.elements[site.element], site.t);
                self.given_traction(e, t, solved.on_boundary(e, t).0)
            }
        };
        Ok(boundary_residuals_of(&part.mesh, solved.field.of_piece(k), &traction, elements, Look::Quick)?)
    }
}
