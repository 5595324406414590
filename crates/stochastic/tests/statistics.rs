//! Statistics against closed forms: 1/E and a point that comes into contact, for a modulus E uniform on [1800, 2200].

use proptest::prelude::*;
use steklov_stochastic::{
    Accumulator, Nodes, StochasticError, StochasticMesh, Variable, density, moments, quantiles, sample, uniform,
};

fn modulus() -> Variable {
    Variable::uniform(1800.0, 2200.0).unwrap()
}

/// Germs and weights of all nodes.
fn nodes(mesh: &StochasticMesh) -> (Vec<f64>, Vec<f64>) {
    let bases: Vec<_> = (0..mesh.cells.len()).map(|c| mesh.basis(c, Nodes::Gauss).unwrap()).collect();
    let points = bases.iter().flat_map(|b| b.points.iter().map(|p| p[0])).collect();
    (points, bases.iter().flat_map(|b| b.weights.clone()).collect())
}

fn equal(elements: usize, degree: usize) -> StochasticMesh {
    StochasticMesh::uniform(vec![modulus()], &[elements], &[degree]).unwrap()
}

#[track_caller]
fn digits(got: f64, wanted: f64) {
    assert!((got / wanted - 1.0).abs() < 6e-10, "{got:e}, wanted {wanted:e}");
}

#[test]
fn mean_and_variance_of_a_linear_answer_converge_as_the_ellipse_says() {
    let mean = (2200f64 / 1800.0).ln() / 400.0;
    let variance = 1.0 / (1800.0 * 2200.0) - mean * mean;
    assert!((mean - 5.016767386553781e-4).abs() < 1e-18);
    let reference = [
        (3.342269087e-3, 1.0),
        (8.965639337e-6, 8.023657704e-3),
        (2.317535874e-8, 3.456033643e-5),
        (5.916034329e-11, 1.23496615e-7),
        (1.506572644e-13, 4.026950995e-10),
    ];
    let mut errors = vec![];
    for (q, (of_mean, of_variance)) in reference.into_iter().enumerate() {
        let (points, weights) = nodes(&equal(1, q));
        let answers: Vec<Vec<f64>> = points.iter().map(|e| vec![1.0 / e]).collect();
        let m = moments(&weights, &answers).unwrap();
        let error = (m.mean[0] / mean - 1.0).abs();
        // rounded sums are right to 1e-15
        assert!((error - of_mean).abs() < 1e-9 * of_mean + 2e-15, "q {q}: {error:e}");
        let spread = (m.variance[0] / variance - 1.0).abs();
        // the reference is a difference of squares: 1e-16 mean²/variance = 4e-14
        assert!((spread - of_variance).abs() < 1e-9 * of_variance + 1e-12, "q {q}: {spread:e}");
        errors.push(error);
    }
    // ϱ² of the ellipse through the pole E = 0: z = -10, ϱ = 10 + √99
    let rho = 10.0 + 99f64.sqrt();
    for pair in errors[..4].windows(2) {
        let factor = pair[0] / pair[1] / (rho * rho);
        assert!((0.9..1.1).contains(&factor), "{factor}");
    }
}

/// u = min(u1/E, g), λ = max(0, u1 - E g) and whether they touch.
fn contact(e: f64) -> [f64; 3] {
    let (load, gap) = (200.0, 0.104);
    let touch = load - e * gap > 0.0;
    [(load / e).min(gap), (load - e * gap).max(0.0), if touch { 1.0 } else { 0.0 }]
}

const EDGE: f64 = 200.0 / 0.104;
/// Mean of u, mean of λ, probability of contact.
fn exact() -> [f64; 3] {
    let (load, gap, low) = (200.0, 0.104, EDGE - 1800.0);
    let u = (gap * low + load * (2200.0 / EDGE).ln()) / 400.0;
    let lambda = (load * low - 0.5 * gap * (EDGE * EDGE - 1800.0 * 1800.0)) / 400.0;
    [u, lambda, 4.0 / 13.0]
}

