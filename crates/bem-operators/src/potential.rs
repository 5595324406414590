//! Displacement and stress inside the body, as close to the boundary as one likes, and traces on the boundary.
//!
//! With z = (x - c_b)/d_b every inner integral is exact:
//!
//! ```text
//! ∫ P_n log|x-y| dt = Re(2 Q_1 + log(z²-1)) (n = 0),  2/(2n+1) Re(Q_(n+1) - Q_(n-1)) (n ≥ 1),  plus 2 δ_n0 log|d|
//! ∫ P_n e^(2i arg(x-y)) dt = (d/d̄) ( 2 δ_n0 + 4i Im z conj Q_n ),      ∫ P_n (x-y)·n_y |d|/r² dt = 2 Im Q_n
//! ```
//! Gradients are taken after integration by parts along the closed curve, so that nothing stronger than a logarithm at
//! the element ends is left.

use std::sync::OnceLock;

use num_complex::Complex64;
use steklov_elastic::plane::{dot, turned};
use steklov_elastic::{Material, RigidMotion};
use steklov_quadrature::{legendre_dq, legendre_p, legendre_q, legendre_q_cut};

use crate::curve::Curve;
use crate::far_potential::{Nodes, Series, reach, rule_at};
use crate::inner::Inner;
use crate::kernel::Constants;
use crate::moments::Segment;
use crate::near::MAX_ORDER;
use crate::{Mesh, Space};

/// The elastic field of a displacement and a traction on the boundary: u = a + V t - K u inside the body.
///
/// Source: Hsiao and Wendland (2008), section 2.2, for the representation formula.
#[derive(Debug, Clone)]
pub struct BoundaryField {
    material: Material,
    /// a.
    constant: [f64; 2],
    /// A rigid motion that is added.
    motion: Option<RigidMotion>,
    pub(crate) constants: Constants,
    pub(crate) elements: Vec<Piece>,
}

/// Legendre coefficients of one element.
#[derive(Debug, Clone)]
pub(crate) struct Piece {
    pub(crate) curve: Curve,
    /// The chord.
    segment: Segment,
    /// Half of the length.
    pub(crate) half: f64,
    /// log L.
    log_length: f64,
    /// 1/d.
    inverse: Complex64,
    /// log(|d|/L).
    log_half: f64,
    /// û[n], n = 0..=p.
    pub(crate) displacement: Vec<[f64; 2]>,
    /// Coefficients of du/dt, n = 0..p.
    pub(crate) derivative: Vec<[f64; 2]>,
    /// ψ[n], n = 0..p.
    pub(crate) traction: Vec<[f64; 2]>,
    /// γ(0), the distances from there at which the rules of distant points hold, and their nodes.
    middle: Complex64,
    reach: [f64; 3],
    nodes: [OnceLock<Nodes>; 3],
}

/// Values at a point inside the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inside {
    /// Displacement.
    pub displacement: [f64; 2],
    /// [[∂x u_x, ∂y u_x], [∂x u_y, ∂y u_y]].
    pub gradient: [[f64; 2]; 2],
    /// Stress σ_xx, σ_yy, σ_xy.
    pub stress: [f64; 3],
}

/// Values on the boundary at a point of one element, from the inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trace {
    /// Displacement.
    pub displacement: [f64; 2],
    /// Traction σ(u)n, of the traction space.
    pub traction: [f64; 2],
    /// Stress σ_xx, σ_yy, σ_xy from the traction and the tangential derivative of the displacement.
    pub stress: [f64; 3],
}

