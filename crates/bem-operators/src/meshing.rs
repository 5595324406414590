//! Meshes from polygons, and their refinement.

use crate::{BemError, Edge, Mesh, Polygon, Shape, edge_tangents};

/// Lengths that differ by less than this, relatively, are equal, so that rotating or scaling a body changes no mesh.
const TIE: f64 = 1e-12;

impl Mesh {
    /// Mesh of `elements` elements of one degree. The elements of an edge are equal, except where a curve turns too far for
    /// one element: there it is halved.
    ///
    /// Each edge gets one element; then, while fewer than `elements` are placed, one more goes to the edge whose elements are
    /// longest (ties: the lowest edge number). A number below that of the edges is raised to it. An edge is not cut below
    /// [`Polygon::tolerance`].
    ///
    /// # Panics
    /// If `degree` is 0.
    pub fn uniform(polygon: &Polygon, elements: usize, degree: usize) -> Mesh {
        assert!(degree > 0, "the degree of an element is at least 1");
        let lengths: Vec<f64> = polygon.edges().iter().map(Edge::length).collect();
        // the rule gives every edge at least the whole part of its share of what the others leave
        let perimeter: f64 = lengths.iter().sum();
        let shared = elements.saturating_sub(lengths.len()) as f64;
        let mut count: Vec<usize> =
            lengths.iter().map(|l| ((shared * l / perimeter * (1.0 - 1e-9)) as usize).max(1)).collect();
        for (count, length) in count.iter_mut().zip(&lengths) {
            *count = (*count).min((length / polygon.tolerance() / 4.0) as usize + 1);
        }
        for _ in count.iter().sum::<usize>()..elements {
            let length = |k: usize| lengths[k] / count[k] as f64;
            let longest = (0..lengths.len()).map(length).fold(0.0, f64::max);
            if longest <= 2.0 * polygon.tolerance() {
                break;
            }
            let Some(k) = (0..lengths.len()).find(|&k| length(k) >= longest * (1.0 - TIE)) else { break };
            count[k] += 1;
        }
        let equal = |n: usize| (1..n).map(|i| i as f64 / n as f64).collect::<Vec<f64>>();
        let breaks: Vec<Vec<f64>> =
            polygon.edges().iter().zip(&count).map(|(edge, &n)| with_needed_cuts(edge, equal(n))).collect();
        let degrees: Vec<Vec<usize>> = breaks.iter().map(|b| vec![degree; b.len() + 1]).collect();
        build(polygon, &breaks, &degrees)
    }

    /// Mesh with given break points and degrees.
    ///
    /// `breaks[k]`: interior break points of edge k, rising in its edge parameter 0 < s < 1; `degree[k]`: the degree
    /// of each of its `breaks[k].len() + 1` elements, in the order of s (on an edge that is [`Edge::reversed`] this is
    /// against the traversal).
    ///
    /// # Errors
    /// [`BemError::Mesh`] when a length does not fit, a break is out of order or out of (0, 1), an element has no
    /// length in floating point or turns too far, or a degree is 0.
    pub fn from_breaks(polygon: &Polygon, breaks: &[Vec<f64>], degree: &[Vec<usize>]) -> Result<Mesh, BemError> {
        let wrong = |what: String| Err(BemError::Mesh { what });
        let edges = polygon.edges();
        if breaks.len() != edges.len() || degree.len() != edges.len() {
            let (b, d) = (breaks.len(), degree.len());
            return wrong(format!("{b} lists of breaks and {d} of degrees for {} edges", edges.len()));
        }
        for (k, edge) in edges.iter().enumerate() {
            if degree[k].len() != breaks[k].len() + 1 {
                let (b, d) = (breaks[k].len(), degree[k].len());
                return wrong(format!("edge {k} has {b} breaks and {d} degrees; it needs one degree more than breaks"));
            }
            if degree[k].contains(&0) {
                return wrong(format!("edge {k} has an element of degree 0; the least is 1"));
            }
            let knots: Vec<f64> = [0.0].into_iter().chain(breaks[k].iter().copied()).chain([1.0]).collect();
            for s in knots.windows(2) {
                if !(s[0] < s[1] && edge.point(s[0]) != edge.point(s[1])) {
                    return wrong(format!("the element of edge {k} from s = {} to s = {} has no length", s[0], s[1]));
                }
                if !edge.is_admissible(s[0], s[1]) {
                    return wrong(format!("the element of edge {k} from s = {} to s = {} turns too far", s[0], s[1]));
                }
            }
        }
        Ok(build(polygon, breaks, degree))
    }

