//! Subdomains of a body that is cut along lines, on a mesh.
//!
//! ```text
//! ┌──────┬──────┐   elements of the boundary: in one subdomain each
//! │  Ω₁  │  Ω₂  │   elements of cuts: in two, traversed forwards in one of them and backwards in the other
//! └──────┴──────┘   nodes on cuts: one number, whichever subdomains have them
//! ```
//! The nodes and elements of the boundary keep their numbers; those of the cuts follow them. Backwards the local point j of an
//! element of degree p is p - j, and a function that is odd about its middle changes its sign.

use std::collections::BTreeMap;
use std::ops::Range;

use steklov_elastic::plane::{distance, dot, minus, unit};

use crate::curve::Shape;
use crate::cut::{Arrangement, Part};
use crate::subdivision::Piece;
use crate::{Cut, CutError, Edge, Location, Mesh, Path, Polygon, Space};

/// A body cut along straight lines, before it has a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Cuts {
    /// The lines, which may end outside of the body and cross each other.
    pub lines: Vec<[[f64; 2]; 2]>,
    /// The points at which boundary and lines meet.
    points: Vec<[f64; 2]>,
    /// The parts of lines inside the body, by their ends among the points.
    parts: Vec<[usize; 2]>,
    /// The loops of each subdomain, the outer one first.
    loops: Vec<Vec<Vec<Step>>>,
    /// The subdomains as bodies.
    outline: Polygon,
    /// A box around each of them: lower left and upper right corner.
    boxes: Vec<[[f64; 2]; 2]>,
    /// Number of edges of the body.
    edges: usize,
}

/// A part of the boundary of a subdomain.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Step {
    /// An edge of the body from one of its parameters to another one, behind a point.
    Outline { from: usize, edge: usize, s: [f64; 2] },
    /// A part of a cut.
    Cut { part: usize, backwards: bool },
}

/// A part of a body on a mesh: the whole body, or one of its subdomains.
#[derive(Debug, Clone)]
pub struct Subdomain {
    /// Its mesh.
    pub mesh: Mesh,
    /// Its unknowns.
    pub space: Space,
    /// The number of each of its nodes among all.
    pub nodes: Vec<usize>,
    /// The number of each of its elements among all.
    pub elements: Vec<usize>,
    /// Whether it traverses them backwards.
    pub backwards: Vec<bool>,
}

/// The elements of cuts: their numbers follow those of the boundary.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CutElements {
    /// The part of a cut that each is on.
    pub part: Vec<usize>,
    /// Its degree.
    pub degree: Vec<usize>,
    /// The points of the nodes that are on no element of the boundary; their numbers follow those of the boundary.
    pub points: Vec<[f64; 2]>,
}

/// A box around each body of a polygon, larger by a part that covers what lies between the points of curves.
fn boxes(outline: &Polygon) -> Vec<[[f64; 2]; 2]> {
    const MARGIN: f64 = 0.05;
    let mut boxes = vec![[[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]]; outline.bodies().len()];
    for edge in outline.edges() {
        let [low, high] = &mut boxes[outline.body_of_loop(edge.loop_index)];
        for x in edge.extent().into_iter().chain([edge.end]) {
            (0..2).for_each(|i| (low[i], high[i]) = (low[i].min(x[i]), high[i].max(x[i])));
        }
    }
    for [low, high] in &mut boxes {
        let margin = MARGIN * (high[0] - low[0]).max(high[1] - low[1]);
        (0..2).for_each(|i| (low[i], high[i]) = (low[i] - margin, high[i] + margin));
    }
    boxes
}

/// Puts the loops of a subdomain, the outer one first, in an order that moving it does not change: each begins at its point that is
/// first along a direction, and holes follow each other along it.
pub(crate) fn in_order(loops: &mut [Vec<usize>], start: impl Fn(usize) -> [f64; 2]) {
    // no line of a drawing is perpendicular to it
    let along = |h: usize| dot(start(h), [1.0_f64.cos(), 1.0_f64.sin()]);
    for one in loops.iter_mut() {
        let first = (0..one.len()).min_by(|&a, &b| along(one[a]).total_cmp(&along(one[b])));
        one.rotate_left(first.unwrap_or(0));
    }
    loops[1..].sort_by(|a, b| along(a[0]).total_cmp(&along(b[0])));
}

