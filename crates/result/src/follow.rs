//! Triangles that follow a field: split until linear interpolation is right to half a step of the colours.
//!
//! The field is evaluated once at the middle of an edge; the middle of a segment of the boundary is on the true
//! boundary. All edges on the boundary are tried, because evaluation is cheap there, and those edges inside at which
//! the surrounding values predict an error. An edge is marked if the value at its middle differs from the mean of its
//! ends by more than 0.3 steps; a step is a band of the colours for von Mises stress, and the same part of the largest
//! displacement. A segment of the outline is also marked if its middle is off by more than a quarter of a pixel, or the
//! displacement of its middle, as drawn, by more than a fiftieth of a pixel: the faces of a crack may be only some
//! pixels apart. The longest edge of a triangle with a marked edge is marked too. Triangles are cut at the middles of
//! their marked edges, first at the middle of the longest one, so that angles do not degenerate.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;
use steklov_bem_operators::Polygon;
use steklov_elastic::plane::{cross, distance, dot, minus, norm};
use steklov_picture::{BANDS, colour_interval, exaggeration, limited};

/// Allowed error at the middle of an edge in steps; a quadratic error is at most 4/3 as large elsewhere in a triangle.
const STEPS: f64 = 0.3;

/// Pixels of a picture along the longer side of the bodies. Edges shorter than a pixel inside are not split, and edges
/// shorter than 1/128 of a pixel on the boundary, because the opening of a crack grows like a root.
const PIXELS: f64 = 1200.0;
const PIXELS_AT_BOUNDARY: f64 = 128.0 * PIXELS;

/// Allowed distance of the outline from its segment, in pixels, and allowed difference of their displacements as drawn.
const OFF: f64 = 0.25;
const MOVED_OFF: f64 = 0.02;

/// Number of points of all bodies above which no edge is split; the last round may add more to stay conforming.
const MOST_POINTS: usize = 8000;

/// An edge inside is tried if the surrounding values predict at least this part of the allowed error; slopes at the
/// boundary, known from one side, are less reliable.
const DOUBT: f64 = 0.4;
const DOUBT_AT_BOUNDARY: f64 = 0.3;

/// Largest number of rounds; each halves the longest marked edges.
const ROUNDS: usize = 24;

/// The field at a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Value {
    pub(crate) displacement: [f64; 2],
    pub(crate) stress: [f64; 3],
    pub(crate) von_mises: f64,
}

/// A segment of the outline: points, edge of the polygon and edge parameters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Segment {
    pub(crate) ends: [usize; 2],
    pub(crate) edge: usize,
    pub(crate) span: [f64; 2],
}

/// Triangles of all bodies; each point belongs to one body.
#[derive(Debug, Clone, Default)]
pub(crate) struct Filling {
    pub(crate) points: Vec<[f64; 2]>,
    pub(crate) bodies: Vec<usize>,
    /// Edge of the polygon and edge parameter of points on the boundary.
    pub(crate) places: Vec<Option<(usize, f64)>>,
    /// Counter-clockwise.
    pub(crate) triangles: Vec<[usize; 3]>,
    /// Segments of the boundary in traversal order.
    pub(crate) outline: Vec<Segment>,
}

/// The middle of an edge.
#[derive(Debug, Clone, Copy)]
struct Middle {
    point: [f64; 2],
    place: Option<(usize, f64)>,
    value: Value,
}

type Middles = HashMap<[usize; 2], Middle>;

fn key(a: usize, b: usize) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

/// The three edges of a triangle, edge k after corner k.
fn edges([a, b, c]: [usize; 3]) -> [[usize; 2]; 3] {
    [key(a, b), key(b, c), key(c, a)]
}

type At<'a> = &'a (dyn Fn(usize, [f64; 2], Option<(usize, f64)>) -> Value + Sync);

