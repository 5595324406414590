//! hp meshes of the boundary: elements on lines and curves, each with a polynomial degree.

use std::collections::HashMap;
use std::ops::Range;

use num_complex::Complex64;
use steklov_elastic::plane::{distance, minus, norm, unit};
use steklov_quadrature::gauss_legendre;

use crate::BemError;
use crate::curve::{Curve, Shape};
use crate::moments::Segment;
use crate::predicates::diameter_of;

/// Elements of all loops in the order of the polygon's edges, each loop traversed with the body to the left.
///
/// Element e runs from `vertices[e]` to `vertices[next[e]]`; vertex and element numbers coincide.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Start point of each element.
    pub vertices: Vec<[f64; 2]>,
    /// Element that follows e on its loop.
    pub next: Vec<usize>,
    /// Polynomial degree p ≥ 1 of the displacement on each element; the traction has degree p-1.
    pub degree: Vec<usize>,
    /// Polygon edge on which each element lies.
    pub edge: Vec<usize>,
    /// How each element runs from its start to its end.
    pub shape: Vec<Shape>,
    /// Unit tangent in the middle of each element in the direction of traversal; for a straight element that of its edge, see
    /// [`edge_tangents`].
    pub heading: Vec<[f64; 2]>,
    /// Side (an index into [`Mesh::side_names`]) to which that edge belongs.
    pub side: Vec<usize>,
    /// Edge parameter `[s_start, s_end]` of each element, in the direction in which the corners were listed:
    /// rising in traversal order, or falling on a hole that was listed the other way round.
    pub span: Vec<[f64; 2]>,
    /// Fractions of the drawn edge's length at the ends of each element: the span on whole lines and circular arcs.
    pub arc: Vec<[f64; 2]>,
    /// Names of the sides.
    pub side_names: Vec<String>,
}

impl Mesh {
    /// The side of elements of cuts, which are on none.
    pub const NO_SIDE: usize = usize::MAX;

    /// The elements of whole loops as a mesh of their own, in their order; edges and sides keep their numbers.
    ///
    /// # Panics
    /// If an element outside of the range follows one inside.
    pub fn part(&self, elements: Range<usize>) -> Self {
        let inside = |&e: &usize| e.checked_sub(elements.start).expect("loops that are not cut");
        Self {
            vertices: self.vertices[elements.clone()].to_vec(),
            next: self.next[elements.clone()].iter().map(inside).collect(),
            degree: self.degree[elements.clone()].to_vec(),
            edge: self.edge[elements.clone()].to_vec(),
            shape: self.shape[elements.clone()].to_vec(),
            heading: self.heading[elements.clone()].to_vec(),
            side: self.side[elements.clone()].to_vec(),
            span: self.span[elements.clone()].to_vec(),
            arc: self.arc[elements.clone()].to_vec(),
            side_names: self.side_names.clone(),
        }
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.vertices.len()
    }

    /// Whether there is no element.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Start and end point of element e.
    pub fn ends(&self, e: usize) -> [[f64; 2]; 2] {
        [self.vertices[e], self.vertices[self.next[e]]]
    }

    /// Element e as a curve.
    pub fn curve(&self, e: usize) -> Curve {
        Curve::new(self.segment(e), &self.shape[e])
    }

    /// Whether element e is straight.
    pub fn is_line(&self, e: usize) -> bool {
        self.shape[e] == Shape::Line
    }

    /// Half the vector from start to end, d; y(t) = c + d t on t ∈ [-1, 1] if the element is straight.
    pub fn half_chord(&self, e: usize) -> [f64; 2] {
        let [a, b] = self.ends(e);
        [(b[0] - a[0]) / 2.0, (b[1] - a[1]) / 2.0]
    }

    /// Length h of element e.
    pub fn length(&self, e: usize) -> f64 {
        if !self.is_line(e) {
            return 2.0 * self.curve(e).half_length();
        }
        2.0 * norm(self.half_chord(e))
    }

    /// |dy/dt| at the reference point t of element e: half of its length, except on polynomial curves.
    pub fn speed(&self, e: usize, t: f64) -> f64 {
        match self.shape[e] {
            Shape::Polynomial(_) => self.curve(e).derivative(t).norm(),
            _ => self.length(e) / 2.0,
        }
    }

    /// Distance on the reference element of e below which points are one: the rounding of their coordinates.
    pub fn resolution(&self, e: usize) -> f64 {
        let [x, y] = self.vertices[e];
        (4e-15 * (x.abs() + y.abs()) / self.length(e)).clamp(1e-12, 1e-3)
    }

    /// Unit tangent at the reference point t of element e, in the direction of traversal.
    pub fn tangent(&self, e: usize, t: f64) -> [f64; 2] {
        let heading = self.heading[e];
        if self.is_line(e) {
            return heading;
        }
        let turn = self.shape[e].turn(t);
        let turned = Complex64::new(heading[0], heading[1]) * turn / turn.norm();
        [turned.re, turned.im]
    }

    /// Unit normal at the reference point t of element e, pointing out of the body: the tangent turned by -90°.
    pub fn normal(&self, e: usize, t: f64) -> [f64; 2] {
        let t = self.tangent(e, t);
        [t[1], -t[0]]
    }

    /// Point y(t) of element e, t ∈ [-1, 1], measured from the nearer end so that both ends are met exactly.
    pub fn point(&self, e: usize, t: f64) -> [f64; 2] {
        if !self.is_line(e) {
            let y = self.curve(e).point(t);
            return [y.re, y.im];
        }
        let ([a, b], d) = (self.ends(e), self.half_chord(e));
        if t <= 0.0 {
            [a[0] + d[0] * (1.0 + t), a[1] + d[1] * (1.0 + t)]
        } else {
            [b[0] - d[0] * (1.0 - t), b[1] - d[1] * (1.0 - t)]
        }
    }

