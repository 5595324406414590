//! Where sides of different bodies see one another: along the normals of those that carry the multipliers.
//!
//! A point x of the carrying sides, with normal n, sees π(x) = x + d n on the others, the nearest one whose normal turns against n;
//! d is the distance, negative where the bodies overlap. What is farther away than the reach is not seen.

use std::sync::{Mutex, PoisonError};

use steklov_bem_operators::Edge;

use super::{Interface, Law, Other, Problem};

/// Sides see each other where n·n' is below this.
const FACING: f64 = -0.2;
/// Part of the diameter of the smaller body up to which sides in contact see each other.
const REACH: f64 = 0.05;
/// The same for sides that are tied, which meet.
const TOUCHING: f64 = 1e-9;
/// A point closer to an end of an edge is there (edge parameter).
const NEAR_END: f64 = 1e-9;
/// Parts of an edge between which it is asked what is seen.
const PARTS: usize = 64;
/// Edge parameters closer than this are one.
const SAME: f64 = 1e-11;

/// Spans that are known, by the sides of their interface and what these face.
#[derive(Debug, Default)]
pub struct KnownSpans(Mutex<Vec<(Met, Vec<Span>)>>);

/// The sides of an interface, and those that they face.
type Met = [Vec<usize>; 2];

/// A copy knows nothing: its outline may be another one.
impl Clone for KnownSpans {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// What a point of one side sees on another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// The edge.
    pub edge: usize,
    /// Its parameter there.
    pub s: f64,
    /// Distance along the normal (length), negative where the bodies overlap.
    pub distance: f64,
}

/// A part of an edge that sees another side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// The edge.
    pub edge: usize,
    /// Its part, s rising.
    pub s: [f64; 2],
}

