//! Integration of given data against the nodal basis: smooth, kinked, singular and impossible ones.

mod common;

use common::{SQUARE, max_abs, polygon};
use proptest::prelude::*;
use steklov_bem_operators::{BemError, Datum, Mesh, Site, Space, add_load, side_moments};

fn integrate(
    value: &(dyn Fn(f64) -> f64 + Sync),
    elements: usize,
    degree: usize,
    kinks: &[f64],
) -> Result<f64, BemError> {
    let mesh = Mesh::uniform(&polygon(&SQUARE, &[]), 4 * elements, degree);
    let space = Space::new(&mesh);
    let in_element = |e: usize| {
        let [a, b] = mesh.span[e];
        kinks.iter().map(|s| 2.0 * (s - a) / (b - a) - 1.0).collect::<Vec<_>>()
    };
    let datum = Datum { name: "test", value: &|site: &Site| value(site.s), kinks: &in_element };
    let moments = side_moments(&mesh, &space, 0, &datum)?;
    Ok(moments.iter().flat_map(|(_, m)| m).sum())
}

proptest! {
    #[test]
    fn polynomials_are_exact_and_loads_balance(
        coefficients in proptest::collection::vec(-2.0..2.0f64, 1..30),
        elements in 1..5usize,
        degree in 1..9usize,
    ) {
        let mesh = Mesh::uniform(&polygon(&SQUARE, &[]), 4 * elements, degree);
        let space = Space::new(&mesh);
        let value = |s: f64| coefficients.iter().rev().fold(0.0, |p, c| p * s + c);
        let datum = Datum { name: "f", value: &|site: &Site| value(site.s), kinks: &|_| Vec::new() };
        let moments = side_moments(&mesh, &space, 1, &datum).expect("moments");
        let mut load = vec![0.0; space.dofs()];
        add_load(&mut load, &space, &moments, |e| mesh.normal(e));
        let exact: f64 = coefficients.iter().enumerate().map(|(k, c)| c / (k + 1) as f64).sum();
        let first: f64 = coefficients.iter().enumerate().map(|(k, c)| c * (1.0 / (k + 2) as f64 - 0.5 / (k + 1) as f64)).sum();
        let scale: f64 = coefficients.iter().map(|c| c.abs()).sum();
        // side 1 runs up at x = 1/2 with the normal (1, 0): force and first moment in y
        let force: f64 = load.iter().step_by(2).sum();
        let moment: f64 = load.iter().step_by(2).zip(&space.points).map(|(f, x)| f * x[1]).sum();
        prop_assert!((force - exact).abs() < 1e-13 * scale);
        prop_assert!((moment - first).abs() < 1e-13 * scale);
        prop_assert!(load.iter().skip(1).step_by(2).all(|f| f.abs() < 1e-15 * scale));
    }

    #[test]
    fn named_kinks_and_jumps_are_exact(at in 0.01..0.99f64, elements in 1..4usize, degree in 1..5usize) {
        let kink = integrate(&|s| (s - at).abs(), elements, degree, &[at]).expect("a kink");
        prop_assert!((kink - (at * at + (1.0 - at) * (1.0 - at)) / 2.0).abs() < 1e-14);
        let jump = integrate(&|s| if s < at { 1.0 } else { -2.0 }, elements, degree, &[at]).expect("a jump");
        prop_assert!((jump - (3.0 * at - 2.0)).abs() < 1e-14, "{jump}");
    }

    #[test]
    fn what_is_not_named_is_found_by_halving(at in 0.001..0.999f64, elements in 1..4usize, degree in 1..5usize) {
        let kink = integrate(&|s| (s - at).abs(), elements, degree, &[]).expect("a kink");
        prop_assert!((kink - (at * at + (1.0 - at) * (1.0 - at)) / 2.0).abs() < 1e-9);
        let jump = integrate(&|s| if s < at { 1.0 } else { -2.0 }, elements, degree, &[]).expect("a jump");
        prop_assert!((jump - (3.0 * at - 2.0)).abs() < 1e-9, "{:e}", jump - (3.0 * at - 2.0));
    }
}

#[test]
fn integrable_singularities_come_out_right_and_poles_are_refused() {
    let log = integrate(&|s| s.ln(), 2, 2, &[]).expect("a logarithm");
    assert!((log + 1.0).abs() < 1e-10, "{log}");
    let root = integrate(&|s| (s - 0.37).abs().sqrt(), 2, 2, &[]).expect("a square root");
    assert!((root - 2.0 / 3.0 * (0.37f64.powf(1.5) + 0.63f64.powf(1.5))).abs() < 1e-10, "{root}");
    for exponent in [1.0, 2.0] {
        let pole = integrate(&|s| 1.0 / (s - 0.3).powf(exponent).abs(), 2, 2, &[]);
        assert!(matches!(pole, Err(BemError::DataRough { .. } | BemError::DataNotFinite { .. })), "{pole:?}");
    }
    let error = integrate(&|s| if s > 0.6 { f64::NAN } else { 1.0 }, 1, 1, &[]).expect_err("not a number");
    assert!(matches!(&error, BemError::DataNotFinite { side, .. } if side == "side0"), "{error}");
    assert!(error.to_string().contains("NaN") && error.to_string().contains("side0"), "{error}");
}

#[test]
fn narrow_peaks_and_noise_come_out_right() {
    for k in [1e4, 1e5, 1e6] {
        let peak = integrate(&|s| (-k * (s - 0.537f64).powi(2)).exp(), 1, 1, &[]).expect("a peak");
        assert!((peak * (k / std::f64::consts::PI).sqrt() - 1.0).abs() < 1e-10, "k = {k}: {peak}");
    }
    // a flat cylinder, its height lost in cancellation to 1e-7
    for radius in [1e3, 1e4, 1e5] {
        let gap = integrate(&|s| radius - (radius * radius - (s - 0.5) * (s - 0.5)).sqrt(), 4, 4, &[]).expect("a gap");
        assert!(
            (gap * 24.0 * radius - 1.0).abs() < 0.04 / (radius * radius) + 1e-15 * radius * radius,
            "R = {radius}: {gap}"
        );
    }
}

#[test]
fn the_highest_degree_can_be_loaded() {
    assert!((integrate(&|s| s.sin(), 1, Mesh::MAX_DEGREE, &[]).expect("a load") - (1.0 - 1.0f64.cos())).abs() < 1e-13);
}

#[test]
fn a_side_without_load_and_a_tiny_load_are_no_trouble() {
    assert_eq!(integrate(&|_| 0.0, 3, 2, &[]).expect("zero"), 0.0);
    let tiny = integrate(&|s| 1e-300 * (5.0 * s).sin(), 3, 2, &[]).expect("tiny");
    assert!((tiny / 1e-300 - (1.0 - 5.0f64.cos()) / 5.0).abs() < 1e-12);
    assert!(max_abs(&[tiny]) > 0.0);
}