impl Cuts {
    /// The subdomains of a body along lines.
    ///
    /// # Errors
    /// As [`Polygon::cut`].
    ///
    /// # Panics
    /// If there are several bodies, or one that is unbounded.
    pub fn new(body: &Polygon, lines: &[[[f64; 2]; 2]]) -> Result<Self, CutError> {
        let names = ["left", "right"].map(str::to_owned);
        let cuts: Vec<Cut> = lines.iter().map(|&ends| Cut { ends, sides: names.clone() }).collect();
        let Arrangement { points, halves, mut pieces, .. } = body.arranged(&cuts)?;
        pieces.iter_mut().for_each(|loops| in_order(loops, |h| points.all[halves[h].from]));
        let mut parts: Vec<[usize; 2]> = Vec::new();
        let mut number_of = BTreeMap::new();
        for half in &halves {
            if let Part::Line(line) = half.of {
                number_of.entry(line).or_insert_with(|| {
                    parts.push([half.from, half.to]);
                    parts.len() - 1
                });
            }
        }
        let step = |&h: &usize| match halves[h].of {
            Part::Outline(edge, s) => Step::Outline { from: halves[h].from, edge, s },
            Part::Line(line) => {
                let part = number_of[&line];
                Step::Cut { part, backwards: parts[part] != [halves[h].from, halves[h].to] }
            }
        };
        let loops = pieces.iter().map(|piece| piece.iter().map(|one| one.iter().map(step).collect()).collect());
        let edges_of = |one: &Vec<usize>| one.iter().map(|&h| halves[h].edge.clone()).collect::<Vec<Edge>>();
        let bodies = pieces.iter().map(|piece| piece.iter().map(edges_of).collect()).collect();
        let outline = body.in_pieces(bodies, body.side_names().to_vec());
        Ok(Self {
            lines: lines.to_vec(),
            loops: loops.collect(),
            parts,
            points: points.all,
            boxes: boxes(&outline),
            outline,
            edges: body.edges().len(),
        })
    }

    /// Number of subdomains.
    pub fn count(&self) -> usize {
        self.loops.len()
    }

    /// The subdomains as bodies.
    pub fn outline(&self) -> &Polygon {
        &self.outline
    }

    /// The parts of lines inside the body: their ends.
    pub fn parts(&self) -> Vec<[[f64; 2]; 2]> {
        self.parts.iter().map(|ends| ends.map(|k| self.points[k])).collect()
    }

    /// The points of edges, corners apart, at which cuts end: edge, edge parameter.
    pub fn ends(&self) -> Vec<(usize, f64)> {
        let steps = self.loops.iter().flatten().flatten();
        let inside = |s: &f64| *s > 0.0 && *s < 1.0;
        let of = |step: &Step| match *step {
            Step::Outline { edge, s, .. } => s.into_iter().filter(inside).map(|s| (edge, s)).collect(),
            Step::Cut { .. } => Vec::new(),
        };
        let mut ends: Vec<(usize, f64)> = steps.flat_map(of).collect();
        ends.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        ends.dedup();
        ends
    }

    /// The subdomain at a point of the body, the nearest one outside of it.
    pub fn at(&self, x: [f64; 2]) -> usize {
        let within = |[low, high]: [[f64; 2]; 2]| (0..2).all(|i| low[i] <= x[i] && x[i] <= high[i]);
        let holds = |k: &usize| within(self.boxes[*k]) && self.outline.location_in(*k, x) != Location::Outside;
        let off = |k: usize| {
            let edges = self.outline.edges().iter();
            let own = edges.filter(|edge| self.outline.body_of_loop(edge.loop_index) == k);
            own.map(|edge| edge.nearest(x, f64::INFINITY).map_or(f64::INFINITY, |(d, _)| d))
                .fold(f64::INFINITY, f64::min)
        };
        let nearest = || (0..self.count()).min_by(|&a, &b| off(a).total_cmp(&off(b)));
        (0..self.count()).find(holds).or_else(nearest).unwrap_or(0)
    }

