//! Multipliers and states of the conditions from the nodal force.

use steklov_elastic::plane::{cross, dot, norm, turned};

use crate::solvers::law::{Branch, Kink, Law};
use crate::solvers::linear::largest;
use crate::{Condition, ContactNode, Outcome, Problem, Solution, Status};

/// Lines closer to v than this part of the largest displacement and gap meet in v.
const TOUCH: f64 = 1e-12;
/// A pressure below this part of the largest multiplier is none.
const PRESSURE: f64 = 1e-12;

/// `[λ_n, λ_t]` of all conditions for the displacement v with nodal forces R = f - S v, on the given pieces.
///
/// Where more lines meet in v than the node has unknowns (a corner in contact, say) the multipliers are not unique: among
/// those that obey the bounds and add up to R, the ones with the smallest Σλ_t² are returned, so that the shears are 0 when
/// the pressures alone can carry R.
pub(crate) fn multipliers(
    problem: &Problem,
    laws: &[Law],
    pieces: &[Vec<Branch>],
    v: &[f64],
    r: &[f64],
) -> Vec<[f64; 2]> {
    let touch = touching_distance(laws, v);
    let nodes = problem.nodes.iter().zip(laws).zip(pieces);
    nodes
        .flat_map(|((node, law), piece)| node_multipliers(node, law, piece, node.pick(v), node.pick(r), touch))
        .collect()
}

/// Distance from v at which a line meets v.
pub(crate) fn touching_distance(laws: &[Law], v: &[f64]) -> f64 {
    TOUCH * (largest(v.iter().copied()) + largest(laws.iter().flat_map(|l| &l.kinks).map(|k| k.at)))
}

/// The multipliers of one node with the unknowns w and the force r.
pub(crate) fn node_multipliers(
    node: &ContactNode,
    law: &Law,
    piece: &[Branch],
    w: [f64; 2],
    r: [f64; 2],
    touch: f64,
) -> Vec<[f64; 2]> {
    let meets = |i: usize| {
        let k = law.kinks[i];
        piece[i] == Branch::On || (dot(k.direction, w) - k.at).abs() <= touch * norm(k.direction)
    };
    let touching: Vec<usize> = (0..law.kinks.len()).filter(|&i| meets(i)).collect();
    let unique = touching.len() == law.on(piece).len() || (node.conditions.len() == 1 && node.unknowns == 2);
    let forces = law.forces(piece, r);
    if unique { from_forces(node, law, &forces) } else { least_shears(node, law, &touching, &forces, r) }
}

fn from_forces(node: &ContactNode, law: &Law, forces: &[f64]) -> Vec<[f64; 2]> {
    let mut lambda = vec![[0.0; 2]; node.conditions.len()];
    for (&(k, tangential), &x) in law.source.iter().zip(forces) {
        let c = &node.conditions[k];
        lambda[k][usize::from(tangential)] = x / if tangential { c.tangent_weight } else { c.normal_weight };
    }
    lambda
}

