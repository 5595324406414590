//! The change of J by rotations of bodies with curves.
//!
//! The polynomials of curved elements have no rotations among them, so that a body that turns has the displacement I_p(u - r) + r,
//! r its motion. Loads act on I_p u in the equations: the rest δ = r - I_p r does the work ∫ (t - t_p)·δ that J does not have, t_p
//! the traction of the particular solution. Of several bodies the loads have that work themselves.

use steklov_quadrature::gauss_legendre;

use crate::data::on_mesh::OnMesh;
use crate::solve::body::Body;
use crate::solve::solution::Solved;

/// Gauss points beyond those of polynomials.
const MORE: usize = 16;

impl OnMesh<'_> {
    /// The first-order gain of J by δ; `homogeneous` is the nodal displacement without particular solutions.
    pub(crate) fn turning_work(&self, solved: &Solved, body: &Body, homogeneous: &[f64]) -> f64 {
        if self.scene.problem.has_several_bodies() {
            return 0.0;
        }
        let mut work = 0.0;
        for assembled in &body.pieces {
            let piece = &assembled.piece;
            let Some(motion) = assembled.motion(&piece.part.own(homogeneous)) else { continue };
            for e in piece.part.elements.iter().copied().filter(|&e| e < self.mesh.len() && !self.mesh.is_line(e)) {
                let basis = self.space.basis(e);
                let rule = gauss_legendre(basis.degree + MORE);
                let nodal: Vec<[f64; 2]> =
                    self.space.element_nodes(e).map(|node| motion.at(self.space.points[node])).collect();
                let mut phi = vec![0.0; basis.degree + 1];
                for (&t, &w) in rule.points.iter().zip(&rule.weights) {
                    basis.evaluate(t, &mut phi);
                    let (x, traction) = (self.mesh.point(e, t), solved.field.trace(e, t).traction);
                    for (i, exact) in motion.at(x).into_iter().enumerate() {
                        let follows: f64 = nodal.iter().zip(&phi).map(|(r, phi)| r[i] * phi).sum();
                        work -= w * self.mesh.speed(e, t) * traction[i] * (exact - follows);
                    }
                }
            }
        }
        work
    }
}
