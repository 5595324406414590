//! The nonconformity of displacements: of bodies that agree in the mean only, and of sides held at data, or closed on obstacles, that are no
//! polynomials.
//!
//! ```text
//! w = [u] - g n, or [u] - j,        where an interface is closed, stuck or tied
//! w = u - u_D                       where a side is held
//! w = (u_n - g) n, and u_t t        where an obstacle is closed, and where the side sticks to it
//! J of the energy                   ∫ λ·w,       λ the mean of the tractions of both sides of u: J is stationary together with -λ·w
//! J of a number                     ∫ τ·w,       τ that of its dual solution z, from a(v, z) - ∫ τ·[v] = J(v) for all v, with a jump or not
//! ```
//! Where J weighs displacements of a held or closed side, τ is the traction of z less that weight.
//!
//! τ is taken from the side that carries multipliers: that of a coarser side may be ten times as large beside a point.
//!
//! *Fails when* the elements of that side are coarser than the distance of a point whose stress is asked for.
//!
//! Source: Wohlmuth (2000), the consistency error of mortar elements.

use std::ops::Range;

use steklov_bem_operators::Site;
use steklov_contact::ContactBubble;
use steklov_coupling::{Cell, Facing, Met, meet};
use steklov_elastic::plane::{dot, turned};
use steklov_problem::{Condition, Law};
use steklov_quadrature::{gauss_legendre, project};

use crate::data::joints::Joint;
use crate::data::on_mesh::OnMesh;
use crate::solve::fields::ElasticField;

/// Distances below this part of the displacements are zero.
const ROUNDED: f64 = 1e-13;
/// Gauss points on a cell.
pub(crate) const POINTS: usize = 24;

/// w at a point of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Left {
    /// The point on the carrying side, and the one that it faces: element and reference coordinate.
    pub(crate) places: [(usize, f64); 2],
    /// Length of the boundary.
    pub(crate) ds: f64,
    /// n and the direction along the interface.
    directions: [[f64; 2]; 2],
    /// w along both, 0 where it is free.
    along: [f64; 2],
}

impl Left {
    /// w.
    pub(crate) fn vector(&self) -> [f64; 2] {
        let ([n, t], [a, b]) = (self.directions, self.along);
        [a * n[0] + b * t[0], a * n[1] + b * t[1]]
    }
}

/// w on all cells.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Nonconformity {
    /// w at the Gauss points of one cell after the other.
    pub(crate) points: Vec<Left>,
    /// The carrying element of each cell, and its points.
    pub(crate) cells: Vec<(usize, Range<usize>)>,
    /// Elements that are closed on an obstacle, and whether they stick.
    on_obstacles: Vec<(usize, bool)>,
}

impl Nonconformity {
    /// With that of other elements.
    pub(crate) fn and(mut self, other: Self) -> Self {
        let first = self.points.len();
        self.points.extend(other.points);
        self.cells.extend(other.cells.into_iter().map(|(e, points)| (e, first + points.start..first + points.end)));
        self.on_obstacles.extend(other.on_obstacles);
        self
    }

    /// ∫ λ·w (energy).
    pub(crate) fn work(&self, field: ElasticField<'_>) -> f64 {
        let of = |left: &Left| {
            let [pull, push] = left.places.map(|(e, t)| field.traction(e, t));
            let w = left.vector();
            left.ds * (dot(push, w) - dot(pull, w)) / 2.0
        };
        self.points.iter().map(of).sum()
    }

    /// Carrying elements, and the energy E*/2 ‖w‖ ‖dw/ds‖ of w as a displacement of the boundary on one of their cells.
    pub(crate) fn energies(&self, data: &OnMesh<'_>) -> Vec<(usize, f64)> {
        let rule = gauss_legendre(POINTS);
        let of_cell = |(e, points): &(usize, Range<usize>)| {
            let modulus = data.scene.problem.contact_modulus(data.mesh.edge[*e]);
            let of = |i: usize| {
                let mut values = self.points[points.clone()].iter().map(|left| left.along[i]);
                let series = project(|_| values.next().unwrap_or(0.0), POINTS - 1, &rule);
                // lengths cancel in the norms of w and dw/ds
                modulus / 2.0 * series.norm() * series.derivative().norm()
            };
            (*e, of(0) + of(1))
        };
        self.cells.iter().map(of_cell).collect()
    }

