//! Bodies bounded by loops of lines and curves, with holes or around them: valid by construction.

use std::f64::consts::TAU;
use std::ops::Range;

use steklov_elastic::plane::{cross, minus};

use crate::edge::{Edge, Path};
use crate::polygon_check::{PolygonError, check, check_holes, tolerance};
use crate::predicates::orientation;

/// A closed chain of corners as the user lists it.
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    /// Corner points (length), at least three, or two if one edge is curved.
    pub corners: Vec<[f64; 2]>,
    /// `sides[k]` names the edge from corner k to the next; edges of one name are one side, on any loop.
    pub sides: Vec<String>,
    /// `paths[k]`: how the edge from corner k to the next runs; if empty, all edges are straight.
    pub paths: Vec<Path>,
}

impl Loop {
    /// A loop of straight edges.
    pub fn straight(corners: Vec<[f64; 2]>, sides: Vec<String>) -> Self {
        Self { corners, sides, paths: Vec::new() }
    }

    /// A circle as arcs of equal length, counter-clockwise from the right, all of one side.
    pub fn circle(centre: [f64; 2], radius: f64, arcs: usize, side: &str) -> Self {
        let ellipse = Self::ellipse(centre, [radius, radius], 0.0, arcs, side);
        Self { paths: vec![Path::Arc { opening: TAU / arcs as f64 }; arcs], ..ellipse }
    }

    /// An ellipse as elliptic arcs of equal opening, counter-clockwise from the end of its first half axis, which makes this
    /// angle with the x axis; all of one side.
    pub fn ellipse(centre: [f64; 2], radii: [f64; 2], angle: f64, arcs: usize, side: &str) -> Self {
        let opening = TAU / arcs as f64;
        let (sin, cos) = angle.sin_cos();
        let corner = |k: usize| {
            // the ends of the axes without rounding
            let (y, x) = match 4 * k % arcs {
                0 => [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][4 * k / arcs],
                _ => (opening * k as f64).sin_cos(),
            };
            let (x, y) = (radii[0] * x, radii[1] * y);
            [centre[0] + cos * x - sin * y, centre[1] + sin * x + cos * y]
        };
        let path = |k: usize| Path::Ellipse { radii, angle, start: opening * k as f64, opening };
        Self {
            corners: (0..arcs).map(corner).collect(),
            sides: vec![side.to_owned(); arcs],
            paths: (0..arcs).map(path).collect(),
        }
    }

    /// How the edge from corner k to the next runs.
    pub fn path(&self, k: usize) -> Path {
        self.paths.get(k).copied().unwrap_or_default()
    }
}

/// Where a point lies with respect to the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Location {
    /// In the open body.
    Inside,
    /// On the boundary, to within [`Polygon::tolerance`].
    Boundary {
        /// The nearest edge; at a corner the one with the lower number.
        edge: usize,
        /// Its edge parameter in [0, 1].
        s: f64,
    },
    /// Outside of the outer loop, or in a hole.
    Outside,
}

/// A polygon with holes, or the plane with holes: the closure of a connected open set whose boundary is a set of disjoint
/// simple loops.
///
/// Edges are numbered as listed: the outer loop first, if there is one, then the holes in order. The outer loop is
/// counter-clockwise; holes may be listed in either order and are traversed clockwise, so that the body is always to the
/// left and n points out of it: of an unbounded body into the holes.
///
/// A polygon that [`Polygon::assembly`] makes from several is several bodies, each with its loops; "the body" then means all
/// of them together.
#[derive(Debug, Clone, PartialEq)]
pub struct Polygon {
    edges: Vec<Edge>,
    loops: Vec<Range<usize>>,
    bodies: Vec<Range<usize>>,
    /// Whether each body is bounded.
    bounded: Vec<bool>,
    side_names: Vec<String>,
    area: f64,
    /// The diagonal of the box about each body.
    diagonals: Vec<f64>,
    diameter: f64,
    centroid: [f64; 2],
    tolerance: f64,
}

impl Polygon {
    /// Checks the loops and takes them over.
    ///
    /// Every corner must keep a distance of more than [`Polygon::tolerance`] from every edge that does not end there;
    /// slivers and near contacts above that are valid. Edges are compared in pairs, at a cost of n²/2 bounding boxes.
    ///
    /// # Errors
    /// [`PolygonError`] names the first thing that is wrong, with loop, index and coordinates.
    pub fn new(outer: Loop, holes: Vec<Loop>) -> Result<Polygon, PolygonError> {
        let listed: Vec<Loop> = std::iter::once(outer).chain(holes).collect();
        check(&listed)?;
        Ok(Self::of_valid(listed, true))
    }

