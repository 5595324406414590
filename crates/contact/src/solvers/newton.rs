//! Semi-smooth Newton on the penalised Fischer-Burmeister function.

use faer::Mat;

use steklov_elastic::plane::dot;

use crate::solvers::active_set::active_set;
use crate::solvers::law::{Branch, Law, Piece};
use crate::solvers::linear::{largest, solve_general};
use crate::solvers::pieces::{Linear, laws, nearest_pieces};
use crate::solvers::settle::{iterate, solution, solve_pieces, violations};
use crate::{ContactError, ContactNode, Outcome, Problem, Solution, Start};

/// Weight m of the Fischer-Burmeister function against its penalty.
const WEIGHT: f64 = 0.9;
/// Relative residual at which the iteration ends.
const TOLERANCE: f64 = 1e-11;
/// Newton steps before the active set method takes over.
const LIMIT: usize = 60;
/// Armijo's constant, on the square of the residual.
const ARMIJO: f64 = 2e-4;
/// Shortest step; where it does not do, the active set method takes over.
const SHORTEST: f64 = 1e-2;

/// Solves the problem by a semi-smooth Newton method with line search.
///
/// The multipliers are eliminated by equilibrium, λ = D⁻¹(f - S v), and v solves one equation for each unknown: at an
/// ordinary node, with c = S_ii/D_i,
///
/// ```text
/// φ(λ_n, c(g - u_n)) = 0,   φ(a, b) = m (a + b - √(a²+b²)) + (1 - m) a₊ b₊ / s,   m = 0.9
/// λ_t - clip(λ_t + c u_t, -F, F) = 0
/// ```
/// with s the mean stress of the start, so that units do not matter, and at a corner, or where the unknowns do not
/// separate the conditions, v = prox(v + C⁻¹R). Under Coulomb's law F = bound + μ (λ_n + c(u_n - g))₊, its derivative
/// included; where that law holds at a node with two conditions the active set method does all. Armijo's rule on the sum
/// of the squared residuals times D_i, relative residual 1e-11. The answer is then polished by one solve on the contact and stick sets that it found.
///
/// *Use when*: always a good choice, also from a good start. *Fails when*: the line search stalls far from the
/// solution; the active set method then goes on from there, and its outcome is reported (the history is that of both).
/// A singular Jacobian gives the step of least norm.
/// *Cost*: one dense LU factorisation a step.
///
/// # Errors
/// As [`crate::active_set`].
///
/// Source: Chen, Chen and Kanzow, Math. Program. 88 (2000) (penalised function); Christensen, Klarbring, Pang and
/// Strömberg, Int. J. Numer. Methods Eng. 42 (1998); Issaoui (2014), equation (2.53) and algorithm 2.1.
pub fn newton(problem: &Problem, start: Option<Start<'_>>) -> Result<Solution, ContactError> {
    newton_watched(problem, start, &mut |_| ())
}

