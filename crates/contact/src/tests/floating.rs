//! Bodies that only contact and friction hold.

use proptest::prelude::*;

use crate::proptest::{Friction, floating};
use crate::{ContactError, Problem, active_set, kkt, newton, uzawa};

fn judged(problem: &Problem) -> [f64; 2] {
    [active_set(problem, None), newton(problem, None)].map(|answer| {
        let answer = answer.unwrap();
        let audit = kkt(problem, &answer);
        assert!(answer.converged() && audit.worst() <= 1e-10, "{audit:?} {:?}", answer.history);
        assert!(answer.displacement.iter().all(|v| v.abs() < 1e4), "{:?}", answer.displacement);
        problem.energy(&answer.displacement, &answer.multipliers)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn friction_holds_a_floating_body(problem in floating(8, Friction::Tresca)) {
        let [a, b] = judged(&problem);
        prop_assert!((a - b).abs() < 1e-9 * a.abs().max(1.0));
    }

    #[test]
    fn stick_holds_a_floating_body(problem in floating(8, Friction::Stick)) {
        let [a, b] = judged(&problem);
        prop_assert!((a - b).abs() < 1e-9 * a.abs().max(1.0));
    }

    #[test]
    fn a_balanced_load_needs_no_friction(problem in floating(8, Friction::None)) {
        let [a, b] = judged(&problem);
        prop_assert!((a - b).abs() < 1e-9 * a.abs().max(1.0));
    }

    #[test]
    fn a_load_that_nothing_stops_is_named(
        problem in floating(8, Friction::None), push in 0.1..1.0f64, lift in 0.0..2.0f64
    ) {
        let mut sideways = problem.clone();
        sideways.load.iter_mut().skip(1).step_by(2).for_each(|f| *f += push);
        let mut away = problem.clone();
        let total: f64 = problem.load.iter().step_by(2).sum();
        let n = problem.nodes.len() as f64;
        away.load.iter_mut().step_by(2).for_each(|f| *f -= total / n + push + lift);
        for free in [sideways, away] {
            for answer in [active_set(&free, None), newton(&free, None)] {
                match answer {
                    Err(ContactError::NotHeld { motion, work, scale }) => {
                        prop_assert!(work > 0.0 && work <= scale * (1.0 + 1e-9), "{work} {scale}");
                        let elastic = free.stiffness.times(&motion);
                        prop_assert!(crate::solvers::linear::largest(elastic) < 1e-9);
                    }
                    other => prop_assert!(false, "{other:?}"),
                }
            }
        }
    }

    #[test]
    fn uzawa_refuses_a_floating_body(problem in floating(5, Friction::Tresca)) {
        let refused = matches!(uzawa(&problem, None, None), Err(ContactError::NotCoercive { .. }));
        prop_assert!(refused);
    }
}
