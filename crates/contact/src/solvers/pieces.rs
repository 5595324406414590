//! Which piece of its law each node is on.

use crate::Problem;
use crate::solvers::law::{Law, Piece};

/// The laws of all nodes under the pressures of these multipliers (0 of none).
pub(crate) fn laws(problem: &Problem, multipliers: &[[f64; 2]]) -> Vec<Law> {
    let mut pressures = multipliers.iter().map(|l| l[0]);
    let nodes = problem.nodes.iter().zip(metric(problem));
    nodes
        .map(|(n, metric)| Law::new(n, metric, &pressures.by_ref().take(n.conditions.len()).collect::<Vec<f64>>()))
        .collect()
}

/// The metric C = diag S of each node, but positive where the stiffness of an unknown vanishes (a floating body that
/// touches with one element).
pub(crate) fn metric(problem: &Problem) -> Vec<[f64; 2]> {
    let diagonal = |i: usize| problem.stiffness[(i, i)];
    let largest = (0..problem.load.len()).map(diagonal).fold(0.0, f64::max);
    let s = |i: usize| diagonal(i).max(1e-6 * largest);
    problem.nodes.iter().map(|n| [s(n.first), s(n.first + n.unknowns - 1)]).collect()
}

/// The piece of each node on which v + C⁻¹R lies.
pub(crate) fn nearest_pieces(problem: &Problem, laws: &[Law], v: &[f64], r: &[f64]) -> Vec<Piece> {
    let nodes = problem.nodes.iter().zip(laws);
    nodes
        .map(|(node, law)| {
            let (w, force) = (node.pick(v), node.pick(r));
            law.prox([w[0] + force[0] / law.metric[0], w[1] + force[1] / law.metric[1]]).1.clone()
        })
        .collect()
}

/// Solution of the linear system of given pieces.
pub(crate) struct Linear {
    /// v.
    pub displacement: Vec<f64>,
    /// R = f - S v.
    pub force: Vec<f64>,
    /// The part of R that is not balanced along the free directions, as a vector of all unknowns: 0 unless the system is
    /// singular.
    pub unbalanced: Vec<f64>,
}
