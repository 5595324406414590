//! The wedges that bodies form at the vertices of their boundaries, and where they begin or cease to meet.
//!
//! ```text
//!       │ A │                    faces of the wedge: the sides of A and B that go on from the point
//!   ────┴───┴────  B             joints: interfaces, tied, or closed, slipping or stuck as at their nodes next to the point
//! ```

use std::f64::consts::PI;

use steklov_bem_operators::{Edge, Polygon};
use steklov_elastic::plane::{angle, distance, minus, unit};
use steklov_elastic::{Face, Joint, Material, Sector, Wedge};
use steklov_problem::{Condition, Faces, Friction, Interface, Law, Scene};

use crate::answer::borne::{AtVertex, Between};
use crate::answer::data_jumps::kinks;
use crate::mesh::first_mesh::SMOOTH;
use crate::solve::contact_rows::{ContactRow, TOUCHING, max_pressure};

/// A point closer to an end of its edge is there (edge parameter).
const NEAR: f64 = 1e-6;
/// Angles between straight edges that differ by less are the same (radian).
const STRAIGHT: f64 = 1e-9;
/// Part of the friction bound that is rounding.
const ROUNDING: f64 = 1e-9;
/// Cosine of the angle between the normal of an edge and those of its nodes, at least.
const ALONG: f64 = 0.9;

/// A wedge that a body forms at a point, alone or with others.
pub(crate) struct Vertex {
    /// The point of each of its bodies, which lie apart where an interface has a gap.
    pub points: Vec<[f64; 2]>,
    /// Of its first body the edge behind the point and of its last body the edge before it, as the boundaries are traversed.
    pub edges: [usize; 2],
    /// Sectors, joints and faces.
    pub wedge: Wedge,
    /// Whether it is closed by contact, of bodies or with an obstacle.
    pub is_pressed: bool,
    /// Whether it lies at a cut beyond the tip of a crack.
    pub is_at_cut: bool,
    /// Whether angle, material and conditions go on: no exponent makes the stress infinite.
    pub goes_on: bool,
    /// Whether the data let the stress grow like log(1/r): None if not, else whether the pressure of contact grows so too.
    pub logarithm: Option<bool>,
}

impl Vertex {
    /// Whether the stress is infinite.
    pub fn is_singular(&self) -> bool {
        self.logarithm.is_some() || !self.goes_on && self.wedge.is_singular()
    }

    /// Whether the pressure of contact is infinite. At the tip of a closed crack the shear ahead is, but no pressure.
    pub fn is_pressed_without_bound(&self) -> bool {
        let of_exponents = || !self.goes_on && self.wedge.is_singular();
        self.is_pressed && !self.is_at_cut && (self.logarithm == Some(true) || of_exponents())
    }
}

/// A ray out of a point of the outline along an edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ray {
    /// The edge.
    pub edge: usize,
    /// Edge parameter of the point.
    pub s: f64,
    /// Whether the parameter rises along the ray.
    pub rising: bool,
}

/// A body at a point.
struct Part {
    point: [f64; 2],
    /// Its first and its last ray, counter-clockwise.
    rays: [Ray; 2],
    angle: f64,
    is_straight: bool,
}

/// Two rays that an interface joins, the carrying one first.
struct Link<'a> {
    rays: [Ray; 2],
    interface: &'a Interface,
}

/// The wedges of all bodies at vertices, at the ends of interfaces and where data of ties have kinks. Cells of different moduli about it count as
/// one material; where such a body meets the medium around it there is none.
///
/// `turns` are angles that bodies have more at points of their boundaries than as they are drawn.
pub(crate) fn wedges(scene: &Scene, rows: &[ContactRow], turns: &[([f64; 2], f64)]) -> Vec<Vertex> {
    let mut at = Points::new(scene, rows);
    for part in &mut at.parts {
        let of_part = turns.iter().filter(|(x, _)| *x == part.point);
        part.angle += of_part.map(|(_, turn)| turn).sum::<f64>();
    }
    let mut seen = vec![false; at.parts.len()];
    (0..at.parts.len()).filter_map(|k| at.wedge(k, &mut seen)).collect()
}

/// The wedges that bodies form alone at vertices of their boundaries, nothing pressed.
pub(crate) fn wedges_of_single_bodies(scene: &Scene) -> Vec<Vertex> {
    let at = Points { scene, rows: &[], parts: parts_at_vertices(scene), links: Vec::new() };
    (0..at.parts.len()).filter_map(|k| at.of_chain(&[k], &[], false)).filter(|vertex| !vertex.goes_on).collect()
}

