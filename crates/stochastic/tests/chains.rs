//! Chains of problems that differ in their random input.

use crate::square::{Square, solve_outcome, square, weight};
use proptest::prelude::*;
use steklov_contact::proptest::{Friction, mixed};
use steklov_contact::{ContactError, Problem, Solution, kkt};
use steklov_stochastic::{
    Accumulator, CHAIN, Nodes, StochasticMesh, Variable, changes, refine, sample, scale_bounds, solve_points,
    solve_warm, truncation,
};

fn problem(square: &Square) -> Problem {
    Problem { stiffness: square.stiffness.clone().into(), load: square.load.clone(), nodes: square.nodes(2e-4, 0.35) }
}

fn solve(square: &Square, modulus: f64, warm: &mut Option<Solution>) -> Result<Solution, ContactError> {
    solve_outcome(problem(square), modulus, warm)
}

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

fn modulus() -> Variable {
    Variable::uniform(1800.0, 2200.0).unwrap()
}

#[test]
fn chains_start_anew_every_few_points_and_keep_the_order() {
    for count in [0, 1, CHAIN, CHAIN + 1, 5 * CHAIN - 1] {
        // the state counts the points of its chain
        let answers: Result<Vec<(usize, usize)>, ()> = solve_points(count, |i, seen: &mut usize| {
            *seen += 1;
            Ok((i, *seen))
        });
        let wanted: Vec<(usize, usize)> = (0..count).map(|i| (i, i % CHAIN + 1)).collect();
        assert_eq!(answers.unwrap(), wanted);
    }
}