impl Problem {
    /// The sides that an interface meets; none of an obstacle or a medium.
    pub fn facing_sides<'a>(&self, interface: &'a Interface) -> &'a [usize] {
        if let Other::Sides(sides) = &interface.other { sides } else { &[] }
    }

    /// The interfaces between sides of bodies.
    pub fn joints(&self) -> impl Iterator<Item = &Interface> {
        self.interfaces.iter().filter(|interface| matches!(interface.other, Other::Sides(_)))
    }

    /// The interface whose multipliers a side carries, between sides of bodies.
    pub fn joint(&self, side: usize) -> Option<&Interface> {
        self.joints().find(|interface| interface.sides.contains(&side))
    }

    /// The edges on both sides of cuts: the same line in both directions.
    pub fn cut_edges(&self) -> Vec<[usize; 2]> {
        let edges = self.outline.edges();
        let of = |interface: &Interface| {
            let facing = self.facing_sides(interface).to_vec();
            let beyond = move |k: usize| {
                let same = |m: &usize| edges[*m].start == edges[k].end && edges[*m].end == edges[k].start;
                (0..edges.len()).filter(|&m| facing.contains(&edges[m].side)).find(same).map(|m| [k, m])
            };
            self.edges_of(&interface.sides).map(|(k, _)| k).filter_map(beyond).collect::<Vec<_>>()
        };
        self.joints().filter(|interface| interface.cut).flat_map(of).collect()
    }

    fn edges_of<'a>(&'a self, sides: &'a [usize]) -> impl Iterator<Item = (usize, &'a Edge)> {
        self.outline.edges().iter().enumerate().filter(|(_, edge)| sides.contains(&edge.side))
    }

    /// Distance up to which the sides of an interface see each other.
    pub fn reach(&self, interface: &Interface) -> f64 {
        let of = |side: usize| self.extent(self.body_of_side(side));
        let sides = interface.sides.iter().chain(self.facing_sides(interface));
        let smaller = sides.map(|&side| of(side)).fold(f64::INFINITY, f64::min);
        match interface.law {
            Law::Tied(_) => TOUCHING.max(4e-15 * self.farthest() / smaller) * smaller,
            Law::Contact(_) => REACH * smaller,
        }
    }

    /// E* of the body of an edge, E/(1-ν²); where it is in contact with another body both give way: 1/E* is the sum of both.
    pub fn contact_modulus(&self, edge: usize) -> f64 {
        let side = self.outline.edges()[edge].side;
        let of = |side: usize| self.bodies[self.body_of_side(side)].material().plane_modulus();
        match self.joint(side).and_then(|interface| self.facing_sides(interface).first()) {
            Some(&other) => 1.0 / (1.0 / of(side) + 1.0 / of(other)),
            None => of(side),
        }
    }

    /// Points of edges that belong together across interfaces are added to both: those of one side where the other one sees
    /// them, and the ends of what is seen.
    pub fn share_points(&self, points: &mut [Vec<f64>]) {
        for interface in self.joints() {
            let spans = self.spans(interface);
            for span in &spans {
                points[span.edge].extend(span.s.into_iter().filter(|&s| !self.goes_on(&spans, span.edge, s)));
            }
            let facing: Vec<usize> = self.edges_of(self.facing_sides(interface)).map(|(k, _)| k).collect();
            for &k in &facing {
                for s in points[k].clone() {
                    for (own, foot) in self.seen_from(interface, k, s) {
                        points[own].push(foot);
                    }
                }
            }
            for span in &spans {
                let [a, b] = span.s;
                // at the ends of a span rounding decides whether anything is seen
                let inset = 1e-13 * (b - a);
                for s in points[span.edge].clone().into_iter().filter(|s| a <= *s && *s <= b) {
                    if let Some(seen) = self.seen(interface, span.edge, s.clamp(a + inset, b - inset)) {
                        let s = if seen.s < NEAR_END {
                            0.0
                        } else if seen.s > 1.0 - NEAR_END {
                            1.0
                        } else {
                            seen.s
                        };
                        points[seen.edge].push(s);
                    }
                }
            }
        }
        for points in points {
            points.sort_by(f64::total_cmp);
            points.dedup_by(|b, a| *b - *a < NEAR_END);
        }
    }

    /// Whether a span that ends at this end of its edge goes on along the next edge.
    fn goes_on(&self, spans: &[Span], edge: usize, s: f64) -> bool {
        if s != 0.0 && s != 1.0 {
            return false;
        }
        let (next, rising) = self.outline.neighbour(edge, s == 1.0);
        let start = if rising { 0.0 } else { 1.0 };
        spans.iter().any(|span| span.edge == next && span.s.contains(&start))
    }

    /// Largest coordinate.
    fn farthest(&self) -> f64 {
        self.outline.edges().iter().flat_map(|edge| edge.start).fold(0.0, |m: f64, x| m.max(x.abs()))
    }

    /// Diagonal of the box about the boundary of a body.
    pub fn extent(&self, body: usize) -> f64 {
        let Some(loops) = self.outline.bodies().get(body) else { return 0.0 };
        let edges = loops.clone().flat_map(|l| &self.outline.edges()[self.outline.loops()[l].clone()]);
        let points: Vec<[f64; 2]> = edges.flat_map(Edge::extent).collect();
        let width = |i: usize| {
            let of = points.iter().map(|x| x[i]);
            of.clone().fold(f64::NEG_INFINITY, f64::max) - of.fold(f64::INFINITY, f64::min)
        };
        width(0).hypot(width(1))
    }

    /// What a point of a carrying edge of an interface sees; nothing where no side is near.
    pub fn seen(&self, interface: &Interface, edge: usize, s: f64) -> Option<Seen> {
        let own = &self.outline.edges()[edge];
        let (x, tangent) = (own.point(s), own.tangent(s));
        let n = [tangent[1], -tangent[0]];
        let reach = self.reach(interface);
        let of_edge = |(k, other): (usize, &Edge)| {
            let facing = |&(s, distance): &(f64, f64)| {
                let t = other.tangent(s);
                n[0] * t[1] - n[1] * t[0] < FACING && distance.abs() <= reach
            };
            let hits = other.met_by(x, n).into_iter().filter(facing);
            hits.map(move |(s, distance)| Seen { edge: k, s, distance }).collect::<Vec<_>>()
        };
        let all = self.edges_of(self.facing_sides(interface)).flat_map(of_edge);
        all.min_by(|a, b| a.distance.abs().total_cmp(&b.distance.abs()))
    }

    /// The points of carrying edges that see a point of a facing one: edges and parameters.
    pub fn seen_from(&self, interface: &Interface, edge: usize, s: f64) -> Vec<(usize, f64)> {
        let x = self.outline.edges()[edge].point(s);
        let sees = |&(k, foot): &(usize, f64)| {
            let at = self.seen(interface, k, foot).map(|seen| self.outline.edges()[seen.edge].point(seen.s));
            at.is_some_and(|y| (y[0] - x[0]).hypot(y[1] - x[1]) <= 1e-9 * self.outline.diameter())
        };
        let own = self.edges_of(&interface.sides);
        own.flat_map(|(k, own)| own.feet(x).into_iter().map(move |foot| (k, foot))).filter(sees).collect()
    }

    /// The parts of the carrying edges of an interface that see other sides.
    pub fn spans(&self, interface: &Interface) -> Vec<Span> {
        let mut known = self.known_spans.0.lock().unwrap_or_else(PoisonError::into_inner);
        let key = [interface.sides.clone(), self.facing_sides(interface).to_vec()];
        if let Some((_, spans)) = known.iter().find(|(of, _)| *of == key) {
            return spans.clone();
        }
        let spans = self.find_spans(interface);
        known.push((key, spans.clone()));
        spans
    }

    fn find_spans(&self, interface: &Interface) -> Vec<Span> {
        let corners: Vec<[f64; 2]> =
            self.edges_of(self.facing_sides(interface)).flat_map(|(_, edge)| [edge.start, edge.end]).collect();
        let of_edge = |(k, own): (usize, &Edge)| {
            let mut points: Vec<f64> = (0..=PARTS).map(|i| i as f64 / PARTS as f64).collect();
            points.extend(corners.iter().flat_map(|&corner| own.feet(corner)));
            points.sort_by(f64::total_cmp);
            points.dedup_by(|b, a| *b - *a < SAME);
            let sees = |s: f64| self.seen(interface, k, s).is_some();
            let mut spans: Vec<[f64; 2]> = Vec::new();
            for part in points.windows(2) {
                let inset = 1e-6 * (part[1] - part[0]);
                let [a, b] = [part[0] + inset, part[1] - inset];
                let span = match [sees(a), sees(b)] {
                    [false, false] => continue,
                    [true, true] => [part[0], part[1]],
                    [true, false] => [part[0], change(a, b, &sees)],
                    [false, true] => [change(b, a, &sees), part[1]],
                };
                match spans.last_mut().filter(|last| span[0] - last[1] < SAME) {
                    Some(last) => last[1] = span[1],
                    None => spans.push(span),
                }
            }
            spans.into_iter().map(move |s| Span { edge: k, s }).collect::<Vec<_>>()
        };
        self.edges_of(&interface.sides).flat_map(of_edge).collect()
    }
}

