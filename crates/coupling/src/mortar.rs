//! The rows P of a mortar method: the displacement that the dual functions of one side see on the side they face.
//!
//! The non-mortar side carries the multipliers, with the dual functions ψ_i of its nodes, D_i = ∫ φ_i ds. A point x of it,
//! with normal n₁, meets π(x) of the mortar side, with n₂, in the direction of contact, the normal of a surface that is closer
//! in shape to the stiffer body:
//!
//! ```text
//! π(x) - x = d(x) (E₁n₁ - E₂n₂)/|E₁n₁ - E₂n₂|,  E = E/(1-ν²)
//! P_ij = (1/D_i) ∫ ψ_i φ_j∘π ds      d_i = (1/D_i) ∫ ψ_i d ds      w_i = u_i - Σ_j P_ij u_m,j
//! ```
//! Σ_j P_ij = 1, so that forces balance: λ acts on the mortar side as Σ_i D_i P_ij λ_i. P reproduces polynomials of degree p
//! on each non-mortar element. Between straight elements π is affine and the integrals are exact; on curves π is a root, and
//! Gauss rules have enough points for 1e-12.
//!
//! Source: Wohlmuth, *A mortar finite element method using dual spaces for the Lagrange multiplier*, SIAM J. Numer. Anal.
//! 38 (2000).

use steklov_bem_operators::{Mesh, Space};
use steklov_elastic::plane::{cross, distance, dot, minus, norm, unit};
use steklov_quadrature::{BiorthogonalBasis, LobattoBasis, gauss_legendre};

/// Elements face each other where n·n' is below this.
const FACING: f64 = -0.2;
/// Ends of cells closer to an end of their element than this (parameter on [-1, 1]) are there.
const SNAP: f64 = 1e-11;
/// Upper limit of the same for small elements far from the origin, whose ends are rounded.
const NEAR: f64 = 1e-4;
/// A root on a curve is taken as found when it moves by less (parameter).
const ROUNDED: f64 = 1e-14;
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
    /// (1/D_i) ∫ ψ_i ds over the covered part: 1 if the elements of the node are covered completely.
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
    /// E/(1-ν²) of the body of each element of the mesh.
    pub modulus: &'a [f64],
}

impl Facing<'_> {
    /// E n of a point.
    fn pull(&self, e: usize, t: f64) -> [f64; 2] {
        self.mesh.normal(e, t).map(|n| self.modulus[e] * n)
    }
}

/// The point of an element that a point meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Met {
    /// The parameter, on a curve clamped to [-1, 1].
    pub t: f64,
    /// Distance along the direction of contact (length), negative where the sides overlap.
    pub distance: f64,
    /// The direction of contact, a unit vector.
    pub direction: [f64; 2],
}

/// The point of a mortar element that a point of a non-mortar element meets; `None` if the mortar element is seen edge-on.
pub fn meet(own: Facing<'_>, (e, t): (usize, f64), other: Facing<'_>, m: usize) -> Option<Met> {
    let (x, pull) = (own.mesh.point(e, t), own.pull(e, t));
    let t = paired(other, m, x, pull)?;
    let t = if other.mesh.is_line(m) { t } else { t.clamp(-1.0, 1.0) };
    let (y, push) = (other.mesh.point(m, t), other.pull(m, t.clamp(-1.0, 1.0)));
    let direction = unit(minus(pull, push));
    Some(Met { t, distance: dot(minus(y, x), direction), direction })
}

/// The parameter of the point y of an element for which y - x is along `pull` - E n(y): on a line not restricted to [-1, 1],
/// on a curve outside of it if there is none inside; `None` if the element is seen edge-on.
fn paired(side: Facing<'_>, e: usize, x: [f64; 2], pull: [f64; 2]) -> Option<f64> {
    let mesh = side.mesh;
    // has the sign of (y - x)·τ
    let along = |t: f64| {
        let (y, push) = (mesh.point(e, t), side.pull(e, t));
        cross(minus(y, x), minus(pull, push))
    };
    if mesh.is_line(e) {
        let push = side.pull(e, 0.0);
        let to = minus(pull, push);
        let slope = cross(mesh.tangent(e, 0.0), to);
        return (slope.abs() > 1e-3 * norm(to)).then(|| -along(0.0) / (slope * mesh.speed(e, 0.0)));
    }
    let ends = [-1.0, 1.0].map(along);
    if ends[0] <= 0.0 && ends[1] >= 0.0 {
        return Some(root(&along, ends));
    }
    // ahead of both ends, or behind; where it falls from + to - the element is farthest from x
    let away = |t: f64| {
        let y = mesh.point(e, t);
        distance(y, x)
    };
    let ahead = if ends[0] * ends[1] > 0.0 { ends[0] < 0.0 } else { away(1.0) < away(-1.0) };
    Some(if ahead { 2.0 } else { -2.0 })
}

