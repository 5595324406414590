//! Expansions of the means over cells.

use proptest::prelude::*;
use steklov_stochastic::Kernel::{Exponential, Gaussian};
use steklov_stochastic::{CellKarhunenLoeve, Covariance, FieldCells, Kernel, StochasticError, Truncation, sample};
use steklov_stochastic::{RectangleKarhunenLoeve, Variable};

fn rectangle(cells: [usize; 2], sides: [f64; 2]) -> FieldCells {
    FieldCells { cells, size: [0, 1].map(|d| sides[d] / cells[d] as f64), inside: None }
}

fn corner(n: usize) -> FieldCells {
    let inside = (0..n * n).map(|c| c / n < n / 2 || c % n < n / 2).collect();
    FieldCells { inside: Some(inside), ..rectangle([n; 2], [1.0; 2]) }
}

fn expansion(kernel: Kernel, ell: f64, cells: FieldCells, truncation: Truncation) -> CellKarhunenLoeve {
    CellKarhunenLoeve::new(&Covariance { kernel, correlation: [ell; 2] }, cells, truncation).unwrap()
}

/// Values of the L by an independent program (dense matrices at 32 × 32 cells), and shares.
#[test]
fn the_l_is_that_of_the_reference() {
    for (kernel, ell, values, share, unresolved) in [
        (
            Exponential,
            0.5,
            [0.2666339302869054, 0.10697706920627265, 0.06455965576086063, 0.010893104033863944, 0.0007248646374648997],
            0.943896653762307,
            0.040602943441105155,
        ),
        (
            Gaussian,
            0.5,
            [0.3473367345363888, 0.16345301227919182, 0.10561977855737656, 0.00421874778922645, 5.073804643608635e-9],
            0.9986993564036365,
            0.0013006435961794294,
        ),
        (
            Exponential,
            0.1,
            [0.03259171207926563, 0.0283108227734017, 0.02527757934629148, 0.013284062536226975, 0.0025799620441583062],
            0.6839715692858821,
            0.18370928780313978,
        ),
        (
            Gaussian,
            0.1,
            [
                0.02916148050478662,
                0.02774824203389919,
                0.026649747389622374,
                0.019860361011507687,
                0.004088787341895097,
            ],
            0.9441019575307986,
            0.03167238455405197,
        ),
    ] {
        // a Gaussian covariance of long correlation has no 100 modes above rounding
        let modes = if kernel == Gaussian && ell == 0.5 { 60 } else { 100 };
        let kl = expansion(kernel, ell, corner(32), Truncation::Modes(modes));
        for (m, value) in [1, 2, 3, 10, 50].into_iter().zip(values) {
            assert!((kl.eigenvalues()[m - 1] - value).abs() < 1e-12 * values[0], "{kernel:?} {ell}: mode {m}");
        }
        assert!((kl.captured() - share).abs() < 2e-9, "{kernel:?} {ell}: {}", kl.captured());
        assert!((kl.unresolved() - unresolved).abs() < 1e-13, "{kernel:?} {ell}: {}", kl.unresolved());
    }
}

/// 1 - k², k = 2 (q - 1 + e^-q)/q², q the length of a cell in correlation lengths; the Matérn values are those of 12 Gauss points
/// a cell.
#[test]
fn cells_do_not_resolve_a_known_share() {
    for (q, one) in [
        (0.0625, 0.020511839500386486),
        (0.25, 0.07837494171504389),
        (0.5, 0.1477547222989326),
        (1.0, 0.26424111765711533),
        (2.0, 0.4323323583816936),
    ] {
        let kl = expansion(Exponential, 1.0 / q, rectangle([2, 3], [2.0, 3.0]), Truncation::Modes(1));
        let square: f64 = 1.0 - (1.0 - one) * (1.0 - one);
        assert!((kl.unresolved() - square).abs() < 1e-13, "{q}: {} {square}", kl.unresolved());
    }
    for (q, wanted) in [(100.0, 1.0 - (2.0 * 99.0 / 1e4f64).powi(2)), (1e-6, 1.0 - (1.0 - 1e-6 / 3.0f64).powi(2))] {
        let kl = expansion(Exponential, 1.0 / q, rectangle([1, 1], [1.0, 1.0]), Truncation::Modes(1));
        assert!((kl.unresolved() - wanted).abs() < 1e-12, "{q}: {} {wanted}", kl.unresolved());
    }
    for (n, wanted) in [(32, 0.0018545005376822132), (128, 0.00012049242826528417)] {
        let kl = expansion(Kernel::MATERN_32, 0.5, rectangle([n; 2], [1.0; 2]), Truncation::Modes(3));
        assert!((kl.unresolved() - wanted).abs() < 1e-8 * wanted, "{n}: {}", kl.unresolved());
    }
}

