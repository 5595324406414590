//! What the pairs of elements contribute to the columns of V, K and W.

use faer::Mat;

use crate::Space;
use crate::moments::{Geometry, Tables, first_is_outer, storage};
use crate::pass::{Block, Pass};

/// The columns of V, K and W that belong to a group of consecutive elements: their traction coefficients, and their
/// nodes but the last one of each.
pub(crate) struct Columns<'a> {
    elements: std::ops::Range<usize>,
    v: Vec<&'a mut [f64]>,
    k: Vec<&'a mut [f64]>,
    w: Vec<&'a mut [f64]>,
}

#[derive(Default)]
pub(crate) struct Scratch {
    tables: Tables,
    /// G̃ times the trial derivative for each test degree.
    g_xx: Vec<f64>,
    g_yy: Vec<f64>,
    g_xy: Vec<f64>,
}

/// The small matrices of a degree, node by node.
pub(crate) struct Local {
    /// Legendre coefficients n = 0..=p of each nodal function.
    values: Vec<f64>,
    /// Legendre coefficients n = 0..p of its derivative with respect to t.
    derivatives: Vec<f64>,
}

impl Local {
    pub(crate) fn new(space: &Space, e: usize) -> Self {
        let basis = space.basis(e);
        let p = basis.degree;
        let pairs = |count: usize| (0..=p).flat_map(move |j| (0..count).map(move |n| (n, j)));
        Self {
            values: pairs(p + 1).map(|at| basis.to_legendre[at]).collect(),
            derivatives: pairs(p).map(|at| basis.derivative_to_legendre[at]).collect(),
        }
    }
}

/// Columns that one task owns, at least; neighbours in a group share their tables.
const TASK_COLUMNS: usize = 24;

