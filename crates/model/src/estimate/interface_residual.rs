//! The effect of the facing body on the bubble of an element.
//!
//! On an element of an interface that is closed, or tied, the body beyond it pulls with -t∘π, t its traction, where an
//! obstacle would only prescribe a displacement. A bubble whose counterpart also deforms may claim no more than the share c/(c
//! + c') of the residual, c = E/(1-ν²): where both sides have the same bubble, both shares together are its energy.

use steklov_contact::ContactBubble;
use steklov_coupling::{Facing, meet};
use steklov_quadrature::{gauss_legendre, legendre_p};

use crate::data::joints::Joint;
use crate::data::on_mesh::OnMesh;
use crate::estimate::nonconformity::POINTS;
use crate::solve::fields::ElasticField;

/// The load on the bubble of an element from beyond an interface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FacingLoad {
    /// The element.
    pub(crate) element: usize,
    /// -∫ t∘π b ds (force per thickness).
    pub(crate) load: [f64; 2],
    /// The share of the residual along n and t that its bubble may claim; none for a component whose force is friction.
    pub(crate) share: [Option<f64>; 2],
}

impl OnMesh<'_> {
    /// The loads of all elements on both sides of closed or tied interfaces; `bubbles` are those of the contact elements.
    pub(crate) fn facing_loads(
        &self,
        joints: &[Joint],
        field: ElasticField<'_>,
        bubbles: &[ContactBubble],
    ) -> Vec<FacingLoad> {
        let mut loads: Vec<FacingLoad> = Vec::new();
        let modulus = self.moduli();
        let side = Facing { mesh: self.mesh, space: self.space, elements: &[], modulus: &modulus };
        for joint in joints {
            for cell in &joint.cells {
                let stuck = if self.is_contact(joint) {
                    let Some(bubble) = bubbles.iter().find(|b| b.element == cell.element) else { continue };
                    if bubble.free[0] {
                        continue;
                    }
                    !bubble.free[1]
                } else {
                    true
                };
                let (e, m) = (cell.element, cell.other);
                let [own, other] = [e, m].map(|e| modulus[e]);
                let (mut on_own, mut on_other) = ([0.0; 2], [0.0; 2]);
                let half = (cell.span[1] - cell.span[0]) / 2.0;
                let rule = gauss_legendre(POINTS);
                for (&g, &w) in rule.points.iter().zip(&rule.weights) {
                    let t = cell.span[0] + half * (1.0 + g);
                    let Some(met) = meet(side, (e, t), side, m) else { continue };
                    let s = met.t.clamp(-1.0, 1.0);
                    let ds = half * w * self.mesh.speed(e, t);
                    let beyond = field.traction(m, s);
                    let here = field.traction(e, t);
                    let (b, b_other) = (self.bubble(e, t), self.bubble(m, s));
                    for i in 0..2 {
                        on_own[i] -= ds * b * beyond[i];
                        on_other[i] -= ds * b_other * here[i];
                    }
                }
                let shares = |part: f64| [Some(part), stuck.then_some(part)];
                add(&mut loads, e, on_own, shares(own / (own + other)));
                add(&mut loads, m, on_other, shares(other / (own + other)));
            }
        }
        loads
    }

    /// b = (P_(p+1) - P_(p-1))/(2p+1) of an element.
    fn bubble(&self, e: usize, t: f64) -> f64 {
        let p = self.space.degree(e);
        let mut legendre = vec![0.0; p + 2];
        legendre_p(t, &mut legendre);
        (legendre[p + 1] - legendre[p - 1]) / (2 * p + 1) as f64
    }
}

fn add(loads: &mut Vec<FacingLoad>, element: usize, load: [f64; 2], share: [Option<f64>; 2]) {
    match loads.iter_mut().find(|of| of.element == element) {
        Some(of) => {
            (0..2).for_each(|i| of.load[i] += load[i]);
            (0..2).for_each(|i| of.share[i] = of.share[i].and(share[i]));
        }
        None => loads.push(FacingLoad { element, load, share }),
    }
}
