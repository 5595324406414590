//! Where to cut a body into subdomains: recursive bisection by predicted cost.
//!
//! ```text
//! dense, a region of n unknowns, n_I of them its own and n_B on cuts:   2.33 n³ + n_I³/3 + n_I² n_B + n_I n_B²
//! skeleton, m unknowns of a new cut in a region with b on earlier ones: m³/3 + m² b + m b²
//! ```
//! A line is taken where the sum is smallest, if all that follows from it gains enough. It may pass through holes: each part of
//! it between two crossings of the boundary is a cut, whose ends stay away from corners, grazing hits and short edges. Elements
//! of cuts are halved until a displacement, analytic up to the singular points, is approximated like ρ^-p with ρ from 2.5 on.
//! Those are the points at which the solution is singular, and circles inside of holes, up to which it continues.
//!
//! Source: George (1973) for nested dissection; Hsiao, Steinbach and Wendland (2000) for subdomains.

use std::cell::RefCell;
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI};

use steklov_elastic::plane::{cross, distance, dot, minus};

use crate::continuation::{Continuation, RHO};
use crate::cut::{Arrangement, Part};
use crate::cut_lines::{Row, at_holes, extent, lattice};
use crate::edge::complex;
use crate::subdomains::in_order;
use crate::{Curve, Cut, Edge, Polygon, Segment};

/// Floating point operations per second of dense matrices and of the skeleton, and seconds of a pair of elements: one core. Only
/// their ratios matter.
const DENSE: f64 = 40e9;
const SKELETON: f64 = 8e9;
const PAIR: f64 = 8e-6;
/// Predicted seconds below which a region is not cut.
const LEAST: f64 = 1e-3;
/// A cut may cost this part more than its region: a first cut alone often gains nothing.
const HOPE: f64 = 1.1;
/// It is undone if all that follows from it costs more than this part.
const GAIN: f64 = 0.85;
/// How many of the lines of a region are cut and costed exactly.
const TRIED: usize = 8;
/// Depth of the bisection at most.
const DEEPEST: usize = 12;
/// Directions of lines.
pub(crate) const DIRECTIONS: usize = 8;
/// Extremes of holes that differ by less than this part of a region are one.
const SAME_OFFSET: f64 = 1e-6;
/// Halvings of an element at most.
const HALVINGS: usize = 8;
/// Sine of the smallest angle between cuts and the boundary.
pub(crate) const STEEP: f64 = 0.5;
/// Distances over the pitch: of an end from those of its edge, for edges of length 1 and more; of an edge that counts as longer
/// than it is; the shortest cut; of vertices from cuts. Over the radius: of arcs that are not crossed.
const CLEAR: f64 = 0.12;
const SHORT_EDGE: f64 = 0.3;
const SHORTEST: f64 = 0.04;
const VERTEX: f64 = 0.05;
const ARC: f64 = 0.15;
/// Points closer than this part of the pitch are one, edges whose tangents differ by less go on smoothly.
pub(crate) const SAME: f64 = 1e-9;
const SMOOTH: f64 = 1e-6;

/// What decides where a body is cut.
#[derive(Debug, Clone, PartialEq)]
pub struct CutRules {
    /// How far the solution continues.
    pub continuation: Continuation,
    /// Corners to which meshes are graded.
    pub graded: Vec<[f64; 2]>,
    /// Sides on which cuts may end at valleys only.
    pub kept: Vec<usize>,
    /// The points of these sides at which cuts may end: valleys between asperities.
    pub valleys: Vec<[f64; 2]>,
    /// The points of these sides at which asperities are: meshes are graded to both ends of contact there.
    pub peaks: Vec<[f64; 2]>,
    /// Degrees that elements of cuts, arcs and straight edges will have.
    pub degrees: [usize; 3],
    /// Unknowns of an edge beside a corner to which meshes are graded.
    pub of_corner: usize,
}

/// Where a body is cut, and what that is expected to gain.
#[derive(Debug, Clone, PartialEq)]
pub struct CutPlan {
    /// The lines.
    pub lines: Vec<[[f64; 2]; 2]>,
    /// Number of subdomains.
    pub subdomains: usize,
    /// Number of those that are no translates of others.
    pub different: usize,
    /// Unknowns of the body without cuts, of the largest subdomain, and of the skeleton.
    pub unknowns: [usize; 3],
    /// Predicted cost of a mesh without cuts and with them (seconds of one core, for their ratio).
    pub cost: [f64; 2],
    /// Bytes of V, K and W of such a mesh without cuts, and with them and the fronts of the skeleton.
    pub bytes: [f64; 2],
}

