//! The first mesh: vertices at singular points and where the data are narrower than an element.

use steklov_bem_operators::{CutPlan, Edge, Grading, Mark, Mesh, Piece, Polygon, SAME_PLACE, Subdivision};
use steklov_elastic::plane::{angle, minus};
use steklov_expression::{Expression, OnEdge, Track};
use steklov_problem::{Condition, Interface, Law, Refine, Scene, Span, Springs};

use crate::answer::wedges::beyond_end;
use crate::mesh::automatic_cuts::{automatic_cuts, continuation, first_error, is_smooth};
use crate::mesh::layout::Layout;

/// Angles on curves that differ by less are the same (radian): their numbers are seldom written with more digits.
pub(crate) const SMOOTH: f64 = 1e-6;
/// Straight corners are those whose sides turn by less than this (radian).
const STRAIGHT: f64 = 1e-9;
/// A vertex closer to a kink of the data than this part of its element is moved there.
const SNAP: f64 = 0.2;
/// Data that vary within less than an element of the first mesh get vertices there, at no more than this many places of an
/// edge.
const MOST_PLACES: usize = 64;
/// A vertex within this part of its distance from such a place is as good as another one there.
const NEAR: f64 = 0.4;
/// They change by this part of the largest value there.
const STEEP: f64 = 0.05;
/// Values beyond this part of the largest one are seen.
const SEEN: f64 = 0.2;

impl Layout {
    /// The first mesh; of the hp strategy with vertices at the kinks of the data, and cut into subdomains where that pays.
    pub fn first(scene: &Scene) -> Self {
        Self::planned(scene).0
    }

    /// The first mesh, and the plan of its cuts or why there are none.
    pub fn planned(scene: &Scene) -> (Self, Result<CutPlan, String>) {
        let mesh = Mesh::uniform(&scene.problem.outline, scene.first_elements(), scene.method.degree);
        let mut subdivision = Subdivision::new(&mesh, &vec![Mark::Keep; mesh.len()]);
        let (cuts, plan) =
            automatic_cuts(scene).map_or_else(|why| (None, Err(why)), |(cuts, plan)| (Some(cuts), Ok(plan)));
        let ends = cuts.as_ref().map_or(Vec::new(), |cuts| cuts.cuts.ends());
        if scene.method.elements.is_none() {
            divide_at_ends(&mut subdivision, &ends);
        }
        if scene.method.refine != Refine::Hp {
            // what faces another body does so with whole elements
            if scene.problem.has_several_bodies() {
                for (k, points) in singular_points(scene, false).iter().enumerate() {
                    points.iter().for_each(|&s| subdivision.insert(k, s, &[], 0.0));
                }
            }
        }
        if scene.method.refine == Refine::Hp {
            if scene.has_few_first_elements() {
                halve_long(&mut subdivision, &scene.problem.outline);
            }
            for (k, points) in singular_points(scene, true).iter().enumerate() {
                for (i, &s) in points.iter().enumerate() {
                    subdivision.insert(k, s, &points[..i], SNAP);
                }
                for place in narrow_places(scene, &scene.problem.outline.edges()[k], &subdivision.edges[k].clone()) {
                    insert_apart(&mut subdivision, k, place);
                    if matches!(
                        scene.problem.sides[scene.problem.outline.edges()[k].side].condition,
                        Condition::Displacement { .. }
                    ) {
                        insert_graded(&mut subdivision, &scene.problem.outline, k, place);
                    }
                }
            }
        }
        halve_single(&mut subdivision, scene);
        for (edge, s) in ends {
            subdivision.insert(edge, s, &[], 0.0);
        }
        let subdivision = with_first_degrees(subdivision, scene);
        (Self { subdivision, tips: Vec::new(), cuts }.with_equal_cuts(&scene.problem), plan)
    }
}

