//! How fields behave at the vertex of a wedge: Williams' exponents.
//!
//! ```text
//! u = r^λ g(θ), data on the faces left out:  a real combination of four functions in each sector (Kolosov, φ = a z^λ, ψ = b z^λ)
//! D(λ) = det(conditions on faces and interfaces) = 0    stress ~ r^(λ-1): infinite where 0 < Re λ < 1
//! ```
//! The zeros of D, an entire function, are counted by the change of its argument around a strip.
//!
//! Source: Williams, J. Appl. Mech. 19 (1952); Dempsey and Sinclair (1979) for several sectors.

use std::f64::consts::PI;

use faer::{Mat, c64};

/// The condition on a face; components are along the ray out of the vertex and turned from it by +90 degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Face {
    /// No traction.
    Free,
    /// No displacement.
    Held,
    /// No displacement along a direction, no traction across it.
    HeldAlong([f64; 2]),
    /// No normal displacement, and this times the normal traction along the tangent that is the outward normal turned by +90
    /// degrees.
    Sliding(f64),
}

/// A sector of one material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sector {
    /// Angle (radian), up to 2π.
    pub angle: f64,
    /// Shear modulus; of a single sector any.
    pub mu: f64,
    /// κ of plane strain.
    pub kappa: f64,
}

/// The condition between two sectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Joint {
    /// Displacements and tractions are the same.
    Bonded,
    /// Closed, with shears as on [`Face::Sliding`] of either of them.
    Sliding(f64),
}

/// Sectors that follow each other counter-clockwise.
#[derive(Debug, Clone, PartialEq)]
pub struct Wedge {
    /// Its sectors, counter-clockwise.
    pub sectors: Vec<Sector>,
    /// Between each sector and the next one, of a closed wedge also between the last and the first; bonded where there is none.
    pub joints: Vec<Joint>,
    /// The first and the last face; none where the last sector is bonded to the first.
    pub faces: Option<[Face; 2]>,
}

/// Exponents nearer to 0 or 1 than this are not distinguished from translations and from uniform stress.
pub const MARGIN: f64 = 1e-3;
/// Zeros with a larger imaginary part, over one over the angle, have a real part above 1: e^24 outweighs λ² there.
const REACH: f64 = 12.0;
/// Relative change of D that a step of the contour may have.
const CHANGE: f64 = 0.5;
/// Steps of a side of the contour at first, and how often one is halved at most.
const STEPS: usize = 16;
const HALVINGS: usize = 40;

/// i.
const I: c64 = c64::new(0.0, 1.0);

/// [u_r, u_θ] times 2μ and [σ_rθ, σ_θθ] over λ, of the four functions at r = 1. They fall from one face or from the other as e^(-θ Im λ),
/// so that they stay independent and none is large.
fn functions(l: c64, sector: &Sector, theta: f64) -> [([c64; 2], [c64; 2]); 4] {
    let (m, n) = (l - 1.0, l + 1.0);
    let (less, more) = (-l + sector.kappa, l + sector.kappa);
    let one = c64::new(1.0, 0.0);
    let [away, back] = [theta, sector.angle - theta];
    let scaled = |e: c64, u: [c64; 2], t: [c64; 2]| (u.map(|u| e * u), t.map(|t| e * t));
    [
        scaled((I * m * away).exp(), [less, -I * more], [-I * m, n]),
        scaled((I * m * back).exp(), [less, I * more], [I * m, n]),
        scaled((I * n * away).exp(), [-one, -I], [-I, one]),
        scaled((I * n * back).exp(), [-one, I], [I, one]),
    ]
}

impl Wedge {
    /// Whether stresses are infinite at the vertex, for data that excite all exponents.
    pub fn is_singular(&self) -> bool {
        self.exponents_below(1.0 - MARGIN) > 0
    }

