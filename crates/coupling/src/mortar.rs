//! What faces the dual functions of one side: the rows P of a mortar method.
//!
//! The non-mortar side carries the multipliers, with the dual functions ψ_i of its nodes, D_i = ∫ φ_i ds; the mortar side is
//! seen along the normals n of the non-mortar one, at π(x) = x + d(x) n(x).
//!
//! ```text
//! P_ij = (1/D_i) ∫ ψ_i φ_j∘π ds      d_i = (1/D_i) ∫ ψ_i d ds      w_i = u_i - Σ_j P_ij u_m,j
//! ```
//! Σ_j P_ij = 1, so that forces balance: λ acts on the mortar side as Σ_i D_i P_ij λ_i. P reproduces what is of degree p on
//! each non-mortar element. On straight sides π is affine and the integrals are exact; on curves π is a root, and Gauss rules
//! have enough points for 1e-12.
//!
//! # Source
//! Wohlmuth, *A mortar finite element method using dual spaces for the Lagrange multiplier*, SIAM J. Numer. Anal. 38 (2000).

use steklov_bem_operators::{Mesh, Space};
use steklov_quadrature::{BiorthogonalBasis, LobattoBasis, gauss_legendre};

/// Elements face each other where n·n' is below this.
const FACING: f64 = -0.2;
/// Ends of cells closer to an end of their element than this (parameter on [-1, 1]) are there.
const SNAP: f64 = 1e-11;
/// The same at most of small elements far from the origin, whose ends are rounded.
const NEAR: f64 = 1e-4;
/// Cells shorter than this are none.
const SLIVER: f64 = 1e-9;
/// Gauss points beyond those of polynomials on curves.
const ON_CURVES: usize = 12;

/// A part of a non-mortar element that one mortar element faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Non-mortar element.
    pub element: usize,
    /// Its part, -1 ≤ t0 < t1 ≤ 1.
    pub span: [f64; 2],
    /// Mortar element.
    pub other: usize,
}

/// The row of a non-mortar node, summed over its elements.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MortarRow {
    /// Node of the non-mortar space.
    pub node: usize,
    /// D_i (length).
    pub weight: f64,
    /// Nodes of the mortar space and P_ij, rising.
    pub other: Vec<(usize, f64)>,
    /// d_i (length), the distance along the normal, negative where the sides overlap.
    pub distance: f64,
    /// (1/D_i) ∫ ψ_i ds over what is faced: 1 where the elements of the node are faced wholly.
    pub covered: f64,
}

/// A side of a mesh.
#[derive(Debug, Clone, Copy)]
pub struct Facing<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// Its displacement space.
    pub space: &'a Space,
    /// Its elements on the side.
    pub elements: &'a [usize],
}

/// The point of a mortar element that a point sees along a direction: its parameter, not bounded to [-1, 1], and its distance.
///
/// Newton's method for (γ(t) - x) × n = 0 from the nearest end or the middle; None where it does not converge near the element.
pub fn project(mesh: &Mesh, e: usize, x: [f64; 2], n: [f64; 2]) -> Option<[f64; 2]> {
    let aside = |t: f64| {
        let y = mesh.point(e, t);
        let r = [y[0] - x[0], y[1] - x[1]];
        (cross(r, n), dot(r, n))
    };
    let mut t: f64 = 0.0;
    for _ in 0..30 {
        let (tangent, speed) = (mesh.tangent(e, t.clamp(-1.5, 1.5)), mesh.speed(e, t.clamp(-1.5, 1.5)));
        let slope = speed * cross(tangent, n);
        if slope.abs() < 1e-3 * speed {
            return None;
        }
        let step = aside(t).0 / slope;
        t -= step;
        if t.abs() > 3.0 {
            // far from the element: on a line the answer, on a curve nothing of it
            return mesh.is_line(e).then(|| [t, aside(t).1]);
        }
        if step.abs() < 1e-15 || mesh.is_line(e) {
            break;
        }
    }
    Some([t, aside(t).1])
}

/// The parameter of a non-mortar element whose normal goes through a point, (γ(t) - x)·τ(t) = 0, not bounded to [-1, 1].
fn foot(mesh: &Mesh, e: usize, x: [f64; 2]) -> f64 {
    let along = |t: f64| {
        let (y, tangent) = (mesh.point(e, t), mesh.tangent(e, t));
        dot([y[0] - x[0], y[1] - x[1]], tangent) / mesh.speed(e, t)
    };
    if mesh.is_line(e) {
        return -along(0.0);
    }
    // by halves: the foot is unique as long as x is nearer than the centre of curvature
    let (mut low, mut high) = (-1.0 - 1e-9, 1.0 + 1e-9);
    let (mut at_low, at_high) = (along(low), along(high));
    if at_low > 0.0 || at_high < 0.0 {
        // the point lies ahead of both ends, or behind; between (along falls from + to -) the element is farthest from it
        let away = |t: f64| {
            let y = mesh.point(e, t);
            (y[0] - x[0]).hypot(y[1] - x[1])
        };
        let ahead = if at_low * at_high > 0.0 { at_low < 0.0 } else { away(1.0) < away(-1.0) };
        return if ahead { 2.0 } else { -2.0 };
    }
    for _ in 0..200 {
        let middle = (low + high) / 2.0;
        let here = along(middle);
        if here * at_low > 0.0 {
            (low, at_low) = (middle, here)
        } else {
            high = middle
        }
        if high - low < 1e-16 {
            break;
        }
    }
    (low + high) / 2.0
}

