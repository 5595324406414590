//! The bodies filled with triangles, with their fields: for pictures and for viewers of the result file.

use rayon::prelude::*;
use steklov_bem_operators::{Edge, Polygon};
use steklov_model::data::body_load::Particulars;
use steklov_model::run::adaptive_loop::Run;
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::solve::fields::ElasticField;
use steklov_model::stochastic::StochasticResult;
use steklov_problem::Scene;
use steklov_unstructured::{Field, Grid};

use crate::follow::{Filling, Segment, Value, follow};
use crate::triangulate::{Triangulation, triangulate};

/// Approximate number of points of all bodies before triangles follow the solution.
const BODY_POINTS: usize = 400;
/// Approximate number of points of the window around the holes of an unbounded body before triangles follow the
/// solution.
const WINDOW_POINTS: usize = 800;

/// The edges, counter-clockwise, of a window around the holes of an unbounded body with the given edges: their bounding
/// box, one and a half diameters larger on each side.
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

/// The chords that replace an edge in pictures; a straight edge is its own chord.
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

/// Adds the points and triangles of a body, for an unbounded body those of a window. There are no triangles if the
/// outline cannot be triangulated.
fn fill(filling: &mut Filling, polygon: &Polygon, body: usize) {
    let loops = polygon.bodies()[body].clone();
    let order: Vec<usize> = loops.clone().flat_map(|l| polygon.traversal(l)).collect();
    let bodies = polygon.bodies().len();
    let (frame, count) = match polygon.is_body_bounded(body) {
        true => (Vec::new(), BODY_POINTS / bodies),
        false => (frame(polygon, &order), WINDOW_POINTS),
    };
    let sides = frame.len();
    // the loop of the window comes before the loops of the holes
    let chords: Vec<Chord> = order.iter().flat_map(|&k| chords(polygon, k)).collect();
    let of_loops =
        chords.iter().map(|c| (c.ends[0], c.ends[1], polygon.edges()[c.edge].loop_index - loops.start + sides));
    let edges: Vec<_> = frame.into_iter().chain(of_loops).collect();
    let filled = triangulate(&edges, count).unwrap_or_else(|_| Triangulation {
        points: edges.iter().map(|e| e.0).collect(),
        triangles: Vec::new(),
        boundary: (0..edges.len()).map(|k| Some((k, 0.0))).collect(),
        outline: Vec::new(),
    });
    let place = |at: &Option<(usize, f64)>| {
        let (k, s) = (*at)?;
        let Chord { edge, span: [a, b], .. } = chords[k.checked_sub(sides)?];
        Some((edge, a + (b - a) * s))
    };
    let places: Vec<Option<(usize, f64)>> = filled.boundary.iter().map(place).collect();
    let first = filling.points.len();
    for (point, place) in filled.points.iter().zip(&places) {
        let curved = place.filter(|at| !polygon.edges()[at.0].is_line());
        filling.points.push(curved.map_or(*point, |(edge, s)| polygon.edges()[edge].point(s)));
    }
    for [i, j] in filled.outline {
        let (Some((edge, a)), Some((other, b))) = (places[i], places[j]) else { continue };
        // the end of an edge is the start of the next one
        let last = if polygon.edges()[edge].reversed { 0.0 } else { 1.0 };
        let end = if edge == other && (b - a) * (last - a) > 0.0 { b } else { last };
        filling.outline.push(Segment { ends: [first + i, first + j], edge, span: [a, end] });
    }
    filling.triangles.extend(filled.triangles.iter().map(|t| t.map(|i| first + i)));
    filling.bodies.extend(places.iter().map(|_| body));
    filling.places.extend(places);
}

/// The bodies filled with triangles that follow their fields, and the fields of the mean of random input where the run has kept its
/// matrices.
pub fn bodies(scene: &Scene, run: &Run<BoundaryElements>, outcomes: Option<&StochasticResult>) -> Grid {
    let (solved, outcomes) = (&run.last, outcomes.zip(run.matrices.as_ref()));
    let polygon = &scene.problem.outline;
    let mut filling = Filling::default();
    (0..polygon.bodies().len()).for_each(|body| fill(&mut filling, polygon, body));
    let at = |elastic: ElasticField<'_>, body: usize, x: [f64; 2], place: Option<(usize, f64)>| match place {
        Some((edge, s)) => elastic.on_edge(edge, s),
        None => elastic.inside(body, x),
    };
    let von_mises = |body: usize, stress: [f64; 3]| scene.problem.bodies[body].material().von_mises(stress);
    let elastic = solved.elastic_field();
    let values = follow(&mut filling, polygon, &|body, x, place| {
        let (displacement, stress) = at(elastic, body, x, place);
        Value { displacement, stress, von_mises: von_mises(body, stress) }
    });
    let field = |name: &str, unit: &str, components: usize, values: Vec<f64>| Field {
        name: name.into(),
        unit: unit.into(),
        components,
        values,
    };
    let mut point_data = vec![
        field("displacement", "length", 3, values.iter().flat_map(|v| in_space(v.displacement)).collect()),
        field("stress", "stress", 3, values.iter().flat_map(|v| v.stress).collect()),
        field("von_mises", "stress", 1, values.iter().map(|v| v.von_mises).collect()),
    ];
    if polygon.bodies().len() > 1 {
        point_data.push(field("body", "1", 1, filling.bodies.iter().map(|&body| body as f64).collect()));
    }
    // the particular solution depends on the outcome: without its mean there are no mean fields
    if let Some((result, matrices)) = outcomes.filter(|_| solved.particular.is_empty()) {
        let mean = |displacement: &[f64]| -> Vec<([f64; 2], [f64; 3])> {
            let field = matrices.field(displacement);
            let elastic = ElasticField { mesh: &matrices.mesh, field: &field, particular: &Particulars::default() };
            let value = |i: usize| at(elastic, filling.bodies[i], filling.points[i], filling.places[i]);
            (0..filling.points.len()).into_par_iter().map(value).collect()
        };
        let displacement = mean(&result.displacement.mean).iter().flat_map(|(u, _)| in_space(*u)).collect();
        let stress = mean(&result.stress_displacement).iter().flat_map(|(_, s)| *s).collect();
        point_data.push(field("mean_displacement", "length", 3, displacement));
        point_data.push(field("mean_stress", "stress", 3, stress));
    }
    let is_boundary = |line: &&Segment| !scene.problem.is_whole_across(polygon.edges()[line.edge].side);
    let lines = filling.outline.iter().filter(is_boundary).map(|line| line.ends).collect();
    Grid { point_data, points: filling.points, lines, triangles: filling.triangles, ..Grid::default() }
}

fn in_space(u: [f64; 2]) -> [f64; 3] {
    [u[0], u[1], 0.0]
}