    /// Mesh that is geometric towards points of the boundary.
    ///
    /// `towards` lists points (edge, s); s = 0 and s = 1 are corners, towards which both of their edges are graded.
    /// The points cut their edges; a piece of length ℓ with such a point at one end is broken at ℓ ratio^k from it,
    /// k = 1..=layers, a piece with one at both ends is halved first, and a piece with none is one element.
    /// `degree(j)` is the degree in layer j, counted from the point: 0 touches it, `layers` is the largest element
    /// (and one of a piece without a point). So `|_| p` is uniform and `|j| 1 + j` linear in the layer.
    ///
    /// # Errors
    /// [`BemError::Mesh`] when an edge or s is out of range, `ratio` is not in (0, 1), a degree is 0, or the smallest
    /// element, ratio^layers of its piece, has no length in floating point.
    ///
    /// Source: Gui and Babuška (1986), part II, for geometric meshes with linear degrees.
    pub fn graded(
        polygon: &Polygon,
        towards: &[(usize, f64)],
        layers: usize,
        ratio: f64,
        degree: impl Fn(usize) -> usize,
    ) -> Result<Mesh, BemError> {
        let wrong = |what: String| Err(BemError::Mesh { what });
        let edges = polygon.edges().len();
        if !(ratio > 0.0 && ratio < 1.0) {
            return wrong(format!("the grading ratio is {ratio}; it must lie in (0, 1)"));
        }
        let mut corner = vec![false; edges]; // corner k is where s = 0 on edge k
        let mut inner = vec![Vec::new(); edges];
        for &(k, s) in towards {
            if k >= edges || !(0.0..=1.0).contains(&s) {
                return wrong(format!("the point s = {s} of edge {k} is not on the boundary of {edges} edges"));
            }
            match s {
                0.0 => corner[k] = true,
                1.0 => corner[next_corner(polygon, k)] = true,
                _ => inner[k].push(s),
            }
        }
        let (mut breaks, mut degrees) = (Vec::new(), Vec::new());
        for (k, mut knots) in inner.into_iter().enumerate() {
            knots.sort_by(f64::total_cmp);
            knots.dedup();
            let last = knots.len();
            let mut points = vec![0.0];
            points.extend(knots);
            points.push(1.0);
            let (mut cuts, mut degree_of) = (Vec::new(), Vec::new());
            for (i, piece) in points.windows(2).enumerate() {
                let singular = [i > 0 || corner[k], i < last || corner[next_corner(polygon, k)]];
                if i > 0 {
                    cuts.push(piece[0]);
                }
                grade_piece([piece[0], piece[1]], singular, layers, ratio, &mut cuts, &mut degree_of);
            }
            breaks.push(cuts);
            degrees.push(degree_of.into_iter().map(&degree).collect());
        }
        Mesh::from_breaks(polygon, &breaks, &degrees)
    }

    /// Halves the marked elements, whose halves keep their degree. Returns the mesh and the parent of each element.
    ///
    /// An element so short that its midpoint is lost in the rounding of its coordinates stays whole: its number then
    /// appears once among the parents.
    ///
    /// # Panics
    /// If `marked` has not one entry for each element.
    pub fn bisected(&self, marked: &[bool]) -> (Mesh, Vec<usize>) {
        assert_eq!(marked.len(), self.len(), "one mark for each element");
        let cut: Vec<bool> = (0..self.len()).map(|e| marked[e] && self.divisible(e)).collect();
        let mut first = Vec::with_capacity(self.len());
        let mut count = 0;
        for &halved in &cut {
            first.push(count);
            count += if halved { 2 } else { 1 };
        }
        let parent: Vec<usize> =
            (0..self.len()).flat_map(|e| std::iter::repeat_n(e, if cut[e] { 2 } else { 1 })).collect();
        let of_parent = |values: &[usize]| parent.iter().map(|&e| values[e]).collect::<Vec<usize>>();
        let mut mesh = Mesh {
            vertices: Vec::with_capacity(count),
            next: Vec::with_capacity(count),
            degree: of_parent(&self.degree),
            edge: of_parent(&self.edge),
            shape: Vec::with_capacity(count),
            heading: Vec::with_capacity(count),
            side: of_parent(&self.side),
            span: Vec::with_capacity(count),
            arc: Vec::with_capacity(count),
            side_names: self.side_names.clone(),
        };
        for e in 0..self.len() {
            let ([s0, s1], after) = (self.span[e], first[self.next[e]]);
            mesh.vertices.push(self.vertices[e]);
            if cut[e] {
                let middle = self.edge_parameter(e, 0.0);
                mesh.vertices.push(self.point(e, 0.0));
                mesh.heading.extend([-0.5, 0.5].map(|t| self.tangent(e, t)));
                mesh.shape.extend(self.shape[e].halves());
                mesh.span.extend([[s0, middle], [middle, s1]]);
                let ([a0, a1], middle) = (self.arc[e], self.arc_fraction(e, 0.0));
                mesh.arc.extend([[a0, middle], [middle, a1]]);
                mesh.next.extend([first[e] + 1, after]);
            } else {
                mesh.heading.push(self.heading[e]);
                mesh.shape.push(self.shape[e].clone());
                mesh.span.push([s0, s1]);
                mesh.arc.push(self.arc[e]);
                mesh.next.push(after);
            }
        }
        (mesh, parent)
    }

