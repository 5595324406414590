//! Quadrature rules.

use pyo3::prelude::*;
use steklov_quadrature::{End, gauss_jacobi, gauss_legendre, gauss_lobatto, graded, graded_unit, substituted};

use crate::blocks::{array, unknown, work, wrong};

/// Most points of a rule, and of one whose points are eigenvalues of a full matrix.
const MOST: usize = 1_000_000;
const MOST_EIGENVALUES: usize = 1000;
/// Largest exponent of a Jacobi weight.
const EXPONENT: f64 = 50.0;

/// Points, weights and degree of a rule of n points, n a panel for graded ones: with the exponents of a Jacobi weight, the layers, ratio
/// and end of a graded rule, and the power of a logarithmic one; each kind looks at its own.
#[pyfunction]
pub fn rule<'py>(
    py: Python<'py>,
    kind: &str,
    n: usize,
    exponents: [f64; 2],
    grading: (usize, f64, String),
    power: u32,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>, usize)> {
    let ([alpha, beta], (layers, ratio, end)) = (exponents, grading);
    let by_eigenvalues = matches!(kind, "lobatto" | "jacobi");
    let (least, most) = (if kind == "lobatto" { 2 } else { 1 }, if by_eigenvalues { MOST_EIGENVALUES } else { MOST });
    if !(least..=most).contains(&n) {
        return Err(wrong(py, format!("n is {n}: the rule {kind:?} takes {least} to {most} points")));
    }
    match kind {
        "jacobi" => check_jacobi(py, [alpha, beta])?,
        "graded" => check_graded(py, n, layers, ratio)?,
        "logarithmic" => check_logarithmic(py, n, power)?,
        _ => {}
    }
    let made = work(py, || {
        Some(match kind {
            "gauss" => gauss_legendre(n),
            "lobatto" => gauss_lobatto(n),
            "jacobi" => gauss_jacobi(n, alpha, beta),
            "graded" => match end.as_str() {
                "left" => graded(&gauss_legendre(n), layers, ratio, End::Left),
                "right" => graded(&gauss_legendre(n), layers, ratio, End::Right),
                "both" => graded(&gauss_legendre(n), layers, ratio, End::Both),
                "zero" => graded_unit(&gauss_legendre(n), layers, ratio),
                _ => return None,
            },
            "logarithmic" => substituted(n, power),
            _ => return None,
        })
    })?;
    let Some(rule) = made else { return Err(unknown(py, "kind of rule with this end", kind)) };
    if rule.points.iter().chain(&rule.weights).any(|x| !x.is_finite()) {
        return Err(wrong(
            py,
            format!("n is {n}: the weights of the rule {kind:?} leave the range of numbers, take fewer points"),
        ));
    }
    let count = rule.len();
    Ok((array(py, rule.points, &[count])?, array(py, rule.weights, &[count])?, rule.degree))
}

fn check_jacobi(py: Python<'_>, exponents: [f64; 2]) -> PyResult<()> {
    for (name, exponent) in ["alpha", "beta"].into_iter().zip(exponents) {
        if !(exponent > -1.0 && exponent <= EXPONENT) {
            let what = format!("{name} is {exponent}: exponents of the weight are above -1 and at most {EXPONENT}");
            return Err(wrong(py, what));
        }
    }
    Ok(())
}

fn check_graded(py: Python<'_>, n: usize, layers: usize, ratio: f64) -> PyResult<()> {
    if !(ratio > 0.0 && ratio < 1.0) {
        return Err(wrong(py, format!("ratio is {ratio}: the panels shrink by a factor above 0 and below 1")));
    }
    let smallest = ratio.powf(layers as f64);
    if smallest < 1e-290 || n.saturating_mul(layers.saturating_add(1)) > MOST {
        let what = format!("layers is {layers}: the last panel would have the length {smallest:e}, take fewer layers");
        return Err(wrong(py, what));
    }
    Ok(())
}

fn check_logarithmic(py: Python<'_>, n: usize, power: u32) -> PyResult<()> {
    if power == 0 || power > 15 || 2 * n < power as usize {
        return Err(wrong(py, format!("power is {power}: it is 1 to 15 and at most 2 n, of use are 5 and 7")));
    }
    Ok(())
}
