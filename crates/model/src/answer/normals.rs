//! How much the direction of contact between two bodies matters for J, and that small displacements keep it.
//!
//! Surfaces that touch have one normal, which neither has where they are apart; small displacements take it from both as they are
//! drawn, d = (E₁n₁ - E₂n₂)/|…|. With another direction d' and the point y' that x meets along it, as J is stationary,
//!
//! ```text
//! J' - J = ∫ λ_n (d'·(u(x) - u(y')) - g' - d·(u(x) - u(y)) + g) + λ_t (t'·(u(x) - u(y')) - t·(u(x) - u(y))) ds
//! ```
//! to first order, g the distance along the direction. Where bodies move far before they touch, x + u(x) arrives at the
//! distance s beside y + u(y), where the side of y, with normal n₂ and curvature κ, is -s (t·n₂)/(d·n₂) + ½ κ s² farther away:
//! this changes J by ∫ λ_n times that. And friction counts as slip the difference between the motion along d and along the
//! normals, the distance of the points that x meets along both: this changes J by ∫ |λ_t| times that distance.
//!
//! Data of the scene are those at x, per length of the side of x. Those at y, per length there, change J by ∫ λ_n times the
//! difference of the gaps, and by ∫ |w_t| times that of the friction bounds, F(x) - F(y) |dy/dx| or λ_n (μ(x) - μ(y)), w_t the slip.

use steklov_bem_operators::Site;
use steklov_coupling::{Cell, Facing, Met, meet};
use steklov_elastic::plane::{self, cross, distance, dot, minus};
use steklov_expression::Expression;
use steklov_problem::{Friction, Law};
use steklov_quadrature::gauss_legendre;

use crate::data::joints::Joint;
use crate::data::on_mesh::OnMesh;
use crate::solve::fields::ElasticField;

/// Gauss points on a cell.
const POINTS: usize = 12;
/// Parts of a cell between which lengths on both sides are compared.
const BESIDE: f64 = 1e-4;
/// Where the pressure is below this part of the largest one, normals do not count.
const PRESSED: f64 = 1e-3;

/// The influence of the direction of contact on an interface.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Normals {
    /// Largest angle between the normal of one side and that against the other where they press each other (radian).
    pub angle: f64,
    /// The uncertainty of J due to this (energy per thickness): |J' - J''| of contact along the normals of the one side and of
    /// the other (0 for mirror images, which leave no choice), and the changes by pairs that moved apart and by data of the
    /// other side.
    pub change: f64,
}

/// A point of an interface.
struct Point {
    /// Element and parameter of the point, and the element that it meets.
    at: (usize, f64),
    other: usize,
    /// λ_n, not less than 0, and λ_t, and the length that it stands for.
    pressure: f64,
    shear: f64,
    ds: f64,
    /// Its displacement.
    displacement: [f64; 2],
    /// The point that it meets.
    met: Met,
    /// Length on the other side per length on this one.
    stretch: f64,
}