/// On a rectangle eigenpairs of the cells tend to those of the rectangle: a mask that leaves out nothing but one cell of many
/// differs from it by that cell.
#[test]
fn a_rectangle_has_the_pairs_of_its_cells() {
    let whole = expansion(Gaussian, 0.7, rectangle([40, 20], [2.0, 1.0]), Truncation::Modes(8));
    let mut inside = vec![true; 800];
    inside[799] = false;
    let cells = FieldCells { inside: Some(inside), ..rectangle([40, 20], [2.0, 1.0]) };
    let mask = expansion(Gaussian, 0.7, cells, Truncation::Modes(8));
    for m in 0..8 {
        let (a, b) = (whole.eigenvalues()[m], mask.eigenvalues()[m]);
        assert!((a - b).abs() < 0.012 * whole.eigenvalues()[0] && (a - b).abs() > 0.0, "{m}: {a} {b}");
    }
}

#[test]
fn what_makes_no_sense_is_refused() {
    let covariance = Covariance { kernel: Exponential, correlation: [0.5; 2] };
    let new = |cells, truncation| CellKarhunenLoeve::new(&covariance, cells, truncation);
    let few = FieldCells { inside: Some(vec![true; 3]), ..rectangle([2; 2], [1.0; 2]) };
    let none = FieldCells { inside: Some(vec![false; 4]), ..rectangle([2; 2], [1.0; 2]) };
    for cells in [few, none, rectangle([0, 2], [1.0; 2])] {
        let refused = new(cells.clone(), Truncation::Modes(1));
        assert!(
            matches!(refused, Err(StochasticError::Inconsistent { .. } | StochasticError::Number { .. })),
            "{cells:?}"
        );
    }
    let flat = FieldCells { size: [0.0, 1.0], ..rectangle([2; 2], [1.0; 2]) };
    assert!(matches!(new(flat, Truncation::Modes(1)), Err(StochasticError::Number { .. })));
    assert!(matches!(new(corner(32), Truncation::Modes(401)), Err(StochasticError::Modes { .. })));
    assert!(matches!(new(corner(4), Truncation::Modes(13)), Err(StochasticError::Modes { wanted: 13, available: 12 })));
    assert!(matches!(new(corner(8), Truncation::Captured(1.0)), Err(StochasticError::Number { .. })));
    for smoothness in [0.49, 10.1, f64::NAN] {
        let kernel = Kernel::Matern { smoothness };
        let refused = CellKarhunenLoeve::new(&Covariance { kernel, ..covariance }, corner(8), Truncation::Modes(1));
        assert!(matches!(refused, Err(StochasticError::Number { .. })), "{smoothness}");
    }
    let refused = CellKarhunenLoeve::independent(rectangle([64, 33], [1.0; 2]));
    assert!(matches!(refused, Err(StochasticError::Modes { wanted: 2112, available: 2048 })));
}

