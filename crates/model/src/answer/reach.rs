//! Whether bodies lie in each other, after they have moved, where no contact was looked for.
//!
//! Interfaces keep apart the parts of their sides that see each other. Every other pair of boundary elements of two bodies is
//! proved to be apart: x + u is a polynomial on an element (of a curve to rounding), within the hull of its Bernstein
//! coefficients; both curves are moved into their bodies by the depth that is allowed, and halved until a line separates them.
//! Pairs that cannot be separated are examined: they touch end to end, or one of their points, ends included, lies deeper than
//! that. Nothing is checked within twice the depth of vertices at which both bodies touch as they are drawn. A gap that the
//! scene adds to the distance counts as allowed depth.

use std::collections::HashMap;

use steklov_bem_operators::{Site, distance_to_segment};
use steklov_coupling::Cell;
use steklov_elastic::plane::{cross, distance, dot, minus};
use steklov_problem::Law;
use steklov_quadrature::{gauss_legendre, project};

use crate::answer::bernstein::{bernstein, halves};
use crate::data::joints::Joint;
use crate::data::on_mesh::OnMesh;

/// Degrees beyond those of displacements in which curves are followed.
const MORE: usize = 8;
/// Depth that is allowed, over the relative error times the largest displacement.
const DEEP: f64 = 2.0;
/// Depth that is allowed beside an interface, over the largest displacement: contact there is that of small displacements.
const BESIDE: f64 = 0.05;
/// Pieces of a pair of elements at most.
const MOST: usize = 20_000;
/// Number of parts of an element at whose ends its passage through another one is measured.
const PASSES: usize = 8;
/// Points of an element at which the depth of a found overlap is measured.
const LOOKS: usize = 64;

/// A place where two bodies lie in each other after they have moved.
#[derive(Debug, Clone, PartialEq)]
pub struct Entered {
    /// The bodies.
    pub bodies: [usize; 2],
    /// The place, after the motion.
    pub point: [f64; 2],
    /// How deep (length).
    pub depth: f64,
}

/// Control points of a piece of a moved element.
type Piece = Vec<[f64; 2]>;

