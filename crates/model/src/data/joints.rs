//! Interfaces between bodies on a mesh: the elements that carry their multipliers, the elements that these face, and the rows
//! that join both.
//!
//! ```text
//! contact   w = u_s - P u_m in the frames (n, t) of the contact nodes, kept; the gap is the distance and the scene's gap
//! tied      w = u_s - P u_m = the jump of the displacement, held; λ = what is left of the equations there, over D
//! ```
//! A node that cannot carry a multiplier, because a support holds it or another interface has one there, gives its dual function
//! to the next node of its element.

use std::collections::BTreeSet;

use steklov_bem_operators::{Relative, Site, order_of_rows};
use steklov_contact::{ContactBoundary, ContactError, Row, Transfer, oscillation};
use steklov_coupling::{Cell, Facing, MortarRow, cells, mortar_rows};
use steklov_elastic::plane::{cross, distance, minus, turned};
use steklov_expression::Expression;
use steklov_problem::{Interface, Law, Seen, Tie};

use crate::data::on_mesh::{Function, OnMesh};
use crate::data::supports::Held;
use crate::error::SolveError;

/// An interface on a mesh.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Its number among the interfaces of the problem.
    pub interface: usize,
    /// Elements that carry multipliers.
    pub own: Vec<usize>,
    /// Elements that may be faced.
    pub other: Vec<usize>,
    /// The parts that are faced.
    pub cells: Vec<Cell>,
    /// The nodes of its bodies with curves that nothing holds against rotations.
    pub(crate) turning: BTreeSet<usize>,
}

/// A node of a tie with a component of its displacement.
#[derive(Debug, Clone)]
pub(crate) struct TiedNode {
    /// w.
    pub(crate) relative: Relative,
    /// Unknown 2·node + component.
    pub(crate) dof: usize,
    /// D (length).
    pub(crate) weight: f64,
    /// D with the weights of the nodes that gave it their dual functions, on which its multiplier acts as well.
    pub(crate) whole: f64,
    /// The jump that w is held at (length).
    pub(crate) jump: f64,
    /// Number of the interface.
    pub interface: usize,
}

/// Distances of bodies below this part of the diameter are zero.
const NO_DISTANCE: f64 = 1e-13;
/// Part of the coordinates that rounding leaves in a distance.
const COORDINATES: f64 = 4e-15;
/// Sine of the angle below which the direction of contact is that of the normal.
const ALIGNED: f64 = 1e-14;
/// Part of an element that may stay uncovered.
const UNCOVERED: f64 = 1e-8;