    /// Edge parameter s ∈ [0, 1] at the reference point t of element e.
    pub fn edge_parameter(&self, e: usize, t: f64) -> f64 {
        let [a, b] = self.span[e];
        if t <= 0.0 { a + (b - a) * (1.0 + t) / 2.0 } else { b - (b - a) * (1.0 - t) / 2.0 }
    }

    /// Fraction of the drawn edge's length up to the reference point t of element e.
    pub fn arc_fraction(&self, e: usize, t: f64) -> f64 {
        let [a, b] = self.arc[e];
        let Shape::Polynomial(_) = self.shape[e] else {
            let linear = |[a, b]: [f64; 2]| {
                if t <= 0.0 { a + (b - a) * (1.0 + t) / 2.0 } else { b - (b - a) * (1.0 - t) / 2.0 }
            };
            return linear([a, b]);
        };
        let curve = self.curve(e);
        if t <= -1.0 {
            return a;
        }
        if t >= 1.0 {
            return b;
        }
        let before = gauss_legendre(32).mapped(-1.0, t).integrate(|t| curve.derivative(t).norm());
        a + (b - a) * before / (2.0 * curve.half_length())
    }

    /// Element that precedes each element on its loop.
    pub fn previous(&self) -> Vec<usize> {
        let mut previous = vec![0; self.len()];
        for (e, &n) in self.next.iter().enumerate() {
            previous[n] = e;
        }
        previous
    }

    /// Largest distance between two vertices, which are corners, or points of curves: the default length in log(L/r).
    pub fn diameter(&self) -> f64 {
        let ends = self.next.iter().enumerate().filter(|&(e, &next)| self.edge[e] != self.edge[next]);
        let mut corners: Vec<[f64; 2]> = ends.map(|(_, &next)| self.vertices[next]).collect();
        for e in (0..self.len()).filter(|&e| !self.is_line(e)) {
            corners.extend([-1.0, -0.5, 0.0, 0.5].map(|t| self.point(e, t)));
        }
        diameter_of(&corners, distance)
    }

    /// End points of element e as complex numbers.
    pub fn segment(&self, e: usize) -> Segment {
        let [a, b] = self.ends(e);
        Segment { start: Complex64::new(a[0], a[1]), end: Complex64::new(b[0], b[1]) }
    }

    /// Checks that the elements are closed loops of at least three elements, two if one is curved, of positive, finite length
    /// and degree ≥ 1, and that the curved ones are [`Curve::is_admissible`].
    ///
    /// # Errors
    /// [`BemError::Mesh`] naming the first element at fault.
    pub fn check(&self) -> Result<(), BemError> {
        let n = self.len();
        let fault = |what: String| Err(BemError::Mesh { what });
        if n == 0 {
            return fault("there is no element".into());
        }
        let (edges, sides) = (self.edge.len(), self.side.len());
        let shapes = [self.shape.len(), self.heading.len()];
        let lengths =
            [self.next.len(), self.degree.len(), edges, shapes[0], shapes[1], sides, self.span.len(), self.arc.len()];
        if lengths.iter().any(|&l| l != n) {
            return fault(format!(
                "{n} vertices but {lengths:?} successors, degrees, edges, shapes, headings, sides, spans, arcs"
            ));
        }
        let mut reached = vec![0; n];
        for (e, &next) in self.next.iter().enumerate() {
            if next >= n {
                return fault(format!("element {e} is followed by {next}, but there are {n} elements"));
            }
            reached[next] += 1;
            let straight = self.is_line(e) && self.is_line(next);
            if (self.next[next] == e && straight) || next == e {
                return fault(format!("the loop of element {e} has too few elements"));
            }
        }
        for e in 0..n {
            let length = self.length(e);
            if reached[e] != 1 {
                return fault(format!("element {e} follows {} elements instead of one", reached[e]));
            }
            if !(length > 0.0 && length.is_finite()) {
                return fault(format!("element {e} has the length {length}"));
            }
            if !self.curve(e).is_admissible() {
                return fault(format!("element {e} turns too far; it needs to be cut"));
            }
            if self.degree[e] == 0 || self.degree[e] > Self::MAX_DEGREE {
                return fault(format!("element {e} has degree {}, not 1 to {}", self.degree[e], Self::MAX_DEGREE));
            }
        }
        Ok(())
    }

    /// Highest degree that the moments are computed for.
    pub const MAX_DEGREE: usize = 64;
}

/// Unit tangent of each element, that of the whole edge on which it lies: small elements of an oblique edge lose digits of
/// their own. Element e runs from `vertices[e]` to `vertices[next[e]]` on `edge[e]`.
pub fn edge_tangents(vertices: &[[f64; 2]], next: &[usize], edge: &[usize]) -> Vec<[f64; 2]> {
    let links = || (0..vertices.len()).filter_map(|e| Some((e, *next.get(e)?, edge.get(e)?, edge.get(*next.get(e)?)?)));
    let (mut starts, mut ends) = (HashMap::new(), HashMap::new());
    for (_, after, here, there) in links().filter(|(_, _, here, there)| here != there) {
        starts.insert(*there, vertices[after]);
        ends.insert(*here, vertices[after]);
    }
    links()
        .map(|(e, after, k, _)| {
            let ends = starts.get(k).zip(ends.get(k));
            // a loop of one edge has no direction but that of each element
            let (a, b) = ends.map_or((vertices[e], vertices[after]), |(a, b)| (*a, *b));
            unit(minus(b, a))
        })
        .collect()
}
