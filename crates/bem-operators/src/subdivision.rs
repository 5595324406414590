//! The elements of every edge as intervals of its parameter: what refinement changes.

use crate::{BemError, Edge, Mesh, Polygon};

/// What refinement does with an element.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Mark {
    /// It stays.
    #[default]
    Keep,
    /// Its error is large.
    Refine {
        /// Whether its solution or a datum is not smooth.
        rough: bool,
        /// Its indicator over the smallest one that is marked, at least 1.
        excess: f64,
        /// Increase of its degree where it is not cut.
        degrees: usize,
    },
}

impl Mark {
    /// Refinement by one degree, or by two where the error is far above the smallest one that is marked.
    pub fn refine(rough: bool, excess: f64) -> Self {
        Self::Refine { rough, excess, degrees: if excess >= TWO_DEGREES { 2 } else { 1 } }
    }
}

/// An element of an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Edge parameter at its start.
    pub start: f64,
    /// Edge parameter at its end, that at the start of the next piece.
    pub end: f64,
    /// Polynomial degree.
    pub degree: usize,
    /// What refinement does with it.
    pub mark: Mark,
}

impl Piece {
    fn length(&self) -> f64 {
        self.end - self.start
    }

    fn middle(&self) -> f64 {
        (self.start + self.end) / 2.0
    }
}

/// The pieces of all edges of a polygon, those of an edge in the order of its parameter s from 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Subdivision {
    /// The pieces of each edge.
    pub edges: Vec<Vec<Piece>>,
}

/// Two edge parameters closer than this are one.
pub const SAME_PLACE: f64 = 1e-12;
/// Pieces shorter than this are not kept when vertices move: their ends could be taken for one another.
const SHORTEST: f64 = 2.0 * SAME_PLACE;

/// Excess from which two degrees are added at once: each is expected to divide the error by 4.
const TWO_DEGREES: f64 = 4.0;
/// Excess from which two layers are cut off at once, as a power of 1/σ: each divides the error by σ^-0.8.
const TWO_LAYERS: f64 = 0.8;

/// How [`Subdivision::refined`] cuts and raises.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grading {
    /// Part of a piece that stays at its singular end when it is cut, 0 < σ < 1.
    pub sigma: f64,
    /// Degree up to which a piece at a singular point is raised before it is cut.
    pub tip_degree: usize,
    /// Degree up to which degrees are raised; a higher one stays.
    pub max_degree: usize,
    /// Shortest piece (part of its edge) that is still cut.
    pub shortest: f64,
}

impl Default for Grading {
    fn default() -> Self {
        Self { sigma: 0.15, tip_degree: 2, max_degree: 12, shortest: 1e-9 }
    }
}

impl Subdivision {
    /// The elements of a mesh; `marks` has one entry for each.
    ///
    /// # Panics
    /// If there are fewer marks than elements.
    pub fn new(mesh: &Mesh, marks: &[Mark]) -> Self {
        let mut edges = vec![Vec::new(); mesh.edge.iter().max().map_or(0, |k| k + 1)];
        for e in 0..mesh.len() {
            let [a, b] = mesh.span[e];
            let piece = Piece { start: a.min(b), end: a.max(b), degree: mesh.degree[e], mark: marks[e] };
            edges[mesh.edge[e]].push(piece);
        }
        for pieces in &mut edges {
            pieces.sort_by(|a: &Piece, b| a.start.total_cmp(&b.start));
        }
        Self { edges }
    }

    /// The mesh of these pieces; those that turn too far for an element are halved.
    ///
    /// # Errors
    /// As [`Mesh::from_breaks`].
    pub fn mesh(&self, polygon: &Polygon) -> Result<Mesh, BemError> {
        let mut edges = self.edges.clone();
        for (edge, pieces) in polygon.edges().iter().zip(&mut edges).filter(|(edge, _)| !edge.is_line()) {
            *pieces = pieces.iter().flat_map(|piece| admissible(edge, *piece)).collect();
        }
        let breaks: Vec<Vec<f64>> = edges.iter().map(|p| p.iter().skip(1).map(|p| p.start).collect()).collect();
        let degree: Vec<Vec<usize>> = edges.iter().map(|p| p.iter().map(|p| p.degree).collect()).collect();
        Mesh::from_breaks(polygon, &breaks, &degree)
    }

