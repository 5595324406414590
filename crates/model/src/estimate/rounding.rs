//! Whether an answer is exact, or only looks so to the functions of its mesh.

use steklov_bem_operators::Look;
use steklov_problem::Scene;

use crate::data::on_mesh::OnMesh;
use crate::doubt::Doubt;
use crate::error::SolveError;
use crate::estimate::error_estimate::{Estimate, ROUNDOFF};
use crate::estimate::residual::Residual;
use crate::solve::equilibrium::UNBALANCED;
use crate::solve::solution::Solved;

impl Estimate {
    /// Withdraws the doubts about an exact answer: its residuals at all points, not only against bubbles, are down at rounding
    /// errors as well. The doubt that Coulomb's law has several solutions stays.
    pub(crate) fn settle_exact(&mut self, scene: &Scene, solved: &Solved) -> Result<(), SolveError> {
        let unbalanced = solved.contact.as_ref().is_some_and(|c| c.audit.equilibrium > UNBALANCED);
        let judged = self.relative < ROUNDOFF;
        // residuals do not cover a medium around a body, nor other bodies or subdomains
        let alone = solved.around.is_none() && !scene.problem.has_several_bodies() && !solved.field.is_cut();
        if !judged || unbalanced || !alone || self.doubts.contains(&Doubt::Data) {
            return Ok(());
        }
        if leaves_less(scene, solved, ROUNDOFF * self.scale)? {
            self.doubts.retain(|doubt| *doubt == Doubt::Several);
        }
        Ok(())
    }
}

/// Number of elements that are examined before it is decided whether the others matter.
const GROUP: usize = 64;

/// Whether residuals at a few points of every element add up to no more than an error (energy norm); to zero if the answer is
/// 0. A residual above rounding errors anywhere mostly shows in the first group: residuals of polynomials reach everywhere.
fn leaves_less(scene: &Scene, solved: &Solved, error: f64) -> Result<bool, SolveError> {
    let Solved { mesh, space, .. } = solved;
    let data = OnMesh { scene, mesh, space };
    let mut left = 0.0;
    for start in (0..mesh.len()).step_by(GROUP) {
        let group = start..(start + GROUP).min(mesh.len());
        left += data.residuals(solved, group, Look::Quick)?.iter().map(Residual::total).sum::<f64>();
        if left.sqrt() > error {
            return Ok(false);
        }
    }
    Ok(left.sqrt() <= error)
}
