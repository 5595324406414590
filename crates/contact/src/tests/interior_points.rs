//! The interior point method against brute force, the other solvers, and problems moved and scaled.

use faer::Mat;
use proptest::prelude::*;

use super::oracle::{brute_force, distance};
use crate::proptest::{Friction, floating, mixed, ordinary};
use crate::solvers::linear::largest;
use crate::{Condition, ContactError, ContactNode, Problem, Solution, Status, active_set, interior_point, kkt};

/// The answer, which must pass the judge to 1e-10 except for the rounding of S v, which counts far from v = 0 only.
fn solved(problem: &Problem) -> Solution {
    let answer = interior_point(problem).unwrap();
    let (v, s) = (&answer.displacement, &problem.stiffness);
    let terms = largest((0..v.len()).map(|i| (0..v.len()).map(|j| (s[(i, j)] * v[j]).abs()).sum()));
    let scale = largest(s.times(v)) + largest(problem.load.iter().copied());
    let rounding = if scale > 0.0 { 1e-15 * terms / scale } else { 0.0 };
    let mut judged = kkt(problem, &answer);
    judged.equilibrium = (judged.equilibrium - rounding).max(0.0);
    assert!(answer.converged() && judged.worst() <= 1e-10, "{:?} {judged:?} {:?}", answer.outcome, answer.history);
    answer
}

fn conditions(problem: &mut Problem) -> impl Iterator<Item = &mut Condition> {
    problem.nodes.iter_mut().flat_map(|n| &mut n.conditions)
}

/// Nodes of all kinds, each bound and weight left as it is or made 0, tiny, huge or infinite.
fn extreme(nodes: usize) -> impl Strategy<Value = Problem> {
    (mixed(nodes, Friction::Tresca), proptest::collection::vec((0..8usize, 0..8usize), 2 * nodes)).prop_filter_map(
        "conditions that no displacement satisfies",
        |(mut problem, kinds)| {
            let ordinary = |n: &ContactNode| n.unknowns == 2 && n.conditions.len() == 1;
            let ordinary: Vec<bool> =
                problem.nodes.iter().flat_map(|n| n.conditions.iter().map(move |_| ordinary(n))).collect();
            for ((c, (bound, weight)), ordinary) in conditions(&mut problem).zip(kinds).zip(ordinary) {
                match bound {
                    0 | 1 => c.bound = f64::INFINITY,
                    // elsewhere an overlap makes it slip, and the loads get lost in the rounding of its force
                    2 if ordinary => c.bound *= 1e6,
                    3 => c.bound *= 1e-6,
                    4 => c.bound = 0.0,
                    _ => {}
                }
                match weight {
                    0 => c.normal_weight = 0.0,
                    1 => c.tangent_weight = 0.0,
                    2 => c.tangent_weight *= 1e-3,
                    _ => {}
                }
            }
            problem.check().is_ok().then_some(problem)
        },
    )
}

/// One corner with a right angle, where each tangent is the other normal, next to another node.
fn right_angle() -> impl Strategy<Value = Problem> {
    (extreme(1), extreme(1), -3.0..3.0f64, proptest::collection::vec(-1.0..1.0f64, 18)).prop_map(
        |(other, bounds, angle, g)| {
            let drawn = &bounds.nodes[0].conditions[0];
            let (n, t) = ([angle.cos(), angle.sin()], [-angle.sin(), angle.cos()]);
            let first = Condition { normal: n, tangent: t, gap: drawn.gap.abs(), slip_offset: 0.0, ..drawn.clone() };
            let second = Condition { normal: t, tangent: n.map(|x| -x), gap: drawn.gap.abs() / 2.0, ..first.clone() };
            let m = other.load.len();
            let mut nodes = other.nodes;
            nodes.push(ContactNode { first: m, unknowns: 2, conditions: vec![first, second] });
            let size = other.stiffness.norm_max();
            let stiffness = Mat::from_fn(m + 2, m + 2, |i, j| {
                let gram: f64 = (0..m + 2).map(|k| g[(4 * i + k) % 18] * g[(4 * j + k) % 18]).sum();
                size * (gram + if i == j { 0.3 } else { 0.0 })
            });
            let mut load = other.load;
            load.extend([g[0] * size, g[1] * size]);
            Problem { stiffness: stiffness.into(), load, nodes }
        },
    )
}

