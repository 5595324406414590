//! Sets of solutions, and problems with given sets.

use proptest::prelude::*;

use super::oracle::distance;
use super::rows::Row;
use crate::proptest::{Friction, mixed, ordinary};
use crate::{Condition, ContactNode, Frozen, FrozenDual, Problem, Sets, Solution, Status, interior_point};

fn conditions(problem: &Problem) -> impl Iterator<Item = (&ContactNode, &Condition)> {
    problem.nodes.iter().flat_map(|n| n.conditions.iter().map(move |c| (n, c)))
}

proptest! {
    #[test]
    fn the_sets_of_a_solution_give_it_back(problem in mixed(6, Friction::Tresca)) {
        let solution = interior_point(&problem).unwrap();
        let sets = Sets::new(&problem, &solution).unwrap();
        let again = Frozen::new(&problem, &sets).unwrap().displacement();
        prop_assert!(distance(&again, &solution.displacement) < 1e-10, "{again:?} {solution:?}");
    }

    #[test]
    fn the_sets_are_the_states(problem in ordinary(8, Friction::Tresca)) {
        let solution = interior_point(&problem).unwrap();
        let sets = Sets::new(&problem, &solution).unwrap();
        for (i, (_, c)) in conditions(&problem).enumerate() {
            let [pressure, shear] = solution.multipliers[i];
            prop_assert_eq!(sets.closed(i), pressure > 0.0);
            let slip = if c.bound == 0.0 {
                None
            } else if shear.abs() < c.bound * (1.0 - 1e-12) {
                Some(0)
            } else {
                Some(shear.signum() as i8)
            };
            prop_assert_eq!(sets.slip(i), slip);
            prop_assert_eq!(solution.status[i] == Status::Apart, !sets.closed(i));
        }
    }

    /// S (v + c) + Bᵀλ = f + df in what is free, and what is held stays.
    #[test]
    fn a_correction_is_the_change_of_the_displacement(
        problem in mixed(6, Friction::Tresca), more in proptest::collection::vec(-1.0..1.0f64, 12)
    ) {
        let sets = Sets::new(&problem, &interior_point(&problem).unwrap()).unwrap();
        let more = &more[..problem.load.len()];
        let scale = problem.stiffness.norm_max();
        let more: Vec<f64> = more.iter().map(|f| f * scale).collect();
        let mut loaded = problem.clone();
        loaded.load.iter_mut().zip(&more).for_each(|(f, df)| *f += df);
        let (frozen, other) = (Frozen::new(&problem, &sets).unwrap(), Frozen::new(&loaded, &sets).unwrap());
        let correction = frozen.correction(&more);
        let sum: Vec<f64> = frozen.displacement().iter().zip(&correction).map(|(v, c)| v + c).collect();
        prop_assert!(distance(&sum, &other.displacement()) < 1e-10);
        for (i, (node, c)) in conditions(&problem).enumerate() {
            let along = |d: [f64; 2], v: &[f64]| d[0] * node.pick(v)[0] + d[1] * node.pick(v)[1];
            prop_assert!(!sets.closed(i) || along(c.normal, &correction).abs() < 1e-12);
            prop_assert!(sets.slip(i) != Some(0) || along(c.tangent, &correction).abs() < 1e-12);
            prop_assert!(!sets.closed(i) || c.opening(node.pick(&sum)).abs() < 1e-12);
        }
    }

    /// j·v changes by y·δf with the load, the shear of Coulomb's law with the pressure.
    #[test]
    fn a_dual_solution_is_the_slope_of_its_number(
        problem in mixed(6, Friction::Coulomb(0.5)), numbers in proptest::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 12)
    ) {
        let solution = interior_point(&problem).unwrap();
        prop_assume!(solution.converged());
        let sets = Sets::new(&problem, &solution).unwrap();
        let frozen = Frozen::new(&problem, &sets).unwrap();
        let m = problem.load.len();
        let j: Vec<f64> = numbers[..m].iter().map(|own| own.0).collect();
        let y = FrozenDual::new(&frozen, &sets).solution(&j);
        let step = 1e-5 * problem.stiffness.norm_max();
        let of = |sign: f64| {
            let mut loaded = problem.clone();
            loaded.load.iter_mut().zip(&numbers).for_each(|(f, own)| *f += sign * step * own.1);
            interior_point(&loaded).unwrap()
        };
        let [less, more] = [-1.0, 1.0].map(of);
        let same = |other: &Solution| other.converged() && other.status == solution.status;
        prop_assume!(same(&less) && same(&more));
        let slope: f64 = (0..m).map(|i| j[i] * (more.displacement[i] - less.displacement[i]) / (2.0 * step)).sum();
        let work: f64 = (0..m).map(|i| y[i] * numbers[i].1).sum();
        let size: f64 = y.iter().map(|y| y.abs()).sum();
        prop_assert!((work - slope).abs() <= 1e-6 * size, "{work:e} {slope:e} of {size:e}");
    }

    #[test]
    fn a_state_that_is_set_is_read_and_obeyed(
        states in proptest::collection::vec((any::<bool>(), -1..=1i8), 1..8), w in -1.0..1.0f64, u in 0.1..1.0f64
    ) {
        let s: Vec<f64> = (0..states.len()).map(|i| i as f64).collect();
        let mut row = Row::new(&s, 0.3, 0.7);
        row.opening(|_| w);
        row.slip(1.0, |_| u);
        let sets = row.sets(&states);
        let v = Frozen::new(&row.problem, &sets).unwrap().displacement();
        for (i, &(closed, slip)) in states.iter().enumerate() {
            prop_assert_eq!((sets.closed(i), sets.slip(i)), (closed, Some(slip)));
            let opened = if closed { 0.3 } else { 0.3 - w };
            prop_assert!((v[2 * i] - opened).abs() < 1e-14);
            // slip the other way turns the friction round: 2 D F over the stiffness
            let slipped = [u + 2.0 * 0.5 * 0.7 / 3.0, 0.0, u][(slip + 1) as usize];
            prop_assert!((v[2 * i + 1] - slipped).abs() < 1e-14);
        }
    }
}

#[test]
fn a_state_that_a_node_does_not_have_is_not_set() {
    let mut row = Row::new(&[0.0], 0.3, 0.0);
    row.opening(|_| 0.1);
    let mut sets = row.sets(&[(true, 1)]);
    assert_eq!((sets.closed(0), sets.slip(0)), (true, None)); // no friction
    // a corner with two normals: both closed leave no tangent to stick on
    let condition = row.problem.nodes[0].conditions[0].clone();
    let other = Condition { normal: [0.6, 0.8], tangent: [-0.8, 0.6], ..condition.clone() };
    row.problem.nodes[0].conditions = [condition, other].map(|c| Condition { bound: 0.7, ..c }).to_vec();
    let mut rest = row.at_rest();
    rest.multipliers.push([0.0; 2]);
    sets = Sets::new(&row.problem, &rest).unwrap();
    (0..2).for_each(|i| sets.set_slip(i, 1));
    (0..2).for_each(|i| sets.set_closed(i, true));
    sets.set_slip(1, 0);
    assert_eq!([0, 1].map(|i| (sets.closed(i), sets.slip(i))), [(true, Some(1)); 2]);
    sets.set_closed(0, false);
    sets.set_slip(1, 0);
    assert_eq!([0, 1].map(|i| (sets.closed(i), sets.slip(i))), [(false, Some(1)), (true, Some(0))]);
    rest.multipliers.pop();
    let refused = Sets::new(&row.problem, &rest);
    assert!(matches!(refused, Err(crate::ContactError::Inconsistent { .. })));
}
