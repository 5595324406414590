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
    let mut edges = Edges::new(filling, Edges::default());
    for _ in 0..ROUNDS {
        let scale = Scale::new(filling, &values, size);
        let slopes = slopes(filling, &values, &scale);
        let is_tried = |k: &usize| {
            if edges.place[*k].is_some() {
                return edges.length[*k] > size / PIXELS_AT_BOUNDARY;
            }
            let ends = edges.ends[*k];
            // across a ligament the slopes at both ends may be equal
            let doubt = match ends.iter().filter(|&&i| filling.places[i].is_some()).count() {
                0 => DOUBT,
                1 => DOUBT_AT_BOUNDARY,
                _ => 0.0,
            };
            edges.length[*k] > size / PIXELS && scale.expected(filling, &slopes, ends) >= doubt
        };
        let tried: Vec<usize> = (0..edges.ends.len()).filter(is_tried).collect();
        edges.add_middles(filling, polygon, &tried, value);
        let folded = edges.folded(filling);
        let marked = marked(filling, &values, &edges, &folded, &scale);
        if marked.is_empty() {
            break;
        }
        edges.add_middles(filling, polygon, &marked, value);
        split(filling, &mut values, &edges, &folded, &marked);
        edges = Edges::new(filling, edges);
    }
    values
}

/// The edges of the triangles, in rising order of their points.
#[derive(Default)]
struct Edges {
    /// The two points, the smaller number first.
    ends: Vec<[usize; 2]>,
    length: Vec<f64>,
    /// Where the middle of a segment of the outline is on the boundary.
    place: Vec<Option<(usize, f64)>>,
    /// The middles that are known.
    middle: Vec<Option<Middle>>,
    /// The edges of each triangle, edge k after corner k.
    of_triangle: Vec<[usize; 3]>,
    /// The edge of each segment of the outline.
    of_segment: Vec<Option<usize>>,
}

impl Edges {
    /// The edges of the triangles as they are, with the middles that were known before.
    fn new(filling: &Filling, before: Self) -> Self {
        let key = |a: usize, b: usize| [a.min(b), a.max(b)];
        let of =
            |(t, &[a, b, c]): (usize, &[usize; 3])| [(key(a, b), [t, 0]), (key(b, c), [t, 1]), (key(c, a), [t, 2])];
        let mut sides: Vec<([usize; 2], [usize; 2])> = filling.triangles.iter().enumerate().flat_map(of).collect();
        sides.sort_unstable();
        let mut ends: Vec<[usize; 2]> = Vec::with_capacity(sides.len());
        let mut of_triangle = vec![[0; 3]; filling.triangles.len()];
        for (points, [t, k]) in sides {
            if ends.last() != Some(&points) {
                ends.push(points);
            }
            of_triangle[t][k] = ends.len() - 1;
        }
        let find = |s: &Segment| ends.binary_search(&key(s.ends[0], s.ends[1])).ok();
        let of_segment: Vec<Option<usize>> = filling.outline.iter().map(find).collect();
        let mut place = vec![None; ends.len()];
        for (s, k) in filling.outline.iter().zip(&of_segment) {
            k.iter().for_each(|&k| place[k] = Some((s.edge, (s.span[0] + s.span[1]) / 2.0)));
        }
        let mut known = before.ends.iter().zip(before.middle).peekable();
        let middle = ends.iter().map(|points| {
            while known.next_if(|(other, _)| *other < points).is_some() {}
            known.next_if(|(other, _)| *other == points)?.1
        });
        let middle = middle.collect();
        let length = ends.iter().map(|[a, b]| distance(filling.points[*a], filling.points[*b])).collect();
        Self { ends, length, place, middle, of_triangle, of_segment }
    }

    /// Adds the middles of the wanted edges that have none yet.
    fn add_middles(&mut self, filling: &Filling, polygon: &Polygon, wanted: &[usize], value: At<'_>) {
        let middle = |&k: &usize| {
            let [a, b] = self.ends[k].map(|i| filling.points[i]);
            let place = self.place[k];
            let point = match place {
                Some((edge, s)) => polygon.edges()[edge].point(s),
                None => [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0],
            };
            (k, Middle { point, place, value: value(filling.bodies[self.ends[k][0]], point, place) })
        };
        let new: Vec<_> = wanted.par_iter().filter(|&&k| self.middle[k].is_none()).map(middle).collect();
        new.into_iter().for_each(|(k, middle)| self.middle[k] = Some(middle));
    }