impl OnMesh<'_> {
    /// The interfaces between bodies; `turns` whether the body of an element has curves and nothing that holds it against rotations.
    pub(crate) fn joints(&self, turns: impl Fn(usize) -> bool) -> Result<Vec<Joint>, SolveError> {
        let problem = &self.scene.problem;
        let mut joints = Vec::new();
        for (number, interface) in problem.interfaces().iter().enumerate() {
            let facing = problem.facing_sides(interface);
            if facing.is_empty() {
                continue;
            }
            let spans = problem.spans(interface);
            let modulus = self.moduli();
            let within = |e: &usize| {
                let middle = (self.mesh.span[*e][0] + self.mesh.span[*e][1]) / 2.0;
                spans.iter().any(|span| span.edge == self.mesh.edge[*e] && span.s[0] < middle && middle < span.s[1])
            };
            let all = || 0..self.mesh.len();
            let own: Vec<usize> =
                all().filter(|&e| interface.sides.contains(&self.mesh.side[e])).filter(within).collect();
            let other: Vec<usize> = all().filter(|&e| facing.contains(&self.mesh.side[e])).collect();
            let side = |elements| Facing { mesh: self.mesh, space: self.space, elements, modulus: &modulus };
            let (near, [low, high]) = (problem.coincidence(interface), problem.seen_distances(interface));
            let cells = cells(side(&own), side(&other), [2.0 * low, 2.0 * high], near);
            for &e in &own {
                let covered: f64 = cells.iter().filter(|c| c.element == e).map(|c| (c.span[1] - c.span[0]) / 2.0).sum();
                if (covered - 1.0).abs() > UNCOVERED.max(self.mesh.resolution(e)) {
                    let [x, y] = self.mesh.point(e, 0.0);
                    let what = format!(
                        "interface {:?}: {covered} of the element at ({x}, {y}) faces another body",
                        interface.name
                    );
                    return Err(ContactError::Inconsistent { what }.into());
                }
            }
            let both = own.iter().chain(&other).filter(|e| turns(**e));
            let turning = both.flat_map(|&e| self.space.element_nodes(e)).collect();
            joints.push(Joint { interface: number, own, other, cells, turning });
        }
        Ok(joints)
    }

    /// E/(1-ν²) of all elements, by which sides are paired.
    pub(crate) fn moduli(&self) -> Vec<f64> {
        let (problem, edges) = (&self.scene.problem, self.scene.problem.outline.edges());
        let body = |e: usize| problem.outline.body_of_loop(edges[self.mesh.edge[e]].loop_index);
        (0..self.mesh.len()).map(|e| problem.pairing_modulus(body(e))).collect()
    }

    fn interface(&self, joint: &Joint) -> &Interface {
        &self.scene.problem.interfaces()[joint.interface]
    }

    /// Whether an interface is one of contact.
    pub(crate) fn is_contact(&self, joint: &Joint) -> bool {
        matches!(self.interface(joint).law, Law::Contact(_))
    }

    pub(crate) fn rows_of(&self, own: &[usize], cells: &[Cell]) -> Vec<MortarRow> {
        let modulus = self.moduli();
        let side = |elements| Facing { mesh: self.mesh, space: self.space, elements, modulus: &modulus };
        mortar_rows(side(own), side(&[]), cells)
    }

    /// The part of the row of a node that one element has.
    fn part_of_row(&self, node: usize, e: usize, cells: &[Cell]) -> Option<MortarRow> {
        let cells: Vec<Cell> = cells.iter().copied().filter(|cell| cell.element == e).collect();
        self.rows_of(&[e], &cells).into_iter().find(|row| row.node == node)
    }

    /// The nodes that a row of one of these interfaces along d faces, and c_j = P_ij d. If one of both bodies turns, with the couple on them
    /// that makes Σ c_j·r(x_j) = d·r(y) for rotations r as well, y the point that the node faces: polynomials on curves have none, and
    /// forces there would turn bodies that nothing holds.
    fn faced(&self, row: &MortarRow, joints: &[&Joint], d: [f64; 2]) -> Vec<(usize, [f64; 2])> {
        let plain = row.other.iter().map(|&(j, p)| (j, d.map(|d| p * d)));
        let turns = |node: usize| joints.iter().any(|joint| joint.turning.contains(&node));
        let seen = || joints.iter().find_map(|joint| self.seen_by(row.node, &joint.own));
        let turn = turns(row.node) || row.other.iter().any(|&(j, _)| turns(j));
        let Some(y) = turn.then(seen).flatten() else { return plain.collect() };
        let at = |j: usize| self.space.points[j];
        let count = row.other.len() as f64;
        let [sum, met] = row.other.iter().fold([[0.0; 2]; 2], |[sum, met], &(j, p)| {
            let x = at(j);
            [[sum[0] + x[0], sum[1] + x[1]], [met[0] + p * x[0], met[1] + p * x[1]]]
        });
        let centre = sum.map(|s| s / count);
        let inertia: f64 = row.other.iter().map(|&(j, _)| distance(at(j), centre).powi(2)).sum();
        let missed = cross(minus(y, met), d);
        if inertia == 0.0 || missed.abs() <= NO_DISTANCE * self.scene.problem.outline.diameter() {
            return plain.collect();
        }
        let with_couple = |(j, c): (usize, [f64; 2])| {
            let r = turned(minus(at(j), centre));
            (j, [0, 1].map(|i| c[i] + missed / inertia * r[i]))
        };
        plain.map(with_couple).collect()
    }

    /// The point that a node of these elements faces.
    fn seen_by(&self, node: usize, own: &[usize]) -> Option<[f64; 2]> {
        let e = own.iter().copied().find(|&e| self.space.element_nodes(e).any(|n| n == node))?;
        let k = self.space.element_nodes(e).position(|n| n == node)?;
        let seen = self.seen(e, self.space.basis(e).nodes[k])?;
        Some(self.scene.problem.outline.edges()[seen.edge].point(seen.s))
    }

    /// The one of these elements that has two given nodes.
    fn element_with(&self, elements: &[usize], a: usize, b: usize) -> Option<usize> {
        let has = |e: usize, node: usize| self.space.element_nodes(e).any(|n| n == node);
        elements.iter().copied().find(|&e| has(e, a) && has(e, b))
    }

    /// Refuses an end of a contact side that is held inside the body it faces, if that is held as well.
    fn check_held_end(&self, row: &MortarRow, held: &[Held], n: [f64; 2]) -> Result<(), SolveError> {
        let along = |node: usize| -> Option<f64> {
            (0..2).map(|i| if n[i].abs() < 1e-12 { Some(0.0) } else { Some(n[i] * held[node].components[i]?.0) }).sum()
        };
        let faced: Option<f64> =
            row.other.iter().filter(|(_, p)| p.abs() > 1e-9).map(|&(j, p)| Some(p * along(j)?)).sum();
        let (Some(own), Some(faced)) = (along(row.node), faced) else { return Ok(()) };
        let Some(e) = (0..self.mesh.len()).find(|&e| {
            self.space.element_nodes(e).any(|node| node == row.node)
                && self.scene.problem.joint(self.mesh.side[e]).is_some()
        }) else {
            return Ok(());
        };
        let t = if self.space.node(e, 0) == row.node { -1.0 } else { 1.0 };
        let Some(contact) = self.scene.contact(self.mesh.side[e]) else { return Ok(()) };
        let gap = (self.gap(self.mesh.side[e], &contact.gap).value)(&Site::new(self.mesh, e, t));
        if own - faced - gap > 1e-9 * own.abs().max(faced.abs()).max(gap.abs()) {
            let [x, y] = self.space.points[row.node];
            let what = format!(
                "the point ({x}, {y}) at the end of side {:?} and what it faces are held {} into each other, where the gap is {gap}",
                self.mesh.side_names[self.mesh.side[e]],
                own - faced
            );
            let remedy = "hold the two bodies apart there, or free one of them";
            return Err(ContactError::Supports { what, remedy }.into());
        }
        Ok(())
    }

    /// Gives a contact boundary the rows of the bodies that it faces.
    pub(crate) fn join_contact(
        &self,
        boundary: &mut ContactBoundary,
        joints: &[Joint],
        held: &[Held],
    ) -> Result<(), SolveError> {
        let of_contact: Vec<&Joint> = joints.iter().filter(|joint| self.is_contact(joint)).collect();
        let own: Vec<usize> = of_contact.iter().flat_map(|joint| joint.own.iter().copied()).collect();
        let cells: Vec<Cell> = of_contact.iter().flat_map(|joint| joint.cells.iter().copied()).collect();
        let rows = self.rows_of(&own, &cells);
        let row_of = |node: usize| rows.iter().find(|row| row.node == node);
        let (mut condition, mut found) = (0, Vec::new());
        for (node, contact) in boundary.nodes.iter().zip(&boundary.contact) {
            for (plane, of) in node.conditions.iter().zip(&contact.conditions) {
                let weights = [of.normal_weight, of.tangent_weight];
                for (functional, (direction, weight)) in
                    [plane.normal, plane.tangent].into_iter().zip(weights).enumerate()
                {
                    if weight == 0.0 {
                        continue;
                    }
                    let mut faced: Vec<(usize, [f64; 2])> = Vec::new();
                    let mut add = |row: &MortarRow, direction: [f64; 2], part: f64| {
                        faced.extend(self.faced(row, &of_contact, direction.map(|d| part * d)));
                    };
                    if let Some(row) = row_of(node.node) {
                        add(row, direction, 1.0);
                    }
                    let mine = |t: &&Transfer| t.condition == condition && t.functional == functional;
                    let mut ends = Vec::new();
                    for transfer in boundary.transfers.iter().filter(mine) {
                        if let Some(end) = row_of(transfer.node).filter(|_| transfer.held && functional == 0) {
                            self.check_held_end(end, held, transfer.direction)?;
                        }
                        let part = transfer.weight / weight;
                        let e = self.element_with(&boundary.elements, transfer.node, node.node);
                        if let Some(row) = e.and_then(|e| self.part_of_row(transfer.node, e, &cells)) {
                            add(&row, transfer.direction, part);
                        }
                        if !transfer.held {
                            ends.push((transfer.node, transfer.direction.map(|d| -part * d)));
                        }
                    }
                    faced.extend(ends);
                    if !faced.is_empty() {
                        let relative = Relative { node: node.node, direction, faced: merged(faced) };
                        found.push(Row { condition, functional, relative });
                    }
                }
                condition += 1;
            }
            if node.frame.is_none() && node.directions.len() == 1 && node.conditions.len() == 1 {
                let aligned = |d: [f64; 2]| d.iter().any(|v| v.abs() < 1e-12);
                if row_of(node.node).is_some() && !aligned(node.conditions[0].normal) {
                    let [x, y] = node.point;
                    let what = format!(
                        "the point ({x}, {y}) is held in x or y alone, which is oblique to the direction of contact there"
                    );
                    let remedy = "hold both components of the side beside it, or neither; or let the other body carry pressure and \
                                  shear: name its side as `multiplier` of the interface";
                    return Err(ContactError::Supports { what, remedy }.into());
                }
            }
        }
        boundary.rows = found;
        Ok(())
    }

    /// The tied nodes; those of `contact` carry no multipliers of ties.
    pub(crate) fn tied_nodes(
        &self,
        joints: &[Joint],
        held: &[Held],
        contact: Option<&ContactBoundary>,
    ) -> Result<Vec<TiedNode>, SolveError> {
        let mut taken: Vec<bool> = vec![false; self.space.nodes()];
        contact.iter().flat_map(|boundary| &boundary.nodes).for_each(|node| taken[node.node] = true);
        let mut tied: Vec<TiedNode> = Vec::new();
        for joint in joints {
            let Law::Tied(tie) = &self.interface(joint).law else { continue };
            let jump = tie.displacement_jump.as_ref();
            let mut rows = self.rows_of(&joint.own, &joint.cells);
            let carries = |node: usize, i: usize| !taken[node] && held[node].components[i].is_none();
            let jumps = self.jumps(jump, joint);
            let mut own: Vec<TiedNode> = Vec::new();
            for row in &rows {
                for i in (0..2).filter(|&i| carries(row.node, i)) {
                    let faced = self.faced(row, &[joint], along(i, 1.0));
                    let relative = Relative { node: row.node, direction: along(i, 1.0), faced };
                    let jump = jumps[row.node][i] / row.weight;
                    let (dof, weight) = (2 * row.node + i, row.weight);
                    own.push(TiedNode { relative, dof, weight, whole: weight, jump, interface: joint.interface });
                }
            }
            rows.retain(|row| (0..2).any(|i| !carries(row.node, i)));
            for end in &rows {
                for i in (0..2).filter(|&i| !carries(end.node, i)) {
                    self.check_held_rows(end, held, i, jumps[end.node][i] / end.weight)?;
                    for e in joint.own.iter().copied().filter(|&e| self.space.element_nodes(e).any(|n| n == end.node)) {
                        let p = self.space.degree(e);
                        let next = self.space.node(e, if self.space.node(e, 0) == end.node { 1 } else { p - 1 });
                        let Some(part) = self.part_of_row(end.node, e, &joint.cells) else { continue };
                        let Some(receiver) = own.iter_mut().find(|tied| tied.dof == 2 * next + i) else {
                            let [x, y] = self.space.points[end.node];
                            let what = format!(
                                "the tied element of degree {p} at ({x}, {y}) has no other node for its multiplier: raise its degree or divide it"
                            );
                            return Err(ContactError::Inconsistent { what }.into());
                        };
                        receiver.whole += part.weight;
                        let share = part.weight / receiver.weight;
                        let faced = &mut receiver.relative.faced;
                        faced.push((end.node, along(i, -share)));
                        faced.extend(self.faced(&part, &[joint], along(i, share)));
                        receiver.jump += self.jumps_on_element(jump, e, end.node)[i] / receiver.weight;
                    }
                }
            }
            for node in &mut own {
                node.relative.faced = merged(std::mem::take(&mut node.relative.faced));
                taken[node.relative.node] = true;
            }
            tied.extend(own);
        }
        let rows: Vec<Relative> = tied.iter().map(|tied| tied.relative.clone()).collect();
        Ok(order_of_rows(&rows)?.into_iter().map(|k| tied[k].clone()).collect())
    }

    /// ∫ ψ_i j of every node.
    fn jumps(&self, jump: Option<&[Expression; 2]>, joint: &Joint) -> Vec<[f64; 2]> {
        let mut jumps = vec![[0.0; 2]; self.space.nodes()];
        if jump.is_some() {
            for &e in &joint.own {
                for node in self.space.element_nodes(e) {
                    let part = self.jumps_on_element(jump, e, node);
                    (0..2).for_each(|i| jumps[node][i] += part[i]);
                }
            }
        }
        jumps
    }

    /// ∫ ψ_i j of a node over one element.
    fn jumps_on_element(&self, jump: Option<&[Expression; 2]>, e: usize, node: usize) -> [f64; 2] {
        let Some(jump) = jump else { return [0.0; 2] };
        let basis = self.space.basis(e);
        let Some(k) = self.space.element_nodes(e).position(|n| n == node) else { return [0.0; 2] };
        jump.each_ref().map(|jump| {
            let function = self.function(jump);
            let value = |t: f64| (function.value)(&Site::new(self.mesh, e, t));
            self.mesh.speed(e, basis.nodes[k]) * steklov_coupling::dual_moment(basis, k, &value)
        })
    }

    /// Refuses values of supports on both sides of an interface for which no gap and no jump leaves room.
    fn check_held_rows(&self, row: &MortarRow, held: &[Held], i: usize, jump: f64) -> Result<(), SolveError> {
        let Some((value, side)) = held[row.node].components[i] else { return Ok(()) };
        let counts = row.other.iter().filter(|(_, p)| p.abs() > 1e-9);
        let faced: Option<Vec<_>> = counts.map(|&(j, p)| held[j].components[i].map(|of| (p, of))).collect();
        let Some(faced) = faced.filter(|faced| !faced.is_empty()) else { return Ok(()) };
        let beyond: f64 = faced.iter().map(|(p, (value, _))| p * value).sum();
        let largest = faced.iter().fold(value.abs().max(jump.abs()), |m, (_, (value, _))| m.max(value.abs()));
        if (value - beyond - jump).abs() > 1e-9 * largest {
            let name = |side: usize| self.mesh.side_names[side].clone();
            return Err(SolveError::Incompatible {
                first: name(side),
                second: name(faced[0].1.1),
                point: self.space.points[row.node],
                component: ['x', 'y'][i],
                a: value,
                b: beyond + jump,
            });
        }
        Ok(())
    }

    /// E*/2 ‖w‖ ‖dw/ds‖ of the part w of the jumps of ties that the nodes miss: (element, energy).
    pub(crate) fn tie_oscillation(&self, joints: &[Joint]) -> Result<Vec<(usize, f64)>, SolveError> {
        let mut found = Vec::new();
        for joint in joints {
            let Law::Tied(Tie { displacement_jump: Some(jump), .. }) = &self.interface(joint).law else { continue };
            for jump in jump.iter().filter(|jump| jump.constant().is_none()) {
                let function = self.function(jump);
                for &e in &joint.own {
                    let left = oscillation(self.mesh, self.space, e, &function.datum("displacement jump"))?;
                    found.push((e, self.scene.problem.contact_modulus(self.mesh.edge[e]) / 2.0 * left));
                }
            }
        }
        Ok(found)
    }

    /// The gap of a side: that of the scene, added to the distance from other bodies.
    pub(crate) fn gap<'e>(&'e self, side: usize, gap: &'e Expression) -> Function<'e> {
        let plain = self.function(gap);
        if self.scene.problem.joint(side).is_none() {
            return plain;
        }
        // sides that touch do so up to the rounding of their coordinates
        let diameter = self.scene.problem.outline.diameter();
        let rounding = NO_DISTANCE * diameter;
        let distance = move |site: &Site| self.seen(site.element, site.t).map_or(0.0, |seen| seen.distance);
        let value = move |site: &Site| {
            let distance = distance(site);
            (plain.value)(site) + if distance.abs() < rounding { 0.0 } else { distance }
        };
        // both may cancel, and then leave the rounding of the coordinates
        let left = move |site: &Site| {
            let [x, y] = site.point;
            distance(site).abs().min(COORDINATES * (x.hypot(y) + diameter))
        };
        Function { value: Box::new(value), kinks: plain.kinks, rounding: Some(Box::new(left)) }
    }

    /// The point that a point of a side in contact with other bodies faces; none elsewhere.
    pub(crate) fn seen(&self, e: usize, t: f64) -> Option<Seen> {
        let interface = self.scene.problem.joint(self.mesh.side[e])?;
        self.scene.problem.seen(interface, self.mesh.edge[e], self.mesh.edge_parameter(e, t))
    }

    /// The direction of contact in the middle of an element, and that turned by +90°.
    pub(crate) fn contact_frame(&self, e: usize) -> [[f64; 2]; 2] {
        let direction = self.direction(e, 0.0);
        [direction, turned(direction)]
    }

    /// The direction in which contact acts at a point of a side: that of its pair on another body, the normal against an obstacle.
    pub(crate) fn direction(&self, e: usize, t: f64) -> [f64; 2] {
        let n = self.mesh.normal(e, t);
        // a difference of opposite normals by rounding is none
        self.seen(e, t).map(|seen| seen.direction).filter(|d| cross(*d, n).abs() > ALIGNED).unwrap_or(n)
    }
}

fn along(i: usize, value: f64) -> [f64; 2] {
    let mut d = [0.0; 2];
    d[i] = value;
    d
}

/// One entry a node, rising.
fn merged(mut faced: Vec<(usize, [f64; 2])>) -> Vec<(usize, [f64; 2])> {
    faced.sort_by_key(|entry| entry.0);
    faced.dedup_by(|b, a| {
        a.0 == b.0 && {
            (0..2).for_each(|i| a.1[i] += b.1[i]);
            true
        }
    });
    faced
}
