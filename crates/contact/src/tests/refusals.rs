//! Bad input, limit states, cycling and forced steps.

use faer::Mat;
use proptest::prelude::*;
use steklov_algebra::{Pattern, SparseSymmetric, Symmetric};

use crate::proptest::{Friction, mixed, ordinary};
use crate::{Condition, ContactError, ContactNode, Outcome, Problem, Start, Status, active_set, kkt, newton, uzawa};

fn wall(first: usize, unknowns: usize, gap: f64, bound: f64) -> ContactNode {
    let (normal, tangent) = if unknowns == 2 { ([1.0, 0.0], [0.0, 1.0]) } else { ([1.0, 0.0], [0.0, 0.0]) };
    let tangent_weight = if unknowns == 2 { 1.0 } else { 0.0 };
    let condition = Condition {
        normal,
        tangent,
        normal_weight: 1.0,
        tangent_weight,
        gap,
        slip_offset: 0.0,
        bound,
        coefficient: 0.0,
    };
    ContactNode { first, unknowns, conditions: vec![condition] }
}

fn refused(problem: &Problem) -> bool {
    [active_set(problem, None), newton(problem, None), uzawa(problem, None, None)]
        .iter()
        .all(|answer| matches!(answer, Err(ContactError::Inconsistent { .. })))
}

proptest! {
    #[test]
    fn one_bad_number_anywhere_is_refused(
        problem in mixed(4, Friction::Tresca), place in 0..9usize, bad in prop_oneof![Just(f64::NAN), Just(f64::NEG_INFINITY)]
    ) {
        let mut p = problem;
        let m = p.load.len();
        let c = &mut p.nodes[0].conditions[0];
        match place {
            0 => p.load[m - 1] = bad,
            1 => {
                let mut stiffness = p.stiffness.full().into_owned();
                stiffness[(m - 1, 0)] = bad;
                p.stiffness = stiffness.into();
            }
            2 => c.gap = bad,
            3 => c.bound = bad,
            4 => c.slip_offset = bad,
            5 => c.normal[0] = bad,
            6 => c.tangent[0] = bad,
            7 => c.normal_weight = bad,
            _ => c.tangent_weight = bad,
        }
        prop_assert!(refused(&p));
    }

    #[test]
    fn contact_nowhere_and_everywhere(problem in ordinary(8, Friction::Tresca)) {
        let mut apart = problem.clone();
        apart.nodes.iter_mut().for_each(|n| n.conditions[0].gap = 1e3);
        for answer in [active_set(&apart, None), newton(&apart, None), uzawa(&apart, None, None)].map(Result::unwrap) {
            prop_assert!(answer.converged() && answer.status.iter().all(|s| *s == Status::Apart), "{answer:?}");
            prop_assert!(answer.multipliers.iter().all(|l| l[0].abs() < 1e-12 * apart.stiffness.norm_max()));
        }
        // all gaps lowered far below where the load alone would bring the nodes: an overlap that all nodes must leave
        let mut closed = problem.clone();
        let size = closed.stiffness.norm_max();
        closed.stiffness = Mat::from_fn(closed.load.len(), closed.load.len(), |i, j| if i == j { size } else { 0.0 }).into();
        closed.nodes.iter_mut().for_each(|n| n.conditions[0].gap = -10.0);
        for answer in [active_set(&closed, None).unwrap(), newton(&closed, None).unwrap()] {
            prop_assert!(answer.converged() && kkt(&closed, &answer).worst() < 1e-10);
            prop_assert!(answer.status.iter().all(|s| *s != Status::Apart));
        }
    }

    #[test]
    fn touching_at_zero_gap_without_load_is_rest(problem in mixed(6, Friction::Tresca)) {
        let mut p = problem;
        p.load.iter_mut().for_each(|f| *f = 0.0);
        p.nodes.iter_mut().flat_map(|n| &mut n.conditions).for_each(|c| (c.gap, c.slip_offset) = (0.0, 0.0));
        for answer in [active_set(&p, None).unwrap(), newton(&p, None).unwrap(), uzawa(&p, None, None).unwrap()] {
            prop_assert!(answer.converged() && kkt(&p, &answer).worst() == 0.0);
            prop_assert!(answer.displacement.iter().chain(answer.multipliers.as_flattened()).all(|x| *x == 0.0));
        }
    }

    #[test]
    fn a_step_beyond_the_safe_one_is_reported(size in 0.1..10.0f64, force in 0.5..3.0f64) {
        // S = size, D = 1, Q = 1/size: safe below 2 size; λ -> λ + ρ (force - λ)/size
        let stiffness = Mat::from_fn(1, 1, |_, _| size);
        let problem = Problem { stiffness: stiffness.into(), load: vec![force], nodes: vec![wall(0, 1, 0.0, 0.0)] };
        let safe = uzawa(&problem, Some(1.99 * size), None).unwrap();
        prop_assert!(safe.converged() && (safe.multipliers[0][0] - force).abs() < 1e-9);
        let forced = uzawa(&problem, Some(2.01 * size), None).unwrap();
        prop_assert_eq!(forced.outcome, Outcome::Diverged);
    }
}