    /// Raises the degree of the marked elements by one.
    ///
    /// # Panics
    /// If `marked` has not one entry for each element.
    pub fn raised(&self, marked: &[bool]) -> Mesh {
        assert_eq!(marked.len(), self.len(), "one mark for each element");
        let degree = self.degree.iter().zip(marked).map(|(&p, &m)| p + usize::from(m)).collect();
        Mesh { degree, ..self.clone() }
    }

    /// Whether the halves of element e still have a direction: several roundings of coordinates and edge parameter.
    fn divisible(&self, e: usize) -> bool {
        let ([a, b], [s0, s1]) = (self.ends(e), self.span[e]);
        let largest = a.iter().chain(&b).fold(0.0, |m: f64, c| m.max(c.abs()));
        self.length(e) > 64.0 * f64::EPSILON * largest && (s1 - s0).abs() > 64.0 * f64::EPSILON * s0.max(s1)
    }
}

/// Breaks of an edge, with those that its elements need because they turn too far.
fn with_needed_cuts(edge: &Edge, breaks: Vec<f64>) -> Vec<f64> {
    if edge.is_line() {
        return breaks;
    }
    let ends: Vec<f64> = [0.0].into_iter().chain(breaks).chain([1.0]).collect();
    let mut all: Vec<f64> =
        ends.windows(2).flat_map(|s| edge.needed_cuts([s[0], s[1]], SHORTEST).into_iter().chain([s[1]])).collect();
    all.pop();
    all
}

/// No part of an edge below this fraction is cut.
const SHORTEST: f64 = 1e-7;

/// Corner at s = 1 of edge k, named after the edge that has it at s = 0.
fn next_corner(polygon: &Polygon, k: usize) -> usize {
    let range = &polygon.loops()[polygon.edges()[k].loop_index];
    if k + 1 == range.end { range.start } else { k + 1 }
}

/// Appends the breaks inside [a, b] and the layer of each element, geometric towards the singular ends.
fn grade_piece(
    [a, b]: [f64; 2],
    singular: [bool; 2],
    layers: usize,
    ratio: f64,
    cuts: &mut Vec<f64>,
    layer: &mut Vec<usize>,
) {
    let distance = |length: f64, k: usize| length * ratio.powi(k as i32);
    match singular {
        [false, false] => layer.push(layers),
        [true, false] => {
            cuts.extend((1..=layers).rev().map(|k| a + distance(b - a, k)));
            layer.extend(0..=layers);
        }
        [false, true] => {
            cuts.extend((1..=layers).map(|k| b - distance(b - a, k)));
            layer.extend((0..=layers).rev());
        }
        [true, true] => {
            let middle = (a + b) / 2.0;
            grade_piece([a, middle], [true, false], layers, ratio, cuts, layer);
            cuts.push(middle);
            grade_piece([middle, b], [false, true], layers, ratio, cuts, layer);
        }
    }
}

/// Elements of all loops in the order of traversal; breaks and degrees by edge in the order of s.
fn build(polygon: &Polygon, breaks: &[Vec<f64>], degrees: &[Vec<usize>]) -> Mesh {
    let mut mesh = Mesh {
        vertices: Vec::new(),
        next: Vec::new(),
        degree: Vec::new(),
        edge: Vec::new(),
        shape: Vec::new(),
        heading: Vec::new(),
        side: Vec::new(),
        span: Vec::new(),
        arc: Vec::new(),
        side_names: polygon.side_names().to_vec(),
    };
    for loop_index in 0..polygon.loops().len() {
        let first = mesh.vertices.len();
        for k in polygon.traversal(loop_index) {
            let edge = &polygon.edges()[k];
            let mut knots: Vec<f64> = [0.0].into_iter().chain(breaks[k].iter().copied()).chain([1.0]).collect();
            let mut degree = degrees[k].clone();
            if edge.reversed {
                knots.reverse();
                degree.reverse();
            }
            for (s, p) in knots.windows(2).zip(degree) {
                mesh.next.push(mesh.vertices.len() + 1);
                mesh.vertices.push(edge.point(s[0]));
                mesh.degree.push(p);
                mesh.edge.push(k);
                mesh.side.push(edge.side);
                mesh.span.push([s[0], s[1]]);
                let (shape, heading) = edge.element([s[0], s[1]]);
                mesh.arc.push([s[0], s[1]].map(|s| edge.drawn_fraction(s)));
                mesh.shape.push(shape);
                mesh.heading.push(heading);
            }
        }
        if let Some(last) = mesh.next.last_mut() {
            *last = first;
        }
    }
    for (e, tangent) in edge_tangents(&mesh.vertices, &mesh.next, &mesh.edge).into_iter().enumerate() {
        if mesh.shape[e] == Shape::Line {
            mesh.heading[e] = tangent;
        }
    }
    mesh
}