/// [`newton`], which also reports the unknowns before its first step and after each; none if the active set method does all.
///
/// # Errors
/// As [`newton`].
pub fn newton_watched(
    problem: &Problem,
    start: Option<Start<'_>>,
    tell: &mut dyn FnMut(&[f64]),
) -> Result<Solution, ContactError> {
    problem.check()?;
    if problem.nodes.iter().any(|n| n.conditions.len() > 1 && n.conditions.iter().any(|c| c.is_coulomb())) {
        return active_set(problem, start);
    }
    let laws = laws(problem, start.map_or(&[], |s| s.multipliers));
    let origin = vec![0.0; problem.load.len()];
    let mut v = match start {
        Some(start) => {
            start.nodal_force(problem)?;
            start.displacement.to_vec()
        }
        None => {
            let closed: Vec<_> = laws.iter().map(|law| law.closed().clone()).collect();
            solve_pieces(problem, &laws, &closed, &origin)?.displacement
        }
    };
    let equations = Equations { problem, laws: &laws, unit: unit(problem, &v) };
    let mut history = Vec::new();
    let mut state = equations.at(&v);
    for _ in 0..LIMIT {
        history.push(state.relative());
        tell(&v);
        if state.relative() <= TOLERANCE {
            break;
        }
        let step = solve_general(&equations.jacobian(&v, &state.force), &state.residual)?;
        let (mut t, before) = (1.0, state.squared());
        let (moved, next) = loop {
            let moved: Vec<f64> = v.iter().zip(&step).map(|(v, s)| v - t * s).collect();
            let next = equations.at(&moved);
            if next.squared() <= (1.0 - ARMIJO * t) * before || t < SHORTEST {
                break (moved, next);
            }
            t *= 0.5;
        };
        if t < SHORTEST {
            break; // stalled
        }
        (v, state) = (moved, next);
    }
    let laws = equations.laws_at(&v, &state.force);
    let pieces = nearest_pieces(problem, &laws, &v, &state.force);
    if history.last().is_none_or(|h| *h > TOLERANCE) {
        // where a start misled the iteration its last pieces would do the same
        let mut rest =
            match if start.is_some() { active_set(problem, None) } else { iterate(problem, &laws, pieces, &origin) } {
                Ok(rest) if rest.converged() || !problem.is_coulomb() => rest,
                Err(error) if !problem.is_coulomb() => return Err(error),
                _ => active_set(problem, None)?, // v may have run away
            };
        history.append(&mut rest.history);
        return Ok(Solution { iterations: history.len(), history, ..rest });
    }
    // the polished answer counts where it confirms the sets it was computed on, which weakly active nodes may not
    let Linear { displacement, force, .. } = solve_pieces(problem, &laws, &pieces, &origin)?;
    let wrong = largest(violations(problem, &laws, &pieces, &displacement, &force));
    let change = largest(displacement.iter().zip(&v).map(|(a, b)| a - b));
    // displacements far below the gaps carry the rounding of these until they are polished
    let gaps = problem.nodes.iter().flat_map(|node| &node.conditions).map(|c| c.gap);
    let scale = largest(v.iter().copied()) + largest(gaps);
    let (v, force) = if wrong <= 1e-10 && change <= 1e-6 * scale { (displacement, force) } else { (v, state.force) };
    let mut answer = solution(problem, &laws, &pieces, v, &force, history, Outcome::Converged);
    answer.iterations -= 1;
    Ok(answer)
}

struct Equations<'a> {
    problem: &'a Problem,
    laws: &'a [Law],
    /// Stress in which the Fischer-Burmeister function is taken: its two terms have different dimensions.
    unit: f64,
}

/// Σ (|f| + |S v|) / Σ D, a mean stress; 1 without forces. That of f - S v would be rounding where nothing touches.
fn unit(problem: &Problem, v: &[f64]) -> f64 {
    let elastic = problem.stiffness.times(v);
    let force: f64 = problem.load.iter().zip(elastic).map(|(f, s)| f.abs() + s.abs()).sum();
    let mean = force / problem.nodes.iter().map(weight).sum::<f64>();
    if mean > 0.0 { mean } else { 1.0 }
}

struct State {
    /// R = f - S v.
    force: Vec<f64>,
    /// One equation for each unknown (stress).
    residual: Vec<f64>,
    /// Weight (length) of each equation in the squared residual, which then is the integral of a squared stress.
    weights: Vec<f64>,
    /// Size of the stresses that make up the residual.
    scale: f64,
}

impl State {
    fn relative(&self) -> f64 {
        if self.scale == 0.0 { 0.0 } else { largest(self.residual.iter().copied()) / self.scale }
    }

    fn squared(&self) -> f64 {
        self.residual.iter().zip(&self.weights).map(|(r, w)| w * r * r).sum()
    }
}

/// Weight by which a node's equations are divided to become stresses.
fn weight(node: &ContactNode) -> f64 {
    let w = node.conditions.iter().fold(0.0f64, |m, c| m.max(c.normal_weight).max(c.tangent_weight));
    if w > 0.0 { w } else { 1.0 }
}

/// The unknown that is u_n alone and on which no friction acts: there the Fischer-Burmeister function is used.
fn separate(node: &ContactNode, law: &Law) -> Option<(usize, f64)> {
    let kink = (0..law.kinks.len()).find(|&i| !law.source[i].1)?;
    let axis = match law.kinks[kink].direction {
        [d, 0.0] if d > 0.0 => 0,
        [0.0, d] if d > 0.0 => 1,
        _ => return None,
    };
    let others = (0..law.kinks.len()).all(|i| i == kink || law.kinks[i].direction[axis] == 0.0);
    (node.conditions.len() == 1 && others).then(|| (axis, law.kinks[kink].at / law.kinks[kink].direction[axis]))
}

/// λ_n + c (u_n - g) of a node with one condition and two unknowns, and its derivatives.
struct Pressure {
    value: f64,
    by_force: [f64; 2],
    by_displacement: [f64; 2],
}

