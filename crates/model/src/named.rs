//! The numbers that a scene asks for by names, on a mesh.
//!
//! ```text
//! pressure            -n·t at a point, at a vertex the mean of both elements
//! mean displacement   (1/L) ∫ u ds by Gauss's rule on each element
//! weighted force      Σ_i w_i·R_i + ∫ (w - I_p w)·t ds,   R_i the forces that hold the nodes; a moment has w = (x - c) turned by 90°
//! opening             g - u_n against an obstacle, g + (u' - u)·d against the pair of a point along the direction d of contact
//! ```
//! A moment by the balance of nodal forces is 10 to 150 times nearer than ∫ (x - c) × t, which it is between bodies and with stabilised
//! multipliers; its w - I_p w is zero on straight elements.

use std::f64::consts::PI;

use steklov_bem_operators::{Mesh, SAME_PLACE, Site};
use steklov_contact::Located;
use steklov_elastic::plane::{dot, minus};
use steklov_problem::{Friction, Multiplier, QuantityKind, Surfaces};
use steklov_quadrature::gauss_legendre;

use crate::data::on_mesh::OnMesh;
use crate::solve::fields::ElasticField;

/// Points of Gauss's rule beyond the degree of an element: on lines products of polynomials, on curves the speed has to be followed.
const MORE: [usize; 2] = [2, 16];

/// The same for weights, which may have many waves on an element.
const OF_WEIGHTS: usize = 48;

/// Points at which the largest pressure on an element is looked for, for each degree, and steps that leave two thirds of an interval.
const SAMPLES: usize = 2;
const THIRDS: usize = 24;
/// Part of the largest pressure of these points from which on an element may have a larger one.
const OF_LARGEST: f64 = 0.5;

/// A pressure, and the edge and its parameter where it is.
type Pressed = (f64, (usize, f64));

/// How many numbers a quantity has.
pub(crate) fn components(kind: &QuantityKind) -> usize {
    if matches!(kind, QuantityKind::MeanDisplacement(_)) { 2 } else { 1 }
}

