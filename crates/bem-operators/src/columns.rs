//! The contributions of the pairs of elements to the columns of V, K and W.

use std::ops::Range;

use faer::Mat;

use crate::moments::{Geometry, LANES, Tables, first_is_outer};
use crate::pass::{Block, Pass};
use crate::{Bubbles, Enrichment, Operators};

/// The matrices that one pass over the pairs fills.
#[derive(Default)]
pub(crate) struct Targets<'m> {
    pub(crate) operators: Option<&'m mut Operators>,
    pub(crate) enrichment: Option<&'m mut Enrichment>,
    pub(crate) bubbles: Option<&'m mut Bubbles>,
}

/// The columns of a group of consecutive elements: in V, K and W those of their traction coefficients and of their nodes
/// except the last node of each; in the enrichment two for each element. Empty if they are not wanted.
pub(crate) struct Columns<'a> {
    elements: Range<usize>,
    v: Vec<&'a mut [f64]>,
    k: Vec<&'a mut [f64]>,
    w: Vec<&'a mut [f64]>,
    /// K's rows of the top tractions, in the columns of the nodes.
    k_top: Vec<&'a mut [f64]>,
    /// The columns of the top tractions and of the bubbles: the rows of the base, and the extra ones.
    v_extra: [Vec<&'a mut [f64]>; 2],
    k_extra: [Vec<&'a mut [f64]>; 2],
    w_extra: [Vec<&'a mut [f64]>; 2],
}

#[derive(Default)]
pub(crate) struct Scratch {
    tables: Tables,
    /// Entries xx, yx, xy, yy of K of one trial function with each test degree.
    k: [Vec<f64>; 4],
    /// c_W G̃ times the derivative of the trial function, xx, xy, yy, for each test degree.
    g: [Vec<f64>; 3],
    /// Entries xx, xy, yy of W with each test function.
    w: [Vec<f64>; 3],
}

/// Smallest number of columns that one task owns; neighbours in a group share their tables.
const TASK_COLUMNS: usize = 24;

impl Pass<'_> {
    /// Splits the matrices into the columns of groups of elements.
    pub(crate) fn columns<'m>(&self, targets: Targets<'m>) -> Vec<Columns<'m>> {
        let Targets { operators, enrichment, bubbles } = targets;
        let [mut v, mut k, mut w] = match operators {
            None => [const { None }; 3],
            Some(o) => [&mut o.v, &mut o.k, &mut o.w].map(|m| Some(column_slices(m))),
        };
        let [mut k_top, mut layers @ ..] = match enrichment {
            None => [const { None }; 5],
            Some(x) => {
                [&mut x.k_top, &mut x.v, &mut x.v_corner, &mut x.k, &mut x.k_corner].map(|m| Some(column_slices(m)))
            }
        };
        let mut bubbles = match bubbles {
            None => [const { None }; 2],
            Some(b) => [&mut b.w, &mut b.w_corner].map(|m| Some(column_slices(m))),
        };
        let mut groups = Vec::new();
        let (mut start, mut count) = (0, 0);
        for e in 0..self.len() {
            count += 2 * self.degree[e];
            if count >= TASK_COLUMNS || e + 1 == self.len() {
                let extra = 2 * (e + 1 - start);
                let [v_base, v_corner, k_base, k_corner] = layers.each_mut().map(|m| next_columns(m, extra));
                groups.push(Columns {
                    elements: start..e + 1,
                    v: next_columns(&mut v, count),
                    k: next_columns(&mut k, count),
                    w: next_columns(&mut w, count),
                    k_top: next_columns(&mut k_top, count),
                    v_extra: [v_base, v_corner],
                    k_extra: [k_base, k_corner],
                    w_extra: bubbles.each_mut().map(|m| next_columns(m, extra)),
                });
                (start, count) = (e + 1, 0);
            }
        }
        groups
    }

    /// Adds the contributions of the pairs of a block to the columns of a group: the group's elements as trial elements, and
    /// the end node of the elements before them, which is a first node of the group.
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
                let (pa, pc) = (self.degree[test], self.degree[trial]);
                let (tests, trials) = (pa + self.more, pc + self.more);
                let moments = &block.moments[start..start + self.pair_size(first, second)];
                if self.is_straight(first, second) {
                    let first_outer = first_is_outer(self.segments[first], self.segments[second]);
                    let (outer, inner) = if first_outer { (first, second) } else { (second, first) };
                    let (m, n) = (self.order[outer] + 1, self.order[inner] + 1);
                    let geometry = Geometry::with_log(self.segments[outer], self.segments[inner], self.log_half[inner]);
                    scratch.tables.fill(&geometry, m, n, moments, outer == test, tests, trials);
                } else {
                    let (m, n) = (self.order[first] + 1, self.order[second] + 1);
                    scratch.tables.fill_curved(self.log_length, m, n, moments, first == test, tests, trials);
                }
                if group.contains(&trial) {
                    let column = 2 * (self.space.offset[trial] - self.space.offset[group.start]);
                    self.add_single_layer(test, trial, columns, column, &scratch.tables);
                    for j in 0..pc {
                        self.add_node(test, trial, j, columns, column + 2 * j, scratch);
                    }
                    self.add_bubble(test, trial, columns, scratch);
                }
                let next = self.space.next[trial];
                if group.contains(&next) {
                    let column = 2 * (self.space.offset[next] - self.space.offset[group.start]);
                    self.add_node(test, trial, pc, columns, column, scratch);
                }
            }
        }
    }

    /// V_ab[m,n] = |d_a||d_b| c_V [ -κ LOG I + rr ], LOG of log(r/L).
    #[inline(always)]
    fn add_single_layer(&self, a: usize, c: usize, columns: &mut Columns<'_>, column: usize, t: &Tables) {
        let constants = &self.constants;
        let scale = self.half[a] * self.half[c] * constants.c_v;
        let row0 = 2 * self.space.offset[a];
        let (pa, pc) = (self.degree[a], self.degree[c]);
        let entry = |m: usize, n: usize| {
            let at = n * t.stride + m;
            let (xx, xy) = (t.xx[at], t.xy[at]);
            let yy = if m == 0 && n == 0 { 4.0 - xx } else { -xx };
            let log = -constants.kappa * t.log[at];
            (scale * (log + xx), scale * xy, scale * (log + yy))
        };
        for n in 0..pc {
            let Some([vx, vy]) = columns.v.get_mut(column + 2 * n..column + 2 * n + 2) else { break };
            add_entries(vx, vy, row0, (0..pa).map(|m| entry(m, n)));
        }
        if let Some([base, corner]) = extra_columns(&mut columns.v_extra, c - columns.elements.start) {
            let ([vx, vy], [tx, ty]) = (base, corner);
            add_entries(vx, vy, row0, (0..pa).map(|m| entry(m, pc)));
            add_entries(tx, ty, 2 * a, [entry(pa, pc)]);
        }
    }

    /// K and W for the local node j of the trial element, in the columns `column` and `column + 1` of the group.
    #[inline(always)]
    fn add_node(
        &self,
        a: usize,
        trial: usize,
        j: usize,
        columns: &mut Columns<'_>,
        column: usize,
        scratch: &mut Scratch,
    ) {
        let row0 = 2 * self.space.offset[a];
        let pa = self.degree[a];
        let range = column..column + 2;
        if let Some([tx, ty]) = columns.k_top.get_mut(range.clone()) {
            self.double_layer(a, trial, j, pa..pa + 1, scratch);
            add_blocks(tx, ty, 2 * a, pa..pa + 1, &scratch.k);
        }
        let Some([kx, ky]) = columns.k.get_mut(range.clone()) else { return };
        self.double_layer(a, trial, j, 0..pa, scratch);
        add_blocks(kx, ky, row0, 0..pa, &scratch.k);
        let Some([wx, wy]) = columns.w.get_mut(range) else { return };
        self.hypersingular(a, scratch);
        let entry = |i: usize| (scratch.w[0][i], scratch.w[1][i], scratch.w[2][i]);
        add_entries(wx, wy, row0, (0..pa).map(entry));
        add_entries(wx, wy, 2 * self.space.node(a, pa), [entry(pa)]);
    }

    /// K and W for the bubble of the trial element.
    #[inline(always)]
    fn add_bubble(&self, a: usize, trial: usize, columns: &mut Columns<'_>, scratch: &mut Scratch) {
        let row0 = 2 * self.space.offset[a];
        let (pa, pc) = (self.degree[a], self.degree[trial]);
        let place = trial - columns.elements.start;
        let layers = extra_columns(&mut columns.k_extra, place);
        let bubbles = extra_columns(&mut columns.w_extra, place);
        if layers.is_none() && bubbles.is_none() {
            return;
        }
        self.double_layer(a, trial, pc + 1, 0..pa + 1, scratch);
        if let Some([[kx, ky], [tx, ty]]) = layers {
            add_blocks(kx, ky, row0, 0..pa, &scratch.k);
            add_blocks(tx, ty, 2 * a, pa..pa + 1, &scratch.k);
        }
        let Some([[wx, wy], [tx, ty]]) = bubbles else { return };
        self.hypersingular(a, scratch);
        let entry = |i: usize| (scratch.w[0][i], scratch.w[1][i], scratch.w[2][i]);
        add_entries(wx, wy, row0, (0..pa).map(entry));
        add_entries(wx, wy, 2 * self.space.node(a, pa), [entry(pa)]);
        add_entries(tx, ty, 2 * a, [entry(pa + 1)]);
    }

    /// Entries [xx, yx, xy, yy] of K for the test degrees in `rows` and function j of the trial element, and G̃ times its
    /// derivative for [`Self::hypersingular`]: |d_a| { D/(2π) + H J }, (HJ)_i0 = H_i1, (HJ)_i1 = -H_i0.
    #[inline(always)]
    fn double_layer(&self, a: usize, trial: usize, j: usize, rows: Range<usize>, scratch: &mut Scratch) {
        let Scratch { tables: t, k, g, .. } = scratch;
        let (constants, half, nc) = (&self.constants, self.half[a], t.trial);
        let local = &self.locals[self.local_of[trial]];
        k.iter_mut().chain(&mut *g).for_each(|part| part.resize(t.stride, 0.0));
        let derivative = &local.derivatives[j * nc..][..nc];
        let value = &local.values[j * (nc + 1)..][..nc + 1];
        for start in (rows.start / LANES * LANES..rows.end).step_by(LANES) {
            let [log, xx, xy] = [&t.log, &t.xx, &t.xy].map(|table| combination(&table[start..], t.stride, derivative));
            let d = combination(&t.d[start..], t.stride, value);
            for lane in 0..LANES {
                let (m, log, xx, xy) = (start + lane, log[lane], xx[lane], xy[lane]);
                let d = 0.5 / std::f64::consts::PI * d[lane];
                let yy = if m == 0 { 4.0 * derivative[0] - xx } else { -xx };
                k[0][m] = half * (d + constants.h_rr * xy);
                k[1][m] = half * (constants.h_log * log + constants.h_rr * yy);
                k[2][m] = -half * (constants.h_log * log + constants.h_rr * xx);
                k[3][m] = half * (d - constants.h_rr * xy);
                g[0][m] = constants.c_w * (xx - log);
                g[1][m] = constants.c_w * xy;
                g[2][m] = constants.c_w * (yy - log);
            }
        }
    }

    /// Entries xx, xy, yy of W for all functions of the test element.
    #[inline(always)]
    fn hypersingular(&self, a: usize, scratch: &mut Scratch) {
        let Scratch { tables: t, g, w, .. } = scratch;
        let local = &self.locals[self.local_of[a]];
        for (w, g) in w.iter_mut().zip(g) {
            w.resize(local.stride, 0.0);
            for start in (0..local.stride).step_by(LANES) {
                let part = combination(&local.transposed[start..], local.stride, &g[..t.test]);
                w[start..start + LANES].copy_from_slice(&part);
            }
        }
    }
}

