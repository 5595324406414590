//! Whether an answer is exact, or only looks so to the functions of its mesh.

use crate::body::UNBALANCED;
use crate::data::Data;
use crate::estimate::{Doubt, Estimate, ROUNDOFF, Residual};
use crate::scene::Scene;
use crate::solve::{SolveError, Solved};

impl Estimate {
    /// Takes back the doubts about an answer that is exact: what it leaves of the equations at all points, not only against
    /// bubbles, is down at rounding errors as well. That Coulomb's law has several solutions stays.
    pub(crate) fn settle_exact(&mut self, scene: &Scene, solved: &Solved) -> Result<(), SolveError> {
        let unbalanced = solved.contact.as_ref().is_some_and(|c| c.audit.equilibrium > UNBALANCED);
        // residuals know no medium around a body
        if self.relative >= ROUNDOFF || unbalanced || solved.around.is_some() || self.doubts.contains(&Doubt::Data) {
            return Ok(());
        }
        let Solved { mesh, space, .. } = solved;
        let left: f64 = Data { scene, mesh, space }.residuals(solved)?.iter().map(Residual::total).sum();
        if left.sqrt() < ROUNDOFF * self.scale {
            self.doubts.retain(|doubt| *doubt == Doubt::Several);
        }
        Ok(())
    }
}