    /// The subdomains on a mesh of the body that has vertices at all [`Cuts::ends`]; `elements` are those of each part of a cut.
    ///
    /// # Panics
    /// If the mesh has no such vertices.
    pub fn subdomains(&self, mesh: &Mesh, space: &Space, elements: &[Vec<Piece>]) -> (Vec<Subdomain>, CutElements) {
        let on_boundary = OnBoundary::new(self, mesh);
        let mut nodes: BTreeMap<usize, usize> = on_boundary.first.iter().map(|(&k, &e)| (k, space.offset[e])).collect();
        let mut cut = CutElements::default();
        // points inside of the body, then the nodes inside of the elements of each part
        for &k in self.parts.iter().flatten() {
            nodes.entry(k).or_insert_with(|| {
                cut.points.push(self.points[k]);
                space.nodes() + cut.points.len() - 1
            });
        }
        let place = |k: usize| on_boundary.first.get(&k).map_or(self.points[k], |&e| mesh.vertices[e]);
        let mut parts = Vec::new();
        for (part, (&[from, to], pieces)) in self.parts.iter().zip(elements).enumerate() {
            let line = Line::new([from, to].map(place), pieces);
            let first = mesh.len() + cut.part.len();
            let mut own = vec![nodes[&from]];
            for (k, piece) in pieces.iter().enumerate() {
                cut.part.push(part);
                cut.degree.push(piece.degree);
                let last = k + 1 == pieces.len();
                let inside = line.nodes(k, &Space::new(&line.mesh));
                let new = &inside[..inside.len() - usize::from(last)];
                let start = space.nodes() + cut.points.len();
                own.extend(start..start + new.len());
                cut.points.extend(new);
            }
            own.push(nodes[&to]);
            parts.push(OfPart { line, nodes: own, elements: first..first + pieces.len() });
        }
        let of = |loops: &Vec<Vec<Step>>| self.subdomain(loops, (mesh, space), &on_boundary, &parts);
        (self.loops.iter().map(of).collect(), cut)
    }

    fn subdomain(
        &self,
        loops: &[Vec<Step>],
        (mesh, space): (&Mesh, &Space),
        on_boundary: &OnBoundary,
        parts: &[OfPart],
    ) -> Subdomain {
        let mut own = Growing::new(mesh);
        for one in loops {
            let first = own.elements.len();
            for step in one {
                match *step {
                    Step::Outline { edge, s, .. } => {
                        for e in on_boundary.between(edge, s, mesh) {
                            let nodes = space.offset[e]..space.offset[e + 1];
                            own.add(mesh, e, (e, false), nodes.collect());
                        }
                    }
                    Step::Cut { part, backwards } => {
                        let OfPart { line, nodes, elements } = &parts[part];
                        let line = if backwards { line.reversed() } else { line.clone() };
                        let mut at = 0;
                        for k in 0..line.mesh.len() / 2 {
                            let p = line.mesh.degree[k];
                            let start = own.mesh.edge.len();
                            let node = |j: usize| nodes[if backwards { nodes.len() - 1 - at - j } else { at + j }];
                            let of_part = if backwards { elements.end - 1 - k } else { elements.start + k };
                            own.add(&line.mesh, k, (of_part, backwards), (0..p).map(node).collect());
                            own.mesh.edge[start] = self.edges + part;
                            own.mesh.side[start] = Mesh::NO_SIDE;
                            at += p;
                        }
                    }
                }
            }
            own.close(first);
        }
        own.finished()
    }
}

