//! Integrals over one element, the inner ones of a pair and those of the potentials: exact up to a smooth rest.
//!
//! ```text
//! D_n = ∫ P_n γ'/(x-γ) dt     F_n = ∫ P_n/(x-γ) dt     E_n = ∫ P_n (x-γ)/conj(x-γ) dt     X_n = ∂E_n/∂x̄
//! ∫ P_n log|x-γ| dt = Re(D_(n+1) - D_(n-1))/(2n+1),  n ≥ 1;     log|x-v₀| + log|x-v₁| + Re D_1,  n = 0
//! ```
//! Near an element the pole at the preimage z of x, γ(z) = x, is taken off: it gives Legendre functions Q_n(z), the rest is
//! smooth and left to Gauss-Legendre. On an arc the rest is that of the cotangent, and F, E follow from D; on a polynomial
//! curve it is made of divided differences, which cancel nothing. Far from the element plain Gauss-Legendre is exact.
//!
//! The singularity swap is that of Helsing, Ojala, J. Comput. Phys. 227 (2008), and af Klinteberg, Barnett, BIT 61 (2021).

use std::f64::consts::PI;
use std::sync::OnceLock;

use num_complex::Complex64;
use steklov_quadrature::{Rule, gauss_legendre, legendre_dq, legendre_p, legendre_q, legendre_q_cut, log_bernstein};

use crate::curve::{CircularArc, Curve, INJECTIVE, PolynomialCurve, evaluate, evaluate_derivative};
use crate::near::MAX_ORDER;

/// The integrals over one element for one point x.
#[derive(Debug, Clone)]
pub(crate) struct Inner {
    /// D_n, one more than the others.
    pub(crate) d: [Complex64; MAX_ORDER],
    pub(crate) f: [Complex64; MAX_ORDER],
    pub(crate) e: [Complex64; MAX_ORDER],
    /// X_n, if requested; at a point on the element itself the derivative of E along the element needs it.
    pub(crate) x: [Complex64; MAX_ORDER],
    /// log|x-v₀| + log|x-v₁|.
    log_ends: f64,
}

impl Default for Inner {
    fn default() -> Self {
        let zeros = [Complex64::ZERO; MAX_ORDER];
        Self { d: zeros, f: zeros, e: zeros, x: zeros, log_ends: 0.0 }
    }
}

/// A Gauss-Legendre rule with `weighted[j * MAX_ORDER + n]` = w_j P_n(t_j).
pub(crate) struct Weighted {
    pub(crate) rule: Rule,
    pub(crate) weighted: Vec<f64>,
}

impl Weighted {
    pub(crate) fn row(&self, j: usize, count: usize) -> &[f64] {
        &self.weighted[j * MAX_ORDER..][..count]
    }
}

/// Largest number of points of a [`weighted_rule`].
const MOST_POINTS: usize = 160;

pub(crate) fn weighted_rule(points: usize) -> &'static Weighted {
    static RULES: [OnceLock<Weighted>; MOST_POINTS + 1] = [const { OnceLock::new() }; MOST_POINTS + 1];
    RULES[points.min(MOST_POINTS)].get_or_init(|| {
        let rule = gauss_legendre(points);
        let mut weighted = vec![0.0; rule.len() * MAX_ORDER];
        for (row, (&t, &w)) in weighted.chunks_exact_mut(MAX_ORDER).zip(rule.points.iter().zip(&rule.weights)) {
            legendre_p(t, row);
            row.iter_mut().for_each(|v| *v *= w);
        }
        Weighted { rule, weighted }
    })
}

/// Points for P_n f, n < `count`, f analytic up to log ϱ.
pub(crate) fn points_for(count: usize, log_rho: f64) -> usize {
    count / 2 + 2 + (19.0 / log_rho).ceil() as usize
}

impl Inner {
    /// ∫ P_n log|x-γ| dt.
    pub(crate) fn log(&self, n: usize) -> f64 {
        match n {
            0 => self.log_ends + self.d[1].re,
            _ => (self.d[n + 1].re - self.d[n - 1].re) / (2 * n + 1) as f64,
        }
    }