impl Pass<'_> {
    /// Splits the matrices into the columns of groups of elements.
    pub(crate) fn columns<'m>(
        &self,
        v: &'m mut Mat<f64>,
        k: &'m mut Mat<f64>,
        w: &'m mut Mat<f64>,
    ) -> Vec<Columns<'m>> {
        let mut v = column_slices(v);
        let mut k = column_slices(k);
        let mut w = column_slices(w);
        let mut groups = Vec::new();
        let (mut start, mut count) = (0, 0);
        for e in 0..self.len() {
            count += 2 * self.degree[e];
            if count >= TASK_COLUMNS || e + 1 == self.len() {
                groups.push(Columns {
                    elements: start..e + 1,
                    v: v.by_ref().take(count).collect(),
                    k: k.by_ref().take(count).collect(),
                    w: w.by_ref().take(count).collect(),
                });
                (start, count) = (e + 1, 0);
            }
        }
        groups
    }

    /// Adds to the columns of a group what the pairs of a block contribute: its elements as trial elements, and of the
    /// elements before them the end node, which is a first node of the group.
    #[inline(always)]
    pub(crate) fn add(&self, columns: &mut Columns<'_>, block: &Block<'_>, scratch: &mut Scratch) {
        let group = columns.elements.clone();
        let before = group.clone().map(|e| self.previous[e]).filter(|e| !group.contains(e));
        let trials: Vec<usize> = before.chain(group.clone()).collect();
        for test in block.rows.start..self.len() {
            for &trial in &trials {
                let (first, second) = (test.min(trial), test.max(trial));
                if !block.rows.contains(&first) {
                    continue;
                }
                let start = block.base[first - block.rows.start] + self.pair_offset(first, second);
                let first_outer = first_is_outer(self.segments[first], self.segments[second]);
                let (outer, inner) = if first_outer { (first, second) } else { (second, first) };
                let (m, n) = (self.degree[outer] + 1, self.degree[inner] + 1);
                let geometry = Geometry::with_log(self.segments[outer], self.segments[inner], self.log_half[inner]);
                let (pa, pc) = (self.degree[test], self.degree[trial]);
                let moments = &block.moments[start..start + storage(m - 1, n - 1)];
                scratch.tables.fill(&geometry, m, n, moments, outer == test, pa, pc);
                if group.contains(&trial) {
                    let column = 2 * (self.space.offset[trial] - self.space.offset[group.start]);
                    self.add_single_layer(test, trial, &mut columns.v[column..column + 2 * pc], &scratch.tables);
                    let (k, w) = (&mut columns.k[column..], &mut columns.w[column..]);
                    self.add_nodes(test, trial, 0..pc, k, w, scratch);
                }
                let next = self.space.next[trial];
                if group.contains(&next) {
                    let column = 2 * (self.space.offset[next] - self.space.offset[group.start]);
                    let (k, w) = (&mut columns.k[column..], &mut columns.w[column..]);
                    self.add_nodes(test, trial, pc..pc + 1, k, w, scratch);
                }
            }
        }
    }

    /// V_ab[m,n] = |d_a||d_b| c_V [ -κ LOG I + rr ], LOG of log(r/L).
    #[inline(always)]
    fn add_single_layer(&self, a: usize, c: usize, v: &mut [&mut [f64]], t: &Tables) {
        let constants = &self.constants;
        let scale = self.segments[a].half().norm() * self.segments[c].half().norm() * constants.c_v;
        let row0 = 2 * self.space.offset[a];
        for n in 0..t.trial {
            let [vx, vy] = &mut v[2 * n..2 * n + 2] else { continue };
            let rows = row0..row0 + 2 * t.test;
            let pairs = vx[rows.clone()].chunks_exact_mut(2).zip(vy[rows].chunks_exact_mut(2));
            for (m, (vx, vy)) in pairs.enumerate() {
                let at = m * t.trial + n;
                let (xx, xy) = (t.xx[at], t.xy[at]);
                let yy = if m == 0 && n == 0 { 4.0 - xx } else { -xx };
                let log = -constants.kappa * t.log[at];
                vx[0] += scale * (log + xx);
                vx[1] += scale * xy;
                vy[0] += scale * xy;
                vy[1] += scale * (log + yy);
            }
        }
    }

    /// K and W for the trial element's local nodes `nodes`, into columns of which the first two belong to the first node.
    #[inline(always)]
    fn add_nodes(
        &self,
        a: usize,
        trial: usize,
        nodes: std::ops::Range<usize>,
        k: &mut [&mut [f64]],
        w: &mut [&mut [f64]],
        scratch: &mut Scratch,
    ) {
        let Scratch { tables: t, g_xx, g_yy, g_xy } = scratch;
        let (constants, half) = (&self.constants, self.segments[a].half().norm());
        let (pa, pc) = (t.test, t.trial);
        let local = &self.locals[self.local_of[trial]];
        let test = &self.locals[self.local_of[a]];
        let row0 = 2 * self.space.offset[a];
        let last = 2 * self.space.node(a, pa);
        for g in [&mut *g_xx, &mut *g_yy, &mut *g_xy] {
            g.resize(pa, 0.0);
        }
        for (column, j) in nodes.enumerate() {
            let [kx, ky] = &mut k[2 * column..2 * column + 2] else { continue };
            let [wx, wy] = &mut w[2 * column..2 * column + 2] else { continue };
            let derivative = &local.derivatives[j * pc..][..pc];
            let value = &local.values[j * (pc + 1)..][..pc + 1];
            let rows = row0..row0 + 2 * pa;
            let pairs = kx[rows.clone()].chunks_exact_mut(2).zip(ky[rows].chunks_exact_mut(2));
            for (m, (kx, ky)) in pairs.enumerate() {
                let log = dot(&t.log[m * pc..][..pc], derivative);
                let xx = dot(&t.xx[m * pc..][..pc], derivative);
                let xy = dot(&t.xy[m * pc..][..pc], derivative);
                let d = 0.5 / std::f64::consts::PI * dot(&t.d[m * (pc + 1)..][..pc + 1], value);
                let yy = if m == 0 { 4.0 * derivative[0] - xx } else { -xx };
                // |d_a| { D/(2π) + H J }, (HJ)_i0 = H_i1, (HJ)_i1 = -H_i0
                kx[0] += half * (d + constants.h_rr * xy);
                kx[1] += half * (constants.h_log * log + constants.h_rr * yy);
                ky[0] -= half * (constants.h_log * log + constants.h_rr * xx);
                ky[1] += half * (d - constants.h_rr * xy);
                g_xx[m] = constants.c_w * (xx - log);
                g_yy[m] = constants.c_w * (yy - log);
                g_xy[m] = constants.c_w * xy;
            }
            for i in 0..=pa {
                let b = &test.derivatives[i * pa..][..pa];
                let (xx, yy, xy) = (dot(b, g_xx), dot(b, g_yy), dot(b, g_xy));
                let row = if i < pa { row0 + 2 * i } else { last };
                wx[row] += xx;
                wx[row + 1] += xy;
                wy[row] += xy;
                wy[row + 1] += yy;
            }
        }
    }
}

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The columns of a matrix as slices.
fn column_slices(a: &mut Mat<f64>) -> impl Iterator<Item = &mut [f64]> {
    a.col_iter_mut().filter_map(|column| column.try_as_col_major_mut()).map(|column| column.as_slice_mut())
}
