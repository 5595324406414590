//! Legendre polynomials, their derivatives and finite Legendre series.

use crate::Rule;

/// P_n(x) for n = 0..`out.len()`.
///
/// Accurate to a few 1e-16 on all of [-1,1]: the recurrence (n+1) P_{n+1} = (2n+1) x P_n - n P_{n-1} is run in terms of
/// 1-|x|, as P_{n+1} = P_n + d_{n+1}, (n+1) d_{n+1} = n d_n - (2n+1) (1-|x|) P_n. In x itself it would lose n² units next
/// to the ends.
pub fn legendre_p(x: f64, out: &mut [f64]) {
    out.iter_mut().zip(values(x)).for_each(|(value, p)| *value = p);
}

/// P_0(x), P_1(x), ..
fn values(x: f64) -> impl Iterator<Item = f64> {
    let distance = 1.0 - x.abs();
    let side = 1f64.copysign(x);
    let (mut p, mut nd, mut sign) = (1.0, 0.0, 1.0);
    (0u32..).map(move |n| {
        let value = sign * p;
        nd -= (2.0 * f64::from(n) + 1.0) * distance * p;
        p += nd / (f64::from(n) + 1.0);
        sign *= side;
        value
    })
}

/// P_n(x) and P_n'(x) for n = 0..`p.len()`; P'_{n+1} = P'_{n-1} + (2n+1) P_n.
///
/// # Panics
/// If the slices differ in length.
pub fn legendre_dp(x: f64, p: &mut [f64], dp: &mut [f64]) {
    assert_eq!(p.len(), dp.len(), "values and derivatives must have one length");
    legendre_p(x, p);
    for n in 0..dp.len() {
        dp[n] = match n {
            0 => 0.0,
            1 => 1.0,
            _ => dp[n - 2] + (2 * n - 1) as f64 * p[n - 1],
        };
    }
}

/// Legendre series f(x) = Σ_n a_n P_n(x); no coefficients mean f = 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Coefficients a_n, n = 0, 1, ..
    pub coefficients: Vec<f64>,
}

impl Series {
    /// f(x), summed upwards with the values of [`legendre_p`].
    pub fn eval(&self, x: f64) -> f64 {
        self.coefficients.iter().zip(values(x)).map(|(a, p)| a * p).sum()
    }

    /// f' as a series of one coefficient less: d_m = (2m+1) Σ a_n over n > m with n-m odd.
    pub fn derivative(&self) -> Series {
        let mut d = vec![0.0; self.coefficients.len().saturating_sub(1)];
        let mut sums = [0.0; 2];
        for m in (0..d.len()).rev() {
            sums[m % 2] += self.coefficients[m + 1];
            d[m] = (2 * m + 1) as f64 * sums[m % 2];
        }
        Series { coefficients: d }
    }

    /// ∫_{-1}^1 f dx = 2 a_0.
    pub fn integral(&self) -> f64 {
        2.0 * self.coefficients.first().unwrap_or(&0.0)
    }

    /// L² norm over [-1,1], (Σ 2 a_n²/(2n+1))^½.
    pub fn norm(&self) -> f64 {
        self.coefficients.iter().enumerate().map(|(n, a)| 2.0 * a * a / (2 * n + 1) as f64).sum::<f64>().sqrt()
    }
}

