//! The judge: how well a displacement and multipliers obey all conditions, whatever computed them.

use crate::solvers::linear::largest;
use crate::{Condition, ContactNode, Problem, Solution};

/// Relative violation of each condition of a contact problem; all 0 for an exact solution. A scale of 0 gives 0.
///
/// With u the unknowns v, g the gaps, λ the multipliers, F the finite friction bounds, under Coulomb's law those of λ_n⁺:
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kkt {
    /// max |S v + Bᵀλ - f| / (max |S v| + max |f|).
    pub equilibrium: f64,
    /// max (u_n - g)⁺ / (max |u| + max |g|).
    pub penetration: f64,
    /// max (-λ_n)⁺ / max |λ|.
    pub tension: f64,
    /// max |λ_n (g - u_n)| / (max |λ| (max |u| + max |g|)).
    pub complementarity: f64,
    /// The largest of (|λ_t| - F)⁺ / (max |λ| + max F) and of |F|u_t| - λ_t u_t| / ((max |λ| + max F)(max |u| + max
    /// |g|)); for an infinite F, |u_t| / (max |u| + max |g|).
    pub friction: f64,
}

impl Kkt {
    /// The largest of the five; NaN if one of them is.
    pub fn worst(&self) -> f64 {
        largest([self.equilibrium, self.penetration, self.tension, self.complementarity, self.friction])
    }
}

/// Judges `solution` against `problem`. A condition whose weight is 0 is not judged, and its multiplier has no force.
///
/// # Panics
/// If the sizes of the solution are not those of the problem.
pub fn kkt(problem: &Problem, solution: &Solution) -> Kkt {
    kkt_in_body(problem, solution, 0.0)
}

/// As [`kkt`], of a body whose displacement is `body_displacement` somewhere: max |u| is at least that. Where a body sticks at
/// zero gap its contact displacements are roundoff and give no scale.
///
/// # Panics
/// If the sizes of the solution are not those of the problem.
pub fn kkt_in_body(problem: &Problem, solution: &Solution, body_displacement: f64) -> Kkt {
    let v = &solution.displacement;
    let conditions = || problem.nodes.iter().flat_map(|n| n.conditions.iter().map(move |c| (n, c)));
    assert_eq!(v.len(), problem.load.len(), "one displacement for each unknown");
    assert_eq!(conditions().count(), solution.multipliers.len(), "one pair of multipliers for each condition");
    let elastic = problem.stiffness.times(v);
    let mut residual: Vec<f64> = elastic.iter().zip(&problem.load).map(|(s, f)| s - f).collect();
    for ((node, c), &[normal, shear]) in conditions().zip(&solution.multipliers) {
        for i in 0..node.unknowns {
            residual[node.first + i] +=
                c.normal_weight * normal * c.normal[i] + c.tangent_weight * shear * c.tangent[i];
        }
    }
    let pairs = || conditions().zip(&solution.multipliers);
    let length = length(problem, v, body_displacement);
    let lambda = largest(solution.multipliers.iter().flatten().copied());
    let (mut penetration, mut tension, mut complementarity) = (vec![], vec![], vec![]);
    for ((node, c), &[normal, _]) in pairs() {
        let w = node.pick(v);
        if c.normal_weight > 0.0 {
            let opening = c.opening(w);
            penetration.push(relative((-opening).max(0.0), length));
            tension.push(relative((-normal).max(0.0), lambda));
            complementarity.push(relative(normal * opening, lambda * length));
        }
    }
    Kkt {
        equilibrium: relative(largest(residual), largest(elastic) + largest(problem.load.iter().copied())),
        penetration: largest(penetration),
        tension: largest(tension),
        complementarity: largest(complementarity),
        friction: friction(problem, solution, body_displacement, |_| 0.0),
    }
}

/// max |u| + max |g|.
fn length(problem: &Problem, v: &[f64], body_displacement: f64) -> f64 {
    let conditions = problem.nodes.iter().flat_map(|n| &n.conditions);
    largest(v.iter().copied().chain([body_displacement]))
        + largest(conditions.filter(|c| c.normal_weight > 0.0).map(|c| c.gap))
}

/// [`Kkt::friction`], less its rounding error, if the force on a node is known only up to `known`.
pub(crate) fn friction(
    problem: &Problem,
    solution: &Solution,
    body_displacement: f64,
    known: impl Fn(&ContactNode) -> f64,
) -> f64 {
    let length = length(problem, &solution.displacement, body_displacement);
    let conditions = || problem.nodes.iter().flat_map(|n| n.conditions.iter().map(move |c| (n, c)));
    let pairs = || conditions().zip(&solution.multipliers).filter(|((_, c), _)| c.tangent_weight > 0.0);
    let rubs = pairs().filter(|((_, c), _)| c.bound.is_finite());
    let stress =
        largest(solution.multipliers.iter().flatten().copied()) + largest(rubs.map(|((_, c), l)| c.limit(l[0])));
    let violation = |((node, c), &[normal, shear]): ((&ContactNode, &Condition), &[f64; 2])| {
        let (slip, limit) = (c.slip(node.pick(&solution.displacement)), c.limit(normal));
        if limit.is_infinite() {
            return relative(slip, length);
        }
        let pressed = if c.is_coulomb() { c.coefficient / c.normal_weight } else { 0.0 };
        let rounding = known(node) * (1.0 / c.tangent_weight + pressed);
        let beyond = |value: f64, rounding: f64| if value <= rounding { 0.0 } else { value - rounding };
        let left = (limit * slip.abs() - shear * slip).abs();
        largest([
            relative(beyond(shear.abs() - limit, rounding), stress),
            relative(beyond(left, rounding * slip.abs()), stress * length),
        ])
    };
    largest(pairs().map(violation))
}

fn relative(value: f64, scale: f64) -> f64 {
    if scale == 0.0 { 0.0 } else { value / scale }
}