/// The points at which wedges are looked for.
struct Points<'a> {
    scene: &'a Scene,
    rows: &'a [ContactRow],
    parts: Vec<Part>,
    links: Vec<Link<'a>>,
}

impl<'a> Points<'a> {
    fn new(scene: &'a Scene, rows: &'a [ContactRow]) -> Self {
        let mut at = Self { scene, rows, parts: parts_at_vertices(scene), links: links(scene) };
        let inside = |ray: &Ray| ray.s > NEAR && ray.s < 1.0 - NEAR;
        let medium = scene.surroundings().is_some();
        let edges = scene.problem.outline.edges();
        for (k, edge) in edges.iter().enumerate().filter(|(_, edge)| medium && edge.loop_index == 0) {
            at.parts.extend(kinks(scene, edge).into_iter().map(|s| Part::inside(edges, k, s)));
        }
        for ray in at.links.iter().flat_map(|link| link.rays).filter(inside) {
            if at.parts.iter().all(|part| part.rays.iter().all(|own| !own.is_at(ray))) {
                at.parts.push(Part::inside(edges, ray.edge, ray.s));
            }
        }
        at
    }

    /// The wedge of a body at a point and of all that are joined to it there; none if it was seen, or if nothing changes there.
    fn wedge(&self, first: usize, seen: &mut [bool]) -> Option<Vertex> {
        if seen[first] {
            return None;
        }
        seen[first] = true;
        let (mut chain, mut joints, mut is_closed) = (vec![first], Vec::new(), false);
        while let Some((next, joint)) = self.beyond(chain[chain.len() - 1], true) {
            is_closed = next == first;
            if !is_closed && chain.contains(&next) {
                break;
            }
            joints.push(joint);
            if is_closed {
                break;
            }
            seen[next] = true;
            chain.push(next);
        }
        while let Some((next, joint)) = self.beyond(chain[0], false).filter(|_| !is_closed) {
            if chain.contains(&next) {
                break;
            }
            seen[next] = true;
            chain.insert(0, next);
            joints.insert(0, joint);
        }
        self.of_chain(&chain, &joints, is_closed)
    }

    /// The body that is joined to another one beyond its last ray, or beyond its first one, and how.
    fn beyond(&self, part: usize, last: bool) -> Option<(usize, Joint)> {
        let ray = self.parts[part].rays[usize::from(last)];
        let (link, other) = self.link(ray)?;
        let next = self.parts.iter().position(|part| part.rays[usize::from(!last)].is(other))?;
        Some((next, self.joint(link)?))
    }