impl OnMesh<'_> {
    /// The deepest place of every pair of bodies where they lie in each other beyond the relative `error` of the displacements.
    pub(crate) fn entered(&self, displacement: &[f64], joints: &[Joint], error: f64) -> Vec<Entered> {
        let outline = &self.scene.problem.outline;
        let body_of = |e: usize| outline.body_of_loop(outline.edges()[self.mesh.edge[e]].loop_index);
        let bodies: Vec<usize> = (0..self.mesh.len()).map(body_of).collect();
        let largest = displacement.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
        let rounding = 1e-9 * outline.diameter();
        let [strict, beside] = [DEEP * error, BESIDE].map(|part| (part * largest).max(rounding));
        let held_apart = HeldApart::new(self, joints);
        let common = self.common_vertices(&bodies, rounding);
        let none = Vec::new();
        let mut found: Vec<Entered> = Vec::new();
        let count = outline.bodies().len();
        for pair in (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b])) {
            let apart = self.drawn_too_large(joints, pair);
            let common = common.get(&pair).unwrap_or(&none);
            let of = |body: usize| (0..self.mesh.len()).filter(|&e| bodies[e] == body).collect::<Vec<_>>();
            let [first, second] = pair.map(of);
            for [a, b] in first.iter().flat_map(|&a| second.iter().map(move |&b| [a, b])) {
                if held_apart.is_beside(a, b) || held_apart.is(a, b) {
                    continue;
                }
                let ways = [self.passed(displacement, [a, b], rounding), self.passed(displacement, [b, a], rounding)];
                for (point, depth) in ways.into_iter().flatten().filter(|(_, depth)| *depth > strict + apart) {
                    keep_deepest(&mut found, Entered { bodies: pair, point, depth });
                }
            }
            for (is_beside, depth) in [(false, strict + apart), (true, beside.max(strict) + apart)] {
                let moved = [&first, &second].map(|elements| {
                    let whole = |&e: &usize| (e, self.moved(e, displacement, depth, [-1.0, 1.0]));
                    elements.iter().map(whole).collect::<Vec<_>>()
                });
                for ((a, piece), (b, other)) in moved[0].iter().flat_map(|a| moved[1].iter().map(move |b| (a, b))) {
                    let judged = held_apart.is_beside(*a, *b) == is_beside && !held_apart.is(*a, *b);
                    if !judged || are_apart(piece, other) {
                        continue;
                    }
                    let [Some(on_a), Some(on_b)] = [a, b].map(|e| self.away_from(common, *e, 2.0 * depth)) else {
                        continue;
                    };
                    let [first, second] =
                        [(a, on_a), (b, on_b)].map(|(e, range)| self.moved(*e, displacement, depth, range));
                    let Some(point) = meeting(&first, &second, 0.1 * depth) else { continue };
                    let least = depth;
                    let depth = self.depth(displacement, &bodies, [*a, *b]);
                    if depth > least {
                        keep_deepest(&mut found, Entered { bodies: pair, point, depth });
                    }
                }
            }
        }
        found
    }

    /// Where an element has passed farthest through one on the same line, and how far; elements on both faces of a crack do
    /// this without crossing.
    fn passed(&self, displacement: &[f64], [own, other]: [usize; 2], near: f64) -> Option<([f64; 2], f64)> {
        if !self.mesh.is_line(own) || !self.mesh.is_line(other) {
            return None;
        }
        let [a, b] = self.mesh.ends(other);
        let (d, length) = (minus(b, a), distance(b, a));
        let off = |x: [f64; 2]| cross(minus(x, a), d) / length;
        if self.mesh.ends(own).into_iter().any(|x| off(x).abs() > near) {
            return None;
        }
        let at = |k: usize| {
            let t = 2.0 * k as f64 / PASSES as f64 - 1.0;
            let (x, n) = (self.mesh.point(own, t), self.mesh.normal(own, t));
            let along = dot(minus(x, a), d) / length;
            if !(0.0..=length).contains(&along) {
                return None;
            }
            let m = self.mesh.normal(other, 0.0);
            if dot(n, m) > 0.0 {
                return None; // end to end
            }
            let u = self.displacement_at(displacement, own, t);
            let v = self.displacement_at(displacement, other, 2.0 * along / length - 1.0);
            Some(([x[0] + u[0], x[1] + u[1]], dot(minus(u, v), n)))
        };
        (0..=PASSES).filter_map(at).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The displacement at a point of an element.
    fn displacement_at(&self, displacement: &[f64], e: usize, t: f64) -> [f64; 2] {
        let basis = self.space.basis(e);
        let mut phi = vec![0.0; basis.degree + 1];
        basis.evaluate(t, &mut phi);
        let nodes = || self.space.element_nodes(e).zip(&phi);
        [0, 1].map(|i| nodes().map(|(k, phi)| displacement[2 * k + i] * phi).sum())
    }

    /// The largest gap that the scene adds to the distance of two bodies: by so much they are smaller than they are drawn.
    fn drawn_too_large(&self, joints: &[Joint], pair: [usize; 2]) -> f64 {
        let problem = &self.scene.problem;
        let gap = |joint: &Joint| {
            let interface = &problem.interfaces()[joint.interface];
            let Law::Contact(contact) = &interface.law else { return 0.0 };
            let sides = [interface.sides.as_slice(), problem.facing_sides(interface)].concat();
            if !pair.iter().all(|body| sides.iter().any(|&side| problem.body_of_side(side) == *body)) {
                return 0.0;
            }
            let at = |e: usize, k: usize| {
                let t = 2.0 * k as f64 / LOOKS as f64 - 1.0;
                self.value(&contact.gap, &Site::new(self.mesh, e, t))
            };
            joint.own.iter().flat_map(|&e| (0..=LOOKS).map(move |k| at(e, k))).fold(0.0, f64::max)
        };
        joints.iter().map(gap).fold(0.0, f64::max)
    }

    /// The vertices at which two bodies touch as they are drawn, by their numbers.
    fn common_vertices(&self, bodies: &[usize], near: f64) -> HashMap<[usize; 2], Vec<[f64; 2]>> {
        let mut common: HashMap<[usize; 2], Vec<[f64; 2]>> = HashMap::new();
        let start = |e: usize| self.mesh.ends(e)[0];
        for (a, b) in (0..self.mesh.len()).flat_map(|a| (a + 1..self.mesh.len()).map(move |b| (a, b))) {
            let (x, y) = (start(a), start(b));
            if bodies[a] != bodies[b] && distance(x, y) <= near {
                common.entry([bodies[a].min(bodies[b]), bodies[a].max(bodies[b])]).or_default().push(x);
            }
        }
        common
    }

    /// The part of an element that is farther away from points than this; none if all of it is nearer.
    fn away_from(&self, points: &[[f64; 2]], e: usize, least: f64) -> Option<[f64; 2]> {
        let near = |t: f64| {
            let x = self.mesh.point(e, t);
            points.iter().any(|p| distance(x, *p) < least)
        };
        if near(0.0) {
            return None;
        }
        let outermost = |end: f64| {
            let (mut away, mut other) = (0.0, end);
            for _ in 0..if near(end) { 40 } else { 0 } {
                let middle = (away + other) / 2.0;
                if near(middle) { other = middle } else { away = middle }
            }
            if near(end) { away } else { end }
        };
        Some([outermost(-1.0), outermost(1.0)])
    }

    /// A part of an element after the motion, moved into its body by this distance.
    fn moved(&self, e: usize, displacement: &[f64], inward: f64, [t0, t1]: [f64; 2]) -> Piece {
        let basis = self.space.basis(e);
        let degree = if self.mesh.is_line(e) { basis.degree } else { basis.degree + MORE };
        let at = |i: usize| {
            let mut phi = vec![0.0; basis.degree + 1];
            let value = |part: f64| {
                let t = (t0 * (1.0 - part) + t1 * (1.0 + part)) / 2.0;
                basis.evaluate(t, &mut phi);
                let moved: f64 =
                    self.space.element_nodes(e).zip(&phi).map(|(k, phi)| displacement[2 * k + i] * phi).sum();
                self.mesh.point(e, t)[i] + moved - inward * self.mesh.normal(e, t)[i]
            };
            bernstein(&project(value, degree, &gauss_legendre(degree + 1)))
        };
        at(0).into_iter().zip(at(1)).map(|(x, y)| [x, y]).collect()
    }

    /// The largest depth of points of either element in the body of the other one.
    fn depth(&self, displacement: &[f64], bodies: &[usize], pair: [usize; 2]) -> f64 {
        let point = |e: usize, k: usize| {
            let t = 2.0 * k as f64 / LOOKS as f64 - 1.0;
            let (x, u) = (self.mesh.point(e, t), self.displacement_at(displacement, e, t));
            [x[0] + u[0], x[1] + u[1]]
        };
        let of = |own: usize, body: usize| {
            let boundary: Vec<[[f64; 2]; 2]> = (0..self.mesh.len())
                .filter(|&e| bodies[e] == body)
                .flat_map(|e| (0..LOOKS).map(move |k| (e, k)))
                .map(|(e, k)| [point(e, k), point(e, k + 1)])
                .collect();
            let bounded = self.scene.problem.outline.is_body_bounded(body);
            let depth = |x: [f64; 2]| if is_within(&boundary, x) == bounded { distance_to(&boundary, x) } else { 0.0 };
            (0..=LOOKS).map(|k| depth(point(own, k))).fold(0.0, f64::max)
        };
        of(pair[0], bodies[pair[1]]).max(of(pair[1], bodies[pair[0]]))
    }
}

