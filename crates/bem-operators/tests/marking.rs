//! Dörfler marking against all subsets, and the Legendre decay of displacements whose coefficients are known.

use std::f64::consts::TAU;

use proptest::collection::vec;
use proptest::prelude::*;
use steklov_bem_operators::proptest::mesh;
use steklov_bem_operators::{Mesh, Space, doerfler, edge_tangents, legendre_decay};

/// Whole numbers, many of them equal or zero, so that all sums are exact.
fn indicators() -> impl Strategy<Value = Vec<f64>> {
    vec(prop_oneof![0..5u32, 0..1000u32], 1..=10).prop_map(|v| v.into_iter().map(f64::from).collect())
}

/// Fewest elements of any subset whose sum is at least `goal`.
fn fewest(squared: &[f64], goal: f64) -> u32 {
    let sum = |set: u32| squared.iter().enumerate().filter(|(e, _)| set >> e & 1 == 1).map(|(_, s)| s).sum::<f64>();
    (0..1 << squared.len()).filter(|&set| sum(set) >= goal).map(u32::count_ones).min().expect("the whole set")
}

proptest! {
    #[test]
    fn the_marked_set_is_the_smallest_and_what_equals_its_last(squared in indicators(), theta in 1..=64u32) {
        let theta = f64::from(theta) / 64.0;
        let marked = doerfler(&squared, theta);
        let whole: f64 = squared.iter().sum();
        let mut falling = squared.clone();
        falling.sort_by(|a, b| b.total_cmp(a));
        let count = fewest(&squared, theta * whole) as usize;
        let least = if count > 0 { falling[count - 1] } else { f64::INFINITY };
        for (e, excess) in squared.iter().zip(&marked) {
            prop_assert_eq!(*e >= least && *e > 0.0, excess.is_some());
            if let Some(excess) = excess {
                prop_assert!((excess - (e / least).sqrt()).abs() <= 1e-15 * excess, "{} of {} over {}", excess, e, least);
                prop_assert!(*excess >= 1.0 && (*excess == 1.0) == (*e == least));
            }
        }
        let sum: f64 = squared.iter().zip(&marked).filter(|(_, m)| m.is_some()).map(|(e, _)| e).sum();
        prop_assert!(sum >= theta * whole);
        if theta == 1.0 {
            prop_assert!(squared.iter().zip(&marked).all(|(e, m)| m.is_some() == (*e > 0.0)));
        }
    }

    #[test]
    fn neither_the_order_nor_the_unit_of_indicators_matters(
        (squared, places) in vec(0.0..1.0f64, 1..40).prop_flat_map(|s| {
            let places: Vec<usize> = (0..s.len()).collect();
            (Just(s), Just(places).prop_shuffle())
        }),
        theta in 0.0..1.0f64,
        exponent in -60..60i32,
    ) {
        let marked = doerfler(&squared, theta);
        let moved: Vec<f64> = places.iter().map(|&e| squared[e] * 2f64.powi(exponent)).collect();
        let want: Vec<Option<f64>> = places.iter().map(|&e| marked[e]).collect();
        prop_assert_eq!(doerfler(&moved, theta), want);
        let largest = squared.iter().fold(0.0, |m: f64, e| m.max(*e));
        prop_assert!(squared.iter().zip(&marked).all(|(e, m)| *e < largest || m.is_some()));
    }
}

#[test]
fn indicators_that_rounding_tells_apart_are_marked_together() {
    // 0.4 is needed; what is 0.5e-6 below it has the same mark, what is 2e-6 below has none
    let marked = doerfler(&[1.6, 0.4, 0.4 * (1.0 - 0.5e-6), 0.4 * (1.0 - 2e-6), 0.0], 0.7);
    assert_eq!(marked, [Some(2.0), Some(1.0), Some(1.0), None, None]);
    assert_eq!(doerfler(&[0.0; 3], 1.0), [None; 3]);
    assert_eq!(doerfler(&[], 0.5), []);
}

#[test]
#[should_panic(expected = "NaN")]
fn an_indicator_that_is_no_number_is_refused() {
    doerfler(&[1.0, f64::NAN], 0.5);
}

