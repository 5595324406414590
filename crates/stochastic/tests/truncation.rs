//! Estimates of the truncation of polynomials in germs, and refinement by them.

use steklov_stochastic::{CellBasis, DirectionError, Nodes, StochasticMesh, Variable, changes, refine, truncation};

fn square(u: &[f64]) -> f64 {
    u.iter().map(|u| u * u).sum()
}

fn one_germ(degree: usize) -> CellBasis {
    let mesh = StochasticMesh::uniform(vec![Variable::uniform(-1.0, 1.0).unwrap()], &[1], &[degree]).unwrap();
    mesh.basis(0, Nodes::Gauss).unwrap()
}

fn at_nodes(basis: &CellBasis, u: &dyn Fn(f64) -> f64) -> Vec<Vec<f64>> {
    basis.points.iter().map(|p| vec![u(p[0])]).collect()
}

/// Estimate and truth of the error of interpolation at the Gauss points.
fn judged(degree: usize, u: &dyn Fn(f64) -> f64) -> (DirectionError, f64) {
    judged_with(degree, u, false)
}

fn judged_with(degree: usize, u: &dyn Fn(f64) -> f64, kinked: bool) -> (DirectionError, f64) {
    let basis = one_germ(degree);
    let answers = at_nodes(&basis, u);
    let estimate = truncation(&basis, &answers, &[kinked], &square)[0];
    // panels, so that a kink costs little
    let mesh = StochasticMesh::uniform(vec![Variable::uniform(-1.0, 1.0).unwrap()], &[64], &[15]).unwrap();
    let mut theta = vec![0.0; degree + 1];
    let mut truth = 0.0;
    for cell in 0..64 {
        let fine = mesh.basis(cell, Nodes::Gauss).unwrap();
        for (point, weight) in fine.points.iter().zip(&fine.weights) {
            basis.evaluate(point, &mut theta);
            let value: f64 = theta.iter().zip(&answers).map(|(t, a)| t * a[0]).sum();
            truth += weight * (value - u(point[0])).powi(2);
        }
    }
    (estimate, truth.sqrt())
}

#[test]
fn it_is_the_error_of_a_random_modulus_and_falls_by_the_rate_of_its_ellipse() {
    for (d, last) in [(0.1, 9), (0.5, 13)] {
        let u = |y: f64| 1.0 / (1.0 + d * y);
        let rate = (1.0 + (1.0f64 - d * d).sqrt()) / d;
        let mean = ((1.0 + d) / (1.0 - d)).ln() / (2.0 * d);
        let means: Vec<f64> = (0..=last)
            .map(|q| {
                let basis = one_germ(q);
                (basis.weights.iter().zip(&basis.points).map(|(w, p)| w * u(p[0])).sum::<f64>() / mean - 1.0).abs()
            })
            .collect();
        let mut before = f64::NAN;
        for degree in 1..=last {
            let (estimate, truth) = judged(degree, &u);
            let share = estimate.error.sqrt() / truth;
            // of degree 1 no decay is known
            let wanted = if degree > 1 { 0.9..1.35 } else { 1.0..20.0 };
            assert!(wanted.contains(&share), "d = {d}, degree {degree}: {share}");
            assert!(degree < 2 || (estimate.decay * rate - 1.0).abs() < 0.2, "{} for {}", estimate.decay, 1.0 / rate);
            assert!(!estimate.is_rough(degree));
            // Legendre coefficients fall like √k ϱ^-k
            if degree > 2 {
                assert!((0.9..1.1).contains(&(before / truth / rate)), "{} for {rate}", before / truth);
            }
            before = truth;
            // down to the roundoff of a mean
            if means[degree] > 1e-13 {
                let fall = means[degree - 1] / means[degree] / (rate * rate);
                assert!((0.9..1.1).contains(&fall), "d = {d}, degree {degree}: {fall}");
            }
        }
        assert!(means[last] < 1e-13);
    }
}

