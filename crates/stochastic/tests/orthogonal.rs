//! Recurrences and rules against closed forms, moments and orthogonality.

use proptest::prelude::*;
use steklov_quadrature::{Rule, gauss_lobatto};
use steklov_stochastic::{Distribution, Recurrence, StochasticError, Variable};

const INFINITE: f64 = f64::INFINITY;

fn whole(v: &Variable, n: usize) -> Recurrence {
    Recurrence::new(v, v.germ_support(), n).unwrap()
}

#[test]
fn a_discretised_density_gives_the_closed_forms() {
    // a normal variable cut where nothing is left is one by Stieltjes, the whole one by Hermite
    let hermite = whole(&Variable::normal(3.0, 2.0).unwrap(), 24);
    let cut = Variable::new(Distribution::Normal { mean: 3.0, deviation: 2.0 }, -90.0, INFINITE).unwrap();
    let stieltjes = whole(&cut, 24);
    // α and β are those of t = (germ - shift)/scale: compare in germs, of which a deviation has 2
    for k in 0..24 {
        let alpha = |r: &Recurrence| r.shift + r.scale * r.alpha[k];
        let beta = |r: &Recurrence| r.beta[k] * if k == 0 { 1.0 } else { r.scale * r.scale };
        assert!(
            (alpha(&hermite) - alpha(&stieltjes)).abs() < 2e-13,
            "α_{k}: {:e}",
            alpha(&stieltjes) - alpha(&hermite)
        );
        assert!((beta(&stieltjes) / beta(&hermite) - 1.0).abs() < 1e-13, "β_{k}");
        assert_eq!(beta(&hermite), if k == 0 { 1.0 } else { 4.0 * k as f64 });
    }
    // beta variables on a cell that misses next to nothing: low^(α) = 1e-20 of the probability
    for (alpha, beta) in [(2.5, 3.5), (4.0, 2.0), (30.0, 20.0)] {
        let v = Variable::beta(alpha, beta, 0.0, 1.0).unwrap();
        let (closed, cell) = (whole(&v, 16), Recurrence::new(&v, [1e-12, 1.0], 16).unwrap());
        for k in 0..16 {
            let alpha = |r: &Recurrence| r.shift + r.scale * r.alpha[k];
            let beta = |r: &Recurrence| r.beta[k] * if k == 0 { 1.0 } else { r.scale * r.scale };
            assert!((alpha(&closed) - alpha(&cell)).abs() < 1e-13, "α_{k}: {:e}", alpha(&closed) - alpha(&cell));
            assert!(
                (beta(&cell) / beta(&closed) - 1.0).abs() < 1e-13,
                "β_{k}: {:e}",
                beta(&cell) / beta(&closed) - 1.0
            );
        }
    }
    // a flat beta variable is uniform, also on a cell: there one is by Stieltjes, the other by Legendre
    let (flat, uniform) = (Variable::beta(1.0, 1.0, 2.0, 5.0).unwrap(), Variable::uniform(2.0, 5.0).unwrap());
    for cell in [[2.0, 5.0], [2.0, 2.5], [2.25, 4.0], [4.5, 5.0]] {
        let rules = [&flat, &uniform].map(|v| Recurrence::new(v, cell, 12).unwrap().gauss(12).unwrap());
        for i in 0..12 {
            assert!((rules[0].points[i] - rules[1].points[i]).abs() < 3e-15);
            assert!((rules[0].weights[i] / rules[1].weights[i] - 1.0).abs() < 1e-13);
        }
    }
}

#[test]
fn gauss_rules_have_the_moments_of_normal_and_beta_variables() {
    let normal = Variable::normal(0.0, 1.0).unwrap();
    let v = Variable::beta(2.5, 0.5, 0.0, 1.0).unwrap();
    for n in 1..=20 {
        let (hermite, jacobi) = (whole(&normal, n).gauss(n).unwrap(), whole(&v, n).gauss(n).unwrap());
        let (mut even, mut moment) = (1.0, 1.0);
        for k in 0..=2 * n {
            let (a, b) = (hermite.integrate(|x| x.powi(k as i32)), jacobi.integrate(|x| x.powi(k as i32)));
            if k < 2 * n {
                let wanted = if k % 2 == 0 { even } else { 0.0 };
                assert!((a - wanted).abs() < 1e-13 * even, "n {n}: E x^{k} = {a}, not {wanted}");
                assert!((b / moment - 1.0).abs() < 1e-13, "n {n}: E x^{k} = {b}, not {moment}");
            } else if n <= 8 {
                assert!(a < even * (1.0 - 1e-6) && b < moment * (1.0 - 1e-12), "degree {k} must fail for {n} points");
            }
            if k % 2 == 0 {
                even *= (k + 1) as f64; // (k+1)!! to E x^(k+2)
            }
            moment *= (2.5 + k as f64) / (3.0 + k as f64);
        }
    }
}

#[test]
fn lobatto_rules_of_a_uniform_density_are_the_classical_ones() {
    let v = Variable::uniform(-1.0, 1.0).unwrap();
    for n in 2..=20 {
        let (got, wanted) = (whole(&v, n).lobatto(n).unwrap(), gauss_lobatto(n));
        for i in 0..n {
            assert!((got.points[i] - wanted.points[i]).abs() < 5e-16, "{n}");
            assert!((2.0 * got.weights[i] - wanted.weights[i]).abs() < 3e-15, "{n}");
        }
    }
}

