//! Points of the boundary at which stresses are infinite, so that numbers there are those of the mesh.

use std::f64::consts::PI;

use steklov_bem_operators::{Mesh, SAME_PLACE};
use steklov_elastic::plane::distance;
use steklov_problem::{Scene, facets};

use crate::answer::data_jumps::data_jumps;
use crate::answer::wedges::{Vertex, wedges, wedges_of_single_bodies};
use crate::solve::contact_rows::ContactRow;

/// The points of infinite stress: where the exponents of the bodies that meet there let stresses grow without bound, and where
/// data jump. Cells of different moduli about a point count as one material; on the interface of such a body with the medium
/// around it no point is judged.
pub(crate) fn singular_points(scene: &Scene, mesh: &Mesh, rows: &[ContactRow]) -> Vec<[f64; 2]> {
    singular_with(scene, mesh, rows, &[])
}

/// These points of bodies that have other angles there than as they are drawn.
fn singular_with(scene: &Scene, mesh: &Mesh, rows: &[ContactRow], turns: &[([f64; 2], f64)]) -> Vec<[f64; 2]> {
    let singular = wedges(scene, rows, turns).into_iter().filter(Vertex::is_singular);
    let of_data = data_jumps(scene, mesh, rows).into_iter().map(|jump| jump.point);
    singular.flat_map(|vertex| vertex.points).chain(of_data).collect()
}

/// Whether the pressure of contact is infinite at one of these points.
pub(crate) fn is_pressure_unbounded(scene: &Scene, mesh: &Mesh, rows: &[ContactRow]) -> bool {
    wedges(scene, rows, &[]).iter().any(Vertex::is_pressed_without_bound)
        || data_jumps(scene, mesh, rows).iter().any(|jump| jump.is_pressed)
}

/// Tells of a point whether it is one of infinite stress.
pub(crate) fn is_among(scene: &Scene, singular: &[[f64; 2]]) -> impl Fn([f64; 2]) -> bool {
    let near = SAME_PLACE * scene.problem.outline.diameter();
    move |x| singular.iter().any(|other| distance(*other, x) <= near)
}

/// Each point of infinite stress once; of polygons that stand for curves those that the curves have too.
pub(crate) fn told(scene: &Scene, mesh: &Mesh, rows: &[ContactRow], singular: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let near = SAME_PLACE * scene.problem.outline.diameter();
    let curves = facets(&scene.problem.outline);
    let turns: Vec<([f64; 2], f64)> = curves.iter().flat_map(|curve| curve.ends.clone()).collect();
    let singular = if turns.is_empty() { singular } else { singular_with(scene, mesh, rows, &turns) };
    let mut found: Vec<[f64; 2]> = Vec::new();
    for point in singular {
        let on_curve = curves.iter().any(|curve| curve.corners.contains(&point));
        if !on_curve && found.iter().all(|other| distance(*other, point) > near) {
            found.push(point);
        }
    }
    found
}

/// Exponents below that of a crack: of a vertex between a held and a free side that is re-entrant.
const STRONG: f64 = 0.45;

/// The vertices, those in contact apart, whose stresses grow faster than at the tip of a crack: the edges before and behind,
/// and the smallest exponent.
pub(crate) fn strong_vertices(scene: &Scene) -> Vec<([usize; 2], f64)> {
    let sides = |edge: usize| scene.problem.outline.edges()[edge].side;
    let held = |edge: usize| (0..2).any(|i| scene.problem.sides[sides(edge)].holds(i));
    let strong = |vertex: Vertex| {
        let [behind, before] = vertex.edges;
        let is_open = [before, behind].iter().all(|&edge| scene.contact(sides(edge)).is_none());
        let is_judged = is_open && held(before) != held(behind) && vertex.wedge.sectors[0].angle > PI + 1e-9;
        let exponent = is_judged.then(|| vertex.wedge.least_exponent_below(STRONG))??;
        Some(([before, behind], exponent))
    };
    wedges_of_single_bodies(scene).into_iter().filter_map(strong).collect()
}

/// Exponents of bodies tied to each other below which stresses grow so fast that one degree more shows little of the error: those of a
/// soft body between a stiff one and a support, 0.37, 0.12 and 0.06 in a right angle for moduli of 3, 25 and 100 times its own.
const WEAK: f64 = 0.4;

/// Whether stresses grow so where bodies that are tied meet.
pub(crate) fn are_weakly_tied(scene: &Scene) -> bool {
    let is_weak = |vertex: &Vertex| {
        vertex.wedge.sectors.len() > 1 && !vertex.goes_on && vertex.wedge.least_exponent_below(WEAK).is_some()
    };
    scene.problem.has_several_bodies() && wedges(scene, &[], &[]).iter().any(is_weak)
}
