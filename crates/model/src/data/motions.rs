//! Rigid motions that nothing holds, and the work of loads and contact forces on them.

use steklov_bem_operators::BemError;
use steklov_contact::{ContactBoundary, ContactEdge, ContactError, resisted_motions};
use steklov_elastic::RigidMotion;
use steklov_elastic::plane::{distance, dot, minus};

use crate::error::SolveError;

/// The work L(r) of a load and its scale Σ |f||r| over the nodes at these points.
pub(crate) fn work(points: &[[f64; 2]], load: &[f64], motion: &RigidMotion) -> (f64, f64) {
    nodal_work(load, &motion.nodal(points))
}

/// The same for the nodal values of a motion.
pub(crate) fn nodal_work(load: &[f64], motion: &[f64]) -> (f64, f64) {
    load.chunks_exact(2).zip(motion.chunks_exact(2)).fold((0.0, 0.0), |(sum, scale), (f, r)| {
        (sum + f[0] * r[0] + f[1] * r[1], scale + f[0].hypot(f[1]) * r[0].hypot(r[1]))
    })
}

/// The motions of `candidates` that nothing resists: all of them without contact, if a load at points does no work on any; in
/// contact those that no obstacle stops.
pub(crate) fn unresisted(
    points: &[[f64; 2]],
    load: &[f64],
    boundary: Option<&ContactBoundary>,
    candidates: &[RigidMotion],
) -> Result<Vec<RigidMotion>, SolveError> {
    match boundary {
        None => balanced(points, load, candidates),
        Some(boundary) => Ok(resisted_motions(candidates, &edges(boundary), |r| work(points, load, r))?),
    }
}

/// Without contact: all free motions, if the loads do no work on any of them.
fn balanced(points: &[[f64; 2]], load: &[f64], candidates: &[RigidMotion]) -> Result<Vec<RigidMotion>, SolveError> {
    let works: Vec<(f64, f64)> = candidates.iter().map(|r| work(points, load, r)).collect();
    let driven = |(work, scale): &(f64, f64)| work.abs() > 1e-9 * scale;
    let worst = works.iter().filter(|w| driven(w)).max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    match worst {
        Some(&(work, scale)) => {
            Err(BemError::RigidMotion { modes: candidates.to_vec(), work: work.abs(), scale }.into())
        }
        None => Ok(candidates.to_vec()),
    }
}

/// From this part of the scale of the loads' work on, contact forces count as doing work on a motion that no load drives.
const PRESSED: f64 = 1e-6;

/// No contact force at the nodes at these points may do work on the motions that springs hold: else the springs carry a part
/// of the load, whose work and scale `driven` gives. `floor`: a force below which all are roundoff.
pub(crate) fn unpressed(
    points: &[[f64; 2]],
    driven: &dyn Fn(&RigidMotion) -> (f64, f64),
    forces: &[(usize, [f64; 2])],
    free: &[RigidMotion],
    floor: f64,
) -> Result<(), ContactError> {
    let mut nodal = vec![0.0; 2 * points.len()];
    for (node, force) in forces {
        (0..2).for_each(|i| nodal[2 * node + i] += force[i]);
    }
    for motion in free {
        let largest = motion.nodal(points).iter().fold(0.0, |m: f64, r| m.max(r.abs()));
        let (driven, scale) = driven(motion);
        if work(points, &nodal, motion).0.abs() > PRESSED * scale.max(floor * largest) {
            let motion = motion.clone();
            return Err(ContactError::RigidMotion { motion, work: driven, resistance: 0.0, scale });
        }
    }
    Ok(())
}

/// The straight parts of the contact boundary: conditions with one normal, one line and one coefficient of friction.
pub(crate) fn edges(boundary: &ContactBoundary) -> Vec<ContactEdge> {
    let mut edges: Vec<ContactEdge> = Vec::new();
    for (node, contact) in boundary.nodes.iter().zip(&boundary.contact) {
        for (c, condition) in node.conditions.iter().zip(&contact.conditions) {
            let friction = condition.tangent_weight * condition.bound;
            let friction = if friction.is_nan() { 0.0 } else { friction };
            let pressed = condition.normal_weight > 0.0 && condition.tangent_weight > 0.0;
            let coefficient = if pressed { condition.coefficient } else { 0.0 };
            let offset = |x: [f64; 2]| dot(minus(x, node.point), c.normal);
            let aligned = |e: &&mut ContactEdge| {
                distance(e.normal, c.normal) < 1e-9
                    && (e.coefficient - coefficient).abs() <= 1e-12 * coefficient
                    && offset(e.ends[0]).abs() <= 1e-9 * distance(e.ends[0], node.point)
            };
            match edges.iter_mut().find(aligned) {
                Some(edge) => {
                    edge.friction += friction;
                    // the farthest pair of nodes on the line
                    let (a, b) = (distance(edge.ends[0], node.point), distance(edge.ends[1], node.point));
                    if a.max(b) > distance(edge.ends[0], edge.ends[1]) {
                        edge.ends[usize::from(a >= b)] = node.point;
                    }
                }
                None => edges.push(ContactEdge { ends: [node.point; 2], normal: c.normal, friction, coefficient }),
            }
        }
    }
    edges
}