    /// Number of elements of its mesh.
    pub fn elements(&self) -> usize {
        self.edges.iter().map(Vec::len).sum()
    }

    /// Displacement unknowns of its mesh.
    pub fn dofs(&self) -> usize {
        2 * self.edges.iter().flatten().map(|p| p.degree).sum::<usize>()
    }

    /// Makes a vertex at s: moves a vertex there that is closer than `snap` times its piece and not one of `fixed` (rising),
    /// otherwise cuts the piece, whose parts keep degree and mark. Does nothing if there is a vertex already.
    pub fn insert(&mut self, edge: usize, s: f64, fixed: &[f64], snap: f64) {
        let pieces = &mut self.edges[edge];
        let Some(i) = pieces.iter().position(|p| p.start <= s && s < p.end) else { return };
        let Piece { start, end, .. } = pieces[i];
        if s - start < SAME_PLACE || end - s < SAME_PLACE {
            return;
        }
        let movable =
            |v: f64| v > SAME_PLACE && v < 1.0 - SAME_PLACE && fixed.iter().all(|f| (f - v).abs() > SAME_PLACE);
        if s - start < snap * (end - start) && movable(start) {
            (pieces[i - 1].end, pieces[i].start) = (s, s);
        } else if end - s < snap * (end - start) && movable(end) {
            (pieces[i].end, pieces[i + 1].start) = (s, s);
        } else {
            let rest = Piece { start: s, ..pieces[i] };
            pieces[i].end = s;
            pieces.insert(i + 1, rest);
        }
    }

    /// Moves the vertex `from` to `to`. A move by less than 0.3 of the piece there moves this vertex only; a larger one maps
    /// all vertices between the neighbouring points of `fixed` (and the ends of the edge) piecewise linearly. Vertices that
    /// come too close to others to be distinguished are left out.
    pub fn shift(&mut self, edge: usize, from: f64, to: f64, fixed: &[f64]) {
        let pieces = &mut self.edges[edge];
        let there = |p: &Piece| (p.start - from).abs() < SAME_PLACE;
        let Some(i) = pieces.iter().position(there).filter(|&i| i > 0) else { return };
        let from = pieces[i].start;
        if -0.3 * pieces[i - 1].length() < to - from && to - from < 0.3 * pieces[i].length() {
            (pieces[i - 1].end, pieces[i].start) = (to, to);
            join_short(pieces, to, fixed);
            return;
        }
        let before = fixed.iter().copied().filter(|f| *f < from - SAME_PLACE).fold(0.0, f64::max);
        let after = fixed.iter().copied().filter(|f| *f > from + SAME_PLACE).fold(1.0, f64::min);
        let map = |s: f64| match s {
            _ if s < before + SAME_PLACE || s > after - SAME_PLACE => s,
            _ if s == from => to,
            _ if s < from => to - (from - s) * ((to - before) / (from - before)),
            _ => to + (s - from) * ((after - to) / (after - from)),
        };
        for piece in pieces.iter_mut() {
            (piece.start, piece.end) = (map(piece.start), map(piece.end));
        }
        join_short(pieces, to, fixed);
    }

