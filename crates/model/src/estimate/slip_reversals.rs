//! What contact nodes leave of the places where slip turns.
//!
//! ```text
//! s₀    u_t = 0: where friction turns from λ_i to λ_{i+1} = -λ_i
//! s_i   Σ_{k ≤ i} ∫φ_k ds: where the friction of the nodes does, i the last node of one sign
//! ΔJ = -(λ_i - λ_{i+1}) (s₀ - s_i) [z]·t
//! ```
//! z is the dual solution of J, [z] what it slips. A node that sticks between both takes the friction that balances it: then nothing is left.
//!
//! *Fails when* slip turns twice between two nodes.

use steklov_contact::LinePoint;

use crate::answer::report::sticks;
use crate::data::on_mesh::OnMesh;
use crate::solve::contact::ContactResult;
use crate::solve::contact_rows::{ContactRow, contact_rows};
use crate::solve::solution::Solved;

/// A point this far beyond an end of an element (reference coordinate) is on it.
const ON_ELEMENT: f64 = 1e-9;

/// A place where slip turns between two nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SlipReversal {
    /// Element and reference coordinate.
    pub(crate) place: (usize, f64),
    /// Those of the place that it faces on another body.
    pub(crate) faced: Option<(usize, f64)>,
    /// The force on the first body that nodes leave out (force/thickness).
    pub(crate) force: [f64; 2],
}

impl OnMesh<'_> {
    /// The reversals of slip of a solution; none of stabilised multipliers.
    pub(crate) fn slip_reversals(&self, solved: &Solved, contact: &ContactResult) -> Vec<SlipReversal> {
        if contact.stabilised.is_some() {
            return Vec::new();
        }
        let rows = contact_rows(solved.trace(), contact);
        let lines = contact.boundary.lines(self.mesh, self.space);
        let pairs = lines.iter().flat_map(|line| line.points.windows(2).map(|pair| (line.edge, [pair[0], pair[1]])));
        pairs.filter_map(|(edge, pair)| self.slip_reversal(edge, pair, (contact, &rows))).collect()
    }

    fn slip_reversal(
        &self,
        edge: usize,
        pair: [LinePoint; 2],
        (contact, rows): (&ContactResult, &[ContactRow]),
    ) -> Option<SlipReversal> {
        let slips = pair.iter().all(|point| {
            let row = &rows[point.index];
            row.bound > 0.0 && !sticks(row.shear, row.bound)
        });
        if !slips || pair.iter().map(|point| rows[point.index].shear).product::<f64>() >= 0.0 {
            return None;
        }
        let mut on_edge = (0..self.mesh.len()).filter(|&e| self.mesh.edge[e] == edge);
        let within = |e: usize, s: f64| {
            let [start, end] = self.mesh.span[e];
            2.0 * (s - start) / (end - start) - 1.0
        };
        let inside = |t: f64| t.abs() <= 1.0 + ON_ELEMENT;
        let e = on_edge.find(|&e| pair.iter().all(|point| inside(within(e, point.s))))?;
        let mut ends = pair.map(|point| (within(e, point.s), rows[point.index]));
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [(a, before), (b, after)] = ends;
        let slip = [before, after].map(|row| row.tangential_displacement.abs());
        let turns = if slip[0] + slip[1] > 0.0 { a + (b - a) * slip[0] / (slip[0] + slip[1]) } else { (a + b) / 2.0 };
        let basis = self.space.basis(e);
        let shares = basis.nodes.iter().zip(&basis.weights).filter(|(t, _)| **t < (a + b) / 2.0);
        let of_nodes = shares.map(|(_, weight)| weight).sum::<f64>() - 1.0;
        let left_out = -(before.shear - after.shear) * (turns - of_nodes) * self.mesh.speed(e, turns);
        let tangent = contact.boundary.nodes[pair[0].node].conditions[pair[0].condition].tangent;
        let faced = self.seen(e, turns).and_then(|seen| {
            let mut on_edge = (0..self.mesh.len()).filter(|&m| self.mesh.edge[m] == seen.edge);
            on_edge.find(|&m| inside(within(m, seen.s))).map(|m| (m, within(m, seen.s)))
        });
        Some(SlipReversal { place: (e, turns), faced, force: tangent.map(|t| left_out * t) })
    }
}
