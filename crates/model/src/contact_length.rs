//! The length of contact by its ends, where these are extracted, and what is not known of it.
//!
//! ```text
//! length = Σ ±(vertex + shift) + the given ends,      uncertainty: that of the sum by both spaces, and Σ (½ δ²/ℓ + 0.02 δ)
//! ```
//! δ the shift of a vertex, ℓ the distance to the next end; the last term with friction alone, where B is that of the nodes.

use steklov_bem_operators::{Edge, SAME_PLACE};
use steklov_contact::{Located, Tip, TipFit, TipKind};
use steklov_elastic::plane::{cross, distance};
use steklov_problem::{Contact, Faces, Friction, Interface, Law, Multiplier, Refine, Scene};

use crate::answer::wedges::beyond_end;
use crate::estimate::contact_ends::ContactEnd;
use crate::refine::transitions::zone;
use crate::solve::contact_rows::ContactRow;

/// What a vertex that is off by δ adds, over δ² / the distance to the next end: 0.4 was measured.
const OF_VERTEX: f64 = 0.5;
/// What a fit of B to nodes adds, over δ.
const OF_FIT: f64 = 0.02;
/// Part of an edge beside its end whose pressures are compared with that at the end.
const BESIDE: f64 = 0.1;
/// Smallest part of these that a pressure at the end is, where contact is sure to reach it.
const PART_AT_CORNER: f64 = 0.5;
/// Step, over the edge, by which the slope of a gap at its end is told.
const STEP: f64 = 1e-4;
/// Part of the change of a gap over two steps that its slope may make, where it counts as none.
const FLAT: f64 = 1e-3;
/// Largest sine of the angle between two tangents that are parallel.
const PARALLEL: f64 = 1e-6;

/// Whether ends of contact along an edge can be extracted: a line, without friction or with Tresca's, on a rigid obstacle, of a body without
/// forces inside.
pub(crate) fn is_extractable(scene: &Scene, edge: &Edge) -> bool {
    let problem = &scene.problem;
    let body = &problem.bodies[problem.outline.body_of_loop(edge.loop_index)];
    let of_law = |contact: &Contact| !matches!(contact.friction, Friction::Coulomb(_));
    let unloaded = body.force.is_none() && body.far.is_none() && problem.tie().is_none();
    edge.is_line() && unloaded && problem.joint(edge.side).is_none() && problem.contact(edge.side).is_some_and(of_law)
}

/// Whether all ends of contact can be extracted.
pub(crate) fn extracts_ends(scene: &Scene) -> bool {
    let method = &scene.method;
    let follows = method.refine == Refine::Hp && method.multiplier == Multiplier::Biorthogonal;
    let mut touching =
        scene.problem.outline.edges().iter().filter(|edge| scene.contact(edge.side).is_some()).peekable();
    follows && touching.peek().is_some() && touching.all(|edge| is_extractable(scene, edge))
}

/// The length of contact up to a constant, by the solution and by the enriched spaces: the ends at `tips`, towards the open side. NaN if one
/// of them was not extracted; none where they cannot be.
pub(crate) fn length_of_contact(scene: &Scene, tips: &[Tip], ends: &[ContactEnd]) -> Option<[f64; 2]> {
    if !extracts_ends(scene) {
        return None;
    }
    let of_contact = tips.iter().filter(|tip| tip.kind == TipKind::ContactEnd).count();
    if of_contact != ends.len() {
        return Some([f64::NAN; 2]);
    }
    let edges = scene.problem.outline.edges();
    let place = |end: &ContactEnd, fit: TipFit| f64::from(end.regular) * edges[end.edge].length() * (end.s + fit.shift);
    Some([
        ends.iter().map(|end| place(end, end.of_solution)).sum(),
        ends.iter().map(|end| place(end, end.enriched)).sum(),
    ])
}

/// What misplaced vertices add to the uncertainty of the length of contact; none if an end has no vertex.
pub(crate) fn of_vertices(scene: &Scene, located: &[Located]) -> Option<f64> {
    let ends: Vec<&Located> = located.iter().filter(|end| end.kind == TipKind::ContactEnd).collect();
    let edges = scene.problem.outline.edges();
    let fitted =
        |edge: usize| scene.contact(edges[edge].side).is_some_and(|contact| contact.friction.bound().is_some());
    let of = |end: &&Located| {
        let of_fit = if fitted(end.edge) { OF_FIT * end.off.abs() } else { 0.0 };
        edges[end.edge].length() * (OF_VERTEX * end.off * end.off / zone(end, located) + of_fit)
    };
    ends.iter().all(|end| end.at_vertex).then(|| ends.iter().map(of).sum())
}