/// Divides edges at the ends of cuts, and their parts into equal elements no longer than those that the edges had: equal cells get equal
/// elements.
fn divide_at_ends(subdivision: &mut Subdivision, ends: &[(usize, f64)]) {
    for (edge, pieces) in subdivision.edges.iter_mut().enumerate() {
        let own: Vec<f64> = ends.iter().filter(|end| end.0 == edge).map(|end| end.1).collect();
        if own.is_empty() {
            continue;
        }
        let longest = pieces.iter().map(|piece| piece.end - piece.start).fold(0.0, f64::max);
        let vertices: Vec<f64> = [0.0].into_iter().chain(own).chain([1.0]).collect();
        let first = pieces[0];
        let of_part = |part: &[f64]| {
            let [a, b] = [part[0], part[1]];
            let n = ((b - a) / longest - SAME_PLACE).ceil().max(1.0) as usize;
            let at = move |k: usize| if k == n { b } else { a + (b - a) * k as f64 / n as f64 };
            (0..n).map(move |k| Piece { start: at(k), end: at(k + 1), ..first })
        };
        *pieces = vertices.windows(2).flat_map(of_part).collect();
    }
}

/// Raises the degrees of the elements of a smooth scene to those at which the solution, continued beyond the boundary, has an error
/// of [`first_error`].
fn with_first_degrees(subdivision: Subdivision, scene: &Scene) -> Subdivision {
    let outline = &scene.problem.outline;
    let (true, Ok(mesh)) = (is_smooth(scene), subdivision.mesh(outline)) else { return subdivision };
    let (continuation, _) = continuation(scene);
    let error = first_error(scene);
    // an edge has more elements than pieces where it turns too far for one
    let mut raised = Subdivision::new(&mesh, &vec![Mark::Keep; mesh.len()]);
    for e in 0..mesh.len() {
        let [a, b] = mesh.span[e];
        let degree = continuation.degree(&mesh.curve(e), error);
        for piece in raised.edges[mesh.edge[e]].iter_mut().filter(|piece| piece.start == a.min(b)) {
            piece.degree = piece.degree.max(degree);
        }
    }
    raised
}

/// Halves elements that are all of a part of an edge that is tied or, of degree 1, in contact, if both of their ends may have no
/// multipliers: those of ties, corners beside a side that is held, and between bodies corners beside another part in contact.
fn halve_single(subdivision: &mut Subdivision, scene: &Scene) {
    let problem = &scene.problem;
    let edges = problem.outline.edges();
    let may_lack = |edge: usize, at_end: bool| {
        let (other, is_straight) = beyond_end(&problem.outline, edge, at_end);
        let [own, other] = [edge, other].map(|edge| edges[edge].side);
        let is_held = matches!(problem.sides[other].condition, Condition::Displacement { .. });
        let joined = [own, other].into_iter().all(|side| problem.joint(side).is_some());
        is_held || joined && problem.contact(other).is_some() && !is_straight
    };
    let tied = |own: &&Interface| matches!(own.law, Law::Tied(_));
    let of_ties = problem.joints().filter(tied).flat_map(|own| problem.spans(own));
    let between = problem.joints().filter(|own| !tied(own)).flat_map(|own| problem.spans(own));
    let on_obstacle = |&edge: &usize| {
        let side = edges[edge].side;
        problem.joint(side).is_none() && problem.contact(side).is_some()
    };
    let on_obstacles = (0..edges.len()).filter(on_obstacle).map(|edge| Span { edge, s: [0.0, 1.0] });
    let is_all = |of: &Span| of.s == [0.0, 1.0] && [false, true].into_iter().all(|at_end| may_lack(of.edge, at_end));
    let in_contact = between.chain(on_obstacles).filter(is_all).filter(|of| subdivision.edges[of.edge][0].degree < 2);
    for Span { edge, s: [a, b] } in of_ties.chain(in_contact).collect::<Vec<_>>() {
        let inside = |p: &&Piece| p.start > a - SAME_PLACE && p.end < b + SAME_PLACE;
        let alone: Vec<Piece> = subdivision.edges[edge].iter().filter(inside).copied().collect();
        if let [piece] = alone.as_slice() {
            subdivision.insert(edge, (piece.start + piece.end) / 2.0, &[], 0.0);
        }
    }
}

