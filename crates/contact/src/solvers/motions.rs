//! Rigid motions that supports leave free: whether contact and friction hold them.

use steklov_algebra::dot;
use steklov_elastic::{RigidMotion, plane};

use crate::ContactError;
use crate::solvers::stopped;

/// A straight part of the contact boundary, as far as rigid motions are concerned: on it u_n is linear and u_t constant.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactEdge {
    /// First and last contact node.
    pub ends: [[f64; 2]; 2],
    /// Normal, out of the body.
    pub normal: [f64; 2],
    /// ∫ F ds = Σ D_i F_i of Tresca's part (force per thickness).
    pub friction: f64,
    /// Coulomb's coefficient μ.
    pub coefficient: f64,
}

/// What counts as zero, relative to the scale of the quantity.
const ZERO: f64 = 1e-9;
/// From this number of rows on, a few rows are first tested for leaving any motion: the pairs of all are a thousand times as
/// many.
const MANY: usize = 64;

/// The motions among the span of `candidates` that nothing resists and no load drives; each of them needs a spring.
///
/// With R_K = {rigid r: r_n + μ |r_t| ≤ 0 on the contact boundary} and j(r) = Σ ∫F |r_t|, a solution exists if L(r) < j(r) for all
/// r ≠ 0 in R_K. (By duality, the load is then carried by pressures λ_n ≥ 0 and shears |λ_t| ≤ F + μ λ_n; Coulomb friction
/// resists under pressure only, so that a body that it does not hold leaves its obstacle obliquely in these terms.) L - j is
/// linear on the cones into which the planes r_n = 0 (at the ends of the edges) and r_t = 0 (on the edges) cut R_K, so the
/// rays in which these planes meet decide. L(r) = j(r) = 0 is allowed: the span of those motions is returned. Among them are the
/// ones that lift the body off; no contact force does work on any of them in a solution, so one that springs hold is a
/// solution if the forces do none in it. `work` gives L(r) and the scale Σ |f||r|.
///
/// # Errors
/// [`ContactError::RigidMotion`] with the worst motion when L(r) > j(r), or when L(r) = j(r) > 0: then nothing says how far
/// the body goes.
pub fn resisted_motions(
    candidates: &[RigidMotion],
    edges: &[ContactEdge],
    work: impl Fn(&RigidMotion) -> (f64, f64),
) -> Result<Vec<RigidMotion>, ContactError> {
    let mut free: Vec<Vec<f64>> = Vec::new();
    let mut worst: Option<(f64, ContactError)> = None;
    let rows = Rows::new(candidates, edges);
    rows.for_each_allowed_ray(|ray| {
        let motion = combine(candidates, ray);
        let (driven, scale) = work(&motion);
        let resisted = rows.resistance(edges, ray);
        let zero = ZERO * (scale + if resisted.is_finite() { resisted } else { 0.0 });
        let excess = driven - resisted;
        if excess < -zero {
            return;
        }
        if excess <= zero && resisted == 0.0 {
            add_independent(&mut free, ray);
        } else if worst.as_ref().is_none_or(|w| excess > w.0) {
            let error = ContactError::RigidMotion { motion, work: driven, resistance: resisted, scale };
            worst = Some((excess, error));
        }
    });
    match worst {
        Some((_, error)) => Err(error),
        None => Ok(free.iter().map(|ray| combine(candidates, ray)).collect()),
    }
}

/// A motion among the span of `free`, which [`resisted_motions`] found, that closes the obstacle nowhere, leaves it wherever
/// one of them can, and meets no friction; of size 1 in their coefficients; `None` if only 0 is such a motion.
///
/// No pressure is possible where such a motion leaves the obstacle: it would do work that nothing balances.
pub fn lifting_motion(free: &[RigidMotion], edges: &[ContactEdge]) -> Option<RigidMotion> {
    let rows = Rows::new(free, edges);
    let mut sum = vec![0.0; free.len()];
    rows.for_each_allowed_ray(|ray| {
        if rows.resistance(edges, ray) == 0.0 && rows.normal.iter().any(|row| dot(row, ray) < -ZERO * rows.scale) {
            sum.iter_mut().zip(ray).for_each(|(sum, r)| *sum += r);
        }
    });
    let size = dot(&sum, &sum).sqrt();
    (size > ZERO).then(|| combine(free, &sum.iter().map(|c| c / size).collect::<Vec<f64>>()))
}

/// u_n ± μ u_t at the ends of the edges and u_t on the edges, as linear functions of the candidates' coefficients.
struct Rows {
    normal: Vec<Vec<f64>>,
    tangential: Vec<Vec<f64>>,
    /// Largest entry.
    scale: f64,
}

