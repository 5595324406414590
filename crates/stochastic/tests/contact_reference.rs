//! Contact of a square with a random modulus against reference values, and scalings that hold exactly.

use crate::square::{Square, solve_outcome, square, weight};
use steklov_contact::{Problem, Solution, Status};
use steklov_quadrature::gauss_legendre;

const TRACTION: [f64; 2] = [0.3, -1.0];
const BOUND: f64 = 0.35;

fn solve(square: &Square, modulus: f64, gap: f64, bound: f64) -> Solution {
    let nodes = square.nodes(gap, bound);
    let problem = Problem { stiffness: square.stiffness.clone().into(), load: square.load.clone(), nodes };
    let solution = solve_outcome(problem, modulus, &mut None).unwrap();
    assert!(solution.converged());
    solution
}

/// Resultant of the multipliers of a component.
fn force(square: &Square, solution: &Solution, component: usize) -> f64 {
    solution.multipliers.iter().enumerate().map(|(i, l)| weight(square.elements, i) * l[component]).sum()
}

fn touching(solution: &Solution) -> usize {
    solution.multipliers.iter().filter(|l| l[0] > 0.0).count()
}

fn near(value: f64, wanted: f64, what: &str) {
    assert!((value / wanted - 1.0).abs() < 1e-8, "{what}: {value} for {wanted}");
}

#[test]
fn without_a_gap_it_has_the_reference_forces() {
    let square = square(16, TRACTION);
    let solution = solve(&square, 2000.0, 0.0, BOUND);
    near(force(&square, &solution, 0), 1.010394075, "normal force");
    near(force(&square, &solution, 1), 0.2841344178, "friction force");
    assert_eq!(touching(&solution), 17);
    let slips = |s: &Status| matches!(s, Status::SlipPlus | Status::SlipMinus);
    assert_eq!(solution.status.iter().filter(|s| slips(s)).count(), 11);
    let ux = solution.displacement[16];
    near(ux, 1.556892202e-5, "u_x in the middle");
    // u is proportional to 1/E: the mean over E uniform in [1800, 2200]
    near(ux * 2000.0 * (2200f64 / 1800.0).ln() / 400.0, 1.562113204e-5, "mean of u_x");
}

#[test]
fn above_a_gap_it_has_the_reference_values_at_gauss_points_and_on_average() {
    let square = square(16, TRACTION);
    let forces = [0.608719319, 0.5982398276, 0.5823062854, 0.5643122625, 0.5490868865, 0.5394170708];
    let contacts = [11, 10, 10, 10, 9, 9];
    let rule = gauss_legendre(6);
    let mut means = [0.0; 3];
    for j in 0..6 {
        let solution = solve(&square, 2000.0 + 200.0 * rule.points[j], 2e-4, BOUND);
        let normal = force(&square, &solution, 0);
        near(normal, forces[j], "force of a node");
        assert_eq!(touching(&solution), contacts[j]);
        let values = [normal, solution.displacement[16], solution.displacement[17]];
        means.iter_mut().zip(values).for_each(|(mean, value)| *mean += 0.5 * rule.weights[j] * value);
    }
    near(means[0], 0.5735670353, "mean force");
    near(means[1], 3.737766613e-5, "mean of u_x");
    near(means[2], -0.0001747779203, "mean of u_y");
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |m, v| m.max(v.abs()))
}

/// Largest difference of a u - b v over the largest of a u.
fn apart(a: f64, u: &[f64], b: f64, v: &[f64]) -> f64 {
    largest(u.iter().zip(v).map(|(u, v)| a * u - b * v)) / largest(u.iter().map(|u| a * u))
}

#[test]
fn without_a_gap_multipliers_do_not_depend_on_the_modulus_and_displacements_go_with_its_inverse() {
    let square = square(16, TRACTION);
    let nominal = solve(&square, 2000.0, 0.0, BOUND);
    for modulus in [1800.0, 2200.0, 1e-3, 7e9] {
        let other = solve(&square, modulus, 0.0, BOUND);
        let lambda = apart(1.0, nominal.multipliers.as_flattened(), 1.0, other.multipliers.as_flattened());
        let u = apart(2000.0, &nominal.displacement, modulus, &other.displacement);
        assert!(lambda < 1e-12 && u < 1e-12, "E = {modulus}: {lambda:e}, {u:e}");
    }
    // with a gap neither holds
    let [a, b] = [1800.0, 2200.0].map(|e| solve(&square, e, 2e-4, BOUND));
    assert!(apart(1.0, a.multipliers.as_flattened(), 1.0, b.multipliers.as_flattened()) > 1e-2);
    assert!(apart(1800.0, &a.displacement, 2200.0, &b.displacement) > 1e-2);
}

#[test]
fn without_load_displacements_do_not_depend_on_the_modulus_and_multipliers_go_with_it() {
    let square = square(16, [0.0, 0.0]);
    let nominal = solve(&square, 2000.0, -1e-3, 0.0);
    assert!(force(&square, &nominal, 0) > 0.1);
    for modulus in [1800.0, 2200.0, 1e-3, 7e9] {
        let other = solve(&square, modulus, -1e-3, 0.0);
        let u = apart(1.0, &nominal.displacement, 1.0, &other.displacement);
        let (a, b) = (nominal.multipliers.as_flattened(), other.multipliers.as_flattened());
        let lambda = apart(1.0 / 2000.0, a, 1.0 / modulus, b);
        assert!(lambda < 1e-12 && u < 1e-12, "E = {modulus}: {lambda:e}, {u:e}");
    }
}