/// Halves elements that are longer than [`LONG`] times their distance from another loop: across a ligament no low degree follows.
fn halve_long(subdivision: &mut Subdivision, polygon: &Polygon) {
    let edges = polygon.edges();
    for (edge, pieces) in edges.iter().zip(&mut subdivision.edges) {
        let body = |edge: &Edge| polygon.body_of_loop(edge.loop_index);
        // no point of the edge is farther from this one than its length
        let (middle, length) = (edge.point(0.5), edge.length());
        let near = |other: &&Edge| {
            let reach = length * (1.0 + 1.0 / LONG);
            let of_body = other.loop_index != edge.loop_index && body(other) == body(edge);
            of_body && other.nearest(middle, reach).is_some()
        };
        let others: Vec<&Edge> = edges.iter().filter(near).collect();
        let is_long = |piece: &Piece| {
            let least = (piece.end - piece.start) * length / LONG;
            let at = |k: usize| edge.point(piece.start + (piece.end - piece.start) * k as f64 / 8.0);
            (0..=8).any(|k| others.iter().any(|other| other.nearest(at(k), least).is_some()))
        };
        let (mut stack, mut parts) = (std::mem::take(pieces), Vec::new());
        stack.reverse();
        while let Some(piece) = stack.pop() {
            if piece.end - piece.start < SHORTEST || !is_long(&piece) {
                parts.push(piece);
                continue;
            }
            let middle = (piece.start + piece.end) / 2.0;
            stack.extend([Piece { start: middle, ..piece }, Piece { end: middle, ..piece }]);
        }
        *pieces = parts;
    }
}

/// Largest length of an element of a first mesh over its distance from another loop.
const LONG: f64 = 4.0;
/// No part of an edge shorter than this is halved for this reason.
const SHORTEST: f64 = 1e-2;

/// Singular points of every edge that are known before anything is solved, rising: its corners, except those where the
/// boundary goes on straight on the same side; with `kinks` also where a datum has a kink or jumps.
pub fn singular_points(scene: &Scene, kinks: bool) -> Vec<Vec<f64>> {
    let edges = scene.problem.outline.edges();
    let mut points = vec![Vec::new(); edges.len()];
    for l in 0..scene.problem.outline.loops().len() {
        let order = scene.problem.outline.traversal(l);
        let order: Vec<usize> = order.into_iter().collect();
        for (i, &a) in order.iter().enumerate() {
            let b = order[(i + 1) % order.len()];
            let curved = !edges[a].is_line() || !edges[b].is_line();
            let direction = |k: usize, at_end: bool| match edges[k].is_line() {
                true => minus(edges[k].end, edges[k].start),
                false => edges[k].tangent(if at_end == edges[k].reversed { 0.0 } else { 1.0 }),
            };
            let (x, y) = (direction(a, true), direction(b, false));
            let turn = angle(x, y);
            let free =
                |k: usize| scene.problem.sides[edges[k].side].is_free() && scene.contact(edges[k].side).is_none();
            let alike = edges[a].side == edges[b].side || curved && free(a) && free(b);
            let mirror = curved && is_mirror_corner(scene, [a, b], turn);
            let bends = curved && bends_at_joint(&edges[a], &edges[b]);
            let jumps = alike && (starts_anew(scene, &edges[a]) || starts_anew(scene, &edges[b]));
            if !mirror && (bends || jumps || turn.abs() > if curved { SMOOTH } else { STRAIGHT } || !alike) {
                points[a].push(if edges[a].reversed { 0.0 } else { 1.0 });
                points[b].push(if edges[b].reversed { 1.0 } else { 0.0 });
            }
        }
    }
    if kinks {
        for (k, edge) in edges.iter().enumerate() {
            for datum in
                scene.problem.side_data(edge.side).into_iter().map(|(_, datum)| datum).chain(scene.jumps_on(edge))
            {
                let along = datum.along(edge);
                points[k].extend(along.kinks.iter().filter(|s| **s > 1e-9 && **s < 1.0 - 1e-9));
            }
        }
    }
    for points in &mut points {
        points.sort_by(f64::total_cmp);
        points.dedup_by(|b, a| *b - *a < 1e-9);
    }
    scene.problem.share_points(&mut points);
    points
}