    /// The smallest real part of an exponent that is below `limit`, to 1e-3.
    pub fn least_exponent_below(&self, limit: f64) -> Option<f64> {
        if self.exponents_below(limit) == 0 {
            return None;
        }
        let (mut low, mut high) = (MARGIN, limit);
        while high - low > MARGIN {
            let middle = 0.5 * (low + high);
            if self.exponents_below(middle) > 0 { high = middle } else { low = middle }
        }
        Some(high)
    }

    /// Number of exponents λ with 1e-3 < Re λ < `limit`.
    pub fn exponents_below(&self, limit: f64) -> usize {
        let least = self.sectors.iter().map(|s| s.angle).fold(2.0 * PI, f64::min);
        let high = REACH / least;
        // the upper half of the strip's border: the lower half is its mirror image
        let corners = [(limit, 0.0), (limit, high), (MARGIN, high), (MARGIN, 0.0)];
        let mut turned = 0.0;
        for side in corners.windows(2) {
            let [a, b] = [side[0], side[1]].map(|(re, im)| c64::new(re, im));
            let at = |k: usize| a + (b - a) * (k as f64 / STEPS as f64);
            for k in 0..STEPS {
                let (from, to) = (at(k), at(k + 1));
                turned += self.turn((from, self.determinant(from)), (to, self.determinant(to)), HALVINGS);
            }
        }
        // D is real on the real axis up to the factors e^(2iλ angle) of the functions
        let factors: f64 = self.sectors.iter().map(|s| 2.0 * s.angle * (MARGIN - limit)).sum();
        ((turned - factors) / PI).round().max(0.0) as usize
    }

    /// Change of the argument of D between two points.
    fn turn(&self, (a, of_a): (c64, c64), (b, of_b): (c64, c64), halvings: usize) -> f64 {
        let middle = (a + b) * 0.5;
        let of_middle = self.determinant(middle);
        let ratios = [of_middle / of_a, of_b / of_middle];
        // also of the size: near a zero of D the argument turns by more than a half while the size grows by much
        if ratios.iter().all(|q| (q - 1.0).norm() < CHANGE) || halvings == 0 {
            return ratios.iter().map(|q| q.arg()).sum();
        }
        self.turn((a, of_a), (middle, of_middle), halvings - 1)
            + self.turn((middle, of_middle), (b, of_b), halvings - 1)
    }

    /// D(λ).
    fn determinant(&self, l: c64) -> c64 {
        self.conditions(l).determinant()
    }

    /// The conditions on faces and joints at λ: a row for each, a column for each function of each sector.
    fn conditions(&self, l: c64) -> Mat<c64> {
        let n = self.sectors.len();
        let mut rows = Mat::<c64>::zeros(4 * n, 4 * n);
        let mut row = 0;
        let mut put = |entries: &[(usize, [c64; 4])]| {
            for (sector, values) in entries {
                (0..4).for_each(|k| rows[(row, 4 * sector + k)] += values[k]);
            }
            row += 1;
        };
        if let Some(faces) = self.faces {
            for (face, sector, theta) in [(faces[0], 0, 0.0), (faces[1], n - 1, self.sectors[n - 1].angle)] {
                let f = functions(l, &self.sectors[sector], theta);
                for weights in conditions(face) {
                    let [u, v, t, s] = weights;
                    put(&[(sector, f.map(|(d, q)| d[0] * u + d[1] * v + q[0] * t + q[1] * s))]);
                }
            }
        }
        for k in 0..n {
            let next = (k + 1) % n;
            if next == 0 && self.faces.is_some() {
                continue;
            }
            let (a, b) = (&self.sectors[k], &self.sectors[next]);
            let [before, after] = [functions(l, a, a.angle), functions(l, b, 0.0)];
            // 1/μ over the sum of both: no entry is large
            let (soft, hard) = (b.mu / (a.mu + b.mu), a.mu / (a.mu + b.mu));
            let ratio = match self.joints.get(k) {
                Some(Joint::Sliding(ratio)) => Some(*ratio),
                Some(Joint::Bonded) | None => None,
            };
            if let Some(ratio) = ratio {
                put(&[(k, before.map(|(_, q)| q[0] + ratio * q[1]))]);
                put(&[(next, after.map(|(_, q)| q[0] + ratio * q[1]))]);
            }
            for i in if ratio.is_some() { 1..2 } else { 0..2 } {
                put(&[(k, before.map(|(d, _)| d[i] * soft)), (next, after.map(|(d, _)| -d[i] * hard))]);
                put(&[(k, before.map(|(_, q)| q[i])), (next, after.map(|(_, q)| -q[i]))]);
            }
        }
        rows
    }