    /// The subdivision after the marked pieces are refined, unmarked. `singular[k]`: parameters of the singular points on
    /// edge k, all of them vertices.
    ///
    /// A piece with a singular point at one end gets degree `tip_degree`, then it is cut at σ times its length from it, the
    /// part at the point keeping the degree, the other one having one more; with singular points at both ends it is
    /// halved. So the degrees become linear in the layer. Elsewhere the degree rises, but a rough piece, and one of
    /// the highest degree, is halved. Where the indicator is far above the smallest marked one, two cuts are made at once.
    ///
    /// Source: Gui and Babuška (1986), part II, for geometric meshes with linear degrees.
    pub fn refined(&self, singular: &[Vec<f64>], grading: &Grading) -> Self {
        let Grading { sigma, tip_degree, max_degree, shortest } = *grading;
        let mut edges = Vec::with_capacity(self.edges.len());
        for (pieces, points) in self.edges.iter().zip(singular) {
            let at = |s: f64| points.iter().any(|p| (p - s).abs() < SAME_PLACE);
            let mut refined = Vec::new();
            for piece in pieces {
                let Piece { start, end, degree, .. } = *piece;
                let Mark::Refine { rough, excess, degrees } = piece.mark else {
                    refined.push(*piece);
                    continue;
                };
                let divisible = piece.length() >= shortest;
                let raised = |by: usize| (degree + by).min(max_degree).max(degree);
                let new = |start: f64, end: f64, degree: usize| Piece { start, end, degree, mark: Mark::Keep };
                let halves = [new(start, piece.middle(), degree), new(piece.middle(), end, degree)];
                match (at(start), at(end)) {
                    (a, b) if (a || b) && (degree < tip_degree || !divisible) => {
                        refined.push(new(start, end, raised(1)));
                    }
                    (true, true) => refined.extend(halves),
                    (false, false) if divisible && (rough || degree >= max_degree) => refined.extend(halves),
                    (false, false) => refined.push(new(start, end, raised(degrees))),
                    (at_start, _) => {
                        let layers = if excess >= sigma.powf(-TWO_LAYERS) { 2 } else { 1 };
                        let cut = |layer: i32| match (layer, at_start) {
                            (0, true) => start,
                            (0, false) => end,
                            (_, true) => start + piece.length() * sigma.powi(layers + 1 - layer),
                            (_, false) => end - piece.length() * sigma.powi(layers + 1 - layer),
                        };
                        let mut parts: Vec<Piece> = (0..=layers)
                            .map(|j| {
                                let degree = raised(j as usize);
                                let last = j == layers;
                                match at_start {
                                    true => new(cut(j), if last { end } else { cut(j + 1) }, degree),
                                    false => new(if last { start } else { cut(j + 1) }, cut(j), degree),
                                }
                            })
                            .collect();
                        if !at_start {
                            parts.reverse();
                        }
                        refined.extend(parts);
                    }
                }
            }
            edges.push(refined);
        }
        Self { edges }
    }

    /// [`Self::refined`] without singular points: smooth marked pieces get a higher degree, rough ones are halved.
    pub fn refined_by_mark(&self, grading: &Grading) -> Self {
        self.refined(&vec![Vec::new(); self.edges.len()], grading)
    }
}

/// A piece as parts that are admissible as elements.
fn admissible(edge: &Edge, piece: Piece) -> Vec<Piece> {
    let cuts = edge.needed_cuts([piece.start, piece.end], SHORTEST);
    let ends: Vec<f64> = [piece.start].into_iter().chain(cuts).chain([piece.end]).collect();
    ends.windows(2).map(|s| Piece { start: s[0], end: s[1], ..piece }).collect()
}

/// Joins pieces that are too short to distinguish their ends with a neighbour; never removes `kept` or a vertex of `fixed`.
fn join_short(pieces: &mut Vec<Piece>, kept: f64, fixed: &[f64]) {
    let goes = |v: f64| v != kept && fixed.iter().all(|f| (f - v).abs() >= SAME_PLACE);
    let mut i = 1;
    while i < pieces.len() {
        let [a, b] = [pieces[i - 1], pieces[i]];
        if a.length().min(b.length()) < SHORTEST && goes(b.start) {
            let mark = if a.mark == Mark::Keep { b.mark } else { a.mark };
            pieces[i - 1] = Piece { start: a.start, end: b.end, degree: a.degree.max(b.degree), mark };
            pieces.remove(i);
        } else {
            i += 1;
        }
    }
}
