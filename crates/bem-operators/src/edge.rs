//! Edges of a body: lines, circular and elliptic arcs, cubic Bézier curves, by a parameter s ∈ [0, 1] in the order in which
//! the corners are listed.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::RangeInclusive;

use num_complex::Complex64;
use steklov_elastic::plane::{self, cross, distance, minus};
use steklov_quadrature::gauss_legendre;

use crate::curve::{Curve, Shape, cis_minus_one, evaluate};
use crate::moments::Segment;

/// How an edge runs from its corner k to the next.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Path {
    /// Straight.
    #[default]
    Line,
    /// A circular arc that turns by this angle, less than 360° in size, positive counter-clockwise; s is the fraction of its length.
    Arc {
        /// Angle in radians.
        opening: f64,
    },
    /// An elliptic arc c + exp(iφ)(a cos θ + i b sin θ), θ linear in s.
    Ellipse {
        /// Half axes a and b.
        radii: [f64; 2],
        /// Angle φ from the x axis to the first half axis.
        angle: f64,
        /// θ at the first corner.
        start: f64,
        /// θ at the second corner less that at the first one, positive counter-clockwise.
        opening: f64,
    },
    /// A cubic Bézier curve with these control points between the corners.
    Cubic {
        /// The second and third control point.
        control: [[f64; 2]; 2],
    },
}

/// Openings beyond this are not arcs but circles.
pub const LARGEST_OPENING: f64 = 0.999 * TAU;
/// An ellipse is a polynomial to the last digit on pieces of up to this half opening.
const ELLIPTIC: f64 = 1.0;
/// Parts of an edge over which lengths and areas are integrated with 24 points each.
const PARTS: f64 = 16.0;
/// Number of Taylor coefficients of such a piece: 1.7^24/24! is below 1e-17.
const TERMS: usize = 26;

/// One edge, in the direction of traversal (body to the left).
#[derive(Debug, Clone, PartialEq)]
pub struct Edge {
    /// First point in the direction of traversal.
    pub start: [f64; 2],
    /// Last point in the direction of traversal.
    pub end: [f64; 2],
    /// How it runs, in the order in which the corners were listed.
    pub path: Path,
    /// Index into [`crate::Polygon::side_names`].
    pub side: usize,
    /// Index into [`crate::Polygon::loops`]: 0 for the outer loop, k for the k-th hole; of an unbounded body 0 for the first hole.
    pub loop_index: usize,
    /// Whether the corners were listed against the traversal: a hole listed counter-clockwise.
    pub reversed: bool,
    /// Its part of the edge as drawn: fractions of the drawn edge's length at s = 0 and 1.
    pub drawn: [f64; 2],
}

pub(crate) fn complex([x, y]: [f64; 2]) -> Complex64 {
    Complex64::new(x, y)
}

impl Edge {
    /// Whether it is straight.
    pub fn is_line(&self) -> bool {
        self.path == Path::Line
    }

    /// The edge parameter at which its traversal ends.
    pub fn at_end(&self) -> f64 {
        if self.reversed { 0.0 } else { 1.0 }
    }

    /// First and second corner in the order in which they were listed.
    pub fn listed(&self) -> [[f64; 2]; 2] {
        if self.reversed { [self.end, self.start] } else { [self.start, self.end] }
    }

    /// Point at the edge parameter s ∈ [0, 1], which runs in the order in which the corners were listed.
    /// Measured from the nearer corner, so that both corners are met exactly.
    pub fn point(&self, s: f64) -> [f64; 2] {
        let [a, b] = self.listed();
        if self.is_line() {
            let d = minus(b, a);
            return if s <= 0.5 {
                [a[0] + d[0] * s, a[1] + d[1] * s]
            } else {
                [b[0] - d[0] * (1.0 - s), b[1] - d[1] * (1.0 - s)]
            };
        }
        let (corner, from) = if s <= 0.5 { (a, self.beyond_corner(s, 0.0)) } else { (b, self.beyond_corner(s, 1.0)) };
        [corner[0] + from.re, corner[1] + from.im]
    }

    /// γ(s) - γ(s₀), s₀ = 0 or 1.
    fn beyond_corner(&self, s: f64, s0: f64) -> Complex64 {
        let [a, b] = self.listed().map(complex);
        match self.path {
            Path::Line => (b - a) * (s - s0),
            Path::Arc { opening } => {
                // the arm from the centre to the corner, from the chord
                let toward = if s0 == 0.0 { -0.5 } else { 0.5 };
                let arm = Complex64::cis(opening * toward) * (b - a) / Complex64::new(0.0, 2.0 * (opening / 2.0).sin());
                arm * cis_minus_one(opening * (s - s0))
            }
            Path::Ellipse { opening, .. } => {
                let [p, q] = self.foci_arms(s0);
                let turn = opening * (s - s0);
                p * cis_minus_one(turn) + q * cis_minus_one(-turn)
            }
            Path::Cubic { .. } => {
                let mut taylor = self.taylor(s0, 1.0);
                taylor[0] = Complex64::ZERO;
                evaluate(&taylor, (s - s0).into())
            }
        }
    }