/// Whether an edge parameter is that of an end.
fn is_end(s: f64) -> bool {
    s == 0.0 || s == 1.0
}

/// A straight part of a cut.
fn straight([a, b]: [[f64; 2]; 2]) -> Curve {
    Curve::Line(Segment { start: complex(a), end: complex(b) })
}

impl CutRules {
    /// Places at which a part of a cut is divided: it is halved until each element has ρ from 2.5 on.
    pub fn breaks(&self, ends: [[f64; 2]; 2]) -> Vec<f64> {
        let at = |s: f64| [0, 1].map(|i| ends[0][i] + s * (ends[1][i] - ends[0][i]));
        let (mut stack, mut breaks) = (vec![([0.0, 1.0], 0)], Vec::new());
        while let Some(([a, b], depth)) = stack.pop() {
            if depth == HALVINGS || self.continuation.rho(&straight([at(a), at(b)])) >= RHO {
                breaks.push(b);
                continue;
            }
            let middle = (a + b) / 2.0;
            stack.extend([([middle, b], depth + 1), ([a, middle], depth + 1)]);
        }
        breaks.pop();
        breaks
    }

    /// The degree of the elements of a part of a cut at which its error is below `wanted`.
    pub fn degree(&self, ends: [[f64; 2]; 2], wanted: f64) -> usize {
        self.continuation.degree(&straight(ends), wanted)
    }
}

/// A part of the body that may be cut further.
#[derive(Clone)]
struct Region {
    outline: Polygon,
    /// Of each edge, whether it is a cut.
    is_cut: Vec<bool>,
}

/// A line with its crossings of the boundary: distance along it, edge, edge parameter.
struct Line {
    from: [f64; 2],
    along: [f64; 2],
    crossings: Vec<(f64, usize, f64)>,
    /// Rough cost of cutting along it.
    cost: f64,
}

/// A region cut along a line.
struct Bisection {
    cuts: Vec<[[f64; 2]; 2]>,
    pieces: Vec<Region>,
    /// Predicted seconds: of the unknowns on the cuts, and with those of the pieces as they are.
    of_skeleton: f64,
    cost: f64,
    /// Unknowns on the cuts.
    unknowns: usize,
}

struct Planner<'a> {
    rules: &'a CutRules,
    /// Elements of parts of cuts, by the bits of their ends: each is asked for many times.
    known: RefCell<HashMap<[u64; 4], usize>>,
    /// Length by which distances are judged: 4 area/perimeter, the pitch of a dense plate or the thickness of a long body.
    pitch: f64,
    /// Whether the body has neither holes nor curves.
    is_simple: bool,
}

/// How a region is cut.
#[derive(Clone, Default)]
struct Division {
    lines: Vec<[[f64; 2]; 2]>,
    /// Number of subdomains, and the unknowns of those that are no translates of earlier ones.
    subdomains: usize,
    different: Vec<f64>,
    /// Unknowns on cuts.
    skeleton: usize,
    /// Numbers in the fronts of the skeleton.
    in_fronts: f64,
    /// Predicted seconds of the skeleton, and of the different subdomains.
    of_skeleton: f64,
    dense: f64,
}

impl Division {
    fn cost(&self) -> f64 {
        self.of_skeleton + self.dense
    }

    fn add(&mut self, other: Self) {
        self.lines.extend(other.lines);
        self.subdomains += other.subdomains;
        self.different.extend(other.different);
        self.skeleton += other.skeleton;
        self.in_fronts += other.in_fronts;
        self.of_skeleton += other.of_skeleton;
        self.dense += other.dense;
    }

    /// That of a translate, whose subdomains are there already.
    fn moved(&self, by: [f64; 2]) -> Self {
        let moved = |x: [f64; 2]| [x[0] + by[0], x[1] + by[1]];
        let lines = self.lines.iter().map(|ends| ends.map(moved)).collect();
        Self { lines, different: Vec::new(), dense: 0.0, ..self.clone() }
    }
}

