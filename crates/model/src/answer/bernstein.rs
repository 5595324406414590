//! Polynomials on [-1, 1] in Bernstein's form, whose values lie in the hull of the coefficients.

use steklov_quadrature::Series;

/// Coefficients Σ b_i C(p,i) ((1-t)/2)^(p-i) ((1+t)/2)^i of a Legendre series of degree p: those of P_k are
/// (-1)^(k+i) C(k,i) in degree k, then raised to p.
///
/// Source: Farouki (2000).
pub(crate) fn bernstein(series: &Series) -> Vec<f64> {
    let p = series.coefficients.len() - 1;
    let mut sum = vec![0.0; p + 1];
    for (k, coefficient) in series.coefficients.iter().enumerate() {
        let mut b: Vec<f64> = Vec::with_capacity(p + 1);
        let mut binomial = 1.0;
        for i in 0..=k {
            b.push(if (k + i).is_multiple_of(2) { binomial } else { -binomial });
            binomial *= (k - i) as f64 / (i + 1) as f64;
        }
        while b.len() <= p {
            let n = b.len() as f64;
            let raised = |i: usize| {
                let part = i as f64 / n;
                let (before, here) = (if i > 0 { b[i - 1] } else { 0.0 }, if i < b.len() { b[i] } else { 0.0 });
                part * before + (1.0 - part) * here
            };
            b = (0..=b.len()).map(raised).collect();
        }
        sum.iter_mut().zip(b).for_each(|(s, b)| *s += coefficient * b);
    }
    sum
}

/// The coefficients on both halves, by de Casteljau's rule.
pub(crate) fn halves(b: &[f64]) -> [Vec<f64>; 2] {
    let mut row = b.to_vec();
    let (mut left, mut right) = (Vec::with_capacity(b.len()), Vec::with_capacity(b.len()));
    while let (Some(first), Some(last)) = (row.first(), row.last()) {
        left.push(*first);
        right.push(*last);
        row = row.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0).collect();
    }
    right.reverse();
    [left, right]
}
