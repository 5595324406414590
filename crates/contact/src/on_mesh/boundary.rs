//! From the sides of a mesh to the conditions of a [`Problem`](crate::Problem).

use steklov_bem_operators::{Dof, Mesh, Relative, Space, relative_displacement};
use steklov_elastic::plane::{cross, dot, turned, unit};

use crate::on_mesh::sides::{ContactElement, JUMP, SideData, contact_elements};
use crate::{Condition, ContactError, ContactNode, Status};

/// Components smaller than this count as zero: normals that agree, directions in which a node cannot move.
const ALIGNED: f64 = 1e-12;
/// Sine of the angle up to which a bend of sides against another body has one condition: 30°.
const BENT: f64 = 0.5;
/// Normals of two curves that meet and differ by less are one.
const SMOOTH: f64 = 1e-8;

/// What a condition's multipliers add to the force on one side: λ_n `normal` n + λ_t `tangent` t.
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
#[derive(Debug, Clone, PartialEq)]
pub struct ContactBoundary {
    /// Where the nodes are.
    pub nodes: Vec<BoundaryNode>,
    /// What a [`Problem`](crate::Problem) needs to know of them.
    pub contact: Vec<ContactNode>,
    /// What ends without multipliers carry of those of their neighbours.
    pub transfers: Vec<Transfer>,
    /// The contact elements, rising.
    pub elements: Vec<usize>,
    /// What nodes face on other bodies: with them displacements are relative ones.
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

    /// A nodal displacement with relative ones at the nodes that face other bodies.
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

    /// The same without the tangential unknowns of nodes with one normal whose sides are all without friction: nothing of them
    /// is in any condition, and they are eliminated with those that are not on the contact boundary.
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

    /// Gives closed nodes without a tangential unknown the direction in which they slip under a displacement of all nodes.
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
        // on curves the directions of a held end are not those of the neighbour that has its multiplier
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
}