/// The shears y = (λ_t of condition 0, of condition 1) nearest to 0 with |y_k| ≤ F_k, y_k as given where the tangential
/// line does not touch, and R - Σ y_k D_k t_k in the cone of the touching normals; then the pressures.
fn least_shears(node: &ContactNode, law: &Law, touching: &[usize], forces: &[f64], r: [f64; 2]) -> Vec<[f64; 2]> {
    let mut lambda = from_forces(node, law, forces);
    let mut shear = [[0.0; 2]; 2]; // D_k t_k
    let mut polygon = Polygon::default();
    for (k, c) in node.conditions.iter().enumerate() {
        shear[k] = [c.tangent_weight * c.tangent[0], c.tangent_weight * c.tangent[1]];
    }
    for k in 0..2 {
        let axis = [(1 - k) as f64, k as f64];
        let free = touching.iter().any(|&i| law.source[i] == (k, true));
        if !free {
            polygon.equal(axis, lambda.get(k).map_or(0.0, |l| l[1]));
        } else if let Some(limit) = law.limit(k).filter(|l| l.is_finite()) {
            let limit = limit / node.conditions[k].tangent_weight;
            polygon.at_most(axis, limit);
            polygon.at_most([-axis[0], -axis[1]], limit);
        }
    }
    let pressed: Vec<&Condition> =
        touching.iter().filter(|&&i| !law.source[i].1).map(|&i| &node.conditions[law.source[i].0]).collect();
    let along = |d: [f64; 2]| [dot(d, shear[0]), dot(d, shear[1])];
    match pressed.as_slice() {
        [] => {
            polygon.equal(along([1.0, 0.0]), r[0]);
            polygon.equal(along([0.0, 1.0]), r[1]);
        }
        [a] => {
            if node.unknowns == 2 {
                polygon.equal(along(turned(a.normal)), dot(turned(a.normal), r));
            }
            polygon.at_most(along(a.normal), dot(a.normal, r));
        }
        pressed => {
            for (a, b) in [(pressed[0], pressed[1]), (pressed[1], pressed[0])] {
                // cross(R - Σ y t, b) / cross(a, b) ≥ 0 is the pressure of a
                let s = cross(a.normal, b.normal).signum();
                let d = [s * b.normal[1], -s * b.normal[0]];
                polygon.at_most(along(d), dot(d, r));
            }
        }
    }
    let y = polygon.nearest_to_origin();
    let rest = [r[0] - dot([shear[0][0], shear[1][0]], y), r[1] - dot([shear[0][1], shear[1][1]], y)];
    for &i in touching {
        let (k, tangential) = law.source[i];
        let c = &node.conditions[k];
        lambda[k][usize::from(tangential)] = match (tangential, pressed.as_slice()) {
            (true, _) => y[k],
            (false, [a, b]) => {
                let other = if std::ptr::eq(c, *a) { b.normal } else { a.normal };
                (cross(rest, other) / cross(c.normal, other)).max(0.0) / c.normal_weight
            }
            (false, _) => (dot(c.normal, rest) / dot(c.normal, c.normal)).max(0.0) / c.normal_weight,
        };
    }
    lambda
}

/// A convex polygon given by lines and half-planes of the plane of the two shears.
#[derive(Default)]
struct Polygon {
    kinks: Vec<Kink>,
}

impl Polygon {
    /// d·y = at, left out when it depends on the equations before it (all of them have a common solution).
    fn equal(&mut self, d: [f64; 2], at: f64) {
        let lines: Vec<[f64; 2]> = self.kinks.iter().filter(|k| k.low.is_infinite()).map(|k| k.direction).collect();
        let dependent = |e: &[f64; 2]| cross(*e, d).abs() <= 1e-12 * norm(d);
        if lines.len() < 2 && !lines.iter().any(dependent) {
            self.push(d, at, f64::NEG_INFINITY);
        }
    }

    /// d·y ≤ at.
    fn at_most(&mut self, d: [f64; 2], at: f64) {
        self.push(d, at, 0.0);
    }

    fn push(&mut self, d: [f64; 2], at: f64, low: f64) {
        let r = norm(d);
        if r > 0.0 {
            self.kinks.push(Kink { direction: [d[0] / r, d[1] / r], at: at / r, low, high: f64::INFINITY });
        }
    }

    fn nearest_to_origin(self) -> [f64; 2] {
        Law::of_kinks(2, self.kinks, Vec::new(), [1.0, 1.0]).prox([0.0, 0.0]).0
    }
}

/// State of every condition, read off the multipliers and the displacement.
pub(crate) fn status(problem: &Problem, v: &[f64], multipliers: &[[f64; 2]]) -> Vec<Status> {
    let scale = largest(multipliers.iter().flatten().copied());
    let conditions = problem.nodes.iter().flat_map(|n| n.conditions.iter().map(move |c| (n, c)));
    conditions
        .zip(multipliers)
        .map(|((node, c), &[normal, shear])| {
            if c.normal_weight > 0.0 && normal <= PRESSURE * scale {
                Status::Apart
            } else if c.tangent_weight == 0.0 || shear.abs() < c.limit(normal) * (1.0 - 1e-12) {
                Status::Stick
            } else if c.limit(normal) > 0.0 && shear < 0.0 || c.limit(normal) == 0.0 && c.slip(node.pick(v)) < 0.0 {
                Status::SlipMinus
            } else {
                Status::SlipPlus
            }
        })
        .collect()
}

impl Solution {
    /// A solution whose displacement and multipliers are known.
    pub fn new(
        problem: &Problem,
        displacement: Vec<f64>,
        multipliers: Vec<[f64; 2]>,
        outcome: Outcome,
        history: Vec<f64>,
    ) -> Self {
        let status = status(problem, &displacement, &multipliers);
        Self { displacement, multipliers, status, iterations: history.len(), outcome, history }
    }
}