#[test]
fn the_kink_of_contact_costs_what_it_costs_and_nothing_on_cells_that_end_there() {
    let wanted = exact();
    digits(wanted[0], 0.09926544648);
    digits(wanted[1], 1.969230769);
    let errors = |mesh: &StochasticMesh| {
        let (points, weights) = nodes(mesh);
        let answers: Vec<Vec<f64>> = points.iter().map(|&e| contact(e).to_vec()).collect();
        let m = moments(&weights, &answers).unwrap().mean;
        [(m[0] / wanted[0] - 1.0).abs(), (m[1] / wanted[1] - 1.0).abs(), (m[2] - wanted[2]).abs()]
    };
    let table = [
        (1, 1, [5.411317766e-5, 0.01788110916, 0.1923076923]),
        (1, 3, [0.001276664176, 0.1245794019, 0.1337648851]),
        (1, 7, [0.0002586733189, 0.02516266012, 0.01096580062]),
        (1, 15, [6.667597342e-5, 0.006478934384, 0.006280679558]),
        (2, 3, [6.893561332e-5, 0.007076598136, 0.05769230769]),
        (4, 3, [1.983397623e-5, 0.00189303353, 0.01421045205]),
        (8, 3, [1.5550664e-5, 0.001510837616, 0.004807692308]),
        (16, 3, [1.407806358e-6, 0.0001366233862, 0.006062771603]),
        (32, 3, [6.05980543e-7, 5.874655742e-5, 0.0006275396476]),
    ];
    for (elements, q, reference) in table {
        let got = errors(&equal(elements, q));
        for (g, r) in got.iter().zip(reference) {
            assert!((g / r - 1.0).abs() < 6e-10 + 1e-15 / r, "{elements} elements, q {q}: {g:e}, not {r:e}");
        }
    }
    let mut aligned = equal(1, 3);
    aligned.split(0, 0, EDGE).unwrap();
    let got = errors(&aligned);
    assert!((got[0] - 1.642241898e-12).abs() < 1e-15 && got[1] < 1e-14 && got[2] < 1e-15, "{got:?}");
    // the variance too; at q = 3 the square of 1/E is right to 3e-9 only
    let mut finer = equal(1, 7);
    finer.split(0, 0, EDGE).unwrap();
    let (points, weights) = nodes(&finer);
    let answers: Vec<Vec<f64>> = points.iter().map(|&e| contact(e).to_vec()).collect();
    digits(moments(&weights, &answers).unwrap().variance[0], 1.982568082e-5);
}

#[test]
fn three_random_inputs_by_samples_agree_within_their_errors() {
    // E = 2000 + 200 a, load 200 (1 + 0.1 b), gap 0.104 (1 + 0.02 c); the mean over E is in closed form, the rest on
    // cells that end at the kinks
    let v = Variable::uniform(-1.0, 1.0).unwrap();
    let variables = [v.clone(), v.clone(), v];
    let rule = steklov_quadrature::gauss_legendre(30);
    let mean = |f: &dyn Fn(f64) -> f64, kink: f64| {
        0.5 * (rule.mapped(-1.0, kink).integrate(f) + rule.mapped(kink, 1.0).integrate(f))
    };
    let over_e = |load: f64, gap: f64| {
        let edge = (load / gap).clamp(1800.0, 2200.0);
        let u = (gap * (edge - 1800.0) + load * (2200.0 / edge).ln()) / 400.0;
        (u, (edge - 1800.0) / 400.0)
    };
    let load = |b: f64| 200.0 * (1.0 + 0.1 * b);
    // two kinks in b, E = 1800 and E = 2200; the second one is outside of all loads
    let over_b = |gap: f64, part: &dyn Fn((f64, f64)) -> f64| {
        assert!(2200.0 * gap > load(1.0));
        mean(&|b| part(over_e(load(b), gap)), (1800.0 * gap / 200.0 - 1.0) / 0.1)
    };
    let total = |part: &dyn Fn((f64, f64)) -> f64| mean(&|c| over_b(0.104 * (1.0 + 0.02 * c), part), 0.0);
    let wanted = [total(&|x| x.0), total(&|x| x.1)];

    let n = 40_000;
    let answer = |i: u64| {
        let x = sample(&variables, 2014, i);
        let (e, load, gap) = (2000.0 + 200.0 * x[0], load(x[1]), 0.104 * (1.0 + 0.02 * x[2]));
        ((load / e).min(gap), load / e > gap)
    };
    let mut all = Accumulator::default();
    (0..n).for_each(|i| all.push(1.0, &[answer(i).0]).unwrap());
    let error = all.standard_errors().mean[0];
    assert!(error > 0.0 && error < 1e-4);
    assert!((all.moments().mean[0] - wanted[0]).abs() < 4.0 * error, "{:e}", all.moments().mean[0] - wanted[0]);
    let p = (0..n).filter(|&i| answer(i).1).count() as f64 / n as f64;
    // 99.99 % of a normal variable
    let off = (p - wanted[1]).abs() / (p * (1.0 - p) / n as f64).sqrt();
    assert!(off < 3.8906, "{p} for {}", wanted[1]);
}

