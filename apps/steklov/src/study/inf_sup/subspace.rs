//! Biorthogonal and continuous multipliers as subspaces of the discontinuous ones of the same mesh and degree.

use faer::Mat;
use steklov_bem_operators::Mesh;
use steklov_contact::{ContactBoundary, MultiplierSpace, multiplier_trace};

use crate::study::supported::Supported;

/// Values of the ψ̃_i of contact conditions at the nodes of W_hp, a column each: unknown 2·node along n, 2·node+1 along t.
/// Components that a support has taken have no column.
pub(super) fn biorthogonal(body: &Supported, boundary: &ContactBoundary, full: &MultiplierSpace) -> Mat<f64> {
    let Supported { mesh, space, .. } = body;
    let conditions: usize = boundary.nodes.iter().map(|n| n.conditions.len()).sum();
    let mut columns = Vec::new();
    for k in 0..2 * conditions {
        let mut multipliers = vec![[0.0; 2]; conditions];
        multipliers[k / 2][k % 2] = 1.0;
        let mut column = vec![0.0; 2 * full.nodes.len()];
        for (e, nodes) in elements(mesh, full) {
            let trace = multiplier_trace(mesh, space, boundary, &multipliers, e);
            nodes.iter().zip(trace).for_each(|(node, v)| (0..2).for_each(|i| column[2 * node + i] = v[i]));
        }
        columns.push(column);
    }
    // a held component has an unknown in name only: its condition has no weight there
    let weights = boundary.contact.iter().flat_map(|n| &n.conditions).flat_map(|c| [c.normal_weight, c.tangent_weight]);
    let mut weights = weights.map(|w| w > 0.0);
    columns.retain(|_| weights.next() == Some(true));
    matrix(2 * full.nodes.len(), &columns)
}

/// Values of the φ_i of displacements on each straight edge at the nodes of W_hp, as in [`biorthogonal`].
/// Those that the supports hold are left out: what is left is as many as the displacements there.
pub(super) fn continuous(body: &Supported, full: &MultiplierSpace) -> Mat<f64> {
    let Supported { mesh, space, held, .. } = body;
    let mut unknowns: Vec<((usize, usize, usize), Vec<f64>)> = Vec::new();
    for (e, nodes) in elements(mesh, full) {
        for (displacement, &node) in space.element_nodes(e).zip(&nodes) {
            for k in 0..2 {
                let direction = full.nodes[node].frame[k];
                let is_held = |i: usize| held.iter().any(|h| h.0 == 2 * displacement + i);
                if (0..2).all(|i| direction[i].abs() < 1e-12 || is_held(i)) {
                    continue;
                }
                let key = (mesh.edge[e], displacement, k);
                let at = unknowns.iter().position(|u| u.0 == key).unwrap_or_else(|| {
                    unknowns.push((key, vec![0.0; 2 * full.nodes.len()]));
                    unknowns.len() - 1
                });
                unknowns[at].1[2 * node + k] = 1.0;
            }
        }
    }
    matrix(2 * full.nodes.len(), &unknowns.into_iter().map(|u| u.1).collect::<Vec<_>>())
}

/// The contact elements of the mesh, each with its nodes of W_hp in the order of its own Lobatto points.
fn elements(mesh: &Mesh, full: &MultiplierSpace) -> Vec<(usize, Vec<usize>)> {
    let of = |e: usize| {
        let cell = full.cells_of(mesh, e).into_iter().next()?;
        let mut nodes = full.elements[cell.multiplier].nodes.clone();
        if mesh.span[e][0] > mesh.span[e][1] {
            nodes.reverse();
        }
        Some((e, nodes))
    };
    (0..mesh.len()).filter_map(of).collect()
}

fn matrix(rows: usize, columns: &[Vec<f64>]) -> Mat<f64> {
    Mat::from_fn(rows, columns.len(), |i, j| columns[j][i])
}

/// Tᵀ G T.
pub(super) fn restricted(form: &Mat<f64>, to: &Option<Mat<f64>>) -> Mat<f64> {
    match to {
        None => form.clone(),
        Some(t) => t.transpose() * (form * t),
    }
}