/// Whether data of an edge depend on its s, which is 1 before a joint and 0 behind it: they have a kink or a jump there.
fn starts_anew(scene: &Scene, edge: &Edge) -> bool {
    let of_side = scene.problem.side_data(edge.side).into_iter().map(|(_, datum)| datum);
    of_side.chain(scene.jumps_on(edge)).any(Expression::uses_edge)
}

/// Whether the curvature jumps from one edge to the next: displacements have a part r² log r there, which degrees alone resolve
/// slowly and an estimate does not see.
fn bends_at_joint(before: &Edge, behind: &Edge) -> bool {
    let at = |edge: &Edge, at_end: bool| edge.curvature(if at_end == edge.reversed { 0.0 } else { 1.0 });
    let (a, b) = (at(before, true), at(behind, false));
    (a - b).abs() > SAME_CURVATURE * a.abs().max(b.abs())
}

/// Curvatures that differ by less than this part are one.
const SAME_CURVATURE: f64 = 1e-6;

/// Whether the field goes on beyond a corner between a straight edge and a curve as its mirror image, without a singular part: the
/// one lies along an axis and is held along its normal alone, the other meets it at 90° and is free or under a constant pressure.
fn is_mirror_corner(scene: &Scene, edges: [usize; 2], turn: f64) -> bool {
    let all = scene.problem.outline.edges();
    let held = |k: usize| {
        let ([a, b], side) = (all[k].listed(), &scene.problem.sides[all[k].side]);
        let Condition::Displacement { values, traction: None } = &side.condition else { return false };
        let along = |i: usize| all[k].is_line() && a[i] == b[i];
        let constant = |i: usize| values[i].as_ref().is_some_and(|v| v.constant().is_some());
        (0..2).any(|i| along(i) && constant(i) && values[1 - i].is_none())
    };
    let even = |k: usize| {
        let side = &scene.problem.sides[all[k].side];
        let loaded = match &side.condition {
            Condition::Free => scene.contact(all[k].side).is_none(),
            Condition::Pressure(pressure) => pressure.constant().is_some(),
            _ => false,
        };
        loaded && side.springs.iter().flat_map(Springs::stiffnesses).all(|k| k.constant().is_some())
    };
    let square = (turn.abs() - std::f64::consts::FRAC_PI_2).abs() < SMOOTH;
    let [a, b] = edges;
    square && turn > 0.0 && (held(a) && even(b) || even(a) && held(b)) && scene.body().force.is_none()
}

/// The elements between two of these points. The error of one may have the parity that the single bubble of an estimate lacks.
pub fn coarse_elements(mesh: &Mesh, singular: &[Vec<f64>]) -> Vec<usize> {
    let at = |e: usize, s: f64| singular[mesh.edge[e]].iter().any(|p| (p - s).abs() < SAME_PLACE);
    (0..mesh.len()).filter(|&e| mesh.span[e].iter().all(|&s| at(e, s))).collect()
}

/// Makes vertices at three places of an edge, except where there is one already.
pub(crate) fn insert_apart(subdivision: &mut Subdivision, edge: usize, places: [f64; 3]) {
    let apart = 0.1 * (places[2] - places[0]).abs();
    for s in places {
        let near = |p: &Piece| (p.start - s).abs() < apart || (p.end - s).abs() < apart;
        if !subdivision.edges[edge].iter().any(near) {
            subdivision.insert(edge, s, &[], 0.0);
        }
    }
}

