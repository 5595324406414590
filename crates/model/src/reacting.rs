//! Where the sides of a scene may have forces, and which corners share them.

use steklov_bem_operators::{Edge, SAME_PLACE};
use steklov_problem::{Condition, Friction, Scene};

/// The components in which a side reacts.
pub(crate) fn reacting(scene: &Scene, side: usize) -> [bool; 2] {
    let own = scene.problem.outline.edges().iter().filter(|edge| edge.side == side);
    own.map(|edge| reacts(scene, edge)).fold([false; 2], |all, own| [all[0] | own[0], all[1] | own[1]])
}

/// The components of the force that a support or an obstacle may have along an edge.
fn reacts(scene: &Scene, edge: &Edge) -> [bool; 2] {
    let side = &scene.problem.sides[edge.side];
    let held = match &side.condition {
        Condition::Displacement { values, .. } => values.each_ref().map(Option::is_some),
        _ => [false; 2],
    };
    let touched = match scene.problem.contact(edge.side) {
        None => [false; 2],
        Some(contact) if matches!(contact.friction, Friction::None) && edge.is_line() => {
            edge.normal(0.5).map(|n| n.abs() > SAME_PLACE)
        }
        Some(_) => [true; 2],
    };
    [0, 1].map(|k| held[k] || touched[k] || side.springs.is_some())
}

/// The corners of a side at which both it and another side may have a component of a force: how much is whose is known to the mesh alone.
fn shared_corners(scene: &Scene, side: usize) -> Vec<([f64; 2], [bool; 2])> {
    let outline = &scene.problem.outline;
    let edges = outline.edges();
    let mut corners = Vec::new();
    for k in (0..edges.len()).filter(|&k| edges[k].side == side) {
        for at_end in [false, true] {
            let (other, _) = outline.neighbour(k, at_end);
            if edges[other].side != side {
                let (own, others) = (reacts(scene, &edges[k]), reacts(scene, &edges[other]));
                corners.push((edges[k].point(f64::from(u8::from(at_end))), [0, 1].map(|i| own[i] && others[i])));
            }
        }
    }
    corners
}

/// The components of the force of a side of which a corner has a part that is another side's as well.
pub(crate) fn shared(scene: &Scene, side: usize) -> [bool; 2] {
    shared_corners(scene, side).iter().fold([false; 2], |all, (_, own)| [all[0] | own[0], all[1] | own[1]])
}

/// Whether the force of a side does no work on w where it shares a corner.
pub(crate) fn works_alone(scene: &Scene, side: usize, w: impl Fn([f64; 2]) -> [f64; 2]) -> bool {
    let moves = |&(x, shared): &([f64; 2], [bool; 2])| {
        let w = w(x);
        (0..2).any(|i| shared[i] && w[i] != 0.0)
    };
    !shared_corners(scene, side).iter().any(moves)
}