    /// The interface along a ray, and the ray of the other side.
    fn link(&self, ray: Ray) -> Option<(&Link<'a>, Ray)> {
        let other = |link: &Link<'_>| match link.rays {
            [own, other] if own.is(ray) => Some(other),
            [other, own] if own.is(ray) => Some(other),
            _ => None,
        };
        self.links.iter().find_map(|link| Some((link, other(link)?)))
    }

    /// How an interface joins its sides next to a point; none if it is open there.
    fn joint(&self, link: &Link<'_>) -> Option<Joint> {
        let Law::Contact(contact) = &link.interface.law else { return Some(Joint::Bonded) };
        let nearest = nearest_row(self.scene, self.rows, link.rays[0])?;
        state(nearest, max_pressure(self.rows), &contact.friction)
    }

    /// The wedge of bodies that follow each other counter-clockwise.
    fn of_chain(&self, chain: &[usize], joints: &[Joint], is_closed: bool) -> Option<Vertex> {
        let (scene, edges) = (self.scene, self.scene.problem.outline.edges());
        let parts: Vec<&Part> = chain.iter().map(|&k| &self.parts[k]).collect();
        let (first, last) = (parts[0].rays[0], parts[parts.len() - 1].rays[1]);
        let sector = |part: &&Part| sector(part.angle, &scene.problem.body_of(&edges[part.rays[0].edge]).material());
        let mut sectors: Vec<Sector> = parts.iter().map(sector).collect();
        let total: f64 = parts.iter().map(|part| part.angle).sum();
        let (mut between, mut joints, mut faces, mut is_pressed) = (Vec::new(), joints.to_vec(), None, false);
        let mut goes_on = self.goes_on(&parts);
        if let Some(around) = scene.surroundings().filter(|_| edges[first.edge].loop_index == 0) {
            if scene.body().cells().is_some() {
                return None;
            }
            sectors.push(self::sector(2.0 * PI - parts[0].angle, &around.material));
            joints = vec![Joint::Bonded; 2];
            between.extend([(last, true), (first, false)].map(|(own, is_before)| Between {
                own,
                interface: None,
                is_before,
            }));
            goes_on = parts[0].is_straight;
        } else {
            let of_contact =
                |ray: Ray| self.link(ray).is_some_and(|(link, _)| matches!(link.interface.law, Law::Contact(_)));
            is_pressed = !joints.is_empty() && parts.iter().any(|part| part.rays.into_iter().any(of_contact));
            for part in &parts[..joints.len()] {
                let (link, _) = self.link(part.rays[1])?;
                let is_before = link.rays[0].is(part.rays[1]);
                between.push(Between { own: link.rays[0], interface: Some(link.interface), is_before });
            }
            if is_closed {
                // faces of contact may not meet at the point as they are drawn
                (total - 2.0 * PI).abs().partial_cmp(&SMOOTH).filter(|order| order.is_lt())?;
            } else {
                faces = Some([first, last].map(|ray| {
                    let (face, closed) = self.face(ray);
                    is_pressed |= closed;
                    face
                }));
            }
        }
        let wedge = Wedge { sectors, joints, faces };
        // where the boundary is straight ridges of gaps are judged by themselves
        let at = AtVertex { scene, rows: self.rows, has_gaps: (total - PI).abs() > SMOOTH && !goes_on };
        let logarithm = at.logarithm(&wedge, faces.map(|_| [first, last]), &between);
        Some(Vertex {
            points: parts.iter().map(|part| part.point).collect(),
            edges: [first.edge, last.edge],
            wedge,
            is_pressed,
            is_at_cut: parts.iter().flat_map(|part| part.rays).any(|ray| self.is_cut(ray)),
            goes_on,
            logarithm,
        })
    }

    /// Whether nothing changes at the point: of a body alone the side, of several the law between them.
    fn goes_on(&self, parts: &[&Part]) -> bool {
        if !parts.iter().all(|part| part.is_straight) {
            return false;
        }
        let edges = self.scene.problem.outline.edges();
        let links: Vec<Option<&Interface>> =
            parts.iter().flat_map(|part| part.rays).map(|ray| self.link(ray).map(|(link, _)| link.interface)).collect();
        let is_tied = |interface: &Option<&Interface>| interface.map(|i| matches!(i.law, Law::Tied(_)));
        if let Some(tied) = is_tied(&links[0]) {
            return links.iter().all(|other| is_tied(other) == Some(tied));
        }
        let [a, b] = [parts[0].rays[0], parts[0].rays[1]].map(|ray| edges[ray.edge].side);
        let touches = |side: usize| self.scene.contact(side).is_some();
        parts.len() == 1 && links[1].is_none() && (a == b || touches(a) && touches(b))
    }

    /// Whether a ray runs along a cut through a body that is whole there.
    fn is_cut(&self, ray: Ray) -> bool {
        let is_tied = |interface: &Interface| matches!(interface.law, Law::Tied(_));
        self.link(ray).is_some_and(|(link, _)| link.interface.faces == Faces::Cut && is_tied(link.interface))
    }

    /// The condition along a ray beyond which no body is joined, and whether an obstacle presses there.
    fn face(&self, ray: Ray) -> (Face, bool) {
        let (scene, edge) = (self.scene, &self.scene.problem.outline.edges()[ray.edge]);
        let meets =
            |of: &Interface| of.sides.contains(&edge.side) || scene.problem.facing_sides(of).contains(&edge.side);
        if scene.problem.joints().any(meets) {
            return (Face::Free, false);
        }
        if let Some(contact) = scene.contact(edge.side) {
            let face = contact_face(self.rows, edge.side, &contact.friction, edge.point(ray.s));
            return (face, face != Face::Free);
        }
        let forward = ray.rising != edge.reversed;
        let direction = direction(edge, !forward).map(|d| if forward { d } else { -d });
        (face_of(&scene.problem.sides[edge.side].condition, direction), false)
    }
}

impl Part {
    /// A body at a point inside of an edge.
    fn inside(edges: &[Edge], edge: usize, s: f64) -> Self {
        let rays = [!edges[edge].reversed, edges[edge].reversed].map(|rising| Ray { edge, s, rising });
        Self { point: edges[edge].point(s), rays, angle: PI, is_straight: true }
    }
}

impl Ray {
    /// The whole edge.
    fn of_end(edge: usize, rising: bool) -> Self {
        Self { edge, s: if rising { 0.0 } else { 1.0 }, rising }
    }

