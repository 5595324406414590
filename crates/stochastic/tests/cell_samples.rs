//! Fields of cells that are drawn as a whole.

use steklov_stochastic::{
    CellKarhunenLoeve, CellSamples, Covariance, FieldCells, Kernel, StochasticError, Truncation, Variable, sample,
};

const KERNELS: [Kernel; 5] = [
    Kernel::Exponential,
    Kernel::Gaussian,
    Kernel::Matern { smoothness: 1.0 },
    Kernel::MATERN_32,
    Kernel::Matern { smoothness: 0.5 },
];

fn cells(cells: [usize; 2], size: [f64; 2]) -> FieldCells {
    FieldCells { cells, size, inside: None }
}

/// Covariance of all pairs of cells, by 20 000 outcomes, and its largest difference from another in standard errors.
fn sampled(samples: &CellSamples, expected: impl Fn(usize, usize) -> f64) -> f64 {
    let law = [Variable::normal(0.0, 1.0).unwrap()];
    let count = 20_000;
    let n = samples.cells().cells[0] * samples.cells().cells[1];
    let mut sums = vec![0.0; n * n];
    for k in 0..count {
        let values = samples.values(sample(&law, 2014, k)[0]);
        for i in 0..n {
            for j in 0..n {
                sums[i * n + j] += values[i] * values[j] / count as f64;
            }
        }
    }
    let off = |i: usize, j: usize| {
        let [a, b, c] = [expected(i, i), expected(j, j), expected(i, j)];
        (sums[i * n + j] - c).abs() / ((a * b + c * c) / count as f64).sqrt()
    };
    (0..n * n).map(|k| off(k / n, k % n)).fold(0.0, f64::max)
}

/// The covariance of outcomes is that of all modes of the means, up to sampling.
#[test]
fn outcomes_have_the_covariance_of_means() {
    for kernel in KERNELS {
        let covariance = Covariance { kernel, correlation: [0.6, 0.3] };
        let own = || cells([4, 3], [0.25, 0.2]);
        let samples = CellSamples::new(&covariance, own()).unwrap();
        // one cell left out makes the expansion one of cells
        let larger = FieldCells { inside: Some((0..20).map(|c| c != 19).collect()), ..cells([5, 4], [0.25, 0.2]) };
        let count = if kernel == Kernel::Gaussian { 15 } else { 19 };
        let modes = CellKarhunenLoeve::new(&covariance, larger, Truncation::Modes(count)).unwrap();
        let at = |c: usize| modes.at(c / 3 * 4 + c % 3);
        let expected = |i: usize, j: usize| at(i).iter().zip(at(j)).map(|(a, b)| a * b).sum::<f64>();
        let off = sampled(&samples, expected);
        println!("{kernel:?}: {off} standard errors at most of 78");
        assert!(off < 4.0, "{kernel:?}: {off}");
        let variance = expected(0, 0);
        let tolerance = if kernel == Kernel::Gaussian { 1e-3 } else { 1e-9 };
        assert!((1.0 - samples.unresolved() - variance).abs() < tolerance, "{kernel:?}: {variance}");
    }
}

/// Independent values are uncorrelated, of variance 1, and uniform ones bounded.
#[test]
fn independent_values_do_not_correlate() {
    for normal in [true, false] {
        let samples = CellSamples::independent(cells([3, 4], [1.0; 2]), normal).unwrap();
        let off = sampled(&samples, |i, j| f64::from(u8::from(i == j)));
        assert!(off < 4.0, "{off}");
        let most = samples.values(0.25).into_iter().fold(0.0f64, |m, v| m.max(v.abs()));
        assert!(normal || most <= 3f64.sqrt());
    }
    let few = CellKarhunenLoeve::independent(cells([3, 4], [0.5, 2.0])).unwrap();
    let germs: Vec<f64> = (0..12).map(|k| f64::from(k) - 5.0).collect();
    for (value, germ) in few.values(&germs).iter().zip(&germs) {
        assert!((value - germ).abs() < 1e-14);
    }
    assert!((few.captured() - 1.0).abs() < 1e-14 && few.unresolved() == 0.0);
}

