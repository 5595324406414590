//! Residual indicators.

use std::ops::Range;

use steklov_bem_operators::{BoundaryResidual, Look, Site, boundary_residuals_of};
use steklov_contact::{ContactResidual, ContactSolution, Multiplier, contact_residuals_of};
use steklov_problem::Scene;

use crate::data::on_mesh::OnMesh;
use crate::error::SolveError;
use crate::estimators::{Estimator, ON_BOUNDARY, STABILISATION};
use crate::solve::solution::Solved;

/// The residual indicator of one element.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Residual {
    /// The residuals of the boundary equations.
    pub boundary: BoundaryResidual,
    /// The residuals of the contact conditions.
    pub contact: ContactResidual,
    /// E*/2 ‖w‖ ‖dw/ds‖ of the part w = u_D - I_p u_D of a held displacement that the nodes miss.
    pub held: f64,
}

impl Residual {
    /// η².
    pub fn total(&self) -> f64 {
        self.boundary.total() + self.contact.total() + self.held
    }

    /// The residual of an element with the terms that [`Self::terms`] gives.
    pub fn of_terms(element: usize, terms: [f64; ON_BOUNDARY.len()]) -> Self {
        let [neumann, equation, contact, stabilisation, complementarity, tension, penetration, bound, friction, held] =
            terms;
        Self {
            boundary: BoundaryResidual { neumann, equation },
            contact: ContactResidual {
                element,
                contact,
                stabilisation,
                complementarity,
                tension,
                penetration,
                bound,
                friction,
            },
            held,
        }
    }

    /// The term of each name in [`ON_BOUNDARY`].
    pub fn terms(&self) -> [f64; ON_BOUNDARY.len()] {
        let (b, c) = (&self.boundary, &self.contact);
        [
            b.neumann,
            b.equation,
            c.contact,
            c.stabilisation,
            c.complementarity,
            c.tension,
            c.penetration,
            c.bound,
            c.friction,
            self.held,
        ]
    }
}

/// Terms of contact, stabilised or not.
const OF_CONTACT: Range<usize> = 2..9;

/// Whether the boundary elements of a scene have residuals: residuals do not cover a medium around a body, nor other bodies.
pub fn knows_residuals(scene: &Scene) -> bool {
    !scene.is_inclusion() && !scene.problem.has_several_bodies()
}

/// The estimator of a solution by boundary elements from the residuals of all elements.
pub fn estimator(residuals: &[Residual], solved: &Solved) -> Estimator {
    let applies = |k: usize| match &solved.contact {
        None => !OF_CONTACT.contains(&k),
        Some(contact) => contact.stabilised.is_some() || ON_BOUNDARY[k].0 != STABILISATION,
    };
    let terms: Vec<_> = residuals.iter().map(Residual::terms).collect();
    let sum = |k: usize| (ON_BOUNDARY[k].0, terms.iter().map(|terms| terms[k]).sum());
    Estimator::new((0..ON_BOUNDARY.len()).filter(|&k| applies(k)).map(sum), (2.0 * solved.energies.strain).sqrt())
}

impl OnMesh<'_> {
    /// Residuals of all elements, with the part of held displacements that the nodes miss.
    ///
    /// # Errors
    /// Data that are not finite.
    pub fn all_residuals(&self, solved: &Solved) -> Result<Vec<Residual>, SolveError> {
        let mut residuals = self.residuals(solved, 0..self.mesh.len(), Look::Close)?;
        for (e, oscillation) in self.held_oscillation(&solved.particular)? {
            residuals[e].held += self.material_of(e).plane_modulus() / 2.0 * oscillation;
        }
        Ok(residuals)
    }

    /// Residuals of some elements.
    pub(crate) fn residuals(
        &self,
        solved: &Solved,
        elements: Range<usize>,
        look: Look,
    ) -> Result<Vec<Residual>, SolveError> {
        let body = solved.particular.of(0);
        let traction = |site: &Site| -> [Option<f64>; 2] {
            let e = site.element;
            let given = self.given_traction(e, site.t, solved.on_boundary(e, site.t).0);
            let particular = body.map_or([0.0; 2], |b| b.traction(site.point, self.mesh.normal(e, site.t)));
            [0, 1].map(|i| given[i].map(|t| t - particular[i]))
        };
        let first = elements.start;
        let boundary = boundary_residuals_of(self.mesh, solved.field.of_piece(0), &traction, elements.clone(), look)?;
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
                field: solved.field.of_piece(0),
                body_force: body,
            };
            let contact = self.with_contact_data(&[], |sides| contact_residuals_of(&solution, sides, elements, look));
            for residual in contact? {
                residuals[residual.element - first].contact = residual;
            }
        }
        Ok(residuals)
    }
}