/// L² projection of f to polynomials of a degree: a_n = (2n+1)/2 ∫_{-1}^1 f P_n dx, n = 0..=degree, by `rule`.
///
/// Exact for a polynomial f if `rule.degree` is at least `degree` plus the degree of f.
pub fn project(mut f: impl FnMut(f64) -> f64, degree: usize, rule: &Rule) -> Series {
    let mut a = vec![0.0; degree + 1];
    for (&x, w) in rule.points.iter().zip(&rule.weights) {
        let wf = w * f(x);
        for (n, (sum, p)) in a.iter_mut().zip(values(x)).enumerate() {
            *sum += (2 * n + 1) as f64 / 2.0 * wf * p;
        }
    }
    Series { coefficients: a }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gauss_legendre;
    use proptest::prelude::*;

    const TOP: usize = 64;

    /// P_64(x) and P_64'(x) by mpmath with 60 digits at exact binary x, by the recurrence in x.
    const TRUTH: [(f64, f64, f64); 6] = [
        (0.0, 0.09934675374796689, 0.0),
        (0.3, 0.07059414327358907, -4.939993558538855),
        (-0.75, -0.03324883805640982, -11.434180335216507),
        (0.99, -0.1212108697302809, 104.54954578218053),
        (-0.9995, 0.20102376816940906, -1170.675600605813),
        (0.999999, 0.9979210808304834, 2077.838588338311),
    ];

    #[test]
    fn values_of_60_digits() {
        for (x, value, slope) in TRUTH {
            let (mut p, mut dp) = ([0.0; TOP + 1], [0.0; TOP + 1]);
            legendre_dp(x, &mut p, &mut dp);
            assert!((p[TOP] - value).abs() < 2e-15, "P({x}) = {}", p[TOP]);
            assert!((dp[TOP] - slope).abs() < 2e-15 * (slope.abs() + 64.0), "P'({x}) = {}", dp[TOP]);
        }
    }

    #[test]
    fn known_values() {
        for (x, sign) in [(1.0, 1.0), (-1.0, -1f64)] {
            let (mut p, mut dp) = ([0.0; TOP + 1], [0.0; TOP + 1]);
            legendre_dp(x, &mut p, &mut dp);
            for n in 0..=TOP {
                assert_eq!(p[n], sign.powi(n as i32));
                assert_eq!(dp[n], sign.powi(n as i32 + 1) * (n * (n + 1)) as f64 / 2.0);
            }
        }
        let mut p = [0.0; 5];
        legendre_p(0.5, &mut p);
        assert_eq!(p, [1.0, 0.5, -0.125, -0.4375, -0.2890625]);
        legendre_p(0.5, &mut []);
    }

    proptest! {
        /// |P_n| ≤ 1 and the differential relation (x²-1) P_n' = n (x P_n - P_{n-1}).
        #[test]
        fn relation_of_values_and_slopes(x in -1.0..=1.0f64) {
            let (mut p, mut dp) = ([0.0; TOP + 1], [0.0; TOP + 1]);
            legendre_dp(x, &mut p, &mut dp);
            for n in 1..=TOP {
                prop_assert!(p[n].abs() <= 1.0 + 1e-15);
                let nf = n as f64;
                prop_assert!(((x - 1.0) * (x + 1.0) * dp[n] - nf * (x * p[n] - p[n - 1])).abs() < 2e-15 * nf);
            }
        }

        /// A projected series gives its coefficients back if the rule's degree is just enough, and not if it is less.
        #[test]
        fn projection(a in prop::collection::vec(-1.0..1.0f64, 1..30), missing in 1usize..3) {
            let series = Series { coefficients: a.clone() };
            let degree = a.len() - 1;
            let found = project(|x| series.eval(x), degree, &gauss_legendre(degree + 1));
            for n in 0..=degree {
                prop_assert!((found.coefficients[n] - a[n]).abs() < 4e-15 * (2 * n + 1) as f64);
            }
            prop_assert!((series.norm().powi(2) - gauss_legendre(degree + 1).integrate(|x| series.eval(x).powi(2))).abs() < 1e-13);
            if degree > missing && a[degree].abs() > 0.1 {
                let poor = project(|x| series.eval(x), degree, &gauss_legendre(degree + 1 - missing));
                prop_assert!((0..=degree).any(|n| (poor.coefficients[n] - a[n]).abs() > 1e-6));
            }
        }

        /// Σ a_n P_n' equals the derivative's series; ∫ f' = f(1) - f(-1).
        #[test]
        fn derivative(a in prop::collection::vec(-1.0..1.0f64, 0..=TOP + 1), x in -1.0..=1.0f64) {
            let series = Series { coefficients: a.clone() };
            let slope = series.derivative();
            prop_assert_eq!(slope.coefficients.len(), a.len().saturating_sub(1));
            let (mut p, mut dp) = (vec![0.0; a.len()], vec![0.0; a.len()]);
            legendre_dp(x, &mut p, &mut dp);
            let expected: f64 = a.iter().zip(&dp).map(|(a, d)| a * d).sum();
            let scale: f64 = 1.0 + slope.coefficients.iter().map(|d| d.abs()).sum::<f64>();
            prop_assert!((slope.eval(x) - expected).abs() < 1e-14 * scale);
            prop_assert!((slope.integral() - series.eval(1.0) + series.eval(-1.0)).abs() < 1e-14 * scale);
        }
    }
}
