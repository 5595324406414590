//! All solvers against brute force, and limits of the law.

use proptest::prelude::*;

use super::oracle::{brute_force, distance};
use crate::proptest::{Friction, mixed, ordinary};
use crate::{ContactNode, Outcome, Problem, Solution, Start, active_set, interior_point, kkt, newton, uzawa};

/// The three answers; each must have converged and pass the judge. Uzawa's iteration may reach its limit at a corner,
/// whose two normals and two tangents are dependent, and where normal and tangent share one unknown; it is left out then.
fn all(problem: &Problem) -> Vec<Solution> {
    let corners = problem.nodes.iter().any(|n| n.conditions.len() > 1 || n.unknowns == 1);
    let mut answers =
        vec![active_set(problem, None).unwrap(), newton(problem, None).unwrap(), uzawa(problem, None, None).unwrap()];
    if corners && answers[2].outcome == Outcome::IterationLimit {
        answers.pop();
    }
    for (i, answer) in answers.iter().enumerate() {
        let judged = kkt(problem, answer);
        assert!(answer.converged(), "solver {i}: {:?} {:?}", answer.outcome, answer.history);
        // relative to a displacement that may vanish, the displacements of Uzawa's iteration are never judged small
        let worst = if i == 2 { judged.equilibrium.max(judged.tension) } else { judged.worst() };
        assert!(worst <= 1e-10, "solver {i}: {judged:?}");
    }
    answers
}

/// Equal to 1e-9; Uzawa's iteration ends at 1e-11 of its residual, which corners of nearly parallel sides magnify.
fn equal(answers: &[Solution], exact: &[f64]) -> bool {
    answers.iter().zip([1e-9, 1e-9, 1e-8]).all(|(answer, tolerance)| {
        let off = distance(&answer.displacement, exact);
        if off >= tolerance {
            eprintln!("off by {off:e}: {:?} {:?}", answer.displacement, exact);
        }
        off < tolerance
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn ordinary_nodes_equal_brute_force(problem in ordinary(4, Friction::Tresca)) {
        let exact = brute_force(&problem);
        prop_assert!(equal(&all(&problem), &exact));
    }

    #[test]
    fn eight_nodes_without_friction_equal_brute_force(problem in ordinary(8, Friction::None)) {
        let exact = brute_force(&problem);
        prop_assert!(equal(&all(&problem), &exact));
    }

    #[test]
    fn eight_nodes_in_full_stick_equal_brute_force(problem in ordinary(8, Friction::Stick)) {
        let exact = brute_force(&problem);
        prop_assert!(equal(&all(&problem), &exact));
    }

    #[test]
    fn corners_and_oblique_nodes_equal_brute_force(problem in mixed(2, Friction::Tresca)) {
        let exact = brute_force(&problem);
        prop_assert!(equal(&all(&problem), &exact));
    }

    #[test]
    fn larger_mixed_problems_have_one_answer(problem in mixed(8, Friction::Tresca)) {
        let answers = all(&problem);
        prop_assert!(equal(&answers, &answers[0].displacement));
        let least = problem.energy(&answers[0].displacement, &answers[0].multipliers);
        for answer in &answers {
            let energy = problem.energy(&answer.displacement, &answer.multipliers);
            let scale = least.abs() + problem.stiffness.norm_max();
            prop_assert!((energy - least).abs() <= 1e-8 * scale, "{energy} {least}");
        }
    }

    #[test]
    fn a_huge_bound_is_stick_and_a_weightless_shear_is_frictionless(problem in ordinary(8, Friction::Tresca)) {
        let with = |change: &dyn Fn(&mut crate::Condition)| {
            let mut p = problem.clone();
            p.nodes.iter_mut().flat_map(|n: &mut ContactNode| &mut n.conditions).for_each(change);
            active_set(&p, None).unwrap().displacement
        };
        let huge = with(&|c| c.bound = 1e6 * problem.stiffness.norm_max() / c.tangent_weight);
        prop_assert!(distance(&huge, &with(&|c| c.bound = f64::INFINITY)) < 1e-9);
        prop_assert!(distance(&with(&|c| c.bound = 0.0), &with(&|c| c.tangent_weight = 0.0)) < 1e-9);
    }

    #[test]
    fn a_solution_is_its_own_start(problem in mixed(6, Friction::Tresca)) {
        let cold = interior_point(&problem).unwrap();
        let start = Start { displacement: &cold.displacement, multipliers: &cold.multipliers };
        let warm = active_set(&problem, Some(start)).unwrap();
        prop_assert!(warm.iterations <= 2, "{cold:?} {warm:?}");
        prop_assert!(distance(&warm.displacement, &cold.displacement) < 1e-9, "{cold:?} {warm:?}");
        let warm = newton(&problem, Some(start)).unwrap();
        prop_assert!(warm.iterations <= 2, "{cold:?} {warm:?}");
        prop_assert!(distance(&warm.displacement, &cold.displacement) < 1e-9, "{cold:?} {warm:?}");
    }

    /// Where nothing touches, the contact stress is rounding and no measure of anything.
    #[test]
    fn an_untouched_body_is_its_own_start(problem in mixed(6, Friction::Tresca)) {
        let mut apart = problem;
        let mut at = |gap: f64| {
            apart.nodes.iter_mut().flat_map(|n| &mut n.conditions).for_each(|c| (c.gap, c.bound) = (gap, 0.0));
            (active_set(&apart, None).unwrap(), apart.clone())
        };
        let size = at(1e3).0.displacement.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let (cold, apart) = at(10.0 * size);
        prop_assert!(cold.multipliers.as_flattened().iter().all(|l| *l == 0.0));
        let start = Start { displacement: &cold.displacement, multipliers: &cold.multipliers };
        let warm = newton(&apart, Some(start)).unwrap();
        prop_assert!(warm.iterations == 0, "{cold:?} {warm:?}");
    }

    #[test]
    fn the_answer_has_the_least_energy(
        problem in mixed(6, Friction::Tresca), other in proptest::collection::vec(-1.0..1.0f64, 12), t in 0.0..1.0f64
    ) {
        let answer = active_set(&problem, None).unwrap();
        let v = &answer.displacement;
        let w: Vec<f64> = v.iter().zip(&other).map(|(v, o)| v + t * o).collect();
        let open = problem.nodes.iter().all(|n| n.conditions.iter().all(|c| c.opening(n.pick(&w)) >= 0.0));
        if open {
            prop_assert!(problem.energy(&w, &answer.multipliers) >= problem.energy(v, &answer.multipliers) - 1e-10 * problem.stiffness.norm_max());
        }
    }
}
