//! Legendre functions of the second kind, off the cut [-1,1] and on it.
//!
//! Q_n(z) = ½ ∫_{-1}^1 P_n(t)/(z-t) dt. Distances to the ends ±1 enter as numbers of their own: near an end they
//! cannot be recovered from z.

use num_complex::Complex64;

/// Q_0(z), .., Q_N(z) for N = `out.len()`-1 and complex z off the cut [-1,1], from zm1 = z-1 and zp1 = z+1.
///
/// ∫_{-1}^1 P_n(t)/(z-t) dt = 2 Q_n(z), and ∫ P_n(t) log(z-t) dt = 2 (Q_{n+1} - Q_{n-1})/(2n+1) for n ≥ 1.
/// Q_0 = ½ log((z+1)/(z-1)) uses both distances, so it is accurate however close z is to ±1. The recurrence
/// (k+1) Q_{k+1} = (2k+1) z Q_k - k Q_{k-1} is run in terms of δ = z-1 (for Re z ≥ 0, the rest by reflection), because the
/// rounding of z alone would cost N² units next to an end. Forward it multiplies errors by ϱ^(2N) (see [`bernstein`])
/// and is used only if 2N log ϱ < 1.5; otherwise it is run downwards from Q = 0 at ⌈19/log ϱ⌉+2 degrees above N, which
/// costs e^(-38), and scaled to Q_0. No allocation; cost O(N + 1/log ϱ), O(N) at most.
///
/// On the cut the sign of a zero imaginary part picks the limit Q_n(x ± i0) = Q_n(x) ∓ iπ/2 P_n(x). At z = ±1 all Q_n
/// are infinite and the result is not finite. Values below 1e-304 become 0 (far away |Q_n| ~ |2z|^-(n+1)); |z| may be up
/// to 1e50.
///
/// Source: NIST DLMF 14.10.3; Gautschi, SIAM Review 9 (1967), for the downward recurrence.
pub fn legendre_q(zm1: Complex64, zp1: Complex64, out: &mut [Complex64]) {
    if zm1.re + zp1.re < 0.0 {
        // Q_n(z) = (-1)^(n+1) Q_n(-z)
        legendre_q(-zp1, -zm1, out);
        out.iter_mut().step_by(2).for_each(|q| *q = -*q);
        return;
    }
    let Some(last) = out.len().checked_sub(1) else { return };
    out[0] = q_zero(zm1, zp1);
    if last == 0 {
        return;
    }
    let log_rho = log_bernstein(zm1, zp1);
    if 2.0 * (last as f64) * log_rho < 1.5 {
        forward(zm1, out);
    } else {
        backward(zm1, log_rho, out);
    }
}

/// Q_{k+1} = Q_k + d_{k+1}, (k+1) d_{k+1} = k d_k + (2k+1) (z-1) Q_k, from Q_0 in `out`.
fn forward(zm1: Complex64, out: &mut [Complex64]) {
    // k d_k; the first step Q_1 = z Q_0 - 1 has -1 in its place.
    let mut kd = Complex64::new(-1.0, 0.0);
    for k in 0..out.len() - 1 {
        kd += (2 * k + 1) as f64 * zm1 * out[k];
        out[k + 1] = out[k] + kd / (k + 1) as f64;
    }
}

/// y_{k-1} = y_k + f_k/k, f_k = f_{k+1} + (2k+1) (z-1) y_k: the recurrence for multiples y_k of Q_k, from y_k = 0 just
/// above `top` downwards, then scaled to Q_0 in `out`. For Re z ≥ 0 there is no cancellation.
fn backward(zm1: Complex64, log_rho: f64, out: &mut [Complex64]) {
    // Q_n ~ ϱ^-(n+1) is below 1e-304 from n = 700/log ϱ on (and NaN if Q_0 is).
    let last = (out.len() - 1).min((700.0 / log_rho) as usize);
    let q_zero = out[0];
    out[last + 1..].fill(0.0 * q_zero);
    let top = last + (19.0 / log_rho).ceil() as usize + 1;
    let mut y = Complex64::from(1e-290);
    let mut f = (top + 1) as f64 * y;
    for k in (1..=top).rev() {
        f += (2 * k + 1) as f64 * zm1 * y;
        y += f * (1.0 / k as f64);
        if k <= last + 1 {
            out[k - 1] = y;
        }
    }
    let size = y.l1_norm();
    let scale = q_zero / size / (y / size);
    out[..=last].iter_mut().for_each(|q| *q *= scale);
    out[0] = q_zero;
}