    /// Whether w is not zero.
    pub(crate) fn is_there(&self) -> bool {
        self.points.iter().any(|left| left.along != [0.0; 2])
    }

    /// Whether an element is closed on an obstacle.
    pub(crate) fn is_on_obstacle(&self, e: usize) -> bool {
        self.on_obstacles.iter().any(|(own, _)| *own == e)
    }

    /// Whether an element carries multipliers of a cell.
    pub(crate) fn has(&self, e: usize) -> bool {
        self.cells.iter().any(|(own, _)| *own == e)
    }
}

impl OnMesh<'_> {
    /// The nonconformity of a field; `bubbles` are those of the contact elements.
    pub(crate) fn nonconformity(
        &self,
        joints: &[Joint],
        field: ElasticField<'_>,
        bubbles: &[ContactBubble],
    ) -> Nonconformity {
        let mut found = Nonconformity::default();
        for joint in joints {
            let interface = &self.scene.problem.interfaces()[joint.interface];
            for cell in &joint.cells {
                let bubble = bubbles.iter().find(|b| b.element == cell.element);
                let closed = match (&interface.law, bubble) {
                    (Law::Tied(_), _) => [true; 2],
                    (Law::Contact(_), Some(bubble)) => bubble.free.map(|free| !free),
                    (Law::Contact(_), None) => continue,
                };
                let first = found.points.len();
                found.points.extend(self.left_of_cell(&interface.law, cell, field, closed));
                found.cells.push((cell.element, first..found.points.len()));
            }
        }
        found
    }

    /// w at the Gauss points of a cell.
    fn left_of_cell(&self, law: &Law, cell: &Cell, field: ElasticField<'_>, closed: [bool; 2]) -> Vec<Left> {
        let Cell { element: e, span, other: m } = *cell;
        let half = (span[1] - span[0]) / 2.0;
        let rule = gauss_legendre(POINTS);
        let moduli = self.moduli();
        let side = Facing { mesh: self.mesh, space: self.space, elements: &[], modulus: &moduli };
        let mut largest = f64::MIN_POSITIVE;
        let at = |(&g, &weight): (&f64, &f64)| {
            let t = span[0] + half * (1.0 + g);
            let ds = half * weight * self.mesh.speed(e, t);
            let Some(Met { t: s, direction: n, .. }) = meet(side, (e, t), side, m) else {
                return Left { places: [(e, t), (m, 0.0)], ds, directions: [[0.0; 2]; 2], along: [0.0; 2] };
            };
            let (s, directions) = (s.clamp(-1.0, 1.0), [n, turned(n)]);
            let [(here, _), (beyond, _)] = [field.on_boundary(e, t), field.on_boundary(m, s)];
            largest = here.into_iter().chain(beyond).fold(largest, |m, u| m.max(u.abs()));
            let apart = self.left_apart(law, &Site::new(self.mesh, e, t), n);
            let left = [0, 1].map(|i| here[i] - beyond[i] - apart[i]);
            let along = [0, 1].map(|i| if closed[i] { dot(left, directions[i]) } else { 0.0 });
            Left { places: [(e, t), (m, s)], ds, directions, along }
        };
        let mut points: Vec<Left> = rule.points.iter().zip(&rule.weights).map(at).collect();
        without_rounding(&mut points, largest);
        points
    }

    /// The nonconformity of a field on the sides that are held and on closed elements of obstacles; `bubbles` are those of the contact elements.
    pub(crate) fn nonconformity_of_sides(&self, field: ElasticField<'_>, bubbles: &[ContactBubble]) -> Nonconformity {
        let mut found = Nonconformity { on_obstacles: self.closed_on_obstacles(bubbles), ..Nonconformity::default() };
        let rule = gauss_legendre(POINTS);
        let elements: Vec<usize> =
            (0..self.mesh.len()).filter(|&e| self.is_held(e) || found.is_on_obstacle(e)).collect();
        for e in elements {
            let mut largest = f64::MIN_POSITIVE;
            let at = |(&t, &weight): (&f64, &f64)| {
                let (own, _) = field.on_boundary(e, t);
                largest = own.into_iter().fold(largest, |m, u| m.max(u.abs()));
                let along = self.off_side(&found, own, (e, t));
                let ds = weight * self.mesh.speed(e, t);
                Left { places: [(e, t); 2], ds, directions: [[1.0, 0.0], [0.0, 1.0]], along }
            };
            let mut points: Vec<Left> = rule.points.iter().zip(&rule.weights).map(at).collect();
            without_rounding(&mut points, largest);
            let first = found.points.len();
            found.points.extend(points);
            found.cells.push((e, first..found.points.len()));
        }
        found
    }

    /// The elements that are closed on an obstacle, and whether they stick; `bubbles` are those of the contact elements.
    pub(crate) fn closed_on_obstacles(&self, bubbles: &[ContactBubble]) -> Vec<(usize, bool)> {
        let is_on_obstacle = |e: usize| self.scene.problem.joint(self.mesh.side[e]).is_none();
        let closed = bubbles.iter().filter(|bubble| is_on_obstacle(bubble.element) && !bubble.free[0]);
        closed.map(|bubble| (bubble.element, !bubble.free[1])).collect()
    }

    /// w of a displacement at a point of a side that is held or closed on an obstacle.
    pub(crate) fn off_side(&self, left: &Nonconformity, u: [f64; 2], place: (usize, f64)) -> [f64; 2] {
        match left.on_obstacles.iter().find(|(e, _)| *e == place.0) {
            Some((_, sticks)) => self.off_obstacle(u, *sticks, place),
            None => self.off_support(u, place),
        }
    }

    /// w of a displacement at a point of an element that is closed on an obstacle.
    pub(crate) fn off_obstacle(&self, u: [f64; 2], sticks: bool, (e, t): (usize, f64)) -> [f64; 2] {
        let Some(contact) = self.scene.contact(self.mesh.side[e]) else { return [0.0; 2] };
        let gap = (self.gap(self.mesh.side[e], &contact.gap).value)(&Site::new(self.mesh, e, t));
        let n = self.mesh.normal(e, t);
        let along = [dot(u, n) - gap, if sticks { dot(u, turned(n)) } else { 0.0 }];
        [0, 1].map(|i| along[0] * n[i] + along[1] * turned(n)[i])
    }

    /// Whether the side of an element holds a component of the displacement.
    pub(crate) fn is_held(&self, e: usize) -> bool {
        let side = &self.scene.problem.sides[self.mesh.side[e]];
        side.holds(0) || side.holds(1)
    }

    /// u - u_D of a displacement at a point of an element, in the components that its side holds, else zero.
    fn off_support(&self, u: [f64; 2], (e, t): (usize, f64)) -> [f64; 2] {
        let Condition::Displacement { values, .. } = &self.scene.problem.sides[self.mesh.side[e]].condition else {
            return [0.0; 2];
        };
        let site = Site::new(self.mesh, e, t);
        [0, 1].map(|i| values[i].as_ref().map_or(0.0, |value| u[i] - self.value(value, &site)))
    }

    /// The distance between two points that a law joins: the gap along n, the jump of a tie.
    fn left_apart(&self, law: &Law, site: &Site, n: [f64; 2]) -> [f64; 2] {
        match law {
            Law::Contact(contact) => {
                let gap = (self.gap(self.mesh.side[site.element], &contact.gap).value)(site);
                n.map(|n| gap * n)
            }
            Law::Tied(tie) => tie
                .displacement_jump
                .as_ref()
                .map_or([0.0; 2], |jump| jump.each_ref().map(|jump| self.value(jump, site))),
        }
    }
}

/// Components of w that are rounding of the largest displacement on a cell are zero.
fn without_rounding(points: &mut [Left], largest: f64) {
    for i in 0..2 {
        if points.iter().all(|left| left.along[i].abs() <= ROUNDED * largest) {
            points.iter_mut().for_each(|left| left.along[i] = 0.0);
        }
    }
}
