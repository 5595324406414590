//! The nodes of a mesh in contact, their conditions, and the forces that multipliers are.

use steklov_bem_operators::{Dof, Relative, relative_displacement};

use crate::{ContactNode, Status};

/// The contribution of a condition's multipliers to the force on one side: λ_n `normal` n + λ_t `tangent` t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Side of the mesh.
    pub side: usize,
    /// ∫ ψ̃_i of the normal multiplier over the side (length).
    pub normal: f64,
    /// ∫ ψ̃_i of the tangential multiplier over the side (length).
    pub tangent: f64,
}

/// One condition of a boundary node, in the frame of the plane.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryCondition {
    /// Outward unit normal n.
    pub normal: [f64; 2],
    /// Unit tangent, n turned by +90°.
    pub tangent: [f64; 2],
    /// Its shares, one for each side (two where straight edges of two contact sides meet).
    pub shares: Vec<Share>,
}

/// A node that carries contact conditions.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryNode {
    /// Number of the displacement node in the space.
    pub node: usize,
    /// The point.
    pub point: [f64; 2],
    /// Unit directions of its unknowns: (n, t), or n alone where nothing resists t; x and y at a corner; the free one of x and y
    /// if the other is held.
    pub directions: Vec<[f64; 2]>,
    /// (n, t) of a node with one normal that is not held.
    pub frame: Option<[[f64; 2]; 2]>,
    /// Its conditions, as many as those of the contact node.
    pub conditions: Vec<BoundaryCondition>,
}

/// The contact nodes of a mesh and their conditions; entry i of `nodes` and of `contact` belong together.
///
/// Each node j of a contact element has the weight D_j = w_j |γ'(t_j)| > 0, the ∫ φ_j of lines and arcs, and the dual function ψ_j,
/// ∫ ψ_i φ_j = δ_ij D_j, Σ ψ_j = 1. With sums over the contact elements at the node, g_i = (1/D_i) ∫ g ψ_i, and
/// F_i, and likewise μ_i, is the mean of F(x_i) weighted by D (the limits from both sides where F jumps), so that Σ D_i F_i |u_t,i| is the
/// Lobatto rule of ∫ F |u_t|.
///
/// - Where g jumps between two elements, g_i is that of the lower side alone: u_n, which is continuous, obeys it.
/// - Where the contact boundary bends, the node has the unknowns (u_x, u_y) and a condition for each side of it.
/// - A node that is held has no multiplier in the directions in which it cannot move. Its ψ is then added to that of
///   the nearest node of the same element, ψ̃_next = ψ_next + ψ_end, so that Σ ψ̃_i = 1 still; the condition there is
///   D_next u_n,next + D_end u_n,end ≤ ∫ g ψ̃_next, and the held u_t,end appears as `slip_offset`.
///
/// Source: Issaoui (2014), equations (2.20) and (2.30); Hüeber (2008) for degree 1.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactBoundary {
    /// Where the nodes are.
    pub nodes: Vec<BoundaryNode>,
    /// The data of the nodes for a [`Problem`](crate::Problem).
    pub contact: Vec<ContactNode>,
    /// The ends without multipliers whose dual functions went to neighbours.
    pub transfers: Vec<Transfer>,
    /// The contact elements, rising.
    pub elements: Vec<usize>,
    /// The relative displacements of nodes that face other bodies.
    pub rows: Vec<Row>,
}

/// The relative displacement that a multiplier acts on.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Number of the condition in the order of the multipliers.
    pub condition: usize,
    /// 0 for λ_n, 1 for λ_t.
    pub functional: usize,
    /// w.
    pub relative: Relative,
}

/// An end whose dual function went to a neighbour, because it is held or meets another interface: the obstacle presses on it with
/// -`weight` λ `direction`, λ being the neighbour's multiplier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transfer {
    /// Number of the displacement node of the held end.
    pub node: usize,
    /// Number of the neighbour's condition in the order of the multipliers.
    pub condition: usize,
    /// 0 for λ_n, 1 for λ_t.
    pub functional: usize,
    /// D_end (length).
    pub weight: f64,
    /// The normal or tangent there.
    pub direction: [f64; 2],
    /// Whether a support holds it, so that its displacement is in the gap.
    pub held: bool,
}

impl ContactBoundary {
    /// max |g| over all conditions (length).
    pub fn largest_gap(&self) -> f64 {
        let conditions = self.contact.iter().flat_map(|node| &node.conditions);
        conditions.fold(0.0, |m: f64, c| m.max(c.gap.abs()))
    }

    /// Bᵀλ: the force of the body on the obstacle at each displacement node (force per thickness), nodes with several
    /// contributions several times.
    pub fn nodal_forces(&self, multipliers: &[[f64; 2]]) -> Vec<(usize, [f64; 2])> {
        let mut forces = Vec::new();
        for (node, contact) in self.nodes.iter().zip(&self.contact) {
            for (plane, condition) in node.conditions.iter().zip(&contact.conditions) {
                let [pressure, shear] = multipliers[forces.len()];
                let (n, t) = (condition.normal_weight * pressure, condition.tangent_weight * shear);
                forces.push((node.node, [0, 1].map(|i| n * plane.normal[i] + t * plane.tangent[i])));
            }
        }
        let carried = self.transfers.iter().filter(|t| t.held).map(|t| {
            let force = t.weight * multipliers[t.condition][t.functional];
            (t.node, t.direction.map(|d| force * d))
        });
        forces.extend(carried);
        for Row { condition, functional, relative } in &self.rows {
            let force = self.weight(*condition, *functional) * multipliers[*condition][*functional];
            forces.extend(relative.faced.iter().map(|&(node, c)| (node, c.map(|c| -force * c))));
        }
        forces
    }