fn products() -> impl Strategy<Value = Kernel> {
    prop_oneof![Just(Exponential), Just(Gaussian)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// The mean over a cell is that of the values in it.
    #[test]
    fn means_are_means(kernel in products(), ell in 0.3..3.0, nx in 1usize..5, ny in 1usize..5, seed in 0u64..1000) {
        let cells = rectangle([nx, ny], [2.0, 1.0]);
        let covariance = Covariance { kernel, correlation: [ell; 2] };
        let truncation = Truncation::Modes(5);
        let points = RectangleKarhunenLoeve::new(&covariance, [2.0, 1.0], truncation).unwrap();
        let kl = CellKarhunenLoeve::new(&covariance, cells.clone(), truncation).unwrap();
        let cell = seed as usize % (nx * ny);
        let parts = 400;
        let mut mean = [0.0; 5];
        let mut at = [0.0; 5];
        for k in 0..parts * parts {
            let place = [(k / parts) as f64, (k % parts) as f64].map(|t| (t + 0.5) / parts as f64);
            let x = [0, 1].map(|d| ([cell / ny, cell % ny][d] as f64 + place[d]) * cells.size[d]);
            points.modes(x, &mut at);
            mean.iter_mut().zip(&at).for_each(|(m, b)| *m += b / (parts * parts) as f64);
        }
        for m in 0..5 {
            prop_assert!((mean[m] - kl.mode(m)[cell]).abs() < 2e-4, "mode {}: {} {}", m, mean[m], kl.mode(m)[cell]);
        }
    }

    /// The mean over a cell is that of the means over its parts, for each outcome.
    #[test]
    fn means_of_parts_are_means(kernel in products(), ell in 0.2..3.0, n in 1usize..6, seed in 0u64..1000) {
        let covariance = Covariance { kernel, correlation: [ell; 2] };
        let of = |cells| CellKarhunenLoeve::new(&covariance, cells, Truncation::Modes(6)).unwrap();
        let (coarse, fine) = (of(rectangle([n, 2 * n], [1.0; 2])), of(rectangle([2 * n, 4 * n], [1.0; 2])));
        let germs = sample(&[(); 6].map(|()| Variable::normal(0.0, 1.0).unwrap()), seed, 1);
        let (a, b) = (coarse.values(&germs), fine.values(&germs));
        for (c, value) in a.iter().enumerate() {
            let (i, j) = (c / (2 * n), c % (2 * n));
            let part = |k: usize| b[(2 * i + k / 2) * 4 * n + 2 * j + k % 2];
            prop_assert!((value - (0..4).map(part).sum::<f64>() / 4.0).abs() < 1e-12);
        }
    }

    /// All modes of a body have the covariance of the means of its cells, and are orthonormal.
    #[test]
    fn modes_have_the_covariance_of_means(
        gaussian in any::<bool>(), ell in 0.1..2.0, n in 2usize..5, gap in 0usize..3,
    ) {
        let kernel = if gaussian { Gaussian } else { Exponential };
        let inside = (0..4 * n * n).map(|c| !(c / (2 * n) >= n && c % (2 * n) >= n + gap.min(n - 1))).collect();
        let cells = FieldCells { inside: Some(inside), ..rectangle([2 * n; 2], [1.0; 2]) };
        let body = cells.body();
        let count = if gaussian { 3 } else { body.len() };
        let kl = expansion(kernel, ell, cells.clone(), Truncation::Modes(count));
        for a in 0..count {
            for b in 0..=a {
                let product: f64 = body.iter().map(|&c| kl.mode(a)[c] * kl.mode(b)[c] * cells.area()).sum();
                prop_assert!((product - f64::from(u8::from(a == b))).abs() < 1e-12);
            }
        }
        if !gaussian {
            // neighbours along x: the mean covariance of intervals h that touch, by (1 - e^-q)²/q²
            let q = cells.size[0] / ell;
            let own = 2.0 * (q - 1.0 + (-q).exp()) / (q * q);
            let beside = ((1.0 - (-q).exp()) / q).powi(2);
            let [first, above, right] = [0, 1, 2 * n].map(|c| kl.at(c));
            let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            prop_assert!((product(&first, &first) - own * own).abs() < 1e-11);
            prop_assert!((product(&first, &above) - own * beside).abs() < 1e-11);
            prop_assert!((product(&first, &right) - own * beside).abs() < 1e-11);
        }
    }
}
