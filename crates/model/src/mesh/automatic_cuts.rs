//! Where a scene is cut into subdomains, and the first elements of the cuts.

use std::sync::Arc;

use steklov_bem_operators::{Continuation, CutPlan, CutRules, Cuts, Edge, Piece, continued_radius};
use steklov_elastic::plane::{angle, distance, dot, minus};
use steklov_expression::Turn;
use steklov_problem::{Condition, Cutting, Indicator, Multiplier, Refine, Scene};

use crate::mesh::first_mesh::singular_points;
use crate::mesh::layout::MeshedCuts;
use crate::refine::asperities::gap_turns;

/// Error of cuts that the degrees of a first mesh allow for, where layers at corners need several steps anyway.
const FIRST: f64 = 0.1;
/// The same of all elements where the solution is smooth, over the root of the tolerance, so that the second mesh is the last: the
/// error of meshes was 0.15 of it.
const OF_ROOT: f64 = 0.33;
/// Smallest gain for which a body is cut: predicted operations without cuts over those with them.
const GAIN: f64 = 2.5;
/// A body with fewer unknowns is not cut.
const FEWEST: usize = 600;
/// Growth of the error of an element on a smooth part of the boundary by a degree less.
const DECAY: f64 = 2.5;
/// Layers of elements beside a corner for each factor of ten of the error.
const LAYERS: f64 = 1.5;
/// Corners turn by more than this (radian).
const STRAIGHT: f64 = 1e-9;

/// The first of the properties of a scene with which its body cannot be cut: the key, and its name.
pub(crate) fn hindrance(scene: &Scene) -> Option<(&'static str, &'static str)> {
    let (problem, method) = (&scene.problem, &scene.method);
    let all = [
        (problem.bodies.len() > 1 || problem.bodies[0].far.is_some(), "body", "several bodies or a medium"),
        (problem.has_springs(), "sides", "springs"),
        (scene.random.is_some(), "random", "random input"),
        (method.multiplier != Multiplier::Biorthogonal, "method", "stabilised multipliers"),
        (method.indicator != Indicator::Bubble, "method", "a residual indicator"),
        (method.estimators, "method", "residual estimators"),
        (!matches!(method.refine, Refine::None | Refine::Hp), "method", "refinement other than \"hp\""),
    ];
    all.into_iter().find(|(is, ..)| *is).map(|(_, key, what)| (key, what))
}

/// The cuts of a scene with their first elements, and their plan.
///
/// # Errors
/// Why it is not cut: cuts are not wanted, not possible, or do not pay.
pub(crate) fn automatic_cuts(scene: &Scene) -> Result<(MeshedCuts, CutPlan), String> {
    let (plan, rules) = plan(scene)?;
    let cuts = Cuts::new(&scene.problem.outline, &plan.lines).map_err(|e| e.to_string())?;
    let error = first_error(scene);
    let elements = cuts.parts().into_iter().map(|ends| elements_of(&rules, ends, error, scene.method.degree)).collect();
    Ok((MeshedCuts { cuts: Arc::new(cuts), elements }, plan))
}

fn plan(scene: &Scene) -> Result<(CutPlan, CutRules), String> {
    if scene.method.cuts == Cutting::None {
        return Err("as the scene says".to_owned());
    }
    if let Some((_, what)) = hindrance(scene) {
        return Err(format!("a scene with {what} has none"));
    }
    if scene.method.refine == Refine::None {
        return Err("one mesh that the scene asks for is solved".to_owned());
    }
    let rules = rules(scene);
    let plan = scene.problem.outline.plan_cuts(&rules);
    let (unknowns, gain) = (plan.unknowns[0], plan.cost[0] / plan.cost[1]);
    if unknowns < FEWEST {
        return Err(format!("about {unknowns} unknowns at the wanted error: cuts pay from {FEWEST} on"));
    }
    if plan.lines.is_empty() || gain < GAIN {
        return Err("no cuts that cost less were found".to_owned());
    }
    Ok((plan, rules))
}

fn rules(scene: &Scene) -> CutRules {
    let (mut continuation, graded) = continuation(scene);
    let turns = gap_turns(scene);
    let at = |maximum: bool| {
        let edges = scene.problem.outline.edges().iter().zip(&turns);
        let of_edge = |(edge, turns): (&Edge, &Vec<Turn>)| {
            turns.iter().filter(|turn| turn.maximum == maximum).map(|turn| edge.point(turn.at)).collect::<Vec<_>>()
        };
        edges.flat_map(of_edge).collect::<Vec<[f64; 2]>>()
    };
    let [valleys, peaks] = [true, false].map(at);
    continuation.singular.extend(&peaks);
    let tolerance = scene.method.tolerance();
    let smooth = (-tolerance.ln() / DECAY.ln()).ceil().max(2.0) as usize;
    let layers = (LAYERS * -tolerance.log10()).ceil().max(1.0) as usize;
    CutRules {
        continuation,
        graded,
        kept: scene.contacts().map(|(side, _)| side).collect(),
        valleys,
        peaks,
        degrees: [smooth, smooth + 1, smooth],
        of_corner: layers * (layers + 3),
    }
}

