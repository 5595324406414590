//! What each element of a contact side contributes: weights, weighted gaps and friction bounds at its nodes.

use steklov_bem_operators::{Curve, Datum, Mesh, Shape, Site, Space, side_moments};
use steklov_quadrature::BiorthogonalBasis;

use crate::ContactError;

/// Data of one contact side.
#[derive(Clone, Copy)]
pub struct SideData<'a> {
    /// Index of the side in the mesh.
    pub side: usize,
    /// Gap g (length), measured along the outward normal; negative is an initial overlap.
    pub gap: Datum<'a>,
    /// Tresca's friction bound F ≥ 0 (stress).
    pub bound: Option<Datum<'a>>,
    /// Coulomb's coefficient of friction μ ≥ 0. Without both the side is frictionless; with both the bound is F + μ λ_n.
    pub coefficient: Option<Datum<'a>>,
    /// The other body that the side faces; none for a rigid obstacle.
    pub beyond: Option<Beyond<'a>>,
}

/// Another body that a side faces.
#[derive(Clone, Copy)]
pub struct Beyond<'a> {
    /// The elements of the side that face it.
    pub elements: &'a [usize],
    /// The direction in which contact acts at a point of an element, a unit vector out of the body.
    pub direction: &'a (dyn Fn(usize, f64) -> [f64; 2] + Sync),
}

/// An element of the contact boundary; the vectors have one entry for each of its p+1 nodes.
pub(crate) struct ContactElement {
    pub element: usize,
    pub side: usize,
    /// The normals at its nodes; for an element that faces another body the directions of contact.
    pub normals: Vec<[f64; 2]>,
    /// Whether it faces another body.
    pub joined: bool,
    /// w_j |γ'(t_j)|, which is ∫ φ_j on lines and arcs.
    pub weights: Vec<f64>,
    /// ∫ g ψ_j.
    pub gaps: Vec<f64>,
    /// g at the start and the end, the limits from within.
    pub limits: [f64; 2],
    /// F and μ at the node, seen from this element.
    pub friction: Vec<[f64; 2]>,
}

/// A direction of contact that changes by more next to a node turns there.
const TURNED: f64 = 1e-9;

/// A bound or a gap that changes by more than this part of its largest value next to a node jumps there.
pub(crate) const JUMP: f64 = 1e-4;

/// Nodal bounds whose integral is off by less than this part are taken as they are.
const FOLLOWED: f64 = 0.1;

