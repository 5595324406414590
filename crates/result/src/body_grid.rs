//! The bodies filled with triangles, with their fields: for pictures and for viewers of the result file.

use rayon::prelude::*;
use steklov_bem_operators::{Edge, Polygon};
use steklov_io::vtkhdf::{Field, Grid};
use steklov_model::data::body_load::Particulars;
use steklov_model::solve::body::Body;
use steklov_model::solve::fields::ElasticField;
use steklov_model::solve::solution::Solved;
use steklov_model::stochastic::StochasticResult;
use steklov_problem::Scene;

use crate::triangulate::{Triangulation, triangulate};

/// Points of the triangulated body, about.
const BODY_POINTS: usize = 800;
/// Points of the triangulated window around the holes of an unbounded body, about.
const WINDOW_POINTS: usize = 2500;

/// The edges of a window around the holes of an unbounded body, whose edges are given, counter-clockwise: their bounding box and one and a half
/// diameters on each side.
fn frame(polygon: &Polygon, edges: &[usize]) -> Vec<([f64; 2], [f64; 2], usize)> {
    let edges = || edges.iter().map(|&k| &polygon.edges()[k]);
    let margin = 1.5 * polygon.diameter();
    let points: Vec<[f64; 2]> = match polygon.is_curved() {
        true => edges().flat_map(Edge::extent).collect(),
        false => edges().map(|e| e.start).collect(),
    };
    let coordinates = |i: usize| points.iter().map(move |x| x[i]);
    let low = [0, 1].map(|i| coordinates(i).fold(f64::INFINITY, f64::min) - margin);
    let high = [0, 1].map(|i| coordinates(i).fold(f64::NEG_INFINITY, f64::max) + margin);
    let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
    (0..4).map(|k| (corners[k], corners[(k + 1) % 4], 0)).collect()
}

/// A chord of an edge, in the direction of traversal.
pub(crate) struct Chord {
    edge: usize,
    pub(crate) ends: [[f64; 2]; 2],
    /// Edge parameters of its ends.
    span: [f64; 2],
}

/// Chords of a curve are shorter than this part of the diameter, and turn by less than this angle.
const CHORD: f64 = 1.0 / 64.0;
const TURN: f64 = 0.1;

/// The chords that stand for an edge in pictures: a straight one is its own.
pub(crate) fn chords(polygon: &Polygon, edge: usize) -> Vec<Chord> {
    let e = &polygon.edges()[edge];
    let count = match e.is_line() {
        true => 1,
        false => (e.length() / (CHORD * polygon.diameter())).max(e.turning() / TURN).ceil() as usize,
    };
    let s = |i: usize| if e.reversed { 1.0 - i as f64 / count as f64 } else { i as f64 / count as f64 };
    let point = |i: usize| match i {
        0 => e.start,
        i if i == count => e.end,
        i => e.point(s(i)),
    };
    (0..count).map(|i| Chord { edge, ends: [point(i), point(i + 1)], span: [s(i), s(i + 1)] }).collect()
}

/// Points and triangles of a body, of an unbounded one a window; without triangles where its outline cannot be triangulated.
struct Filled {
    body: usize,
    triangulation: Triangulation,
    /// Edge and edge parameter of each point on the boundary.
    places: Vec<Option<(usize, f64)>>,
}