/// Where `sees` changes from true at one parameter to false at another.
fn change(mut seeing: f64, mut blind: f64, sees: &dyn Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = (seeing + blind) / 2.0;
        if sees(middle) { seeing = middle } else { blind = middle }
    }
    seeing
}

/// Bodies whose moduli are not farther apart than this factor are about as stiff.
const ALIKE: f64 = 2.0;
/// How far inside of its boundary a body is looked at, in parts of its extent.
const INSET: f64 = 1e-4;
/// Part of the diameter of a body by which bodies may overlap as they are drawn.
const OVERLAP: f64 = 1e-6;
/// Points of an edge at which it is asked whether it lies in another body.
const LOOKS: usize = 128;

impl Problem {
    /// Whether the carrying sides of the first of two mirrored interfaces carry the multipliers rather than those of the second:
    /// those of the softer body, whose mesh resolves what happens; of bodies about as stiff those that are wholly covered, else
    /// the first. On the coarse mesh of a stiff body multipliers would be too few to hold a soft one.
    pub fn carries_rather(&self, first: &Interface, second: &Interface) -> bool {
        let covered = |interface: &Interface| {
            let spans: f64 = self
                .spans(interface)
                .iter()
                .map(|span| (span.s[1] - span.s[0]) * self.outline.edges()[span.edge].length())
                .sum();
            let whole: f64 = self.edges_of(&interface.sides).map(|(_, edge)| edge.length()).sum();
            spans > (1.0 - 1e-9) * whole
        };
        let modulus =
            |interface: &Interface| self.bodies[self.body_of_side(interface.sides[0])].material().plane_modulus();
        let ratio = modulus(first) / modulus(second);
        if !(1.0 / ALIKE..=ALIKE).contains(&ratio) {
            return ratio < 1.0;
        }
        match (covered(first), covered(second)) {
            (true, false) => true,
            (false, true) => false,
            _ if matches!(first.law, Law::Tied(_)) => true,
            _ => ratio <= 1.0,
        }
    }

