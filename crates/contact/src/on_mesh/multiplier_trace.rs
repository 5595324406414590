//! The multiplier as a function on the contact boundary.

use steklov_bem_operators::{Mesh, Space};
use steklov_elastic::plane::{cross, dot};
use steklov_quadrature::BiorthogonalBasis;

use crate::ContactBoundary;

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
    let side = mesh.side[element];
    let basis = space.basis(element);
    let frame = |j: usize| [mesh.normal(element, basis.nodes[j]), mesh.tangent(element, basis.nodes[j])];
    let mut weighted = vec![[0.0; 2]; basis.degree + 1];
    let local = |node: usize| space.element_nodes(element).position(|n| n == node);
    let (mut number, mut found) = (0, Vec::new());
    for node in &boundary.nodes {
        let j = local(node.node);
        for condition in &node.conditions {
            // a bend has a condition for each of its elements
            let here = |normal: [f64; 2]| {
                let aligned = if mesh.is_line(element) { 1e-12 } else { 1e-8 };
                cross(condition.normal, normal).abs() <= aligned && dot(condition.normal, normal) > 0.0
            };
            if let Some(j) = j
                && here(frame(j)[0])
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
    if !mesh.is_line(element) {
        // the vectors Σ_i λ_i ψ̃_i with the frame and the |γ'| of node i
        let speed: Vec<f64> = basis.nodes.iter().map(|&t| mesh.speed(element, t)).collect();
        let vector = |i: usize| -> [f64; 2] {
            let [n, t] = frame(i);
            [0, 1].map(|k| speed[i] * (weighted[i][0] * n[k] + weighted[i][1] * t[k]))
        };
        let vectors: Vec<[f64; 2]> = (0..=basis.degree).map(vector).collect();
        let at = |j: usize| {
            let sum = |k: usize| vectors.iter().enumerate().map(|(i, v)| v[k] * dual[(i, j)]).sum::<f64>() / speed[j];
            let (v, frame) = ([sum(0), sum(1)], frame(j));
            frame.map(|d| dot(v, d))
        };
        return (0..=basis.degree).map(at).collect();
    }
    let value = |j: usize, k: usize| weighted.iter().enumerate().map(|(i, w)| w[k] * dual[(i, j)]).sum();
    (0..=basis.degree).map(|j| [value(j, 0), value(j, 1)]).collect()
}