/// Contact conditions of the given sides. `held(node)` tells the prescribed values of u_x and u_y at a node.
///
/// # Errors
/// [`ContactError::Data`] when a gap or bound is not finite or cannot be integrated; [`ContactError::Inconsistent`] for
/// a negative bound, a side given twice, a held node inside the contact boundary, and an element that is left without a
/// node for its multiplier: of degree 1 between two held ends.
pub fn contact_boundary(
    mesh: &Mesh,
    space: &Space,
    sides: &[SideData<'_>],
    held: &dyn Fn(usize) -> [Option<f64>; 2],
) -> Result<ContactBoundary, ContactError> {
    let elements = contact_elements(mesh, space, sides)?;
    let mut drafts: Vec<Draft> = Vec::new();
    let mut draft_of = vec![None; space.nodes()];
    for element in &elements {
        for (j, node) in space.element_nodes(element.element).enumerate() {
            let d = *draft_of[node].get_or_insert_with(|| {
                drafts.push(Draft { node, held: held(node), joined: element.joined, conditions: Vec::new() });
                drafts.len() - 1
            });
            let (e, t) = (element.element, space.basis(element.element).nodes[j]);
            let aligned = match (element.joined, mesh.is_line(e)) {
                (true, _) => BENT,
                (false, true) => ALIGNED,
                (false, false) => SMOOTH,
            };
            let [x, y] = element.normals[j];
            let tangent = if element.joined { [-y, x] } else { mesh.tangent(e, t) };
            drafts[d].add([[x, y], tangent], element, j, aligned);
        }
    }
    let received = transfers(mesh, space, &mut drafts, &draft_of)?;
    let mut contact_elements: Vec<usize> = elements.iter().map(|element| element.element).collect();
    contact_elements.sort_unstable();
    let mut boundary = ContactBoundary {
        nodes: Vec::new(),
        contact: Vec::new(),
        transfers: Vec::new(),
        elements: contact_elements,
        rows: Vec::new(),
    };
    let (mut first, mut conditions) = (0, 0);
    let carries = |d: &Draft| !d.held.iter().all(Option::is_some) && !d.conditions.is_empty();
    for (d, draft) in drafts.iter().enumerate().filter(|(_, d)| carries(d)) {
        let (node, contact) = draft.finish(space, first);
        let mine = received.iter().filter(|(r, ..)| *r == d);
        boundary.transfers.extend(mine.map(|&(_, c, transfer)| Transfer { condition: conditions + c, ..transfer }));
        conditions += contact.conditions.len();
        first += contact.unknowns;
        boundary.nodes.push(node);
        boundary.contact.push(contact);
    }
    Ok(boundary)
}

/// A draft and one of its conditions that receive the dual function of an end, and what it is.
type Received = (usize, usize, Transfer);

/// Takes the multipliers of nodes that carry none, and gives their dual functions to the next ones.
fn transfers(
    mesh: &Mesh,
    space: &Space,
    drafts: &mut [Draft],
    draft_of: &[Option<usize>],
) -> Result<Vec<Received>, ContactError> {
    let mut received: Vec<Received> = Vec::new();
    for d in 0..drafts.len() {
        if drafts[d].joined && drafts[d].conditions.len() > 1 {
            drop_corner(space, drafts, draft_of, d, &mut received)?;
            continue;
        }
        if drafts[d].held == [None, None] {
            continue;
        }
        if drafts[d].elements() > 1 {
            let [x, y] = space.points[drafts[d].node];
            let what = format!("the node at ({x}, {y}) inside the contact boundary is held; only its ends may be");
            return Err(ContactError::Inconsistent { what });
        }
        for functional in [Functional::Normal, Functional::Tangent] {
            if let Some(known) = drafts[d].immovable(functional) {
                let part = drafts[d].conditions[0].take(functional);
                let (e, node) = (drafts[d].conditions[0].elements[0], drafts[d].node);
                let p = space.degree(e);
                let next = if space.node(e, 0) == node { space.node(e, 1) } else { space.node(e, p - 1) };
                let receiver = draft_of[next].and_then(|r: usize| Some((r, drafts[r].receiver(e, functional)?)));
                let Some((r, c)) = receiver else {
                    let side = &mesh.side_names[mesh.side[e]];
                    let what = format!(
                        "an element of degree {p} on side \"{side}\" has no node that can move for its multiplier: \
                         raise its degree or divide it"
                    );
                    return Err(ContactError::Inconsistent { what });
                };
                let (weight, direction) = (part.weight, drafts[d].conditions[0].direction(functional));
                let receiver = &mut drafts[r].conditions[c];
                let index = usize::from(functional == Functional::Tangent);
                received.push((
                    r,
                    c,
                    Transfer { node, condition: 0, functional: index, weight, direction, held: true },
                ));
                receiver.receive(functional, part, known);
            }
        }
    }
    Ok(received)
}

/// A corner of the contact boundary against another body carries no multipliers: two conditions there would act on different
/// relative displacements. Its dual functions go to the next nodes on both sides.
fn drop_corner(
    space: &Space,
    drafts: &mut [Draft],
    draft_of: &[Option<usize>],
    d: usize,
    received: &mut Vec<Received>,
) -> Result<(), ContactError> {
    let node = drafts[d].node;
    for mut condition in std::mem::take(&mut drafts[d].conditions) {
        let e = condition.elements[0];
        let p = space.degree(e);
        let next = if space.node(e, 0) == node { space.node(e, 1) } else { space.node(e, p - 1) };
        for functional in [Functional::Normal, Functional::Tangent] {
            let receiver = draft_of[next].and_then(|r: usize| Some((r, drafts[r].receiver(e, functional)?)));
            let Some((r, c)) = receiver else {
                let [x, y] = space.points[node];
                let what = format!(
                    "the element of degree {p} at the corner ({x}, {y}) has no other node for its multiplier: raise its degree or divide it"
                );
                return Err(ContactError::Inconsistent { what });
            };
            let direction = condition.direction(functional);
            let part = condition.take(functional);
            let index = usize::from(functional == Functional::Tangent);
            let transfer =
                Transfer { node, condition: 0, functional: index, weight: part.weight, direction, held: false };
            received.push((r, c, transfer));
            drafts[r].conditions[c].receive(functional, part, 0.0);
        }
    }
    Ok(())
}

#[derive(Clone, Copy, PartialEq)]
enum Functional {
    Normal,
    Tangent,
}

/// What one functional of a condition has gathered.
#[derive(Clone, Default)]
struct Part {
    /// D.
    weight: f64,
    /// ∫ ψ̃ by side.
    shares: Vec<(usize, f64)>,
    /// Normal: ∫ g ψ̃ - D_end u_n,end; tangential: D_end u_t,end.
    moment: f64,
}

struct DraftCondition {
    normal: [f64; 2],
    tangent: [f64; 2],
    elements: Vec<usize>,
    parts: [Part; 2],
    /// g from within, ∫ g ψ and ∫ φ of each element.
    gaps: Vec<[f64; 3]>,
    /// Σ D F and Σ D μ.
    friction: [f64; 2],
    /// Σ D, also where the multiplier is gone.
    weight: f64,
}

struct Draft {
    node: usize,
    held: [Option<f64>; 2],
    /// Whether it faces another body.
    joined: bool,
    conditions: Vec<DraftCondition>,
}

impl Draft {
    fn add(&mut self, [normal, tangent]: [[f64; 2]; 2], element: &ContactElement, j: usize, aligned: f64) {
        let e = element.element;
        let aligned = |c: &DraftCondition| cross(c.normal, normal).abs() <= aligned && dot(c.normal, normal) > 0.0;
        self.joined |= element.joined;
        let k = self.conditions.iter().position(aligned).unwrap_or_else(|| {
            let (elements, parts) = (Vec::new(), <[Part; 2]>::default());
            let gaps = Vec::new();
            self.conditions.push(DraftCondition {
                normal,
                tangent,
                elements,
                parts,
                gaps,
                friction: [0.0; 2],
                weight: 0.0,
            });
            self.conditions.len() - 1
        });
        let (c, weight) = (&mut self.conditions[k], element.weights[j]);
        if element.joined && cross(c.normal, normal).abs() > ALIGNED {
            // where a polygon that stands for a curve bends: the mean of both
            let mean = [0, 1].map(|i| c.weight * c.normal[i] + weight * normal[i]);
            c.normal = unit(mean);
            c.tangent = turned(c.normal);
        }
        c.elements.push(e);
        c.weight += weight;
        (0..2).for_each(|k| c.friction[k] += weight * element.friction[j][k]);
        for part in &mut c.parts {
            part.weight += weight;
            part.share(element.side, weight);
        }
        let limit = element.limits[usize::from(j > 0)];
        c.gaps.push([limit, element.gaps[j], weight]);
        c.parts[0].moment = c.gap_moment();
    }

    fn elements(&self) -> usize {
        self.conditions.iter().map(|c| c.elements.len()).sum()
    }

    /// The known displacement of a held node in a direction in which it cannot move; None if it can.
    fn immovable(&self, functional: Functional) -> Option<f64> {
        let d = self.conditions[0].direction(functional);
        let movable = (0..2).any(|i| self.held[i].is_none() && d[i].abs() > ALIGNED);
        (!movable).then(|| (0..2).map(|i| d[i] * self.held[i].unwrap_or(0.0)).sum())
    }

    /// Index of the condition on element e, if the functional is not itself one in which the node cannot move.
    fn receiver(&self, e: usize, functional: Functional) -> Option<usize> {
        if self.held != [None, None] && self.immovable(functional).is_some() {
            return None;
        }
        self.conditions.iter().position(|c| c.elements.contains(&e))
    }

    fn finish(&self, space: &Space, first: usize) -> (BoundaryNode, ContactNode) {
        let axes = [[1.0, 0.0], [0.0, 1.0]];
        let directions: Vec<[f64; 2]> = match self.conditions.as_slice() {
            [c] if self.held == [None, None] => vec![c.normal, c.tangent],
            _ => (0..2).filter(|&i| self.held[i].is_none()).map(|i| axes[i]).collect(),
        };
        let in_unknowns = |d: [f64; 2]| {
            let mut c = [0.0; 2];
            directions.iter().zip(&mut c).for_each(|(e, c)| *c = if *e == d { 1.0 } else { dot(*e, d) });
            c
        };
        let ordinary = self.held == [None, None] && self.conditions.len() == 1;
        let condition = |c: &DraftCondition| {
            let known = |d: [f64; 2]| (0..2).map(|i| d[i] * self.held[i].unwrap_or(0.0)).sum::<f64>();
            let [normal, tangent] = &c.parts;
            let mean = |p: &Part| if p.weight > 0.0 { p.moment / p.weight } else { 0.0 };
            Condition {
                normal: if ordinary { [1.0, 0.0] } else { in_unknowns(c.normal) },
                tangent: if ordinary { [0.0, 1.0] } else { in_unknowns(c.tangent) },
                normal_weight: normal.weight,
                tangent_weight: tangent.weight,
                gap: mean(normal) - known(c.normal),
                slip_offset: mean(tangent) + known(c.tangent),
                bound: c.friction[0] / c.weight,
                coefficient: c.friction[1] / c.weight,
            }
        };
        let described = |c: &DraftCondition| {
            let (normal, tangent, mut shares) = (c.normal, c.tangent, Vec::<Share>::new());
            for (k, part) in c.parts.iter().enumerate() {
                for &(side, length) in &part.shares {
                    let at = shares.iter().position(|s| s.side == side).unwrap_or_else(|| {
                        shares.push(Share { side, normal: 0.0, tangent: 0.0 });
                        shares.len() - 1
                    });
                    if k == 0 { shares[at].normal += length } else { shares[at].tangent += length }
                }
            }
            BoundaryCondition { normal, tangent, shares }
        };
        let contact = ContactNode {
            first,
            unknowns: directions.len(),
            conditions: self.conditions.iter().map(condition).collect(),
        };
        let conditions = self.conditions.iter().map(described).collect();
        let frame = ordinary.then(|| [self.conditions[0].normal, self.conditions[0].tangent]);
        (BoundaryNode { node: self.node, point: space.points[self.node], directions, frame, conditions }, contact)
    }
}

impl DraftCondition {
    /// ∫ g ψ of both elements; where g jumps between them, that of the lower side over the weights of both.
    fn gap_moment(&self) -> f64 {
        let whole: f64 = self.gaps.iter().map(|g| g[1]).sum();
        let [a, b] = self.gaps.as_slice() else { return whole };
        if (a[0] - b[0]).abs() <= JUMP * a[0].abs().max(b[0].abs()) {
            return whole;
        }
        let lower = if a[0] < b[0] { a } else { b };
        lower[1] / lower[2] * (a[2] + b[2])
    }

    fn direction(&self, functional: Functional) -> [f64; 2] {
        if functional == Functional::Normal { self.normal } else { self.tangent }
    }

    fn part(&mut self, functional: Functional) -> &mut Part {
        &mut self.parts[if functional == Functional::Normal { 0 } else { 1 }]
    }

    /// Leaves the condition without this multiplier.
    fn take(&mut self, functional: Functional) -> Part {
        std::mem::take(self.part(functional))
    }

    /// Adds the dual function of an end whose displacement is `known`.
    fn receive(&mut self, functional: Functional, end: Part, known: f64) {
        let part = self.part(functional);
        let sign = if functional == Functional::Normal { -1.0 } else { 1.0 };
        part.moment += end.moment + sign * end.weight * known;
        end.shares.iter().for_each(|&(side, length)| part.share(side, length));
    }
}

impl Part {
    fn share(&mut self, side: usize, length: f64) {
        match self.shares.iter_mut().find(|s| s.0 == side) {
            Some(share) => share.1 += length,
            None => self.shares.push((side, length)),
        }
    }
}
