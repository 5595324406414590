//! Ends that move by one node, against problems with the sets that follow.

use proptest::prelude::*;

use super::oracle::distance;
use super::rows::{Row, SPRING, WEIGHT};
use crate::proptest::{Friction, ordinary};
use crate::{ContactLine, Frozen, LinePoint, MovedEnd, Problem, Sets, interior_point, moved_ends};

/// ½ vᵀSv - fᵀv + Σ D s F u_t, s the slip of the sets.
fn energy(problem: &Problem, sets: &Sets, v: &[f64]) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let friction = problem.nodes.iter().enumerate().map(|(i, node)| {
        let c = &node.conditions[0];
        c.tangent_weight * f64::from(sets.slip(i).unwrap_or(0)) * c.bound * c.slip(node.pick(v))
    });
    0.5 * dot(v, &problem.stiffness.times(v)) - dot(&problem.load, v) + friction.sum::<f64>()
}

proptest! {
    #[test]
    fn an_end_moves_as_the_sets_with_it(problem in ordinary(8, Friction::Tresca)) {
        let solution = interior_point(&problem).unwrap();
        let sets = Sets::new(&problem, &solution).unwrap();
        let frozen = Frozen::new(&problem, &sets).unwrap();
        let points = (0..problem.nodes.len()).map(|i| LinePoint { s: i as f64, node: i, condition: 0, index: i });
        let line = ContactLine { edge: 0, points: points.collect() };
        // without the nodes that stick under much of their bound
        let mut moved = moved_ends((&problem, &solution), (&sets, &frozen), (&[line], false));
        // the sets that follow, and the most that a condition moves off its line
        let mut expected: Vec<[(Sets, f64); 2]> = Vec::new();
        let with = |change: &dyn Fn(&mut Sets)| {
            let mut sets = sets.clone();
            change(&mut sets);
            sets
        };
        let at = |k: usize| (&problem.nodes[k].conditions[0], problem.nodes[k].pick(&solution.displacement));
        let opening = |k: usize| at(k).0.opening(at(k).1).abs();
        let slip = |k: usize| at(k).0.slip(at(k).1).abs();
        for j in 1..problem.nodes.len() {
            let i = j - 1;
            if sets.closed(i) != sets.closed(j) {
                let [held, free] = if sets.closed(i) { [i, j] } else { [j, i] };
                let released = with(&|sets| sets.set_closed(held, false));
                expected.push([(released, opening(free)), (with(&|sets| sets.set_closed(free, true)), 0.0)]);
            }
            match [i, j].map(|k| sets.slip(k)) {
                [Some(a), Some(b)] if a != b && a * b == 0 => {
                    let [held, free] = if a == 0 { [i, j] } else { [j, i] };
                    let released = with(&|sets| sets.set_slip(held, a + b));
                    expected.push([(released, slip(free)), (with(&|sets| sets.set_slip(free, 0)), 0.0)]);
                }
                [Some(a), Some(b)] if a != b => {
                    expected.push([i, j].map(|k| (with(&|sets| sets.set_slip(k, 0)), 0.0)));
                }
                _ => {}
            }
        }
        prop_assert!(moved.len() >= expected.len());
        moved.truncate(expected.len());
        let (of_solution, scale) = (&sets, problem.stiffness.norm_max());
        let before = energy(&problem, &sets, &solution.displacement);
        for (moved, (sets, most)) in moved.iter().flatten().zip(expected.iter().flatten()) {
            let other = Frozen::new(&problem, sets).unwrap().displacement();
            let change: Vec<f64> = other.iter().zip(&solution.displacement).map(|(a, b)| a - b).collect();
            // the condition that is released alone leaves its line
            let off = (0..problem.nodes.len()).map(|k| {
                let (c, change) = (at(k).0, problem.nodes[k].pick(&change));
                let along = |d: [f64; 2]| d[0] * change[0] + d[1] * change[1];
                if of_solution.closed(k) && !sets.closed(k) {
                    along(c.normal).abs()
                } else if of_solution.slip(k) == Some(0) && sets.slip(k) != Some(0) {
                    along(c.tangent).abs()
                } else {
                    0.0
                }
            });
            let off = off.fold(0.0, f64::max);
            let part = if off > *most && *most > 0.0 { most / off } else { 1.0 };
            // entry by entry, each with its dual solution
            let sum: Vec<f64> = (0..change.len()).map(|i| {
                let mut unit = vec![0.0; change.len()];
                unit[i] = 1.0;
                solution.displacement[i] + moved.change_of(&unit, &frozen.correction(&unit))
            }).collect();
            let capped: Vec<f64> = solution.displacement.iter().zip(&change).map(|(v, d)| v + part * d).collect();
            prop_assert!(distance(&sum, &capped) < 1e-9, "{sum:?} {capped:?}");
            prop_assert!((moved.energy - (energy(&problem, sets, &sum) - before)).abs() < 1e-9 * scale);
        }
    }
}

/// Nodes on springs: one that sticks under 0.8 and one under 0.3 of the bound, closed under pressure.
#[test]
fn nodes_near_slip_and_last_nodes_that_may_open_are_ends() {
    let (bound, shares, overlap) = (0.7, [0.8, 0.3], 0.2);
    let mut row = Row::new(&[0.0, 1.0], 0.1, bound);
    row.opening(|_| -overlap);
    for (i, share) in shares.into_iter().enumerate() {
        row.problem.load[2 * i + 1] = share * WEIGHT * bound;
    }
    let solution = interior_point(&row.problem).unwrap();
    let sets = Sets::new(&row.problem, &solution).unwrap();
    let frozen = Frozen::new(&row.problem, &sets).unwrap();
    let of = |may_open| moved_ends((&row.problem, &solution), (&sets, &frozen), (&[row.line.clone()], may_open));
    let change = |ends: &[MovedEnd; 2], unknown: usize| {
        let mut unit = vec![0.0; 4];
        unit[unknown] = 1.0;
        ends.each_ref().map(|end| end.change_of(&unit, &frozen.correction(&unit)))
    };
    // half of the shear of the first one on its spring
    let slides = 0.5 * shares[0] * WEIGHT * bound / SPRING;
    let near = of(false);
    assert_eq!(near.len(), 1);
    assert!(change(&near[0], 1).iter().all(|own| (own - slides).abs() < 1e-12), "{:?}", change(&near[0], 1));
    // the whole pressure, which held the spring by the overlap
    let open = of(true);
    assert_eq!(open.len(), 3);
    for (ends, unknown) in open[1..].iter().zip([0, 2]) {
        assert!(change(ends, unknown).iter().all(|own| (own - overlap).abs() < 1e-12), "{:?}", change(ends, unknown));
        assert!(ends.iter().all(|end| (end.energy + 0.5 * SPRING * overlap * overlap).abs() < 1e-12));
    }
}