fn expected_pressure(node: &ContactNode, law: &Law, w: [f64; 2], r: [f64; 2]) -> Option<Pressure> {
    let [condition] = node.conditions.as_slice() else { return None };
    if node.unknowns == 1 || !condition.is_coulomb() {
        return None;
    }
    let (n, c) = (condition.normal, law.metric);
    let stiffness = (c[0] * n[0] * n[0] + c[1] * n[1] * n[1]) / condition.normal_weight;
    let by_force = n.map(|x| x / (condition.normal_weight * dot(n, n)));
    let value = dot(by_force, r) - stiffness * condition.opening(w);
    Some(Pressure { value, by_force, by_displacement: n.map(|x| stiffness * x) })
}

/// For a node that slips under pressure: the gain of its friction force per unit of pressure, and the pressure.
fn coupling(node: &ContactNode, law: &Law, piece: &Piece, w: [f64; 2], r: [f64; 2]) -> Option<([f64; 2], Pressure)> {
    let pressure = expected_pressure(node, law, w, r)?;
    let kink = law.source.iter().position(|s| s.1)?;
    let sign = match piece[kink] {
        Branch::Below => -1.0,
        Branch::Above => 1.0,
        Branch::On => return None,
    };
    let c = &node.conditions[0];
    let friction = c.tangent.map(|t| sign * c.tangent_weight * c.coefficient * t);
    (pressure.value > 0.0).then_some((friction, pressure))
}

impl Equations<'_> {
    /// The laws with the friction bounds of the expected pressures.
    fn laws_at(&self, v: &[f64], force: &[f64]) -> Vec<Law> {
        let mut laws = self.laws.to_vec();
        for (node, law) in self.problem.nodes.iter().zip(&mut laws) {
            if let Some(pressure) = expected_pressure(node, law, node.pick(v), node.pick(force)) {
                law.set_limits(node, &[pressure.value]);
            }
        }
        laws
    }

    fn at(&self, v: &[f64]) -> State {
        let elastic = self.problem.stiffness.times(v);
        let force: Vec<f64> = self.problem.load.iter().zip(&elastic).map(|(f, s)| f - s).collect();
        let (mut residual, mut weights, mut scale) = (vec![0.0; v.len()], vec![0.0; v.len()], 0.0f64);
        for (node, law) in self.problem.nodes.iter().zip(&self.laws_at(v, &force)) {
            let (w, r, c, d) = (node.pick(v), node.pick(&force), law.metric, weight(node));
            let (prox, ..) = law.prox([w[0] + r[0] / c[0], w[1] + r[1] / c[1]]);
            for i in 0..node.unknowns {
                residual[node.first + i] = c[i] * (w[i] - prox[i]) / d;
                let i = node.first + i;
                weights[i] = d;
                scale = scale.max(self.problem.load[i].abs() / d + elastic[i].abs() / d);
            }
            if let Some((axis, gap)) = separate(node, law) {
                residual[node.first + axis] =
                    fischer_burmeister(r[axis] / d, c[axis] / d * (gap - w[axis]), self.unit).0;
            }
        }
        State { force, residual, weights, scale }
    }

    /// Derivative of the residual by v, m×m, not symmetric.
    fn jacobian(&self, v: &[f64], force: &[f64]) -> Mat<f64> {
        let (m, s) = (v.len(), self.problem.stiffness.full());
        let mut jacobian = Mat::zeros(m, m);
        for (node, law) in self.problem.nodes.iter().zip(&self.laws_at(v, force)) {
            let (w, r, c, d) = (node.pick(v), node.pick(force), law.metric, weight(node));
            let (_, piece, _) = law.prox([w[0] + r[0] / c[0], w[1] + r[1] / c[1]]);
            let q = law.derivative(piece); // C P C⁻¹; the rows are C(I - P) + C P C⁻¹ S, over D
            for i in 0..node.unknowns {
                for k in 0..node.unknowns {
                    for j in 0..m {
                        jacobian[(node.first + i, j)] += q[i][k] * s[(node.first + k, j)] / d;
                    }
                    let unit = if i == k { 1.0 } else { 0.0 };
                    jacobian[(node.first + i, node.first + k)] += (unit - q[i][k]) * c[k] / d;
                }
            }
            if let Some((friction, pressure)) = coupling(node, law, piece, w, r) {
                for (i, q) in q.iter().enumerate() {
                    let x = dot(*q, friction) / d;
                    for k in 0..2 {
                        for j in 0..m {
                            jacobian[(node.first + i, j)] -= x * pressure.by_force[k] * s[(node.first + k, j)];
                        }
                        jacobian[(node.first + i, node.first + k)] += x * pressure.by_displacement[k];
                    }
                }
            }
            if let Some((axis, gap)) = separate(node, law) {
                let i = node.first + axis;
                let (_, by_pressure, by_opening) =
                    fischer_burmeister(r[axis] / d, c[axis] / d * (gap - w[axis]), self.unit);
                for j in 0..m {
                    jacobian[(i, j)] = -by_pressure * s[(i, j)] / d;
                }
                jacobian[(i, i)] -= by_opening * c[axis] / d;
            }
        }
        jacobian
    }
}

