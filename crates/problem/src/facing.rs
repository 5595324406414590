//! Where sides of different bodies see one another.
//!
//! ```text
//! x, with normal n₁, of a carrying side and y, with n₂, of another one are a pair where y - x = g d,
//! d = (E₁n₁ - E₂n₂)/|E₁n₁ - E₂n₂|,  E = E/(1-ν²)
//! ```
//! Surfaces that touch take a shape between their own, nearer to that of the stiffer body: with E₂ = ∞ the normal is that of
//! the partner, with equal bodies the mean of both. Pairs, d and g are the same whichever side carries. g is negative where
//! the bodies overlap as they are drawn; if a point has several pairs, the nearest counts. Beside a corner of the partner
//! points see the corner, whose normal is any one between those of its edges.

use steklov_bem_operators::Edge;
use steklov_elastic::plane::{cross, dot, minus, norm, unit};

use super::spans::Span;
use super::{Faces, Interface, Law, Other, Problem};

/// Sides see each other where n·n' is below this.
const FACING: f64 = -0.2;
/// Part of the diameter of the smaller body below which distances are digits of a file: sides that are tied meet.
const COINCIDE: f64 = 1e-6;
/// A point closer to an end of an edge is there (edge parameter).
const NEAR_END: f64 = 1e-9;
/// Number of parts of an edge between which visibility is tested.
const PARTS: usize = 64;
/// Edge parameters closer than this are one.
pub(super) const SAME: f64 = 1e-11;

/// The point of another side that a point of one side sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// The edge.
    pub edge: usize,
    /// Its parameter there.
    pub s: f64,
    /// Distance along the direction of contact (length), negative where the bodies overlap.
    pub distance: f64,
    /// The direction of contact, a unit vector out of the body that sees.
    pub direction: [f64; 2],
}

impl Problem {
    /// The sides that an interface meets; none for an obstacle or a medium.
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

    /// Whether a side is a cut through a body that is whole there, as beyond the tip of a crack.
    pub fn is_whole_across(&self, side: usize) -> bool {
        let is_tied_cut = |joint: &&Interface| joint.faces == Faces::Cut && matches!(joint.law, Law::Tied(_));
        let mut cuts = self.joints().filter(is_tied_cut);
        cuts.any(|cut| cut.sides.contains(&side) || self.facing_sides(cut).contains(&side))
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
        self.joints().filter(|interface| interface.faces == Faces::Cut).flat_map(of).collect()
    }

