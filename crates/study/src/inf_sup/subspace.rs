//! Biorthogonal and continuous multipliers as subspaces of the discontinuous ones of the same mesh and degree.

use faer::Mat;
use steklov_bem_operators::Mesh;
use steklov_contact::{ContactBoundary, MultiplierSpace, multiplier_trace};

use crate::supported::Supported;

/// Values of the ψ̃_i of contact conditions at the nodes of W_hp, one column each: unknown 2·node along n, 2·node+1
/// along t. A component that a support holds has no column.
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
    // the condition of a held component has no weight for it
    let weights = boundary.contact.iter().flat_map(|n| &n.conditions).flat_map(|c| [c.normal_weight, c.tangent_weight]);
    let mut weights = weights.map(|w| w > 0.0);
    columns.retain(|_| weights.next() == Some(true));
    matrix(2 * full.nodes.len(), &columns)
}

/// Values of the φ_i of displacements on each straight edge at the nodes of W_hp, as in [`biorthogonal`]. Functions
/// that the supports hold are left out, so that as many remain as there are free displacements.
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

#[cfg(test)]
mod tests {
    use steklov_bem_operators::Mesh;
    use steklov_contact::{MultiplierDegree, MultiplierMesh, pairing};

    use super::*;
    use crate::supported::contact_sides;
    use steklov_model::data::on_mesh::OnMesh;
    use steklov_problem::Scene;

    /// A trapezium on two contact sides, one of them oblique; its left side is held in x.
    const SCENE: &str = r#"
[body]
corners = [[0, 0], [2, 0], [3, 1.5], [0, 1]]
sides = ["floor", "ramp", "top", "left"]
[material]
young = 3
poisson = 0.2
[sides.floor]
contact = { gap = "0" }
[sides.ramp]
contact = { gap = "0.1", friction = { tresca = "1" } }
[sides.top]
traction = ["0", "-1"]
[sides.left]
displacement = ["0", "free"]
"#;

    fn body(scene: &Scene, degree: usize) -> (Supported, MultiplierSpace) {
        let body = Supported::new(scene, Mesh::uniform(&scene.problem.outline, 11, degree)).unwrap();
        let degree = MultiplierDegree::Relative(0);
        let full = MultiplierSpace::new(&body.mesh, &contact_sides(scene), MultiplierMesh::Same, degree).unwrap();
        (body, full)
    }

    /// ∫ ψ̃_i φ_j = δ_ij D_i along the direction of each unknown, for all displacements that are not held.
    #[test]
    fn biorthogonal_multipliers_see_one_displacement_each() {
        let scene = steklov_document::parse(SCENE, "scene", &[]).unwrap();
        for degree in [1, 2, 5] {
            let (body, full) = body(&scene, degree);
            let data = OnMesh { scene: &scene, mesh: &body.mesh, space: &body.space };
            let boundary = data.contact(&data.held().unwrap(), &[]).unwrap().unwrap();
            let t = biorthogonal(&body, &boundary, &full);
            let [n, s] = pairing(&body.mesh, &body.space, &full);
            let b = Mat::from_fn(2 * full.nodes.len(), body.space.dofs(), |i, j| [&n, &s][i % 2][(i / 2, j)]);
            let seen = t.transpose() * b;
            let mut expected = Vec::new();
            for (node, contact) in boundary.nodes.iter().zip(&boundary.contact) {
                for (place, condition) in node.conditions.iter().zip(&contact.conditions) {
                    let both = [(place.normal, condition.normal_weight), (place.tangent, condition.tangent_weight)];
                    expected.extend(both.into_iter().filter(|d| d.1 > 0.0).map(|(d, weight)| (node.node, d, weight)));
                }
            }
            assert_eq!(t.ncols(), expected.len());
            for (i, (node, direction, weight)) in expected.into_iter().enumerate() {
                for j in (0..body.space.dofs()).filter(|j| body.held.iter().all(|h| h.0 != *j)) {
                    let want = if j / 2 == node { weight * direction[j % 2] } else { 0.0 };
                    assert!((seen[(i, j)] - want).abs() < 1e-13, "p = {degree}, ({i}, {j}): {}", seen[(i, j)]);
                }
            }
        }
    }

    /// The φ_i of an edge sum up to 1; held ones are left out.
    #[test]
    fn continuous_multipliers_are_the_traces_of_displacements() {
        let scene =
            steklov_document::parse(SCENE, "scene", &["sides.left.displacement=[\"free\", \"0\"]".into()]).unwrap();
        for degree in [1, 3] {
            let (body, full) = body(&scene, degree);
            let t = continuous(&body, &full);
            let elements = |side: usize| (0..body.mesh.len()).filter(|&e| body.mesh.side[e] == side).count();
            // u_n is held at one end of the floor
            assert_eq!(t.ncols(), 2 * (degree * (elements(0) + elements(1)) + 2) - 1);
            let [_, s] = pairing(&body.mesh, &body.space, &full);
            let columns: Vec<usize> = (0..t.ncols())
                .filter(|&c| (0..t.nrows()).any(|i| t[(i, c)] != 0.0 && i % 2 == 1 && full.nodes[i / 2].side == 0))
                .collect();
            assert_eq!(columns.len(), degree * elements(0) + 1);
            let nodes: Vec<usize> = (0..body.space.nodes()).filter(|&n| body.space.points[n][1] == 0.0).collect();
            assert_eq!(nodes.len(), columns.len());
            // Σ_i ∫ φ_i φ_j = ∫ φ_j, the Lobatto weights; t = (1, 0) on the floor
            let mut weights = vec![0.0; body.space.nodes()];
            for e in (0..body.mesh.len()).filter(|&e| body.mesh.side[e] == 0) {
                for (w, node) in body.space.basis(e).weights.iter().zip(body.space.element_nodes(e)) {
                    weights[node] += w * body.mesh.length(e) / 2.0;
                }
            }
            for node in nodes {
                let seen = |c: &usize| -> f64 {
                    (0..full.nodes.len()).map(|k| t[(2 * k + 1, *c)] * s[(k, 2 * node)]).sum::<f64>()
                };
                let sum: f64 = columns.iter().map(seen).sum();
                assert!((sum - weights[node]).abs() < 1e-14, "p = {degree}: {sum}, not {}", weights[node]);
            }
        }
    }
}