/// φ(a, b) = m (a + b - √(a²+b²)) + (1 - m) a₊ b₊ / unit and its derivatives by a and b; at the origin those of the direction
/// a = b > 0. Zero exactly where a, b ≥ 0 and a b = 0.
fn fischer_burmeister(a: f64, b: f64, unit: f64) -> (f64, f64, f64) {
    let (m, r) = (WEIGHT, a.hypot(b));
    let (ra, rb) = if r > 0.0 { (a / r, b / r) } else { (0.5f64.sqrt(), 0.5f64.sqrt()) };
    let both = if a > 0.0 && b > 0.0 { (1.0 - m) / unit } else { 0.0 };
    let value = if a > 0.0 && b > 0.0 { 2.0 * a * b / (a + b + r) } else { a + b - r };
    (m * value + both * a * b, m * (1.0 - ra) + both * b, m * (1.0 - rb) + both * a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::proptest::{Friction, mixed, ordinary};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_derivatives_of_fischer_burmeister_are_its_differences(a in -2.0..2.0f64, b in -2.0..2.0f64) {
            prop_assume!(a.hypot(b) > 0.05 && a.abs() > 1e-4 && b.abs() > 1e-4);
            let (_, da, db) = fischer_burmeister(a, b, 1.0);
            let h = 1e-6;
            let by_a = (fischer_burmeister(a + h, b, 1.0).0 - fischer_burmeister(a - h, b, 1.0).0) / (2.0 * h);
            let by_b = (fischer_burmeister(a, b + h, 1.0).0 - fischer_burmeister(a, b - h, 1.0).0) / (2.0 * h);
            prop_assert!((da - by_a).abs() < 1e-7 && (db - by_b).abs() < 1e-7, "{da} {by_a} {db} {by_b}");
        }

        #[test]
        fn fischer_burmeister_vanishes_on_complementarity_only(a in 0.0..2.0f64, b in 0.001..2.0f64) {
            prop_assert_eq!(fischer_burmeister(a, 0.0, 1.0).0, 0.0);
            prop_assert_eq!(fischer_burmeister(0.0, a, 1.0).0, 0.0);
            prop_assert!(fischer_burmeister(a + 0.001, b, 1.0).0 > 0.0);
            prop_assert!(fischer_burmeister(a, -b, 1.0).0 < 0.0 && fischer_burmeister(-b, a, 1.0).0 < 0.0);
        }

        /// Clip, corner and normal equations at once; points next to a kink, where there is no derivative, are left
        /// out.
        #[test]
        fn the_jacobian_is_the_difference_of_the_residual(
            problem in prop_oneof![mixed(4, Friction::Tresca), ordinary(4, Friction::Coulomb(2.0))], v in proptest::collection::vec(-1.0..1.0f64, 8)
        ) {
            let laws = laws(&problem, &[]);
            let equations = Equations { problem: &problem, laws: &laws, unit: 0.7 };
            let v = &v[..problem.load.len()];
            let force = equations.at(v).force;
            let jacobian = equations.jacobian(v, &force);
            let pieces = nearest_pieces(&problem, &equations.laws_at(v, &force), v, &force);
            let h = 1e-6;
            for j in 0..v.len() {
                let shifted = |h: f64| {
                    let mut w = v.to_vec();
                    w[j] += h;
                    let state = equations.at(&w);
                    let laws = equations.laws_at(&w, &state.force);
                    (nearest_pieces(&problem, &laws, &w, &state.force), state.residual)
                };
                let ((p, up), (q, down)) = (shifted(h), shifted(-h));
                prop_assume!(p == pieces && q == pieces);
                for i in 0..v.len() {
                    let scale = jacobian.norm_max();
                    let difference = (up[i] - down[i]) / (2.0 * h);
                    // the curvature of φ grows next to its origin
                    let found = jacobian[(i, j)];
                    prop_assert!((found - difference).abs() < 1e-5 * scale, "{found} {difference}");
                }
            }
        }
    }
}