/// The common refinement: the parts of the non-mortar elements that mortar elements face, no farther away than `reach`.
pub fn cells(own: Facing<'_>, other: Facing<'_>, reach: f64) -> Vec<Cell> {
    let mut cells = Vec::new();
    for &e in own.elements {
        for &m in other.elements {
            let [a, b] = other.mesh.ends(m).map(|x| foot(own.mesh, e, x));
            let snap = SNAP.max(own.mesh.resolution(e)).min(NEAR);
            let snapped = |t: f64| if (t.abs() - 1.0).abs() < snap { t.signum() } else { t.clamp(-1.0, 1.0) };
            let span = [snapped(a.min(b)), snapped(a.max(b))];
            if span[1] - span[0] < SLIVER.max(2.0 * snap) {
                continue;
            }
            let middle = (span[0] + span[1]) / 2.0;
            let (x, n) = (own.mesh.point(e, middle), own.mesh.normal(e, middle));
            let Some([t, distance]) = project(other.mesh, m, x, n) else { continue };
            if t.abs() <= 1.0 && dot(n, other.mesh.normal(m, t)) < FACING && distance.abs() <= reach {
                cells.push(Cell { element: e, span, other: m });
            }
        }
    }
    cells
}

/// The rows of the nodes on the non-mortar elements.
pub fn mortar_rows(own: Facing<'_>, other: Facing<'_>, cells: &[Cell]) -> Vec<MortarRow> {
    let mut rows: Vec<MortarRow> = Vec::new();
    let mut row_of = vec![None; own.space.nodes()];
    for &e in own.elements {
        let basis = own.space.basis(e);
        for (k, node) in own.space.element_nodes(e).enumerate() {
            let at = *row_of[node].get_or_insert_with(|| {
                rows.push(MortarRow { node, ..MortarRow::default() });
                rows.len() - 1
            });
            rows[at].weight += basis.weights[k] * own.mesh.speed(e, basis.nodes[k]);
        }
    }
    for cell in cells {
        add_cell(own, other, cell, &row_of, &mut rows);
    }
    for row in &mut rows {
        row.other.sort_by_key(|entry| entry.0);
        row.other.dedup_by(|b, a| {
            a.0 == b.0 && {
                a.1 += b.1;
                true
            }
        });
        row.other.iter_mut().for_each(|entry| entry.1 /= row.weight);
        row.distance /= row.weight;
        row.covered /= row.weight;
    }
    rows
}

/// ψ_i ds = ψ_i(t) |γ'(t_i)| dt, whose integrals against φ_j are δ_ij D_i on every curve.
fn add_cell(own: Facing<'_>, other: Facing<'_>, cell: &Cell, row_of: &[Option<usize>], rows: &mut [MortarRow]) {
    let (e, m) = (cell.element, cell.other);
    let (basis, facing) = (own.space.basis(e), other.space.basis(m));
    let dual = BiorthogonalBasis::new(basis);
    let straight = own.mesh.is_line(e) && other.mesh.is_line(m);
    let points = (basis.degree + facing.degree) / 2 + 1 + if straight { 0 } else { ON_CURVES };
    let rule = gauss_legendre(points);
    let half = (cell.span[1] - cell.span[0]) / 2.0;
    let (mut own_phi, mut psi) = (vec![0.0; basis.degree + 1], vec![0.0; basis.degree + 1]);
    let mut phi = vec![0.0; facing.degree + 1];
    for (&g, &w) in rule.points.iter().zip(&rule.weights) {
        let t = cell.span[0] + half * (1.0 + g);
        let (x, n) = (own.mesh.point(e, t), own.mesh.normal(e, t));
        let Some([s, distance]) = project(other.mesh, m, x, n) else { continue };
        basis.evaluate(t, &mut own_phi);
        dual.evaluate(&own_phi, &mut psi);
        facing.evaluate(s.clamp(-1.0, 1.0), &mut phi);
        for (k, node) in own.space.element_nodes(e).enumerate() {
            let Some(row) = row_of[node].map(|at| &mut rows[at]) else { continue };
            let weight = half * w * psi[k] * own.mesh.speed(e, basis.nodes[k]);
            row.covered += weight;
            row.distance += weight * distance;
            row.other.extend(other.space.element_nodes(m).zip(&phi).map(|(node, phi)| (node, weight * phi)));
        }
    }
}

/// ∫ ψ_k f dt over [-1, 1].
pub fn dual_moment(basis: &LobattoBasis, k: usize, f: &dyn Fn(f64) -> f64) -> f64 {
    let dual = BiorthogonalBasis::new(basis);
    let (mut phi, mut psi) = (vec![0.0; basis.degree + 1], vec![0.0; basis.degree + 1]);
    gauss_legendre(basis.degree + 2 * ON_CURVES).integrate(|t| {
        basis.evaluate(t, &mut phi);
        dual.evaluate(&phi, &mut psi);
        psi[k] * f(t)
    })
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[cfg(test)]
mod tests;