impl Polygon {
    /// The plan by which a body is best cut into subdomains; no lines where that gains nothing.
    ///
    /// # Panics
    /// If there are several bodies, or one that is unbounded.
    pub fn plan_cuts(&self, rules: &CutRules) -> CutPlan {
        let perimeter: f64 = self.edges().iter().map(Edge::length).sum();
        let pitch = 4.0 * self.area().abs() / perimeter;
        let is_simple = self.loops().len() == 1 && self.edges().iter().all(Edge::is_line);
        let planner = Planner { rules, known: RefCell::default(), pitch, is_simple };
        let region = Region { outline: self.clone(), is_cut: vec![false; self.edges().len()] };
        let along = |rows: &[Row]| planner.divided(&region, rows, &mut Vec::new(), 0);
        let rows = lattice(self, pitch);
        let aligned = (!rows.is_empty()).then(|| along(&rows));
        // where many are equal, no other lines cost less
        let has_many_equal = |aligned: &Division| 2 * aligned.different.len() <= aligned.subdomains;
        let best = match aligned {
            Some(aligned) if has_many_equal(&aligned) => aligned,
            other => {
                other.into_iter().chain([along(&[])]).min_by(|a, b| a.cost().total_cmp(&b.cost())).unwrap_or_default()
            }
        };
        let unknowns = planner.counts(&region)[0];
        let bytes = |sizes: &[f64]| 24.0 * sizes.iter().map(|n| n * n).sum::<f64>();
        CutPlan {
            subdomains: best.subdomains,
            different: best.different.len(),
            unknowns: [
                unknowns as usize,
                best.different.iter().fold(0.0, |a: f64, b| a.max(*b)) as usize,
                best.skeleton,
            ],
            cost: [planner.dense(&region), best.cost()],
            bytes: [bytes(&[unknowns]), bytes(&best.different) + 8.0 * best.in_fronts],
            lines: best.lines,
        }
    }
}

