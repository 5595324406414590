//! Which elements are refined, and whether their solution is smooth.

use crate::{Mesh, Space};

/// Indicators that differ by less than this part are equal, so that rounding breaks no symmetry.
const TIE: f64 = 1e-6;

/// Marks the smallest set of elements with Σ η² ≥ θ times the whole, and those whose η² equals that of the last of them. A
/// marked element gets its η over the smallest marked one.
///
/// Source: Dörfler, *A convergent adaptive algorithm for Poisson's equation*, SIAM J. Numer. Anal. 33 (1996), with η² for
/// η.
///
/// # Panics
/// If an indicator is NaN.
pub fn doerfler(squared: &[f64], theta: f64) -> Vec<Option<f64>> {
    assert!(squared.iter().all(|e| !e.is_nan()), "an indicator is NaN");
    let mut order: Vec<f64> = squared.to_vec();
    order.sort_by(|a, b| b.total_cmp(a));
    let whole: f64 = order.iter().sum();
    let mut sum = 0.0;
    let last = order.iter().find(|&&e| {
        sum += e;
        sum >= theta * whole
    });
    let last = last.copied().unwrap_or(0.0);
    squared.iter().map(|&e| (e >= last * (1.0 - TIE) && e > 0.0).then(|| (e / last).sqrt().max(1.0))).collect()
}

/// exp(-m) of a displacement on element e: the rate at which its Legendre coefficients fall, |a_i| ~ exp(-(m i + b)), fitted
/// over i = 1..=p to each of the components along n and t; the larger of the two, except a component whose coefficients are
/// below a thousandth of the other's. None with fewer than two coefficients above the roundoff of the displacement (always for
/// p = 1).
///
/// a_0, a translation, does not count, and the fit does not depend on units or directions.
///
/// Source: Mavriplis, *Adaptive mesh strategies for the spectral element method*, 1994; Houston and Süli, 2005.
pub fn legendre_decay(mesh: &Mesh, space: &Space, e: usize, displacement: &[f64]) -> Option<f64> {
    let basis = space.basis(e);
    let (n, t) = (mesh.normal(e, 0.0), mesh.tangent(e, 0.0));
    let coefficients = |d: [f64; 2]| -> Vec<f64> {
        let coefficient = |i: usize| -> f64 {
            let nodes = space.element_nodes(e).enumerate();
            nodes
                .map(|(j, k)| basis.to_legendre[(i, j)] * (d[0] * displacement[2 * k] + d[1] * displacement[2 * k + 1]))
                .sum()
        };
        (1..=basis.degree).map(coefficient).collect()
    };
    let components = [coefficients(n), coefficients(t)];
    let largest = components.iter().flatten().fold(0.0, |m: f64, a| m.max(a.abs()));
    let values = space.element_nodes(e).flat_map(|k| [displacement[2 * k], displacement[2 * k + 1]]);
    let roundoff = 1e-14 * values.fold(0.0, |m: f64, u| m.max(u.abs()));
    let mut slowest: Option<f64> = None;
    for a in &components {
        let peak = a.iter().fold(0.0, |m: f64, a| m.max(a.abs()));
        let points: Vec<(f64, f64)> = (1..)
            .zip(a)
            .filter(|(_, a)| a.abs() > roundoff)
            .map(|(i, a)| (f64::from(i), (a.abs() / largest).ln()))
            .collect();
        if peak < 1e-3 * largest || points.len() < 2 {
            continue;
        }
        let count = points.len() as f64;
        let (x, y) = points.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0 / count, s.1 + p.1 / count));
        let (xy, xx) = points.iter().fold((0.0, 0.0), |s, p| (s.0 + (p.0 - x) * (p.1 - y), s.1 + (p.0 - x).powi(2)));
        slowest = Some(slowest.unwrap_or(0.0).max((xy / xx).exp()));
    }
    slowest
}
