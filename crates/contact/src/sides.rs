//! What each element of a contact side contributes: weights, weighted gaps and friction bounds at its nodes.

use steklov_bem_operators::{Datum, Mesh, Site, Space, side_moments};
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
}

/// An element of the contact boundary; the vectors have one entry for each of its p+1 nodes.
pub(crate) struct ContactElement {
    pub element: usize,
    pub side: usize,
    /// ∫ φ_j = w_j |d|.
    pub weights: Vec<f64>,
    /// ∫ g ψ_j.
    pub gaps: Vec<f64>,
    /// g at the start and the end, the limits from within.
    pub limits: [f64; 2],
    /// F and μ at the node, seen from this element.
    pub friction: Vec<[f64; 2]>,
}

/// A bound or a gap that changes by more than this part of its largest value next to a node jumps there.
pub(crate) const JUMP: f64 = 1e-4;

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
        let moments = side_moments(mesh, space, data.side, &data.gap)?;
        let mut friction: Vec<Vec<[f64; 2]>> = moments.iter().map(|(_, m)| vec![[0.0; 2]; m.len()]).collect();
        for (k, datum) in [&data.bound, &data.coefficient].into_iter().enumerate() {
            if let Some(datum) = datum {
                let values = nodal_values(mesh, space, data.side, datum)?;
                let all = friction.iter_mut().flatten().zip(values.into_iter().flatten());
                all.for_each(|(friction, value)| friction[k] = value);
            }
        }
        for ((e, moments), friction) in moments.into_iter().zip(friction) {
            if found[e].is_some() {
                let what = format!("side \"{}\" has two contact conditions", mesh.side_names[data.side]);
                return Err(ContactError::Inconsistent { what });
            }
            let (basis, half) = (space.basis(e), mesh.length(e) / 2.0);
            let dual = BiorthogonalBasis::new(basis);
            let gaps = (0..=basis.degree)
                .map(|i| (0..=basis.degree).map(|j| dual.coefficients[(i, j)] * moments[j]).sum())
                .collect();
            let weights = basis.weights.iter().map(|w| w * half).collect();
            let limit = |t: f64| data.gap.at(mesh, &Site::new(mesh, e, from_within(mesh, e, t)));
            let limits = [limit(-1.0)?, limit(1.0)?];
            found[e] = Some(ContactElement { element: e, side: data.side, weights, gaps, limits, friction });
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

/// A reference coordinate, at an end of the element moved just inside: where a datum jumps there, its limit from within.
pub(crate) fn from_within(mesh: &Mesh, e: usize, t: f64) -> f64 {
    let inside = 1.0 - mesh.resolution(e);
    t.clamp(-inside, inside)
}

/// Values of F or μ at the nodes of the elements of a side. Where it jumps: inside an element the mean of the limits from
/// both sides, at its ends the limit from within.
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
    Ok(samples.iter().map(|nodes| nodes.iter().map(limit).collect()).collect())
}