impl OnMesh<'_> {
    /// The influence of the direction on an interface of contact.
    pub(crate) fn normals(&self, joint: &Joint, field: ElasticField<'_>) -> Normals {
        // the normals of one side are those of contact with a partner that gives way to it
        let alone = |sides: &[usize]| -> Vec<f64> {
            let of = |e: usize| if sides.contains(&e) { 1.0 } else { 0.0 };
            (0..self.mesh.len()).map(of).collect()
        };
        let (moduli, alone) = (self.moduli(), [alone(&joint.own), alone(&joint.other)]);
        let Law::Contact(contact) = &self.scene.problem.interfaces()[joint.interface].law else {
            return Normals::default();
        };
        let mut points: Vec<Point> =
            joint.cells.iter().flat_map(|cell| self.points(cell, self.side(&moduli), field)).collect();
        if matches!(contact.friction, Friction::None) {
            points.iter_mut().for_each(|point| point.shear = 0.0);
        }
        let largest = points.iter().fold(0.0, |m: f64, p| m.max(p.pressure));
        let [mut angle, mut change, mut apart, mut slip, mut carried, mut rubbed] = [0.0_f64; 6];
        for point in &points {
            apart += point.ds * point.pressure * self.left_after_motion(point, field);
            let [here, there] = self.on_both(&contact.gap, point);
            carried += point.ds * point.pressure * (here - there);
            rubbed += point.ds * self.rubbed(&contact.friction, point, field);
            let met = alone.each_ref().map(|alone| meet(self.side(alone), point.at, self.side(alone), point.other));
            let [Some(first), Some(second)] = met else { continue };
            let [a, b] = [first, second].map(|other| self.turned(point, other, field));
            change += point.ds * (a - b);
            let [y, z] = [first, second].map(|met| self.mesh.point(point.other, met.t));
            slip += point.ds * point.shear.abs() * distance(y, z);
            if point.pressure > PRESSED * largest {
                angle = angle.max(plane::angle(first.direction, second.direction).abs());
            }
        }
        Normals { angle, change: change.abs() + apart.abs() + slip + carried.abs() + rubbed.abs() }
    }

    /// All elements, with moduli.
    fn side<'a>(&'a self, modulus: &'a [f64]) -> Facing<'a> {
        Facing { mesh: self.mesh, space: self.space, elements: &[], modulus }
    }

    /// The points of a cell.
    fn points(&self, cell: &Cell, side: Facing<'_>, field: ElasticField<'_>) -> Vec<Point> {
        let Cell { element: e, span, other } = *cell;
        let (half, rule) = ((span[1] - span[0]) / 2.0, gauss_legendre(POINTS));
        let at = |(&g, &w): (&f64, &f64)| {
            let t = span[0] + half * (1.0 + g);
            let met = meet(side, (e, t), side, other)?;
            let beside = [-BESIDE, BESIDE].map(|by| meet(side, (e, t + by * half), side, other));
            let stretch = match beside {
                [Some(a), Some(b)] => (b.t - a.t).abs() / (2.0 * BESIDE * half) * self.mesh.speed(other, met.t),
                _ => self.mesh.speed(e, t),
            };
            let pull = field.traction(e, t);
            let (pressure, shear) = ((-dot(pull, met.direction)).max(0.0), -cross(met.direction, pull));
            let (displacement, ds) = (field.on_boundary(e, t).0, half * w * self.mesh.speed(e, t));
            let stretch = stretch / self.mesh.speed(e, t);
            Some(Point { at: (e, t), other, pressure, shear, ds, displacement, met, stretch })
        };
        rule.points.iter().zip(&rule.weights).filter_map(at).collect()
    }

    /// The values of a datum at a point and at the point that it meets.
    fn on_both(&self, datum: &Expression, point: &Point) -> [f64; 2] {
        [point.at, (point.other, point.met.t.clamp(-1.0, 1.0))]
            .map(|(e, t)| self.value(datum, &Site::new(self.mesh, e, t)))
    }

    /// The change in the work of slip by the friction bounds of the other side.
    fn rubbed(&self, friction: &Friction, point: &Point, field: ElasticField<'_>) -> f64 {
        let bound = match friction {
            Friction::None => return 0.0,
            Friction::Tresca(bound) => {
                let [here, there] = self.on_both(bound, point);
                here - there * point.stretch
            }
            Friction::Coulomb(coefficient) => {
                let [here, there] = self.on_both(coefficient, point);
                point.pressure * (here - there)
            }
        };
        let beyond = field.on_boundary(point.other, point.met.t.clamp(-1.0, 1.0)).0;
        let apart = minus(point.displacement, beyond);
        bound * cross(point.met.direction, apart).abs()
    }

    /// The density of J' - J for another direction.
    fn turned(&self, point: &Point, other: Met, field: ElasticField<'_>) -> f64 {
        let along = |met: Met| {
            let beyond = field.on_boundary(point.other, met.t.clamp(-1.0, 1.0)).0;
            let apart = minus(point.displacement, beyond);
            [dot(apart, met.direction) - met.distance, cross(met.direction, apart)]
        };
        let ([n, t], [normal, tangential]) = (along(other), along(point.met));
        point.pressure * (n - normal) + point.shear * (t - tangential)
    }

    /// The distance left between a moved point and the side that it presses, which keeps its drawn shape and moves with the
    /// point that it met: the point has moved aside, where the side is oblique to the direction or bends.
    fn left_after_motion(&self, point: &Point, field: ElasticField<'_>) -> f64 {
        let (m, Met { t, direction: d, .. }) = (point.other, point.met);
        let t = t.clamp(-1.0, 1.0);
        let (beyond, n) = (field.on_boundary(m, t).0, self.mesh.normal(m, t));
        let edge = &self.scene.problem.outline.edges()[self.mesh.edge[m]];
        let aside = cross(d, minus(point.displacement, beyond));
        -aside * cross(d, n) / dot(d, n) + 0.5 * edge.curvature(self.mesh.edge_parameter(m, t)) * aside * aside
    }
}