impl Planner<'_> {
    /// Elements of a part of a cut.
    fn elements(&self, [a, b]: [[f64; 2]; 2]) -> usize {
        // both directions have the same
        let [a, b] = if a < b { [a, b] } else { [b, a] };
        let key = [a[0], a[1], b[0], b[1]].map(f64::to_bits);
        *self.known.borrow_mut().entry(key).or_insert_with(|| self.rules.breaks([a, b]).len() + 1)
    }

    /// Unknowns and elements of an edge.
    fn of_edge(&self, edge: &Edge, is_cut: bool) -> [f64; 2] {
        let [of_cuts, of_arcs, straight] = self.rules.degrees.map(|p| 2.0 * p as f64);
        if is_cut {
            let n = self.elements([edge.start, edge.end]) as f64;
            return [of_cuts * n, n];
        }
        if !edge.is_line() {
            let n = (edge.turning() / FRAC_PI_2 - 1e-9).ceil().max(1.0);
            return [of_arcs * n, n];
        }
        let at_ends = [edge.start, edge.end].into_iter().filter(|x| self.rules.graded.contains(x)).count();
        let peaks = self.rules.peaks.iter().filter(|x| self.is_on_kept(edge, **x)).count();
        let corners = (at_ends + 2 * peaks) as f64;
        let pitches = (edge.length() / self.pitch).max(1.0);
        // beside holes the solution varies all along an edge, without them only near its ends
        let n = if self.is_simple { 1.0 + 2.0 * pitches.log2() } else { pitches };
        let n = (n - 1e-9).ceil();
        [corners * self.rules.of_corner as f64 + straight * n, n + 5.0 * corners]
    }

    /// Whether a point is on an edge of a side on which cuts end at valleys only.
    fn is_on_kept(&self, edge: &Edge, x: [f64; 2]) -> bool {
        self.rules.kept.contains(&edge.side) && edge.nearest(x, SAME * self.pitch).is_some()
    }

    /// Unknowns, elements, and unknowns on cuts.
    fn counts(&self, region: &Region) -> [f64; 3] {
        let edges = region.outline.edges().iter().zip(&region.is_cut);
        edges.fold([0.0; 3], |[n, m, cut], (edge, &is_cut)| {
            let [own, elements] = self.of_edge(edge, is_cut);
            [n + own, m + elements, cut + if is_cut { own } else { 0.0 }]
        })
    }

    /// Predicted seconds of a region as it is.
    fn dense(&self, region: &Region) -> f64 {
        let [n, m, cut] = self.counts(region);
        let own = n - cut;
        let flops = 2.33 * n.powi(3) + own.powi(3) / 3.0 + own * own * cut + own * cut * cut;
        flops / DENSE + PAIR * m * m / 2.0
    }

    /// The best division of a region: along the lines of a lattice as long as these pay, then along any. `done` are the regions
    /// that were divided before: their translates are divided alike.
    fn divided(&self, region: &Region, lattice: &[Row], done: &mut Vec<(Region, Division)>, depth: usize) -> Division {
        for (before, division) in done.iter() {
            if let Some(by) = self.shift(before, region) {
                return division.moved(by);
            }
        }
        let alone = self.dense(region);
        let whole =
            Division { subdomains: 1, different: vec![self.counts(region)[0]], dense: alone, ..Division::default() };
        let earlier = done.len();
        let division = match self.bisected(region, lattice, alone, depth) {
            Some(Bisection { cuts, pieces, of_skeleton, unknowns, .. }) => {
                let in_fronts = (unknowns as f64 + self.counts(region)[2]).powi(2);
                let mut division =
                    Division { lines: cuts, skeleton: unknowns, in_fronts, of_skeleton, ..Division::default() };
                pieces.iter().for_each(|piece| division.add(self.divided(piece, lattice, done, depth + 1)));
                division
            }
            None => whole.clone(),
        };
        let best = if division.subdomains > 1 && division.cost() > GAIN * alone {
            done.truncate(earlier);
            whole
        } else {
            division
        };
        done.push((region.clone(), best.clone()));
        best
    }

    fn bisected(&self, region: &Region, lattice: &[Row], alone: f64, depth: usize) -> Option<Bisection> {
        if depth == DEEPEST || alone < LEAST {
            return None;
        }
        let along_lattice = || self.best(region, self.candidates(region, lattice), alone);
        let free = || self.best(region, self.candidates(region, &self.directions(&region.outline)), alone);
        (!lattice.is_empty()).then(along_lattice).flatten().or_else(free)
    }

    /// Lines in equally spaced directions: equally spaced ones, those at holes, and those through valleys.
    fn directions(&self, outline: &Polygon) -> Vec<Row> {
        let row = |k: usize| {
            let (sin, cos) = (PI * k as f64 / DIRECTIONS as f64).sin_cos();
            let equal = if k.is_multiple_of(4) { 24 } else { 13 };
            let across = [-sin, cos];
            let (edges, loops) = (outline.edges(), outline.loops());
            let [low, high] = extent(across, &edges[loops[0].clone()]);
            let holes: Vec<&[Edge]> = loops[1..].iter().map(|one| &edges[one.clone()]).collect();
            let at_holes = at_holes(across, &holes, SAME_OFFSET * (high - low));
            let at = |k: usize| low + (high - low) * k as f64 / (equal + 1) as f64;
            let at_valleys = self.rules.valleys.iter().map(|x| dot(across, *x)).filter(|x| low < *x && *x < high);
            Row { along: [cos, sin], offsets: (1..=equal).map(at).chain(at_holes).chain(at_valleys).collect() }
        };
        (0..DIRECTIONS).map(row).collect()
    }

    /// The vector by which a region is another one moved, with as many elements.
    fn shift(&self, region: &Region, other: &Region) -> Option<[f64; 2]> {
        let (a, b) = (region.outline.edges(), other.outline.edges());
        if a.len() != b.len() || region.is_cut != other.is_cut || region.outline.loops() != other.outline.loops() {
            return None;
        }
        let by = minus(b[0].start, a[0].start);
        let near = SAME * self.pitch;
        let is_moved = |x: [f64; 2], y: [f64; 2]| distance(minus(y, x), by) <= near;
        let same = |((a, b), &is_cut): ((&Edge, &Edge), &bool)| {
            is_moved(a.start, b.start)
                && is_moved(a.end, b.end)
                && is_moved(a.point(0.3), b.point(0.3))
                && self.of_edge(a, is_cut) == self.of_edge(b, is_cut)
        };
        a.iter().zip(b).zip(&region.is_cut).all(same).then_some(by)
    }

    /// The cuts of the best line and what they make of a region.
    fn best(&self, region: &Region, mut lines: Vec<Line>, alone: f64) -> Option<Bisection> {
        let on_cuts = self.counts(region)[2];
        lines.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let mut best: Option<Bisection> = None;
        let mut tried = 0;
        for line in lines {
            if tried == TRIED || best.as_ref().is_some_and(|best| line.cost > 1.3 * best.cost) {
                break;
            }
            let Some(cuts) = self.admissible(region, &line) else { continue };
            tried += 1;
            let Some(pieces) = cut_along(region, &cuts).filter(|pieces| pieces.len() > 1) else { continue };
            let elements: usize = cuts.iter().map(|ends| self.elements(*ends)).sum();
            let m = (2 * self.rules.degrees[0] * elements) as f64;
            let of_skeleton = of_skeleton(m, on_cuts);
            let cost = of_skeleton + pieces.iter().map(|piece| self.dense(piece)).sum::<f64>();
            if best.as_ref().is_none_or(|best| cost < best.cost) {
                best = Some(Bisection { cost, cuts, pieces, of_skeleton, unknowns: m as usize });
            }
        }
        best.filter(|best| best.cost <= HOPE * alone)
    }

    /// Lines that cross the boundary steeply, with rough costs: by the unknowns on both sides, and a guess of those of the cuts.
    fn candidates(&self, region: &Region, rows: &[Row]) -> Vec<Line> {
        let (edges, on_cuts) = (region.outline.edges(), self.counts(region)[2]);
        let middles: Vec<([f64; 2], f64)> = edges
            .iter()
            .zip(&region.is_cut)
            .map(|(edge, &is_cut)| (edge.point(0.5), self.of_edge(edge, is_cut)[0]))
            .collect();
        let degree = 2.0 * self.rules.degrees[0] as f64;
        let mut lines = Vec::new();
        for &Row { along, ref offsets } in rows {
            let across = [-along[1], along[0]];
            let reached: Vec<[f64; 2]> = edges
                .iter()
                .map(|edge| {
                    let [a, b] = [edge.start, edge.end].map(|x| dot(across, x));
                    let slack = edge.deviation(0.0, 1.0) + SAME * self.pitch;
                    [a.min(b) - slack, a.max(b) + slack]
                })
                .collect();
            for &offset in offsets {
                let from = across.map(|c| c * offset);
                let mut crossings: Vec<(f64, usize, f64)> = Vec::new();
                let is_reached = |e: &usize| reached[*e][0] <= offset && offset <= reached[*e][1];
                for e in (0..edges.len()).filter(is_reached) {
                    crossings.extend(edges[e].met_by(from, along).into_iter().map(|(s, d)| (d, e, s)));
                }
                crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
                crossings.dedup_by(|b, a| self.is_one_crossing(edges, *a, *b));
                let steep = |&(_, e, s): &(f64, usize, f64)| cross(along, edges[e].tangent(s)).abs() >= STEEP;
                if crossings.len() < 2 || !crossings.len().is_multiple_of(2) || !crossings.iter().all(steep) {
                    continue;
                }
                let guess = |pair: &[(f64, usize, f64)]| ((pair[1].0 - pair[0].0) / (0.5 * self.pitch)).ceil().max(1.0);
                let m = degree * crossings.chunks_exact(2).map(guess).sum::<f64>();
                let beyond = |left: bool| -> f64 {
                    let on_side = middles.iter().filter(|(x, _)| (dot(across, *x) > offset) == left);
                    m + on_side.map(|(_, unknowns)| unknowns).sum::<f64>()
                };
                let dense = 2.66 * (beyond(true).powi(3) + beyond(false).powi(3)) / DENSE;
                lines.push(Line { from, along, crossings, cost: dense + of_skeleton(m, on_cuts) });
            }
        }
        lines
    }

    /// Whether two crossings of a line are one, at a vertex where two edges go on smoothly.
    fn is_one_crossing(&self, edges: &[Edge], a: (f64, usize, f64), b: (f64, usize, f64)) -> bool {
        (b.0 - a.0).abs() < SAME * self.pitch && is_end(a.2) && is_end(b.2) && self.joint(edges, a.1, a.2) == Some(b.1)
    }

    /// The edge that goes on smoothly from an end of an edge.
    fn joint(&self, edges: &[Edge], e: usize, s: f64) -> Option<usize> {
        let (x, tangent) = (edges[e].point(s), edges[e].tangent(s));
        let goes_on = |other: &Edge| {
            let at_end = distance(other.end, x) < SAME * self.pitch;
            let meets = at_end || distance(other.start, x) < SAME * self.pitch;
            let there = if at_end { other.at_end() } else { 1.0 - other.at_end() };
            meets && distance(other.tangent(there), tangent) < SMOOTH
        };
        edges
            .iter()
            .enumerate()
            .position(|(k, other)| k != e && other.loop_index == edges[e].loop_index && goes_on(other))
    }

    /// The cuts of a line, if all of them keep their distances.
    fn admissible(&self, region: &Region, line: &Line) -> Option<Vec<[[f64; 2]; 2]>> {
        let edges = region.outline.edges();
        for &(_, e, s) in &line.crossings {
            let (edge, length) = (&edges[e], edges[e].length() / self.pitch);
            let clearance = CLEAR * length.clamp(SHORT_EDGE, 1.0);
            let at_joint = || is_end(s) && self.joint(edges, e, s).is_some();
            let x = edge.point(s);
            let at_valley = || self.rules.valleys.iter().any(|valley| distance(*valley, x) < SAME * self.pitch);
            if s.min(1.0 - s) * length < clearance && !at_joint()
                || !region.is_cut[e] && self.rules.kept.contains(&edge.side) && !at_valley()
            {
                return None;
            }
        }
        let mut cuts = Vec::new();
        for pair in line.crossings.chunks_exact(2) {
            let cut = [pair[0], pair[1]].map(|(_, e, s)| edges[e].point(s));
            if distance(cut[0], cut[1]) < SHORTEST * self.pitch || self.rules.continuation.rho(&straight(cut)) < 1.02 {
                return None;
            }
            let off = |x: [f64; 2]| {
                let r = minus(x, line.from);
                let (along, across) = (dot(r, line.along), cross(line.along, r).abs());
                across + (pair[0].0 - along).max(along - pair[1].0).max(0.0)
            };
            let is_met = |x: [f64; 2]| cut.iter().any(|end| distance(*end, x) < SAME * self.pitch);
            let near_vertex = || edges.iter().any(|edge| off(edge.start) < VERTEX * self.pitch && !is_met(edge.start));
            let is_crossed = |e: usize| {
                let touched = is_met(edges[e].start) || is_met(edges[e].end);
                touched || line.crossings.iter().any(|&(_, crossed, _)| crossed == e)
            };
            let near_arc = || {
                let arcs = edges.iter().enumerate().filter(|(e, edge)| !edge.is_line() && !is_crossed(*e));
                let mut close = arcs.map(|(_, edge)| {
                    let radius = edge.length() / edge.turning().max(1e-9);
                    (0..=8).any(|k| off(edge.point(k as f64 / 8.0)) < ARC * radius)
                });
                close.any(|near| near)
            };
            if near_vertex() || near_arc() {
                return None;
            }
            cuts.push(cut);
        }
        Some(cuts)
    }
}