    /// p and q of an ellipse γ = c + p exp(iΔ) + q exp(-iΔ) about the parameter s, Δ = θ(s') - θ(s).
    fn foci_arms(&self, s: f64) -> [Complex64; 2] {
        let Path::Ellipse { radii: [a, b], angle, start, opening } = self.path else {
            return [Complex64::ZERO; 2];
        };
        let theta = start + opening * s;
        [Complex64::cis(angle + theta) * ((a + b) / 2.0), Complex64::cis(angle - theta) * ((a - b) / 2.0)]
    }

    /// Taylor coefficients of γ(s + h t) in t.
    fn taylor(&self, s: f64, h: f64) -> Vec<Complex64> {
        let [a, b] = self.listed().map(complex);
        match self.path {
            Path::Line => vec![a + (b - a) * s, (b - a) * h],
            Path::Cubic { control } => {
                let [c, d] = control.map(complex);
                let u = 1.0 - s;
                let point = u * u * u * a + 3.0 * s * u * u * c + 3.0 * s * s * u * d + s * s * s * b;
                let first = 3.0 * (u * u * (c - a) + 2.0 * s * u * (d - c) + s * s * (b - d));
                let second = 3.0 * (u * (d - 2.0 * c + a) + s * (b - 2.0 * d + c));
                let third = b - 3.0 * (d - c) - a;
                vec![point, first * h, second * (h * h), third * (h * h * h)]
            }
            Path::Arc { .. } => Vec::new(),
            Path::Ellipse { opening, .. } => {
                let [p, q] = self.foci_arms(s);
                let step = Complex64::new(0.0, opening * h);
                let (mut up, mut down) = (p, q);
                let mut terms = vec![p + q];
                for k in 1..TERMS {
                    up *= step / k as f64;
                    down *= -step / k as f64;
                    terms.push(up + down);
                }
                terms
            }
        }
    }

    /// γ'(s) in the order of listing.
    pub fn derivative(&self, s: f64) -> [f64; 2] {
        let slope = match self.path {
            Path::Line => complex(self.listed()[1]) - complex(self.listed()[0]),
            Path::Arc { opening } => {
                let [a, b] = self.listed().map(complex);
                (b - a) * Complex64::cis(opening * (s - 0.5)) * (opening / 2.0) / (opening / 2.0).sin()
            }
            Path::Ellipse { opening, .. } => {
                let [p, q] = self.foci_arms(s);
                Complex64::new(0.0, opening) * (p - q)
            }
            Path::Cubic { .. } => self.taylor(s, 1.0)[1],
        };
        [slope.re, slope.im]
    }

    /// Unit tangent at s in the direction of traversal.
    pub fn tangent(&self, s: f64) -> [f64; 2] {
        let [x, y] = self.derivative(s);
        let r = if self.reversed { -x.hypot(y) } else { x.hypot(y) };
        [x / r, y / r]
    }

    /// Upper bound of |γ''| on an interval of s.
    fn bend_on(&self, interval: RangeInclusive<f64>) -> f64 {
        match self.path {
            Path::Line => 0.0,
            Path::Arc { opening } => {
                let radius = distance(self.start, self.end) / (2.0 * (opening / 2.0).sin().abs());
                radius * opening * opening
            }
            Path::Ellipse { radii, opening, .. } => radii[0].max(radii[1]) * opening * opening,
            // linear in s
            Path::Cubic { .. } => [*interval.start(), *interval.end()]
                .map(|s| 2.0 * self.taylor(s, 1.0)[2].norm())
                .into_iter()
                .fold(0.0, f64::max),
        }
    }

    /// Upper bound of |γ''|.
    pub fn bend(&self) -> f64 {
        self.bend_on(0.0..=1.0)
    }

    /// Whether the parameter is the fraction of the length.
    pub fn is_arc_length(&self) -> bool {
        matches!(self.path, Path::Line | Path::Arc { .. })
    }

    /// Bits of its corners and of its other data, in the order of listing.
    pub fn listed_bits(&self) -> Vec<u64> {
        let mut numbers: Vec<f64> = self.listed().into_iter().flatten().collect();
        match self.path {
            Path::Line => {}
            Path::Arc { opening } => numbers.push(opening),
            Path::Ellipse { radii, angle, start, opening } => {
                numbers.extend([radii[0], radii[1], angle, start, opening])
            }
            Path::Cubic { control } => numbers.extend(control.into_iter().flatten()),
        }
        numbers.into_iter().map(f64::to_bits).collect()
    }