/// The first [`LANES`] of Σ_n column_n factor_n.
#[inline(always)]
fn combination(columns: &[f64], stride: usize, factors: &[f64]) -> [f64; LANES] {
    // the sign of a sum of nothing
    let mut sums = [-0.0; LANES];
    for (n, factor) in factors.iter().enumerate() {
        for (sum, value) in sums.iter_mut().zip(&columns[n * stride..][..LANES]) {
            *sum += value * factor;
        }
    }
    sums
}

/// Adds 2×2 blocks [xx, yx, xy, yy] of the degrees in `rows` to two columns, the first of them at `row`.
#[inline(always)]
fn add_blocks(x: &mut [f64], y: &mut [f64], row: usize, rows: Range<usize>, [xx, yx, xy, yy]: &[Vec<f64>; 4]) {
    let columns = x[row..].chunks_exact_mut(2).zip(y[row..].chunks_exact_mut(2));
    for ((x, y), m) in columns.zip(rows) {
        x[0] += xx[m];
        x[1] += yx[m];
        y[0] += xy[m];
        y[1] += yy[m];
    }
}

/// Adds symmetric 2×2 entries (xx, xy, yy) to two columns, from `row` on.
#[inline(always)]
fn add_entries(x: &mut [f64], y: &mut [f64], row: usize, entries: impl IntoIterator<Item = (f64, f64, f64)>) {
    let rows = x[row..].chunks_exact_mut(2).zip(y[row..].chunks_exact_mut(2));
    for ((x, y), (xx, xy, yy)) in rows.zip(entries) {
        x[0] += xx;
        x[1] += xy;
        y[0] += xy;
        y[1] += yy;
    }
}

/// The columns of a matrix as slices.
fn column_slices(a: &mut Mat<f64>) -> impl Iterator<Item = &mut [f64]> {
    a.col_iter_mut().filter_map(|column| column.try_as_col_major_mut()).map(|column| column.as_slice_mut())
}

/// The next columns of a matrix; none if the matrix is not wanted.
fn next_columns<'m>(columns: &mut Option<impl Iterator<Item = &'m mut [f64]>>, count: usize) -> Vec<&'m mut [f64]> {
    columns.iter_mut().flat_map(|columns| columns.take(count)).collect()
}

/// The two columns of an element's extra unknowns, rows of the base and extra rows; none if they are not wanted.
#[inline(always)]
fn extra_columns<'m, 'a>(
    [base, corner]: &'m mut [Vec<&'a mut [f64]>; 2],
    place: usize,
) -> Option<[&'m mut [&'a mut [f64]; 2]; 2]> {
    let range = 2 * place..2 * place + 2;
    Some([base.get_mut(range.clone())?.try_into().ok()?, corner.get_mut(range)?.try_into().ok()?])
}