/// An outcome depends on its germ alone, another germ gives another one, 0 the mean; larger cells have the means of their parts.
#[test]
fn outcomes_are_functions_of_their_germ() {
    let covariance = Covariance { kernel: Kernel::Exponential, correlation: [0.3; 2] };
    for samples in [
        CellSamples::new(&covariance, cells([8, 4], [0.1; 2])).unwrap(),
        CellSamples::independent(cells([8, 4], [0.1; 2]), false).unwrap(),
    ] {
        assert_eq!(samples.values(0.7), samples.values(0.7));
        assert_ne!(samples.values(0.7), samples.values(0.7f64.next_up()));
        assert!(samples.values(0.0).iter().all(|v| *v == 0.0));
        let (fine, coarse) = (samples.values(-1.3), samples.coarsened().unwrap().values(-1.3));
        for (c, value) in coarse.iter().enumerate() {
            let part = |k: usize| fine[(2 * (c / 2) + k / 2) * 4 + 2 * (c % 2) + k % 2];
            assert!((value - (0..4).map(part).sum::<f64>() / 4.0).abs() < 1e-14);
        }
        let two = samples.coarsened().and_then(|s| s.coarsened()).unwrap();
        assert!(two.cells().cells == [2, 1] && two.coarsened().is_none());
        assert!(two.unresolved() > samples.unresolved() + 0.05);
    }
}

/// Means of drawn cells over larger ones have the covariance of means over those, and so have values drawn on larger cells.
#[test]
fn larger_cells_have_one_law() {
    // drawn cells know nothing of the kernel but its torus
    for kernel in [Kernel::Exponential, Kernel::Gaussian, Kernel::MATERN_32] {
        let covariance = Covariance { kernel, correlation: [0.6, 0.3] };
        let coarse = CellSamples::new(&covariance, cells([8, 4], [0.125; 2])).unwrap().coarsened().unwrap();
        let own = coarse.redrawn().expect("a torus of larger cells");
        assert!(own.redrawn().is_none() && own.cells().size == coarse.cells().size);
        assert!((own.unresolved() - coarse.unresolved()).abs() < 1e-15);
        // by means of pairs of points, a 16 × 16 rule in each cell of ¼: of the distance d there are 16 - |d| pairs along each axis
        let mean = |i: usize, j: usize| {
            let along = |a: usize, b: usize| {
                (-15i32..=15)
                    .map(move |d| (f64::from(16 - d.abs()), 0.25 * (a as f64 - b as f64 + f64::from(d) / 16.0)))
            };
            let [x, y] = [along(i / 2, j / 2), along(i % 2, j % 2)];
            let pairs = x.flat_map(|(n, x)| y.clone().map(move |(m, y)| (n * m, x, y)));
            pairs.map(|(n, x, y)| n * covariance.on_rectangle(x, y)).sum::<f64>() / 256f64.powi(2)
        };
        let from_first: Vec<f64> = (0..8).map(|c| mean(0, c)).collect();
        let expected = |i: usize, j: usize| from_first[(i / 2).abs_diff(j / 2) * 2 + (i % 2).abs_diff(j % 2)];
        for (samples, name) in [(&coarse, "means"), (&own, "redrawn")] {
            let off = sampled(samples, expected);
            println!("{kernel:?}, {name}: {off} standard errors at most of 36");
            assert!(off < 4.0, "{kernel:?} {name}: {off}");
        }
    }
    let uniform = CellSamples::independent(cells([4, 4], [1.0; 2]), false).unwrap();
    assert!(uniform.coarsened().unwrap().redrawn().is_none(), "means of uniform values are not uniform");
}

/// Smooth fields of long correlation take larger tori, or have none.
#[test]
fn tori_that_have_no_covariance_are_refused() {
    let new = |kernel, ell: f64| {
        let covariance = Covariance { kernel, correlation: [ell; 2] };
        CellSamples::new(&covariance, cells([16; 2], [1.0 / 16.0; 2])).map(|_| ())
    };
    for kernel in KERNELS {
        assert_eq!(new(kernel, 0.5), Ok(()), "{kernel:?}");
    }
    let refused = new(Kernel::Gaussian, 50.0);
    assert!(matches!(refused, Err(StochasticError::Embedding { times: 16 })), "{refused:?}");
    assert!(matches!(new(Kernel::Exponential, 0.0), Err(StochasticError::Number { .. })));
}