    /// Upper bound of the distance from the chord to the points between two parameters.
    pub(crate) fn deviation(&self, low: f64, high: f64) -> f64 {
        (high - low) * (high - low) / 8.0 * self.bend_on(low..=high)
    }

    /// The shape of the element from s₀ to s₁, in this order, and its unit tangent in the middle.
    pub(crate) fn element(&self, [s0, s1]: [f64; 2]) -> (Shape, [f64; 2]) {
        let (middle, half) = ((s0 + s1) / 2.0, (s1 - s0) / 2.0);
        let shape = match self.path {
            Path::Line => Shape::Line,
            Path::Arc { opening } => Shape::Arc(opening * half),
            Path::Ellipse { .. } | Path::Cubic { .. } => {
                let taylor = self.taylor(middle, half);
                let mut b: Vec<Complex64> = taylor[2..].iter().map(|a| a / taylor[1]).collect();
                // what is below rounding on the ellipse of injectivity
                let counts = |k: usize, b: &Complex64| b.norm() * 1.7f64.powi(k as i32 + 2) > 1e-18;
                let last = b.iter().enumerate().rposition(|(k, b)| counts(k, b)).map_or(0, |k| k + 1);
                b.truncate(last);
                if b.is_empty() { Shape::Line } else { Shape::of_coefficients(b.into_iter()) }
            }
        };
        let [x, y] = self.derivative(middle);
        let r = if half < 0.0 { -x.hypot(y) } else { x.hypot(y) };
        (shape, [x / r, y / r])
    }

    /// The element between two parameters.
    fn curve(&self, s0: f64, s1: f64) -> Curve {
        let [start, end] = [s0, s1].map(|s| complex(self.point(s)));
        Curve::new(Segment { start, end }, &self.element([s0, s1]).0)
    }

    /// Whether the rules of this crate hold on an element between these parameters.
    pub fn is_admissible(&self, s0: f64, s1: f64) -> bool {
        match self.path {
            Path::Line => true,
            Path::Arc { opening } => (opening * (s1 - s0) / 2.0).abs() <= FRAC_PI_2 * (1.0 + 1e-12),
            Path::Ellipse { opening, .. } if (opening * (s1 - s0) / 2.0).abs() > ELLIPTIC => false,
            _ => self.curve(s0, s1).is_admissible(),
        }
    }

    /// Parameters at which the element between two parameters is cut by repeated halving until its parts are admissible; no
    /// part is halved below `shortest`.
    pub fn needed_cuts(&self, [low, high]: [f64; 2], shortest: f64) -> Vec<f64> {
        let (mut stack, mut cuts) = (vec![[low, high]], Vec::new());
        while let Some([a, b]) = stack.pop() {
            if b - a < shortest || self.is_admissible(a, b) {
                cuts.push(b);
                continue;
            }
            let middle = (a + b) / 2.0;
            stack.extend([[middle, b], [a, middle]]);
        }
        cuts.pop();
        cuts
    }

    /// ∫ f(s, γ'(s)) ds over [0, `to`] by Gauss rules that are exact to rounding on such paths.
    fn integrate<const N: usize>(&self, to: f64, f: impl Fn(f64, [f64; 2]) -> [f64; N]) -> [f64; N] {
        let parts = (PARTS * to).ceil().max(1.0) as usize;
        let rule = gauss_legendre(24);
        let width = to / parts as f64;
        let mut sum = [0.0; N];
        for k in 0..parts {
            let part = rule.mapped(k as f64 * width, (k + 1) as f64 * width);
            let mut of_part = [0.0; N];
            for (&s, weight) in part.points.iter().zip(&part.weights) {
                of_part.iter_mut().zip(f(s, self.derivative(s))).for_each(|(sum, f)| *sum += weight * f);
            }
            sum.iter_mut().zip(of_part).for_each(|(sum, part)| *sum += part);
        }
        sum
    }

    /// Length of the edge.
    pub fn length(&self) -> f64 {
        let chord = distance(self.start, self.end);
        match self.path {
            Path::Line => chord,
            Path::Arc { opening } => chord * (opening / 2.0 / (opening / 2.0).sin()).abs(),
            _ => self.integrate(1.0, |_, [x, y]| [x.hypot(y)])[0],
        }
    }

    /// Fraction of the length up to the parameter s: s itself on lines and circular arcs.
    pub fn arc_fraction(&self, s: f64) -> f64 {
        match self.path {
            _ if self.is_arc_length() => s,
            _ if s <= 0.0 || s >= 1.0 => s,
            _ => self.integrate(s, |_, [x, y]| [x.hypot(y)])[0] / self.length(),
        }
    }

