//! Vertices of the boundary at which stresses are infinite, so that numbers there are those of the mesh.

use std::f64::consts::PI;

use steklov_bem_operators::{Edge, SAME_PLACE};
use steklov_elastic::Material;
use steklov_elastic::plane::{angle, distance, minus, unit};
use steklov_elastic::{Face, Joint, Sector, Wedge};
use steklov_problem::{Condition, Faces, Friction, Interface, Scene, facets};

use crate::mesh::first_mesh::SMOOTH;
use crate::solve::contact_rows::{ContactRow, TOUCHING, max_pressure};

/// Angles that differ by less are the same (radian).
const STRAIGHT: f64 = 1e-9;

/// Tells of a point whether it is a vertex with infinite stresses: a corner, or where the condition of a straight side changes,
/// whose exponents let stresses grow without bound. Cells of different moduli about it count as one material; on the interface
/// of such a body with the medium around it no vertex is judged.
pub(crate) fn unbounded_at(scene: &Scene, rows: &[ContactRow]) -> impl Fn([f64; 2]) -> bool {
    let near = SAME_PLACE * scene.problem.outline.diameter();
    let vertices = vertices(scene);
    move |x| {
        let mut at = vertices.iter().filter(|(vertex, _)| distance(*vertex, x) <= near);
        at.any(|(vertex, edges)| is_unbounded_between(scene, rows, *edges, *vertex))
    }
}

/// The vertices with infinite stresses, each once, without corners between straight edges that stand for a curve. Ends of
/// interfaces between bodies are not judged.
pub(crate) fn unbounded_vertices(scene: &Scene, rows: &[ContactRow]) -> Vec<[f64; 2]> {
    let near = SAME_PLACE * scene.problem.outline.diameter();
    let between_bodies = |edge: &Edge| {
        let of = |i: &Interface| i.sides.contains(&edge.side) || scene.problem.facing_sides(i).contains(&edge.side);
        scene.problem.joints().any(|interface| interface.faces != Faces::Cut && of(interface))
    };
    let on_curves: Vec<[f64; 2]> = facets(&scene.problem.outline).into_iter().flat_map(|f| f.corners).collect();
    let mut found: Vec<[f64; 2]> = Vec::new();
    for (vertex, edges) in vertices(scene) {
        if !on_curves.contains(&vertex)
            && !edges.iter().any(|edge| between_bodies(edge))
            && is_unbounded_between(scene, rows, edges, vertex)
            && found.iter().all(|other| distance(*other, vertex) > near)
        {
            found.push(vertex);
        }
    }
    found
}

/// The vertices of the outline, each with the edges before and behind it.
fn vertices(scene: &Scene) -> Vec<([f64; 2], [&Edge; 2])> {
    let outline = &scene.problem.outline;
    let edges = outline.edges();
    let of_loop = |l: usize| {
        let order = outline.traversal(l);
        let at = |k: usize| {
            let (a, b) = (&edges[order[(k + order.len() - 1) % order.len()]], &edges[order[k]]);
            (b.start, [a, b])
        };
        (0..order.len()).map(at).collect::<Vec<_>>()
    };
    (0..outline.loops().len()).flat_map(of_loop).collect()
}

fn is_unbounded_between(scene: &Scene, rows: &[ContactRow], edges: [&Edge; 2], vertex: [f64; 2]) -> bool {
    let of_wedge = || wedge(scene, rows, edges[0], edges[1]).is_some_and(|wedge| wedge.is_singular());
    at_cut(scene, rows, edges, vertex).unwrap_or_else(of_wedge)
}

/// Whether a vertex next to a cut beyond a crack is the tip of that crack, whose faces do not stick there; none at other vertices.
fn at_cut(scene: &Scene, rows: &[ContactRow], edges: [&Edge; 2], vertex: [f64; 2]) -> Option<bool> {
    let problem = &scene.problem;
    let of = |edge: &Edge| {
        let meets = |i: &&Interface| i.sides.contains(&edge.side) || problem.facing_sides(i).contains(&edge.side);
        problem.joints().find(meets).and_then(|interface| problem.crack_before(interface))
    };
    let ([left, right], other) = match edges.map(of) {
        [None, None] => return None,
        [Some(_), Some(_)] => return Some(false),
        [Some(crack), None] => (crack, edges[1]),
        [None, Some(crack)] => (crack, edges[0]),
    };
    let sticks = || {
        let contact = scene.contact(left);
        contact.is_some_and(|c| matches!(contact_face(rows, left, &c.friction, vertex), Face::Held))
    };
    Some([left, right].contains(&other.side) && !sticks())
}

