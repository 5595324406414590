//! Residual indicators.

use std::ops::Range;

use steklov_bem_operators::{BoundaryResidual, Look, Site, boundary_residuals_of};
use steklov_contact::{ContactResidual, ContactSolution, Multiplier, contact_residuals_of};

use crate::data::on_mesh::OnMesh;
use crate::error::SolveError;
use crate::solve::solution::Solved;

/// The residual indicator of one element.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Residual {
    /// What is left of the boundary equations.
    pub boundary: BoundaryResidual,
    /// What is left of the contact conditions.
    pub contact: ContactResidual,
}

impl Residual {
    /// η².
    pub fn total(&self) -> f64 {
        self.boundary.total() + self.contact.total()
    }
}

impl OnMesh<'_> {
    /// Residual indicators of some elements.
    pub fn residuals(&self, solved: &Solved, elements: Range<usize>, look: Look) -> Result<Vec<Residual>, SolveError> {
        let body = solved.particular.of(0);
        let traction = |site: &Site| -> [Option<f64>; 2] {
            let e = site.element;
            let given = self.given_traction(e, site.t, solved.on_boundary(e, site.t).0);
            let particular = body.map_or([0.0; 2], |b| b.traction(site.point, self.mesh.normal(e, site.t)));
            [0, 1].map(|i| given[i].map(|t| t - particular[i]))
        };
        let first = elements.start;
        let boundary = boundary_residuals_of(self.mesh, solved.field.of_body(0), &traction, elements.clone(), look)?;
        let mut residuals: Vec<Residual> =
            boundary.into_iter().map(|boundary| Residual { boundary, ..Default::default() }).collect();
        if let Some(contact) = &solved.contact {
            let solution = ContactSolution {
                mesh: self.mesh,
                space: self.space,
                displacement: &solved.displacement,
                multiplier: match &contact.stabilised {
                    Some(s) => Multiplier::Stabilised(&s.space, &s.solution.multipliers),
                    None => Multiplier::Biorthogonal(&contact.boundary, &contact.solution.multipliers),
                },
                field: solved.field.of_body(0),
                body_force: body,
            };
            for residual in
                self.with_contact_data(&[], |sides| contact_residuals_of(&solution, sides, elements, look))?
            {
                residuals[residual.element - first].contact = residual;
            }
        }
        Ok(residuals)
    }
}
