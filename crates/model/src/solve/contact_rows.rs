//! Contact as a table: a row for each condition of each contact node.

use steklov_bem_operators::{Mesh, Space};
use steklov_contact::{MultiplierNode, Status};
use steklov_elastic::plane::dot;

use crate::solve::contact::ContactResult;
use crate::solve::solution::Solved;
use crate::solve::stabilised::StabilisedContact;

/// A condition of a contact node: one row of `/contact`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactRow {
    /// The node's point.
    pub point: [f64; 2],
    /// Normal of the condition, out of the body.
    pub normal: [f64; 2],
    /// Weighted gap.
    pub gap: f64,
    /// u_n.
    pub normal_displacement: f64,
    /// u_t.
    pub tangential_displacement: f64,
    /// λ_n.
    pub pressure: f64,
    /// λ_t.
    pub shear: f64,
    /// Friction bound F_i, of Coulomb friction that of the pressure; 0 without friction.
    pub bound: f64,
    /// ∫ψ_i, the length that the node stands for.
    pub weight: f64,
    /// 0 apart, 1 stick, 2 slip along +t, 3 slip along -t.
    pub status: usize,
    /// Side.
    pub side: usize,
}

/// λ_n below this part of the largest is no contact.
pub const TOUCHING: f64 = 1e-12;

/// The boundary of a solved body: its elements, their nodes and the displacement there.
#[derive(Clone, Copy)]
pub struct Trace<'a> {
    /// The elements.
    pub mesh: &'a Mesh,
    /// Their nodes.
    pub space: &'a Space,
    /// Nodal displacement, interleaved.
    pub displacement: &'a [f64],
}

impl Solved {
    /// The boundary of the body.
    pub fn trace(&self) -> Trace<'_> {
        Trace { mesh: &self.mesh, space: &self.space, displacement: &self.displacement }
    }
}

/// One row for each condition of each contact node.
pub fn contact_rows(trace: Trace<'_>, contact: &ContactResult) -> Vec<ContactRow> {
    if let Some(stabilised) = &contact.stabilised {
        return stabilised_rows(trace, stabilised);
    }
    let (displacement, solution) = (contact.boundary.relative(trace.displacement), &contact.solution);
    let mut rows = Vec::with_capacity(solution.multipliers.len());
    for (node, condensed) in contact.boundary.nodes.iter().zip(&contact.boundary.contact) {
        let u = [displacement[2 * node.node], displacement[2 * node.node + 1]];
        for (plane, condition) in node.conditions.iter().zip(&condensed.conditions) {
            let [pressure, shear] = solution.multipliers[rows.len()];
            let share = plane.shares.iter().max_by(|a, b| a.normal.total_cmp(&b.normal));
            rows.push(ContactRow {
                point: node.point,
                normal: plane.normal,
                // a held component adds to the gap in the node's own unknowns what it takes from u_n
                gap: condition.gap + dot(u, plane.normal)
                    - dot(condensed.pick(&solution.displacement), condition.normal),
                normal_displacement: dot(u, plane.normal),
                tangential_displacement: dot(u, plane.tangent),
                pressure,
                shear,
                bound: condition.limit(pressure),
                weight: plane.shares.iter().map(|s| if s.normal > 0.0 { s.normal } else { s.tangent }).sum(),
                status: number(solution.status[rows.len()]),
                side: share.map_or(0, |s| s.side),
            });
        }
    }
    rows
}

/// One row for each node of stabilised multipliers.
fn stabilised_rows(trace: Trace<'_>, contact: &StabilisedContact) -> Vec<ContactRow> {
    let Trace { mesh, space, displacement } = trace;
    let row = |(i, node): (usize, &MultiplierNode)| {
        // the displacement of two elements that meet there is the same
        let at =
            |e: &usize| mesh.edge[*e] == node.edge && (mesh.span[*e][0] - node.s) * (mesh.span[*e][1] - node.s) <= 0.0;
        let u = (0..mesh.len()).find(at).map_or([0.0; 2], |e| {
            let [s0, s1] = mesh.span[e];
            let basis = space.basis(e);
            let mut phi = vec![0.0; basis.degree + 1];
            basis.evaluate(2.0 * (node.s - s0) / (s1 - s0) - 1.0, &mut phi);
            let nodes = space.element_nodes(e).zip(&phi);
            nodes.fold([0.0; 2], |u, (node, phi)| {
                [u[0] + phi * displacement[2 * node], u[1] + phi * displacement[2 * node + 1]]
            })
        });
        let [normal, tangent] = node.frame;
        let condition = &contact.nodes[i].conditions[0];
        let [pressure, shear] = contact.solution.multipliers[i];
        ContactRow {
            point: node.point,
            normal,
            gap: contact.gaps[i],
            normal_displacement: dot(u, normal),
            tangential_displacement: dot(u, tangent),
            pressure,
            shear,
            bound: condition.limit(pressure),
            weight: node.weight,
            status: number(contact.solution.status[i]),
            side: node.side,
        }
    };
    contact.space.nodes.iter().enumerate().map(row).collect()
}

fn number(status: Status) -> usize {
    match status {
        Status::Apart => 0,
        Status::Stick => 1,
        Status::SlipPlus => 2,
        Status::SlipMinus => 3,
    }
}

/// Largest nodal pressure.
pub(crate) fn max_pressure(rows: &[ContactRow]) -> f64 {
    rows.iter().fold(0.0, |m: f64, r| m.max(r.pressure))
}