    /// Fills all integrals with n < `count` for a point off the curve, from x - v₀ and x - v₁; `gradient`: X_n too.
    pub(crate) fn off_curve(&mut self, curve: &Curve, from: [Complex64; 2], count: usize, gradient: bool) {
        self.log_ends = 0.5 * (from[0].norm_sqr().ln() + from[1].norm_sqr().ln());
        let z = curve.preimage(from);
        let log_rho = z.map_or(INJECTIVE.ln(), |[zm1, zp1]| log_bernstein(zm1, zp1));
        match (curve, z) {
            (Curve::Line(ends), Some(z)) => self.line(ends.half(), z, count, gradient),
            (Curve::Arc(arc), Some(z)) if arc.is_near(from[0], log_rho) => self.arc(arc, from[0], z, count, gradient),
            (Curve::Polynomial(curve), Some(z)) => self.polynomial(curve, z, count, gradient),
            _ => self.plain(curve, from, log_rho, count, gradient),
        }
    }

    /// Plain Gauss-Legendre.
    fn plain(&mut self, curve: &Curve, from: [Complex64; 2], log_rho: f64, count: usize, gradient: bool) {
        let rule = weighted_rule(points_for(count + 2, log_rho));
        self.clear(count);
        for (j, &t) in rule.rule.points.iter().enumerate() {
            let [from_start, from_end] = curve.from_ends((1.0 + t) / 2.0, (1.0 - t) / 2.0);
            let r = if t <= 0.0 { from[0] - from_start } else { from[1] - from_end };
            let f = r.inv();
            let (d, e) = (curve.derivative(t) * f, r * f.conj());
            let x = if gradient { -e * f.conj() } else { Complex64::ZERO };
            self.add(rule.row(j, count + 1), count, [d, f, e, x]);
        }
    }

    fn clear(&mut self, count: usize) {
        self.d[..count + 1].fill(Complex64::ZERO);
        for part in [&mut self.f, &mut self.e, &mut self.x] {
            part[..count].fill(Complex64::ZERO);
        }
    }

    /// Adds w P_n times values of the integrands at one point.
    fn add(&mut self, weighted: &[f64], count: usize, [d, f, e, x]: [Complex64; 4]) {
        for (n, &w) in weighted.iter().enumerate() {
            self.d[n] += w * d;
            if n < count {
                self.f[n] += w * f;
                self.e[n] += w * e;
                self.x[n] += w * x;
            }
        }
    }

    fn line(&mut self, half: Complex64, [zm1, zp1]: [Complex64; 2], count: usize, gradient: bool) {
        let mut q = [Complex64::ZERO; MAX_ORDER];
        legendre_q(zm1, zp1, &mut q[..count + 1]);
        let (inverse, turn) = (half.inv(), half * half / half.norm_sqr());
        let z_im = if zm1.norm_sqr() < zp1.norm_sqr() { zm1.im } else { zp1.im };
        for n in 0..=count {
            self.d[n] = 2.0 * q[n];
        }
        for n in 0..count {
            let one = if n == 0 { 2.0 } else { 0.0 };
            self.f[n] = self.d[n] * inverse;
            self.e[n] = turn * (one + Complex64::new(0.0, 4.0 * z_im) * q[n].conj());
        }
        if gradient {
            let mut dq = [Complex64::ZERO; MAX_ORDER];
            legendre_dq(zm1, zp1, &q[..count], &mut dq[..count]);
            for n in 0..count {
                // E = turn (2δ + 2 (z - z̄) conj Q)
                let inner = -2.0 * q[n].conj() + Complex64::new(0.0, 4.0 * z_im) * dq[n].conj();
                self.x[n] = turn * inner * inverse.conj();
            }
        }
    }