/// Vertices at distances that grow by 1/σ away from a narrow place of prescribed displacements, along this edge and those after
/// it: the tractions beside it fall off like those beside a singular point, but no estimate of one long element sees that. There
/// are none where a vertex is about as far away already.
fn insert_graded(subdivision: &mut Subdivision, polygon: &Polygon, edge: usize, [begin, _, end]: [f64; 3]) {
    let sigma = Grading::default().sigma;
    let edges = polygon.edges();
    let half = (end - begin) / 2.0 * edges[edge].length();
    for (from, rising) in [(begin, false), (end, true)] {
        let (mut at, mut rising) = (edge, rising);
        // distance from the place to the end of this edge that the walk comes from
        let mut passed = if rising { -from } else { from - 1.0 } * edges[edge].length();
        let mut distance = half;
        while distance < polygon.diameter() {
            let length = edges[at].length();
            if distance - passed >= length {
                passed += length;
                (at, rising) = polygon.neighbour(at, rising);
                continue;
            }
            let s = (distance - passed) / length;
            let s = if rising { s } else { 1.0 - s };
            let apart = NEAR * distance / length;
            let near = |p: &Piece| (p.start - s).abs() < apart || (p.end - s).abs() < apart;
            if !subdivision.edges[at].iter().any(near) {
                subdivision.insert(at, s, &[], 0.0);
            }
            distance /= sigma;
        }
    }
}

/// Where the data of an edge, gaps apart, change within less than one of its elements, unseen by its nodes: begin, peak and
/// end of each such place. A gap matters where the body comes near the obstacle only.
fn narrow_places(scene: &Scene, edge: &Edge, elements: &[Piece]) -> Vec<[f64; 3]> {
    let shortest = elements.iter().map(|p| p.end - p.start).fold(0.0, f64::max);
    let mut places: Vec<[f64; 3]> = Vec::new();
    let condition = &scene.problem.sides[edge.side].condition;
    let contact = scene.contact(edge.side).is_some();
    let of_side =
        scene.problem.side_data(edge.side).into_iter().filter(|(what, _)| *what != "gap").map(|(_, datum)| datum);
    for datum in of_side.chain(scene.jumps_on(edge)) {
        if datum.constant().is_some() {
            continue;
        }
        let along = datum.along(edge);
        let clusters = along.survey.stretches(0.55 * shortest, STEEP);
        let held = matches!(condition, Condition::Displacement { .. });
        // loads are integrated: a look between the nodes is enough to see them; bounds and held values count at nodes, and one
        // node does not show how steep held values are
        let loads = !contact && matches!(condition, Condition::Traction(_) | Condition::Pressure(_) | Condition::Free);
        let value = |s: f64| {
            let (x, y, s) = OnEdge::new(edge, datum).at(s);
            datum.eval(x, y, s).abs()
        };
        let largest = along.survey.sampled.magnitude();
        let points: Vec<f64> = elements
            .iter()
            .flat_map(|p| {
                let parts = if loads { 4 } else { p.degree };
                (0..=parts).map(move |k| p.start + (p.end - p.start) * k as f64 / parts as f64)
            })
            .collect();
        for [a, b] in clusters.into_iter().filter(|c| c[0] < c[1] && c[1] - c[0] <= shortest) {
            if held || !points.iter().any(|&s| a <= s && s <= b && value(s) > SEEN * largest) {
                let inside = along.survey.samples.iter().filter(|p| a < p.0 && p.0 < b);
                let peak = inside.max_by(|p, q| p.1.abs().total_cmp(&q.1.abs())).map_or((a + b) / 2.0, |p| p.0);
                places.push([a, peak, b]);
            }
        }
    }
    if places.len() > MOST_PLACES { Vec::new() } else { places }
}

/// The mesh of the first step.
pub fn first_mesh(scene: &Scene) -> Mesh {
    let uniform = || Mesh::uniform(&scene.problem.outline, scene.first_elements(), scene.method.degree);
    Layout::first(scene).subdivision.mesh(&scene.problem.outline).unwrap_or_else(|_| uniform())
}