impl BoundaryField {
    /// Field of a nodal displacement and Legendre coefficients of a traction (interleaved, as [`Space`] numbers them).
    /// `length` is L in log(L/r): inside the body the field does not depend on it when the traction has no resultant.
    pub fn new(
        mesh: &Mesh,
        space: &Space,
        material: &Material,
        displacement: &[f64],
        traction: &[f64],
        length: f64,
    ) -> Self {
        let elements = (0..mesh.len()).map(|e| {
            let basis = space.basis(e);
            let p = basis.degree;
            let combine = |row: usize, a: &faer::Mat<f64>| {
                let mut sum = [0.0; 2];
                for (j, node) in space.element_nodes(e).enumerate() {
                    sum[0] += a[(row, j)] * displacement[2 * node];
                    sum[1] += a[(row, j)] * displacement[2 * node + 1];
                }
                sum
            };
            let segment = mesh.segment(e);
            let at = 2 * space.offset[e];
            let curve = mesh.curve(e);
            Piece {
                segment,
                middle: curve.point(0.0),
                reach: reach(&curve),
                nodes: Default::default(),
                half: curve.half_length(),
                log_length: length.ln(),
                curve,
                inverse: 1.0 / segment.half(),
                log_half: (segment.half().norm() / length).ln(),
                displacement: (0..=p).map(|n| combine(n, &basis.to_legendre)).collect(),
                derivative: (0..p).map(|n| combine(n, &basis.derivative_to_legendre)).collect(),
                traction: (0..p).map(|n| [traction[at + 2 * n], traction[at + 2 * n + 1]]).collect(),
            }
        });
        let constants = Constants::new(material);
        Self { material: *material, constant: [0.0; 2], motion: None, constants, elements: elements.collect() }
    }

    /// The same field with the constant a to which it tends at infinity, in an unbounded body:
    /// [`crate::TractionMap::at_infinity`]. It is 0 in a bounded body.
    pub fn tending_to(self, constant: [f64; 2]) -> Self {
        Self { constant, ..self }
    }

    /// The same field with a rigid motion added, exactly: the polynomials of curved elements have no rotations among them.
    pub fn moved(self, motion: Option<RigidMotion>) -> Self {
        Self { motion, ..self }
    }

    /// The same field with exact integrals over all elements.
    #[cfg(test)]
    pub(crate) fn by_exact_integrals(mut self) -> Self {
        self.elements.iter_mut().for_each(|piece| piece.reach = [f64::INFINITY; 3]);
        self
    }

    /// The rigid motion that is added, at a point.
    fn motion_at(&self, x: Complex64) -> [f64; 2] {
        self.motion.as_ref().map_or([0.0; 2], |motion| motion.at([x.re, x.im]))
    }

    /// The constant at infinity.
    pub fn at_infinity(&self) -> [f64; 2] {
        self.constant
    }

    /// Displacement, its gradient and the stress at a point inside the body (not on the boundary).
    pub fn inside(&self, x: [f64; 2]) -> Inside {
        let x = Complex64::new(x[0], x[1]);
        let k = &self.constants;
        let r = self.motion_at(x);
        let (mut u, mut gradient) = ([0, 1].map(|i| self.constant[i] + r[i]), [[0.0; 2]; 2]);
        let mut at = AtPoint::default();
        for piece in &self.elements {
            match rule_at(piece.reach, (x - piece.middle).norm_sqr()) {
                Some(rule) => {
                    let nodes = || Nodes::new(&piece.curve, rule, &piece.series(k), piece.log_length);
                    piece.nodes[rule].get_or_init(nodes).add(x, &mut u, &mut gradient);
                }
                None => piece.add_near(k, x, &mut at, &mut u, &mut gradient),
            }
        }
        Inside { displacement: u, gradient, stress: self.material.stress(gradient) }
    }

    /// Values on the boundary at the reference coordinate t of element e.
    pub fn trace(&self, e: usize, t: f64) -> Trace {
        let piece = &self.elements[e];
        let mut p = [0.0; MAX_ORDER];
        let p = &mut p[..piece.displacement.len()];
        legendre_p(t, p);
        let slope = piece.curve.derivative(t);
        let speed = slope.norm();
        let traction = piece.traction_at(p, speed);
        let along = series(&piece.derivative, p).map(|d| d / speed);
        let (u, r) = (series(&piece.displacement, p), self.motion_at(piece.curve.point(t)));
        Trace {
            displacement: if self.motion.is_some() { [u[0] + r[0], u[1] + r[1]] } else { u },
            traction,
            stress: self.boundary_stress(slope / speed, traction, along),
        }
    }