    /// The unbounded body that is the plane without the holes: checks them and takes them over.
    ///
    /// The boundary equations of a body to the left of its boundary hold for it too, for fields that decay at infinity, or
    /// grow like a logarithm with a net force: [`crate::Domain::Interior`].
    /// # Errors
    /// [`PolygonError`] as [`Polygon::new`]; holes that meet, or lie in one another. Holes count from 1 in it.
    pub fn outside(holes: Vec<Loop>) -> Result<Polygon, PolygonError> {
        check_holes(&holes)?;
        Ok(Self::of_valid(holes, false))
    }

    fn of_valid(listed: Vec<Loop>, bounded: bool) -> Polygon {
        let (diameter, tolerance) = tolerance(&listed);
        let (mut edges, mut loops, mut side_names) = (Vec::new(), Vec::new(), Vec::<String>::new());
        for (loop_index, listed) in listed.into_iter().enumerate() {
            let first = edges.len();
            let reversed = (loop_index > 0 || !bounded) && area_of(&listed) > 0.0;
            let Loop { corners, sides, paths } = listed;
            for (k, name) in sides.into_iter().enumerate() {
                let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
                let (start, end) = if reversed { (b, a) } else { (a, b) };
                let side = side_names.iter().position(|n| *n == name).unwrap_or_else(|| {
                    side_names.push(name);
                    side_names.len() - 1
                });
                let path = paths.get(k).copied().unwrap_or_default();
                edges.push(Edge { start, end, path, side, loop_index, reversed, drawn: [0.0, 1.0] });
            }
            loops.push(first..edges.len());
        }
        // both area and moments are negative for holes alone: the centroid is that of the holes
        let (area, centroid) = area_and_centroid(&edges);
        let area = if bounded { area } else { f64::INFINITY };
        let bodies = std::iter::once(0..loops.len()).collect();
        let (bounded, diagonals) = (vec![bounded], vec![diagonal(&edges)]);
        Polygon { edges, loops, bodies, bounded, side_names, area, diagonals, diameter, centroid, tolerance }
    }

    /// Replaces the body by the pieces into which it is cut, each with its loops, the outer one first.
    pub(crate) fn in_pieces(&self, pieces: Vec<Vec<Vec<Edge>>>, side_names: Vec<String>) -> Polygon {
        let bounded = vec![true; pieces.len()];
        let (mut edges, mut loops, mut bodies) = (Vec::new(), Vec::new(), Vec::new());
        let mut diagonals = Vec::new();
        for piece in pieces {
            let (first, first_edge) = (loops.len(), edges.len());
            for one in piece {
                let (loop_index, start) = (loops.len(), edges.len());
                edges.extend(one.into_iter().map(|edge| Edge { loop_index, ..edge }));
                loops.push(start..edges.len());
            }
            bodies.push(first..loops.len());
            diagonals.push(diagonal(&edges[first_edge..]));
        }
        Polygon { edges, loops, bodies, bounded, side_names, diagonals, ..self.clone() }
    }

    /// The same with the sides of a body of this name: `NAME.SIDE`.
    pub fn with_body_name(mut self, name: &str) -> Self {
        self.side_names.iter_mut().for_each(|side| *side = format!("{name}.{side}"));
        self
    }

    /// Joins bodies to one polygon: loops, edges and sides one body after the other, sides of equal names kept apart. Overlaps
    /// are not checked: bodies that are pressed together overlap.
    ///
    /// # Panics
    /// Without a body.
    pub fn assembly(bodies: Vec<Polygon>) -> Polygon {
        let mut bodies = bodies.into_iter();
        let mut all = bodies.next().expect("at least one body");
        for body in bodies {
            let (edges, loops, sides) = (all.edges.len(), all.loops.len(), all.side_names.len());
            let moved = |edge: Edge| Edge { side: sides + edge.side, loop_index: loops + edge.loop_index, ..edge };
            all.edges.extend(body.edges.into_iter().map(moved));
            all.loops.extend(body.loops.into_iter().map(|range| edges + range.start..edges + range.end));
            all.bodies.extend(body.bodies.into_iter().map(|range| loops + range.start..loops + range.end));
            all.side_names.extend(body.side_names);
            // an infinite area has no centre: then that of the bounded bodies, or the first one
            let part = match (all.area.is_finite(), body.area.is_finite()) {
                (true, true) => body.area / (all.area + body.area),
                (false, true) => 1.0,
                (_, false) => 0.0,
            };
            all.centroid = [0, 1].map(|i| (1.0 - part) * all.centroid[i] + part * body.centroid[i]);
            all.area += body.area;
            all.bounded.extend(body.bounded);
            all.diagonals.extend(body.diagonals);
            all.diameter = all.diameter.max(body.diameter);
            all.tolerance = all.tolerance.max(body.tolerance);
        }
        all
    }