/// Splits the triangles until they follow the field, which is evaluated once at each point (body, point, place on the
/// boundary). Returns the values at the points.
pub(crate) fn follow(filling: &mut Filling, polygon: &Polygon, value: At<'_>) -> Vec<Value> {
    let at = |i: usize| value(filling.bodies[i], filling.points[i], filling.places[i]);
    let mut values: Vec<Value> = (0..filling.points.len()).into_par_iter().map(at).collect();
    let extent = |i: usize| {
        let along = || filling.points.iter().map(|p| p[i]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    let size = extent(0).max(extent(1));
    let mut middles = Middles::new();
    for _ in 0..ROUNDS {
        let scale = Scale::new(filling, &values, size);
        let mut tried: Vec<[usize; 2]> = filling.triangles.iter().flat_map(|&t| edges(t)).collect();
        tried.sort_unstable();
        tried.dedup();
        let slopes = slopes(filling, &values, &scale);
        let on_boundary: HashSet<[usize; 2]> = filling.outline.iter().map(|s| key(s.ends[0], s.ends[1])).collect();
        tried.retain(|e| {
            let length = distance(filling.points[e[0]], filling.points[e[1]]);
            if on_boundary.contains(e) {
                return length > size / PIXELS_AT_BOUNDARY;
            }
            // across a ligament the slopes at both ends may be equal
            let doubt = match e.iter().filter(|&&i| filling.places[i].is_some()).count() {
                0 => DOUBT,
                1 => DOUBT_AT_BOUNDARY,
                _ => 0.0,
            };
            length > size / PIXELS && scale.expected(filling, &slopes, *e) >= doubt
        });
        add_middles(filling, polygon, &tried, &mut middles, value);
        let folded = folded(filling, &middles);
        let marked = marked(filling, &values, &middles, &folded, &scale);
        if marked.is_empty() {
            break;
        }
        add_middles(filling, polygon, &marked, &mut middles, value);
        split(filling, &mut values, &middles, &folded, &marked);
    }
    values
}

/// Adds the middles of the wanted edges that have none yet.
fn add_middles(filling: &Filling, polygon: &Polygon, wanted: &[[usize; 2]], middles: &mut Middles, value: At<'_>) {
    let places: HashMap<[usize; 2], (usize, f64)> =
        filling.outline.iter().map(|s| (key(s.ends[0], s.ends[1]), (s.edge, (s.span[0] + s.span[1]) / 2.0))).collect();
    let middle = |e: &[usize; 2]| {
        let (a, b) = (filling.points[e[0]], filling.points[e[1]]);
        let place = places.get(e).copied();
        let point = match place {
            Some((edge, s)) => polygon.edges()[edge].point(s),
            None => [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0],
        };
        (*e, Middle { point, place, value: value(filling.bodies[e[0]], point, place) })
    };
    let new: Vec<_> = wanted.par_iter().filter(|e| !middles.contains_key(*e)).map(middle).collect();
    middles.extend(new);
}

/// The segments of the boundary whose middle lies beyond another side of their triangle, which are not split.
fn folded(filling: &Filling, middles: &Middles) -> HashSet<[usize; 2]> {
    let mut folded = HashSet::new();
    for &[a, b, c] in &filling.triangles {
        for [a, b, c] in [[a, b, c], [b, c, a], [c, a, b]] {
            let Some(m) = middles.get(&key(a, b)).filter(|m| m.place.is_some()) else { continue };
            let [p, q, r] = [a, b, c].map(|i| filling.points[i]);
            if cross(minus(m.point, p), minus(r, p)) <= 0.0 || cross(minus(q, m.point), minus(r, m.point)) <= 0.0 {
                folded.insert(key(a, b));
            }
        }
    }
    folded
}

/// The allowed errors.
struct Scale {
    /// Ends of the colours, and the allowed error of the stress.
    colours: [f64; 2],
    stress: f64,
    displacement: f64,
    pixel: f64,
    /// The factor at which displacements are drawn.
    factor: f64,
}

impl Scale {
    fn new(filling: &Filling, values: &[Value], size: f64) -> Self {
        let von_mises: Vec<f64> = values.iter().map(|v| v.von_mises).collect();
        let colours = colour_interval(&filling.points, &filling.triangles, &von_mises);
        let largest = values.iter().map(|v| norm(v.displacement)).filter(|u| u.is_finite()).fold(0.0, f64::max);
        Self {
            colours,
            stress: STEPS * (colours[1] - colours[0]) / BANDS as f64,
            displacement: STEPS * largest / BANDS as f64,
            pixel: size / PIXELS,
            factor: exaggeration(largest / size, f64::INFINITY),
        }
    }

    /// The error at the middle of an edge over the allowed error.
    fn error(&self, filling: &Filling, values: &[Value], e: [usize; 2], m: &Middle) -> f64 {
        let [low, high] = self.colours;
        let [a, b] = e.map(|i| &values[i]);
        let [va, vb, vm] = [a, b, &m.value].map(|v| limited(v.von_mises, self.colours));
        let stress = (vm.clamp(low, high) - ((va + vb) / 2.0).clamp(low, high)).abs() / self.stress;
        let u = [0, 1].map(|i| m.value.displacement[i] - (a.displacement[i] + b.displacement[i]) / 2.0);
        let outline = m.place.map_or(0.0, |_| {
            let x = [0, 1].map(|i| m.point[i] - (filling.points[e[0]][i] + filling.points[e[1]][i]) / 2.0);
            (norm(x) / OFF).max(self.factor * norm(u) / MOVED_OFF) / self.pixel
        });
        [stress, norm(u) / self.displacement, outline].into_iter().filter(|e| e.is_finite()).fold(0.0, f64::max)
    }

    /// The error at the middle of an edge, over the allowed error, of a cubic polynomial with the slopes at its ends.
    fn expected(&self, filling: &Filling, slopes: &[[f64; 2]], [a, b]: [usize; 2]) -> f64 {
        let along = minus(filling.points[b], filling.points[a]);
        dot(minus(slopes[b], slopes[a]), along).abs() / 8.0 / self.stress
    }
}

/// Slopes of von Mises stress at the points: the mean over the triangles around them, weighted by area.
fn slopes(filling: &Filling, values: &[Value], scale: &Scale) -> Vec<[f64; 2]> {
    let mut sums = vec![([0.0; 2], 0.0); filling.points.len()];
    for t in &filling.triangles {
        let [a, b, c] = t.map(|i| filling.points[i]);
        let [va, vb, vc] = t.map(|i| limited(values[i].von_mises, scale.colours));
        let (p, q) = (minus(b, a), minus(c, a));
        // the slope times twice the area
        let slope = [(vb - va) * q[1] - (vc - va) * p[1], (vc - va) * p[0] - (vb - va) * q[0]];
        for &i in t {
            sums[i].0 = [sums[i].0[0] + slope[0], sums[i].0[1] + slope[1]];
            sums[i].1 += cross(p, q);
        }
    }
    sums.iter().map(|(slope, area)| slope.map(|s| s / area)).collect()
}

/// The edges to split: the worst ones, as many as there is room for, and the edges that keep the triangulation
/// conforming.
fn marked(
    filling: &Filling,
    values: &[Value],
    middles: &Middles,
    folded: &HashSet<[usize; 2]>,
    scale: &Scale,
) -> Vec<[usize; 2]> {
    let mut wanted: Vec<(f64, [usize; 2])> = Vec::new();
    for e in filling.triangles.iter().flat_map(|&t| edges(t)) {
        let middle = middles.get(&e).filter(|_| !folded.contains(&e));
        if let Some(error) = middle.map(|m| scale.error(filling, values, e, m)).filter(|&error| error > 1.0) {
            wanted.push((error, e));
        }
    }
    wanted.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    wanted.dedup();
    let room = MOST_POINTS.saturating_sub(filling.points.len());
    let mut marked: Vec<[usize; 2]> = wanted.iter().map(|w| w.1).take(room).collect();
    marked.sort_unstable();
    let mut added = true;
    while added && !marked.is_empty() {
        let more: Vec<[usize; 2]> = filling
            .triangles
            .iter()
            .filter(|&&t| edges(t).iter().any(|e| marked.binary_search(e).is_ok()))
            .filter_map(|&t| longest(filling, folded, t))
            .filter(|e| marked.binary_search(e).is_err())
            .collect();
        added = !more.is_empty();
        marked.extend(more);
        marked.sort_unstable();
        marked.dedup();
    }
    marked
}

/// The longest edge of a triangle that can be split.
fn longest(filling: &Filling, folded: &HashSet<[usize; 2]>, triangle: [usize; 3]) -> Option<[usize; 2]> {
    let length = |e: &[usize; 2]| distance(filling.points[e[0]], filling.points[e[1]]);
    let open = edges(triangle).into_iter().filter(|e| !folded.contains(e));
    open.max_by(|a, b| length(a).total_cmp(&length(b)).then(a.cmp(b)))
}

/// Cuts the triangles at the middles of the marked edges, which are sorted.
fn split(
    filling: &mut Filling,
    values: &mut Vec<Value>,
    middles: &Middles,
    folded: &HashSet<[usize; 2]>,
    marked: &[[usize; 2]],
) {
    let mut number: HashMap<[usize; 2], usize> = HashMap::new();
    for &e in marked {
        let middle = &middles[&e];
        number.insert(e, filling.points.len());
        filling.bodies.push(filling.bodies[e[0]]);
        filling.points.push(middle.point);
        filling.places.push(middle.place);
        values.push(middle.value);
    }
    let mut triangles = Vec::with_capacity(filling.triangles.len() + 2 * marked.len());
    for &t in &filling.triangles {
        if !edges(t).iter().any(|e| number.contains_key(e)) {
            triangles.push(t);
            continue;
        }
        let first = longest(filling, folded, t).and_then(|e| edges(t).iter().position(|other| *other == e));
        let [a, b, c] = [0, 1, 2].map(|k| t[(first.unwrap_or(0) + k) % 3]);
        let Some(&m) = number.get(&key(a, b)) else { continue };
        // each half has one other edge of the triangle
        for [p, q, r] in [[c, a, m], [b, c, m]] {
            match number.get(&key(p, q)) {
                Some(&n) => triangles.extend([[p, n, r], [n, q, r]]),
                None => triangles.push([p, q, r]),
            }
        }
    }
    filling.triangles = triangles;
    let halves = |s: &Segment| match number.get(&key(s.ends[0], s.ends[1])) {
        Some(&m) => {
            let middle = (s.span[0] + s.span[1]) / 2.0;
            let [a, b] = [[s.ends[0], m], [m, s.ends[1]]];
            vec![
                Segment { ends: a, span: [s.span[0], middle], ..*s },
                Segment { ends: b, span: [middle, s.span[1]], ..*s },
            ]
        }
        None => vec![*s],
    };
    filling.outline = filling.outline.iter().flat_map(halves).collect();
}
