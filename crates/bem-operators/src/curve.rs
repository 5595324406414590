//! The curves that elements lie on: lines, circular arcs and polynomials of a parameter t ∈ [-1, 1].
//!
//! Points are complex numbers. Everything is measured from the end points, which are given: c + R exp(iθ) would lose the
//! digits of R/h on flat arcs. With d = (v₁-v₀)/2 and half the opening α,
//!
//! ```text
//! A₀ = v₀ - c = -i d exp(-iα)/sin α,   A₁ = v₁ - c = -i d exp(iα)/sin α,   R = |d|/|sin α|,   |γ'| = R |α|
//! γ(t) - v₀ = A₀ (exp(iα(1+t)) - 1),   γ(t) - v₁ = A₁ (exp(-iα(1-t)) - 1)
//! ```

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use num_complex::Complex64;
use steklov_quadrature::{bernstein, gauss_legendre, log_bernstein};

use crate::moments::Segment;

/// How an element runs from its start to its end; halving the element halves its parameter.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Shape {
    /// γ(t) = c + d t.
    #[default]
    Line,
    /// A circular arc with constant |γ'|, whose opening is twice this angle: positive counter-clockwise, at most π/2 in size.
    Arc(f64),
    /// γ(t) = γ(0) + γ'(0) (t + b_2 t² + b_3 t³ + …).
    Polynomial(Arc<Polynomial>),
}

/// A polynomial t + b_2 t² + b_3 t³ + … with data derived from it.
#[derive(Debug, Clone, PartialEq)]
pub struct Polynomial {
    /// 0, 1, b_2, b_3, …
    pub(crate) middle: Vec<Complex64>,
    /// Taylor coefficients about t = -1 and t = 1, the first of them 0.
    at_ends: [Vec<Complex64>; 2],
    /// Its value at 1 minus that at -1.
    whole: Complex64,
    /// ½ ∫|γ'| dt.
    half: f64,
}

impl Polynomial {
    fn new(middle: Vec<Complex64>) -> Self {
        let at_ends = [-1.0, 1.0].map(|t| {
            let mut taylor = shifted(&middle, t);
            taylor[0] = Complex64::ZERO;
            taylor
        });
        // 2 (1 + b_3 + b_5 + …)
        let whole = 2.0 * middle.iter().skip(1).step_by(2).sum::<Complex64>();
        let half = 0.5 * gauss_legendre(32).integrate(|t| evaluate_derivative(&middle, t.into()).norm());
        Self { middle, at_ends, whole, half }
    }
}

impl Shape {
    /// A polynomial curve of the real and imaginary parts of its coefficients.
    pub fn polynomial(numbers: &[f64]) -> Self {
        Self::of_coefficients(numbers.chunks_exact(2).map(|b| Complex64::new(b[0], b[1])))
    }

    /// A polynomial curve of b_2, b_3, …
    pub(crate) fn of_coefficients(b: impl Iterator<Item = Complex64>) -> Self {
        let middle = [Complex64::ZERO, Complex64::ONE].into_iter().chain(b).collect();
        Shape::Polynomial(Arc::new(Polynomial::new(middle)))
    }

    /// b_2, b_3, …, of a polynomial curve.
    pub fn coefficients(&self) -> &[Complex64] {
        match self {
            Shape::Polynomial(p) => &p.middle[2..],
            _ => &[],
        }
    }

    /// γ'(t)/γ'(0).
    pub fn turn(&self, t: f64) -> Complex64 {
        match self {
            Shape::Line => Complex64::ONE,
            Shape::Arc(alpha) => Complex64::cis(alpha * t),
            Shape::Polynomial(p) => evaluate_derivative(&p.middle, t.into()),
        }
    }
}

impl Shape {
    /// The shapes of both halves, t < 0 and t > 0.
    pub fn halves(&self) -> [Self; 2] {
        match self {
            Shape::Line => [Shape::Line, Shape::Line],
            Shape::Arc(alpha) => [Shape::Arc(alpha / 2.0), Shape::Arc(alpha / 2.0)],
            Shape::Polynomial(p) => [-0.5, 0.5].map(|middle| {
                let taylor = shifted(&p.middle, middle);
                let half = taylor.iter().enumerate().skip(2).map(|(k, a)| a / taylor[1] * 0.5f64.powi(k as i32 - 1));
                Shape::of_coefficients(half)
            }),
        }
    }
}