/// Seconds of m unknowns of a cut in a region with b on earlier ones.
fn of_skeleton(m: f64, b: f64) -> f64 {
    (m.powi(3) / 3.0 + m * m * b + m * b * b) / SKELETON
}

/// The pieces of a region along cuts.
fn cut_along(region: &Region, cuts: &[[[f64; 2]; 2]]) -> Option<Vec<Region>> {
    let names = region.outline.side_names();
    let sides = [0, 0].map(|side| names[side].clone());
    let cuts: Vec<Cut> = cuts.iter().map(|&ends| Cut { ends, sides: sides.clone() }).collect();
    let Arrangement { halves, mut pieces, .. } = region.outline.arranged(&cuts).ok()?;
    pieces.iter_mut().for_each(|loops| in_order(loops, |h| halves[h].edge.start));
    let region_of = |piece: &Vec<Vec<usize>>| {
        let of_cut = |&h: &usize| match halves[h].of {
            Part::Outline(edge, _) => region.is_cut[edge],
            Part::Line(_) => true,
        };
        let is_cut = piece.iter().flatten().map(of_cut).collect();
        let edges_of = |one: &Vec<usize>| one.iter().map(|&h| halves[h].edge.clone()).collect();
        let outline = region.outline.in_pieces(vec![piece.iter().map(edges_of).collect()], names.to_vec());
        Region { outline, is_cut }
    };
    Some(pieces.iter().map(region_of).collect())
}