    /// σ_nn, σ_nt from the traction, σ_tt = 2μ/(1-ν) ε_tt + ν/(1-ν) σ_nn, turned to x, y.
    pub(crate) fn boundary_stress(&self, tangent: Complex64, traction: [f64; 2], along: [f64; 2]) -> [f64; 3] {
        let (t, n) = ([tangent.re, tangent.im], [tangent.im, -tangent.re]);
        let (nu, mu) = (self.material.nu(), self.material.mu());
        let nn = dot(traction, n);
        let nt = dot(traction, t);
        let tt = (2.0 * mu * dot(along, t) + nu * nn) / (1.0 - nu);
        [
            nn * n[0] * n[0] + 2.0 * nt * n[0] * t[0] + tt * t[0] * t[0],
            nn * n[1] * n[1] + 2.0 * nt * n[1] * t[1] + tt * t[1] * t[1],
            nn * n[0] * n[1] + nt * (n[0] * t[1] + n[1] * t[0]) + tt * t[0] * t[1],
        ]
    }

    /// Pointwise Steklov-Poincaré trace σ^h = W u + K'ψ + ψ/2 at the reference coordinate -1 < t < 1 of element e.
    ///
    /// ∫ σ^h·φ = (S u)_φ; σ^h has logarithmic singularities at all element ends, so it wants rules graded to them.
    ///
    /// Source: Issaoui (2014), equation (3.7).
    pub fn steklov_trace(&self, e: usize, t: f64) -> [f64; 2] {
        self.boundary_derivatives(e, t, 0..self.elements.len()).0
    }

    /// Derivative by arc length (dimensionless) of w = (K+½)u - Vψ at the reference coordinate -1 < t < 1 of element e:
    ///
    /// ```text
    /// w' = -K'_Δ u' + d/ds (2μV - V_Δ) J u' + ½ u' - d/ds Vψ,    K'_Δ u'(x) = -(1/2π) ∫ n_x·(x-y)/r² u' ds
    /// ```
    /// w is the displacement minus the limit of [`Self::inside`]. It vanishes if u and ψ belong to one elastic field of the
    /// body, and with ψ = V⁻¹(K+½)u its moments against the traction space do. w' has logarithmic singularities at all element
    /// ends.
    pub fn equation_slope(&self, e: usize, t: f64) -> [f64; 2] {
        self.boundary_derivatives(e, t, 0..self.elements.len()).1
    }

    /// Number of its elements.
    pub fn elements(&self) -> usize {
        self.elements.len()
    }

    /// Material of the body.
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// [`Self::steklov_trace`] and [`Self::equation_slope`] at once, from the elements `of` alone: they share the Legendre
    /// functions, which cost most. The contribution of distant elements is smooth on e.
    pub fn boundary_derivatives(&self, e: usize, t: f64, of: impl Iterator<Item = usize>) -> ([f64; 2], [f64; 2]) {
        let own = &self.elements[e];
        let k = &self.constants;
        let slope_own = own.curve.derivative(t);
        let speed = slope_own.norm();
        let tangent = slope_own / speed;
        let mut hypersingular = [0.0; 2];
        // K'_Δ and d/ds (2μV - V_Δ) of ψ, and of u' and J u'
        let (mut adjoint, mut slope) = ([0.0; 2], [0.0; 2]);
        let (mut adjoint_u, mut slope_u) = ([0.0; 2], [0.0; 2]);
        let mut single = [0.0; 2];
        let mut at = AtPoint::default();
        let (mut traction, mut along) = ([0.0; 2], [0.0; 2]);
        for b in of {
            let piece = &self.elements[b];
            at.on_boundary(piece, own, b == e, t);
            if b == e {
                let mut p = [0.0; MAX_ORDER];
                let p = &mut p[..own.traction.len()];
                legendre_p(t, p);
                (traction, along) = (own.traction_at(p, speed), series(&own.derivative, p).map(|d| d / speed));
            }
            let half = piece.half;
            for n in 0..piece.traction.len() {
                let (log, [xx, yy, xy]) = at.slope(n, tangent);
                let d = piece.derivative[n];
                hypersingular[0] -= k.c_w * ((xx - log) * d[0] + xy * d[1]);
                hypersingular[1] -= k.c_w * (xy * d[0] + (yy - log) * d[1]);
                let s = piece.traction[n].map(|c| half * c);
                if b != e || !own.curve.is_line() {
                    let double = at.adjoint(n, tangent);
                    for i in 0..2 {
                        adjoint[i] += double * s[i];
                        adjoint_u[i] += double * d[i];
                    }
                }
                let (hxx, hyy, hxy) = (k.h_log * log + k.h_rr * xx, k.h_log * log + k.h_rr * yy, k.h_rr * xy);
                slope[0] += hxx * s[0] + hxy * s[1];
                slope[1] += hxy * s[0] + hyy * s[1];
                slope_u[0] += hxy * d[0] - hxx * d[1];
                slope_u[1] += hyy * d[0] - hxy * d[1];
                single[0] += k.c_v * ((xx - k.kappa * log) * s[0] + xy * s[1]);
                single[1] += k.c_v * (xy * s[0] + (yy - k.kappa * log) * s[1]);
            }
        }
        let turned = turned(slope);
        let steklov = |i: usize| hypersingular[i] + adjoint[i] + turned[i] + 0.5 * traction[i];
        let equation = |i: usize| slope_u[i] - adjoint_u[i] + 0.5 * along[i] - single[i];
        ([steklov(0), steklov(1)], [equation(0), equation(1)])
    }
}