    fn is_at(&self, other: Self) -> bool {
        self.edge == other.edge && (self.s - other.s).abs() < NEAR
    }

    fn is(&self, other: Self) -> bool {
        self.is_at(other) && self.rising == other.rising
    }
}

fn sector(angle: f64, material: &Material) -> Sector {
    Sector { angle, mu: material.mu(), kappa: material.kappa() }
}

/// The bodies at the vertices of their boundaries.
fn parts_at_vertices(scene: &Scene) -> Vec<Part> {
    let outline = &scene.problem.outline;
    let edges = outline.edges();
    let of_loop = |l: usize| {
        let order = outline.traversal(l);
        let at = |k: usize| {
            let [before, behind] = [order[(k + order.len() - 1) % order.len()], order[k]];
            let (a, b) = (&edges[before], &edges[behind]);
            let angle = interior_angle(a, b);
            let rays = [Ray::of_end(behind, !b.reversed), Ray::of_end(before, a.reversed)];
            Part { point: b.start, rays, angle, is_straight: is_straight(a, b) }
        };
        (0..order.len()).map(at).collect::<Vec<_>>()
    };
    (0..outline.loops().len()).flat_map(of_loop).collect()
}

/// The rays at the ends of interfaces and at the vertices of their sides.
fn links(scene: &Scene) -> Vec<Link<'_>> {
    let problem = &scene.problem;
    let edges = problem.outline.edges();
    let shortest = edges.iter().map(Edge::length).fold(f64::INFINITY, f64::min);
    // as far inside of the edge as keeps the other point within NEAR of its end
    let inset = |edge: usize| (1e-3 * NEAR * shortest / edges[edge].length()).max(1e-13);
    let mut links: Vec<Link<'_>> = Vec::new();
    for interface in problem.joints() {
        let mut add = |own: Ray, seen: (usize, f64)| {
            let other = opposite(scene, own, seen);
            let is = |link: &Link<'_>| link.rays[0].is(own) && link.rays[1].is(other);
            if !links.iter().any(is) {
                links.push(Link { rays: [own, other], interface });
            }
        };
        for span in problem.spans(interface) {
            for own in [
                Ray { edge: span.edge, s: span.s[0], rising: true },
                Ray { edge: span.edge, s: span.s[1], rising: false },
            ] {
                let seen =
                    |s: f64| problem.seen(interface, own.edge, s).map(|seen| (seen.edge, seen.s)).into_iter().collect();
                for other in limits(own, inset(own.edge), seen) {
                    add(own, other);
                }
            }
        }
        for (k, edge) in edges.iter().enumerate().filter(|(_, edge)| interface.sides.contains(&edge.side)) {
            for own in
                kinks(scene, edge).into_iter().flat_map(|s| [false, true].map(|rising| Ray { edge: k, s, rising }))
            {
                let seen = |s: f64| problem.seen(interface, k, s).map(|seen| (seen.edge, seen.s)).into_iter().collect();
                for other in limits(own, inset(k), seen) {
                    add(own, other);
                }
            }
        }
        let facing = (0..edges.len()).filter(|&k| problem.facing_sides(interface).contains(&edges[k].side));
        for other in facing.flat_map(|edge| [false, true].map(|rising| Ray::of_end(edge, rising))) {
            for own in limits(other, inset(other.edge), |s| problem.seen_from(interface, other.edge, s)) {
                add(opposite(scene, other, own), (other.edge, other.s));
            }
        }
    }
    links
}

/// What the beginning of a ray sees, edges and parameters, from what is seen at one and two small steps along it.
fn limits(ray: Ray, step: f64, seen: impl Fn(f64) -> Vec<(usize, f64)>) -> Vec<(usize, f64)> {
    let step = if ray.rising { step } else { -step };
    let [near, far] = [1.0, 2.0].map(|steps| seen(ray.s + steps * step));
    let limit = |(edge, s): (usize, f64)| {
        let beyond = far.iter().filter(|of| of.0 == edge).map(|of| of.1);
        let beyond = beyond.min_by(|a, b| (a - s).abs().total_cmp(&(b - s).abs()));
        (edge, beyond.map_or(s, |beyond| 2.0 * s - beyond))
    };
    near.iter().copied().map(limit).collect()
}