impl OnMesh<'_> {
    /// The quantities of the scene in their order; `balance` are the moments and weighted forces of the nodal forces.
    pub(crate) fn named(&self, field: &ElasticField<'_>, balance: &[f64]) -> Vec<f64> {
        let mut balance = balance.iter();
        let mut values = Vec::new();
        for quantity in &self.scene.quantities {
            match quantity.kind {
                QuantityKind::PressureAt(x) => values.push(self.pressure(field, x)),
                QuantityKind::MeanDisplacement(side) => values.extend(self.mean_displacement(field, side)),
                QuantityKind::Moment { .. } | QuantityKind::WeightedForce { .. } => {
                    let of_nodes = balance.next().copied().unwrap_or(f64::NAN);
                    values.push(of_nodes + self.work_of_traction(field, &quantity.kind));
                }
                QuantityKind::OpeningAt(x) => values.push(self.opening(field, x)),
            }
        }
        values
    }

    fn pressure(&self, field: &ElasticField<'_>, x: [f64; 2]) -> f64 {
        self.scene.problem.pressed_at(x).map_or(f64::NAN, |at| self.pressure_on(field, at))
    }

    /// The pressure at the edge parameter s of an edge.
    pub(crate) fn pressure_on(&self, field: &ElasticField<'_>, (edge, s): (usize, f64)) -> f64 {
        self.on_edge(edge, s, |e, t| -dot(field.traction(e, t), self.mesh.normal(e, t)))
    }

    /// The edge and its parameter at which the pressure of contact is largest, on some of the sides in contact.
    pub(crate) fn most_pressed(
        &self,
        field: &ElasticField<'_>,
        is_pressed: impl Fn(usize) -> bool,
    ) -> Option<(usize, f64)> {
        let touching = (0..self.mesh.len()).filter(|&e| is_pressed(self.mesh.side[e]));
        let at = |e: usize, t: f64| {
            let [a, b] = self.mesh.span[e];
            let s = a + (b - a) * (1.0 + t) / 2.0;
            let place = (self.mesh.edge[e], s);
            let is_vertex = (s - a).abs().min((s - b).abs()) <= SAME_PLACE;
            let inside = || -dot(field.traction(e, t), self.mesh.normal(e, t));
            (if is_vertex { self.pressure_on(field, place) } else { inside() }, place)
        };
        let larger = |a: &Pressed, b: &Pressed| a.0.total_cmp(&b.0);
        // the pressure is a polynomial of the degree of the element
        let parts = |e: usize| SAMPLES * (self.space.degree(e) + 1);
        let point = |e: usize, k: usize| -(k as f64 * PI / parts(e) as f64).cos();
        let sampled = |e: usize| {
            let all = (0..=parts(e)).map(|k| (at(e, point(e, k)), k));
            all.max_by(|(a, _), (b, _)| larger(a, b)).map(|(best, k)| (best, e, k))
        };
        let samples: Vec<(Pressed, usize, usize)> = touching.filter_map(sampled).collect();
        let largest = samples.iter().fold(0.0, |most: f64, ((pressure, _), ..)| most.max(*pressure));
        let refined = |&(best, e, k): &(Pressed, usize, usize)| {
            let (mut low, mut high) = (point(e, k.saturating_sub(1)), point(e, (k + 1).min(parts(e))));
            for _ in 0..THIRDS {
                let [a, b] = [1.0, 2.0].map(|k| low + k * (high - low) / 3.0);
                if at(e, a).0 < at(e, b).0 { low = a } else { high = b }
            }
            [best, at(e, (low + high) / 2.0)].into_iter().max_by(larger)
        };
        let near = samples.iter().filter(|((pressure, _), ..)| *pressure > OF_LARGEST * largest);
        near.filter_map(refined).max_by(larger).filter(|(pressure, _)| *pressure > 0.0).map(|(_, place)| place)
    }

    /// A number at the edge parameter s of an edge; between two of its elements the mean of both.
    fn on_edge(&self, edge: usize, s: f64, of: impl Fn(usize, f64) -> f64) -> f64 {
        let at = elements_at(self.mesh, edge, s);
        at.iter().map(|&(e, t)| of(e, t)).sum::<f64>() / at.len() as f64
    }

    fn mean_displacement(&self, field: &ElasticField<'_>, side: usize) -> [f64; 2] {
        let (mut sum, mut length) = ([0.0; 2], 0.0);
        for e in self.elements_of(side) {
            self.integrate(e, |t, ds| {
                let (u, _) = field.on_boundary(e, t);
                (0..2).for_each(|i| sum[i] += ds * u[i]);
                length += ds;
            });
        }
        sum.map(|sum| sum / length)
    }

    /// The elements of a side.
    pub(crate) fn elements_of(&self, side: usize) -> impl Iterator<Item = usize> {
        (0..self.mesh.len()).filter(move |&e| self.mesh.side[e] == side)
    }

    /// Calls `call` with the points of an element and their weights ds.
    pub(crate) fn integrate(&self, e: usize, call: impl FnMut(f64, f64)) {
        self.integrate_with(MORE[usize::from(!self.mesh.is_line(e))], e, call);
    }

    fn integrate_with(&self, more: usize, e: usize, mut call: impl FnMut(f64, f64)) {
        let rule = gauss_legendre(self.space.degree(e) + more);
        rule.points.iter().zip(&rule.weights).for_each(|(&t, &w)| call(t, w * self.mesh.speed(e, t)));
    }

    /// Whether the weighted force of a side is that of its nodal forces, and not ∫ w·t; stabilised multipliers have none at nodes.
    pub(crate) fn is_balanced(&self, side: usize) -> bool {
        let (problem, own) = (&self.scene.problem, &self.scene.problem.sides[side]);
        let touched = problem.contact(side).is_some() && self.scene.method.multiplier == Multiplier::Biorthogonal;
        own.holds(0) || own.holds(1) || own.springs.is_some() || touched
    }

    /// ∫ w·t of a moment or weighted force, or the part of it that nodes do not have.
    fn work_of_traction(&self, field: &ElasticField<'_>, kind: &QuantityKind) -> f64 {
        let Some((side, w)) = kind.weighted_side() else { return f64::NAN };
        let balanced = self.is_balanced(side);
        // the forces of springs are integrals themselves
        if balanced && self.scene.problem.sides[side].springs.is_some() {
            return 0.0;
        }
        // the nodes of straight elements have rotations
        let is_rotation = matches!(kind, QuantityKind::Moment { .. });
        let is_whole = |e: usize| is_rotation && self.mesh.is_line(e);
        let mut sum = 0.0;
        for e in self.elements_of(side).filter(|&e| !balanced || !is_whole(e)) {
            let basis = self.space.basis(e);
            let of_nodes: Vec<[f64; 2]> = self.space.element_nodes(e).map(|node| w(self.space.points[node])).collect();
            let mut phi = vec![0.0; of_nodes.len()];
            let more = if is_rotation { MORE[usize::from(!self.mesh.is_line(e))] } else { OF_WEIGHTS };
            self.integrate_with(more, e, |t, ds| {
                let mut rest = w(self.mesh.point(e, t));
                if balanced {
                    basis.evaluate(t, &mut phi);
                    for (w, phi) in of_nodes.iter().zip(&phi) {
                        (0..2).for_each(|i| rest[i] -= phi * w[i]);
                    }
                }
                sum += ds * dot(rest, self.reacting(side, field.traction(e, t), self.mesh.normal(e, t), balanced));
            });
        }
        sum
    }

    /// The part of a traction that a support or an obstacle bears.
    fn reacting(&self, side: usize, t: [f64; 2], n: [f64; 2], balanced: bool) -> [f64; 2] {
        let own = &self.scene.problem.sides[side];
        match self.scene.problem.contact(side) {
            _ if !balanced => t,
            Some(contact) if matches!(contact.friction, Friction::None) => n.map(|c| c * dot(t, n)),
            Some(_) => t,
            None => [0, 1].map(|i| if own.holds(i) { t[i] } else { 0.0 }),
        }
    }

    fn opening(&self, field: &ElasticField<'_>, x: [f64; 2]) -> f64 {
        let displacement = |(edge, s): (usize, f64)| field.on_edge(edge, s).0;
        match self.scene.problem.surfaces_at(x) {
            None => f64::NAN,
            Some(Surfaces::Faces([a, b])) => {
                let n = self.scene.problem.outline.edges()[a.0].normal(a.1);
                dot(minus(displacement(b), displacement(a)), n)
            }
            Some(Surfaces::Contact(edge, s)) => {
                let side = self.scene.problem.outline.edges()[edge].side;
                let Some(contact) = self.scene.problem.contact(side) else { return f64::NAN };
                let gap = self.gap(side, &contact.gap);
                let own = displacement((edge, s));
                self.on_edge(edge, s, |e, t| {
                    let site = Site { element: e, t, s, point: self.mesh.point(e, t) };
                    let there = self.seen(e, t).map_or([0.0; 2], |seen| displacement((seen.edge, seen.s)));
                    (gap.value)(&site) + dot(minus(there, own), self.direction(e, t))
                })
            }
        }
    }

    /// Whether the points of quantities are within one element of an end of contact or stick, in the order of [`Self::named`].
    pub(crate) fn near_transitions(&self, ends: &[Located]) -> Vec<bool> {
        let is_near = |x: [f64; 2]| {
            let Ok((edge, s)) = self.scene.problem.pressed_at(x) else { return false };
            let longest = elements_at(self.mesh, edge, s).iter().fold(0.0, |longest: f64, &(e, _)| {
                let [a, b] = self.mesh.span[e];
                longest.max((b - a).abs())
            });
            ends.iter().any(|end| end.edge == edge && (end.s - s).abs() <= longest + end.off.abs() + SAME_PLACE)
        };
        let of = |kind: &QuantityKind| match *kind {
            QuantityKind::PressureAt(x) => vec![is_near(x)],
            _ => vec![false; components(kind)],
        };
        self.scene.quantities.iter().flat_map(|quantity| of(&quantity.kind)).collect()
    }
}

/// The elements of an edge at one of its parameters, two at a vertex between them, and the reference coordinates there.
pub(crate) fn elements_at(mesh: &Mesh, edge: usize, s: f64) -> Vec<(usize, f64)> {
    let of = |e: usize| {
        let [a, b] = mesh.span[e];
        let within = mesh.edge[e] == edge && a.min(b) - SAME_PLACE <= s && s <= a.max(b) + SAME_PLACE;
        within.then(|| (e, (2.0 * (s - a) / (b - a) - 1.0).clamp(-1.0, 1.0)))
    };
    (0..mesh.len()).filter_map(of).collect()
}