/// An element with its end points.
#[derive(Debug, Clone, PartialEq)]
pub enum Curve {
    /// A straight element.
    Line(Segment),
    /// A circular arc.
    Arc(CircularArc),
    /// A polynomial curve.
    Polynomial(PolynomialCurve),
}

/// A circular arc of at most 180°.
#[derive(Debug, Clone, PartialEq)]
pub struct CircularArc {
    pub(crate) ends: Segment,
    /// α.
    pub(crate) half_opening: f64,
    /// A₀, A₁.
    pub(crate) arms: [Complex64; 2],
    pub(crate) radius: f64,
}

/// A polynomial curve, injective on the Bernstein ellipse of parameter 3.
#[derive(Debug, Clone, PartialEq)]
pub struct PolynomialCurve {
    pub(crate) ends: Segment,
    /// γ'(0).
    pub(crate) slope: Complex64,
    /// (γ - γ(0))/γ'(0).
    pub(crate) of: Arc<Polynomial>,
}

/// Parameter of the Bernstein ellipse on which a polynomial element takes each value at most once.
pub(crate) const INJECTIVE: f64 = 3.0;

impl Curve {
    /// The curve of this shape between two points.
    pub fn new(ends: Segment, shape: &Shape) -> Self {
        match shape {
            Shape::Line => Curve::Line(ends),
            Shape::Arc(alpha) => Curve::Arc(CircularArc::new(ends, *alpha)),
            Shape::Polynomial(of) => {
                let slope = (ends.end - ends.start) / of.whole;
                Curve::Polynomial(PolynomialCurve { ends, slope, of: of.clone() })
            }
        }
    }

    /// The end points.
    pub fn ends(&self) -> Segment {
        match self {
            Curve::Line(ends) => *ends,
            Curve::Arc(arc) => arc.ends,
            Curve::Polynomial(curve) => curve.ends,
        }
    }

    /// Whether it is straight.
    pub fn is_line(&self) -> bool {
        matches!(self, Curve::Line(_))
    }

    /// Half of the length, ½ ∫|γ'|dt.
    pub fn half_length(&self) -> f64 {
        match self {
            Curve::Line(ends) => ends.half().norm(),
            Curve::Arc(arc) => arc.radius * arc.half_opening.abs(),
            Curve::Polynomial(curve) => curve.slope.norm() * curve.of.half,
        }
    }

    /// γ(t) - v₀ and γ(t) - v₁, each with its own relative accuracy, from (1+t)/2 and (1-t)/2.
    pub fn from_ends(&self, before: f64, after: f64) -> [Complex64; 2] {
        match self {
            Curve::Line(ends) => {
                let whole = ends.end - ends.start;
                [whole * before, -whole * after]
            }
            Curve::Arc(arc) => {
                let angle = 2.0 * arc.half_opening;
                [arc.arms[0] * cis_minus_one(angle * before), arc.arms[1] * cis_minus_one(-angle * after)]
            }
            Curve::Polynomial(curve) => {
                let whole = curve.ends.end - curve.ends.start;
                if before < after {
                    let from_start = curve.slope * evaluate(&curve.of.at_ends[0], (2.0 * before).into());
                    [from_start, from_start - whole]
                } else {
                    let from_end = curve.slope * evaluate(&curve.of.at_ends[1], (-2.0 * after).into());
                    [from_end + whole, from_end]
                }
            }
        }
    }

    /// γ(t) - v for two points v, exact where they are its own end points.
    pub(crate) fn differences(&self, before: f64, after: f64, from: [Complex64; 2]) -> [Complex64; 2] {
        let ([from_start, from_end], ends) = (self.from_ends(before, after), self.ends());
        from.map(|v| match v {
            _ if v == ends.start => from_start,
            _ if v == ends.end => from_end,
            _ if before < after => from_start + (ends.start - v),
            _ => from_end + (ends.end - v),
        })
    }

    /// γ(t).
    pub fn point(&self, t: f64) -> Complex64 {
        let ([from_start, from_end], ends) = (self.from_ends((1.0 + t) / 2.0, (1.0 - t) / 2.0), self.ends());
        if t <= 0.0 { ends.start + from_start } else { ends.end + from_end }
    }