    /// K_n = ∫ P_n (α/2) cot(α(z-t)/2) dt = 2 Q_n + (α/2) Σ_j λ_j P_n(t_j) κ(α(z-t_j)/2), κ(w) = cot w - 1/w; from it
    /// D_n = K_n - iα δ_n0,  F_n = (δ_n0 - (i/α) K_n)/X,  E_n = -G_n/X̄ + ((|X|²-R²)/X̄) conj F_n,  X = x - c.
    fn arc(&mut self, arc: &CircularArc, x0: Complex64, z: [Complex64; 2], count: usize, gradient: bool) {
        let [zm1, zp1] = z;
        let alpha = arc.half_opening;
        let arm = x0 + arc.arms[0];
        let mut q = [Complex64::ZERO; MAX_ORDER];
        legendre_q(zm1, zp1, &mut q[..count + 1]);
        let mut dk = [Complex64::ZERO; MAX_ORDER];
        if gradient {
            legendre_dq(zm1, zp1, &q[..count], &mut dk[..count]);
            dk[..count].iter_mut().for_each(|dk| *dk *= 2.0);
        }
        let k = &mut self.d;
        for n in 0..=count {
            k[n] = 2.0 * q[n];
        }
        let rule = arc.rest_rule(count + 1);
        for (j, &t) in rule.rule.points.iter().enumerate() {
            // z - t from the nearer end
            let distance = if t >= 0.0 { zm1 + (1.0 - t) } else { zp1 - (1.0 + t) };
            let (kappa, slope) = cot_rest(alpha / 2.0 * distance, gradient);
            let (kappa, slope) = (alpha / 2.0 * kappa, alpha * alpha / 4.0 * slope);
            for (n, &w) in rule.row(j, count + 1).iter().enumerate() {
                k[n] += w * kappa;
                if gradient && n < count {
                    dk[n] += w * slope;
                }
            }
        }
        let moments = arc.moments(count);
        let turn = -Complex64::I / alpha;
        let (inverse, power) = (arm.inv(), x0.norm_sqr() + 2.0 * (x0 * arc.arms[0].conj()).re);
        for n in 0..count {
            let one = if n == 0 { 1.0 } else { 0.0 };
            self.f[n] = (one + turn * self.d[n]) * inverse;
            self.e[n] = (power * self.f[n].conj() - moments[n]) * inverse.conj();
            if gradient {
                let df = -self.f[n] * inverse + turn * turn * dk[n] * inverse * inverse;
                let flat = (moments[n] + arc.radius * arc.radius * self.f[n].conj()) * inverse.conj();
                self.x[n] = (flat + power * df.conj()) * inverse.conj();
            }
        }
        self.d[0] -= Complex64::new(0.0, alpha);
    }