#[test]
fn sizes_and_unknowns_must_fit() {
    let good = Problem {
        stiffness: Mat::identity(4, 4).into(),
        load: vec![1.0; 4],
        nodes: vec![wall(0, 2, 0.0, 1.0), wall(2, 2, 0.0, 1.0)],
    };
    assert_eq!(good.check(), Ok(()));
    let change = |change: &dyn Fn(&mut Problem)| {
        let mut p = good.clone();
        change(&mut p);
        assert!(refused(&p));
        p.check().unwrap_err().to_string()
    };
    assert!(change(&|p| p.load.truncate(3)).contains("4×4"));
    assert!(change(&|p| p.nodes[1].first = 1).contains("two nodes"));
    assert!(change(&|p| p.nodes.truncate(1)).contains("unknown 2"));
    let with = |i: usize, j: usize, value: f64| {
        change(&|p| {
            let mut stiffness = p.stiffness.full().into_owned();
            stiffness[(i, j)] = value;
            p.stiffness = stiffness.into();
        })
    };
    assert!(with(0, 1, 0.5).contains("symmetric"));
    assert!(with(2, 2, -0.1).contains("diagonal"));
    let third = good.nodes[0].conditions[0].clone();
    assert!(change(&|p| p.nodes[0].conditions = vec![third.clone(); 3]).contains("3 conditions"));
    let diagonal = Pattern { start: (0..=4).collect(), rows: (0..4).collect() };
    let apart = SparseSymmetric::new(diagonal, vec![1.0; 4]).unwrap();
    assert!(change(&|p| p.stiffness = Symmetric::Sparse(apart.clone())).contains("no entry between"));
    assert!(change(&|p| p.nodes[0].conditions[0].bound = -1.0).contains("friction bound"));
    assert!(change(&|p| p.nodes[0].conditions[0].normal = [0.0; 2]).contains("direction"));
    // an overlap at a corner in full stick: no displacement does
    let mut stuck = wall(0, 2, -1.0, f64::INFINITY);
    let turned = Condition { normal: [0.0, 1.0], tangent: [-1.0, 0.0], ..stuck.conditions[0].clone() };
    stuck.conditions.push(turned);
    assert!(change(&|p| p.nodes[0] = stuck.clone()).contains("no displacement"));
}

/// Plain active sets cycle on this matrix of Curtis, Han and Robinson (2015) from some starts; the fallback ends it.
#[test]
fn a_cycle_ends_by_changing_one_node_at_a_time() {
    let s = [[4.0, 5.0, -5.0], [5.0, 9.0, -5.0], [-5.0, -5.0, 7.0]];
    let nodes = (0..3).map(|i| wall(i, 1, 0.0, 0.0)).collect();
    let problem = Problem { stiffness: Mat::from_fn(3, 3, |i, j| s[i][j]).into(), load: vec![-2.0, -1.0, 3.0], nodes };
    let exact = super::oracle::brute_force(&problem);
    let mut longest = 0;
    for sets in 0..8 {
        // a start whose pieces are the given sets: far inside contact, or far apart
        let in_contact = |i: usize| sets >> i & 1 == 1;
        let displacement: Vec<f64> = (0..3).map(|i| if in_contact(i) { 0.0 } else { -1.0 }).collect();
        let multipliers: Vec<[f64; 2]> = (0..3).map(|i| [f64::from(u8::from(in_contact(i))), 0.0]).collect();
        let start = Start { displacement: &displacement, multipliers: &multipliers };
        let answer = active_set(&problem, Some(start)).unwrap();
        assert!(answer.converged() && super::oracle::distance(&answer.displacement, &exact) < 1e-13, "{answer:?}");
        longest = longest.max(answer.iterations);
    }
    assert!(longest > 8, "no start cycles: the longest run has {longest} steps");
}