fn filled(polygon: &Polygon, body: usize) -> Filled {
    let loops = polygon.bodies()[body].clone();
    let order: Vec<usize> = loops.clone().flat_map(|l| polygon.traversal(l)).collect();
    let bodies = polygon.bodies().len();
    let (frame, count) = match polygon.is_body_bounded(body) {
        true => (Vec::new(), BODY_POINTS / bodies),
        false => (frame(polygon, &order), WINDOW_POINTS),
    };
    let sides = frame.len();
    // the window is the loop before those of the holes
    let chords: Vec<Chord> = order.iter().flat_map(|&k| chords(polygon, k)).collect();
    let of_loops =
        chords.iter().map(|c| (c.ends[0], c.ends[1], polygon.edges()[c.edge].loop_index - loops.start + sides));
    let edges: Vec<_> = frame.into_iter().chain(of_loops).collect();
    let mut filled = triangulate(&edges, count).unwrap_or_else(|_| Triangulation {
        points: edges.iter().map(|e| e.0).collect(),
        triangles: Vec::new(),
        boundary: (0..edges.len()).map(|k| Some((k, 0.0))).collect(),
        outline: Vec::new(),
    });
    filled.boundary.iter_mut().for_each(|at| *at = at.and_then(|(k, s)| Some((k.checked_sub(sides)?, s))));
    filled.outline.retain(|line| line.iter().all(|&i| filled.boundary[i].is_some()));
    let place = |(k, s): (usize, f64)| {
        let Chord { edge, span: [a, b], .. } = chords[k];
        (edge, a + (b - a) * s)
    };
    let places: Vec<Option<(usize, f64)>> = filled.boundary.iter().map(|at| at.map(place)).collect();
    for (x, at) in filled.points.iter_mut().zip(&places) {
        if let Some((edge, s)) = at.filter(|at| !polygon.edges()[at.0].is_line()) {
            *x = polygon.edges()[edge].point(s);
        }
    }
    Filled { body, triangulation: filled, places }
}

/// The bodies with their fields.
pub(crate) fn body_grid(scene: &Scene, solved: &Solved, outcomes: Option<(&StochasticResult, &Body)>) -> Grid {
    let polygon = &scene.problem.outline;
    let all: Vec<Filled> = (0..polygon.bodies().len()).map(|body| filled(polygon, body)).collect();
    let at_points = |elastic: ElasticField<'_>| -> Vec<([f64; 2], [f64; 3])> {
        let of = |filled: &Filled| {
            let at = |i: usize| match filled.places[i] {
                Some((edge, s)) => elastic.on_edge(edge, s),
                None => elastic.inside(filled.body, filled.triangulation.points[i]),
            };
            (0..filled.places.len()).into_par_iter().map(at).collect::<Vec<_>>()
        };
        all.iter().flat_map(of).collect()
    };
    let of_body: Vec<usize> = all.iter().flat_map(|f| vec![f.body; f.places.len()]).collect();
    let values = at_points(solved.elastic_field());
    let field = |name: &str, unit: &str, components: usize, values: Vec<f64>| Field {
        name: name.into(),
        unit: unit.into(),
        components,
        values,
    };
    let displacements = |values: &[([f64; 2], [f64; 3])]| values.iter().flat_map(|(u, _)| [u[0], u[1], 0.0]).collect();
    let stresses = |values: &[([f64; 2], [f64; 3])]| values.iter().flat_map(|(_, s)| *s).collect();
    let von_mises =
        values.iter().zip(&of_body).map(|((_, s), &body)| scene.problem.bodies[body].material().von_mises(*s));
    let mut point_data = vec![
        field("displacement", "length", 3, displacements(&values)),
        field("stress", "stress", 3, stresses(&values)),
        field("von_mises", "stress", 1, von_mises.collect()),
    ];
    if all.len() > 1 {
        point_data.push(field("body", "1", 1, of_body.iter().map(|&body| body as f64).collect()));
    }
    // the particular solution depends on the outcome: without its mean there are no mean fields
    if let Some((result, matrices)) = outcomes.filter(|_| solved.particular.is_empty()) {
        let mean = |displacement: &[f64]| {
            let field = matrices.field(displacement);
            at_points(ElasticField { mesh: &matrices.mesh, field: &field, particular: &Particulars::default() })
        };
        point_data.push(field("mean_displacement", "length", 3, displacements(&mean(&result.displacement.mean))));
        point_data.push(field("mean_stress", "stress", 3, stresses(&mean(&result.stress_displacement))));
    }
    let (mut points, mut lines, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for Filled { triangulation, .. } in all {
        let first = points.len();
        points.extend(triangulation.points);
        lines.extend(triangulation.outline.into_iter().map(|line| line.map(|i| first + i)));
        triangles.extend(triangulation.triangles.into_iter().map(|triangle| triangle.map(|i| first + i)));
    }
    Grid { point_data, points, lines, triangles, ..Grid::default() }
}
