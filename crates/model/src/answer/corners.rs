//! Corners at which bodies meet in contact: together they are a wedge, whose exponents decide whether the pressure is infinite.
//!
//! ```text
//!       │ A │                    faces of the wedge: the sides of A and B that go on from the corner
//!   ────┴───┴────  B             joint: the interface, closed, slipping or stuck as at its node next to the corner
//! ```

use std::f64::consts::PI;

use steklov_elastic::plane::{angle, distance};
use steklov_elastic::{Face, Joint, Sector, Wedge};
use steklov_problem::{Contact, Interface, Law, Scene, Span};

use crate::answer::singular_points::{direction, face, state};
use crate::mesh::first_mesh::SMOOTH;
use crate::solve::contact_rows::{ContactRow, max_pressure};

/// A point closer to an end of its edge is there (edge parameter).
const NEAR: f64 = 1e-6;
/// Cosine of the angle between the normal of an edge and those of its nodes, at least.
const ALONG: f64 = 0.9;

/// A body at a point of an interface.
struct Corner {
    /// Its angle there.
    sector: Sector,
    /// The edge that goes on beyond; none inside of an edge.
    beyond: Option<usize>,
}

/// Whether the exact pressure between bodies is infinite at an end or at a corner of an interface, where that is closed. At
/// the tip of a closed crack the shear ahead is infinite, but no pressure; where a third body goes on nothing is decided.
pub(crate) fn is_unbounded_between_bodies(scene: &Scene, rows: &[ContactRow]) -> bool {
    scene.problem.joints().any(|interface| {
        let Law::Contact(contact) = &interface.law else { return false };
        let spans = scene.problem.spans(interface);
        let ends = spans.iter().flat_map(|span| [(span, false), (span, true)]);
        let mut wedges = ends.filter_map(|(span, upper)| {
            let at = Place { scene, rows, interface, contact, spans: &spans, edge: span.edge, upper };
            at.wedge(span.s[usize::from(upper)])
        });
        wedges.any(|wedge| wedge.is_singular())
    })
}

/// An end of a part of a carrying edge that sees another body.
struct Place<'a> {
    scene: &'a Scene,
    rows: &'a [ContactRow],
    interface: &'a Interface,
    contact: &'a Contact,
    spans: &'a [Span],
    edge: usize,
    /// Whether it is the end with the larger edge parameter.
    upper: bool,
}

impl Place<'_> {
    /// The wedge of both bodies, where the interface is closed.
    fn wedge(&self, s: f64) -> Option<Wedge> {
        let edges = self.scene.problem.outline.edges();
        let own = &edges[self.edge];
        // whether the interface is on the edge behind the point, the body to the left
        let behind = self.upper == own.reversed;
        let inwards = if self.upper { -1e-3 * NEAR } else { 1e-3 * NEAR };
        let seen = self.scene.problem.seen(self.interface, self.edge, s + inwards)?;
        let here = self.corner(self.edge, s, behind)?;
        let there = self.corner(seen.edge, seen.s, !behind)?;
        let x = own.point(s);
        let joint = self.joint(self.edge, s, x);
        let ordered = |joint: Joint, [first, second]: [Face; 2]| {
            let (sectors, faces) = match behind {
                true => (vec![there.sector, here.sector], [second, first]),
                false => (vec![here.sector, there.sector], [first, second]),
            };
            Wedge { sectors, joints: vec![joint], faces: Some(faces) }
        };
        if let Some((next, at)) = here.beyond.and_then(|next| self.goes_on(next, x)) {
            let together = (here.sector.angle + there.sector.angle - 2.0 * PI).abs() < SMOOTH;
            if (here.sector.angle - PI).abs() < SMOOTH || !together {
                return None;
            }
            return match (joint, self.joint(next, at, x)) {
                (Some(joint), Some(second)) if behind => {
                    Some(Wedge { sectors: vec![there.sector, here.sector], joints: vec![joint, second], faces: None })
                }
                // if the side is open, both faces are free
                (Some(joint), None) => Some(ordered(joint, [Face::Free; 2])),
                _ => None,
            };
        }
        let faces = [self.beyond(&here, behind, x)?, self.beyond(&there, !behind, x)?];
        Some(ordered(joint?, faces))
    }

    /// The angle of the body of an edge at one of its points, and the edge beyond.
    fn corner(&self, edge: usize, s: f64, behind: bool) -> Option<Corner> {
        let outline = &self.scene.problem.outline;
        let edges = outline.edges();
        let material = self.scene.problem.body_of(&edges[edge]).material();
        let sector = |angle: f64| Sector { angle, mu: material.mu(), kappa: material.kappa() };
        if s > NEAR && s < 1.0 - NEAR {
            return Some(Corner { sector: sector(PI), beyond: None });
        }
        let rising = s > 0.5;
        if (rising == edges[edge].reversed) != behind {
            return None;
        }
        let next = outline.neighbour(edge, rising).0;
        let [a, b] = if behind { [next, edge] } else { [edge, next] };
        let (a, b) = (direction(&edges[a], true), direction(&edges[b], false));
        let angle = PI - angle(a, b);
        Some(Corner { sector: sector(angle), beyond: Some(next) })
    }

    /// The condition on the side of a body beyond the corner; none if it meets another body there.
    fn beyond(&self, corner: &Corner, behind: bool, x: [f64; 2]) -> Option<Face> {
        let Some(next) = corner.beyond else { return Some(Face::Free) };
        let problem = &self.scene.problem;
        let edge = &problem.outline.edges()[next];
        let meets = |of: &Interface| of.sides.contains(&edge.side) || problem.facing_sides(of).contains(&edge.side);
        if problem.joints().any(meets) {
            return None;
        }
        let ray = if behind { direction(edge, true).map(|d| -d) } else { direction(edge, false) };
        Some(face(self.scene, self.rows, edge, x, ray))
    }

    /// The next edge along which the interface continues, and the edge parameter.
    fn goes_on(&self, next: usize, x: [f64; 2]) -> Option<(usize, f64)> {
        let edge = &self.scene.problem.outline.edges()[next];
        let near = NEAR * edge.length();
        let ends = self.spans.iter().filter(|span| span.edge == next).flat_map(|span| span.s);
        let at = |s: &f64| {
            let y = edge.point(*s);
            distance(y, x) <= near
        };
        ends.filter(at).map(|s| (next, s)).next()
    }

    /// The state of the node next to a point of a carrying edge; none if it is open.
    fn joint(&self, edge: usize, s: f64, x: [f64; 2]) -> Option<Joint> {
        let edge = &self.scene.problem.outline.edges()[edge];
        let [tx, ty] = edge.tangent(s);
        let distance = |r: &ContactRow| distance(r.point, x);
        let along = |r: &&ContactRow| r.side == edge.side && r.normal[0] * ty - r.normal[1] * tx > ALONG;
        let nearest = self.rows.iter().filter(along).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        state(nearest, max_pressure(self.rows), &self.contact.friction)
    }
}
