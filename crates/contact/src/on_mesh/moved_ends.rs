//! How a solution changes where an end of contact or of stick moves by one node.
//!
//! ```text
//! u = e·v + offset       the normal or tangential displacement of a condition,  E the displacements that the sets leave free
//! held on its line       Δv = x (g - u)/(e·x),   Δenergy = ½ (g - u)²/(e·x),     x = E (EᵀSE)⁻¹ Eᵀ e
//! released from it       Δv = d a,               Δenergy = ½ a² e·S d - a r,       d = e - E (EᵀSE)⁻¹ Eᵀ S e,   a = r/(e·S d)
//! ```
//! r is the force that held the condition, of a tangential one less the friction that remains, and |a| at most the opening or slip of the node
//! beyond the end, from which it grows. Friction bounds stay as they are, but for the change of a number j·v = j·Δv, which is that of its dual
//! solution. Between two nodes the sets of a mesh say no more than that an end
//! lies there.

use steklov_algebra::dot;

use crate::on_mesh::lines::ContactLine;
use crate::solvers::frozen::{Frozen, Sets};
use crate::solvers::problem::{Condition, ContactNode, Problem, Solution};

/// The change of a solution where a condition is held that was not, or the other way round.
#[derive(Debug, Clone, PartialEq)]
pub struct MovedEnd {
    /// e, m entries.
    row: Vec<f64>,
    /// S e of a condition that is released; None of one that is held.
    forces: Option<Vec<f64>>,
    /// By how much x or d is taken.
    by: f64,
    /// The change of ½ vᵀSv - fᵀv + Σ D F |u_t| (force times length per thickness).
    pub energy: f64,
}

impl MovedEnd {
    /// The change of j·v, with y the dual solution of j in what the sets leave free, see [`crate::FrozenDual::solution`].
    pub fn change_of(&self, j: &[f64], y: &[f64]) -> f64 {
        match &self.forces {
            None => self.by * dot(&self.row, y),
            Some(forces) => self.by * (dot(j, &self.row) - dot(forces, y)),
        }
    }
}

/// For each end of contact, of stick and of one direction of slip between two neighbours along the lines the changes where it moves by one
/// node, first into what holds. Where `may_open` the last nodes of a line that are closed count as ends, and nodes that stick under more than
/// half of their friction bound as ends that half of their shear moves. `frozen` is the problem with these sets, those of the solution.
///
/// Cost: two solutions of the problem with given sets an end, 4 m² operations.
pub fn moved_ends(
    (problem, solution): (&Problem, &Solution),
    (sets, frozen): (&Sets, &Frozen<'_>),
    (lines, may_open): (&[ContactLine], bool),
) -> Vec<[MovedEnd; 2]> {
    let kinks = Kinks { problem, solution, frozen };
    let nodes = problem.nodes.iter();
    let conditions: Vec<_> = nodes.flat_map(|node| node.conditions.iter().map(move |c| (node, c))).collect();
    let mut all = Vec::new();
    for pair in lines.iter().flat_map(|line| line.points.windows(2)) {
        let [i, j] = [pair[0].index, pair[1].index];
        let normal = |index: usize| kinks.place(conditions[index], index, false);
        let tangential = |index: usize| kinks.place(conditions[index], index, true);
        match (sets.closed(i), sets.closed(j)) {
            (true, false) => all.push(kinks.end(&normal(i), &normal(j), 0.0)),
            (false, true) => all.push(kinks.end(&normal(j), &normal(i), 0.0)),
            _ => {}
        }
        match (sets.slip(i), sets.slip(j)) {
            (Some(0), Some(s @ (-1 | 1))) => all.push(kinks.end(&tangential(i), &tangential(j), f64::from(s))),
            (Some(s @ (-1 | 1)), Some(0)) => all.push(kinks.end(&tangential(j), &tangential(i), f64::from(s))),
            (Some(a), Some(b)) if a != b => all.push([kinks.held(&tangential(i)), kinks.held(&tangential(j))]),
            _ => {}
        }
    }
    for line in lines {
        for point in &line.points {
            let tangential = kinks.place(conditions[point.index], point.index, true);
            if sets.slip(point.index) == Some(0) && tangential.force.abs() > NEAR_SLIP * tangential.bound {
                all.push(kinks.alone(&tangential, NEAR_SLIP));
            }
        }
        for point in [line.points.first(), line.points.last()].into_iter().flatten().filter(|_| may_open) {
            if sets.closed(point.index) {
                all.push(kinks.alone(&kinks.place(conditions[point.index], point.index, false), 1.0));
            }
        }
    }
    all
}

/// Part of the friction bound from which on a node that sticks may slip.
const NEAR_SLIP: f64 = 0.5;

/// The normal or tangential part of a condition.
struct Kink {
    /// e.
    row: Vec<f64>,
    /// g - u.
    opening: f64,
    /// D λ, and D F.
    force: f64,
    bound: f64,
}

struct Kinks<'a> {
    problem: &'a Problem,
    solution: &'a Solution,
    frozen: &'a Frozen<'a>,
}

impl Kinks<'_> {
    fn place(&self, (node, condition): (&ContactNode, &Condition), index: usize, tangential: bool) -> Kink {
        let [pressure, shear] = self.solution.multipliers[index];
        let v = node.pick(&self.solution.displacement);
        let (along, opening, force) = if tangential {
            (condition.tangent, -condition.slip(v), condition.tangent_weight * shear)
        } else {
            (condition.normal, condition.opening(v), condition.normal_weight * pressure)
        };
        let mut row = vec![0.0; self.problem.load.len()];
        row[node.first..node.first + node.unknowns].copy_from_slice(&along[..node.unknowns]);
        Kink { row, opening, force, bound: condition.tangent_weight * condition.limit(pressure) }
    }

    /// An end between a node that is held and one that is not, and slips in the direction `slip` if it may: released, and held.
    fn end(&self, held: &Kink, free: &Kink, slip: f64) -> [MovedEnd; 2] {
        [self.released(held, slip, free.opening.abs()), self.held(free)]
    }

    /// A condition without a neighbour beyond it, released from this part of its force: by twice what it does to the condition alone at most.
    fn alone(&self, kink: &Kink, part: f64) -> [MovedEnd; 2] {
        let own = dot(&kink.row, &self.problem.stiffness.times(&kink.row));
        let force = part * kink.force;
        let released = self.released(&Kink { row: kink.row.clone(), force, ..*kink }, 0.0, 2.0 * force.abs() / own);
        [released.clone(), released]
    }

    fn held(&self, kink: &Kink) -> MovedEnd {
        let x = self.frozen.correction(&kink.row);
        let flexibility = dot(&kink.row, &x);
        // what other conditions hold already does not move
        let by = if flexibility > 0.0 { kink.opening / flexibility } else { 0.0 };
        MovedEnd { row: kink.row.clone(), forces: None, by, energy: 0.5 * by * kink.opening }
    }

    fn released(&self, kink: &Kink, slip: f64, most: f64) -> MovedEnd {
        let forces = self.problem.stiffness.times(&kink.row);
        let others = self.frozen.correction(&forces);
        let d: Vec<f64> = kink.row.iter().zip(others).map(|(e, c)| e - c).collect();
        let left = if slip == 0.0 { 0.0 } else { slip * kink.bound };
        let (stiffness, force) = (dot(&forces, &d), kink.force - left);
        let by = if stiffness > 0.0 && force.is_finite() { (force / stiffness).clamp(-most, most) } else { 0.0 };
        let energy = by * (0.5 * by * stiffness - force);
        MovedEnd { row: kink.row.clone(), forces: Some(forces), by, energy }
    }
}