    /// γ'(t).
    pub fn derivative(&self, t: f64) -> Complex64 {
        match self {
            Curve::Line(ends) => ends.half(),
            Curve::Arc(arc) => {
                let (arm, turned) = if t < 0.0 { (arc.arms[0], 1.0 + t) } else { (arc.arms[1], t - 1.0) };
                Complex64::I * arc.half_opening * arm * Complex64::cis(arc.half_opening * turned)
            }
            Curve::Polynomial(curve) => curve.slope * evaluate_derivative(&curve.of.middle, t.into()),
        }
    }

    /// z - 1 and z + 1 for the point z with γ(z) = x that is nearest to [-1, 1], from x - v₀ and x - v₁. None if the curve is
    /// a polynomial and z lies outside the Bernstein ellipse of parameter 3.
    ///
    /// Source: Helsing and Ojala (2008); af Klinteberg and Barnett (2021).
    pub fn preimage(&self, [x0, x1]: [Complex64; 2]) -> Option<[Complex64; 2]> {
        match self {
            Curve::Line(ends) => {
                let inverse = 1.0 / ends.half();
                Some([x1 * inverse, x0 * inverse])
            }
            Curve::Arc(arc) => Some(arc.preimage(x0, x1)),
            Curve::Polynomial(curve) => curve.preimage(x0, x1),
        }
    }

    /// Distance of a nearby point from the curve, and the parameter of the nearest point of the curve.
    pub fn nearest(&self, [x, y]: [f64; 2]) -> (f64, f64) {
        let (x, ends) = (Complex64::new(x, y), self.ends());
        let preimage = self.preimage([x - ends.start, x - ends.end]);
        let end = if (x - ends.start).norm_sqr() < (x - ends.end).norm_sqr() { -1.0 } else { 1.0 };
        let t = preimage.map_or(end, |[zm1, zp1]| ((zm1.re + zp1.re) / 2.0).clamp(-1.0, 1.0));
        ((x - self.point(t)).norm(), t)
    }

    /// Whether the rules of this crate hold on it: an arc of at most 180°; a polynomial curve that is injective on the ellipse
    /// of parameter 3, where γ' stays in a half plane.
    ///
    /// Source: Noshiro (1934) and Warschawski (1935) for the half plane.
    pub fn is_admissible(&self) -> bool {
        match self {
            Curve::Line(_) => true,
            Curve::Arc(arc) => arc.half_opening.abs() <= FRAC_PI_2 * (1.0 + 1e-12),
            Curve::Polynomial(curve) => {
                const POINTS: usize = 64;
                let turn = |k: usize| {
                    let w = INJECTIVE * Complex64::cis(2.0 * PI * k as f64 / POINTS as f64);
                    let ratio = evaluate_derivative(&curve.of.middle, (w + w.inv()) / 2.0);
                    if ratio.norm_sqr() > 0.0 { ratio.arg() } else { PI }
                };
                let (low, high) = (0..POINTS).map(turn).fold((0.0f64, 0.0f64), |(l, h), a| (l.min(a), h.max(a)));
                // less than π, by what may lie between the points
                high - low < PI - 0.3
            }
        }
    }
}

impl CircularArc {
    fn new(ends: Segment, half_opening: f64) -> Self {
        let scale = -Complex64::I * ends.half() / half_opening.sin();
        let turn = Complex64::cis(half_opening);
        let radius = ends.half().norm() / half_opening.sin().abs();
        Self { ends, half_opening, arms: [scale * turn.conj(), scale * turn], radius }
    }

    /// The centre.
    pub fn centre(&self) -> Complex64 {
        self.ends.start - self.arms[0]
    }

    fn preimage(&self, x0: Complex64, x1: Complex64) -> [Complex64; 2] {
        let factor = -Complex64::I / self.half_opening;
        let near = |x: Complex64| x.norm_sqr() < 0.25 * self.radius * self.radius;
        if near(x1) && x1.norm_sqr() <= x0.norm_sqr() {
            let zm1 = factor * ln_1p(x1 / self.arms[1]);
            [zm1, zm1 + 2.0]
        } else if near(x0) {
            let zp1 = factor * ln_1p(x0 / self.arms[0]);
            [zp1 - 2.0, zp1]
        } else {
            let arm = x0 + self.arms[0];
            let middle = self.arms[0] * Complex64::cis(self.half_opening);
            // next to the centre z is as far as rounding lets it be
            let ratio = if arm.norm_sqr() > 0.0 { arm / middle } else { Complex64::from(1e-30) };
            let z = factor * ratio.ln();
            [z - 1.0, z + 1.0]
        }
    }
}