/// [`legendre_q`] from z alone.
pub fn legendre_q_at(z: Complex64, out: &mut [Complex64]) {
    legendre_q(z - 1.0, z + 1.0, out);
}

/// Principal values Q_0(x), .., Q_N(x), N = `out.len()`-1, on the cut -1 < x < 1: half of p.v. ∫ P_n(t)/(x-t) dt.
///
/// Not finite at ±1, not a number outside [-1,1].
pub fn legendre_q_cut(x: f64, out: &mut [f64]) {
    legendre_q_cut_from(1.0 - x, 1.0 + x, out);
}

/// [`legendre_q_cut`] from the distances 1-x and 1+x, accurate however small one of them is.
pub fn legendre_q_cut_from(one_minus_x: f64, one_plus_x: f64, out: &mut [f64]) {
    if one_plus_x < one_minus_x {
        legendre_q_cut_from(one_plus_x, one_minus_x, out);
        out.iter_mut().step_by(2).for_each(|q| *q = -*q);
        return;
    }
    // artanh x = ½ log((1+x)/(1-x)), then upwards as off the cut.
    let mut q = 0.5 * ((one_plus_x - one_minus_x) / one_minus_x).ln_1p();
    let mut kd = -1.0;
    for (k, value) in out.iter_mut().enumerate() {
        *value = q;
        kd -= (2 * k + 1) as f64 * one_minus_x * q;
        q += kd / (k + 1) as f64;
    }
}

/// Derivatives Q_n'(z) = n (z Q_n - Q_{n-1})/(z²-1), Q_0' = -1/(z²-1), from the values `q` of [`legendre_q`].
///
/// # Panics
/// If `q` and `out` differ in length.
pub fn legendre_dq(zm1: Complex64, zp1: Complex64, q: &[Complex64], out: &mut [Complex64]) {
    assert_eq!(q.len(), out.len(), "values and derivatives must have one length");
    let z = 0.5 * (zm1 + zp1);
    let factor = (zm1 * zp1).inv();
    for n in 0..out.len() {
        out[n] = if n == 0 { -factor } else { n as f64 * (z * q[n] - q[n - 1]) * factor };
    }
}

/// Parameter ϱ ≥ 1 of the Bernstein ellipse through z: |z-1| + |z+1| = ϱ + 1/ϱ, ϱ = |z + √(z-1) √(z+1)|.
///
/// n-point Gauss-Legendre quadrature of a function analytic inside this ellipse has an error of about ϱ^(-2n).
///
/// Source: Trefethen (2013), theorem 19.3, for the error.
pub fn bernstein(z: Complex64) -> f64 {
    log_bernstein(z - 1.0, z + 1.0).exp()
}

/// log ϱ ≥ 0 of the Bernstein ellipse through z, from zm1 = z-1 and zp1 = z+1; relatively accurate at any distance from
/// the cut, where ϱ itself rounds to 1.
pub fn log_bernstein(zm1: Complex64, zp1: Complex64) -> f64 {
    // ϱ + 1/ϱ - 2 = 4 sinh²(½ log ϱ) = |z-1| + |z+1| - 2, a sum of two terms without cancellation.
    let excess = norm_plus_real(zm1) + norm_plus_real(-zp1);
    2.0 * (0.5 * excess.sqrt()).asinh()
}

/// |w| + Re w ≥ 0 without cancellation.
fn norm_plus_real(w: Complex64) -> f64 {
    let norm = w.norm_sqr().sqrt();
    if w.re >= 0.0 { norm + w.re } else { w.im * w.im / (norm - w.re) }
}

/// Q_0(z) = ½ log((z+1)/(z-1)) for Re z ≥ 0.
fn q_zero(zm1: Complex64, zp1: Complex64) -> Complex64 {
    let re = 0.25 * (2.0 * (zm1.re + zp1.re) / zm1.norm_sqr()).ln_1p();
    // (z+1) conj(z-1) has the imaginary part -2 Im z; multiplied out it would cancel far from the cut.
    let im = 0.5 * (-2.0 * zm1.im).atan2(zm1.re * zp1.re + zm1.im * zm1.im);
    Complex64::new(re, im)
}

#[cfg(test)]
mod tests;