#[test]
fn even_and_odd_answers_do_not_hide_and_kinks_are_rough() {
    let even = |y: f64| 1.0 / (1.0 + 0.2 * y * y);
    let odd = |y: f64| y / (1.0 + 0.2 * y * y);
    for degree in 4..12 {
        for u in [&even as &dyn Fn(f64) -> f64, &odd] {
            let (estimate, truth) = judged(degree, u);
            assert!((0.7..2.0).contains(&(estimate.error.sqrt() / truth)), "{degree}: {estimate:?} {truth:e}");
            assert!(!estimate.is_rough(degree));
        }
    }
    for (degree, kink) in (2..15).flat_map(|q| [0.0, 0.3].map(|kink| (q, kink))) {
        let kinked = |y: f64| (y - kink).abs();
        let (estimate, truth) = judged_with(degree, &kinked, true);
        assert!((0.35..4.5).contains(&(estimate.error.sqrt() / truth)), "{degree}: {estimate:?} {truth:e}");
        // a linear part that hides it
        let (estimate, truth) = judged_with(degree, &|y| 3.0 + y + 0.01 * kinked(y), true);
        assert!((0.35..6.0).contains(&(estimate.error.sqrt() / truth)), "{degree}: {estimate:?} {truth:e}");
        let (estimate, truth) = judged(degree, &kinked);
        assert!((0.1..4.5).contains(&(estimate.error.sqrt() / truth)), "{degree}: {estimate:?} {truth:e}");
        // of the coefficients of degree 2 and less one may be small by chance
        assert!(degree < 3 || estimate.is_rough(degree), "{degree}: {estimate:?}");
    }
    // a constant has no error, a polynomial none beyond its pair of degrees
    let constant = |degree: usize| judged(degree, &|_| 3.0).0.error;
    assert!((1..9).all(|q| constant(q) < 1e-28));
    assert!(judged(5, &|y| 1.0 + y * y * y).0.error < 1e-28);
    assert!(judged(3, &|y| 1.0 + y * y * y).0.error > 1e-3);
}

#[test]
fn a_large_fixed_part_is_no_decay() {
    for (degree, fixed) in (1..10).flat_map(|q| [0.0, 1e3].map(|fixed| (q, fixed))) {
        for kinked in [false, true] {
            let (estimate, truth) = judged_with(degree, &|y: f64| fixed + 1.0 / (1.0 + 0.3 * y), kinked);
            let share = estimate.error.sqrt() / truth;
            let most = match degree {
                // as if the kink were what is seen
                _ if kinked => 100.0,
                1 => 6.0,
                _ => 1.4,
            };
            assert!((0.9..most).contains(&share), "degree {degree}, {fixed}, {kinked}: {share}");
        }
    }
}

#[test]
fn it_is_the_error_of_a_lognormal_modulus() {
    // 1/E = exp(-s x) of a standard normal x has the coefficients exp(s²/2) (-s)^k/(k!)^½
    for deviation in [0.1f64, 0.5] {
        let variance = (1.0 + deviation * deviation).ln();
        let mesh =
            |degree| StochasticMesh::uniform(vec![Variable::normal(0.0, 1.0).unwrap()], &[1], &[degree]).unwrap();
        for degree in 2..8 {
            let basis = mesh(degree).basis(0, Nodes::Gauss).unwrap();
            let answers = at_nodes(&basis, &|x| (-variance.sqrt() * x).exp());
            let estimate = truncation(&basis, &answers, &[false], &square)[0];
            let mut term = variance.exp();
            let rest: f64 = (1..40)
                .map(|k| {
                    term *= variance / k as f64;
                    if k > degree { term } else { 0.0 }
                })
                .sum();
            let share = (estimate.error / rest).sqrt();
            assert!((0.9..3.0).contains(&share), "deviation {deviation}, degree {degree}: {share}");
            assert!(deviation > 0.2 || !estimate.is_rough(degree));
        }
    }
}

#[test]
fn estimates_add_up_over_cells_directions_and_components() {
    // u = (f(x), 2 g(y)): each direction has its own error, whatever the other does
    let variables = vec![Variable::uniform(-1.0, 1.0).unwrap(), Variable::uniform(0.0, 3.0).unwrap()];
    let mesh = StochasticMesh::uniform(variables, &[1, 1], &[4, 2]).unwrap();
    let basis = mesh.basis(0, Nodes::Gauss).unwrap();
    let g = |y: f64| 1.0 / (2.0 + y);
    let answers: Vec<Vec<f64>> = basis.points.iter().map(|p| vec![1.0 / (1.0 + 0.3 * p[0]), 2.0 * g(p[1])]).collect();
    let both = truncation(&basis, &answers, &[false; 2], &square);
    let first = truncation(&basis, &answers.iter().map(|u| vec![u[0], 0.0]).collect::<Vec<_>>(), &[false; 2], &square);
    assert!((both[0].error / first[0].error - 1.0).abs() < 1e-10 && first[1].error < 1e-28);
    // a cell of half the probability has half the error of the same answers
    let mesh = StochasticMesh::uniform(vec![Variable::uniform(-1.0, 1.0).unwrap()], &[2], &[4]).unwrap();
    let half = mesh.basis(1, Nodes::Gauss).unwrap();
    let on_half =
        truncation(&half, &at_nodes(&half, &|y| 1.0 / (1.0 + 0.3 * (2.0 * y - 1.0))), &[false], &square)[0].error;
    let (whole, _) = judged(4, &|y| 1.0 / (1.0 + 0.3 * y));
    assert!((2.0 * on_half / whole.error - 1.0).abs() < 1e-10);
}