/// To 1e-9, of the largest displacement where that is above 1: full stick nearly along an overlapped wall takes a node far.
fn equals_brute_force(problem: &Problem) -> Result<(), TestCaseError> {
    let exact = brute_force(problem);
    let off = distance(&solved(problem).displacement, &exact);
    prop_assert!(off < 1e-9 * largest(exact.iter().copied()).max(1.0), "{off:e} {exact:?}");
    Ok(())
}

/// The energy and the displacement of the active set method, which stops at the same tolerance.
fn as_active_set(problem: &Problem, answer: &Solution) -> Result<(), TestCaseError> {
    let other = active_set(problem, None).unwrap();
    let (a, b) = (
        problem.energy(&answer.displacement, &answer.multipliers),
        problem.energy(&other.displacement, &other.multipliers),
    );
    prop_assert!((a - b).abs() <= 1e-9 * (a.abs() + problem.stiffness.norm_max()), "{a} {b}");
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn ordinary_nodes_equal_brute_force(problem in ordinary(4, Friction::Tresca)) {
        equals_brute_force(&problem)?;
    }

    #[test]
    fn eight_nodes_equal_brute_force(a in ordinary(8, Friction::None), b in ordinary(8, Friction::Stick)) {
        for problem in [&a, &b] {
            equals_brute_force(problem)?;
        }
    }

    #[test]
    fn all_kinds_of_nodes_and_bounds_equal_brute_force(problem in extreme(2)) {
        equals_brute_force(&problem)?;
    }

    #[test]
    fn a_right_angle_equals_brute_force(problem in right_angle()) {
        prop_assume!(problem.check().is_ok());
        equals_brute_force(&problem)?;
    }

    #[test]
    fn larger_problems_equal_the_active_set(rough in extreme(30), plain in ordinary(40, Friction::Tresca)) {
        for problem in [&rough, &plain] {
            let other = active_set(problem, None).unwrap();
            prop_assert!(distance(&solved(problem).displacement, &other.displacement) < 1e-9);
        }
        prop_assert!(solved(&plain).iterations <= 25);
    }

    #[test]
    fn floating_bodies_have_the_least_energy(
        problem in prop_oneof![
            floating(40, Friction::Tresca), floating(40, Friction::Stick), floating(40, Friction::None)
        ]
    ) {
        as_active_set(&problem, &solved(&problem))?;
    }

    /// Closed under λ_n = 1 and slipping everywhere, the first node backwards: friction and load balance, the body may lie
    /// anywhere between the next changes of direction. With the mean slip 0 many would go the wrong way.
    #[test]
    fn a_body_that_slips_everywhere_is_found(
        drawn in floating(12, Friction::Tresca), w in proptest::collection::vec(0.01..2.0f64, 24)
    ) {
        let mut problem = drawn;
        let mut w = w[..problem.load.len()].to_vec();
        w[1] = -w[1];
        problem.load = problem.stiffness.times(&w);
        for (i, node) in problem.nodes.iter_mut().enumerate() {
            let c = &mut node.conditions[0];
            (c.gap, c.slip_offset, c.bound) = (w[2 * i], 0.0, c.bound.max(0.01));
            problem.load[2 * i] += c.normal_weight;
            problem.load[2 * i + 1] += c.tangent_weight * c.bound * w[2 * i + 1].signum();
        }
        let answer = solved(&problem);
        let (a, b) = (problem.energy(&answer.displacement, &answer.multipliers), problem.energy(&w, &answer.multipliers));
        prop_assert!((a - b).abs() <= 1e-9 * (a.abs() + problem.stiffness.norm_max()), "{a} {b}");
        prop_assert!(answer.iterations <= 30, "{:?}", answer.history);
    }

    /// u_n → u_n + d and g → g + d changes nothing else in a body that nothing holds.
    #[test]
    fn a_floating_body_is_pressed_at_any_distance(problem in floating(8, Friction::Tresca), exponent in -6.0..8.0f64) {
        let far = 10f64.powf(exponent);
        let mut moved = problem.clone();
        conditions(&mut moved).for_each(|c| c.gap += far);
        let (near, far_answer) = (solved(&problem), solved(&moved));
        // lengths are right to 1e-10 of the distance; weights are 0.1 at least
        let tolerance = 1e-10 * (1.0 + far) * problem.stiffness.norm_max() / 0.1;
        for (a, b) in near.multipliers.as_flattened().iter().zip(far_answer.multipliers.as_flattened()) {
            prop_assert!((a - b).abs() <= tolerance, "{near:?} {far_answer:?}");
        }
    }

    #[test]
    fn far_gaps_and_deep_overlaps(problem in mixed(8, Friction::Tresca), exponent in 2.0..6.0f64) {
        for gap in [10f64.powf(exponent), -10f64.powf(exponent)] {
            let mut p = problem.clone();
            conditions(&mut p).for_each(|c| c.gap = gap);
            let answer = solved(&p);
            prop_assert!(gap < 0.0 || answer.status.iter().all(|s| *s == Status::Apart));
            prop_assert!(distance(&answer.displacement, &active_set(&p, None).unwrap().displacement) < 1e-9 * gap.abs());
        }
    }

    /// In other units of length and stress the numbers change, the steps do not.
    #[test]
    fn units_do_not_matter(
        problem in prop_oneof![mixed(8, Friction::Tresca).boxed(), floating(8, Friction::Tresca).boxed()],
        length in -6.0..6.0f64, stress in -6.0..6.0f64
    ) {
        let (length, stress) = (10f64.powf(length), 10f64.powf(stress));
        let mut scaled = problem.clone();
        scaled.stiffness = (&*problem.stiffness.full() * faer::Scale(stress)).into();
        scaled.load.iter_mut().for_each(|f| *f *= stress * length);
        for c in conditions(&mut scaled) {
            c.bound *= stress;
            for x in [&mut c.gap, &mut c.slip_offset, &mut c.normal_weight, &mut c.tangent_weight] {
                *x *= length;
            }
        }
        let (a, b) = (solved(&problem), solved(&scaled));
        prop_assert_eq!(a.iterations, b.iterations, "{:?} {:?}", a.history, b.history);
        let back: Vec<f64> = b.displacement.iter().map(|v| v / length).collect();
        prop_assert!(distance(&a.displacement, &back) < 1e-9);
    }

    #[test]
    fn nothing_moves_an_unloaded_body(problem in prop_oneof![mixed(6, Friction::Tresca).boxed(), floating(6, Friction::Tresca).boxed()]) {
        let mut p = problem;
        p.load.iter_mut().for_each(|f| *f = 0.0);
        conditions(&mut p).for_each(|c| (c.gap, c.slip_offset) = (c.gap.abs(), 0.0));
        let answer = solved(&p);
        prop_assert!(answer.displacement.iter().chain(answer.multipliers.as_flattened()).all(|x| *x == 0.0));
    }

    #[test]
    fn a_load_that_nothing_stops_is_named(
        problem in floating(8, Friction::Tresca), push in 0.1..1.0f64, lift in 0.1..1.0f64
    ) {
        let friction: f64 = problem.nodes.iter().flat_map(|n| &n.conditions).map(|c| c.tangent_weight * c.bound).sum();
        let n = problem.nodes.len() as f64;
        let mut sideways = problem.clone();
        let shear: f64 = problem.load.iter().skip(1).step_by(2).sum();
        sideways.load.iter_mut().skip(1).step_by(2).for_each(|f| *f += push + (friction - shear) / n);
        let mut away = problem.clone();
        let total: f64 = problem.load.iter().step_by(2).sum();
        away.load.iter_mut().step_by(2).for_each(|f| *f -= total / n + lift);
        for free in [sideways, away] {
            match interior_point(&free) {
                Err(ContactError::NotHeld { motion, work, .. }) => {
                    let elastic = free.stiffness.times(&motion);
                    prop_assert!(work > 0.0 && largest(elastic) < 1e-9);
                }
                other => prop_assert!(false, "{other:?}"),
            }
        }
    }
}