/// The elements of the boundary along its edges.
struct OnBoundary {
    /// The element that begins at a point of the arrangement.
    first: BTreeMap<usize, usize>,
    /// The elements of each edge, as it is traversed.
    of_edge: Vec<Vec<usize>>,
}

impl OnBoundary {
    fn new(cuts: &Cuts, mesh: &Mesh) -> Self {
        let mut of_edge = vec![Vec::new(); cuts.edges];
        (0..mesh.len()).for_each(|e| of_edge[mesh.edge[e]].push(e));
        let mut all = Self { first: BTreeMap::new(), of_edge };
        let near = SAME * mesh.diameter();
        for step in cuts.loops.iter().flatten().flatten() {
            if let Step::Outline { from, edge, s } = *step {
                let first = all.between(edge, s, mesh).next().expect("an element between the ends of cuts");
                let x = cuts.points[from];
                let y = mesh.vertices[first];
                assert!(distance(x, y) <= near, "no vertex at the end {x:?} of a cut: {y:?}");
                all.first.insert(from, first);
            }
        }
        all
    }

    fn between<'m>(&'m self, edge: usize, [a, b]: [f64; 2], mesh: &'m Mesh) -> impl Iterator<Item = usize> + 'm {
        let (low, high) = (a.min(b), a.max(b));
        let inside = move |e: &usize| {
            let middle = (mesh.span[*e][0] + mesh.span[*e][1]) / 2.0;
            low < middle && middle < high
        };
        self.of_edge[edge].iter().copied().filter(inside)
    }
}

/// Largest distance of the end of a cut from its vertex (part of the diameter).
const SAME: f64 = 1e-8;

/// The elements of a part of a cut, forwards, and their way back: a mesh is closed.
#[derive(Clone)]
struct Line {
    mesh: Mesh,
}

impl Line {
    fn new(ends: [[f64; 2]; 2], pieces: &[Piece]) -> Self {
        let [start, end] = ends;
        let edge = Edge { start, end, path: Path::Line, side: 0, loop_index: 0, reversed: false, drawn: [0.0, 1.0] };
        let mut starts: Vec<[f64; 2]> = pieces.iter().map(|piece| edge.point(piece.start)).collect();
        starts[0] = start;
        let spans = pieces.iter().map(|piece| [piece.start, piece.end]).collect();
        Self::through(starts, end, pieces.iter().map(|piece| piece.degree).collect(), spans)
    }

    fn through(starts: Vec<[f64; 2]>, end: [f64; 2], degree: Vec<usize>, spans: Vec<[f64; 2]>) -> Self {
        let n = starts.len();
        let heading = unit(minus(end, starts[0]));
        let back = heading.map(|d| -d);
        let way_back = std::iter::once(end).chain(starts[1..].iter().rev().copied());
        let vertices: Vec<[f64; 2]> = starts.iter().copied().chain(way_back).collect();
        let both = |spans: &[[f64; 2]]| -> Vec<[f64; 2]> {
            spans.iter().copied().chain(spans.iter().rev().map(|[a, b]| [*b, *a])).collect()
        };
        let mesh = Mesh {
            next: (0..2 * n).map(|e| (e + 1) % (2 * n)).collect(),
            degree: degree.iter().chain(degree.iter().rev()).copied().collect(),
            edge: vec![0; 2 * n],
            shape: vec![Shape::Line; 2 * n],
            heading: (0..2 * n).map(|e| if e < n { heading } else { back }).collect(),
            side: vec![0; 2 * n],
            span: both(&spans),
            arc: both(&spans),
            side_names: Vec::new(),
            vertices,
        };
        Self { mesh }
    }

    fn reversed(&self) -> Self {
        let n = self.mesh.len() / 2;
        let starts = (0..n).map(|k| self.mesh.vertices[n + k]).collect();
        let degree = self.mesh.degree[n..].to_vec();
        Self::through(starts, self.mesh.vertices[0], degree, self.mesh.span[n..].to_vec())
    }