/// Nodal displacement with Legendre coefficients (from degree 0) along n and t of element e, zero at the other nodes.
fn with_coefficients(mesh: &Mesh, space: &Space, e: usize, coefficients: [&[f64]; 2]) -> Vec<f64> {
    let mut displacement = vec![0.0; space.dofs()];
    let p_n = &space.basis(e).vandermonde;
    for (d, a) in [mesh.normal(e, 0.0), mesh.tangent(e, 0.0)].iter().zip(coefficients) {
        for (j, node) in space.element_nodes(e).enumerate() {
            let value: f64 = a.iter().enumerate().map(|(i, a)| a * p_n[(j, i)]).sum();
            (0..2).for_each(|k| displacement[2 * node + k] += d[k] * value);
        }
    }
    displacement
}

/// `mesh` with one degree, and an element of it.
fn element(degree: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = (Mesh, usize)> {
    (mesh(1), degree, 0..1000usize).prop_map(|(mesh, p, e)| {
        let e = e % mesh.len();
        (Mesh { degree: vec![p; mesh.len()], ..mesh }, e)
    })
}

/// c ±r^i, i = 0..=p, with c and the signs from `seed`.
fn geometric(r: f64, c: f64, signs: u32, p: usize) -> Vec<f64> {
    (0..=p).map(|i| if signs >> i & 1 == 1 { -c * r.powi(i as i32) } else { c * r.powi(i as i32) }).collect()
}

/// The mesh with other vertices.
fn of_vertices(vertices: Vec<[f64; 2]>, mesh: &Mesh) -> Mesh {
    let heading = edge_tangents(&vertices, &mesh.next, &mesh.edge);
    Mesh { vertices, heading, ..mesh.clone() }
}

/// The image in the y axis, traversed backwards so that the body is to the left; elements keep their numbers.
fn mirrored(mesh: &Mesh) -> Mesh {
    let vertices = (0..mesh.len()).map(|e| mesh.ends(e)[1]).map(|[x, y]| [-x, y]).collect();
    let span = mesh.span.iter().map(|[a, b]| [*b, *a]).collect();
    of_vertices(vertices, &Mesh { next: mesh.previous(), span, ..mesh.clone() })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// |a_i| = c r^i along n and c' r'^i along t: the larger ratio.
    #[test]
    fn geometric_coefficients_give_their_ratio(
        (mesh, e) in element(2..=12),
        ratio in [0.2..1.3f64, 0.2..1.3f64],
        ten in -0.8..0.8f64,
        signs: [u32; 2],
    ) {
        let (space, p) = (Space::new(&mesh), mesh.degree[e]);
        let along = [geometric(ratio[0], 1.0, signs[0], p), geometric(ratio[1], 10f64.powf(ten), signs[1], p)];
        let u = with_coefficients(&mesh, &space, e, [&along[0], &along[1]]);
        let got = legendre_decay(&mesh, &space, e, &u).expect("coefficients");
        prop_assert!((got - ratio[0].max(ratio[1])).abs() < 1e-6, "{} of {:?}", got, ratio);
        // one component only
        for (k, r) in ratio.iter().enumerate() {
            let only: [&[f64]; 2] = if k == 0 { [&along[0], &[]] } else { [&[], &along[1]] };
            let got = legendre_decay(&mesh, &space, e, &with_coefficients(&mesh, &space, e, only)).expect("one");
            prop_assert!((got - r).abs() < 1e-6);
        }
    }

    /// x ↦ c R x + d of the body and u ↦ c' R u + d' of its displacement, and the image in the y axis.
    #[test]
    fn neither_units_nor_directions_nor_translations_matter(
        (mesh, e) in element(2..=10),
        coefficients in vec([0.01..1.0f64, 0.01..1.0f64], 11),
        signs: [u32; 2],
        turn in 0.0..TAU,
        scale in [-6.0..6.0f64, -6.0..6.0f64],
        shift in [-10.0..10.0f64, -10.0..10.0f64],
    ) {
        let (space, p) = (Space::new(&mesh), mesh.degree[e]);
        let along: Vec<Vec<f64>> = (0..2)
            .map(|k| geometric(0.5, 1.0, signs[k], p).iter().zip(&coefficients).map(|(g, c)| g * c[k]).collect())
            .collect();
        let u = with_coefficients(&mesh, &space, e, [&along[0], &along[1]]);
        let want = legendre_decay(&mesh, &space, e, &u).expect("coefficients");

        let (sin, cos) = turn.sin_cos();
        let map = |[x, y]: [f64; 2], scale: f64, shift: [f64; 2]| {
            [scale * (cos * x - sin * y + shift[0]), scale * (sin * x + cos * y + shift[1])]
        };
        let [length, unit] = scale.map(|s| 10f64.powf(s));
        let moved = of_vertices(mesh.vertices.iter().map(|&x| map(x, length, [0.0; 2])).collect(), &mesh);
        let turned: Vec<f64> = u.chunks_exact(2).flat_map(|u| map([u[0], u[1]], unit, shift)).collect();
        let got = legendre_decay(&moved, &Space::new(&moved), e, &turned).expect("coefficients");
        prop_assert!((got - want).abs() < 1e-7 * want, "{} {}", got, want);

        let image = mirrored(&mesh);
        let other = Space::new(&image);
        let mut reflected = vec![0.0; other.dofs()];
        let nodes: Vec<usize> = space.element_nodes(e).collect();
        for (&from, to) in nodes.iter().rev().zip(other.element_nodes(e)) {
            (reflected[2 * to], reflected[2 * to + 1]) = (-u[2 * from], u[2 * from + 1]);
        }
        let got = legendre_decay(&image, &other, e, &reflected).expect("coefficients");
        prop_assert!((got - want).abs() < 1e-9 * want, "{} {}", got, want);
    }

    /// One coefficient besides the translation does not make a rate, nor does what is left of others in rounding.
    #[test]
    fn a_translation_and_one_more_coefficient_have_no_rate(
        (mesh, e) in element(2..=12),
        translation in [-1.0..1.0f64, -1.0..1.0f64],
        slope in [-1.0..1.0f64, -1.0..1.0f64],
        ten in -12.0..0.0f64,
    ) {
        let (space, p) = (Space::new(&mesh), mesh.degree[e]);
        let linear = slope.map(|s| s * 10f64.powf(ten));
        for (i, some) in [(0, false), (1, false), (p, false), (0, true)] {
            let along = [0, 1].map(|k| {
                let mut a = vec![0.0; p + 1];
                a[0] = translation[k];
                a[i] += linear[k];
                if some {
                    a[1] += 0.1;
                    a[p] += 0.1;
                }
                a
            });
            let rate = legendre_decay(&mesh, &space, e, &with_coefficients(&mesh, &space, e, [&along[0], &along[1]]));
            prop_assert_eq!(rate.is_some(), some, "{:?} of {:?}", rate, along);
        }
    }

    #[test]
    fn degree_one_has_no_rate((mesh, e) in element(1..=1), a in [-1.0..1.0f64, -1.0..1.0f64]) {
        let space = Space::new(&mesh);
        prop_assert_eq!(legendre_decay(&mesh, &space, e, &with_coefficients(&mesh, &space, e, [&a, &a])), None);
    }
}

#[test]
fn the_fit_is_that_of_least_squares_over_what_is_there() {
    let mesh = Mesh { degree: vec![3; 4], ..Mesh::uniform(&crate::common::polygon(&crate::common::SQUARE, &[]), 4, 1) };
    let space = Space::new(&mesh);
    let rate = |n: &[f64], t: &[f64]| legendre_decay(&mesh, &space, 2, &with_coefficients(&mesh, &space, 2, [n, t]));
    let close = |got: Option<f64>, want: f64| (got.expect("a rate") - want).abs() < 1e-9;
    // log|a| = 0, -3, -1 at 1, 2, 3 has the slope -1/2; without the middle one, as for a parity, it is the same
    let e = |x: f64| x.exp();
    assert!(close(rate(&[7.0, 1.0, e(-3.0), -e(-1.0)], &[]), e(-0.5)));
    assert!(close(rate(&[7.0, 1.0, 0.0, -e(-1.0)], &[]), e(-0.5)));
    // a component with one coefficient is no witness
    assert!(close(rate(&[0.0, 1.0], &[0.0, 1.0, 0.3, 0.09]), 0.3));
    // nor is one a thousandth as large as the other
    let small = |c: f64| [0.0, c, 0.8 * c, 0.64 * c];
    assert!(close(rate(&[0.0, 1.0, 0.3, 0.09], &small(0.999e-3)), 0.3));
    assert!(close(rate(&[0.0, 1.0, 0.3, 0.09], &small(1.001e-3)), 0.8));
}
