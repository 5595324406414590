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
pub(super) fn functions(l: c64, sector: &Sector, theta: f64) -> [([c64; 2], [c64; 2]); 4] {
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
    pub(super) fn conditions(&self, l: c64) -> Mat<c64> {
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
}

/// Weights of u_r, u_θ, σ_rθ and σ_θθ in the two conditions of a face.
pub(super) fn conditions(face: Face) -> [[f64; 4]; 2] {
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
}
