//! Checks that the steps of a file are steps of a scene, because a file may come from anywhere.

use steklov_bem_operators::{Mark, Mesh, SAME_PLACE, Subdivision};
use steklov_contact::TipKind;
use steklov_io::{Group, IoError, invalid, open_group};
use steklov_model::mesh::layout::Layout;
use steklov_model::run::adaptive_loop::Step;
use steklov_model::run::boundary_elements::{BoundaryElements, RefinedMesh};
use steklov_problem::Scene;

/// Checks the step that was read from the group `at`: the numbers are possible, its mesh is one of the scene's polygon,
/// and its transitions are on sides in contact.
///
/// # Errors
/// [`IoError::Invalid`] names the dataset and what is wrong in it.
pub(super) fn check(at: &Group, step: &Step<BoundaryElements>, scene: &Scene) -> Result<(), IoError> {
    for (name, value) in [("energy", step.energy), ("strain_energy", step.strain)] {
        if !value.is_finite() {
            return Err(invalid(at, name, format!("it is {value}")));
        }
    }
    check_mesh(&open_group(at, "mesh")?, &step.layout.mesh, scene)?;
    let RefinedMesh { mesh, tips, cuts, .. } = &step.layout;
    let subdivision = Subdivision::new(mesh, &vec![Mark::Keep; mesh.len()]);
    let ends = cuts.iter().flat_map(|cuts| cuts.cuts.ends());
    for (edge, s) in ends {
        if subdivision.edges[edge].iter().all(|piece| (piece.start - s).abs() > SAME_PLACE) {
            return Err(invalid(at, "cuts", format!("the mesh has no vertex where a cut ends, {s} along edge {edge}")));
        }
    }
    let dofs = Layout { subdivision, tips: tips.clone(), cuts: cuts.clone() }.dofs();
    if step.dofs != dofs {
        return Err(invalid(at, "dofs", format!("{}, but the mesh has {dofs}", step.dofs)));
    }
    for (row, tip) in step.layout.tips.iter().enumerate() {
        check_place(at, "tips", row, (tip.edge, tip.s), scene)?;
        let directions: &[i8] = if tip.kind == TipKind::SlipReversal { &[0] } else { &[-1, 1] };
        if !directions.contains(&tip.regular) {
            return Err(invalid(at, "tips", format!("row {row}: regular is {}, not of {directions:?}", tip.regular)));
        }
    }
    for (row, found) in step.layout.located.iter().enumerate() {
        check_place(at, "transitions", row, (found.edge, found.s), scene)?;
        if !found.off.is_finite() || found.curvature.is_some_and(|b| !b.is_finite()) {
            return Err(invalid(at, "transitions", format!("row {row}: a number that is not finite")));
        }
    }
    Ok(())
}

/// Checks that a place is on an edge in contact.
fn check_place(at: &Group, name: &str, row: usize, (edge, s): (usize, f64), scene: &Scene) -> Result<(), IoError> {
    let edges = scene.problem.outline.edges();
    let Some(found) = edges.get(edge) else {
        return Err(invalid(at, name, format!("row {row}: edge {edge} of {}", edges.len())));
    };
    if scene.contact(found.side).is_none() {
        return Err(invalid(at, name, format!("row {row}: edge {edge} is not in contact")));
    }
    if !(0.0..=1.0).contains(&s) {
        return Err(invalid(at, name, format!("row {row}: edge parameter {s}, not from 0 to 1")));
    }
    Ok(())
}

/// Checks that the elements of every edge cover it from 0 to 1 in order, and make this mesh.
fn check_mesh(at: &Group, mesh: &Mesh, scene: &Scene) -> Result<(), IoError> {
    let edges = scene.problem.outline.edges().len();
    if let Some((e, edge)) = mesh.edge.iter().enumerate().find(|(_, edge)| **edge >= edges) {
        return Err(invalid(at, "edge", format!("element {e} is on edge {edge} of {edges}")));
    }
    let subdivision = Subdivision::new(mesh, &vec![Mark::Keep; mesh.len()]);
    for edge in 0..edges {
        let pieces = subdivision.edges.get(edge).map_or(&[][..], Vec::as_slice);
        let ends = (pieces.first().map(|p| p.start), pieces.last().map(|p| p.end));
        let cover = ends == (Some(0.0), Some(1.0)) && pieces.windows(2).all(|pair| pair[0].end == pair[1].start);
        if !cover || pieces.iter().any(|p| p.end <= p.start) {
            return Err(invalid(at, "span", format!("the elements of edge {edge} do not cover it from 0 to 1")));
        }
    }
    let made = subdivision.mesh(&scene.problem.outline).map_err(|e| invalid(at, "span", e))?;
    for (name, same, what) in [
        ("nodes", made.vertices == mesh.vertices, "they are not where edge and span have them on the scene's polygon"),
        ("elements", made.next == mesh.next, "they do not follow each other as the scene's polygon has them"),
        ("degree", made.degree == mesh.degree, "the elements are not in the order of the scene's polygon"),
        ("edge", made.edge == mesh.edge, "the elements are not in the order of the scene's polygon"),
        ("side", made.side == mesh.side, "it is not that of the edge"),
        ("span", made.span == mesh.span, "it is not in the direction of the edge"),
        ("side_names", made.side_names == mesh.side_names, "they are not the scene's"),
    ] {
        if !same {
            return Err(invalid(at, name, what));
        }
    }
    Ok(())
}