/// Keeps the deepest place of every pair of bodies.
fn keep_deepest(found: &mut Vec<Entered>, new: Entered) {
    match found.iter_mut().find(|of| of.bodies == new.bodies) {
        Some(of) if of.depth < new.depth => *of = new,
        Some(_) => {}
        None => found.push(new),
    }
}

/// Which elements an interface keeps apart.
struct HeldApart {
    /// Interfaces on which elements see others, or are seen.
    seeing: Vec<Vec<usize>>,
    seen: Vec<Vec<usize>>,
    /// Interfaces to whose sides they belong.
    sides: Vec<Vec<usize>>,
    /// Interfaces between sides of their body.
    bodies: Vec<Vec<usize>>,
}

impl HeldApart {
    fn new(data: &OnMesh<'_>, joints: &[Joint]) -> Self {
        let (problem, mesh) = (&data.scene.problem, data.mesh);
        let none = || vec![Vec::new(); mesh.len()];
        let mut apart = Self { seeing: none(), seen: none(), sides: none(), bodies: none() };
        for (k, joint) in joints.iter().enumerate() {
            for &Cell { element, other, .. } in &joint.cells {
                apart.seeing[element].push(k);
                apart.seen[other].push(k);
            }
            let interface = &problem.interfaces()[joint.interface];
            let sides: Vec<usize> = interface.sides.iter().chain(problem.facing_sides(interface)).copied().collect();
            let bodies: Vec<usize> = sides.iter().map(|&side| problem.body_of_side(side)).collect();
            for e in 0..mesh.len() {
                if sides.contains(&mesh.side[e]) {
                    apart.sides[e].push(k);
                }
                if bodies.contains(&problem.body_of_side(mesh.side[e])) {
                    apart.bodies[e].push(k);
                }
            }
        }
        apart
    }