    /// All edges by number.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// Names of the sides in the order in which they first appear.
    pub fn side_names(&self) -> &[String] {
        &self.side_names
    }

    /// Whether an edge is curved.
    pub fn is_curved(&self) -> bool {
        !self.edges.iter().all(Edge::is_line)
    }

    /// Whether the body has an outer loop; else it is the plane without its holes. For several bodies, whether all have one.
    pub fn is_bounded(&self) -> bool {
        self.bounded.iter().all(|bounded| *bounded)
    }

    /// The same for one of several bodies.
    pub fn is_body_bounded(&self, body: usize) -> bool {
        self.bounded[body]
    }

    /// Edge numbers of each loop, the outer one first if there is one.
    pub fn loops(&self) -> &[Range<usize>] {
        &self.loops
    }

    /// The loops of each body, its outer one first: one body, unless [`Polygon::assembly`] joined several.
    pub fn bodies(&self) -> &[Range<usize>] {
        &self.bodies
    }

    /// The body to which a loop belongs.
    pub fn body_of_loop(&self, loop_index: usize) -> usize {
        self.bodies.iter().position(|loops| loops.contains(&loop_index)).unwrap_or(0)
    }

    /// The first loop of the body of an edge.
    pub fn is_outer(&self, edge: &Edge) -> bool {
        self.bodies.iter().any(|loops| loops.start == edge.loop_index)
    }

    /// Edge numbers of a loop in the order of traversal, each edge starting where the one before it ends; it begins at
    /// the first corner listed.
    pub fn traversal(&self, loop_index: usize) -> Vec<usize> {
        let range = self.loops[loop_index].clone();
        if self.edges[range.start].reversed { range.rev().collect() } else { range.collect() }
    }

    /// The edge that meets another one at its end s = 1 (`rising`) or s = 0, and whether its own parameter rises from there.
    pub fn neighbour(&self, edge: usize, rising: bool) -> (usize, bool) {
        let Edge { loop_index, reversed, .. } = self.edges[edge];
        let forward = rising != reversed;
        let order = self.traversal(loop_index);
        let count = order.len();
        let at = order.iter().position(|&k| k == edge).unwrap_or(0);
        let next = order[if forward { at + 1 } else { at + count - 1 } % count];
        (next, forward != self.edges[next].reversed)
    }

    /// Area of the body, holes excluded; infinite if it is unbounded.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Largest distance between two points of the boundary, which for a bounded body is also that between two of its points.
    pub fn diameter(&self) -> f64 {
        self.diameter
    }

    /// The diagonal of the box about the boundary of one of the bodies, with sides along the axes.
    pub fn diagonal_of_body(&self, body: usize) -> f64 {
        self.diagonals[body]
    }

    /// Centre of mass of the body, which may lie outside of it if there are holes or notches; for an unbounded body that of
    /// all its holes together.
    pub fn centroid(&self) -> [f64; 2] {
        self.centroid
    }

    /// The same for one of several bodies.
    pub fn centroid_of_body(&self, body: usize) -> [f64; 2] {
        let loops = &self.bodies[body];
        let edges = self.loops[loops.start].start..self.loops[loops.end - 1].end;
        area_and_centroid(&self.edges[edges]).1
    }

    /// Distance below which points count as equal: 1e-12 diameters, or four roundings of the largest coordinate if the
    /// body lies so far from the origin that this is more.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Where x lies: on the boundary if an edge is within [`Polygon::tolerance`], else by the winding number, whose
    /// orientation tests are exact. A point that is not finite is outside.
    ///
    /// Source: Shewchuk (1997) for the orientation tests.
    pub fn contains(&self, x: [f64; 2]) -> Location {
        match self.nearest_edge(0..self.edges.len(), x) {
            Some((edge, s)) => Location::Boundary { edge, s },
            None if self.body_at(x).is_some() => Location::Inside,
            None => Location::Outside,
        }
    }

    /// Where x lies with respect to one of the bodies alone.
    pub fn location_in(&self, body: usize, x: [f64; 2]) -> Location {
        let loops = &self.bodies[body];
        match self.nearest_edge(self.loops[loops.start].start..self.loops[loops.end - 1].end, x) {
            Some((edge, s)) => Location::Boundary { edge, s },
            None if self.is_in_body(body, x) => Location::Inside,
            None => Location::Outside,
        }
    }

