//! Stresses at the vertex of a wedge that grow like a logarithm, because no constant stress bears the data there.
//!
//! ```text
//! D(1) c = d has no solution:   u = r (log r Σ β_j n_j + c),   D(1) n_j = 0,  w_i·D(1) = 0,   Σ β_j w_i·D'(1) n_j = w_i·d
//! ```
//! d are tractions and changes of displacements with r on faces, and their jumps on joints. A rotation among the n_j bears no stress.
//!
//! Source: Dempsey and Sinclair, J. Elasticity 9 (1979), on powers of log r beside eigenvalues; Sternberg and Koiter (1958).

use faer::{Mat, c64};

use super::wedge::{Face, Joint, Wedge, conditions, functions};

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

impl Wedge {
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

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::Sector;

    const KAPPA: f64 = 1.8;

    fn one(angle: f64, faces: [Face; 2], kappa: f64) -> Wedge {
        Wedge { sectors: vec![Sector { angle, mu: 1.0, kappa }], joints: Vec::new(), faces: Some(faces) }
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