    /// Fraction of the drawn edge's length up to the parameter s.
    pub fn drawn_fraction(&self, s: f64) -> f64 {
        let ([a, b], fraction) = (self.drawn, self.arc_fraction(s));
        if [a, b] == [0.0, 1.0] { fraction } else { a + (b - a) * fraction }
    }

    /// The path between two parameters, in this order.
    fn path_between(&self, [s0, s1]: [f64; 2]) -> Path {
        match self.path {
            Path::Line => Path::Line,
            Path::Arc { opening } => Path::Arc { opening: opening * (s1 - s0) },
            Path::Ellipse { radii, angle, start, opening } => {
                Path::Ellipse { radii, angle, start: start + opening * s0, opening: opening * (s1 - s0) }
            }
            Path::Cubic { .. } => {
                let h = s1 - s0;
                let control = [(s0, 1.0), (s1, -1.0)].map(|(s, sign)| {
                    let (point, slope) = (self.point(s), self.derivative(s));
                    [0, 1].map(|i| point[i] + sign * h * slope[i] / 3.0)
                });
                Path::Cubic { control }
            }
        }
    }

    /// The part between two parameters, traversed and listed in this order.
    pub(crate) fn part(&self, [s0, s1]: [f64; 2], [start, end]: [[f64; 2]; 2]) -> Edge {
        let drawn = [s0, s1].map(|s| self.drawn_fraction(s));
        Edge { start, end, path: self.path_between([s0, s1]), reversed: false, drawn, ..*self }
    }

    /// Twice the area between the chord and the edge, and its first moments about `o`, in the direction of traversal:
    /// positive where the edge lies to the right of its chord.
    pub(crate) fn bulge(&self, o: [f64; 2]) -> [f64; 3] {
        if self.is_line() {
            return [0.0; 3];
        }
        let sign = if self.reversed { -1.0 } else { 1.0 };
        let a = self.listed()[0];
        // the closed curve of edge and chord back, from corner a
        // ∫ x dA = ⅓ ∮ x (x dy - y dx); along the chord x × dx vanishes
        let all = self.integrate(1.0, |s, d| {
            let r = minus(self.point(s), a);
            let twice = cross(r, d);
            [twice, r[0] * twice, r[1] * twice]
        });
        let [twice, mx, my] = [all[0], all[1] / 3.0, all[2] / 3.0].map(|of| sign * of);
        [twice, mx + (a[0] - o[0]) * twice / 2.0, my + (a[1] - o[1]) * twice / 2.0]
    }

    /// The first number of [`Self::bulge`], closed for circles and ellipses.
    pub(crate) fn twice_segment(&self) -> f64 {
        let sign = if self.reversed { -1.0 } else { 1.0 };
        match self.path {
            Path::Line => 0.0,
            Path::Arc { opening } => {
                let radius = distance(self.start, self.end) / 2.0 / (opening / 2.0).sin();
                sign * radius * radius * (opening - opening.sin())
            }
            Path::Ellipse { radii: [a, b], opening, .. } => sign * a * b * (opening - opening.sin()),
            Path::Cubic { .. } => self.bulge(self.start)[0],
        }
    }

    /// Outward unit normal at s.
    pub fn normal(&self, s: f64) -> [f64; 2] {
        let [x, y] = self.tangent(s);
        [y, -x]
    }

    /// Points that span the edge: its corners and, on a curve, enough other points that no point is far from all of them.
    pub fn extent(&self) -> Vec<[f64; 2]> {
        let count = if self.is_line() { 1 } else { 32 };
        (0..=count).map(|k| self.point(k as f64 / count as f64)).collect()
    }

    /// Angle by which the edge turns from its start to its end, in size.
    pub fn turning(&self) -> f64 {
        match self.path {
            Path::Line => 0.0,
            Path::Arc { opening } => opening.abs(),
            _ => {
                let parts = 64;
                let tangents: Vec<[f64; 2]> = (0..=parts).map(|k| self.tangent(k as f64 / parts as f64)).collect();
                tangents.windows(2).map(|t| angle(t[0], t[1]).abs()).sum()
            }
        }
    }

    /// Signed curvature at s, positive where the edge turns left in the direction of traversal.
    pub fn curvature(&self, s: f64) -> f64 {
        let sign = if self.reversed { -1.0 } else { 1.0 };
        match self.path {
            Path::Line => 0.0,
            Path::Arc { opening } => sign * opening / self.length(),
            _ => {
                let taylor = self.taylor(s, 1.0);
                let (d, dd) = (taylor[1], 2.0 * taylor[2]);
                sign * (d.conj() * dd).im / d.norm().powi(3)
            }
        }
    }
}

/// Angle from one direction to another, -π to π.
pub(crate) fn angle(a: [f64; 2], b: [f64; 2]) -> f64 {
    let angle = plane::angle(a, b);
    if angle == -PI { PI } else { angle }
}