/// Σ c_n P_n.
fn series(c: &[[f64; 2]], p: &[f64]) -> [f64; 2] {
    c.iter().zip(p).fold([0.0; 2], |s, (c, p)| [s[0] + c[0] * p, s[1] + c[1] * p])
}

impl Piece {
    /// The functions of [`crate::far_potential`].
    fn series(&self, k: &Constants) -> Series {
        let scale = self.half * k.c_v;
        // J u' = (-u'_y, u'_x)
        let of = |t_factor: f64, h: f64| {
            let both = self.traction.iter().zip(&self.derivative);
            both.map(|(t, d)| [t_factor * t[0] + h * d[1], t_factor * t[1] - h * d[0]]).collect()
        };
        Series {
            a: of(scale, k.h_rr),
            b: of(-k.kappa * scale, k.h_log),
            derivative: self.derivative.clone(),
            displacement: self.displacement.clone(),
        }
    }

    /// Adds the displacement and its gradient at a point off the element, by exact integrals.
    fn add_near(&self, k: &Constants, x: Complex64, at: &mut AtPoint, u: &mut [f64; 2], gradient: &mut [[f64; 2]; 2]) {
        at.at_distance(self, x);
        for n in 0..self.traction.len() {
            self.add_terms(k, at, n, (self.traction[n], self.derivative[n]), (&mut *u, &mut *gradient));
        }
        for (n, c) in self.displacement.iter().enumerate() {
            at.add_double(n, *c, u);
        }
    }

    /// Adds what the coefficients n of traction and derivative have of displacement and gradient.
    pub(crate) fn add_terms(
        &self,
        k: &Constants,
        at: &AtPoint,
        n: usize,
        (t, d): ([f64; 2], [f64; 2]),
        (u, gradient): (&mut [f64; 2], &mut [[f64; 2]; 2]),
    ) {
        let scale = self.half * k.c_v;
        let add = |sum: &mut [f64; 2], log: f64, [xx, yy, xy]: [f64; 3]| {
            sum[0] += scale * ((xx - k.kappa * log) * t[0] + xy * t[1]);
            sum[1] += scale * (xy * t[0] + (yy - k.kappa * log) * t[1]);
            // H J û', J û' = (-û'_y, û'_x)
            let (hxx, hyy, hxy) = (k.h_log * log + k.h_rr * xx, k.h_log * log + k.h_rr * yy, k.h_rr * xy);
            sum[0] -= -hxx * d[1] + hxy * d[0];
            sum[1] -= -hxy * d[1] + hyy * d[0];
        };
        add(u, at.log(n), at.direction(n));
        for (axis, along) in [Complex64::ONE, Complex64::I].into_iter().enumerate() {
            let (log, rr) = at.slope(n, along);
            let mut sum = [0.0; 2];
            add(&mut sum, log, rr);
            let double = at.double_slope(n, along);
            gradient[0][axis] += sum[0] - double * d[0];
            gradient[1][axis] += sum[1] - double * d[1];
        }
    }