/// Whether contact that reaches an end of an edge does so for certain: with a pressure there that is no small part of those beside it, and a
/// gap without slope, or where the side goes on without a corner. Else a short piece beside the corner may be open that no node shows.
pub(crate) fn ends_at_corners_are_known(scene: &Scene, rows: &[ContactRow]) -> bool {
    unknown_at_corners(scene, rows).is_empty()
}

/// The edges, of either side of an interface, and their ends 0 or 1, that contact may or may not reach.
pub(crate) fn unknown_at_corners(scene: &Scene, rows: &[ContactRow]) -> Vec<(usize, f64)> {
    let (problem, outline) = (&scene.problem, &scene.problem.outline);
    let is_known = |&(k, end): &(usize, f64)| {
        let edge = &outline.edges()[k];
        let (at, length) = (edge.point(end), edge.length());
        let far = |row: &ContactRow| distance(row.point, at);
        let own = || rows_along(scene, rows, edge.side);
        let Some(nearest) = own().min_by(|a, b| far(a).total_cmp(&far(b))).filter(|row| row.pressure > 0.0) else {
            return true;
        };
        let Some(contact) = scene.contact(nearest.side) else { return true };
        let beside = own().filter(|row| far(row) <= BESIDE * length);
        let largest = beside.fold(0.0, |largest: f64, row| largest.max(row.pressure));
        let (beyond, is_straight) = beyond_end(outline, k, end > 0.5);
        let beyond = outline.edges()[beyond].side;
        let goes_on = is_straight && (beyond == edge.side || is_tied(scene, beyond));
        // shear at a free corner makes the pressure infinite there, of either sign
        let smooth = || matches!(contact.friction, Friction::None) || is_symmetric(scene, k, end);
        let flat = || smooth() && is_flat(edge, contact, end) && is_parallel(scene, k, end);
        // where a support holds the corner, and where no other body is, the nearest node may be far
        let is_near = far(nearest) <= BESIDE * length;
        let is_faced = problem.joint(edge.side).is_none_or(|own| problem.seen(own, k, end).is_some());
        goes_on || !is_near && !is_faced || is_near && nearest.pressure >= PART_AT_CORNER * largest && flat()
    };
    let touching = outline.edges().iter().enumerate().filter(|(_, edge)| scene.contact(edge.side).is_some());
    let carrying = touching.flat_map(|(k, _)| [(k, 0.0), (k, 1.0)]);
    carrying.chain(faced_corners(scene)).filter(|corner| !is_known(corner)).collect()
}

/// The ends of the edges that sides in contact face, other than cracks, that lie between the ends of those: edge and end 0 or 1.
fn faced_corners(scene: &Scene) -> Vec<(usize, f64)> {
    let (problem, edges) = (&scene.problem, scene.problem.outline.edges());
    let between_bodies = problem.joints().filter(|own| matches!(own.law, Law::Contact(_)) && own.faces != Faces::Cut);
    let of_joint = |own: &Interface| {
        let near = problem.coincidence(own);
        let lies_between = |&(k, end): &(usize, f64)| {
            let seen_from = problem.seen_from(own, k, end);
            let is_corner = |&(edge, s): &(usize, f64)| {
                [0.0, 1.0].iter().any(|&to| distance(edges[edge].point(s), edges[edge].point(to)) <= near)
            };
            !seen_from.is_empty() && !seen_from.iter().any(is_corner)
        };
        let faced = edges.iter().enumerate().filter(|(_, edge)| problem.facing_sides(own).contains(&edge.side));
        faced.flat_map(|(k, _)| [(k, 0.0), (k, 1.0)]).filter(lies_between).collect::<Vec<_>>()
    };
    between_bodies.flat_map(of_joint).collect()
}

/// The contact rows of a side, or of the sides that face it.
pub(crate) fn rows_along<'r>(
    scene: &'r Scene,
    rows: &'r [ContactRow],
    side: usize,
) -> impl Iterator<Item = &'r ContactRow> {
    let is_along = move |row: &&ContactRow| {
        let faces = |own: &Interface| scene.problem.facing_sides(own).contains(&side);
        row.side == side || scene.problem.joint(row.side).is_some_and(faces)
    };
    rows.iter().filter(is_along)
}

/// Whether a side is tied to another body, as the sides behind the tip of a crack are.
fn is_tied(scene: &Scene, side: usize) -> bool {
    let meets = |own: &Interface| own.sides.contains(&side) || scene.problem.facing_sides(own).contains(&side);
    scene.problem.joints().any(|own| matches!(own.law, Law::Tied(_)) && meets(own))
}