    /// D of a multiplier.
    pub fn weight(&self, condition: usize, functional: usize) -> f64 {
        let of = self.contact.iter().flat_map(|node| &node.conditions).nth(condition);
        of.map_or(0.0, |c| if functional == 0 { c.normal_weight } else { c.tangent_weight })
    }

    /// A nodal displacement, relative at the nodes that face other bodies.
    pub fn relative(&self, displacement: &[f64]) -> Vec<f64> {
        relative_displacement(self.rows.iter().map(|row| &row.relative), displacement)
    }

    /// The displacement unknowns in the order of the problem's unknowns, numbered along [`Self::frames`] (for
    /// `Partition::kept`).
    pub fn kept(&self) -> Vec<Dof> {
        let of = |n: &BoundaryNode| -> Vec<Dof> {
            match (n.directions.as_slice(), n.frame) {
                ([_], Some(_)) => vec![2 * n.node],
                (&[d], None) => vec![2 * n.node + usize::from(d[0] == 0.0)],
                _ => vec![2 * n.node, 2 * n.node + 1],
            }
        };
        self.nodes.iter().flat_map(of).collect()
    }

    /// Nodes whose unknowns are along (n, t) (for `Partition::frames`).
    pub fn frames(&self) -> Vec<(usize, [[f64; 2]; 2])> {
        self.nodes.iter().filter_map(|n| Some((n.node, n.frame?))).collect()
    }

    /// The same without the tangential unknowns of nodes with one normal whose sides are all frictionless: no condition
    /// contains them, and they are eliminated with the unknowns off the contact boundary.
    pub fn without_tangents(mut self, frictionless: &dyn Fn(usize) -> bool) -> Self {
        let mut first = 0;
        for (node, contact) in self.nodes.iter_mut().zip(&mut self.contact) {
            let free = node.conditions[0].shares.iter().all(|share| frictionless(share.side));
            if let (Some([normal, _]), true) = (node.frame, free) {
                node.directions = vec![normal];
                contact.unknowns = 1;
                (contact.conditions[0].tangent, contact.conditions[0].tangent_weight) = ([0.0; 2], 0.0);
            }
            contact.first = first;
            first += contact.unknowns;
        }
        self
    }

    /// Sets the direction in which closed nodes without a tangential unknown slip under a displacement of all nodes.
    pub fn tell_slip(&self, displacement: &[f64], status: &mut [Status]) {
        let nodes = self.nodes.iter().zip(&self.contact);
        let conditions = nodes.flat_map(|(node, contact)| contact.conditions.iter().map(move |c| (node, c)));
        for ((node, condition), status) in conditions.zip(status) {
            if let (Some([_, t]), [_], Status::Stick) = (node.frame, node.directions.as_slice(), &status) {
                let own = displacement[2 * node.node] * t[0] + displacement[2 * node.node + 1] * t[1];
                let slip = own + condition.slip_offset;
                *status = if slip < 0.0 { Status::SlipMinus } else { Status::SlipPlus };
            }
        }
    }

    /// Force of the obstacle on the body over one side, -∫ (λ_n n + λ_t t) ds (force per thickness), of the
    /// multipliers `[λ_n, λ_t]` of all conditions.
    pub fn force(&self, side: usize, multipliers: &[[f64; 2]]) -> [f64; 2] {
        let conditions = self.nodes.iter().flat_map(|n| &n.conditions);
        let mut force = [0.0; 2];
        for (c, [normal, shear]) in conditions.zip(multipliers) {
            for share in c.shares.iter().filter(|s| s.side == side) {
                for i in 0..2 {
                    force[i] -= share.normal * normal * c.normal[i] + share.tangent * shear * c.tangent[i];
                }
            }
        }
        // on curves the directions of a held end differ from those of the neighbour that has its multiplier
        let conditions: Vec<_> = self.nodes.iter().flat_map(|n| &n.conditions).collect();
        for transfer in &self.transfers {
            let c = conditions[transfer.condition];
            let own = if transfer.functional == 0 { c.normal } else { c.tangent };
            if transfer.direction != own && c.shares.iter().any(|s| s.side == side) {
                let multiplier = multipliers[transfer.condition][transfer.functional];
                (0..2).for_each(|i| force[i] -= transfer.weight * multiplier * (transfer.direction[i] - own[i]));
            }
        }
        force
    }

    /// Work of the force of the obstacle on the body over one side on a field w, of nodes whose points are `points`.
    pub fn work(
        &self,
        side: usize,
        multipliers: &[[f64; 2]],
        points: &[[f64; 2]],
        w: impl Fn([f64; 2]) -> [f64; 2],
    ) -> f64 {
        let conditions: Vec<_> =
            self.nodes.iter().flat_map(|n| n.conditions.iter().map(move |c| (n.point, c))).collect();
        let work = |x: [f64; 2], force: f64, d: [f64; 2]| {
            let w = w(x);
            force * (w[0] * d[0] + w[1] * d[1])
        };
        let mut sum = 0.0;
        for (&(x, c), [normal, shear]) in conditions.iter().zip(multipliers) {
            for share in c.shares.iter().filter(|s| s.side == side) {
                sum -= work(x, share.normal * normal, c.normal) + work(x, share.tangent * shear, c.tangent);
            }
        }
        // what acts at a held end is in the share of the neighbour that has its multiplier
        for transfer in &self.transfers {
            let (x, c) = conditions[transfer.condition];
            if c.shares.iter().any(|s| s.side == side) {
                let own = if transfer.functional == 0 { c.normal } else { c.tangent };
                let force = transfer.weight * multipliers[transfer.condition][transfer.functional];
                sum -= work(points[transfer.node], force, transfer.direction) - work(x, force, own);
            }
        }
        sum
    }
}