    /// The traction, Σ ψ_n P_n times half of the length over |γ'|, from the P_n.
    fn traction_at(&self, p: &[f64], speed: f64) -> [f64; 2] {
        let sum = series(&self.traction, p);
        if speed == self.half { sum } else { sum.map(|t| t * self.half / speed) }
    }
}

/// Legendre functions of one element at one point, or the integrals over it if it is curved.
pub(crate) struct AtPoint {
    curved: Option<Box<Inner>>,
    log_length: f64,
    q: [Complex64; MAX_ORDER],
    dq: [Complex64; MAX_ORDER],
    /// 1/d.
    inverse: Complex64,
    /// d/d̄.
    turn: Complex64,
    z_im: f64,
    /// ∫ log|x-y| dt less 2 log L.
    log0: f64,
}

impl Default for AtPoint {
    fn default() -> Self {
        let zeros = [Complex64::ZERO; MAX_ORDER];
        Self {
            curved: None,
            log_length: 0.0,
            q: zeros,
            dq: zeros,
            inverse: Complex64::ONE,
            turn: Complex64::ONE,
            z_im: 0.0,
            log0: 0.0,
        }
    }
}

impl AtPoint {
    /// The point t of the element `own` of the boundary, which may be the piece itself.
    pub(crate) fn on_boundary(&mut self, piece: &Piece, own: &Piece, same: bool, t: f64) {
        if same {
            return self.on_piece(piece, t);
        }
        let (before, after) = ((1.0 + t) / 2.0, (1.0 - t) / 2.0);
        if !(own.curve.is_line() && piece.curve.is_line()) {
            let from = own.curve.differences(before, after, [piece.segment.start, piece.segment.end]);
            return self.off_piece(piece, from, true);
        }
        let Segment { start, end } = own.segment;
        let from = |y: Complex64| ((start - y) * after + (end - y) * before) * piece.inverse;
        self.curved = None;
        self.off_cut(piece, from(piece.segment.end), from(piece.segment.start));
    }

    /// A point off the element.
    pub(crate) fn at_distance(&mut self, piece: &Piece, x: Complex64) {
        let Segment { start, end } = piece.segment;
        self.off_piece(piece, [x - start, x - end], true);
    }

    /// Adds the displacement of the double layer of the coefficient n.
    pub(crate) fn add_double(&self, n: usize, c: [f64; 2], u: &mut [f64; 2]) {
        let double = self.double(n);
        u[0] -= double * c[0];
        u[1] -= double * c[1];
    }

    /// A point off the element, from x - v₀ and x - v₁.
    fn off_piece(&mut self, piece: &Piece, from: [Complex64; 2], gradient: bool) {
        if piece.curve.is_line() {
            self.curved = None;
            return self.off_cut(piece, from[1] * piece.inverse, from[0] * piece.inverse);
        }
        self.log_length = piece.log_length;
        self.curved.get_or_insert_default().off_curve(&piece.curve, from, piece.displacement.len(), gradient);
    }

    /// The point t of the element itself: principal values.
    fn on_piece(&mut self, piece: &Piece, t: f64) {
        if piece.curve.is_line() {
            self.curved = None;
            return self.on_cut(piece, t);
        }
        self.log_length = piece.log_length;
        self.curved.get_or_insert_default().on_curve(&piece.curve, t, piece.displacement.len());
    }

    /// A point off the element, from z - 1 and z + 1.
    fn off_cut(&mut self, piece: &Piece, from_end: Complex64, from_start: Complex64) {
        let count = piece.displacement.len();
        legendre_q(from_end, from_start, &mut self.q[..count]);
        legendre_dq(from_end, from_start, &self.q[..count], &mut self.dq[..count]);
        self.z_im = if from_end.norm_sqr() < from_start.norm_sqr() { from_end.im } else { from_start.im };
        self.set(piece, 0.5 * (from_end.norm_sqr() * from_start.norm_sqr()).ln());
    }

