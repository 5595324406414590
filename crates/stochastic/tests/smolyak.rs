//! Sparse grids: degrees and sizes.

use proptest::prelude::*;
use steklov_stochastic::{Distribution, StochasticError, Variable, smolyak};

/// Standard deviations from the mean: the coordinate of the moments.
fn unit(v: &Variable, x: f64) -> f64 {
    (x - v.mean()) / v.variance().sqrt()
}

proptest! {
    #[test]
    fn total_degree_is_exact(level in 0usize..4, powers in (0u32..8, 0u32..8, 0u32..8)) {
        let variables = [
            Variable::uniform(1.0, 3.0).unwrap(),
            Variable::normal(-2.0, 0.5).unwrap(),
            Variable::new(Distribution::Normal { mean: 0.0, deviation: 1.0 }, 0.3, 2.0).unwrap(),
        ];
        let powers = [powers.0, powers.1, powers.2];
        let grid = smolyak(&variables, level).unwrap();
        let term = |p: &[f64]| -> f64 { (0..3).map(|d| unit(&variables[d], p[d]).powi(powers[d] as i32)).product() };
        let got: f64 = grid.points.iter().zip(&grid.weights).map(|(p, w)| w * term(p)).sum();
        let moment = |d: usize| smolyak(&variables[d..=d], 5).map(|g| {
            g.points.iter().zip(&g.weights).map(|(p, w)| w * unit(&variables[d], p[0]).powi(powers[d] as i32)).sum::<f64>()
        });
        let wanted = moment(0).unwrap() * moment(1).unwrap() * moment(2).unwrap();
        let size: f64 = grid.points.iter().zip(&grid.weights).map(|(p, w)| (w * term(p)).abs()).sum::<f64>().max(1.0);
        if powers.iter().sum::<u32>() <= 2 * level as u32 + 1 {
            prop_assert!((got - wanted).abs() < 1e-12 * size, "{got} {wanted}");
        }
    }
}

#[test]
fn the_degree_ends_where_it_is_said_to_end() {
    let variables = vec![Variable::uniform(-1.0, 1.0).unwrap(); 3];
    let moment = |level: usize, powers: [i32; 3]| -> f64 {
        let grid = smolyak(&variables, level).unwrap();
        let term = |p: &Vec<f64>| -> f64 { (0..3).map(|d| p[d].powi(powers[d])).product() };
        grid.points.iter().zip(&grid.weights).map(|(p, w)| w * term(p)).sum()
    };
    // level 1 is right to degree 3 in all and 5 in one; x²y² is of degree 4
    assert!(moment(1, [2, 2, 0]).abs() < 1e-15, "not 1/9");
    assert!((moment(1, [4, 0, 0]) - 0.2).abs() < 1e-15);
    assert!((moment(1, [6, 0, 0]) - 1.0 / 7.0).abs() > 1e-3);
    assert!((moment(2, [2, 2, 0]) - 1.0 / 9.0).abs() < 1e-15);
    assert!(moment(2, [2, 2, 2]).abs() < 1e-15, "not 1/27");
    assert!((moment(3, [2, 2, 2]) - 1.0 / 27.0).abs() < 1e-15);
}

#[test]
fn grids_of_ten_directions_stay_small() {
    let symmetric = smolyak(&vec![Variable::normal(0.0, 1.0).unwrap(); 10], 2).unwrap();
    // the mean, two and four more points on each axis, four on each of the 45 planes
    assert_eq!(symmetric.points.len(), 1 + 10 * 6 + 45 * 4);
    assert!((symmetric.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    assert!(symmetric.weights.iter().any(|&w| w < 0.0), "weights may be negative");
    // rules without the mean: 1, 3 and 5 different points on each axis
    let skew = smolyak(&vec![Variable::beta(2.0, 5.0, 0.0, 1.0).unwrap(); 10], 2).unwrap();
    assert_eq!(skew.points.len(), 1 + 10 * 8 + 45 * 9);
    assert!(skew.points.windows(2).all(|p| p[0] < p[1]));
}

#[test]
fn edges_and_refusals() {
    let v = Variable::uniform(0.0, 2.0).unwrap();
    let one = smolyak(&[v.clone(), v.clone()], 0).unwrap();
    assert_eq!((one.points, one.weights), (vec![vec![1.0, 1.0]], vec![1.0]));
    let certain = smolyak(&[], 3).unwrap();
    assert_eq!((certain.points, certain.weights), (vec![vec![]], vec![1.0]));
    // a single direction: the Gauss rule itself
    let line = smolyak(std::slice::from_ref(&v), 4).unwrap();
    assert!(line.points.len() == 9 && line.weights.iter().all(|&w| w > 0.0));
    for (d, level) in [(1, 61), (1, usize::MAX), (40, 12), (100_000, 3)] {
        assert!(matches!(smolyak(&vec![v.clone(); d], level), Err(StochasticError::Number { .. })), "{d} {level}");
    }
}

/// Polynomials of the total degree of the level come back between the points; one of a degree more does not.
#[test]
fn polynomials_of_the_level_come_back() {
    let variables = [
        Variable::uniform(-1.0, 2.0).unwrap(),
        Variable::normal(0.5, 0.3).unwrap(),
        Variable::beta(2.0, 3.0, 0.0, 1.0).unwrap(),
    ];
    for level in 0..=3usize {
        let grid = smolyak(&variables, level).unwrap();
        let polynomials = grid.polynomials(&variables, level).unwrap();
        for (degree, comes_back) in [(level, true), (level + 1, false)] {
            let f = |x: &[f64]| (1.0 + x[0] - 0.7 * x[1] + 0.3 * x[2]).powi(degree as i32);
            let mut off = 0.0f64;
            for x in [[-0.9, 0.1, 0.2], [1.7, 0.9, 0.8], [0.3, 0.45, 0.5]] {
                let theta = polynomials.evaluate(&x);
                let value: f64 = theta.iter().zip(&grid.points).map(|(t, p)| t * f(p)).sum();
                off = off.max((value / f(&x) - 1.0).abs());
            }
            assert!(
                (off < 1e-10) == comes_back && (comes_back || off > 1e-3),
                "level {level}, degree {degree}: {off:e}"
            );
        }
    }
}