/// The ray of another edge that runs along with one, from the point that its beginning sees.
fn opposite(scene: &Scene, ray: Ray, (edge, s): (usize, f64)) -> Ray {
    let outline = &scene.problem.outline;
    let edges = outline.edges();
    // the bodies lie on both sides: what is the first ray of one is the last of the other
    let is_first = ray.rising != edges[ray.edge].reversed;
    let rising = is_first == edges[edge].reversed;
    if (rising && s > 1.0 - NEAR) || (!rising && s < NEAR) {
        let (next, rising) = outline.neighbour(edge, rising);
        return Ray::of_end(next, rising);
    }
    let is_end = (rising && s < NEAR) || (!rising && s > 1.0 - NEAR);
    if is_end { Ray::of_end(edge, rising) } else { Ray { edge, s, rising } }
}

/// The angle of a body between an edge and the next one as the boundary is traversed.
fn interior_angle(before: &Edge, behind: &Edge) -> f64 {
    PI - angle(direction(before, true), direction(behind, false))
}

/// The edge that meets another one at its end s = 1 (`at_end`) or s = 0, and whether the boundary has no corner there.
pub(crate) fn beyond_end(outline: &Polygon, edge: usize, at_end: bool) -> (usize, bool) {
    let (other, _) = outline.neighbour(edge, at_end);
    let edges = outline.edges();
    // forward along the loop
    let before = at_end == edges[edge].reversed;
    let [first, second] = if before { [other, edge] } else { [edge, other] };
    (other, is_straight(&edges[first], &edges[second]))
}

/// Whether the boundary has no corner between an edge and the next one.
pub(crate) fn is_straight(before: &Edge, behind: &Edge) -> bool {
    let turn = (interior_angle(before, behind) - PI).abs();
    turn < if before.is_line() && behind.is_line() { STRAIGHT } else { SMOOTH }
}

/// The contact node of the side of a ray, with about its normal, that is nearest to its beginning.
pub(crate) fn nearest_row<'a>(scene: &Scene, rows: &'a [ContactRow], ray: Ray) -> Option<&'a ContactRow> {
    let edge = &scene.problem.outline.edges()[ray.edge];
    let (x, [tx, ty]) = (edge.point(ray.s), edge.tangent(ray.s));
    let distance = |r: &ContactRow| distance(r.point, x);
    let along = |r: &&ContactRow| r.side == edge.side && r.normal[0] * ty - r.normal[1] * tx > ALONG;
    rows.iter().filter(along).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Direction of an edge as the boundary is traversed, the body to its left, where it begins or ends.
fn direction(edge: &Edge, at_end: bool) -> [f64; 2] {
    match edge.is_line() {
        true => unit(minus(edge.end, edge.start)),
        false => edge.tangent(if at_end == edge.reversed { 0.0 } else { 1.0 }),
    }
}

/// A condition on a side that runs along `ray` from the point.
fn face_of(condition: &Condition, ray: [f64; 2]) -> Face {
    match condition {
        Condition::Free | Condition::Traction(_) | Condition::Pressure(_) => Face::Free,
        Condition::Displacement { values: [Some(_), Some(_)], .. } => Face::Held,
        Condition::Displacement { values: [None, None], .. } => Face::Free,
        // an axis, along the ray and turned from it
        Condition::Displacement { values: [Some(_), None], .. } => Face::HeldAlong([ray[0], -ray[1]]),
        Condition::Displacement { values: [None, Some(_)], .. } => Face::HeldAlong([ray[1], ray[0]]),
    }
}

/// Contact: the state of the nearest node of the side.
fn contact_face(rows: &[ContactRow], side: usize, friction: &Friction, vertex: [f64; 2]) -> Face {
    let distance = |r: &ContactRow| distance(r.point, vertex);
    let nearest = rows.iter().filter(|r| r.side == side).min_by(|a, b| distance(a).total_cmp(&distance(b)));
    match nearest.and_then(|row| state(row, max_pressure(rows), friction)) {
        None => Face::Free,
        Some(Joint::Bonded) => Face::Held,
        Some(Joint::Sliding(ratio)) => Face::Sliding(ratio),
    }
}

/// The state of a node in contact; none if it is open. The shear of Tresca's law is bounded: it holds nothing.
fn state(row: &ContactRow, largest: f64, friction: &Friction) -> Option<Joint> {
    if row.pressure <= TOUCHING * largest {
        return None;
    }
    Some(match friction {
        // at a node that slips rounding may say that it sticks
        Friction::Coulomb(_) if row.status == 1 && row.shear.abs() < row.bound * (1.0 - ROUNDING) => Joint::Bonded,
        Friction::Coulomb(_) => Joint::Sliding(row.shear / row.pressure),
        Friction::None | Friction::Tresca(_) => Joint::Sliding(0.0),
    })
}