    /// The nodes of an element inside of it and at its end.
    fn nodes(&self, k: usize, space: &Space) -> Vec<[f64; 2]> {
        space.element_nodes(k).skip(1).map(|node| space.points[node]).collect()
    }
}

/// A part of a cut: its elements forwards, their nodes from end to end, and their numbers.
struct OfPart {
    line: Line,
    nodes: Vec<usize>,
    elements: Range<usize>,
}

/// A subdomain to which elements are added.
struct Growing {
    mesh: Mesh,
    nodes: Vec<usize>,
    elements: Vec<usize>,
    backwards: Vec<bool>,
}

impl Growing {
    fn new(whole: &Mesh) -> Self {
        let mesh = whole.part(0..0);
        Self { mesh, nodes: Vec::new(), elements: Vec::new(), backwards: Vec::new() }
    }

    /// Adds an element of a mesh, with its number among all, and with the nodes that it owns.
    fn add(&mut self, of: &Mesh, e: usize, (number, backwards): (usize, bool), nodes: Vec<usize>) {
        let mesh = &mut self.mesh;
        mesh.vertices.push(of.vertices[e]);
        mesh.next.push(mesh.vertices.len());
        mesh.degree.push(of.degree[e]);
        mesh.edge.push(of.edge[e]);
        mesh.shape.push(of.shape[e].clone());
        mesh.heading.push(of.heading[e]);
        mesh.side.push(of.side[e]);
        mesh.span.push(of.span[e]);
        mesh.arc.push(of.arc[e]);
        self.nodes.extend(nodes);
        self.elements.push(number);
        self.backwards.push(backwards);
    }

    /// Closes the loop that begins with an element.
    fn close(&mut self, first: usize) {
        if let Some(last) = self.mesh.next.last_mut() {
            *last = first;
        }
    }

    fn finished(self) -> Subdomain {
        let Self { mesh, nodes, elements, backwards } = self;
        Subdomain { space: Space::new(&mesh), mesh, nodes, elements, backwards }
    }
}

impl Subdomain {
    /// A whole body: consecutive elements of a mesh.
    pub fn whole(mesh: &Mesh, space: &Space, elements: Range<usize>) -> Self {
        let part = mesh.part(elements.clone());
        Self {
            space: Space::new(&part),
            mesh: part,
            nodes: (space.offset[elements.start]..space.offset[elements.end]).collect(),
            backwards: vec![false; elements.len()],
            elements: elements.collect(),
        }
    }

    /// Its own part of a vector of all nodes (interleaved x, y).
    pub fn own(&self, nodal: &[f64]) -> Vec<f64> {
        self.nodes.iter().flat_map(|&node| [nodal[2 * node], nodal[2 * node + 1]]).collect()
    }

    /// Adds its own part to a vector of all nodes.
    pub fn add_to(&self, nodal: &mut [f64], own: &[f64]) {
        for (&node, own) in self.nodes.iter().zip(own.chunks_exact(2)) {
            (0..2).for_each(|i| nodal[2 * node + i] += own[i]);
        }
    }

    /// Puts its own values into a vector of all nodes.
    pub fn set(&self, nodal: &mut [f64], own: &[f64]) {
        for (&node, own) in self.nodes.iter().zip(own.chunks_exact(2)) {
            (0..2).for_each(|i| nodal[2 * node + i] = own[i]);
        }
    }

    /// Its number of an element among all, if it has that.
    pub fn local(&self, element: usize) -> Option<usize> {
        self.elements.iter().position(|&e| e == element)
    }

    /// Whether it has an element.
    pub fn has(&self, element: usize) -> bool {
        self.elements.contains(&element)
    }

    /// The sign of the function ∫P_p of each of its elements relative to that of all.
    pub fn bubble_signs(&self) -> Vec<f64> {
        let of = |(&backwards, p): (&bool, &usize)| if backwards && p % 2 == 0 { -1.0 } else { 1.0 };
        self.backwards.iter().zip(&self.mesh.degree).map(of).collect()
    }
}
