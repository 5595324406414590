//! Whether bodies fit as they are drawn: which side of an interface carries, what a tie covers, what overlaps.

use steklov_bem_operators::Edge;

use super::facing::SAME;
use super::spans::Span;
use super::{Interface, Law, Other, Place, Problem};

/// Bodies whose moduli are not farther apart than this factor are about as stiff.
const ALIKE: f64 = 2.0;
/// Distance inside its boundary at which a body is tested, in parts of its extent.
const INSET: f64 = 1e-4;
/// Part of the diameter of a body by which bodies may overlap as they are drawn.
const OVERLAP: f64 = 1e-6;
/// Number of points of an edge that are tested for lying in another body.
const LOOKS: usize = 128;

impl Problem {
    /// Whether the carrying sides of the first of two mirrored interfaces carry the multipliers rather than those of the
    /// second: those of the softer body, whose mesh resolves what happens; for bodies about equally stiff those that are
    /// wholly covered, else the first. On the coarse mesh of a stiff body multipliers would be too few to hold a soft one.
    pub(super) fn carries_rather(&self, first: &Interface, second: &Interface) -> bool {
        let covered = |interface: &Interface| self.unseen(interface).is_empty();
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

    /// Whether the sides of an interface see each other, and tied ones meet on all of the shorter of both.
    ///
    /// # Errors
    /// What is wrong, and what to do.
    pub(super) fn check_facing(&self, interface: &Interface) -> Result<(), (String, &'static str)> {
        let between = [&interface.sides, self.facing_sides(interface)].map(|sides| self.names(sides)).join(" and ");
        let far = |x: &[f64; 2]| self.distance_to_other(interface, *x);
        if self.spans(interface).is_empty() {
            let least = self.looks(&self.whole(interface)).iter().map(far).fold(f64::INFINITY, f64::min);
            return Err(match interface.law {
                Law::Tied(_) if least > self.coincidence(interface) => (
                    format!("the sides {between} are tied but {least:e} apart"),
                    "move the bodies together, or write the distance as a displacement_jump of sides that meet",
                ),
                _ => (
                    format!("the sides {between} do not face each other: their normals do not point at one another"),
                    "name the sides that meet; the body lies to the left of its corners as they are listed",
                ),
            });
        }
        if matches!(interface.law, Law::Contact(_)) {
            return match self.hidden_by(interface) {
                Some(body) => Err((
                    format!(
                        "the sides {between} do not face each other: body {:?} lies between them",
                        self.bodies[body].name
                    ),
                    "name the sides that meet: those that are drawn next to each other",
                )),
                None => Ok(()),
            };
        }
        let beyond = self.mirrored(interface);
        let length = |of: &Interface| self.whole(of).iter().map(|span| self.span_length(span)).sum::<f64>();
        let shorter = if length(interface) <= length(&beyond) { interface } else { &beyond };
        let left = self.unseen(shorter);
        if !left.is_empty() {
            let far = |x: &[f64; 2]| self.distance_to_other(shorter, *x);
            let [x, y] = self.looks(&left).into_iter().max_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or_default();
            let side = self.outline.edges()[left[0].edge].side;
            return Err((
                format!(
                    "the sides {between} are tied, but {:?} and the other side are {:e} apart at ({x}, {y}), which is more \
                     than {:e}, 1e-6 of the smaller body",
                    self.sides[side].name,
                    far(&[x, y]),
                    self.coincidence(interface)
                ),
                "a tie covers all of the shorter of its sides: move the bodies together, or give what is not tied a side of its own",
            ));
        }
        let faces_nothing = [interface, &beyond].into_iter().find_map(|of| self.facing_nothing(of).first().copied());
        match faces_nothing {
            None => Ok(()),
            Some(side) => Err((
                format!("the sides {between} are tied, but {:?} meets none of the others", self.sides[side].name),
                "leave it out, or move the bodies together",
            )),
        }
    }

    /// The names of sides.
    pub(super) fn names(&self, sides: &[usize]) -> String {
        sides.iter().map(|&side| self.sides[side].name.as_str()).collect::<Vec<_>>().join(", ")
    }

    /// A body that lies between the sides of an interface wherever they see each other.
    fn hidden_by(&self, interface: &Interface) -> Option<usize> {
        let edges = self.outline.edges();
        let near = self.coincidence(interface);
        let between = |span: &Span| {
            let s = (span.s[0] + span.s[1]) / 2.0;
            let seen = self.seen(interface, span.edge, s)?;
            let way = near..seen.distance - near;
            let met = |edge: &&Edge| {
                edge.met_by(edges[span.edge].point(s), seen.direction).iter().any(|(_, d)| way.contains(d))
            };
            edges.iter().find(met).map(|edge| self.body_of_side(edge.side))
        };
        let bodies: Option<Vec<usize>> = self.spans(interface).iter().map(between).collect();
        bodies?.first().copied()
    }

    /// The same interface seen from its other sides.
    pub(super) fn mirrored(&self, interface: &Interface) -> Interface {
        let (sides, other) = (self.facing_sides(interface).to_vec(), Other::Sides(interface.sides.clone()));
        let place = if interface.place == Place::First { Place::Second } else { Place::First };
        Interface { sides, other, place, ..interface.clone() }
    }

    /// All of the carrying edges of an interface.
    fn whole(&self, interface: &Interface) -> Vec<Span> {
        self.edges_of(&interface.sides).map(|(edge, _)| Span { edge, s: [0.0, 1.0] }).collect()
    }

    /// The parts of the carrying edges of an interface that see nothing.
    fn unseen(&self, interface: &Interface) -> Vec<Span> {
        let spans = self.spans(interface);
        let of_edge = |(edge, own): (usize, &Edge)| {
            let near = (self.coincidence(interface) / own.length()).max(SAME);
            let mut at = 0.0;
            let mut left = Vec::new();
            for [a, b] in spans.iter().filter(|span| span.edge == edge).map(|span| span.s).chain([[1.0, 1.0]]) {
                if a - at > near {
                    left.push(Span { edge, s: [at, a] });
                }
                at = b;
            }
            left
        };
        self.edges_of(&interface.sides).flat_map(of_edge).collect()
    }

    /// The sides of both places of an interface that see nothing of the other one.
    pub fn facing_nothing(&self, interface: &Interface) -> Vec<usize> {
        let sees = |of: &Interface, side: usize| {
            self.spans(of).iter().any(|span| self.outline.edges()[span.edge].side == side)
        };
        let beyond = self.mirrored(interface);
        let both = [interface, &beyond];
        both.into_iter()
            .flat_map(|of| of.sides.iter().copied().filter(|&side| !sees(of, side)).collect::<Vec<_>>())
            .collect()
    }

    /// Length of a part of an edge.
    pub fn span_length(&self, span: &Span) -> f64 {
        let edge = &self.outline.edges()[span.edge];
        edge.length() * (edge.arc_fraction(span.s[1]) - edge.arc_fraction(span.s[0]))
    }

    /// The tested points of parts of edges.
    fn looks(&self, spans: &[Span]) -> Vec<[f64; 2]> {
        let at = |span: &Span, k: usize| span.s[0] + (span.s[1] - span.s[0]) * k as f64 / LOOKS as f64;
        let of =
            |span: &Span| (0..=LOOKS).map(|k| self.outline.edges()[span.edge].point(at(span, k))).collect::<Vec<_>>();
        spans.iter().flat_map(of).collect()
    }

    /// Distance of a point from the sides that an interface faces.
    fn distance_to_other(&self, interface: &Interface, x: [f64; 2]) -> f64 {
        let near =
            |least: f64, (_, other): (usize, &Edge)| other.nearest(x, least).map_or(least, |(distance, _)| distance);
        self.edges_of(self.facing_sides(interface)).fold(f64::INFINITY, near)
    }

    /// Whether bodies overlap as they are drawn.
    ///
    /// # Errors
    /// What is wrong: the two bodies, the deepest of the examined points, and how deep it lies.
    pub(super) fn check_overlaps(&self) -> Result<(), (String, String)> {
        let bodies = self.outline.bodies().len();
        let diagonal = |body| self.outline.diagonal_of_body(body);
        let pairs = (0..bodies).flat_map(|a| (0..bodies).filter(move |&b| b != a).map(move |b| (a, b)));
        for (a, b) in pairs {
            let deepest = self.boundary_in(a, b).max_by(|(_, one), (_, two)| one.total_cmp(two));
            let Some(([x, y], depth)) = deepest else { continue };
            if depth > OVERLAP * diagonal(b).min(diagonal(a)) {
                let (a, b, depth) = (&self.bodies[a].name, &self.bodies[b].name, rounded(depth));
                return Err((
                    format!("the point ({x}, {y}) of body {a:?} lies {depth} deep in body {b:?}"),
                    format!(
                        "draw bodies that touch, and write an interference as a negative contact.gap, here gap = \"-{depth}\", or as \
                         the displacement_jump of a tie"
                    ),
                ));
            }
        }
        Ok(())
    }

    /// Points of the boundary of body `a` that lie in body `b`, and how deep.
    fn boundary_in(&self, a: usize, b: usize) -> impl Iterator<Item = ([f64; 2], f64)> {
        let inset = INSET * self.outline.diagonal_of_body(a);
        // on the boundary, and a little inside: bodies may share all of their boundaries
        let look = move |edge: &Edge, k: usize| {
            let s = (k / 2) as f64 / LOOKS as f64 + 0.5 / LOOKS as f64;
            let (x, t) = (edge.point(s), edge.tangent(s));
            if k.is_multiple_of(2) {
                Some(x)
            } else {
                Some([x[0] - inset * t[1], x[1] + inset * t[0]]).filter(|&x| self.outline.is_in_body(a, x))
            }
        };
        let looks = self.edges_of_body(a).flat_map(move |edge| (0..2 * LOOKS).filter_map(move |k| look(edge, k)));
        let deep = move |x: [f64; 2]| {
            let nearer = |least: f64, edge: &Edge| edge.nearest(x, least).map_or(least, |(distance, _)| distance);
            (x, self.edges_of_body(b).fold(f64::INFINITY, nearer))
        };
        looks.filter(move |&x| self.outline.is_in_body(b, x)).map(deep)
    }

    /// The edges of all loops of a body.
    fn edges_of_body(&self, body: usize) -> impl Iterator<Item = &Edge> {
        let loops = self.outline.bodies()[body].clone();
        loops.flat_map(|l| &self.outline.edges()[self.outline.loops()[l].clone()])
    }
}

/// Rounded to four digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