    /// Whether data on faces and joints let the stress at the vertex grow like log(1/r), if no exponent makes it infinite: None if not, else
    /// whether the pressure on a sliding face or joint grows so too.
    ///
    /// At λ = 1 the conditions D(1) c = d may have no solution. Then u = r (log r Σ β_j n_j + c) with the solutions n_j of D(1) n = 0,
    /// of left ones w_i with w_i·D(1) = 0, and Σ β_j w_i·D'(1) n_j = w_i·d. A rotation among the n_j bears no stress.
    ///
    /// `rounding` is a stress that data may be off by; `faces` are those of the first and the last face, `joints` those before each
    /// joint less those behind it.
    pub fn logarithm(&self, faces: [Datum; 2], joints: &[Datum], rounding: f64) -> Option<bool> {
        let given = self.given(faces, joints);
        let size = given.iter().map(|v| v.norm()).fold(0.0, f64::max);
        let small = rounding.max(BORNE * size);
        if size <= rounding {
            return None;
        }
        let one = c64::new(1.0, 0.0);
        let svd = self.conditions(one).svd().ok()?;
        let singular: Vec<f64> = svd.S().column_vector().iter().map(|s| s.re).collect();
        let null: Vec<usize> = (0..given.len()).filter(|&k| singular[k] <= BORNE * singular[0]).collect();
        let column =
            |of: faer::MatRef<'_, c64>, k: usize| -> Vec<c64> { (0..given.len()).map(|i| of[(i, k)]).collect() };
        let kernel: Vec<Vec<c64>> = null.iter().map(|&k| column(svd.V(), k)).collect();
        let left: Vec<Vec<c64>> = null.iter().map(|&k| column(svd.U(), k)).collect();
        let slopes: Vec<Vec<c64>> = kernel.iter().map(|n| self.slope(n)).collect();
        let product = |a: &[c64], b: &[c64]| a.iter().zip(b).map(|(a, b)| a.conj() * b).sum::<c64>();
        let count = null.len();
        let matrix = Mat::from_fn(count, count, |i, j| product(&left[i], &slopes[j]));
        let right = Mat::from_fn(count, 1, |i, _| product(&left[i], &given));
        let beta = matrix.svd().ok()?.pseudoinverse() * right;
        let logarithm: Vec<c64> =
            (0..given.len()).map(|i| (0..count).map(|j| beta[(j, 0)] * kernel[j][i]).sum()).collect();
        let (largest, pressure) = self.stresses(&logarithm);
        (largest > small).then_some(pressure > small)
    }

    /// d/dλ of the conditions on functions with these coefficients at λ = 1, tractions as they are.
    fn slope(&self, coefficients: &[c64]) -> Vec<c64> {
        let kinds = self.kinds();
        let at = |step: f64| -> Vec<c64> {
            let l = c64::new(1.0 + step, 0.0);
            let rows = self.conditions(l);
            let of_row = |i: usize| {
                let sum: c64 = coefficients.iter().enumerate().map(|(j, c)| rows[(i, j)] * c).sum();
                if kinds[i] { sum * l } else { sum }
            };
            (0..coefficients.len()).map(of_row).collect()
        };
        let [less, more] = [at(-STEP), at(STEP)];
        less.iter().zip(&more).map(|(less, more)| (more - less) / (2.0 * STEP)).collect()
    }