/// The edges, and their ends 0 or 1 at a tip of a crack, that contact reaches with a pressure that falls towards the tip: it may end before the tip
/// where no node is.
pub(crate) fn unsure_at_tips(scene: &Scene, rows: &[ContactRow]) -> Vec<(usize, f64)> {
    let outline = &scene.problem.outline;
    let falls = |(k, edge): (usize, &Edge), end: f64| {
        let (beyond, is_straight) = beyond_end(outline, k, end > 0.5);
        let far = |row: &ContactRow| distance(row.point, edge.point(end));
        let own = || rows.iter().filter(|row| row.side == edge.side);
        let nearest = own().min_by(|a, b| far(a).total_cmp(&far(b))).map_or(0.0, |row| row.pressure);
        let largest = own().fold(0.0, |largest: f64, row| largest.max(row.pressure));
        let is_tip = is_straight && is_tied(scene, outline.edges()[beyond].side);
        is_tip && nearest > 0.0 && nearest < PART_AT_CORNER * largest
    };
    let touching = outline.edges().iter().enumerate().filter(|(_, edge)| scene.contact(edge.side).is_some());
    let ends = touching.flat_map(|own| [(own, 0.0), (own, 1.0)]);
    ends.filter(|&(own, end)| falls(own, end)).map(|((edge, _), end)| (edge, end)).collect()
}

/// Whether a support at an end of an edge holds its tangent alone: the edge goes on as its mirror image.
pub(crate) fn is_symmetric(scene: &Scene, edge: usize, end: f64) -> bool {
    let outline = &scene.problem.outline;
    let (beyond, _) = beyond_end(outline, edge, end > 0.5);
    let (side, tangent) = (&scene.problem.sides[outline.edges()[beyond].side], outline.edges()[edge].tangent(end));
    (0..2).any(|i| side.holds(i) && !side.holds(1 - i) && tangent[1 - i].abs() <= SAME_PLACE)
}

/// Whether the other body at an end of an edge, if there is one, has the same tangent: the distance of both has no slope there.
fn is_parallel(scene: &Scene, edge: usize, end: f64) -> bool {
    let (problem, edges) = (&scene.problem, scene.problem.outline.edges());
    let normal = edges[edge].normal(end);
    let is_along = |k: usize, s: f64| cross(edges[k].normal(s), normal).abs() <= PARALLEL;
    let facing = |own: &&Interface| problem.facing_sides(own).contains(&edges[edge].side);
    match (problem.joint(edges[edge].side), problem.joints().find(facing)) {
        (Some(own), _) => problem.seen(own, edge, end).is_some_and(|seen| is_along(seen.edge, seen.s)),
        (None, Some(own)) => problem.seen_from(own, edge, end).iter().all(|&(k, s)| is_along(k, s)),
        (None, None) => true,
    }
}

/// Whether the gap has no slope at an end of an edge, in any units: what two steps change is curvature or rounding.
fn is_flat(edge: &Edge, contact: &Contact, end: f64) -> bool {
    let gap = |steps: f64| {
        let s = if end > 0.5 { 1.0 - steps * STEP } else { steps * STEP };
        let [x, y] = edge.point(s);
        contact.gap.eval(x, y, s)
    };
    let [a, b, c] = [0.0, 1.0, 2.0].map(gap);
    let rounding = 16.0 * f64::EPSILON * (a.abs() + b.abs() + c.abs());
    (4.0 * b - c - 3.0 * a).abs() <= FLAT * (b - a).abs().max((c - a).abs()) + rounding
}

#[cfg(test)]
mod tests {
    use steklov_problem::steklov_bem_operators::{Loop, Polygon};
    use steklov_problem::steklov_expression::Expression;

    use super::*;

    /// Slopes are told from curvature whatever the units.
    #[test]
    fn slopes_are_told_from_curvature() {
        let gaps = [
            ("x^2", true),
            ("1 - cos(7*x)", true),
            ("0", true),
            ("5", true),
            ("x^2 - 3*x^3", true),
            ("x", false),
            ("x^2 + 0.01*x", false),
            ("3 + x", false),
            ("exp(x)", false),
        ];
        for (text, flat) in gaps {
            for scale in [1e-12, 1.0, 1e9] {
                let corners = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
                let sides = ["floor", "right", "top", "left"].map(str::to_owned).to_vec();
                let outline = Polygon::new(Loop::straight(corners, sides), vec![]).unwrap();
                let gap = Expression::parse(&format!("{scale:?}*({text})"), &Default::default()).unwrap();
                let contact = Contact { gap, friction: Friction::None };
                assert_eq!(is_flat(&outline.edges()[0], &contact, 0.0), flat, "{scale:e} ({text})");
            }
        }
    }
}