    /// Whether the sides of an interface see each other, and tied ones meet.
    ///
    /// # Errors
    /// What is wrong, and what to do.
    pub fn check_facing(&self, interface: &Interface, is_tied: bool) -> Result<(), (String, &'static str)> {
        if !self.spans(interface).is_empty() {
            return Ok(());
        }
        let names = |sides: &[usize]| sides.iter().map(|&s| self.sides[s].name.as_str()).collect::<Vec<_>>().join(", ");
        let between = format!("{} and {}", names(&interface.sides), names(self.facing_sides(interface)));
        let mut least = f64::INFINITY;
        for (_, own) in self.edges_of(&interface.sides) {
            for k in 0..=LOOKS {
                let x = own.point(k as f64 / LOOKS as f64);
                for (_, other) in self.edges_of(self.facing_sides(interface)) {
                    least = other.nearest(x, least).map_or(least, |(distance, _)| distance);
                }
            }
        }
        let reach = self.reach(interface);
        Err(match is_tied {
            _ if least <= reach => (
                format!("the sides {between} do not face each other: their normals do not point at one another"),
                "name the sides that meet; the body lies to the left of its corners as they are listed",
            ),
            true => (
                format!("the sides {between} are tied but {least:e} apart"),
                "move the bodies together, or write the distance as a displacement_jump of sides that meet",
            ),
            false => (
                format!(
                    "the sides {between} are {least:e} apart, which is more than {reach:e}, 5 % of the smaller body"
                ),
                "move the bodies together and write the rest as contact.gap",
            ),
        })
    }

    /// Whether bodies overlap as they are drawn.
    ///
    /// # Errors
    /// What is wrong: the two bodies, a point and how deep it lies.
    pub fn check_overlaps(&self) -> Result<(), (String, &'static str)> {
        let bodies = self.outline.bodies();
        for (a, loops) in bodies.iter().enumerate() {
            for edge in loops.clone().flat_map(|l| &self.outline.edges()[self.outline.loops()[l].clone()]) {
                for k in 0..2 * LOOKS {
                    // on the boundary, and a little inside: bodies may share all of their boundaries
                    let s = (k / 2) as f64 / LOOKS as f64 + 0.5 / LOOKS as f64;
                    let (mut x, t) = (edge.point(s), edge.tangent(s));
                    if k % 2 == 1 {
                        let inset = INSET * self.extent(a);
                        x = [x[0] - inset * t[1], x[1] + inset * t[0]];
                        if !self.outline.is_in_body(a, x) {
                            continue;
                        }
                    }
                    for (b, other) in bodies.iter().enumerate().filter(|(b, _)| *b != a) {
                        if !self.outline.is_in_body(b, x) {
                            continue;
                        }
                        let boundary =
                            other.clone().flat_map(|l| &self.outline.edges()[self.outline.loops()[l].clone()]);
                        let depth = boundary.fold(f64::INFINITY, |least, edge| {
                            edge.nearest(x, least).map_or(least, |(distance, _)| distance)
                        });
                        if depth > OVERLAP * self.extent(b).min(self.extent(a)) {
                            let (a, b) = (&self.bodies[a].name, &self.bodies[b].name);
                            return Err((
                                format!(
                                    "the point ({}, {}) of body {a:?} lies {depth:e} deep in body {b:?}",
                                    x[0], x[1]
                                ),
                                "draw bodies that touch, and write an interference as a negative contact.gap",
                            ));
                        }
                    }
                }
            }
        }
        Ok(())
    }
}