    /// The largest stress σ_rθ, σ_θθ of functions with these coefficients at λ = 1, and the largest σ_θθ on sliding faces and joints,
    /// times log r a pressure.
    fn stresses(&self, coefficients: &[c64]) -> (f64, f64) {
        let one = c64::new(1.0, 0.0);
        let at = |k: usize, theta: f64| -> [f64; 2] {
            let f = functions(one, &self.sectors[k], theta);
            [0, 1].map(|i| (0..4).map(|j| f[j].1[i] * coefficients[4 * k + j]).sum::<c64>().re)
        };
        let mut largest = 0.0f64;
        for (k, sector) in self.sectors.iter().enumerate() {
            let stresses = (0..=SAMPLES).flat_map(|i| at(k, sector.angle * i as f64 / SAMPLES as f64));
            largest = stresses.fold(largest, |m, v| m.max(v.abs()));
        }
        let last = self.sectors.len() - 1;
        let ends = [(0, 0.0), (last, self.sectors[last].angle)];
        let faces = self.faces.into_iter().flatten().zip(ends).filter(|(face, _)| matches!(face, Face::Sliding(_)));
        let joints = self.joined().filter(|&k| matches!(self.joints.get(k), Some(Joint::Sliding(_))));
        let rays = faces.map(|(_, end)| end).chain(joints.map(|k| (k, self.sectors[k].angle)));
        (largest, rays.map(|(k, theta)| at(k, theta)[1]).fold(0.0, f64::max))
    }

    /// Whether each row of the conditions is one of tractions.
    fn kinds(&self) -> Vec<bool> {
        let of_face = |face: Face| conditions(face).map(|[u, v, _, _]| u == 0.0 && v == 0.0);
        let mut kinds: Vec<bool> = self.faces.into_iter().flatten().flat_map(of_face).collect();
        for k in self.joined() {
            match self.joints.get(k) {
                Some(Joint::Sliding(_)) => kinds.extend([true, true, false, true]),
                Some(Joint::Bonded) | None => kinds.extend([false, true, false, true]),
            }
        }
        kinds
    }

    /// The sectors that are joined to the next one.
    fn joined(&self) -> std::ops::Range<usize> {
        0..self.sectors.len() - usize::from(self.faces.is_some())
    }

    /// The right-hand sides of the conditions at λ = 1.
    fn given(&self, faces: [Datum; 2], joints: &[Datum]) -> Vec<c64> {
        let mut given = Vec::new();
        if let Some(own) = self.faces {
            for ((face, datum), sector) in
                own.into_iter().zip(faces).zip([&self.sectors[0], &self.sectors[self.sectors.len() - 1]])
            {
                let [u, v] = datum.displacement.map(|d| 2.0 * sector.mu * d);
                let [t, s] = datum.traction;
                given.extend(conditions(face).map(|w| w[0] * u + w[1] * v + w[2] * t + w[3] * s));
            }
        }
        for k in self.joined() {
            let [a, b] = [k, (k + 1) % self.sectors.len()].map(|k| self.sectors[k].mu);
            let Datum { displacement, traction } = joints.get(k).copied().unwrap_or_default();
            let [u, v] = displacement.map(|d| 2.0 * a * b / (a + b) * d);
            match self.joints.get(k) {
                Some(Joint::Sliding(_)) => given.extend([traction[0], traction[0], v, traction[1]]),
                Some(Joint::Bonded) | None => given.extend([u, traction[0], v, traction[1]]),
            }
        }
        given.into_iter().map(|v| c64::new(v, 0.0)).collect()
    }
}

/// Part of the data that rounding may leave, and part of the largest singular value below which one is 0.
const BORNE: f64 = 1e-7;
/// Parts of a sector between which stresses are looked at.
const SAMPLES: usize = 6;
/// Step of λ for a derivative.
const STEP: f64 = 1e-4;