#[test]
fn changes_are_found_between_nodes() {
    let basis = one_germ(5);
    let events = |f: &dyn Fn(f64) -> f64| -> Vec<Vec<f64>> { basis.points.iter().map(|p| vec![f(p[0])]).collect() };
    // smooth on one side: exact from there
    let kinked = |y: f64| if y < 0.3 { (y - 0.3) * (y + 2.0) } else { (3.0 * (y - 0.3)).sin() };
    let found = changes(&basis, 0, &events(&kinked)).unwrap();
    assert!((found - 0.3).abs() < 1e-14, "{found}");
    // with a single node on the side that is beyond, and values of the other that do not lead there
    let found = changes(&basis, 0, &events(&|y| if y < 0.9 { 1.0 } else { -1.0 })).unwrap();
    assert!((basis.points[4][0]..basis.points[5][0]).contains(&found));
    assert_eq!(changes(&basis, 0, &events(&|y| y + 2.0)), None);
    // the median of three
    let three: Vec<Vec<f64>> = basis.points.iter().map(|p| [-0.5, 0.1, 0.8].map(|at| p[0] - at).to_vec()).collect();
    assert!((changes(&basis, 0, &three).unwrap() - 0.1).abs() < 1e-14);
}

/// What refinement reached.
struct Reached {
    mesh: StochasticMesh,
    cells: Vec<(CellBasis, Vec<Vec<f64>>)>,
    solves: usize,
    rounds: usize,
}

impl Reached {
    fn mean(&self, component: usize) -> f64 {
        let pairs = self.cells.iter().flat_map(|(basis, answers)| basis.weights.iter().zip(answers));
        pairs.map(|(w, u)| w * u[component]).sum()
    }
}

/// Refines until the estimate is `tolerance` of the size of the answers' first component; `solve` gives answers and events.
fn refined(mut mesh: StochasticMesh, tolerance: f64, solve: impl Fn(&[f64]) -> (Vec<f64>, Vec<f64>)) -> Reached {
    let energy = |u: &[f64]| u[0] * u[0];
    let mut solves = 0;
    for rounds in 0..60 {
        let (mut cells, mut errors, mut events) = (Vec::new(), Vec::new(), Vec::new());
        for cell in 0..mesh.cells.len() {
            let basis = mesh.basis(cell, Nodes::Gauss).unwrap();
            let (answers, own): (Vec<_>, Vec<_>) = basis.points.iter().map(|p| solve(p)).unzip();
            let kinked: Vec<bool> = (0..mesh.variables.len()).map(|d| changes(&basis, d, &own).is_some()).collect();
            errors.push(truncation(&basis, &answers, &kinked, &energy));
            events.push(own);
            cells.push((basis, answers));
        }
        if rounds == 0 {
            solves += cells.iter().map(|c| c.1.len()).sum::<usize>();
        }
        let size: f64 = cells.iter().flat_map(|(b, a)| b.weights.iter().zip(a)).map(|(w, u)| w * energy(u)).sum();
        let error: f64 = errors.iter().flatten().map(|e| e.error).sum();
        if error <= tolerance * tolerance * size {
            return Reached { mesh, cells, solves, rounds };
        }
        let at = |cell: usize, direction: usize| changes(&cells[cell].0, direction, &events[cell]);
        let changed = refine(&mut mesh, &errors, 0.7, &at).unwrap();
        solves += changed.iter().map(|&c| mesh.cells[c].degree.iter().map(|q| q + 1).product::<usize>()).sum::<usize>();
    }
    panic!("60 rounds do not do");
}

const LOAD: f64 = 200.0;
const GAP: f64 = 0.104;

/// u = min(u1/E, g) and λ = max(0, u1 - E g), E from 1800 to 2200; the event is that of the app.
fn spring(modulus: f64) -> (Vec<f64>, Vec<f64>) {
    let (u, lambda) = ((LOAD / modulus).min(GAP), (LOAD - modulus * GAP).max(0.0));
    (vec![u, lambda], vec![lambda - 2000.0 * (GAP - u)])
}

fn means() -> [f64; 2] {
    let kink = LOAD / GAP;
    let u = (GAP * (kink - 1800.0) + LOAD * (2200.0 / kink).ln()) / 400.0;
    [u, (LOAD * (kink - 1800.0) - GAP * (kink * kink - 1800.0 * 1800.0) / 2.0) / 400.0]
}

