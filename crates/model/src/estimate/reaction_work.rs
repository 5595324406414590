//! The work of supports and obstacles, and that of friction: with them and J the strain energy and the work of loads have error bars.
//!
//! ```text
//! R = Σ u_i r_i over held unknowns  -  Σ D_i g_i λ_n,i                     work of reactions on prescribed displacements and gaps
//! F = Σ D_i λ_t,i u_t,i                                                    work against friction
//! 2E = L + R - F,   J = E - L + F    so that    E = R - J,   L = R + F - 2J
//! ```
//! E with the energy of springs, L the work of loads. R and F are linear in the forces at nodes, whose change by the enriched spaces is known.

use steklov_bem_operators::Enriched;
use steklov_contact::ContactBubble;
use steklov_elastic::plane::dot;
use steklov_problem::{Condition, Friction, Law, Multiplier, Scene};

use crate::data::on_mesh::OnMesh;
use crate::error::SolveError;
use crate::solve::body::{Body, Factors, Loading};
use crate::solve::solution::Solved;

/// The part of Σ |changes of nodes| that a change of the work against friction has at least.
const OF_PARTS: f64 = 0.5;

/// Whether the work of reactions of boundary elements is a quantity: where displacements or gaps may be prescribed, and known.
pub(crate) fn has_reaction_work(scene: &Scene) -> bool {
    let problem = &scene.problem;
    let touches = scene.contacts().next().is_some();
    let jumps = !scene.is_on_grid() && jumps(scene);
    let moves = problem.sides.iter().any(|side| match &side.condition {
        Condition::Displacement { values, .. } => values.iter().flatten().any(|value| value.constant() != Some(0.0)),
        _ => false,
    });
    let known = !(touches && scene.method.multiplier == Multiplier::Stabilised);
    known && (touches || moves || jumps) && (jumps || !is_tied_with_a_jump(scene))
}

/// Whether a displacement jumps between tied bodies: by the jump of the scene, or as that of a medium is without its remote stress.
fn jumps(scene: &Scene) -> bool {
    let remote = scene.far().is_some_and(|far| far.remote_stress != [0.0; 3]);
    let tied = scene.problem.interfaces().iter().any(|interface| matches!(interface.law, Law::Tied(_)));
    is_tied_with_a_jump(scene) || remote && tied
}

fn is_tied_with_a_jump(scene: &Scene) -> bool {
    let has_jump = |law: &Law| matches!(law, Law::Tied(tie) if tie.displacement_jump.is_some());
    scene.problem.interfaces().iter().any(|interface| has_jump(&interface.law))
}

/// Whether the work against friction is a quantity: where something may slip.
pub(crate) fn has_friction_work(scene: &Scene) -> bool {
    let rubs = |friction: &Friction| {
        friction.coefficient().is_some() || friction.bound().is_some_and(|bound| bound.constant() != Some(0.0))
    };
    has_reaction_work(scene) && scene.contacts().any(|(_, contact)| rubs(&contact.friction))
}

impl Body {
    /// (Su - f)·u: the work of all that is not a load; `forces` are S u of the bodies alone.
    pub(crate) fn work_of_forces(&self, given: &Loading, displacement: &[f64], forces: &[f64]) -> f64 {
        let mut own = displacement.to_vec();
        for (body, p) in self.pieces.iter().zip(&given.particular) {
            // the energies of an unbounded body are those without the particular solution
            let Some(p) = p.as_ref().filter(|p| p.relative) else { continue };
            let part = &body.piece.part;
            let less: Vec<f64> = part.own(displacement).iter().zip(&p.displacement).map(|(u, p)| u - p).collect();
            part.set(&mut own, &less);
        }
        own.iter().zip(forces).zip(&given.load).map(|((u, s), f)| u * (s - f)).sum()
    }
}