/// The root in [-1, 1] of a function that rises from the first of these values to the second, by the Illinois method.
///
/// Source: Dowell and Jarratt (1971).
fn root(f: &dyn Fn(f64) -> f64, [mut at_low, mut at_high]: [f64; 2]) -> f64 {
    let ([mut low, mut high], mut kept, mut last) = ([-1.0, 1.0], 0, f64::INFINITY);
    for _ in 0..100 {
        let t = if at_low == at_high { low } else { low - at_low * (high - low) / (at_high - at_low) };
        if (t - last).abs() < ROUNDED || high - low < ROUNDED {
            return t;
        }
        last = t;
        let here = f(t);
        if here == 0.0 {
            return t;
        }
        if here < 0.0 {
            (low, at_low) = (t, here);
            at_high = if kept == 1 { at_high / 2.0 } else { at_high };
            kept = 1;
        } else {
            (high, at_high) = (t, here);
            at_low = if kept == -1 { at_low / 2.0 } else { at_low };
            kept = -1;
        }
    }
    last
}

/// A cell that is not cut yet, and the distance in its middle.
type Draft = (Cell, f64);

/// The common refinement: the parts of the non-mortar elements that mortar elements face, at distances in the given range.
/// Where several face one, the nearest counts. Gaps between cells, as beside a corner of the mortar side, and gaps up to the
/// length `near` at the ends of cells face the end of the adjacent mortar element.
pub fn cells(own: Facing<'_>, other: Facing<'_>, [low, high]: [f64; 2], near: f64) -> Vec<Cell> {
    let mut cells = Vec::new();
    for &e in own.elements {
        let snap = SNAP.max(own.mesh.resolution(e)).min(NEAR);
        let snapped = |t: f64| if (t.abs() - 1.0).abs() < snap { t.signum() } else { t.clamp(-1.0, 1.0) };
        let mut drafts: Vec<Draft> = Vec::new();
        for &m in other.elements {
            let ends = [-1.0, 1.0].map(|t| paired(own, e, other.mesh.point(m, t), other.pull(m, t)));
            let [Some(a), Some(b)] = ends else { continue };
            let span = [snapped(a.min(b)), snapped(a.max(b))];
            if span[1] - span[0] < SLIVER.max(2.0 * snap) {
                continue;
            }
            let middle = (span[0] + span[1]) / 2.0;
            let Some(met) = meet(own, (e, middle), other, m) else { continue };
            let away = dot(own.mesh.normal(e, middle), other.mesh.normal(m, met.t.clamp(-1.0, 1.0)));
            if met.t.abs() <= 1.0 && away < FACING && low <= met.distance && met.distance <= high {
                drafts.push((Cell { element: e, span, other: m }, met.distance.abs()));
            }
        }
        let mut of_element = nearest(drafts, SLIVER.max(2.0 * snap));
        close(&mut of_element, 2.0 * near / own.mesh.length(e), other.mesh);
        if of_element.is_empty() && own.mesh.length(e) <= near {
            let cell = |m| Cell { element: e, span: [-1.0, 1.0], other: m };
            of_element.extend(beside(own, e, other, [low, high], 2.0 * near).map(cell));
        }
        cells.append(&mut of_element);
    }
    cells
}

/// The parts of cells on which no other cell is nearer, in their order.
fn nearest(mut drafts: Vec<Draft>, shortest: f64) -> Vec<Cell> {
    drafts.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut cells: Vec<Cell> = Vec::new();
    for (draft, _) in drafts {
        let mut parts = vec![draft.span];
        for taken in cells.iter().map(|cell| cell.span) {
            let beside = |[a, b]: [f64; 2]| [[a, b.min(taken[0])], [a.max(taken[1]), b]];
            parts = parts.into_iter().flat_map(beside).filter(|[a, b]| b - a > shortest).collect();
        }
        cells.extend(parts.into_iter().map(|span| Cell { span, ..draft }));
    }
    cells.sort_by(|a, b| a.span[0].total_cmp(&b.span[0]));
    cells
}

/// The mortar element whose end, the end of its side, a non-mortar element passes by no more than `near`.
fn beside(own: Facing<'_>, e: usize, other: Facing<'_>, [low, high]: [f64; 2], near: f64) -> Option<usize> {
    let (x, pull) = (own.mesh.point(e, 0.0), own.pull(e, 0.0));
    let end = |m: usize, t: f64| {
        let (y, push) = (other.mesh.point(m, t), other.pull(m, t));
        let (r, along) = (minus(y, x), minus(pull, push));
        let length = norm(along);
        let (aside, distance) = (cross(r, along).abs() / length, dot(r, along) / length);
        (aside <= near && low <= distance && distance <= high).then_some((m, distance.abs()))
    };
    let ends = other.elements.iter().flat_map(|&m| [end(m, -1.0), end(m, 1.0)]).flatten();
    ends.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(m, _)| m)
}

/// Lengthens the cells of an element over the gaps between neighbours, and over no more than `near` elsewhere.
fn close(cells: &mut [Cell], near: f64, mesh: &Mesh) {
    for k in 1..cells.len() {
        let [a, b] = [cells[k - 1].other, cells[k].other];
        if mesh.next[a] == b || mesh.next[b] == a || cells[k].span[0] - cells[k - 1].span[1] <= near {
            cells[k - 1].span[1] = cells[k].span[0];
        }
    }
    if let Some(first) = cells.first_mut().filter(|cell| cell.span[0] + 1.0 <= near) {
        first.span[0] = -1.0;
    }
    if let Some(last) = cells.last_mut().filter(|cell| 1.0 - cell.span[1] <= near) {
        last.span[1] = 1.0;
    }
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
        let Some(Met { t: s, distance, .. }) = meet(own, (e, t), other, m) else { continue };
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

#[cfg(test)]
mod tests;