/// Exponents below that of a crack: of a vertex between a held and a free side that is re-entrant.
const STRONG: f64 = 0.45;

/// The vertices, those in contact apart, whose stresses grow faster than at the tip of a crack: the edges before and behind,
/// and the smallest exponent.
pub(crate) fn strong_vertices(scene: &Scene) -> Vec<([usize; 2], f64)> {
    let outline = &scene.problem.outline;
    let edges = outline.edges();
    let mut found = Vec::new();
    for l in 0..outline.loops().len() {
        let order = outline.traversal(l);
        for (k, &b) in order.iter().enumerate() {
            let a = order[(k + order.len() - 1) % order.len()];
            let held = |e: usize| (0..2).any(|i| scene.problem.sides[edges[e].side].holds(i));
            if held(a) == held(b) || [a, b].iter().any(|&e| scene.contact(edges[e].side).is_some()) {
                continue;
            }
            let wedge = wedge(scene, &[], &edges[a], &edges[b]).filter(|w| w.sectors[0].angle > PI + STRAIGHT);
            if let Some(exponent) = wedge.and_then(|wedge| wedge.least_exponent_below(STRONG)) {
                found.push(([a, b], exponent));
            }
        }
    }
    found
}

/// Direction of an edge as the boundary is traversed, the body to its left, where it begins or ends.
pub(crate) fn direction(edge: &Edge, at_end: bool) -> [f64; 2] {
    match edge.is_line() {
        true => unit(minus(edge.end, edge.start)),
        false => edge.tangent(if at_end == edge.reversed { 0.0 } else { 1.0 }),
    }
}

/// The wedge between the edge before a vertex and that behind it; none where the boundary goes on as before.
fn wedge(scene: &Scene, rows: &[ContactRow], before: &Edge, behind: &Edge) -> Option<Wedge> {
    let (a, b) = (direction(before, true), direction(behind, false));
    let angle = PI - angle(a, b);
    let straight = (angle - PI).abs() < if before.is_line() && behind.is_line() { STRAIGHT } else { SMOOTH };
    let sector = |angle: f64, material: &Material| Sector { angle, mu: material.mu(), kappa: material.kappa() };
    if let Some(around) = scene.surroundings().filter(|_| behind.loop_index == 0) {
        let judged = scene.body().cells().is_none() && !straight;
        let sectors = vec![sector(angle, &scene.body().material()), sector(2.0 * PI - angle, &around.material)];
        return judged.then_some(Wedge { sectors, joints: Vec::new(), faces: None });
    }
    let touch = |edge: &Edge| scene.contact(edge.side).is_some();
    if straight && (before.side == behind.side || touch(before) && touch(behind)) {
        return None;
    }
    let faces = [face(scene, rows, behind, behind.start, b), face(scene, rows, before, behind.start, a.map(|a| -a))];
    Some(Wedge { sectors: vec![sector(angle, &scene.body().material())], joints: Vec::new(), faces: Some(faces) })
}

/// The condition on an edge at one of its ends, from which it runs along `ray`.
pub(crate) fn face(scene: &Scene, rows: &[ContactRow], edge: &Edge, vertex: [f64; 2], ray: [f64; 2]) -> Face {
    if let Some(contact) = scene.contact(edge.side) {
        return contact_face(rows, edge.side, &contact.friction, vertex);
    }
    match &scene.problem.sides[edge.side].condition {
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
pub(crate) fn state(row: &ContactRow, largest: f64, friction: &Friction) -> Option<Joint> {
    if row.pressure <= TOUCHING * largest {
        return None;
    }
    Some(match friction {
        Friction::Coulomb(_) if row.status == 1 => Joint::Bonded,
        Friction::Coulomb(_) => Joint::Sliding(row.shear / row.pressure),
        Friction::None | Friction::Tresca(_) => Joint::Sliding(0.0),
    })
}