#[test]
fn refused_are_too_many_points_empty_intervals_and_infinite_ends() {
    let v = Variable::normal(0.0, 1.0).unwrap();
    let r = whole(&v, 3);
    assert!(r.gauss(3).is_ok() && r.gauss(4).is_err() && r.gauss(0).is_err());
    assert!(matches!(r.lobatto(3), Err(StochasticError::Number { value, .. }) if value == -INFINITE));
    let finite = Recurrence::new(&v, [0.0, 1.0], 3).unwrap();
    assert!(finite.lobatto(4).is_ok() && finite.lobatto(5).is_err() && finite.lobatto(1).is_err());
    for empty in [[1.0, 1.0], [2.0, 1.0], [f64::NAN, 1.0], [50.0, 51.0]] {
        assert!(matches!(Recurrence::new(&v, empty, 3), Err(StochasticError::NoProbability { .. })), "{empty:?}");
    }
    assert!(Recurrence::new(&v, [0.0, 1.0], 0).is_err() && Recurrence::new(&v, [0.0, 1.0], 257).is_err());
}

/// Variables and a cell of each.
fn cells() -> impl Strategy<Value = (Variable, [f64; 2])> {
    let law = prop_oneof![
        Just(Variable::uniform(1800.0, 2200.0).unwrap()),
        Just(Variable::normal(200e9, 1e9).unwrap()),
        Just(Variable::lognormal(200e9, 60e9).unwrap()),
        Just(Variable::new(Distribution::Normal { mean: 0.0, deviation: 1.0 }, 3.0, INFINITE).unwrap()),
        Just(Variable::new(Distribution::Normal { mean: 0.0, deviation: 1.0 }, -1e6, 1e7).unwrap()),
        (0.1..40.0f64, 0.1..40.0f64).prop_map(|(a, b)| Variable::beta(a, b, -1.0, 3.0).unwrap()),
    ];
    let share = prop_oneof![Just((0.0, 1.0)), Just((0.0, 0.5)), Just((0.75, 1.0)), (0.0..0.5f64, 0.6..1.0f64)];
    (law, share).prop_map(|(v, (p, q))| {
        let cell = [v.quantile(p), v.quantile(q)];
        (v, cell)
    })
}

fn orthogonality(r: &Recurrence, rule: &Rule, n: usize) -> f64 {
    let mut worst = 0.0f64;
    let mut values = vec![0.0; n];
    let mut gram = vec![0.0; n * n];
    for (&x, w) in rule.points.iter().zip(&rule.weights) {
        r.evaluate(x, &mut values);
        for i in 0..n * n {
            gram[i] += w * values[i / n] * values[i % n];
        }
    }
    for i in 0..n * n {
        worst = worst.max((gram[i] - if i / n == i % n { 1.0 } else { 0.0 }).abs());
    }
    worst
}

proptest! {
    #[test]
    fn rules_of_any_cell_are_positive_inside_and_orthogonalise((v, cell) in cells(), n in 2usize..12) {
        let r = Recurrence::new(&v, cell, n).unwrap();
        let gauss = r.gauss(n).unwrap();
        let sum: f64 = gauss.weights.iter().sum();
        prop_assert!((sum - 1.0).abs() < 1e-13 && gauss.weights.iter().all(|&w| w > 0.0));
        prop_assert!(gauss.points.windows(2).all(|x| x[0] < x[1]));
        prop_assert!(cell[0] < gauss.points[0] && gauss.points[n - 1] < cell[1]);
        // germs of 2e11 ± 1e9 have lost two digits to their mean
        let digits = 1.0 + r.shift.abs() / r.scale;
        prop_assert!(orthogonality(&r, &gauss, n) < 1e-13 * digits, "{:e}", orthogonality(&r, &gauss, n));
        if cell.iter().all(|x| x.is_finite()) {
            let lobatto = r.lobatto(n).unwrap();
            prop_assert_eq!([lobatto.points[0], lobatto.points[n - 1]], cell);
            prop_assert!(lobatto.weights.iter().all(|&w| w > 0.0));
            prop_assert!(orthogonality(&r, &lobatto, n - 1) < 1e-13 * digits);
            // the top polynomial is one degree too high for it
            prop_assert!(orthogonality(&r, &lobatto, n) > 1e-6);
        }
    }

    #[test]
    fn the_first_moments_of_a_cell_are_integrals_of_its_density((v, cell) in cells()) {
        let r = Recurrence::new(&v, cell, 4).unwrap();
        let probability = v.probability(cell);
        prop_assert_eq!(r.probability, probability);
        // halves of the cell, each with its own rule, make up the rule of the cell
        let middle = r.gauss(1).unwrap().points[0];
        let halves = [[cell[0], middle], [middle, cell[1]]].map(|c| Recurrence::new(&v, c, 4).unwrap());
        let share = halves[0].probability + halves[1].probability;
        prop_assert!((share / probability - 1.0).abs() < 1e-13);
        let whole = r.gauss(4).unwrap();
        let digits = 1.0 + r.shift.abs() / r.scale;
        for k in 0..=7 {
            let power = |x: f64| ((x - r.shift) / r.scale).powi(k);
            let parts: f64 = halves.iter().map(|h| h.probability * h.gauss(4).unwrap().integrate(power)).sum();
            let size = probability * whole.integrate(|x| power(x).abs()).max(1e-3);
            prop_assert!((parts - probability * whole.integrate(power)).abs() < 1e-12 * digits * size, "{k}");
        }
    }
}