    /// With g(t) = γ[t,z], τ = z̄, h = g/ḡ and h(τ) = γ[τ,z]/conj γ'(z):
    ///
    /// ```text
    /// D_n = 2Q_n - ∫P_n g'/g      F_n = 2Q_n/γ'(z) + ∫P_n γ[t,z,z]/(g γ'(z))
    /// E_n = ∫P_n h + (z-τ) ( 2 h(τ) conj Q_n - ∫P_n h[t,τ] )
    /// ```
    fn polynomial(&mut self, curve: &PolynomialCurve, [zm1, zp1]: [Complex64; 2], count: usize, gradient: bool) {
        let mut q = [Complex64::ZERO; MAX_ORDER];
        legendre_q(zm1, zp1, &mut q[..count + 1]);
        let mut dq = [Complex64::ZERO; MAX_ORDER];
        if gradient {
            legendre_dq(zm1, zp1, &q[..count], &mut dq[..count]);
        }
        let near_end = zm1.norm_sqr() < zp1.norm_sqr();
        let z_im = if near_end { zm1.im } else { zp1.im };
        let z = if near_end { 1.0 + zm1 } else { zp1 - 1.0 };
        // in units of γ'(0): F, E and X are scaled below
        let swap = Swap::new(&curve.of.middle, z);
        let apart = Complex64::new(0.0, 2.0 * z_im);
        let slope_inverse = swap.slope.inv();
        for n in 0..=count {
            self.d[n] = 2.0 * q[n];
        }
        for n in 0..count {
            self.f[n] = 2.0 * q[n] * slope_inverse;
            self.e[n] = 2.0 * apart * swap.h_tau * q[n].conj();
            self.x[n] = Complex64::ZERO;
            if gradient {
                // -(z-τ) h₂/(τ-t)² - h₂/(τ-t), h₂ = g/ḡ²
                self.x[n] = 2.0 * apart * (swap.h2_tau * dq[n].conj() + swap.h2_slope * q[n].conj())
                    - 2.0 * swap.h2_tau * q[n].conj();
            }
        }
        let rule = weighted_rule(points_for(count + 1, INJECTIVE.ln()));
        for (j, &t) in rule.rule.points.iter().enumerate() {
            let at = swap.at(t);
            let d = -at.g_slope / at.g;
            let f = at.by_z_z / at.g * slope_inverse;
            let e = at.g / at.g.conj() - apart * at.h_tau;
            let x = if gradient { at.gradient(&swap, t, apart) } else { Complex64::ZERO };
            self.add(rule.row(j, count + 1), count, [d, f, e, x]);
        }
        self.turn(curve.slope, count);
    }

    /// From a curve with γ'(0) = 1 to one with this γ'(0).
    fn turn(&mut self, slope: Complex64, count: usize) {
        let (inverse, turn) = (slope.inv(), slope / slope.conj());
        for n in 0..count {
            self.f[n] *= inverse;
            self.e[n] *= turn;
            self.x[n] *= turn * inverse.conj();
        }
    }

    /// Principal values at the point t of the element itself, X_n as its derivative along the element needs it.
    pub(crate) fn on_curve(&mut self, curve: &Curve, t: f64, count: usize) {
        let [from_start, from_end] = curve.from_ends((1.0 + t) / 2.0, (1.0 - t) / 2.0);
        self.log_ends = 0.5 * (from_start.norm_sqr().ln() + from_end.norm_sqr().ln());
        let mut q = [0.0; MAX_ORDER];
        legendre_q_cut(t, &mut q[..count + 1]);
        self.clear(count);
        let slope = curve.derivative(t);
        // dE/dt at the point of the element
        let mut along = [Complex64::ZERO; MAX_ORDER];
        match curve {
            Curve::Line(ends) => {
                let turn = ends.half() / ends.half().conj();
                for n in 0..=count {
                    self.d[n] = (2.0 * q[n]).into();
                }
                for n in 0..count {
                    self.f[n] = self.d[n] / slope;
                }
                self.e[0] = 2.0 * turn;
            }
            Curve::Arc(arc) => {
                let alpha = arc.half_opening;
                let rule = arc.rest_rule(count + 1);
                for (j, &u) in rule.rule.points.iter().enumerate() {
                    let kappa = alpha / 2.0 * cot_rest((alpha / 2.0 * (t - u)).into(), false).0;
                    self.add(rule.row(j, count + 1), 0, [kappa, Complex64::ZERO, Complex64::ZERO, Complex64::ZERO]);
                }
                let arm = if t <= 0.0 { arc.arms[0] + from_start } else { arc.arms[1] + from_end };
                let moments = arc.moments(count);
                for n in 0..=count {
                    self.d[n] += 2.0 * q[n];
                }
                for n in 0..count {
                    let one = if n == 0 { 1.0 } else { 0.0 };
                    self.f[n] = (one - Complex64::I / alpha * self.d[n]) / arm;
                    self.e[n] = -moments[n] / arm.conj();
                    along[n] = moments[n] * slope.conj() / (arm.conj() * arm.conj());
                }
                self.d[0] -= Complex64::new(0.0, alpha);
            }
            Curve::Polynomial(curve) => {
                let scale = curve.slope;
                let swap = Swap::new(&curve.of.middle, t.into());
                let rule = weighted_rule(points_for(count + 1, INJECTIVE.ln()));
                for (j, &u) in rule.rule.points.iter().enumerate() {
                    let at = swap.at(u);
                    let (d, f) = (-at.g_slope / at.g, at.by_z_z / (at.g * swap.slope));
                    self.add(rule.row(j, count + 1), count, [d, f, at.g / at.g.conj(), Complex64::ZERO]);
                    let turned = (at.by_z_z - at.g * at.by_z_z.conj() / at.g.conj()) / at.g.conj();
                    for (along, &w) in along.iter_mut().zip(rule.row(j, count)) {
                        *along += w * turned;
                    }
                }
                for n in 0..=count {
                    self.d[n] += 2.0 * q[n];
                }
                for n in 0..count {
                    self.f[n] += 2.0 * q[n] / swap.slope;
                    along[n] *= scale / scale.conj();
                }
                self.turn(scale, count);
            }
        }
        for n in 0..count {
            self.x[n] = (along[n] - slope * self.f[n].conj()) / slope.conj();
        }
    }
}

