//! The multiplier as a function on the contact boundary.

use steklov_bem_operators::{Mesh, Space};
use steklov_quadrature::BiorthogonalBasis;

use crate::ContactBoundary;
use crate::law::{cross, dot};

/// λ^hp = Σ λ_i ψ̃_i on one element, as a polynomial: `[λ_n, λ_t]` (stress) at each of its p+1 Lobatto points.
///
/// Between the points it is Σ_j λ^hp(x_j) φ_j(t), at element ends it jumps. `multipliers` are those of all conditions in
/// the order of [`ContactBoundary::nodes`]. A held end whose dual function went to a neighbour has the neighbour's
/// multiplier. On an element outside the contact boundary the multiplier is 0.
///
/// For p ≥ 2 and next to jumps λ^hp oscillates about the weighted averages λ_i: it may be negative where these are not.
///
/// # Panics
/// If there are fewer multipliers than conditions.
pub fn multiplier_trace(
    mesh: &Mesh,
    space: &Space,
    boundary: &ContactBoundary,
    multipliers: &[[f64; 2]],
    element: usize,
) -> Vec<[f64; 2]> {
    let (side, normal) = (mesh.side[element], mesh.normal(element));
    let basis = space.basis(element);
    let mut weighted = vec![[0.0; 2]; basis.degree + 1];
    let local = |node: usize| space.element_nodes(element).position(|n| n == node);
    let (mut number, mut found) = (0, Vec::new());
    for node in &boundary.nodes {
        let j = local(node.node);
        for condition in &node.conditions {
            // a bend has a condition for each of its elements
            let here = cross(condition.normal, normal).abs() <= 1e-12 && dot(condition.normal, normal) > 0.0;
            if let Some(j) = j
                && here
                && condition.shares.iter().any(|s| s.side == side)
            {
                weighted[j] = multipliers[number];
                found.push(number);
            }
            number += 1;
        }
    }
    for transfer in &boundary.transfers {
        if let Some(j) = local(transfer.node)
            && found.contains(&transfer.condition)
        {
            weighted[j][transfer.functional] = multipliers[transfer.condition][transfer.functional];
        }
    }
    let dual = BiorthogonalBasis::new(basis).coefficients;
    let value = |j: usize, k: usize| weighted.iter().enumerate().map(|(i, w)| w[k] * dual[(i, j)]).sum();
    (0..=basis.degree).map(|j| [value(j, 0), value(j, 1)]).collect()
}
