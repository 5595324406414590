//! Coulomb's law: all solvers against brute force, closed forms of one node, the fixed point and its contraction.

use faer::Mat;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use steklov_algebra::eigenvalues;

use super::oracle::{coulomb_solutions, distance};
use crate::proptest::{Friction, floating, mixed, ordinary};
use crate::solvers::linear::largest;
use crate::{
    Condition, ContactNode, Contraction, Frozen, Outcome, Problem, Sets, Solution, Start, active_set, contraction,
    fixed_point, interior_point, kkt, newton, other_solution, uzawa,
};

/// Solved by each method that says that it converged; the judge must agree.
fn all(problem: &Problem) -> Vec<Solution> {
    let answers =
        [interior_point(problem), active_set(problem, None), newton(problem, None), fixed_point(problem, None)];
    let answers = answers.map(Result::unwrap).to_vec();
    for (i, answer) in answers.iter().enumerate() {
        let judged = kkt(problem, answer);
        assert!(!answer.converged() || judged.worst() <= 1e-10, "solver {i}: {judged:?} {:?}", answer.history);
    }
    answers
}

/// A node of the stiffness [[a, b], [b, c]] at a wall without gap, under the load f.
fn one([a, b, c]: [f64; 3], f: [f64; 2], coefficient: f64) -> Problem {
    let condition = Condition {
        normal: [1.0, 0.0],
        tangent: [0.0, 1.0],
        normal_weight: 1.0,
        tangent_weight: 1.0,
        gap: 0.0,
        slip_offset: 0.0,
        bound: 0.0,
        coefficient,
    };
    Problem {
        stiffness: Mat::from_fn(2, 2, |i, j| [[a, b], [b, c]][i][j]).into(),
        load: f.to_vec(),
        nodes: vec![ContactNode { first: 0, unknowns: 2, conditions: vec![condition] }],
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn small_coefficients_equal_brute_force(problem in ordinary(4, Friction::Coulomb(0.3))) {
        let exact = coulomb_solutions(&problem);
        prop_assume!(exact.len() == 1);
        for (i, answer) in all(&problem).iter().enumerate() {
            prop_assert!(answer.converged(), "solver {i}: {:?}", answer.history);
            let off = distance(&answer.displacement, &exact[0].0);
            prop_assert!(off < 1e-9, "solver {i}: {off:e} {exact:?}");
        }
    }

    /// Up to coefficients of 3: whatever converges is one of all solutions, and the robust method finds one of them.
    #[test]
    fn any_coefficient_gives_one_of_all_solutions(problem in ordinary(4, Friction::Coulomb(3.0))) {
        let exact = coulomb_solutions(&problem);
        let answers = all(&problem);
        for answer in answers.iter().filter(|a| a.converged()) {
            let off = exact.iter().map(|e| distance(&answer.displacement, &e.0)).fold(f64::INFINITY, f64::min);
            prop_assert!(off < 1e-8, "{off:e} {exact:?} {:?}", answer.displacement);
        }
        prop_assert!(exact.is_empty() || answers[0].converged(), "{exact:?} {:?}", answers[0].history);
    }

    /// Without a coefficient Coulomb's law is none, and a solution is that of its own Tresca problem.
    #[test]
    fn limits_of_the_law(problem in ordinary(6, Friction::Coulomb(0.5))) {
        let answer = interior_point(&problem).unwrap();
        prop_assert!(answer.converged(), "{:?}", answer.history);
        let scale = largest(answer.displacement.iter().copied()).max(1.0);
        prop_assert!(kkt(&problem, &answer).worst() <= 1e-10, "{:?} {:?} {:?}", kkt(&problem, &answer), answer, problem.nodes);
        let tresca = problem.tresca(&answer.multipliers);
        prop_assert!(!tresca.is_coulomb());
        let again = interior_point(&tresca).unwrap();
        prop_assert!(distance(&again.displacement, &answer.displacement) < 1e-9 * scale);
        let (a, b) = (problem.energy(&answer.displacement, &answer.multipliers), tresca.energy(&again.displacement, &again.multipliers));
        prop_assert!((a - b).abs() < 1e-9 * (a.abs() + problem.stiffness.norm_max()), "{a} {b}");
        let mut smooth = problem.clone();
        smooth.nodes.iter_mut().flat_map(|n| &mut n.conditions).for_each(|c| c.coefficient = 0.0);
        let mut tiny = problem;
        tiny.nodes.iter_mut().flat_map(|n| &mut n.conditions).for_each(|c| c.coefficient *= 1e-14);
        let [a, b] = [smooth, tiny].map(|p| interior_point(&p).unwrap().displacement);
        prop_assert!(distance(&a, &b) < 1e-12 * scale, "{a:?} {b:?}");
    }

    #[test]
    fn friction_under_pressure_holds_a_floating_body(mut problem in floating(8, Friction::Coulomb(0.5))) {
        // with one coefficient the largest possible friction does not depend on where the body is pressed
        let coefficients = || problem.nodes.iter().flat_map(|n| &n.conditions).map(|c| c.coefficient);
        let largest = coefficients().fold(0.0, f64::max);
        problem.nodes.iter_mut().flat_map(|n| &mut n.conditions).for_each(|c| c.coefficient = largest);
        for answer in [interior_point(&problem), active_set(&problem, None), newton(&problem, None)] {
            let answer = answer.unwrap();
            let judged = kkt(&problem, &answer);
            prop_assert!(answer.converged() && judged.worst() <= 1e-10, "{judged:?} {:?}", answer.history);
        }
    }

    #[test]
    fn many_nodes_settle(problem in ordinary(40, Friction::Coulomb(1.0))) {
        let answers = [interior_point(&problem), active_set(&problem, None), newton(&problem, None)].map(Result::unwrap);
        for answer in &answers {
            prop_assert!(answer.converged() && kkt(&problem, answer).worst() <= 1e-10, "{:?}", answer.history);
        }
    }

    /// u_n = 0 and slip along t: λ_n = f_n - b u_t, u_t = (f_t ∓ μ f_n)/(c ∓ μ b), a change of λ_n by 1 moves u_t by ∓μ/c.
    #[test]
    fn one_node_slips_as_it_must(b in -0.9..0.9f64, c in 1.0..3.0f64, f in (0.5..2.0f64, -3.0..3.0f64), coefficient in 0.0..0.4f64) {
        prop_assume!(f.1.abs() > coefficient * f.0 * 1.01 && coefficient > 0.01);
        let problem = one([1.0, b, c], [f.0, f.1], coefficient);
        let sign = f.1.signum();
        let slip = (f.1 - sign * coefficient * f.0) / (c - sign * coefficient * b);
        let pressure = f.0 - b * slip;
        prop_assume!(pressure > 1e-3);
        let answer = fixed_point(&problem, None).unwrap();
        prop_assert!(distance(&answer.displacement, &[0.0, slip]) < 1e-10, "{answer:?} {slip}");
        let factor = contraction(&problem, &answer).unwrap().factor;
        prop_assert!((factor - coefficient * b.abs() / c).abs() < 1e-9, "{factor}");
        let work = problem.friction_work(&answer.displacement, &answer.multipliers);
        prop_assert!((work - coefficient * pressure * slip.abs()).abs() < 1e-9);
    }

    /// λ_n⁺ of the Tresca problem is piecewise linear in the pressures of its bounds: differences are its derivative, whose
    /// spectral radius is the contraction.
    #[test]
    fn the_contraction_is_the_spectral_radius_of_the_fixed_point(problem in ordinary(6, Friction::Coulomb(1.0))) {
        let answer = interior_point(&problem).unwrap();
        prop_assume!(answer.converged());
        let n = problem.nodes.len();
        let scale = answer.multipliers.iter().fold(0.0f64, |m, l| m.max(l[0]));
        prop_assume!(scale > 0.0);
        let after = |j: usize, h: f64| -> Vec<f64> {
            let mut pressures = answer.multipliers.clone();
            pressures[j][0] += h;
            interior_point(&problem.tresca(&pressures)).unwrap().multipliers.iter().map(|l| l[0].max(0.0)).collect()
        };
        let h = 1e-4 * scale;
        // a difference of h has to leave every node that presses in contact
        prop_assume!(answer.multipliers.iter().all(|l| l[0] <= 0.0 || l[0] > 2.0 * h));
        let columns: Vec<[Vec<f64>; 2]> = (0..n).map(|j| [after(j, h), after(j, -h)]).collect();
        let slope = |sign: usize| Mat::from_fn(n, n, |i, j| {
            if answer.multipliers[j][0] <= h { return 0.0 } // a negative pressure counts as none
            let change = columns[j][sign][i] - answer.multipliers[i][0].max(0.0);
            if sign == 0 { change / h } else { -change / h }
        });
        let (up, down) = (slope(0), slope(1));
        prop_assume!((&up - &down).norm_max() < 1e-6); // else a set changes within h
        let radius = eigenvalues(up.as_ref()).unwrap().iter().fold(0.0f64, |m, z| m.max(z.norm()));
        let found = contraction(&problem, &answer).unwrap().factor;
        prop_assert!((found - radius).abs() <= 1e-3 * radius + 1e-5, "{found} {radius}");
    }

    /// At corners and oblique nodes there may be no solution (a wedge that friction jams): what converges is one.
    #[test]
    fn corners_have_solutions_that_the_judge_accepts_or_none(problem in mixed(6, Friction::Coulomb(0.5))) {
        for (i, answer) in all(&problem).iter().enumerate() {
            let judged = kkt(&problem, answer);
            prop_assert!(!answer.converged() || judged.worst() <= 1e-10, "solver {i}: {judged:?}");
        }
    }

    #[test]
    fn uzawa_finds_the_same_for_small_coefficients(problem in ordinary(4, Friction::Coulomb(0.2))) {
        let (a, b) = (uzawa(&problem, None, None).unwrap(), interior_point(&problem).unwrap());
        prop_assume!(a.converged());
        prop_assert!(distance(&a.displacement, &b.displacement) < 1e-8);
    }

    /// The sets of a solution, with the bounds of that solution, give it back.
    #[test]
    fn frozen_sets_give_the_solution_back(problem in ordinary(8, Friction::Coulomb(1.0))) {
        let answer = interior_point(&problem).unwrap();
        prop_assume!(answer.converged());
        let sets = Sets::new(&problem, &answer).unwrap();
        let frozen = Frozen::new(&problem, &sets).unwrap();
        let scale = largest(answer.displacement.iter().copied()).max(1.0);
        prop_assert!(distance(&frozen.displacement(), &answer.displacement) < 1e-9 * scale);
        for (i, l) in answer.multipliers.iter().enumerate().filter(|(_, l)| l[0] <= 0.0) {
            prop_assert!(sets.slip(i).is_none() && l[1] == 0.0, "{l:?}");
        }
    }
}

/// The node is pulled along b > 0 so that it lifts. It may also stick once f_t ≤ μ f_n, and slip with
/// λ_n = (c f_n - b f_t)/(c - μ b), where the contraction μ b/c is above 1.
#[test]
fn several_solutions_are_found_beyond_the_critical_coefficient() {
    let problem = |coefficient| one([1.0, 0.5, 1.0], [1.0, 2.5], coefficient);
    for (coefficient, count) in [(0.3, 1), (1.9, 1), (2.4, 1), (2.6, 3), (4.0, 3)] {
        let problem = problem(coefficient);
        let exact = coulomb_solutions(&problem);
        assert_eq!(exact.len(), count, "{coefficient} {exact:?}");
        let answer = interior_point(&problem).unwrap();
        assert!(answer.converged());
        assert_eq!(other_solution(&problem, &answer).unwrap().is_some(), count > 1, "{coefficient} {answer:?}");
        if let Some((v, multipliers)) = exact.into_iter().find(|e| e.0[1] > 1e-6 && e.1[0][0] > 0.0) {
            let slips = Solution { displacement: v, multipliers, ..answer };
            let Contraction { factor, real } = contraction(&problem, &slips).unwrap();
            assert!((factor - coefficient / 2.0).abs() < 1e-9 && factor == real && factor > 1.0, "{factor} {real}");
            let start = [[slips.multipliers[0][0] * 0.99, 0.0]];
            let start = Start { displacement: &slips.displacement, multipliers: &start };
            let away = fixed_point(&problem, Some(start)).unwrap();
            assert!((away.displacement[1] - slips.displacement[1]).abs() > 0.1, "{away:?}");
        }
    }
}

/// With b < 0 slip presses: λ_n ↦ f_n + |b| (f_t - μ λ_n)/c. Beyond μ = c/|b| = 2 that alternates without end, while there is
/// one solution, which the other methods find.
#[test]
fn a_fixed_point_that_does_not_contract_says_so() {
    let problem = |coefficient| one([2.0, -0.5, 1.0], [1.0, 4.0], coefficient);
    let slow = fixed_point(&problem(1.2), None).unwrap();
    let ratio = slow.history[40] / slow.history[39];
    assert!(slow.converged() && (ratio - 0.6).abs() < 1e-6, "{slow:?}");
    let none = fixed_point(&problem(2.2), None).unwrap();
    assert_eq!(none.outcome, Outcome::IterationLimit, "{none:?}");
    let exact = coulomb_solutions(&problem(2.2));
    assert_eq!(exact.len(), 1);
    let found = contraction(&problem(2.2), &interior_point(&problem(2.2)).unwrap()).unwrap();
    assert!(
        (found.factor - 1.1).abs() < 1e-9 && found.real == 0.0,
        "one solution, though nothing contracts: {found:?}"
    );
    for answer in [interior_point(&problem(2.2)), active_set(&problem(2.2), None), newton(&problem(2.2), None)] {
        assert!(distance(&answer.unwrap().displacement, &exact[0].0) < 1e-12);
    }
}

/// Nearly all problems with corners and oblique nodes under a small coefficient have a solution that the interior point method
/// finds; another method that converges mostly finds the same one.
#[test]
fn most_corners_are_solved() {
    let mut runner = TestRunner::deterministic();
    let strategy = mixed(6, Friction::Coulomb(0.2));
    let mut solved = [0; 4];
    for _ in 0..300 {
        let problem = strategy.new_tree(&mut runner).unwrap().current();
        for (count, answer) in solved.iter_mut().zip(all(&problem)) {
            *count += usize::from(answer.converged());
        }
    }
    println!("{solved:?} of 300");
    assert!(solved[0] >= 285 && solved.iter().all(|s| *s >= 240), "{solved:?}");
}

/// Large coefficients and few nodes, all solutions by brute force: the signs of det(I - T) add up to 1, so that a real
/// eigenvalue above 1 at one of them and others go together; the spectral radius says nothing of that.
#[test]
fn a_real_eigenvalue_above_one_means_several_solutions() {
    let mut runner = TestRunner::deterministic();
    let strategy = ordinary(4, Friction::Coulomb(8.0));
    let (mut several, mut missed, mut radius_of_one) = (0, 0, 0);
    for _ in 0..2000 {
        let problem = strategy.new_tree(&mut runner).unwrap().current();
        let exact = coulomb_solutions(&problem);
        let answer = interior_point(&problem).unwrap();
        if !answer.converged() {
            continue;
        }
        let contractions: Vec<Contraction> = exact
            .iter()
            .map(|(v, l)| Solution { displacement: v.clone(), multipliers: l.clone(), ..answer.clone() })
            .map(|solution| contraction(&problem, &solution).unwrap())
            .collect();
        let unstable = contractions.iter().filter(|c| c.real > 1.0).count();
        assert!(exact.len() == 1 + 2 * unstable, "{contractions:?}");
        let other = other_solution(&problem, &answer).unwrap();
        if exact.len() > 1 {
            several += 1;
            missed += usize::from(other.is_none());
        } else {
            radius_of_one += usize::from(contractions[0].factor >= 1.0);
            assert!(other.is_none(), "{other:?}");
        }
        if let Some(other) = other {
            assert!(kkt(&problem, &other).worst() <= 1e-10);
        }
    }
    println!("{several} with several solutions, {missed} missed; {radius_of_one} with one though nothing contracts");
    assert!(several > 20 && 5 * missed < several, "{missed} of {several}");
    assert!(radius_of_one > several, "{radius_of_one}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// F = bound + μ λ_n: all methods agree.
    #[test]
    fn bound_and_coefficient_add_up(mut problem in ordinary(6, Friction::Coulomb(0.3))) {
        let size = largest(problem.load.iter().copied());
        let conditions = problem.nodes.iter_mut().flat_map(|n| &mut n.conditions);
        conditions.enumerate().for_each(|(i, c)| c.bound = 0.1 * size * (i % 3) as f64);
        let answers = all(&problem);
        let scale = largest(answers[0].displacement.iter().copied()).max(1e-3);
        for (i, answer) in answers.iter().enumerate() {
            prop_assert!(answer.converged(), "solver {i}: {:?}", answer.history);
            let off = distance(&answer.displacement, &answers[0].displacement);
            prop_assert!(off < 1e-8 * scale, "solver {i}: {off:e}");
        }
        for (c, l) in problem.nodes.iter().flat_map(|n| &n.conditions).zip(&answers[0].multipliers) {
            prop_assert!(l[1].abs() <= c.bound + c.coefficient * l[0].max(0.0) + 1e-9 * size, "{l:?} {c:?}");
        }
    }
}

/// u_n = 0, λ_n = 2, and a shear of 1.5 against F = 0.5 + 0.25·2 = 1: slip by 0.5, and none against 0.5 + 0.5·2.
#[test]
fn a_node_slips_under_bound_and_coefficient() {
    for (coefficient, slip, shear) in [(0.25, 0.5, 1.0), (0.5, 0.0, 1.5)] {
        let mut problem = one([1.0, 0.0, 1.0], [2.0, 1.5], coefficient);
        problem.nodes[0].conditions[0].bound = 0.5;
        for (i, answer) in all(&problem).iter().enumerate() {
            assert!(distance(&answer.displacement, &[0.0, slip]) < 1e-9, "solver {i}: {answer:?}");
            assert!(distance(&answer.multipliers[0], &[2.0, shear]) < 1e-9, "solver {i}: {answer:?}");
        }
    }
}