/// Divided differences of a polynomial γ at a preimage z and its mirror image τ.
pub(crate) struct Swap {
    /// γ[t,z], γ[t,z,z] and γ[t,τ,z] as polynomials in t.
    g: Vec<Complex64>,
    by_z_z: Vec<Complex64>,
    by_tau_z: Vec<Complex64>,
    tau: Complex64,
    /// γ'(z).
    slope: Complex64,
    /// γ[τ,z].
    g_tau: Complex64,
    /// h(τ).
    h_tau: Complex64,
    /// h₂(τ) and h₂'(τ).
    h2_tau: Complex64,
    h2_slope: Complex64,
}

/// Their values at one t.
pub(crate) struct At {
    pub(crate) g: Complex64,
    pub(crate) g_slope: Complex64,
    by_z_z: Complex64,
    /// (h(t) - h(τ))/(t - τ).
    h_tau: Complex64,
}

/// The quotient of p(t) - p(z) by t - z.
pub(crate) fn divided(p: &[Complex64], z: Complex64) -> Vec<Complex64> {
    let mut quotient = vec![Complex64::ZERO; p.len().saturating_sub(1)];
    let mut sum = Complex64::ZERO;
    for k in (1..p.len()).rev() {
        sum = sum * z + p[k];
        quotient[k - 1] = sum;
    }
    quotient
}

impl Swap {
    pub(crate) fn new(a: &[Complex64], z: Complex64) -> Self {
        let tau = z.conj();
        let g = divided(a, z);
        let (by_z_z, by_tau_z) = (divided(&g, z), divided(&g, tau));
        let (slope, g_tau) = (evaluate(&g, z), evaluate(&g, tau));
        // ḡ(τ) = conj γ'(z); its slope is conj of that of g at z
        let low = slope.conj();
        let (top_slope, low_slope) = (evaluate_derivative(&g, tau), evaluate_derivative(&g, z).conj());
        let h2_tau = g_tau / (low * low);
        let h2_slope = (top_slope - 2.0 * g_tau * low_slope / low) / (low * low);
        Self { g, by_z_z, by_tau_z, tau, slope, g_tau, h_tau: g_tau / low, h2_tau, h2_slope }
    }

    pub(crate) fn at(&self, t: f64) -> At {
        let t = Complex64::from(t);
        let g = evaluate(&self.g, t);
        let (by_z_z, by_tau_z) = (evaluate(&self.by_z_z, t), evaluate(&self.by_tau_z, t));
        let low = self.slope.conj();
        let h_tau = (by_tau_z * low - self.g_tau * by_z_z.conj()) / (g.conj() * low);
        At { g, g_slope: evaluate_derivative(&self.g, t), by_z_z, h_tau }
    }
}