    /// The segments of the boundary whose middle lies beyond another side of their triangle, which are not split.
    fn folded(&self, filling: &Filling) -> Vec<bool> {
        let mut folded = vec![false; self.ends.len()];
        for (corners, edges) in filling.triangles.iter().zip(&self.of_triangle) {
            for (k, &edge) in edges.iter().enumerate() {
                let Some(m) = self.middle[edge].as_ref().filter(|m| m.place.is_some()) else { continue };
                let [p, q, r] = [0, 1, 2].map(|i| filling.points[corners[(k + i) % 3]]);
                folded[edge] |=
                    cross(minus(m.point, p), minus(r, p)) <= 0.0 || cross(minus(q, m.point), minus(r, m.point)) <= 0.0;
            }
        }
        folded
    }

    /// Which of the edges of a triangle is the longest one that can be split.
    fn longest(&self, folded: &[bool], triangle: usize) -> Option<usize> {
        let edge = |k: usize| self.of_triangle[triangle][k];
        let open = (0..3).filter(|&k| !folded[edge(k)]);
        open.max_by(|&a, &b| {
            let [a, b] = [a, b].map(edge);
            self.length[a].total_cmp(&self.length[b]).then(a.cmp(&b))
        })
    }
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

/// The edges to split, rising: the worst ones, as many as there is room for, and the edges that keep the triangulation
/// conforming.
fn marked(filling: &Filling, values: &[Value], edges: &Edges, folded: &[bool], scale: &Scale) -> Vec<usize> {
    let error = |k: usize| {
        let middle = edges.middle[k].as_ref().filter(|_| !folded[k])?;
        Some((scale.error(filling, values, edges.ends[k], middle), k)).filter(|wanted| wanted.0 > 1.0)
    };
    let mut wanted: Vec<(f64, usize)> = (0..edges.ends.len()).filter_map(error).collect();
    wanted.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let room = MOST_POINTS.saturating_sub(filling.points.len());
    let mut is_marked = vec![false; edges.ends.len()];
    wanted.iter().take(room).for_each(|w| is_marked[w.1] = true);
    let mut added = room > 0 && !wanted.is_empty();
    while std::mem::take(&mut added) {
        for (t, of_triangle) in edges.of_triangle.iter().enumerate() {
            if !of_triangle.iter().any(|&k| is_marked[k]) {
                continue;
            }
            let longest = edges.longest(folded, t).map(|k| of_triangle[k]);
            if let Some(longest) = longest.filter(|&k| !is_marked[k]) {
                (is_marked[longest], added) = (true, true);
            }
        }
    }
    (0..edges.ends.len()).filter(|&k| is_marked[k]).collect()
}

/// Cuts the triangles at the middles of the marked edges.
fn split(filling: &mut Filling, values: &mut Vec<Value>, edges: &Edges, folded: &[bool], marked: &[usize]) {
    let mut number: Vec<Option<usize>> = vec![None; edges.ends.len()];
    for &k in marked {
        let Some(middle) = &edges.middle[k] else { continue };
        number[k] = Some(filling.points.len());
        filling.bodies.push(filling.bodies[edges.ends[k][0]]);
        filling.points.push(middle.point);
        filling.places.push(middle.place);
        values.push(middle.value);
    }
    let mut triangles = Vec::with_capacity(filling.triangles.len() + 2 * marked.len());
    for (t, (corners, of_triangle)) in filling.triangles.iter().zip(&edges.of_triangle).enumerate() {
        if of_triangle.iter().all(|&k| number[k].is_none()) {
            triangles.push(*corners);
            continue;
        }
        let first = edges.longest(folded, t).unwrap_or(0);
        let [a, b, c] = [0, 1, 2].map(|k| corners[(first + k) % 3]);
        let [ab, bc, ca] = [0, 1, 2].map(|k| number[of_triangle[(first + k) % 3]]);
        let Some(m) = ab else { continue };
        // each half has one other edge of the triangle
        for ([p, q, r], middle) in [([c, a, m], ca), ([b, c, m], bc)] {
            match middle {
                Some(n) => triangles.extend([[p, n, r], [n, q, r]]),
                None => triangles.push([p, q, r]),
            }
        }
    }
    filling.triangles = triangles;
    let halves = |(s, edge): (&Segment, &Option<usize>)| match edge.and_then(|k| number[k]) {
        Some(m) => {
            let middle = (s.span[0] + s.span[1]) / 2.0;
            let [a, b] = [[s.ends[0], m], [m, s.ends[1]]];
            vec![
                Segment { ends: a, span: [s.span[0], middle], ..*s },
                Segment { ends: b, span: [middle, s.span[1]], ..*s },
            ]
        }
        None => vec![*s],
    };
    filling.outline = filling.outline.iter().zip(&edges.of_segment).flat_map(halves).collect();
}