    pub(super) fn edges_of<'a>(&'a self, sides: &'a [usize]) -> impl Iterator<Item = (usize, &'a Edge)> {
        self.outline.edges().iter().enumerate().filter(|(_, edge)| sides.contains(&edge.side))
    }

    /// Distances between which the sides of an interface see each other: tied ones meet, others may be anywhere before one another.
    pub fn seen_distances(&self, interface: &Interface) -> [f64; 2] {
        let near = self.coincidence(interface);
        match interface.law {
            Law::Tied(_) => [-near, near],
            Law::Contact(_) => [-10.0 * near, f64::INFINITY],
        }
    }

    /// Distance below which points of both sides of an interface are one: 1e-6 of the smaller body, and the rounding of
    /// coordinates far from the origin.
    pub fn coincidence(&self, interface: &Interface) -> f64 {
        (COINCIDE * self.smaller_diagonal(interface)).max(4e-15 * self.farthest())
    }

    fn smaller_diagonal(&self, interface: &Interface) -> f64 {
        let sides = interface.sides.iter().chain(self.facing_sides(interface));
        sides.map(|&side| self.outline.diagonal_of_body(self.body_of_side(side))).fold(f64::INFINITY, f64::min)
    }

    /// E* of the body of an edge, E/(1-ν²); in contact with another body both deform: 1/E* is the sum of both.
    pub fn contact_modulus(&self, edge: usize) -> f64 {
        let side = self.outline.edges()[edge].side;
        let of = |side: usize| self.bodies[self.body_of_side(side)].material().plane_modulus();
        match self.joint(side).and_then(|interface| self.facing_sides(interface).first()) {
            Some(&other) => 1.0 / (1.0 / of(side) + 1.0 / of(other)),
            None => of(side),
        }
    }

    /// Dundurs' second parameter of the bodies in contact along an edge that carries multipliers, without its sign and unit:
    /// β = |G₂(κ₁-1) - G₁(κ₂-1)| / (G₂(κ₁+1) + G₁(κ₂+1)), beside a rigid obstacle (κ-1)/(κ+1).
    ///
    /// Source: Dundurs (1969), eq. (4).
    pub fn dundurs_beta(&self, edge: usize) -> f64 {
        let side = self.outline.edges()[edge].side;
        let of = |side: usize| {
            let material = self.bodies[self.body_of_side(side)].material();
            (material.mu(), material.kappa())
        };
        let (mu, kappa) = of(side);
        match self.joint(side).and_then(|interface| self.facing_sides(interface).first()) {
            Some(&other) => {
                let (other_mu, other_kappa) = of(other);
                let [difference, sum] = [-1.0, 1.0].map(|one| [other_mu * (kappa + one), mu * (other_kappa + one)]);
                (difference[0] - difference[1]).abs() / (sum[0] + sum[1])
            }
            None => (kappa - 1.0) / (kappa + 1.0),
        }
    }

    /// Adds points of edges that belong together across interfaces to both: those of one side where the other one sees them,
    /// and the ends of the visible parts. A point close to one that is there already, or to a corner, counts as that one.
    pub fn share_points(&self, points: &mut [Vec<f64>]) {
        for interface in self.joints() {
            let add = |points: &mut [Vec<f64>], edge: usize, s: f64| {
                let s = at_end(s);
                if points[edge].iter().all(|p| (p - s).abs() > NEAR_END) {
                    points[edge].push(s);
                }
            };
            let spans = self.spans(interface);
            for span in &spans {
                for s in span.s.into_iter().filter(|&s| !self.goes_on(&spans, span.edge, s)) {
                    add(points, span.edge, s);
                }
            }
            let facing: Vec<usize> = self.edges_of(self.facing_sides(interface)).map(|(k, _)| k).collect();
            for &k in &facing {
                for s in points[k].clone() {
                    for (own, foot) in self.seen_from(interface, k, s) {
                        add(points, own, foot);
                    }
                }
            }
            for span in &spans {
                let [a, b] = span.s;
                // at the ends of a span rounding decides whether anything is seen
                let inset = 1e-13 * (b - a);
                for s in points[span.edge].clone().into_iter().filter(|s| a <= *s && *s <= b) {
                    if let Some(seen) = self.seen(interface, span.edge, s.clamp(a + inset, b - inset)) {
                        add(points, seen.edge, seen.s);
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

    /// E* of the body of an edge, by which its sides are paired with others.
    fn modulus_of(&self, edge: &Edge) -> f64 {
        self.pairing_modulus(self.body_of_side(edge.side))
    }

    /// E* of a body; of an outcome of random input that of the mean, so that all outcomes have the same pairs.
    pub fn pairing_modulus(&self, body: usize) -> f64 {
        self.paired_by.get(body).copied().unwrap_or_else(|| self.bodies[body].material().plane_modulus())
    }

    /// E* n at a point of an edge.
    fn pull(&self, edge: &Edge, s: f64) -> [f64; 2] {
        let modulus = self.modulus_of(edge);
        edge.normal(s).map(|n| modulus * n)
    }

    /// The point that a point of a carrying edge of an interface sees; none if no side is before it.
    pub fn seen(&self, interface: &Interface, edge: usize, s: f64) -> Option<Seen> {
        let own = &self.outline.edges()[edge];
        let (x, normal, pull) = (own.point(s), own.normal(s), self.pull(own, s));
        let [low, high] = self.seen_distances(interface);
        let faced: Vec<(usize, &Edge)> = self.edges_of(self.facing_sides(interface)).collect();
        let is_seen = |seen: &Seen| low <= seen.distance && seen.distance <= high;
        let nearest = |all: &mut dyn Iterator<Item = Seen>| {
            all.filter(is_seen).min_by(|a, b| a.distance.abs().total_cmp(&b.distance.abs()))
        };
        let on_edges = faced.iter().flat_map(|&(k, other)| {
            let push = self.modulus_of(other);
            let at = move |s: f64| meet(x, normal, pull, (other.point(s), other.normal(s)), push, (k, s));
            other.paired(x, pull, push).into_iter().filter_map(at).collect::<Vec<_>>()
        });
        if let Some(seen) = nearest(&mut on_edges.into_iter()) {
            return Some(seen);
        }
        let at_corners = faced.iter().filter_map(|&(k, other)| {
            let at_end = !other.reversed;
            let (next, rising) = self.outline.neighbour(k, at_end);
            let behind = faced.iter().find(|of| of.0 == next)?.1;
            let (s, start) = (if at_end { 1.0 } else { 0.0 }, if rising { 0.0 } else { 1.0 });
            let normals = [other.normal(s), behind.normal(start)];
            meet_corner(x, normal, pull, (other.point(s), normals), self.modulus_of(other), (k, s))
        });
        nearest(&mut at_corners.into_iter())
    }

    /// The points of carrying edges that see a point of a facing one: edges and parameters.
    pub fn seen_from(&self, interface: &Interface, edge: usize, s: f64) -> Vec<(usize, f64)> {
        let other = &self.outline.edges()[edge];
        let (x, pull) = (other.point(s), self.pull(other, s));
        let sees = |&(k, foot): &(usize, f64)| {
            let at = self.seen(interface, k, foot).map(|seen| self.outline.edges()[seen.edge].point(seen.s));
            at.is_some_and(|y| (y[0] - x[0]).hypot(y[1] - x[1]) <= 1e-9 * self.outline.diameter())
        };
        let own = self.edges_of(&interface.sides);
        let feet =
            own.flat_map(|(k, own)| own.paired(x, pull, self.modulus_of(own)).into_iter().map(move |foot| (k, foot)));
        feet.filter(sees).collect()
    }

    /// The parts of the carrying edges of an interface that see other sides.
    pub fn spans(&self, interface: &Interface) -> Vec<Span> {
        self.known_spans.get_or(self.seen_by(interface), || self.find_spans(interface))
    }

    /// The bits of all data on which the spans of an interface depend: sides, law, edges and moduli.
    fn seen_by(&self, interface: &Interface) -> Vec<u64> {
        let sides = [&interface.sides, self.facing_sides(interface)].map(|sides| {
            let count = sides.len() as u64;
            [count].into_iter().chain(sides.iter().map(|&side| side as u64))
        });
        let tied = matches!(interface.law, Law::Tied(_));
        let edges = self.outline.edges().iter().flat_map(|edge| {
            let ends = [edge.start, edge.end].as_flattened().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            [edge.side as u64].into_iter().chain(ends).chain(edge.listed_bits())
        });
        let moduli = (0..self.bodies.len()).map(|body| self.pairing_modulus(body).to_bits());
        sides.into_iter().flatten().chain([u64::from(tied)]).chain(moduli).chain(edges).collect()
    }

    fn find_spans(&self, interface: &Interface) -> Vec<Span> {
        let corners: Vec<([f64; 2], [f64; 2])> = self
            .edges_of(self.facing_sides(interface))
            .flat_map(|(_, edge)| [0.0, 1.0].map(|s| (edge.point(s), self.pull(edge, s))))
            .collect();
        let of_edge = |(k, own): (usize, &Edge)| {
            let mut points: Vec<f64> = (0..=PARTS).map(|i| i as f64 / PARTS as f64).collect();
            points.extend(corners.iter().flat_map(|&(x, pull)| own.paired(x, pull, self.modulus_of(own))));
            points.sort_by(f64::total_cmp);
            points.dedup_by(|b, a| *b - *a < SAME);
            let sees = |s: f64| self.seen(interface, k, s).is_some();
            let mut spans: Vec<[f64; 2]> = Vec::new();
            for part in points.windows(2) {
                // feet that are at an end to rounding are seen beyond it, farther than a millionth of a short part
                let length = part[1] - part[0];
                let inset = (1e-6 * length).max(NEAR_END.min(length / 4.0));
                let [a, b] = [part[0] + inset, part[1] - inset];
                let span = match [sees(a), sees(b)] {
                    [false, false] => continue,
                    [true, true] => [part[0], part[1]],
                    [true, false] => [part[0], change(a, b, &sees)],
                    [false, true] => [change(b, a, &sees), part[1]],
                };
                match spans.last_mut().filter(|last| span[0] - last[1] < NEAR_END) {
                    Some(last) => last[1] = span[1],
                    None => spans.push(span),
                }
            }
            spans.retain(|[a, b]| b - a > NEAR_END);
            spans.into_iter().map(move |s| Span { edge: k, s: s.map(at_end) }).collect::<Vec<_>>()
        };
        self.edges_of(&interface.sides).flat_map(of_edge).collect()
    }
}

/// The pair of a point x, with its normal and E* n, and a point y, with its normal, of an edge with another E*; none where they look
/// away from each other.
fn meet(
    x: [f64; 2],
    normal: [f64; 2],
    pull: [f64; 2],
    (y, beyond): ([f64; 2], [f64; 2]),
    push: f64,
    (edge, s): (usize, f64),
) -> Option<Seen> {
    let direction = unit([0, 1].map(|i| pull[i] - push * beyond[i]));
    let distance = dot(minus(y, x), direction);
    (dot(normal, beyond) < FACING).then_some(Seen { edge, s, distance, direction })
}

/// The same of a corner y with the normals before and behind, if the pair's is between them.
fn meet_corner(
    x: [f64; 2],
    normal: [f64; 2],
    pull: [f64; 2],
    (y, normals): ([f64; 2], [[f64; 2]; 2]),
    push: f64,
    (edge, s): (usize, f64),
) -> Option<Seen> {
    let r = minus(y, x);
    let along = normals.map(|beyond| [0, 1].map(|i| pull[i] - push * beyond[i]));
    let [before, behind] = along.map(|d| cross(r, d));
    if normals[0] == normals[1] || before * behind > 0.0 {
        return None;
    }
    let mean = unit([0, 1].map(|i| normals[0][i] + normals[1][i]));
    let middle = unit([0, 1].map(|i| pull[i] - push * mean[i]));
    let distance = norm(r);
    let ahead = dot(r, middle) > 0.5 * distance;
    let direction = if distance > 0.0 && ahead { unit(r) } else { middle };
    (dot(normal, mean) < FACING && (ahead || distance == 0.0)).then_some(Seen { edge, s, distance, direction })
}

/// An edge parameter, at an end that is close.
fn at_end(s: f64) -> f64 {
    if s < NEAR_END {
        0.0
    } else if s > 1.0 - NEAR_END {
        1.0
    } else {
        s
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
