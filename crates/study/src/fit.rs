//! Laws of convergence fitted to errors.

/// Law of an error over the number N of unknowns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// C N^r.
    Algebraic,
    /// C exp(r N^½).
    SquareRoot,
    /// C exp(r N^⅓).
    CubeRoot,
}

impl Law {
    /// Its name in files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Algebraic => "algebraic",
            Self::SquareRoot => "square_root",
            Self::CubeRoot => "cube_root",
        }
    }

    /// The law with its rate, as a text.
    pub fn with_rate(self, rate: f64) -> String {
        match self {
            Self::Algebraic => format!("N^{rate:.2}"),
            Self::SquareRoot => format!("exp({rate:.3} N^1/2)"),
            Self::CubeRoot => format!("exp({rate:.3} N^1/3)"),
        }
    }

    fn abscissa(self, dofs: usize) -> f64 {
        let n = dofs as f64;
        match self {
            Self::Algebraic => n.ln(),
            Self::SquareRoot => n.sqrt(),
            Self::CubeRoot => n.cbrt(),
        }
    }
}

/// A law fitted by least squares to the logarithms of errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// The law.
    pub law: Law,
    /// Its r; negative if errors fall.
    pub rate: f64,
    /// 1 - Σ(y - fit)²/Σ(y - mean)², y the logarithms: 1 for a perfect fit.
    pub r_squared: f64,
    /// Number of fitted points.
    pub points: usize,
}

/// Fits a law to the later half of `(N, error)`, N rising: the points from the geometric mean of the smallest and the
/// largest N on, at least the last three. Errors that are not positive and finite are left out; None if fewer than
/// three are left.
pub fn fit(law: Law, errors: &[(usize, f64)]) -> Option<Fit> {
    let known: Vec<(usize, f64)> = errors.iter().copied().filter(|(_, e)| *e > 0.0 && e.is_finite()).collect();
    let middle = (known.first()?.0 as f64 * known.last()?.0 as f64).sqrt();
    let later = known.iter().filter(|(n, _)| *n as f64 >= middle * (1.0 - 1e-12)).count().max(3);
    let start = known.len().checked_sub(later)?;
    let points: Vec<[f64; 2]> = known[start..].iter().map(|&(n, e)| [law.abscissa(n), e.ln()]).collect();
    let mean = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / points.len() as f64);
    let product = |i: usize, j: usize| points.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum::<f64>();
    let (xx, xy, yy) = (product(0, 0), product(0, 1), product(1, 1));
    let rate = xy / xx;
    let r_squared = if yy > 0.0 { xy * xy / (xx * yy) } else { 1.0 };
    rate.is_finite().then_some(Fit { law, rate, r_squared, points: points.len() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ALL: [Law; 3] = [Law::Algebraic, Law::SquareRoot, Law::CubeRoot];

    fn errors(law: Law, rate: f64, factor: f64, dofs: &[usize]) -> Vec<(usize, f64)> {
        dofs.iter().map(|&n| (n, factor * (rate * law.abscissa(n)).exp())).collect()
    }

    proptest! {
        /// Each law is found with its rate, and fits its own errors better than the others do.
        #[test]
        fn a_law_is_found_in_its_own_errors(
            k in 0usize..3,
            rate in -1.5f64..-0.2,
            factor in 1e-3f64..1e3,
            steps in prop::collection::vec(1.1f64..2.0, 8..16),
        ) {
            let mut n = 30.0;
            let dofs: Vec<usize> = steps.iter().map(|s| { n *= s; n as usize }).collect();
            let data = errors(ALL[k], rate, factor, &dofs);
            let fits = ALL.map(|law| fit(law, &data).unwrap());
            prop_assert!((fits[k].rate - rate).abs() < 1e-9 && fits[k].r_squared > 1.0 - 1e-12, "{:?}", fits[k]);
            prop_assert!((0..3).all(|j| j == k || fits[j].r_squared < fits[k].r_squared), "{fits:?}");
        }
    }

    #[test]
    fn the_later_half_is_fitted_and_what_is_not_known_is_left_out() {
        let dofs = [32, 64, 128, 256, 512, 1024];
        let mut data = errors(Law::Algebraic, -0.5, 1.0, &dofs);
        // 32 * 1024 = 181²
        let of = |data: &[(usize, f64)]| fit(Law::Algebraic, data).map(|f| (f.points, (1e6 * f.rate).round() / 1e6));
        assert_eq!(of(&data), Some((3, -0.5)));
        (data[0].1, data[1].1, data[2].1) = (1e9, 1e-9, 7.0);
        assert_eq!(of(&data), Some((3, -0.5)));
        assert_ne!(of(&data[..5]), Some((3, -0.5)));
        (data[3].1, data[4].1) = (f64::NAN, 0.0);
        assert_eq!(of(&data[3..]), None);
        assert_eq!((of(&[]), of(&data[..1])), (None, None));
        // three errors at one N have no rate
        assert_eq!(of(&[(8, 1.0), (8, 2.0), (8, 3.0)]), None);
    }

    #[test]
    fn scatter_lowers_r_squared() {
        // logarithms 0, 1, 0, 1 at ln N = 0, 1, 2, 3 (rounded): slope 1/5, R² = 1/5
        let e = std::f64::consts::E;
        let found = fit(Law::Algebraic, &[(1000, 1.0), (2718, e), (7389, 1.0), (20086, e)]).unwrap();
        assert_eq!(found.points, 3);
        let all = fit(Law::Algebraic, &[(7389, e), (20086, 1.0), (54598, e)]).unwrap();
        assert!(all.rate.abs() < 1e-4 && all.r_squared < 1e-4, "{all:?}");
    }
}
