//! The unit square of bilinear elements, clamped at the top, loaded on both vertical sides, condensed to its bottom.

use faer::Mat;
use steklov_algebra::Cholesky;
use steklov_contact::{Condition, ContactError, ContactNode, Problem, Solution};
use steklov_stochastic::{scale_bounds, solve_warm};

/// Poisson's ratio, plane strain.
const NU: f64 = 0.3;

/// Stiffness for E = 1 and load of the bottom nodes, unknowns (u_x, u_y) of a node after the other.
pub struct Square {
    pub elements: usize,
    pub stiffness: Mat<f64>,
    pub load: Vec<f64>,
}

/// `elements` × `elements` bilinear elements with the traction on both vertical sides.
pub fn square(elements: usize, traction: [f64; 2]) -> Square {
    let n = elements;
    // the nodes of the clamped top row are left out
    let unknowns = 2 * (n + 1) * n;
    let element = element();
    let mut k = Mat::<f64>::zeros(unknowns, unknowns);
    let mut f = Mat::<f64>::zeros(unknowns, 1);
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
        let unknown = |a: usize| 2 * (corners[a / 2].1 * (n + 1) + corners[a / 2].0) + a % 2;
        for (a, b) in (0..8).flat_map(|a| (0..8).map(move |b| (a, b))) {
            if unknown(a) < unknowns && unknown(b) < unknowns {
                k[(unknown(a), unknown(b))] += element[(a, b)];
            }
        }
    }
    for j in 0..n {
        let weight = if j == 0 { 0.5 } else { 1.0 } / n as f64;
        for i in [0, n] {
            for c in 0..2 {
                f[(2 * (j * (n + 1) + i) + c, 0)] += weight * traction[c];
            }
        }
    }
    // Schur complement on the bottom row, which comes first
    let m = 2 * (n + 1);
    let inner = Cholesky::new(k.submatrix(m, m, unknowns - m, unknowns - m)).unwrap();
    let coupling = k.submatrix(m, 0, unknowns - m, m).to_owned();
    let stiffness = k.submatrix(0, 0, m, m) - coupling.transpose() * inner.solve(coupling.as_ref());
    let load = f.submatrix(0, 0, m, 1) - coupling.transpose() * inner.solve(f.submatrix(m, 0, unknowns - m, 1));
    let stiffness = Mat::from_fn(m, m, |i, j| 0.5 * (stiffness[(i, j)] + stiffness[(j, i)]));
    Square { elements: n, stiffness, load: load.col_as_slice(0).to_vec() }
}

/// Stiffness of a square element, whose size does not matter, by 2×2 Gauss points, which is exact.
fn element() -> Mat<f64> {
    let (lambda, mu) = (NU / ((1.0 + NU) * (1.0 - 2.0 * NU)), 0.5 / (1.0 + NU));
    let point = 0.5 / 3f64.sqrt();
    let mut k = Mat::<f64>::zeros(8, 8);
    for (x, y) in [(-point, -point), (point, -point), (point, point), (-point, point)] {
        let (x, y) = (0.5 + x, 0.5 + y);
        let gradient = [[y - 1.0, x - 1.0], [1.0 - y, -x], [y, x], [-y, 1.0 - x]];
        for (a, b) in (0..8).flat_map(|a| (0..8).map(move |b| (a, b))) {
            let (g, h, c, d) = (gradient[a / 2], gradient[b / 2], a % 2, b % 2);
            let dot = if c == d { g[0] * h[0] + g[1] * h[1] } else { 0.0 };
            k[(a, b)] += 0.25 * (lambda * g[c] * h[d] + mu * (g[d] * h[c] + dot));
        }
    }
    k
}

impl Square {
    /// Contact nodes over a rigid ground.
    pub fn nodes(&self, gap: f64, bound: f64) -> Vec<ContactNode> {
        ground(self.elements, gap, bound)
    }
}

/// Nodes of a bottom of `elements` elements over a rigid ground, with weights lumped by the trapezoidal rule.
pub fn ground(elements: usize, gap: f64, bound: f64) -> Vec<ContactNode> {
    let condition = |i: usize| {
        let weight = weight(elements, i);
        Condition {
            normal: [0.0, -1.0],
            tangent: [1.0, 0.0],
            normal_weight: weight,
            tangent_weight: weight,
            gap,
            slip_offset: 0.0,
            bound,
            coefficient: 0.0,
        }
    };
    let node = |i: usize| ContactNode { first: 2 * i, unknowns: 2, conditions: vec![condition(i)] };
    (0..=elements).map(node).collect()
}

/// Length that belongs to a bottom node.
pub fn weight(elements: usize, i: usize) -> f64 {
    let share = if i == 0 || i == elements { 0.5 } else { 1.0 };
    share / elements as f64
}

/// Solves E S v + Bᵀ W λ = f for the S of a problem, all stresses over E; `warm` is an answer in that scale.
pub fn solve_outcome(
    mut problem: Problem,
    modulus: f64,
    warm: &mut Option<Solution>,
) -> Result<Solution, ContactError> {
    problem.load.iter_mut().for_each(|f| *f /= modulus);
    scale_bounds(&mut problem.nodes, 1.0 / modulus);
    let mut solution = solve_warm(&problem, warm)?;
    solution.multipliers.iter_mut().flatten().for_each(|l| *l *= modulus);
    Ok(solution)
}
