//! Integration of given data against the nodal basis: smooth, kinked, singular and impossible ones.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::common::{SQUARE, max_abs, polygon};
use proptest::prelude::*;
use steklov_bem_operators::proptest::mesh;
use steklov_bem_operators::{BemError, Datum, Mesh, Site, Space, add_load, side_moments, side_moments_and_squares};

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
    let datum = Datum { name: "test", value: &|site: &Site| value(site.s), kinks: &in_element, rounding: None };
    let moments = side_moments(&mesh, &space, 0, &datum)?;
    Ok(moments.iter().flat_map(|(_, m)| m).sum())
}

/// What two terms leave that cancel up to rounding is refused, unless it is known to be rounding.
#[test]
fn rounding_of_what_cancels_is_no_roughness() {
    let mesh = Mesh::uniform(&polygon(&SQUARE, &[]), 4, 3);
    let left = |site: &Site| (0.3 + site.s).sin().powi(2) + (0.3 + site.s).cos().powi(2) - 1.0;
    let datum = Datum { name: "left", value: &left, kinks: &|_| Vec::new(), rounding: None };
    let moments = |datum| side_moments(&mesh, &Space::new(&mesh), 0, &datum);
    assert!(matches!(moments(datum), Err(BemError::DataRough { .. })));
    let known = moments(Datum { rounding: Some(&|_| 4e-16), ..datum }).expect("rounding");
    assert!(known[0].1.iter().all(|m| m.abs() < 1e-15), "{known:?}");
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
        let datum = Datum { name: "f", value: &|site: &Site| value(site.s), kinks: &|_| Vec::new(), rounding: None };
        let moments = side_moments(&mesh, &space, 1, &datum).expect("moments");
        let mut load = vec![0.0; space.dofs()];
        add_load(&mut load, &space, &moments, |e| mesh.normal(e, 0.0));
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

    /// Σ c_k P_k has the square h Σ c_k²/(2k+1), and |t - a| that of both its arms.
    #[test]
    fn squares_are_those_of_legendre_series_and_of_kinks(
        coefficients in proptest::collection::vec(-2.0..2.0f64, 1..12), at in -0.99..0.99f64, degree in 1..9usize,
    ) {
        let mesh = Mesh::uniform(&polygon(&SQUARE, &[]), 8, degree);
        let space = Space::new(&mesh);
        let squares = |value: &(dyn Fn(&Site) -> f64 + Sync), kinks: &(dyn Fn(usize) -> Vec<f64> + Sync)| {
            side_moments_and_squares(&mesh, &space, 2, &Datum { name: "f", value, kinks, rounding: None }).expect("moments")
        };
        let series = |site: &Site| {
            let mut p = vec![0.0; coefficients.len()];
            steklov_quadrature::legendre_p(site.t, &mut p);
            p.iter().zip(&coefficients).map(|(p, c)| p * c).sum()
        };
        let (moments, found) = squares(&series, &|_| vec![]);
        let want: f64 = coefficients.iter().enumerate().map(|(k, c)| c * c / (2 * k + 1) as f64).sum();
        prop_assert_eq!((moments.len(), found.len()), (2, 2));
        for ((e, _), square) in moments.iter().zip(&found) {
            prop_assert!((square - mesh.length(*e) * want).abs() < 1e-13 * want, "{square} {want}");
        }
        let (_, found) = squares(&|site| (site.t - at).abs(), &|_| vec![at]);
        let want = mesh.length(4) / 6.0 * ((1.0 - at).powi(3) + (1.0 + at).powi(3));
        prop_assert!(found.iter().all(|square| (square - want).abs() < 1e-14), "{found:?} {want}");
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

/// The square with a vertex at v of each edge and elements of length h on both sides of it.
fn with_vertex(v: f64, h: f64, degree: usize) -> Mesh {
    let breaks = vec![vec![v - h, v, v + h]; 4];
    Mesh::from_breaks(&polygon(&SQUARE, &[]), &breaks, &vec![vec![degree; 4]; 4]).expect("a mesh")
}

/// Moments on side 1 of a function with a kink or a jump at c, named where the elements see it, and how often it is asked.
fn bent(mesh: &Mesh, c: f64, value: fn(f64) -> f64, named: bool) -> (Vec<f64>, usize) {
    let asked = AtomicUsize::new(0);
    let value = |site: &Site| {
        asked.fetch_add(1, Ordering::Relaxed);
        value(site.s - c)
    };
    let kinks = |e: usize| {
        let [a, b] = mesh.span[e];
        if named { vec![2.0 * (c - a) / (b - a) - 1.0] } else { Vec::new() }
    };
    let datum = Datum { name: "bent", value: &value, kinks: &kinks, rounding: None };
    let moments = side_moments(mesh, &Space::new(mesh), 1, &datum).expect("moments");
    (moments.into_iter().flat_map(|(_, m)| m).collect(), asked.into_inner())
}

proptest! {
    /// A kink and a jump that rounding put beside a vertex have the load of those at it, at the same cost.
    #[test]
    fn a_kink_an_ulp_beside_a_vertex_is_at_the_vertex(
        v in 0.1..0.9f64, ten in -8.0..-1.1f64, degree in 1..6usize, ulps in 1..3i64, after: bool,
    ) {
        let mesh = with_vertex(v, 10f64.powf(ten), degree);
        let c = f64::from_bits(v.to_bits().wrapping_add_signed(if after { ulps } else { -ulps }));
        for value in [f64::abs, |x: f64| if x < 0.0 { -2.0 } else { 1.0 }] {
            let ((at, cost), (beside, more)) = (bent(&mesh, v, value, true), bent(&mesh, c, value, true));
            prop_assert!(at.iter().zip(&beside).all(|(a, b)| (a - b).abs() < 1e-12), "{at:?} {beside:?}");
            prop_assert_eq!(cost, more);
        }
        let exact = (v * v + (1.0 - v) * (1.0 - v)) / 2.0;
        prop_assert!((bent(&mesh, c, f64::abs, true).0.iter().sum::<f64>() - exact).abs() < 1e-14);
    }

    /// A kink between the last Gauss point and a vertex, that nobody named.
    #[test]
    fn a_kink_next_to_a_vertex_is_found(v in 0.2..0.8f64, ten in -9.0..-4.0f64, after: bool, degree in 1..6usize) {
        let mesh = with_vertex(v, 0.1, degree);
        let c = if after { v + 10f64.powf(ten) } else { v - 10f64.powf(ten) };
        let exact = (c * c + (1.0 - c) * (1.0 - c)) / 2.0;
        let error = bent(&mesh, c, f64::abs, false).0.iter().sum::<f64>() - exact;
        prop_assert!(error.abs() < 3e-11, "{error:e}");
    }

    /// Points are one with an end exactly if rounding of coordinates can have put them apart: within some 30 ulps.
    #[test]
    fn the_resolution_is_that_of_the_coordinates(
        mesh in mesh(1), ten in -12.0..0.0f64, at in 0.01..0.9f64, ulps in [-2..=2i64, -2..=2i64],
    ) {
        // the vertex after a small element, on which it lies at t = 1, off by some ulps
        let h = 10f64.powf(ten);
        let mut small = mesh.clone();
        let [a, b] = mesh.ends(0);
        small.vertices[0] = [0, 1].map(|i| a[i] + at * (b[i] - a[i]));
        small.vertices[small.next[0]] = [0, 1].map(|i| a[i] + (at + 0.1 * h) * (b[i] - a[i]));
        let ([start, end], length) = (small.ends(0), small.length(0));
        prop_assume!(length > 0.0);
        let off = [0, 1].map(|i| f64::from_bits(end[i].to_bits().wrapping_add_signed(ulps[i])));
        let resolution = small.resolution(0);
        let t = small.tangent(0, 0.0);
        let distance = 2.0 * ((off[0] - end[0]) * t[0] + (off[1] - end[1]) * t[1]).abs() / length;
        prop_assert!(distance <= resolution || resolution == 1e-3, "{distance:e} {resolution:e}");
        let ulp = f64::EPSILON * (start[0].abs() + start[1].abs()) / length;
        prop_assert!(resolution <= (32.0 * ulp).max(1e-12) && (1e-12..=1e-3).contains(&resolution));
    }
}

/// The points of a side are shared out by length: a peak is seen however many small elements there are elsewhere.
#[test]
fn small_elements_take_no_points_from_a_large_one() {
    let breaks: Vec<f64> = (1..40).rev().map(|k| 0.6f64.powi(k)).collect();
    let (breaks, degrees) = (vec![breaks; 4], vec![vec![2; 40]; 4]);
    let mesh = Mesh::from_breaks(&polygon(&SQUARE, &[]), &breaks, &degrees).expect("a mesh");
    let k = 1e6;
    for at in (0..=40).map(|i| 0.61 + 0.0095 * f64::from(i)) {
        let value = |site: &Site| 1.0 + (-k * (site.s - at).powi(2)).exp();
        let datum = Datum { name: "a peak", value: &value, kinks: &|_| Vec::new(), rounding: None };
        let moments = side_moments(&mesh, &Space::new(&mesh), 0, &datum).expect("moments");
        let whole: f64 = moments.iter().flat_map(|(_, m)| m).sum();
        assert!((whole - 1.0 - (std::f64::consts::PI / k).sqrt()).abs() < 1e-11, "{at}: {whole}");
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
