use super::*;
use crate::proptest::off_cut;
use crate::{End, gauss_legendre, graded, legendre_p};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

const TOP: usize = 64;

fn at(z: Complex64) -> Vec<Complex64> {
    let mut q = vec![Complex64::ZERO; TOP + 1];
    legendre_q_at(z, &mut q);
    q
}

fn of(zm1: Complex64, zp1: Complex64, degree: usize) -> Vec<Complex64> {
    let mut q = vec![Complex64::ZERO; degree + 1];
    legendre_q(zm1, zp1, &mut q);
    q
}

/// P_0(z), .., P_degree(z) by P_{k+1} = P_k + d_{k+1}, (k+1) d_{k+1} = k d_k + (2k+1) (z-1) P_k, reflected for Re z < 0.
fn complex_p(zm1: Complex64, zp1: Complex64, degree: usize) -> Vec<Complex64> {
    let (delta, side) = if zm1.re + zp1.re < 0.0 { (-zp1, -1.0f64) } else { (zm1, 1.0) };
    let (mut p, mut kd) = (vec![Complex64::ONE], Complex64::ZERO);
    for k in 0..degree {
        kd += (2 * k + 1) as f64 * delta * p[k];
        p.push(p[k] + kd / (k + 1) as f64);
    }
    p.iter().enumerate().map(|(k, p)| side.powi(k as i32) * p).collect()
}

/// Degrees n = 1..=degree whose Q_n is not next to underflow.
fn normal_degrees(log_rho: f64, degree: usize) -> impl Iterator<Item = usize> {
    (1..=degree).filter(move |&n| (n + 1) as f64 * log_rho < 600.0)
}

enum From {
    Minus,
    Plus,
    Point,
}

type Row = (From, f64, f64, [(usize, f64, f64); 4]);

/// Q_n from mpmath with 1500 digits: Q_0 = ½ log((z+1)/(z-1)) and the forward recurrence; each Q_0 was compared with
/// ½∫dt/(z-t). The pair of numbers is z-1, z+1 or z itself; then n, Re Q_n, Im Q_n.
const TRUTH: &[Row] = {
    use From::*;
    &[
        (
            Minus,
            1e-12,
            1e-12,
            [
                (0, 13.988797353104511, -0.3926990816984742),
                (1, 12.988797353118892, -0.39269908168487805),
                (7, 11.395940210605449, -0.3926990813623834),
                (64, 9.244906471524962, -0.3926990612058828),
            ],
        ),
        (
            Minus,
            -1e-12,
            1e-15,
            [
                (0, 14.162083898244122, -1.5702963269615628),
                (1, 13.16208389822996, -1.5702963269599786),
                (7, 11.569226755035084, -1.5702963269172427),
                (64, 9.418192972871777, -1.5702963236736767),
            ],
        ),
        (
            Plus,
            1e-12,
            -2e-12,
            [
                (0, -13.759724670135471, 1.0172219678973513),
                (1, 12.759724670123747, -1.0172219678688148),
                (7, 11.16686752699462, -1.0172219671875247),
                (64, -9.015833749828412, 1.0172219241156613),
            ],
        ),
        (
            Plus,
            -3e-09,
            1e-12,
            [
                (0, -10.158900337391348, -0.00016666666024382757),
                (1, 9.158900367868048, 0.0001666666505849272),
                (7, 7.5660439140818525, 0.0001666664343946076),
                (64, -5.415049463412072, -0.00016665435698093293),
            ],
        ),
        (
            Point,
            0.3,
            1e-10,
            [
                (0, 0.3095196042031117, -1.5707963266850065),
                (1, -0.9071441185819868, -0.47123889797455),
                (7, -0.3084459355889393, 0.3519730155990277),
                (64, 0.11503093056394775, -0.11088902019569648),
            ],
        ),
        (
            Point,
            0.3,
            0.001,
            [
                (0, 0.309519241928501, -1.5696974262577645),
                (1, -0.905574529995192, -0.47059970863540085),
                (7, -0.30608132896365775, 0.3491600562783747),
                (64, 0.10752595548984961, -0.10362240080142729),
            ],
        ),
        (
            Point,
            -0.2,
            0.0117,
            [
                (0, -0.20270285161112855, -1.5586095025541493),
                (1, -0.9412236984978908, 0.30935027714697966),
                (7, 0.023687203791351134, -0.4214830714113346),
                (64, -0.029883241312889244, -0.06657851210505372),
            ],
        ),
        (
            Point,
            0.5,
            0.0125,
            [
                (0, 0.549167303650167, -1.5541323597653687),
                (1, -0.7059896936778494, -0.7702015885870572),
                (7, -0.3073468135109172, -0.3155635880604185),
                (64, 0.04666978908813532, 0.0468011328939999),
            ],
        ),
        (
            Point,
            -1.01,
            0.0,
            [
                (0, -2.6516524540295374, 0.0),
                (1, 1.6781689785698328, 0.0),
                (7, 0.38572818291505845, 0.0),
                (64, -4.50378162156013e-05, 0.0),
            ],
        ),
        (
            Point,
            1.0,
            0.05,
            [
                (0, 1.8445959282491786, -0.7729007665879882),
                (1, 0.8832409665785781, -0.6806709701755292),
                (7, -0.06597433112606901, -0.12971426622355534),
                (64, -8.237554078034976e-08, -1.1547665118290312e-07),
            ],
        ),
        (
            Point,
            -1.3,
            -0.4,
            [
                (0, -0.7704774924487608, 0.37755220173933657),
                (1, 0.15264162087912372, -0.18262686528163324),
                (7, -0.0005565695090513349, 0.00011347538606828489),
                (64, -1.7821686049263214e-28, 2.5189475924438048e-26),
            ],
        ),
        (
            Point,
            0.0,
            2.0,
            [
                (0, 0.0, -0.4636476090008061),
                (1, -0.07270478199838777, 0.0),
                (7, 5.984253499160388e-06, 0.0),
                (64, 0.0, -3.790313331789063e-42),
            ],
        ),
        (
            Point,
            40.0,
            -25.0,
            [
                (0, 0.017977194409590138, 0.011239113879856351),
                (1, 6.562338001433988e-05, 0.00013469495450060793),
                (7, -2.4394861340731195e-17, -9.851673582764962e-17),
                (64, 1.815820273596747e-130, -9.583391931209888e-130),
            ],
        ),
        (
            Point,
            10000.0,
            10000.0,
            [
                (0, 4.9999999916666665e-05, -5.000000008333333e-05),
                (1, -4.9999999999999996e-18, -1.6666666666666667e-09),
                (7, 1.554001554001554e-36, -1.6454134101192924e-44),
                (64, 6.950464361900126e-291, -6.950465499972437e-291),
            ],
        ),
        (
            Point,
            -1000000.0,
            3.0,
            [
                (0, -9.999999999913333e-07, -2.999999999976e-12),
                (1, 3.3333333332453334e-13, 1.9999999999664e-18),
                (7, 2.4864024856021572e-51, 5.9673659665761685e-56),
                (64, 0.0, 0.0),
            ],
        ),
    ]
};