#[test]
fn a_kink_stalls_the_degree_and_not_the_mesh() {
    let wanted = means();
    assert!((wanted[0] / 0.09926544648 - 1.0).abs() < 1e-9 && (wanted[1] / 1.969230769 - 1.0).abs() < 1e-9);
    let mesh = |elements: usize, degree: usize| {
        StochasticMesh::uniform(vec![Variable::uniform(1800.0, 2200.0).unwrap()], &[elements], &[degree]).unwrap()
    };
    // reference values of uniform meshes
    let table = [
        (1, 1, 5.411317766e-5, 0.01788110916),
        (1, 3, 0.001276664176, 0.1245794019),
        (1, 7, 0.0002586733189, 0.02516266012),
        (1, 15, 6.667597342e-5, 0.006478934384),
        (2, 3, 6.893561332e-5, 0.007076598136),
        (32, 3, 6.05980543e-7, 5.874655742e-5),
    ];
    for (elements, degree, u, lambda) in table {
        let mesh = mesh(elements, degree);
        let mut sums = [0.0; 2];
        for cell in 0..elements {
            let basis = mesh.basis(cell, Nodes::Gauss).unwrap();
            for (w, p) in basis.weights.iter().zip(&basis.points) {
                let (values, _) = spring(p[0]);
                (0..2).for_each(|c| sums[c] += w * values[c]);
            }
        }
        for (sum, (wanted, error)) in sums.into_iter().zip(wanted.into_iter().zip([u, lambda])) {
            assert!(((sum / wanted - 1.0).abs() / error - 1.0).abs() < 1e-6, "{elements} elements, degree {degree}");
        }
    }
    for degree in 0..12 {
        let reached = refined(mesh(1, degree), 1e-9, |p| spring(p[0]));
        let errors = [0, 1].map(|c| (reached.mean(c) / wanted[c] - 1.0).abs());
        println!(
            "degree {degree}: {} solves, {} cells, {} rounds, errors {errors:?}",
            reached.solves,
            reached.mesh.cells.len(),
            reached.rounds
        );
        // λ is the small rest of the load u1 = 200 and E g
        assert!(errors[0] < 1e-8 && errors[1] * wanted[1] < 1e-8 * LOAD, "degree {degree}: {errors:?}");
        assert!(degree < 7 || errors[1] < 1e-8, "degree {degree}: {errors:?}");
        assert!(reached.mesh.cells.len() == 2 && reached.solves < 50);
    }
}

#[test]
fn a_kink_along_a_line_of_two_germs_is_reached_by_cells() {
    let variables = vec![Variable::uniform(1800.0, 2200.0).unwrap(), Variable::uniform(180.0, 220.0).unwrap()];
    let mesh = StochasticMesh::uniform(variables, &[1, 1], &[3, 3]).unwrap();
    let spring = |p: &[f64]| {
        let (u, lambda) = ((p[1] / p[0]).min(GAP), (p[1] - p[0] * GAP).max(0.0));
        (vec![u, lambda], vec![lambda - 2000.0 * (GAP - u)])
    };
    // E(λ) = ∫∫_(t > E g) (t - E g): of t' = t - 187.2 - g (E - 1800), the inner integral is a square
    let cubes = |a: f64| (220.0 - a * GAP).powi(3);
    let lambda = (cubes(1800.0) - cubes(2200.0f64.min(220.0 / GAP))) / (6.0 * GAP * 400.0 * 40.0);
    for tolerance in [1e-3, 1e-4, 1e-5] {
        let reached = refined(mesh.clone(), tolerance, spring);
        let error = (reached.mean(1) / lambda - 1.0).abs();
        println!("{tolerance:e}: {} solves, {} cells, error of λ {error:e}", reached.solves, reached.mesh.cells.len());
        assert!(error * lambda < tolerance * LOAD);
        // cells of a tenth of the width where there is no kink would need a hundred times those along it
        assert!(tolerance > 5e-4 || reached.mesh.cells.len() > 8);
    }
}

#[test]
fn smooth_answers_are_refined_by_degree_in_the_germ_that_matters() {
    let variables = vec![Variable::uniform(-1.0, 1.0).unwrap(), Variable::normal(0.0, 1.0).unwrap()];
    let mesh = StochasticMesh::uniform(variables, &[1, 1], &[0, 0]).unwrap();
    let solve = |p: &[f64]| (vec![(0.01 * p[1]).exp() / (1.0 + 0.4 * p[0])], vec![1.0]);
    let reached = refined(mesh, 1e-8, solve);
    assert_eq!(reached.mesh.cells.len(), 1);
    let mean = (1.4f64 / 0.6).ln() / 0.8 * 0.5e-4f64.exp();
    assert!((reached.mean(0) / mean - 1.0).abs() < 1e-9, "{:e}", reached.mean(0) / mean - 1.0);
    let degree = &reached.mesh.cells[0].degree;
    assert!((9..=13).contains(&degree[0]) && (2..=4).contains(&degree[1]), "{degree:?}");
    // nothing random: nothing to do after the degrees of nothing known
    let reached = refined(reached.mesh, 1e-8, |_| (vec![1.0], vec![1.0]));
    assert_eq!(reached.rounds, 0);
}