proptest! {
    #[test]
    fn accumulators_have_the_moments_of_all_answers_however_they_are_divided(
        answers in prop::collection::vec((0.1..3.0f64, -5.0..5.0f64), 2..60), cut in 0.0..1.0f64, shift in prop_oneof![Just(0.0), Just(1e6)],
    ) {
        let at = (cut * answers.len() as f64) as usize;
        let block = |part: &[(f64, f64)]| {
            let mut a = Accumulator::default();
            part.iter().for_each(|&(w, x)| a.push(w, &[x + shift, -2.0 * x]).unwrap());
            a
        };
        let whole = block(&answers);
        let mut merged = block(&answers[..at]);
        merged.merge(&block(&answers[at..])).unwrap();
        let weights: Vec<f64> = answers.iter().map(|a| a.0).collect();
        let vectors: Vec<Vec<f64>> = answers.iter().map(|a| vec![a.1 + shift, -2.0 * a.1]).collect();
        let direct = moments(&weights, &vectors).unwrap();
        let digits = 1e-12 * (1.0 + shift * 1e-2);
        for a in [&whole, &merged] {
            let (m, e) = (a.moments(), a.standard_errors());
            for i in 0..2 {
                prop_assert!((m.mean[i] - direct.mean[i]).abs() < 1e-14 * (10.0 + shift));
                prop_assert!((m.variance[i] - direct.variance[i]).abs() < digits * (100.0 + direct.variance[i]));
            }
            // the errors by their definition
            let total: f64 = weights.iter().sum();
            let n = total * total / weights.iter().map(|w| w * w).sum::<f64>();
            let power = |k: i32| weights.iter().zip(&vectors).map(|(w, v)| w * (v[1] - direct.mean[1]).powi(k)).sum::<f64>() / total;
            if n >= 2.0 {
                let s = power(2) * n / (n - 1.0);
                prop_assert!((e.mean[1] - (s / n).sqrt()).abs() < 1e-12 * (1.0 + e.mean[1]));
                let of_variance = (power(4) - (n - 3.0) / (n - 1.0) * s * s) / n;
                prop_assert!((e.variance[1].powi(2) - of_variance.max(0.0)).abs() < 1e-10 * (1.0 + power(4)));
            }
        }
    }

    #[test]
    fn quantiles_divide_the_weights(
        answers in prop::collection::vec((0.0..3.0f64, -5.0..5.0f64), 1..40), p in 0.0..=1.0f64,
    ) {
        let (weights, values): (Vec<f64>, Vec<f64>) = answers.into_iter().unzip();
        let total: f64 = weights.iter().sum();
        prop_assume!(total > 0.0);
        let q = quantiles(&values, &weights, &[p]).unwrap()[0];
        let to = |strict: bool| -> f64 {
            values.iter().zip(&weights).filter(|(x, _)| **x < q || (!strict && **x == q)).map(|(_, w)| w).sum()
        };
        prop_assert!(to(false) >= p * total * (1.0 - 1e-14) && to(true) <= p * total * (1.0 + 1e-14));
    }
}

#[test]
fn standard_errors_are_those_of_repeated_experiments() {
    // 400 experiments of 50 uniform samples each: the spread of their means and variances
    let (experiments, n) = (400, 50);
    let run = |k: u64| {
        let mut a = Accumulator::default();
        (0..n).for_each(|i| a.push(1.0, &[uniform(11, k * n + i, 0)]).unwrap());
        let unbiased = a.moments().variance[0] * n as f64 / (n - 1) as f64;
        (a.moments().mean[0], unbiased, a.standard_errors())
    };
    let mut spread = Accumulator::default();
    let mut errors = [0.0; 2];
    for k in 0..experiments {
        let (mean, variance, e) = run(k);
        spread.push(1.0, &[mean, variance]).unwrap();
        errors[0] += e.mean[0] / experiments as f64;
        errors[1] += e.variance[0] / experiments as f64;
    }
    // √400 experiments fix a deviation to 1/√800 = 3.5 %: within four of that
    for i in 0..2 {
        let seen = spread.moments().variance[i].sqrt();
        assert!((errors[i] / seen - 1.0).abs() < 0.15, "{i}: {} {seen}", errors[i]);
    }
    // closed forms for the uniform distribution: σ² = 1/12, m_4 = 1/80
    let (s, n) = (1.0 / 12.0f64, n as f64);
    assert!((errors[0] / (s / n).sqrt() - 1.0).abs() < 0.02);
    assert!((errors[1] / ((1.0 / 80.0 - (n - 3.0) / (n - 1.0) * s * s) / n).sqrt() - 1.0).abs() < 0.05);
}