/// What is given along a ray, along it and turned from it by +90 degrees: the change of the displacement with r, and the stresses σ_rθ
/// and σ_θθ, so far as the condition there says them. Of a sliding joint the first traction is its shear.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Datum {
    /// ∂u/∂r.
    pub displacement: [f64; 2],
    /// σ_rθ, σ_θθ.
    pub traction: [f64; 2],
}

/// Weights of u_r, u_θ, σ_rθ and σ_θθ in the two conditions of a face.
fn conditions(face: Face) -> [[f64; 4]; 2] {
    match face {
        Face::Free => [[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
        Face::Held => [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]],
        Face::HeldAlong([r, t]) => [[r, t, 0.0, 0.0], [0.0, 0.0, -t, r]],
        // on both faces the tangential traction on the body is -σ_rθ
        Face::Sliding(ratio) => [[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, ratio]],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KAPPA: f64 = 1.8;

    fn one(angle: f64, faces: [Face; 2], kappa: f64) -> Wedge {
        Wedge { sectors: vec![Sector { angle, mu: 1.0, kappa }], joints: Vec::new(), faces: Some(faces) }
    }

    /// `count` exponents below each of these: none before a root, one more behind it.
    fn check(wedge: &Wedge, roots: &[f64]) {
        for (k, root) in roots.iter().enumerate() {
            let before = roots.iter().filter(|r| **r < root - 1e-5).count();
            let behind = roots.iter().filter(|r| **r < root + 1e-5).count();
            let found = [root - 1e-5, root + 1e-5].map(|limit| wedge.exponents_below(limit));
            assert_eq!(found, [before, behind], "root {k}, {root}, of {wedge:?}");
        }
        assert_eq!(wedge.exponents_below(1.0 - MARGIN), roots.len(), "{wedge:?}");
    }

    /// The root of a function between two points of opposite signs.
    fn root(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
        assert!(f(a) * f(b) < 0.0, "no change of sign between {a} and {b}");
        for _ in 0..60 {
            let middle = (a + b) / 2.0;
            if f(a) * f(middle) <= 0.0 { b = middle } else { a = middle }
        }
        a
    }

    /// A crack has ½ between free faces and ¼ where one is held; a half plane held in part has none below ½.
    #[test]
    fn the_least_exponent_of_a_crack_is_a_half_or_a_quarter() {
        let least = |angle: f64, faces: [Face; 2]| one(angle, faces, KAPPA).least_exponent_below(0.7);
        for (angle, faces, exact) in [
            (2.0 * PI, [Face::Free; 2], 0.5),
            (2.0 * PI, [Face::Held, Face::Free], 0.25),
            (PI, [Face::Held, Face::Free], 0.5),
        ] {
            let found = least(angle, faces).expect("it is singular");
            assert!((found - exact).abs() <= 1.5 * MARGIN, "{angle}: {found} for {exact}");
        }
        assert_eq!(least(0.9 * PI, [Face::Free; 2]), None);
        assert_eq!(one(PI, [Face::Held, Face::Free], KAPPA).least_exponent_below(0.49), None);
    }

    /// sin λα = ± λ sin α between free faces; the two of 270 degrees are 0.5444837 and 0.9085292.
    #[test]
    fn free_faces_have_the_exponents_of_williams() {
        let free = [Face::Free; 2];
        check(&one(1.5 * PI, free, KAPPA), &[0.5444837367, 0.9085291898]);
        for alpha in [1.1 * PI, 1.7 * PI] {
            let of = |sign: f64| move |l: f64| (l * alpha).sin() + sign * l * alpha.sin();
            let mut roots = vec![root(of(1.0), 0.4, 0.999)];
            if alpha > 1.5 * PI {
                roots.push(root(of(-1.0), 0.6, 0.999));
            }
            check(&one(alpha, free, 2.5), &roots);
        }
        check(&one(2.0 * PI, free, KAPPA), &[0.5, 0.5]);
        for alpha in [0.3, 1.0, 2.0, PI] {
            check(&one(alpha, free, KAPPA), &[]);
        }
    }

    /// 4κ sin² λα = (κ+1)² - 4λ² sin² α where one face is held; on a straight side ½ ± i ln κ/2π.
    #[test]
    fn an_end_of_a_held_side_is_singular_beyond_some_sixty_degrees() {
        for kappa in [1.2, KAPPA, 2.6] {
            let of = |alpha: f64| {
                move |l: f64| {
                    4.0 * kappa * (l * alpha).sin().powi(2) + (2.0 * l * alpha.sin()).powi(2) - (kappa + 1.0f64).powi(2)
                }
            };
            let faces = [Face::Held, Face::Free];
            check(&one(0.5 * PI, faces, kappa), &[root(of(0.5 * PI), 0.3, 0.999)]);
            let obtuse = of(0.75 * PI);
            if kappa < 2.0 {
                check(&one(0.75 * PI, faces, kappa), &[root(obtuse, 0.3, 0.66), root(obtuse, 0.66, 0.999)]);
            }
            check(&one(PI, [Face::Free, Face::Held], kappa), &[0.5, 0.5]);
            check(&one(0.2 * PI, [Face::Free, Face::Held], kappa), &[]);
        }
        // ν = 0 carries a uniform stress at a right angle
        check(&one(0.5 * PI, [Face::Held, Face::Free], 3.0), &[]);
    }

    /// λ = ±1 + kπ/α between faces that slide, and sin 2λα = -λ sin 2α between one and a free face, as half of a wedge.
    #[test]
    fn sliding_faces_are_planes_of_symmetry() {
        let sliding = [Face::Sliding(0.0); 2];
        for alpha in [0.4 * PI, 0.7 * PI, PI, 1.5 * PI] {
            let roots: Vec<f64> = (-4..=4)
                .flat_map(|k| [-1.0, 1.0].map(|one| one + f64::from(k) * PI / alpha))
                .filter(|l| *l > MARGIN && *l < 1.0 - MARGIN)
                .collect();
            check(&one(alpha, sliding, KAPPA), &roots);
            check(&one(alpha, [Face::HeldAlong([0.0, 1.0]), Face::HeldAlong([0.0, -1.0])], KAPPA), &roots);
        }
        check(&one(PI, [Face::Sliding(0.0), Face::Free], KAPPA), &[0.5]);
        check(&one(0.5 * PI, [Face::Sliding(0.0), Face::Free], KAPPA), &[]);
        check(&one(0.75 * PI, [Face::Sliding(0.0), Face::Free], KAPPA), &[0.5444837367]);
    }

    /// The edge of a flat punch that slides: cot λπ = ± μ (κ-1)/(κ+1), below ½ on one side and above on the other.
    #[test]
    fn friction_moves_the_exponent_of_a_punch() {
        for (ratio, sign) in [(0.2, -1.0), (-0.2, 1.0)] {
            let cot: f64 = sign * 0.2 * (KAPPA - 1.0) / (KAPPA + 1.0);
            let exponent = 0.5 - cot.atan() / PI;
            check(&one(PI, [Face::Sliding(ratio), Face::Free], KAPPA), &[exponent]);
            // seen from the other side
            check(&one(PI, [Face::Free, Face::Sliding(-ratio)], KAPPA), &[exponent]);
        }
    }

    /// One material all around has no vertex; a soft part is a hole, a stiff one a support.
    #[test]
    fn bonded_sectors_lie_between_a_hole_and_a_support() {
        let around = |ratio: f64| Wedge {
            sectors: vec![
                Sector { angle: 0.5 * PI, mu: ratio, kappa: KAPPA },
                Sector { angle: 1.5 * PI, mu: 1.0, kappa: KAPPA },
            ],
            joints: Vec::new(),
            faces: None,
        };
        check(&around(1.0), &[]);
        assert!(around(2.0).is_singular() && around(0.5).is_singular());
        let hole = around(1e-7);
        assert_eq!([0.543, 0.546, 0.907, 0.910].map(|l| hole.exponents_below(l)), [0, 1, 1, 2]);
        let held = one(1.5 * PI, [Face::Held; 2], KAPPA);
        for limit in [0.3, 0.55, 0.62, 0.8, 0.95] {
            assert_eq!(around(1e7).exponents_below(limit), held.exponents_below(limit), "{limit}");
        }
        // a straight interface is none
        let straight = Wedge {
            sectors: [5.0, 1.0].map(|mu| Sector { angle: PI, mu, kappa: KAPPA }).to_vec(),
            joints: Vec::new(),
            faces: None,
        };
        check(&straight, &[]);
    }

    /// Two bodies that slide on each other without friction: of equal angles they are mirror images, a block on a half plane of the
    /// same material has sin²λπ + 2 cos λπ (sin²(λπ/2) - λ²) = 0, on a rigid one none, and a rigid one on it that of a punch.
    #[test]
    fn bodies_in_contact_have_the_exponents_of_a_punch() {
        let pair = |angles: [f64; 2], mu: [f64; 2], joint: Joint| Wedge {
            sectors: vec![
                Sector { angle: angles[0], mu: mu[0], kappa: KAPPA },
                Sector { angle: angles[1], mu: mu[1], kappa: KAPPA },
            ],
            joints: vec![joint],
            faces: Some([Face::Free; 2]),
        };
        let sliding = Joint::Sliding(0.0);
        check(&pair([0.5 * PI; 2], [1.0, 3.0], sliding), &[]);
        check(&pair([0.5 * PI; 2], [1.0; 2], Joint::Bonded), &[]);
        check(&pair([PI; 2], [1.0, 3.0], sliding), &[0.5]);
        let equal = |l: f64| (l * PI).sin().powi(2) + 2.0 * (l * PI).cos() * ((0.5 * l * PI).sin().powi(2) - l * l);
        let exponent = root(equal, 0.6, 0.9);
        check(&pair([PI, 0.5 * PI], [1.0; 2], sliding), &[exponent]);
        check(&pair([0.5 * PI, PI], [1.0; 2], sliding), &[exponent]);
        assert!(!pair([PI, 0.5 * PI], [1e7, 1.0], sliding).is_singular());
        let rigid = pair([PI, 0.5 * PI], [1.0, 1e7], sliding);
        assert_eq!([0.49, 0.51, 0.99].map(|l| rigid.exponents_below(l)), [0, 1, 1]);
        // friction moves it as that of a punch, by the sign of the slip
        let moved =
            [0.2, -0.2].map(|ratio| pair([PI, 0.5 * PI], [1.0; 2], Joint::Sliding(ratio)).least_exponent_below(0.99));
        assert!(moved[0] != moved[1], "{moved:?}");
    }

    fn bears(wedge: &Wedge, faces: [Datum; 2], joints: &[Datum]) -> bool {
        wedge.logarithm(faces, joints, 0.0).is_none()
    }

    /// Constant data that a constant stress, or one that turns with the angle, carries, and others that need a logarithm.
    #[test]
    fn data_that_no_bounded_stress_carries_are_found() {
        let none = Datum::default();
        let shear = |t: f64| Datum { traction: [t, 0.0], ..none };
        let normal = |s: f64| Datum { traction: [0.0, s], ..none };
        let stretched = |d: f64| Datum { displacement: [d, 0.0], ..none };
        let turned = |d: f64| Datum { displacement: [0.0, d], ..none };
        let free = [Face::Free; 2];
        // on a straight side a jump of the shear is none, of the pressure is one
        let half = one(PI, free, KAPPA);
        assert!(bears(&half, [normal(1.0), none], &[]) && bears(&half, [shear(1.0), shear(1.0)], &[]));
        assert!(!bears(&half, [shear(1.0), none], &[]) && !bears(&half, [shear(1.0), shear(-1.0)], &[]));
        // corners between free sides bear all
        for angle in [0.3 * PI, 0.5 * PI, 0.9 * PI] {
            let wedge = one(angle, free, KAPPA);
            for data in [[shear(1.0), none], [none, normal(2.0)], [shear(1.0), normal(-3.0)]] {
                assert!(bears(&wedge, data, &[]), "{angle} {data:?}");
            }
        }
        // beside a roller or a floor without friction at a right angle the side may have no shear, at another angle it may
        for (roller, pressure) in [(Face::HeldAlong([0.0, 1.0]), false), (Face::Sliding(0.0), true)] {
            let square = one(0.5 * PI, [roller, Face::Free], KAPPA);
            assert!(bears(&square, [none, normal(1.0)], &[]));
            // what pushes the body onto a floor lets the pressure grow, what pulls it off other stresses only
            assert_eq!(
                [-1.0, 1.0].map(|t| square.logarithm([none, shear(t)], &[], 0.0)),
                [Some(pressure), Some(false)]
            );
            let mirrored = one(0.5 * PI, [Face::Free, roller], KAPPA);
            assert_eq!(
                [1.0, -1.0].map(|t| mirrored.logarithm([shear(t), none], &[], 0.0)),
                [Some(pressure), Some(false)]
            );
            assert!(bears(&one(0.4 * PI, [roller, Face::Free], KAPPA), [none, shear(1.0)], &[]));
        }
        // a held straight side bears a slope, and no kink
        let held = one(PI, [Face::Held; 2], KAPPA);
        assert!(bears(&held, [stretched(1.0), stretched(1.0)], &[]) && bears(&held, [turned(1.0), turned(1.0)], &[]));
        assert!(!bears(&held, [stretched(1.0), none], &[]) && !bears(&held, [turned(1.0), none], &[]));
        // two rollers at a right angle may turn, and not shear
        let rollers = one(0.5 * PI, [Face::HeldAlong([0.0, 1.0]); 2], KAPPA);
        assert!(bears(&rollers, [turned(1.0), turned(1.0)], &[]) && !bears(&rollers, [turned(1.0), none], &[]));
    }

    /// A square that is too large for its hole, of the material around it, has infinite stresses at its corners; what is turned in its
    /// hole has not. Bricks that are tied bear what one body does.
    #[test]
    fn data_of_joints_are_borne_as_those_of_one_body() {
        let none = Datum::default();
        let sector = |angle: f64, mu: f64| Sector { angle, mu, kappa: KAPPA };
        let square = |mu: f64| Wedge {
            sectors: vec![sector(0.5 * PI, mu), sector(1.5 * PI, 1.0)],
            joints: Vec::new(),
            faces: None,
        };
        let misfit = Datum { displacement: [0.01, 0.0], ..none };
        let turned = Datum { displacement: [0.0, 0.01], ..none };
        // both joints are passed counter-clockwise, into the square at one and out of it at the other
        let back = |datum: Datum| Datum { displacement: datum.displacement.map(|d| -d), ..datum };
        assert!(!bears(&square(1.0), [none; 2], &[misfit, back(misfit)]));
        assert!(bears(&square(1.0), [none; 2], &[turned, back(turned)]));
        let shear = Datum { traction: [1.0, 0.0], ..none };
        let normal = Datum { traction: [0.0, 1.0], ..none };
        let bricks = |angles: &[f64]| Wedge {
            sectors: angles.iter().map(|&angle| sector(angle, 3.0)).collect(),
            joints: vec![Joint::Bonded; angles.len() - 1],
            faces: Some([Face::Free; 2]),
        };
        for angles in [&[0.5 * PI, 0.5 * PI][..], &[0.25 * PI, 0.5 * PI, 0.25 * PI]] {
            let wedge = bricks(angles);
            assert!(bears(&wedge, [normal, none], &[]) && bears(&wedge, [shear, shear], &[]), "{angles:?}");
            assert!(!bears(&wedge, [shear, none], &[]), "{angles:?}");
        }
    }
}
