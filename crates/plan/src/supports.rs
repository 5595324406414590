//! Supports and springs of bodies with boundary elements.

use steklov_elastic::RigidMotion;
use steklov_expression::Expression;
use steklov_problem::{Scene, Springs};

use crate::{Decision, decision};

/// Adds the decisions about supports and springs.
pub(crate) fn decide(scene: &Scene, modelled: &mut Vec<Decision>) {
    modelled.push(supports(scene));
    springs(scene, modelled);
}

/// The decision about the supports of several bodies, some of which only interfaces may hold.
fn supports_of_several(scene: &Scene) -> Decision {
    let problem = &scene.problem;
    let loose: Vec<String> = (0..problem.outline.bodies().len())
        .filter_map(|body| {
            let free = scene.unresisted(body, scene.free_of_supports(Some(body)));
            (!free.is_empty()).then(|| format!("{} ({})", problem.bodies[body].name, RigidMotion::names(&free)))
        })
        .collect();
    if loose.is_empty() {
        let why = if problem.has_springs() { "held displacements and springs" } else { "held displacements" };
        return decision("supports", "hold every body against all rigid motions", why);
    }
    let choice = format!("leave bodies free: {}", loose.join("; "));
    decision("supports", choice, "only interfaces hold them there, or the loads must be balanced")
}

/// The decision about the supports.
fn supports(scene: &Scene) -> Decision {
    if scene.problem.has_several_bodies() {
        return supports_of_several(scene);
    }
    let free = scene.unresisted(0, scene.free_of_supports(None));
    let (choice, why) = if !free.is_empty() {
        let choice = format!("leave {} free", RigidMotion::names(&free));
        (choice, "contact or friction must hold it, or the loads must be balanced")
    } else if scene.is_inclusion() {
        ("none is needed".to_owned(), "the medium holds the body")
    } else if scene.is_cavity() {
        let why = "a displacement that decays has no rigid motion, and one that is bounded no rotation";
        ("none is needed".to_owned(), why)
    } else {
        let why = if scene.problem.has_springs() { "held displacements and springs" } else { "held displacements" };
        ("hold all rigid motions".to_owned(), why)
    };
    decision("supports", choice, why)
}

/// Adds the decisions about springs on sides.
fn springs(scene: &Scene, modelled: &mut Vec<Decision>) {
    for side in &scene.problem.sides {
        let Some(springs) = &side.springs else { continue };
        let [first, second] = springs.stiffnesses().map(Expression::text);
        let choice = match springs {
            Springs::Axes(_) if first == second => format!("{first:?} on {}", side.name),
            Springs::Axes(_) => format!("{first:?} along x, {second:?} along y on {}", side.name),
            Springs::Normal { .. } => {
                format!("{first:?} along the normal, {second:?} along the tangent of {}", side.name)
            }
        };
        let why = "the traction -k u, added to the stiffness of the boundary by integrals of k along its elements";
        modelled.push(decision("springs", choice, why));
    }
}