#[test]
fn a_spread_far_below_the_mean_keeps_its_digits() {
    let exact: Vec<f64> = (0..5).map(f64::from).collect();
    let answers: Vec<Vec<f64>> = exact.iter().map(|x| vec![1e8 + x * 2f64.powi(-20)]).collect();
    let m = moments(&[0.2; 5], &answers).unwrap();
    assert!((m.variance[0] / (2.0 * 2f64.powi(-40)) - 1.0).abs() < 1e-9, "{:e}", m.variance[0]);
    assert!((m.mean[0] - 1e8 - 2.0 * 2f64.powi(-20)).abs() < 2e-8);
    // negative weights: a variance of -1 is 0
    let m = moments(&[-1.0, 2.0], &[vec![0.0], vec![1.0]]).unwrap();
    assert_eq!((m.mean[0], m.variance[0]), (2.0, 0.0));
}

#[test]
fn histograms_have_mass_one_and_the_shares_of_their_bins() {
    // x² of a uniform x: the density is 1/(2√y)
    let n = 100_000;
    let values: Vec<f64> = (0..n).map(|i| ((i as f64 + 0.5) / n as f64).powi(2)).collect();
    let h = density(&values, &vec![2.0; n], 16).unwrap();
    let mass: f64 = h.density.iter().zip(h.edges.windows(2)).map(|(d, e)| d * (e[1] - e[0])).sum();
    assert!((mass - 1.0).abs() < 1e-12);
    for (d, e) in h.density.iter().zip(h.edges.windows(2)) {
        let wanted = (e[1].sqrt() - e[0].sqrt()) / (e[1] - e[0]);
        assert!((d - wanted).abs() < 1e-3, "{d} {wanted}");
    }
    let weighted = density(&[0.0, 1.0, 2.0], &[1.0, 2.0, 1.0], 2).unwrap();
    assert_eq!((weighted.edges, weighted.density), (vec![0.0, 1.0, 2.0], vec![0.25, 0.75]));
}

#[test]
fn quantiles_of_equal_weights_and_refusals() {
    let values = [3.0, 1.0, 2.0, 5.0, 4.0];
    let got = quantiles(&values, &[0.2; 5], &[0.0, 0.2, 0.5, 0.6, 0.61, 1.0]).unwrap();
    assert_eq!(got, [1.0, 1.0, 3.0, 3.0, 4.0, 5.0]);
    // values without weight are not there
    assert_eq!(quantiles(&[9.0, 1.0, -9.0], &[0.0, 1.0, 0.0], &[0.0, 1.0]).unwrap(), [1.0, 1.0]);

    let number = |r: Result<(), StochasticError>| assert!(matches!(r, Err(StochasticError::Number { .. })), "{r:?}");
    let sizes =
        |r: Result<(), StochasticError>| assert!(matches!(r, Err(StochasticError::Inconsistent { .. })), "{r:?}");
    sizes(quantiles(&[], &[], &[0.5]).map(drop));
    sizes(quantiles(&[1.0], &[1.0, 2.0], &[0.5]).map(drop));
    number(quantiles(&[f64::NAN], &[1.0], &[0.5]).map(drop));
    number(quantiles(&[1.0, 2.0], &[2.0, -1.0], &[0.5]).map(drop));
    number(quantiles(&[1.0], &[0.0], &[0.5]).map(drop));
    number(quantiles(&[1.0], &[1.0], &[1.5]).map(drop));
    number(density(&[1.0, 1.0], &[1.0, 1.0], 5).map(drop));
    number(density(&[1.0, 2.0], &[1.0, 1.0], 0).map(drop));
    number(density(&[-1e308, 1e308], &[1.0, 1.0], 1).map(drop));
    sizes(moments(&[1.0], &[]).map(drop));
    sizes(moments(&[1.0, 1.0], &[vec![1.0], vec![]]).map(drop));
    number(moments(&[1.0, -1.0], &[vec![1.0], vec![2.0]]).map(drop));
    let mut a = Accumulator::default();
    assert_eq!((a.moments().mean.len(), a.weight()), (0, 0.0));
    number(a.push(-1.0, &[1.0]));
    number(a.push(f64::INFINITY, &[1.0]));
    a.push(1.0, &[1.0]).unwrap();
    assert_eq!(a.standard_errors().mean, [f64::INFINITY]);
    sizes(a.push(1.0, &[1.0, 2.0]));
    assert_eq!((a.weight(), a.moments().variance), (1.0, vec![0.0]));
}