impl OnMesh<'_> {
    /// What is prescribed at the nodes, two for each, where nothing else is displaced: displacements of supports, along normals gaps of
    /// pressed nodes, and jumps of ties; else zero.
    pub(crate) fn prescribed(&self, solved: &Solved, body: &Body) -> Vec<f64> {
        // the energies of an unbounded body are those of the field without the particular solution
        let remote = self.remote_displacement(solved);
        let mut prescribed = vec![0.0; self.space.dofs()];
        for (index, side) in self.scene.problem.sides.iter().enumerate() {
            for dof in self.nodes_of(index).into_iter().flat_map(|node| [0, 1].map(|i| (2 * node + i, i))) {
                if side.holds(dof.1) {
                    prescribed[dof.0] = solved.displacement[dof.0] - remote[dof.0];
                }
            }
        }
        if let Some(contact) = &solved.contact {
            let [all, of_supports, of_remote] =
                [&solved.displacement, &prescribed, &remote].map(|u| contact.boundary.relative(u));
            let mut multipliers = contact.solution.multipliers.iter();
            for node in &contact.boundary.nodes {
                let own = multipliers.by_ref().take(node.conditions.len());
                let pressed = own.fold(false, |any, [pressure, _]| any | (*pressure > 0.0));
                let dofs = [2 * node.node, 2 * node.node + 1];
                let u = dofs.map(|dof| all[dof]);
                let gap = match &node.conditions[..] {
                    _ if !pressed => continue,
                    [one] => one.normal.map(|n| n * dot(u, one.normal)),
                    _ => u,
                };
                for (i, dof) in
                    dofs.into_iter().enumerate().filter(|(_, dof)| body.held[dof / 2].components[dof % 2].is_none())
                {
                    prescribed[dof] = gap[i] - of_remote[dof] - of_supports[dof];
                }
            }
        }
        let mut whole: Vec<f64> = prescribed.iter().zip(&remote).map(|(own, remote)| own + remote).collect();
        // each comes before those of nodes that it faces
        for tied in body.tied.iter().rev() {
            whole[tied.dof] = 0.0;
            whole[tied.dof] = tied.jump - tied.relative.of(&whole);
            prescribed[tied.dof] = whole[tied.dof] - remote[tied.dof];
        }
        prescribed
    }

    /// The displacement of the remote stress at the nodes of unbounded bodies, two for each; else zero.
    fn remote_displacement(&self, solved: &Solved) -> Vec<f64> {
        let problem = &self.scene.problem;
        let mut remote = vec![0.0; self.space.dofs()];
        let unbounded = |&side: &usize| problem.bodies[problem.body_of_side(side)].far.is_some();
        for side in (0..problem.sides.len()).filter(unbounded) {
            let Some(of_side) = self.particular_of_side(&solved.particular, side) else { continue };
            for node in self.nodes_of(side) {
                remote[2 * node..2 * node + 2].copy_from_slice(&of_side.displacement(self.space.points[node]));
            }
        }
        remote
    }

    /// R of a solution and of the enriched spaces, which change the forces at nodes so; `bubbles` are those of the contact elements.
    ///
    /// # Errors
    /// Data that are not finite.
    pub(crate) fn reaction_work(
        &self,
        (solved, factors): (&Solved, &Factors),
        bubbles: &[ContactBubble],
        prescribed: &[f64],
        change: &[f64],
    ) -> Result<[f64; 2], SolveError> {
        let gained: f64 = prescribed.iter().zip(change).map(|(w, force)| w * force).sum();
        Ok([solved.reaction_work, solved.reaction_work + gained + self.held_work(solved, factors, bubbles)?])
    }

    /// F of a solution, and with what the enriched spaces change, or half of the changes at all nodes without signs: these spaces correct the displacement and change the forces at nodes so.
    ///
    /// # Errors
    /// Data that are not finite.
    pub(crate) fn friction_work(
        &self,
        (solved, factors): (&Solved, &Factors),
        bubbles: &[ContactBubble],
        correction: &Enriched,
        change: &[f64],
    ) -> Result<[f64; 2], SolveError> {
        let Some(contact) = &solved.contact else { return Ok([0.0; 2]) };
        let [u, e] = [&solved.displacement, &correction.base].map(|u| contact.boundary.relative(u));
        let mut parts = vec![self.friction_work_left(solved, factors)?];
        let mut multipliers = contact.solution.multipliers.iter();
        for (node, condensed) in contact.boundary.nodes.iter().zip(&contact.boundary.contact) {
            let at = |of: &[f64], t: [f64; 2]| dot([of[2 * node.node], of[2 * node.node + 1]], t);
            for ((plane, condition), [_, shear]) in
                node.conditions.iter().zip(&condensed.conditions).zip(multipliers.by_ref())
            {
                parts.push(condition.tangent_weight * shear * at(&e, plane.tangent));
            }
            if let ([one], true) = (&node.conditions[..], condensed.conditions[0].tangent_weight > 0.0) {
                parts.push(-at(change, one.tangent) * at(&u, one.tangent));
            }
        }
        parts.extend(bubbles.iter().map(|bubble| {
            let [_, t] = self.contact_frame(bubble.element);
            -bubble.load[1] * dot([0, 1].map(|i| correction.extra[2 * bubble.element + i]), t)
        }));
        let (sum, size) = parts.iter().fold((0.0, 0.0), |(sum, size), part| (sum + part, size + part.abs()));
        // sums cross zero by accident
        let gained = f64::max(f64::abs(sum), OF_PARTS * size).copysign(sum);
        Ok([solved.energies.friction_work, solved.energies.friction_work + gained])
    }
}
