//! The effect of the facing body on the bubble of an element.
//!
//! On an element of an interface that is closed, or tied, the body beyond it pulls with -t∘π, t its traction, where an
//! obstacle would only prescribe a displacement. A bubble whose counterpart also deforms may claim no more than the share c/(c
//! + c') of the residual, c = E/(1-ν²): where both sides have the same bubble, both shares together are its energy.

use steklov_bem_operators::Site;
use steklov_contact::ContactBubble;
use steklov_coupling::{Cell, Facing, Met, meet};
use steklov_elastic::plane::{dot, turned};
use steklov_problem::Law;
use steklov_quadrature::{gauss_legendre, legendre_p, project as legendre_project};

use crate::data::joints::Joint;
use crate::data::on_mesh::OnMesh;
use crate::solve::fields::ElasticField;

/// Distances below this part of the displacements are zero.
const ROUNDED: f64 = 1e-13;
/// Gauss points on a cell.
const POINTS: usize = 24;

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

/// The nonconformity of displacements that agree in the mean only.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Nonconformity {
    /// ∫ λ·w (energy).
    pub(crate) work: f64,
    /// Carrying elements, and the energy of w on one of their cells.
    pub(crate) energies: Vec<(usize, f64)>,
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

    /// The nonconformity w = [u] - g n, or [u] - j, of displacements that agree in the mean only, where the interface is
    /// closed, stuck or tied: ∫ λ·w, the first-order error of J, which is stationary together with -λ·w, λ the mean of the
    /// tractions of both sides; and for each carrying element E*/2 ‖w‖ ‖dw/ds‖ of its cells, the energy of w as a displacement
    /// of the boundary.
    pub(crate) fn nonconformity(
        &self,
        joints: &[Joint],
        field: ElasticField<'_>,
        bubbles: &[ContactBubble],
    ) -> Nonconformity {
        let mut found = Nonconformity::default();
        for joint in joints {
            let interface = &self.scene.problem.interfaces()[joint.interface];
            for cell in &joint.cells {
                let bubble = bubbles.iter().find(|b| b.element == cell.element);
                let closed = match (&interface.law, bubble) {
                    (Law::Tied(_), _) => [true; 2],
                    (Law::Contact(_), Some(bubble)) => bubble.free.map(|free| !free),
                    (Law::Contact(_), None) => continue,
                };
                let [work, energy] = self.left_of_cell(&interface.law, cell, field, closed);
                found.work += work;
                found.energies.push((cell.element, energy));
            }
        }
        found
    }

    /// Work and energy of the nonconformity on one cell.
    fn left_of_cell(&self, law: &Law, cell: &Cell, field: ElasticField<'_>, closed: [bool; 2]) -> [f64; 2] {
        let Cell { element: e, span, other: m } = *cell;
        let half = (span[1] - span[0]) / 2.0;
        let rule = gauss_legendre(POINTS);
        let moduli = self.moduli();
        let side = Facing { mesh: self.mesh, space: self.space, elements: &[], modulus: &moduli };
        let (mut work, mut lefts, mut here_largest) = (0.0, vec![[0.0; 2]; POINTS], 0.0f64);
        for (k, (&g, &w)) in rule.points.iter().zip(&rule.weights).enumerate() {
            let t = span[0] + half * (1.0 + g);
            let Some(Met { t: s, direction: n, .. }) = meet(side, (e, t), side, m) else { continue };
            let (s, tangent) = (s.clamp(-1.0, 1.0), turned(n));
            let [(here, _), (beyond, _)] = [field.on_boundary(e, t), field.on_boundary(m, s)];
            let [pull, push] = [field.traction(e, t), field.traction(m, s)];
            let apart = self.left_apart(law, &Site::new(self.mesh, e, t), n);
            here_largest = here.into_iter().chain(beyond).fold(here_largest, |m, u| m.max(u.abs()));
            for (i, d) in [n, tangent].into_iter().enumerate().filter(|(i, _)| closed[*i]) {
                let along = |v: [f64; 2]| dot(v, d);
                lefts[k][i] = along(here) - along(beyond) - along(apart);
                let traction = (along(push) - along(pull)) / 2.0;
                work += half * w * self.mesh.speed(e, t) * traction * lefts[k][i];
            }
        }
        let modulus = self.scene.problem.contact_modulus(self.mesh.edge[e]);
        let largest = here_largest.max(f64::MIN_POSITIVE);
        let of = |i: usize| {
            if lefts.iter().all(|left| left[i].abs() <= ROUNDED * largest) {
                return 0.0;
            }
            let mut values = lefts.iter().map(|left| left[i]);
            let series = legendre_project(|_| values.next().unwrap_or(0.0), POINTS - 1, &rule);
            // lengths cancel in the norms of w and dw/ds
            modulus / 2.0 * series.norm() * series.derivative().norm()
        };
        let energy = of(0) + of(1);
        [work, energy]
    }

    /// The distance between two points that a law joins: the gap along n, the jump of a tie.
    fn left_apart(&self, law: &Law, site: &Site, n: [f64; 2]) -> [f64; 2] {
        match law {
            Law::Contact(contact) => {
                let gap = (self.gap(self.mesh.side[site.element], &contact.gap).value)(site);
                n.map(|n| gap * n)
            }
            Law::Tied(tie) => tie
                .displacement_jump
                .as_ref()
                .map_or([0.0; 2], |jump| jump.each_ref().map(|jump| self.value(jump, site))),
        }
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