    /// Whether a point that is in no body lies around the first one, and not in one of its holes.
    pub fn is_around(&self, x: [f64; 2]) -> bool {
        x.iter().all(|c| c.is_finite()) && winding(self.edges[self.loops[0].clone()].iter(), x) == 0
    }

    /// The nearest of some edges within [`Polygon::tolerance`] and its parameter; of equally near ones the first.
    fn nearest_edge(&self, edges: Range<usize>, x: [f64; 2]) -> Option<(usize, f64)> {
        let (mut nearest, mut on) = (self.tolerance, None);
        for k in edges {
            if let Some((gap, s)) = self.edges[k].nearest(x, nearest)
                && (gap < nearest || (gap == nearest && on.is_none()))
            {
                (nearest, on) = (gap, Some((k, s)));
            }
        }
        on
    }

    /// The first body that a point lies in, not on its boundary.
    pub fn body_at(&self, x: [f64; 2]) -> Option<usize> {
        (0..self.bodies.len()).find(|&body| self.is_in_body(body, x))
    }

    /// Whether a point that is not on its boundary lies in a body.
    pub fn is_in_body(&self, body: usize, x: [f64; 2]) -> bool {
        let edges = self.bodies[body].clone().flat_map(|l| &self.edges[self.loops[l].clone()]);
        // holes are traversed clockwise: -1 in one of them
        x.iter().all(|c| c.is_finite()) && winding(edges, x) == i32::from(self.bounded[body])
    }
}

/// How often edges turn around a point that lies on none of them, counter-clockwise.
pub(crate) fn winding<'a>(edges: impl Iterator<Item = &'a Edge>, x: [f64; 2]) -> i32 {
    let of = |edge: &Edge| {
        let (start, end) = (edge.start, edge.end);
        if !edge.is_line() {
            edge.crossings(x)
        } else if start[1] <= x[1] && end[1] > x[1] && orientation(start, end, x) > 0.0 {
            1
        } else if start[1] > x[1] && end[1] <= x[1] && orientation(start, end, x) < 0.0 {
            -1
        } else {
            0
        }
    };
    edges.map(of).sum()
}

/// Area of a closed chain of corners, positive when it is counter-clockwise.
pub(crate) fn signed_area(corners: &[[f64; 2]]) -> f64 {
    let o = corners[0];
    corners.windows(2).map(|w| cross(minus(w[0], o), minus(w[1], o))).sum::<f64>() / 2.0
}

/// Signed area of a loop.
pub(crate) fn area_of(listed: &Loop) -> f64 {
    let straight = signed_area(&listed.corners);
    let edges = listed_edges(listed);
    if edges.iter().all(Edge::is_line) {
        return straight;
    }
    straight + edges.iter().map(|edge| edge.twice_segment() / 2.0).sum::<f64>()
}

/// The edges of a loop in the order of listing.
pub(crate) fn listed_edges(listed: &Loop) -> Vec<Edge> {
    let corners = &listed.corners;
    let edge = |k: usize| {
        let (start, end) = (corners[k], corners[(k + 1) % corners.len()]);
        Edge { start, end, path: listed.path(k), side: k, loop_index: 0, reversed: false, drawn: [0.0, 1.0] }
    };
    (0..corners.len()).map(edge).collect()
}

/// The diagonal of the box about some edges.
fn diagonal(edges: &[Edge]) -> f64 {
    let points: Vec<[f64; 2]> = edges.iter().flat_map(Edge::extent).collect();
    let width = |i: usize| {
        let of = points.iter().map(|x| x[i]);
        of.clone().fold(f64::NEG_INFINITY, f64::max) - of.fold(f64::INFINITY, f64::min)
    };
    width(0).hypot(width(1))
}

/// Area and centre of mass as sums over the triangles that the edges span with one corner.
fn area_and_centroid(edges: &[Edge]) -> (f64, [f64; 2]) {
    let o = edges[0].start;
    let (mut twice, mut first) = (0.0, [0.0; 2]);
    for Edge { start, end, .. } in edges {
        let (a, b) = (minus(*start, o), minus(*end, o));
        let cross = cross(a, b);
        twice += cross;
        first = [first[0] + cross * (a[0] + b[0]), first[1] + cross * (a[1] + b[1])];
    }
    for [more, x, y] in edges.iter().map(|edge| edge.bulge(o)) {
        twice += more;
        first = [first[0] + 6.0 * x, first[1] + 6.0 * y];
    }
    (twice / 2.0, [o[0] + first[0] / (3.0 * twice), o[1] + first[1] / (3.0 * twice)])
}