    /// Whether two elements see each other's side on one interface.
    fn is(&self, a: usize, b: usize) -> bool {
        let common = |a: &[usize], b: &[usize]| a.iter().any(|k| b.contains(k));
        common(&self.seeing[a], &self.seen[b]) || common(&self.seen[a], &self.seeing[b])
    }

    /// Whether one of them is on a side of an interface between their bodies.
    fn is_beside(&self, a: usize, b: usize) -> bool {
        let between = |k: &usize| self.bodies[a].contains(k) && self.bodies[b].contains(k);
        self.sides[a].iter().chain(&self.sides[b]).any(between)
    }
}

/// A point that two pieces may have in common; none where they are apart.
fn meeting(a: &Piece, b: &Piece, small: f64) -> Option<[f64; 2]> {
    let mut stack = vec![(a.clone(), b.clone())];
    for _ in 0..MOST {
        let (a, b) = stack.pop()?;
        if are_apart(&a, &b) {
            continue;
        }
        let (size_a, size_b) = (size(&a), size(&b));
        if size_a.max(size_b) < small {
            return Some(a[0]);
        }
        if size_a > size_b {
            stack.extend(parts(&a).map(|half| (half, b.clone())));
        } else {
            stack.extend(parts(&b).map(|half| (a.clone(), half)));
        }
    }
    stack.pop().map(|(a, _)| a[0])
}

/// Whether a line along an axis or along the chord of one of them separates two hulls.
fn are_apart(a: &Piece, b: &Piece) -> bool {
    let across = |piece: &Piece| {
        let (first, last) = (piece[0], piece[piece.len() - 1]);
        [first[1] - last[1], last[0] - first[0]]
    };
    let range = |piece: &Piece, axis: [f64; 2]| {
        let along = piece.iter().map(|x| dot(*x, axis));
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    };
    [[1.0, 0.0], [0.0, 1.0], across(a), across(b)].into_iter().any(|axis| {
        let [a, b] = [range(a, axis), range(b, axis)];
        a[1] < b[0] || b[1] < a[0]
    })
}

fn size(piece: &Piece) -> f64 {
    let span = |i: usize| {
        let along = piece.iter().map(|x| x[i]);
        along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
    };
    span(0).max(span(1))
}

fn parts(piece: &Piece) -> [Piece; 2] {
    let of = |i: usize| halves(&piece.iter().map(|x| x[i]).collect::<Vec<f64>>());
    let ([left_x, right_x], [left_y, right_y]) = (of(0), of(1));
    [(left_x, left_y), (right_x, right_y)].map(|(x, y)| x.into_iter().zip(y).map(|(x, y)| [x, y]).collect())
}

/// Whether a point is to the left of closed polygons.
fn is_within(boundary: &[[[f64; 2]; 2]], [x, y]: [f64; 2]) -> bool {
    let crosses =
        |[a, b]: &&[[f64; 2]; 2]| (a[1] > y) != (b[1] > y) && x < a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]);
    boundary.iter().filter(crosses).count() % 2 == 1
}

fn distance_to(boundary: &[[[f64; 2]; 2]], x: [f64; 2]) -> f64 {
    boundary.iter().map(|side| distance_to_segment(x, *side)).fold(f64::INFINITY, f64::min)
}