#[test]
fn the_error_of_the_first_chain_that_has_one_is_told() {
    let solve = |bad: &'static [usize]| {
        solve_points(4 * CHAIN, move |i, seen: &mut Vec<usize>| {
            seen.push(i);
            if bad.contains(&i) { Err(seen.clone()) } else { Ok(i) }
        })
    };
    assert_eq!(solve(&[3 * CHAIN, 2 * CHAIN + 1, 2 * CHAIN + 5]), Err(vec![2 * CHAIN, 2 * CHAIN + 1]));
    assert_eq!(solve(&[]).unwrap().len(), 4 * CHAIN);
    // of a problem: the load of the second outcome is too short
    let square = square(4, [0.3, -1.0]);
    let answers = solve_points(3, |i, warm: &mut Option<Solution>| {
        let mut problem = problem(&square);
        if i == 1 {
            problem.load.pop();
        }
        solve_outcome(problem, 2000.0, warm)
    });
    assert!(matches!(answers, Err(ContactError::Inconsistent { .. })));
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    let scale = a.iter().fold(0.0f64, |m, a| m.max(a.abs()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / scale
}

#[test]
fn warm_answers_are_the_cold_ones_in_fewer_steps_and_in_any_number_of_threads() {
    let square = square(16, [0.3, -1.0]);
    let points: Vec<f64> = (0..100).map(|i| sample(&[modulus()], 7, i)[0]).collect();
    let warm = || solve_points(points.len(), |i, warm| solve(&square, points[i], warm)).unwrap();
    let (one, two) = (on_threads(1, warm), on_threads(2, warm));
    let (mut fast, mut slow) = (0, 0);
    for ((a, b), &modulus) in one.iter().zip(&two).zip(&points) {
        assert_eq!((&a.displacement, &a.multipliers), (&b.displacement, &b.multipliers));
        let cold = solve(&square, modulus, &mut None).unwrap();
        assert!(apart(&cold.displacement, &a.displacement) < 1e-10);
        assert!(apart(cold.multipliers.as_flattened(), a.multipliers.as_flattened()) < 1e-10);
        assert_eq!(cold.status, a.status);
        fast += a.iterations;
        slow += cold.iterations;
    }
    assert!(2 * fast < slow, "{fast} of {slow} steps");
}

proptest! {
    #[test]
    fn whatever_it_starts_from_it_ends_at_the_solution(
        problem in mixed(5, Friction::Tresca),
        modulus in 1e-3..1e3f64,
        junk in prop::collection::vec(-1e3..1e3f64, 40),
    ) {
        let scaled = problem.load.iter().map(|f| f * modulus).collect();
        let mut nodes = problem.nodes.clone();
        scale_bounds(&mut nodes, modulus);
        let count: usize = problem.nodes.iter().map(|n| n.conditions.len()).sum();
        let multipliers: Vec<[f64; 2]> = (0..count).map(|i| [junk[2 * i], junk[2 * i + 1]]).collect();
        let wild = Solution::new(
            &problem, junk[..problem.load.len()].to_vec(), multipliers, steklov_contact::Outcome::Converged, vec![],
        );
        let mut warm = Some(wild);
        let solution = solve_outcome(Problem { load: scaled, nodes, ..problem.clone() }, modulus, &mut warm).unwrap();
        prop_assert!(solution.converged());
        // the state holds the answer in the scale of S: E times less stress, the same displacement
        let kept = warm.unwrap();
        prop_assert!(kkt(&problem, &kept).equilibrium < 1e-10);
        prop_assert_eq!(&kept.displacement, &solution.displacement);
        for (a, b) in kept.multipliers.as_flattened().iter().zip(solution.multipliers.as_flattened()) {
            prop_assert!((a * modulus - b).abs() <= 1e-15 * b.abs());
        }
        let cold = solve_warm(&problem, &mut None).unwrap();
        let size = cold.displacement.iter().fold(0.0f64, |m, v| m.max(v.abs())) + 1.0;
        for (a, b) in cold.displacement.iter().zip(&solution.displacement) {
            prop_assert!((a - b).abs() < 1e-10 * size);
        }
    }

    #[test]
    fn a_start_of_another_problem_does_no_harm(problem in mixed(3, Friction::Tresca), other in mixed(4, Friction::Tresca)) {
        let mut warm = None;
        solve_warm(&other, &mut warm).unwrap();
        let solution = solve_warm(&problem, &mut warm).unwrap();
        prop_assert!(solution.converged() && kkt(&problem, &solution).equilibrium < 1e-10);
    }
}

/// Sums of the normal multipliers and u_x in the middle of 16 contact nodes.
fn observed(square: &Square, solution: &Solution) -> [f64; 2] {
    let force = solution.multipliers.iter().enumerate().map(|(i, l)| weight(square.elements, i) * l[0]).sum();
    [force, solution.displacement[16]]
}

/// Mean of the observed values over cells refined where contact changes.
fn by_cells(square: &Square) -> [f64; 2] {
    let mut mesh = StochasticMesh::uniform(vec![modulus()], &[4], &[3]).unwrap();
    for _ in 0..8 {
        let (mut errors, mut events, mut bases, mut mean) = (vec![], vec![], vec![], [0.0; 2]);
        for cell in 0..mesh.cells.len() {
            let basis = mesh.basis(cell, Nodes::Gauss).unwrap();
            let solutions =
                solve_points(basis.points.len(), |i, warm| solve(square, basis.points[i][0], warm)).unwrap();
            for (w, s) in basis.weights.iter().zip(&solutions) {
                let values = observed(square, s);
                (0..2).for_each(|c| mean[c] += w * values[c]);
            }
            let event = |s: &Solution| -> Vec<f64> {
                let gaps = s.displacement.chunks(2).map(|v| 2e-4 + v[1]);
                s.multipliers.iter().zip(gaps).map(|(l, gap)| l[0] - 1e4 * gap).collect()
            };
            events.push(solutions.iter().map(event).collect::<Vec<_>>());
            let answers: Vec<Vec<f64>> = solutions.iter().map(|s| s.displacement.clone()).collect();
            let kinked = [changes(&basis, 0, &events[cell]).is_some()];
            errors.push(truncation(&basis, &answers, &kinked, &|u| u.iter().map(|u| u * u).sum()));
            bases.push(basis);
        }
        let at = |cell: usize, direction: usize| changes(&bases[cell], direction, &events[cell]);
        if refine(&mut mesh, &errors, 0.9, &at).unwrap().is_empty() || mesh.cells.len() > 40 {
            return mean;
        }
        if errors.iter().flatten().map(|e| e.error).sum::<f64>().sqrt() < 1e-10 {
            return mean;
        }
    }
    panic!("the mesh does not settle");
}

fn monte_carlo(square: &Square, count: usize) -> Accumulator {
    let values = solve_points(count, |i, warm: &mut Option<Solution>| {
        let modulus = sample(&[modulus()], 2014, i as u64)[0];
        solve(square, modulus, warm).map(|s| observed(square, &s))
    });
    let mut sums = Accumulator::default();
    values.unwrap().iter().for_each(|v| sums.push(1.0, v).unwrap());
    sums
}

#[test]
fn samples_agree_with_gauss_points_within_their_confidence() {
    let square = square(15, [0.3, -1.0]);
    let wanted = by_cells(&square);
    let sums = monte_carlo(&square, 25_000);
    let (mean, error) = (sums.moments().mean, sums.standard_errors().mean);
    for c in 0..2 {
        // 99.9 % of a normal variable
        let off = (mean[c] - wanted[c]).abs() / error[c];
        println!("{} for {}: {off} standard errors of {:e}", mean[c], wanted[c], error[c]);
        assert!(off < 3.2905, "{} for {}: {off}", mean[c], wanted[c]);
        assert!(error[c] < 1e-3 * wanted[c].abs());
    }
    let [one, two] = [1, 2].map(|threads| on_threads(threads, || monte_carlo(&square, 1000)));
    assert_eq!(one, two);
}
