//! Rigid motions of the plane, and those that the held displacements leave free.

use std::fmt;

use nalgebra::Vector3;

use crate::plane::{cross, distance, minus, norm, unit};

/// An infinitesimal rigid motion r(x) = a + ω J (x - c), J the rotation by +90°.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidMotion {
    /// Translation a.
    pub translation: [f64; 2],
    /// Rate of rotation ω, counter-clockwise.
    pub rotation: f64,
    /// Centre c of the rotation.
    pub centre: [f64; 2],
}

impl RigidMotion {
    /// Translation along a direction, not normalised.
    pub fn along(translation: [f64; 2]) -> Self {
        Self { translation, rotation: 0.0, centre: [0.0; 2] }
    }

    /// Rotation by ω about a point.
    pub fn about(centre: [f64; 2], rotation: f64) -> Self {
        Self { translation: [0.0; 2], rotation, centre }
    }

    /// One motion after another, about the origin; none if there is neither.
    pub fn sum(a: Option<Self>, b: Option<Self>) -> Option<Self> {
        let (Some(a), Some(b)) = (&a, &b) else { return a.or(b) };
        let ([x, y], [u, v]) = (a.at([0.0; 2]), b.at([0.0; 2]));
        Some(Self { translation: [x + u, y + v], rotation: a.rotation + b.rotation, centre: [0.0; 2] })
    }

    /// r(x).
    pub fn at(&self, x: [f64; 2]) -> [f64; 2] {
        let ([a, b], w, c) = (self.translation, self.rotation, self.centre);
        [a - w * (x[1] - c[1]), b + w * (x[0] - c[0])]
    }

    /// Nodal values r(x_i), interleaved x, y.
    pub fn nodal(&self, points: &[[f64; 2]]) -> Vec<f64> {
        points.iter().flat_map(|&x| self.at(x)).collect()
    }

    /// Names of several motions for a sentence: "A", "A and B", "A, B and C".
    pub fn names(motions: &[RigidMotion]) -> String {
        let names: Vec<String> = motions.iter().map(RigidMotion::to_string).collect();
        match names.split_last() {
            None => "no rigid motion".into(),
            Some((last, [])) => last.clone(),
            Some((last, others)) => format!("{} and {last}", others.join(", ")),
        }
    }
}

/// Distance of a fixed point from which a rotation is named as a translation.
const FAR: f64 = 1e11;

/// "translation along (1, 0)" or "rotation about (0.5, 0)": a motion that turns has one fixed point, c + J a / ω.
impl fmt::Display for RigidMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([a, b], w, c) = (self.translation, self.rotation, self.centre);
        // a fixed point so far away is a rotation that is all rounding
        if w != 0.0 && a.hypot(b) < FAR * w.abs() {
            let size = [c[0], c[1], a / w, b / w].iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            write!(f, "rotation about {}", point([c[0] - b / w, c[1] + a / w], size))
        } else if a == 0.0 && b == 0.0 {
            write!(f, "no motion")
        } else {
            let length = a.hypot(b);
            write!(f, "translation along {}", point([a / length, b / length], 1.0))
        }
    }
}

/// Coordinates to six digits, without the rounding errors of a zero; `size` is that of the numbers they come from.
fn point(x: [f64; 2], size: f64) -> String {
    let short = |v: f64| if v.abs() <= 1e-9 * size { 0.0 } else { format!("{v:.5e}").parse().unwrap_or(v) };
    format!("({}, {})", short(x[0]), short(x[1]))
}

/// Singular values and rotations below this, relatively, count as zero.
const RANK: f64 = 1e-10;

/// Basis of the rigid motions r that satisfy all constraints r(x)·d = 0, given as (point x, direction d).
///
/// Motions are measured at the centre c of the box around `points` in units of its half diagonal ρ: the vectors
/// (r(c), ρω) of the basis are orthonormal. Whether a constraint is independent of the others is decided to 1e-10 in
/// this measure, after scaling d to length 1 (a zero d is no constraint). Translations come first and point into the
/// right half plane; a rotation is counter-clockwise and given by its fixed point, with no translation.
///
/// # Panics
/// If `points` has not two different points.
pub fn free_motions(points: &[[f64; 2]], held: &[([f64; 2], [f64; 2])]) -> Vec<RigidMotion> {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for x in points {
        low = [low[0].min(x[0]), low[1].min(x[1])];
        high = [high[0].max(x[0]), high[1].max(x[1])];
    }
    let centre = [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0];
    let size = distance(high, low) / 2.0;
    assert!(size > 0.0 && size.is_finite(), "a body has two different points");

    let mut rows: Vec<Vector3<f64>> = held.iter().filter_map(|&(x, d)| row(x, d, centre, size)).collect();
    let mut fixed = Vec::new();
    while let Some(largest) = rows.iter().copied().max_by(|a, b| a.norm().total_cmp(&b.norm())) {
        if fixed.len() == 3 || largest.norm() <= RANK {
            break;
        }
        let q = largest / largest.norm();
        for _ in 0..2 {
            rows.iter_mut().for_each(|r| *r -= q * r.dot(&q));
        }
        fixed.push(q);
    }
    let free = match fixed[..] {
        [] => vec![Vector3::x(), Vector3::y(), Vector3::z()],
        [q] => {
            let [x, y] = unit([q[0], q[1]]); // not 0: every row has a direction of length 1
            let t = Vector3::new(-y, x, 0.0);
            vec![t, q.cross(&t)]
        }
        [q, r] => vec![q.cross(&r)],
        _ => vec![],
    };
    free.into_iter().map(|v| motion(v, centre, size, held)).collect()
}

/// r(x)·d as a linear form of (r(c), ρω), d scaled to length 1.
fn row(x: [f64; 2], d: [f64; 2], centre: [f64; 2], size: f64) -> Option<Vector3<f64>> {
    let (length, d) = (norm(d), unit(d));
    let from = minus(x, centre).map(|r| r / size);
    (length > 0.0).then(|| Vector3::new(d[0], d[1], cross(from, d)))
}

/// The motion (r(c), ρω) as a translation, or as a rotation about its fixed point.
fn motion(v: Vector3<f64>, centre: [f64; 2], size: f64, held: &[([f64; 2], [f64; 2])]) -> RigidMotion {
    let clean = |x: f64, unit: f64| if x.abs() <= 1e-12 * unit { 0.0 } else { x };
    if v[2].abs() <= RANK {
        let (a, b) = (clean(v[0], 1.0), clean(v[1], 1.0));
        let length = if a < 0.0 || (a == 0.0 && b < 0.0) { -a.hypot(b) } else { a.hypot(b) };
        return RigidMotion::along([a / length + 0.0, b / length + 0.0]);
    }
    let arm = [-v[1] / v[2] * size, v[0] / v[2] * size]; // J a / ω
    let reach = size.max(norm(arm));
    let fixed = [centre[0] + arm[0], centre[1] + arm[1]];
    let pinned = held.iter().map(|h| h.0).find(|x| distance(*x, fixed) <= RANK * reach);
    RigidMotion::about(pinned.unwrap_or(fixed.map(|x| clean(x, size))), v[2].abs() / size)
}