impl Rows {
    fn new(candidates: &[RigidMotion], edges: &[ContactEdge]) -> Self {
        let row = |x: [f64; 2], d: [f64; 2]| -> Vec<f64> {
            candidates.iter().map(|r| r.at(x)).map(|u| plane::dot(u, d)).collect()
        };
        // r_n, or r_n + μ r_t and r_n - μ r_t
        let pressing = |e: &ContactEdge| -> Vec<Vec<f64>> {
            let slopes = if e.coefficient > 0.0 { vec![e.coefficient, -e.coefficient] } else { vec![0.0] };
            let d = |slope: f64| [e.normal[0] - slope * e.normal[1], e.normal[1] + slope * e.normal[0]];
            slopes.iter().flat_map(|slope| e.ends.map(|x| row(x, d(*slope)))).collect()
        };
        let normal: Vec<_> = edges.iter().flat_map(pressing).collect();
        let tangential: Vec<_> = edges.iter().map(|e| row(e.ends[0], plane::turned(e.normal))).collect();
        let scale = normal.iter().chain(&tangential).flatten().fold(0.0, |m: f64, v| m.max(v.abs()));
        Self { normal, tangential, scale }
    }

    /// Unit vectors along the rays in which the planes meet, of motions that close the obstacle nowhere.
    fn for_each_allowed_ray(&self, mut visit: impl FnMut(&[f64])) {
        if self.normal.len() > MANY && stopped::every_way(&self.normal, ZERO * self.scale) {
            return;
        }
        let closes = |row: &[f64], ray: &[f64]| dot(row, ray) > ZERO * self.scale;
        // what stops the two rays of a line mostly stops those of the next: few cost a look at all rows
        let mut last = [0; 2];
        let candidates = self.normal.first().or(self.tangential.first()).map_or(0, Vec::len);
        for_each_ray(&self.planes(), candidates, |ray| {
            if last.iter().any(|&k| self.normal.get(k).is_some_and(|row| closes(row, ray))) {
                return;
            }
            match self.normal.iter().position(|row| closes(row, ray)) {
                Some(row) => last = [row, last[0]],
                None => visit(ray),
            }
        });
    }

    /// ∫F |r_t| of the motion along a ray.
    fn resistance(&self, edges: &[ContactEdge], ray: &[f64]) -> f64 {
        let slips = self.tangential.iter().zip(edges);
        slips
            .map(|(row, edge)| match dot(row, ray).abs() {
                slip if slip <= ZERO * self.scale => 0.0,
                slip => edge.friction * slip,
            })
            .sum()
    }

    /// Planes through the origin that cut the cone; rows that vanish are left out.
    fn planes(&self) -> Vec<Vec<f64>> {
        let size = |row: &[f64]| row.iter().map(|v| v * v).sum::<f64>().sqrt();
        let rows = self.normal.iter().chain(&self.tangential).filter(|row| size(row) > ZERO * self.scale);
        rows.map(|row| row.iter().map(|v| v / size(row)).collect()).collect()
    }
}

/// Unit vectors along the lines in which k - 1 of the planes meet, both ways.
fn for_each_ray(planes: &[Vec<f64>], k: usize, mut visit: impl FnMut(&[f64])) {
    let mut both_ways = |line: &[f64]| {
        let (size, mut ray) = (dot(line, line).sqrt(), [0.0; 3]);
        if size > ZERO {
            for sign in [1.0, -1.0] {
                ray.iter_mut().zip(line).for_each(|(r, v)| *r = sign * v / size);
                visit(&ray[..line.len()]);
            }
        }
    };
    match k {
        0 => {}
        1 => both_ways(&[1.0]),
        2 => planes.iter().for_each(|p| both_ways(&[-p[1], p[0]])),
        _ => {
            for (i, p) in planes.iter().enumerate() {
                for q in &planes[..i] {
                    both_ways(&[p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]);
                }
            }
        }
    }
}

/// Σ c_i r_i, about the centre of a rotation among them.
fn combine(candidates: &[RigidMotion], coefficients: &[f64]) -> RigidMotion {
    let centre = candidates.iter().find(|r| r.rotation != 0.0).map_or([0.0; 2], |r| r.centre);
    let mut motion = RigidMotion { translation: [0.0; 2], rotation: 0.0, centre };
    for (r, c) in candidates.iter().zip(coefficients) {
        let at = r.at(centre);
        motion.translation[0] += c * at[0];
        motion.translation[1] += c * at[1];
        motion.rotation += c * r.rotation;
    }
    motion
}

/// Adds a ray's direction if the ones that are there do not span it.
fn add_independent(basis: &mut Vec<Vec<f64>>, ray: &[f64]) {
    let mut rest = ray.to_vec();
    for b in basis.iter() {
        let c = dot(b, &rest);
        rest.iter_mut().zip(b).for_each(|(r, b)| *r -= c * b);
    }
    let size = dot(&rest, &rest).sqrt();
    if size > 1e-6 {
        basis.push(rest.iter().map(|v| v / size).collect());
    }
}
