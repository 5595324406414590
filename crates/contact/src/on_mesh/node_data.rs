//! Gap, bound and coefficient at the nodes of stabilised multipliers.

use steklov_bem_operators::{Datum, Mesh, Site};
use steklov_quadrature::gauss_legendre;

use crate::{ContactError, MultiplierSpace, SideData};

/// Gauss points for data on a smooth part, at least.
const DATA_POINTS: usize = 24;
/// Limits of data at a node are taken at this part of its element from it.
const INWARDS: f64 = 1e-9;

/// The data at a node.
#[derive(Clone, Copy, Default)]
pub(crate) struct NodeData {
    /// ∫ g μ / ∫ μ.
    pub(crate) gap: f64,
    /// F and μ at the node, the mean of the limits.
    pub(crate) bound: f64,
    pub(crate) coefficient: f64,
}

/// The data at every node.
pub(crate) fn node_data(
    mesh: &Mesh,
    multipliers: &MultiplierSpace,
    sides: &[SideData<'_>],
) -> Result<Vec<NodeData>, ContactError> {
    let mut data = vec![NodeData::default(); multipliers.nodes.len()];
    let side = |index: usize| {
        sides.iter().find(|s| s.side == index).ok_or_else(|| ContactError::Inconsistent {
            what: format!("side \"{}\" has multipliers but no gap", mesh.side_names[index]),
        })
    };
    for cell in multipliers.cells(mesh) {
        let (e, element) = (cell.element, &multipliers.elements[cell.multiplier]);
        let gap = &side(element.side)?.gap;
        let mut breaks = vec![cell.span[0], cell.span[1]];
        breaks.extend((gap.kinks)(e).into_iter().filter(|t| *t > cell.span[0] && *t < cell.span[1]));
        breaks.sort_by(f64::total_cmp);
        for part in breaks.windows(2) {
            let rule = gauss_legendre(DATA_POINTS.max(element.degree)).mapped(part[0], part[1]);
            for (&t, &w) in rule.points.iter().zip(&rule.weights) {
                let g = gap.at(mesh, &Site::new(mesh, e, t))?;
                let mu = multipliers.basis(cell.multiplier, mesh.edge_parameter(e, t));
                for (&k, mu) in element.nodes.iter().zip(mu) {
                    data[k].gap += w * mesh.speed(e, t) * mu * g / multipliers.nodes[k].weight;
                }
            }
        }
    }
    let mut limits = vec![0.0; data.len()];
    for element in &multipliers.elements {
        let SideData { bound, coefficient, .. } = side(element.side)?;
        let [a, b] = element.span;
        for &k in &element.nodes {
            let margin = INWARDS * (b - a);
            // on both sides of a node inside the element, where data may jump as well
            let beside = [-margin, margin].map(|d| (multipliers.nodes[k].s + d).clamp(a + margin, b - margin));
            let value = |f: &Option<Datum<'_>>| -> Result<f64, ContactError> {
                let Some(f) = f else { return Ok(0.0) };
                let [below, above] = beside.map(|s| value_at(mesh, element.edge, s, f));
                Ok((below? + above?) / 2.0)
            };
            data[k].bound += value(bound)?;
            data[k].coefficient += value(coefficient)?;
            limits[k] += 1.0;
        }
    }
    for (d, count) in data.iter_mut().zip(limits) {
        (d.bound, d.coefficient) = (d.bound / count, d.coefficient / count);
    }
    Ok(data)
}

/// A bound or coefficient, at least 0, at an edge parameter.
fn value_at(mesh: &Mesh, edge: usize, s: f64, bound: &Datum<'_>) -> Result<f64, ContactError> {
    let inside = |e: &usize| mesh.edge[*e] == edge && (mesh.span[*e][0] - s) * (mesh.span[*e][1] - s) <= 0.0;
    let Some(e) = (0..mesh.len()).find(inside) else { return Ok(0.0) };
    let [s0, s1] = mesh.span[e];
    let site = Site::new(mesh, e, 2.0 * (s - s0) / (s1 - s0) - 1.0);
    let f = bound.at(mesh, &site)?;
    if f < 0.0 {
        let ([x, y], side) = (site.point, &mesh.side_names[mesh.side[e]]);
        let what = format!("{} on side \"{side}\" is {f} at ({x}, {y}); it must be at least 0", bound.name);
        return Err(ContactError::Inconsistent { what });
    }
    Ok(f)
}