impl PolynomialCurve {
    /// Newton's method from the nearest of some points of the curve, in the distance to the nearer end.
    fn preimage(&self, x0: Complex64, x1: Complex64) -> Option<[Complex64; 2]> {
        let Polynomial { middle, at_ends, half, .. } = &*self.of;
        let [x0, x1] = [x0, x1].map(|x| x / self.slope);
        // what is this far from γ(0) has no preimage in the ellipse
        let x = x0 + evaluate(middle, (-1.0).into());
        let far: f64 = middle.iter().skip(1).rev().fold(0.0, |sum, a| (sum + a.norm()) * AXIS);
        if x.norm() > far {
            return None;
        }
        let distance = |t: f64| (evaluate(middle, t.into()) - x).norm_sqr();
        let starts = [-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0];
        let nearest = starts.into_iter().min_by(|a, b| distance(*a).total_cmp(&distance(*b)))?;
        let aside = Complex64::new(0.0, 0.6);
        [Complex64::ZERO, aside, -aside].into_iter().find_map(|shift| {
            let mut z = nearest + shift;
            for _ in 0..20 {
                let step = (x - evaluate(middle, z)) / evaluate_derivative(middle, z);
                z += step;
                if z.norm_sqr() > 100.0 || step.norm_sqr() < 1e-24 {
                    break;
                }
            }
            let rho = bernstein(z);
            if rho.is_nan() || rho > INJECTIVE * 1.2 {
                return None;
            }
            let at_end = z.re >= 0.0;
            let (taylor, target) = if at_end { (&at_ends[1], x1) } else { (&at_ends[0], x0) };
            let mut u = if at_end { z - 1.0 } else { z + 1.0 };
            for _ in 0..3 {
                u += (target - evaluate(taylor, u)) / evaluate_derivative(taylor, u);
            }
            let missed = (target - evaluate(taylor, u)).norm();
            let pair = if at_end { [u, u + 2.0] } else { [u - 2.0, u] };
            let inside = log_bernstein(pair[0], pair[1]) <= INJECTIVE.ln();
            (missed <= 1e-13 * (target.norm() + half) && inside).then_some(pair)
        })
    }
}

/// Half the large axis of the Bernstein ellipse of parameter 3.
pub(crate) const AXIS: f64 = (INJECTIVE + 1.0 / INJECTIVE) / 2.0;

/// Σ a_k z^k.
pub(crate) fn evaluate(a: &[Complex64], z: Complex64) -> Complex64 {
    a.iter().rev().fold(Complex64::ZERO, |sum, a| sum * z + a)
}

/// Σ k a_k z^(k-1).
pub(crate) fn evaluate_derivative(a: &[Complex64], z: Complex64) -> Complex64 {
    let terms = a.iter().enumerate().skip(1).rev();
    terms.fold(Complex64::ZERO, |sum, (k, a)| sum * z + k as f64 * a)
}

/// Coefficients about `t` of a polynomial with the coefficients `a` about 0.
pub(crate) fn shifted(a: &[Complex64], t: f64) -> Vec<Complex64> {
    let mut a = a.to_vec();
    for low in 0..a.len() {
        for k in (low..a.len() - 1).rev() {
            let higher = a[k + 1];
            a[k] += t * higher;
        }
    }
    a
}

/// exp(iθ) - 1 without cancellation.
pub(crate) fn cis_minus_one(angle: f64) -> Complex64 {
    Complex64::new(0.0, 2.0 * (angle / 2.0).sin()) * Complex64::cis(angle / 2.0)
}

/// log(1 + x), principal branch, without cancellation.
fn ln_1p(x: Complex64) -> Complex64 {
    Complex64::new(0.5 * (x.re * (2.0 + x.re) + x.im * x.im).ln_1p(), x.im.atan2(1.0 + x.re))
}