    /// The point t of the straight element itself: principal values.
    fn on_cut(&mut self, piece: &Piece, t: f64) {
        let mut real = [0.0; MAX_ORDER];
        let real = &mut real[..piece.displacement.len()];
        legendre_q_cut(t, real);
        for (n, &q) in real.iter().enumerate() {
            self.q[n] = Complex64::new(q, 0.0);
            self.dq[n] = Complex64::ZERO;
        }
        self.z_im = 0.0;
        self.set(piece, (1.0 - t).ln() + (1.0 + t).ln());
    }

    /// `log_ends` = log|z-1| + log|z+1|.
    fn set(&mut self, piece: &Piece, log_ends: f64) {
        let d = piece.segment.half();
        self.inverse = piece.inverse;
        self.turn = d * d / d.norm_sqr();
        self.log0 = 2.0 * self.q[1].re + log_ends + 2.0 * piece.log_half;
    }

    /// ∫ P_n log(|x-y|/L) dt.
    fn log(&self, n: usize) -> f64 {
        if let Some(inner) = &self.curved {
            return if n == 0 { inner.log(0) - 2.0 * self.log_length } else { inner.log(n) };
        }
        if n == 0 { self.log0 } else { 2.0 / (2 * n + 1) as f64 * (self.q[n + 1].re - self.q[n - 1].re) }
    }

    /// ∫ P_n r_i r_j/r² dt: xx, yy, xy.
    fn direction(&self, n: usize) -> [f64; 3] {
        let one = if n == 0 { 2.0 } else { 0.0 };
        let e = match &self.curved {
            Some(inner) => inner.e[n],
            None => self.turn * (one + Complex64::new(0.0, 4.0 * self.z_im) * self.q[n].conj()),
        };
        [(one + e.re) / 2.0, (one - e.re) / 2.0, e.im / 2.0]
    }

    /// (1/2π) ∫ P_n (x-y)·n_y |γ'|/r² dt.
    fn double(&self, n: usize) -> f64 {
        match &self.curved {
            Some(inner) => 0.5 * inner.d[n].im / std::f64::consts::PI,
            None => self.q[n].im / std::f64::consts::PI,
        }
    }

    /// Contribution of du/dt = P_n to the derivative of the double layer along a direction, without its sign.
    fn double_slope(&self, n: usize, along: Complex64) -> f64 {
        match &self.curved {
            Some(inner) => 0.5 * (along * inner.f[n]).im / std::f64::consts::PI,
            None => (along * self.inverse * self.q[n]).im / std::f64::consts::PI,
        }
    }

    /// -(1/2π) ∫ P_n n_x·(x-y)/r² dt of a point on a boundary with this tangent, which is 0 on a straight element itself.
    pub(crate) fn adjoint(&self, n: usize, tangent: Complex64) -> f64 {
        let normal = -Complex64::I * tangent;
        if let Some(inner) = &self.curved {
            return -0.5 * (normal * inner.f[n]).re / std::f64::consts::PI;
        }
        -(normal * self.inverse * self.q[n]).re / std::f64::consts::PI
    }

    /// Derivatives of `log` and `direction` along a direction.
    pub(crate) fn slope(&self, n: usize, along: Complex64) -> (f64, [f64; 3]) {
        if let Some(inner) = &self.curved {
            let e = along * inner.f[n].conj() + along.conj() * inner.x[n];
            return ((along * inner.f[n]).re, [e.re / 2.0, -e.re / 2.0, e.im / 2.0]);
        }
        let dz = along * self.inverse;
        let log = 2.0 * (self.q[n] * dz).re;
        let inner = self.q[n].conj() * dz.im + (self.dq[n] * dz).conj() * self.z_im;
        let e = self.turn * Complex64::new(0.0, 4.0) * inner;
        (log, [e.re / 2.0, -e.re / 2.0, e.im / 2.0])
    }
}