#[test]
fn values_of_1500_digits() {
    for (from, re, im, values) in TRUTH {
        let w = Complex64::new(*re, *im);
        let (zm1, zp1) = match from {
            From::Minus => (w, w + 2.0),
            From::Plus => (w - 2.0, w),
            From::Point => (w - 1.0, w + 1.0),
        };
        // Several lengths: the choice between forward and backward depends on the highest degree.
        for degree in [7, 20, TOP] {
            let q = of(zm1, zp1, degree);
            for &(n, re, im) in values.iter().filter(|v| v.0 <= degree) {
                let truth = Complex64::new(re, im);
                let error = (q[n] - truth).norm() / truth.norm().max(1e-300);
                assert!(error < 1e-14, "Q_{n}({w}) of {degree}: {error:e}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// n (P_n Q_{n-1} - P_{n-1} Q_n) = 1.
    #[test]
    fn casoratian((log_rho, zm1, zp1) in off_cut(), degree in 1..=TOP) {
        let (q, p) = (of(zm1, zp1, degree), complex_p(zm1, zp1, degree));
        for n in normal_degrees(log_rho, degree) {
            let (a, b) = (p[n] * q[n - 1], p[n - 1] * q[n]);
            let scale = n as f64 * (a.norm() + b.norm());
            prop_assert!((n as f64 * (a - b) - 1.0).norm() < 2e-14 * scale, "n {}: {:e}", n, (n as f64 * (a - b) - 1.0).norm()/scale);
        }
    }

    #[test]
    fn recurrence((log_rho, zm1, zp1) in off_cut(), degree in 2..=TOP) {
        let (q, z) = (of(zm1, zp1, degree), 0.5 * (zm1 + zp1));
        for k in normal_degrees(log_rho, degree - 1) {
            let kf = k as f64;
            let terms = [(kf + 1.0) * q[k + 1], -(2.0 * kf + 1.0) * z * q[k], kf * q[k - 1]];
            let scale: f64 = terms.iter().map(|t| t.norm()).sum();
            prop_assert!(terms.iter().sum::<Complex64>().norm() <= 1e-15 * scale, "k {}: {:e}", k, terms.iter().sum::<Complex64>().norm()/scale);
        }
    }

    /// Q_n(z̄) is the conjugate, Q_n(-z) = (-1)^(n+1) Q_n(z).
    #[test]
    fn reflections((_, zm1, zp1) in off_cut(), degree in 0..=TOP) {
        let q = of(zm1, zp1, degree);
        let (conjugate, opposite) = (of(zm1.conj(), zp1.conj(), degree), of(-zp1, -zm1, degree));
        for n in 0..=degree {
            let sign = if n % 2 == 0 { -1.0 } else { 1.0 };
            prop_assert_eq!(conjugate[n], q[n].conj());
            prop_assert_eq!(opposite[n], sign * q[n]);
        }
    }

    /// Q'_{n+1} - Q'_{n-1} = (2n+1) Q_n and Q_1' = Q_0 + z Q_0'.
    #[test]
    fn derivatives((log_rho, zm1, zp1) in off_cut(), degree in 1..=TOP) {
        let (q, z) = (of(zm1, zp1, degree), 0.5 * (zm1 + zp1));
        let mut dq = vec![Complex64::ZERO; degree + 1];
        legendre_dq(zm1, zp1, &q, &mut dq);
        let scale = q[0].norm() + (z * dq[0]).norm();
        prop_assert!((dq[1] - q[0] - z * dq[0]).norm() < 1e-14 * scale, "Q1' {:e}", (dq[1] - q[0] - z * dq[0]).norm()/scale);
        for n in normal_degrees(log_rho, degree - 1) {
            let terms = [dq[n + 1], -dq[n - 1], -((2 * n + 1) as f64) * q[n]];
            let scale: f64 = terms.iter().map(|t| t.norm()).sum();
            prop_assert!(terms.iter().sum::<Complex64>().norm() < 1e-13 * scale, "n {}: {:e}", n, terms.iter().sum::<Complex64>().norm()/scale);
        }
    }

    /// ∫ P_n(t)/(z-t) dt = 2 Q_n(z), by Gauss panels graded on both sides of Re z down to the distance to the cut.
    #[test]
    fn integral(x in -1.2..1.2f64, height in -3.0..1.0f64) {
        let z = Complex64::new(x, 10f64.powf(height));
        let panels = graded(&gauss_legendre(60), 8, 0.35, End::Both);
        let split = x.clamp(-1.0, 1.0);
        let q = at(z);
        let mut p = [0.0; TOP + 1];
        let mut sum = vec![Complex64::ZERO; TOP + 1];
        let mut scale = 0.0;
        for (a, b) in [(-1.0, split), (split, 1.0)] {
            let rule = panels.mapped(a, b);
            for (&t, &w) in rule.points.iter().zip(&rule.weights) {
                legendre_p(t, &mut p);
                let kernel = w / (z - t);
                scale += kernel.norm();
                sum.iter_mut().zip(&p).for_each(|(s, p)| *s += kernel * p);
            }
        }
        for n in 0..=TOP {
            prop_assert!((sum[n] - 2.0 * q[n]).norm() < 2e-14 * scale, "n {}: {:e}", n, (sum[n] - 2.0 * q[n]).norm()/scale);
        }
    }

    #[test]
    fn bernstein_parameter((log_rho, zm1, zp1) in off_cut()) {
        let found = log_bernstein(zm1, zp1);
        prop_assert!((found - log_rho).abs() < 1e-14 * log_rho, "{:e}", (found - log_rho).abs()/log_rho);
        let rho = bernstein(0.5 * (zm1 + zp1));
        // From z alone, an error of 1e-16 in z next to ±1 is one of 1e-8 in ϱ.
        prop_assert!((rho - log_rho.exp()).abs() < 1e-7 * rho);
    }

    /// Q_n(x ± i0) = Q_n(x) ∓ iπ/2 P_n(x), with zero and with tiny imaginary parts.
    #[test]
    fn limits_at_the_cut(x in -0.999..0.999f64, im in prop::sample::select(vec![0.0, 1e-300, 1e-30])) {
        let (mut p, mut cut) = ([0.0; TOP + 1], [0.0; TOP + 1]);
        legendre_p(x, &mut p);
        legendre_q_cut(x, &mut cut);
        for side in [1.0, -1.0] {
            let q = at(Complex64::new(x, side * im));
            for n in 0..=TOP {
                let limit = Complex64::new(cut[n], -side * FRAC_PI_2 * p[n]);
                prop_assert!((q[n] - limit).norm() < 1e-14 * (1.0 + cut[0].abs()), "n {}: {:e}", n, (q[n] - limit).norm());
            }
        }
    }

    /// On the cut: n (P_n Q_{n-1} - P_{n-1} Q_n) = 1, oddness, and Q_0 = artanh x also right next to the ends.
    #[test]
    fn on_the_cut(exponent in -15.0..0.0f64) {
        let d = 10f64.powf(exponent);
        let (mut p, mut q, mut mirror) = ([0.0; TOP + 1], [0.0; TOP + 1], [0.0; TOP + 1]);
        legendre_p(1.0 - d, &mut p);
        legendre_q_cut_from(d, 2.0 - d, &mut q);
        legendre_q_cut_from(2.0 - d, d, &mut mirror);
        let artanh = 0.5 * ((2.0 - d).ln() - d.ln());
        prop_assert!((q[0] - artanh).abs() < 1e-15 * (1.0 + artanh));
        for n in 0..=TOP {
            prop_assert_eq!(mirror[n], if n % 2 == 0 { -q[n] } else { q[n] });
            if n > 0 {
                let one = n as f64 * (p[n] * q[n - 1] - p[n - 1] * q[n]);
                prop_assert!((one - 1.0).abs() < 1e-14 * n as f64 * (1.0 + q[0]), "n {}: {:e}", n, (one - 1.0).abs());
            }
        }
    }
}

/// Q_2 = P_2 Q_0 - 3z/2, Q_3 = P_3 Q_0 - 5z²/2 + 2/3 where these do not cancel.
#[test]
fn closed_forms() {
    for k in 0..64 {
        let z = 0.9 * Complex64::cis(PI * (f64::from(k) + 0.5) / 32.0);
        let (q, p) = (at(z), complex_p(z - 1.0, z + 1.0, 3));
        let q0 = 0.5 * ((z + 1.0) / (z - 1.0)).ln();
        let forms = [q0, z * q0 - 1.0, p[2] * q0 - 1.5 * z, p[3] * q0 - 2.5 * z * z + 2.0 / 3.0];
        for n in 0..4 {
            assert!((q[n] - forms[n]).norm() < 4e-15, "{z} {n} {:e}", (q[n] - forms[n]).norm());
        }
    }
}

/// All four signs of zero on the axes beside the cut: one value, positive ϱ > 1, no 1/ϱ.
#[test]
fn signed_zeros() {
    for x in [1.0 + 1e-9, 1.5, 40.0] {
        let q = at(Complex64::new(x, 0.0));
        for (sx, im) in [(1.0, -0.0), (-1.0, 0.0), (-1.0, -0.0)] {
            let z = Complex64::new(sx * x, im);
            assert_eq!(bernstein(z), bernstein(Complex64::new(x, 0.0)));
            for (n, value) in at(z).iter().enumerate() {
                assert_eq!(value.re, if n % 2 == 0 { sx * q[n].re } else { q[n].re });
                assert_eq!(value.im, 0.0);
            }
        }
        assert!((bernstein(Complex64::new(-x, -0.0)) / (x + ((x - 1.0) * (x + 1.0)).sqrt()) - 1.0).abs() < 1e-15);
    }
    for y in [1e-9, 0.5, 40.0] {
        assert_eq!(bernstein(Complex64::new(-0.0, -y)), bernstein(Complex64::new(0.0, y)));
        assert_eq!(at(Complex64::new(-0.0, y))[0].re, 0.0);
    }
}

#[test]
fn empty_and_infinite_inputs_end() {
    legendre_q_at(Complex64::new(2.0, 0.0), &mut []);
    legendre_q_cut(0.5, &mut []);
    assert!(!at(Complex64::new(1.0, 0.0))[0].is_finite());
    assert!(at(Complex64::new(f64::NAN, 0.0)).iter().all(|q| q.is_nan()));
    // Q_n = n!/(2n+1)!! z^-(n+1) far away, 0 where that is too small for a number.
    for size in [1e9, 1e40, 1e50] {
        let q = at(Complex64::new(0.0, size));
        assert!((q[0].im * size + 1.0).abs() < 1e-15, "{size}: {}", q[0]);
        assert!((q[1].re * size * size * 3.0 + 1.0).abs() < 4e-15, "{size}: {}", q[1]);
        assert!(q.iter().all(|q| q.is_finite()) && q[TOP] == Complex64::ZERO);
    }
}
