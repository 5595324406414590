//! Where the sides of a scene may have forces, and which corners share them.

use steklov_bem_operators::{Edge, SAME_PLACE};
use steklov_elastic::plane::cross;
use steklov_problem::{Condition, Friction, Interface, Law, Scene};

/// The components in which a side reacts.
pub(crate) fn reacting(scene: &Scene, side: usize) -> [bool; 2] {
    let own = scene.problem.outline.edges().iter().filter(|edge| edge.side == side);
    own.map(|edge| reacts(scene, edge)).fold([false; 2], |all, own| [all[0] | own[0], all[1] | own[1]])
}

/// The components of the force that a support, an obstacle or another body may have along an edge.
fn reacts(scene: &Scene, edge: &Edge) -> [bool; 2] {
    let side = &scene.problem.sides[edge.side];
    let held = match &side.condition {
        Condition::Displacement { values, .. } => values.each_ref().map(Option::is_some),
        _ => [false; 2],
    };
    let touched = match scene.problem.contact(edge.side) {
        None => [is_tied(scene, edge.side); 2],
        Some(contact) if matches!(contact.friction, Friction::None) && is_flat(scene, edge) => {
            edge.normal(0.5).map(|n| n.abs() > SAME_PLACE)
        }
        Some(_) => [true; 2],
    };
    [0, 1].map(|k| held[k] || touched[k] || side.springs.is_some())
}

/// Whether a side is tied to another one.
fn is_tied(scene: &Scene, side: usize) -> bool {
    let problem = &scene.problem;
    let meets = |own: &Interface| own.sides.contains(&side) || problem.facing_sides(own).contains(&side);
    problem.joints().any(|own| matches!(own.law, Law::Tied(_)) && meets(own))
}

/// Whether what touches an edge can push it along its normal alone: both are straight.
fn is_flat(scene: &Scene, edge: &Edge) -> bool {
    let (problem, n) = (&scene.problem, edge.normal(0.5));
    let faced = problem.joint(edge.side).map_or(&[][..], |own| problem.facing_sides(own));
    let mut faced = problem.outline.edges().iter().filter(|other| faced.contains(&other.side));
    edge.is_line() && faced.all(|other| other.is_line() && cross(other.normal(0.5), n).abs() <= SAME_PLACE)
}

/// The corners of a side at which both it and a side that is not one of `own` may have a component of a force: how much is whose is known
/// to the mesh alone.
pub(crate) fn shared_corners(scene: &Scene, side: usize, own: &[usize]) -> Vec<([f64; 2], [bool; 2])> {
    let outline = &scene.problem.outline;
    let edges = outline.edges();
    let mut corners = Vec::new();
    // the force of springs is an integral of its own
    if scene.problem.sides[side].springs.is_some() {
        return corners;
    }
    for k in (0..edges.len()).filter(|&k| edges[k].side == side) {
        for at_end in [false, true] {
            let (other, _) = outline.neighbour(k, at_end);
            if !own.contains(&edges[other].side) {
                let (own, others) = (reacts(scene, &edges[k]), reacts(scene, &edges[other]));
                corners.push((edges[k].point(f64::from(u8::from(at_end))), [0, 1].map(|i| own[i] && others[i])));
            }
        }
    }
    corners
}

/// The components of the force of sides of which a corner has a part that is another side's as well.
pub(crate) fn shared(scene: &Scene, sides: &[usize]) -> [bool; 2] {
    let corners = sides.iter().flat_map(|&side| shared_corners(scene, side, sides));
    corners.fold([false; 2], |all, (_, own)| [all[0] | own[0], all[1] | own[1]])
}

/// Whether the force of a side does no work on w where it shares a corner.
pub(crate) fn works_alone(scene: &Scene, side: usize, w: impl Fn([f64; 2]) -> [f64; 2]) -> bool {
    let moves = |&(x, shared): &([f64; 2], [bool; 2])| {
        let w = w(x);
        (0..2).any(|i| shared[i] && w[i] != 0.0)
    };
    !shared_corners(scene, side, &[side]).iter().any(moves)
}