/// Whether degrees alone resolve a scene, so that they are foreseen: one body with curves, without contact and without corners to which
/// meshes are graded.
pub(crate) fn is_smooth(scene: &Scene) -> bool {
    let is_curved = !scene.problem.outline.edges().iter().all(Edge::is_line);
    let is_hp = scene.method.refine == Refine::Hp && hindrance(scene).is_none();
    is_curved && is_hp && scene.contacts().next().is_none() && continuation(scene).1.is_empty()
}

/// Error that the degrees of a first mesh allow for.
pub(crate) fn first_error(scene: &Scene) -> f64 {
    if is_smooth(scene) { FIRST.min(OF_ROOT * scene.method.tolerance().sqrt()) } else { FIRST }
}

/// The first elements of a part of a cut.
fn elements_of(rules: &CutRules, ends: [[f64; 2]; 2], error: f64, least: usize) -> Vec<Piece> {
    let vertices: Vec<f64> = [0.0].into_iter().chain(rules.breaks(ends)).chain([1.0]).collect();
    let at = |s: f64| [0, 1].map(|i| ends[0][i] + s * (ends[1][i] - ends[0][i]));
    let of = |s: &[f64]| {
        let degree = rules.degree([at(s[0]), at(s[1])], error).max(least);
        Piece { start: s[0], end: s[1], degree, mark: Default::default() }
    };
    vertices.windows(2).map(of).collect()
}

/// How far the solution continues, and the corners to which meshes are graded.
pub(crate) fn continuation(scene: &Scene) -> (Continuation, Vec<[f64; 2]>) {
    let outline = &scene.problem.outline;
    let edges = outline.edges();
    let mut graded = Vec::new();
    for (k, places) in singular_points(scene, false).iter().enumerate() {
        let (next, _) = outline.neighbour(k, !edges[k].reversed);
        if places.contains(&edges[k].at_end()) && is_singular(scene, &edges[k], &edges[next]) {
            graded.push(edges[k].end);
        }
    }
    let mut all = graded.clone();
    for (edge, places) in edges.iter().zip(singular_points(scene, true)) {
        all.extend(places.into_iter().filter(|s| *s > 0.0 && *s < 1.0).map(|s| edge.point(s)));
    }
    (Continuation { singular: all, circles: circles(edges) }, graded)
}

/// Whether a corner is re-entrant, or conditions change there. At a convex one between free or loaded sides the solution is smooth
/// enough.
fn is_singular(scene: &Scene, before: &Edge, behind: &Edge) -> bool {
    let turn = angle(before.tangent(before.at_end()), behind.tangent(1.0 - behind.at_end()));
    let is_loaded = |edge: &Edge| {
        let condition = &scene.problem.sides[edge.side].condition;
        !matches!(condition, Condition::Displacement { .. }) && scene.contact(edge.side).is_none()
    };
    turn <= STRAIGHT || !is_loaded(before) || !is_loaded(behind)
}

/// Smallest difference of radii that is no rounding (part of the radius).
const SMALLER: f64 = 1e-6;

/// Radius of the largest disc in a hole, beyond an edge, that touches the edge at a point: that of curvature, or a smaller one that
/// touches the hole elsewhere too.
fn touching_radius(edges: &[Edge], edge: &Edge, s: f64, of_curvature: f64) -> f64 {
    let (x, outward) = (edge.point(s), edge.normal(s));
    let own = edges.iter().filter(|other| other.loop_index == edge.loop_index);
    let points = own.flat_map(|other| (0..16).map(|k| other.point(f64::from(k) / 16.0)));
    let through = |y: [f64; 2]| {
        let d = minus(y, x);
        let across = dot(d, outward);
        let is_apart = dot(d, d).sqrt() > SMALLER * of_curvature;
        if across > 0.0 && is_apart { dot(d, d) / (2.0 * across) } else { f64::INFINITY }
    };
    let smallest = points.map(through).fold(f64::INFINITY, f64::min);
    if smallest < (1.0 - SMALLER) * of_curvature { smallest } else { of_curvature }
}

/// The circles up to which the solution continues into holes: of each curved edge that is concave, shrunk by its distance from the
/// rest of the boundary.
fn circles(edges: &[Edge]) -> Vec<([f64; 2], f64)> {
    let mut circles: Vec<([f64; 2], f64)> = Vec::new();
    for edge in edges.iter().filter(|edge| !edge.is_line()) {
        // a circle has one centre, other curves one for each of these places
        let places: &[f64] = if edge.is_arc_length() { &[0.5] } else { &[0.0, 0.25, 0.5, 0.75, 1.0] };
        for &s in places {
            let curvature = edge.curvature(s);
            if curvature >= 0.0 {
                continue;
            }
            let (x, outward) = (edge.point(s), edge.normal(s));
            let radius = touching_radius(edges, edge, s, -curvature.recip());
            let centre = [0, 1].map(|i| x[i] + radius * outward[i]);
            let near = 1e-9 * radius;
            if circles.iter().any(|(c, _)| distance(*c, centre) < near) {
                continue;
            }
            let gap = edges
                .iter()
                .filter(|other| other.loop_index != edge.loop_index)
                .fold(f64::INFINITY, |gap, other| other.nearest(centre, gap).map_or(gap, |(d, _)| d));
            let gap = if gap.is_finite() { (gap - radius).max(0.0) } else { 2.0 * radius };
            circles.push((centre, continued_radius(radius, gap)));
        }
    }
    circles
}
