//! From the sides of a mesh to the conditions of a [`Problem`](crate::Problem): gathered node by node from the elements that meet there.

use steklov_bem_operators::{Mesh, Space};
use steklov_elastic::plane::{cross, dot, turned, unit};

use crate::on_mesh::boundary::{BoundaryCondition, BoundaryNode, ContactBoundary, Share, Transfer};
use crate::on_mesh::sides::{ContactElement, JUMP, SideData, contact_elements};
use crate::{Condition, ContactError, ContactNode};

/// Components smaller than this count as zero: normals that agree, directions in which a node cannot move.
const ALIGNED: f64 = 1e-12;
/// Sine of the angle up to which a bend of sides against another body has one condition: 30°.
const BENT: f64 = 0.5;
/// Normals of two curves that meet and differ by less are one.
const SMOOTH: f64 = 1e-8;

/// Contact conditions of the given sides. `held(node)` gives the prescribed values of u_x and u_y at a node.
///
/// # Errors
/// [`ContactError::Data`] when a gap or bound is not finite or cannot be integrated; [`ContactError::Inconsistent`] for a
/// negative bound, a side given twice, a held node inside the contact boundary, and an element without a node for its
/// multiplier: one of degree 1 between two held ends.
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

/// The draft and the condition that receive the dual function of an end, and that end.
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

/// The sums gathered for one functional of a condition.
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

    /// Index of the condition on element e, unless the node cannot move along this functional either.
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