/// All contact elements, each loop in the order of traversal, beginning where the contact boundary begins.
pub(crate) fn contact_elements(
    mesh: &Mesh,
    space: &Space,
    sides: &[SideData<'_>],
) -> Result<Vec<ContactElement>, ContactError> {
    let mut found: Vec<Option<ContactElement>> = (0..mesh.len()).map(|_| None).collect();
    for data in sides {
        if data.side >= mesh.side_names.len() {
            let what = format!("side {} of {} is to be in contact", data.side, mesh.side_names.len());
            return Err(ContactError::Inconsistent { what });
        }
        let speeds = RelativeSpeed::new(mesh);
        let gap = |site: &Site| (data.gap.value)(site) / speeds.at(site.element, site.t);
        let moments = side_moments(mesh, space, data.side, &Datum { value: &gap, ..data.gap })?;
        let mut friction: Vec<Vec<[f64; 2]>> = moments.iter().map(|(_, m)| vec![[0.0; 2]; m.len()]).collect();
        for (k, datum) in [&data.bound, &data.coefficient].into_iter().enumerate() {
            if let Some(datum) = datum {
                let values = nodal_values(mesh, space, data.side, datum)?;
                let all = friction.iter_mut().flatten().zip(values.into_iter().flatten());
                all.for_each(|(friction, value)| friction[k] = value);
            }
        }
        let faces = |e: &usize| data.beyond.is_none_or(|beyond| beyond.elements.contains(e));
        for ((e, moments), friction) in moments.into_iter().zip(friction).filter(|((e, _), _)| faces(e)) {
            if found[e].is_some() {
                let what = format!("side \"{}\" has two contact conditions", mesh.side_names[data.side]);
                return Err(ContactError::Inconsistent { what });
            }
            let (basis, half) = (space.basis(e), mesh.length(e) / 2.0);
            let dual = BiorthogonalBasis::new(basis);
            let speed: Vec<f64> = basis.nodes.iter().map(|&t| speeds.at(e, t)).collect();
            let gaps = (0..=basis.degree)
                .map(|i| (0..=basis.degree).map(|j| dual.coefficients[(i, j)] * moments[j]).sum::<f64>() * speed[i])
                .collect();
            let weights = basis.weights.iter().zip(&speed).map(|(w, v)| w * half * v).collect();
            let limit = |t: f64| data.gap.at(mesh, &Site::new(mesh, e, from_within(mesh, e, t)));
            let limits = [limit(-1.0)?, limit(1.0)?];
            let normal = |&t: &f64| match data.beyond {
                Some(beyond) => {
                    let [at, within] = [t, from_within(mesh, e, t)].map(|t| (beyond.direction)(e, t));
                    if (0..2).all(|i| (at[i] - within[i]).abs() < TURNED) { at } else { within }
                }
                None => mesh.normal(e, t),
            };
            found[e] = Some(ContactElement {
                element: e,
                side: data.side,
                normals: basis.nodes.iter().map(normal).collect(),
                joined: data.beyond.is_some(),
                weights,
                gaps,
                limits,
                friction,
            });
        }
    }
    let previous = mesh.previous();
    let begins = |e: &usize| found[*e].is_some() && found[previous[*e]].is_none();
    let starts: Vec<usize> = (0..mesh.len()).filter(begins).chain(0..mesh.len()).collect(); // the rest: closed loops
    let mut ordered = Vec::new();
    for mut e in starts {
        while let Some(element) = found[e].take() {
            ordered.push(element);
            e = mesh.next[e];
        }
    }
    Ok(ordered)
}

/// |γ'| over half of the length of the elements: 1 except on polynomial curves.
struct RelativeSpeed {
    curves: Vec<Option<(Curve, f64)>>,
}

impl RelativeSpeed {
    fn new(mesh: &Mesh) -> Self {
        let curve = |e: usize| match mesh.shape[e] {
            Shape::Polynomial(_) => Some((mesh.curve(e), mesh.length(e) / 2.0)),
            _ => None,
        };
        Self { curves: (0..mesh.len()).map(curve).collect() }
    }

    fn at(&self, e: usize, t: f64) -> f64 {
        self.curves[e].as_ref().map_or(1.0, |(curve, half)| curve.derivative(t).norm() / half)
    }
}

/// A reference coordinate, at an end of the element moved just inside: where a datum jumps there, its limit from within.
pub(crate) fn from_within(mesh: &Mesh, e: usize, t: f64) -> f64 {
    let inside = 1.0 - mesh.resolution(e);
    t.clamp(-inside, inside)
}

/// Values of F or μ at the nodes of the elements of a side. Where it jumps: inside an element the mean of the limits from
/// both sides, at its ends the limit from within. Where the nodes do not follow it: see [`keep_integral`].
fn nodal_values(mesh: &Mesh, space: &Space, side: usize, bound: &Datum<'_>) -> Result<Vec<Vec<f64>>, ContactError> {
    let elements: Vec<usize> = (0..mesh.len()).filter(|&e| mesh.side[e] == side).collect();
    let mut samples = Vec::new(); // for each element and node: F there, and close to it on one or two sides
    for &e in &elements {
        let near = mesh.resolution(e);
        let value = |t: f64| -> Result<f64, ContactError> {
            let site = Site::new(mesh, e, t);
            let f = bound.at(mesh, &site)?;
            if f < 0.0 {
                let (name, side, [x, y]) = (bound.name, &mesh.side_names[side], site.point);
                let what = format!("{name} on side \"{side}\" is {f} at ({x}, {y}); it must be at least 0");
                return Err(ContactError::Inconsistent { what });
            }
            Ok(f)
        };
        let mut nodes = Vec::new();
        for &t in &space.basis(e).nodes {
            let close = [t - near, t + near].into_iter().filter(|t| t.abs() <= 1.0);
            nodes.push((value(t)?, close.map(value).collect::<Result<Vec<f64>, _>>()?));
        }
        samples.push(nodes);
    }
    let largest = samples.iter().flatten().fold(0.0f64, |m, (f, close)| close.iter().fold(m.max(*f), |m, c| m.max(*c)));
    let limit = |(f, close): &(f64, Vec<f64>)| {
        let jumps = close.iter().any(|c| (c - f).abs() > JUMP * largest);
        if jumps { close.iter().sum::<f64>() / close.len() as f64 } else { *f }
    };
    let mut values: Vec<Vec<f64>> = samples.iter().map(|nodes| nodes.iter().map(limit).collect()).collect();
    for ((e, moments), values) in side_moments(mesh, space, side, bound)?.into_iter().zip(&mut values) {
        let basis = space.basis(e);
        let weights: Vec<f64> = basis.nodes.iter().zip(&basis.weights).map(|(&t, w)| w * mesh.speed(e, t)).collect();
        keep_integral(&weights, &moments, values);
    }
    Ok(values)
}

/// Replaces nodal values whose sum Σ D_j F_j is far from ∫ F by ∫ F φ_j / D_j without its negative part: the element does not
/// resolve F, but has its integral.
fn keep_integral(weights: &[f64], moments: &[f64], values: &mut [f64]) {
    let whole: f64 = moments.iter().sum();
    let nodal: f64 = weights.iter().zip(values.iter()).map(|(w, f)| w * f).sum();
    if (nodal - whole).abs() <= FOLLOWED * nodal.max(whole) {
        return;
    }
    let positive: f64 = moments.iter().map(|m| m.max(0.0)).sum();
    let factor = if positive > 0.0 { whole / positive } else { 0.0 };
    for ((value, moment), weight) in values.iter_mut().zip(moments).zip(weights) {
        *value = factor * moment.max(0.0) / weight;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bound that the nodes follow stays, any other keeps its integral and sign.
    #[test]
    fn friction_bounds_keep_their_integrals() {
        let weights = [0.5, 2.0, 0.5];
        let mut linear = [1.0, 2.0, 3.0];
        keep_integral(&weights, &[0.5, 4.0, 1.5], &mut linear);
        assert_eq!(linear, [1.0, 2.0, 3.0]);
        // a peak next to the first node, which no node sees, and one that a node takes for broad
        for (moments, mut values) in [([0.7, 0.4, -0.1], [0.0; 3]), ([0.0, 0.1, 0.0], [0.0, 50.0, 0.0])] {
            keep_integral(&weights, &moments, &mut values);
            let sum: f64 = weights.iter().zip(&values).map(|(w, f)| w * f).sum();
            let whole: f64 = moments.iter().sum();
            assert!((sum - whole).abs() < 1e-15 && values.iter().all(|f| *f >= 0.0), "{values:?}");
        }
    }
}