impl At {
    /// The smooth rest of -(z-t) h₂/(τ-t)² = -(z-τ) h₂/(τ-t)² - h₂/(τ-t) at t. |z-τ| ≤ 2|t-τ|, so that the difference of
    /// divided differences costs no digits.
    fn gradient(&self, swap: &Swap, t: f64, apart: Complex64) -> Complex64 {
        let conj = self.g.conj();
        // h₂[t,τ], h₂ = h (1/ḡ), (1/ḡ)[t,τ] = -ḡ[t,τ]/(ḡ(t) ḡ(τ))
        let first = (self.h_tau - swap.h_tau * self.by_z_z.conj() / swap.slope.conj()) / conj;
        first - apart / (t - swap.tau) * (first - swap.h2_slope)
    }
}

impl CircularArc {
    /// Whether the pole is to be taken off: F and E lose digits at the centre of the circle.
    fn is_near(&self, x0: Complex64, log_rho: f64) -> bool {
        log_rho < INJECTIVE.ln() && (x0 + self.arms[0]).norm_sqr() > 0.04 * self.radius * self.radius
    }

    /// The rest of the cotangent has its poles at z ± 2π/α, |Re z| ≤ 5/3.
    pub(crate) fn rest_rule(&self, count: usize) -> &'static Weighted {
        let pole = 2.0 * PI / self.half_opening.abs() - 5.0 / 3.0;
        weighted_rule(points_for(count, log_bernstein((pole - 1.0).into(), (pole + 1.0).into())))
    }

    /// G_n = ∫ P_n (γ-c) dt.
    pub(crate) fn moments(&self, count: usize) -> [Complex64; MAX_ORDER] {
        let rule = weighted_rule(count / 2 + 12);
        let middle = self.arms[0] * Complex64::cis(self.half_opening);
        let mut moments = [Complex64::ZERO; MAX_ORDER];
        for (j, &t) in rule.rule.points.iter().enumerate() {
            let arm = middle * Complex64::cis(self.half_opening * t);
            for (moment, &w) in moments.iter_mut().zip(rule.row(j, count)) {
                *moment += w * arm;
            }
        }
        moments
    }
}

/// ζ(2k) - 1, k = 1 … 12.
const ZETA: [f64; 12] = [
    6.449340668482264e-1,
    8.232323371113819e-2,
    1.734306198444914e-2,
    4.077356197944339e-3,
    9.945751278180853e-4,
    2.460865533080483e-4,
    6.124813505870483e-5,
    1.528225940865187e-5,
    3.81729326499984e-6,
    9.53962033872796e-7,
    2.384505027277329e-7,
    5.960818905125948e-8,
];

/// κ(w) = cot w - 1/w = -2 Σ ζ(2k) π^(-2k) w^(2k-1), and κ' if requested.
pub(crate) fn cot_rest(w: Complex64, derivative: bool) -> (Complex64, Complex64) {
    if w.norm_sqr() < 0.36 {
        let square = w * w / (PI * PI);
        let (mut value, mut slope) = (Complex64::ZERO, Complex64::ZERO);
        for k in (1..=ZETA.len()).rev() {
            let zeta = 1.0 + ZETA[k - 1];
            value = value * square + zeta;
            if derivative {
                slope = slope * square + (2 * k - 1) as f64 * zeta;
            }
        }
        let scale = -2.0 / (PI * PI);
        return (scale * w * value, scale * slope);
    }
    let inverse = w.inv();
    let cot = cot(w);
    (cot - inverse, if derivative { inverse * inverse - (1.0 + cot * cot) } else { Complex64::ZERO })
}

/// cot w without overflow.
fn cot(w: Complex64) -> Complex64 {
    // cot w = i (q + 1)/(q - 1), q = exp(2iw), |q| ≤ 1 in the upper half plane
    let sign = if w.im >= 0.0 { 1.0 } else { -1.0 };
    let q = (Complex64::new(0.0, 2.0 * sign) * w).exp();
    Complex64::new(0.0, sign) * (q + 1.0) / (q - 1.0)
}

#[cfg(test)]
mod tests;
