//! What the pairs of elements contribute to the columns of V, K and W.

use std::ops::Range;

use faer::Mat;

use crate::moments::{Geometry, Tables, first_is_outer};
use crate::pass::{Block, Pass};
use crate::{Bubbles, Enrichment, Operators, Space};

/// The matrices that one pass over the pairs fills.
#[derive(Default)]
pub(crate) struct Targets<'m> {
    pub(crate) operators: Option<&'m mut Operators>,
    pub(crate) enrichment: Option<&'m mut Enrichment>,
    pub(crate) bubbles: Option<&'m mut Bubbles>,
}

/// The columns that belong to a group of consecutive elements: of V, K and W those of their traction coefficients, and of
/// their nodes but the last one of each; of the enrichment two for each element. Empty where they are not wanted.
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
    /// G̃ times the trial derivative for each test degree.
    g_xx: Vec<f64>,
    g_yy: Vec<f64>,
    g_xy: Vec<f64>,
}

/// The functions of an element of one degree: the nodal ones from start to end, then, with an enrichment, the bubble
/// (P_(p+1) - P_(p-1))/(2p+1).
pub(crate) struct Local {
    /// Legendre coefficients of each function, one more than there are test degrees.
    values: Vec<f64>,
    /// Legendre coefficients of its derivative with respect to t.
    derivatives: Vec<f64>,
}

impl Local {
    pub(crate) fn new(space: &Space, e: usize, enriched: bool) -> Self {
        let basis = space.basis(e);
        let p = basis.degree;
        let top = p + usize::from(enriched);
        let (mut values, mut derivatives) = (Vec::new(), Vec::new());
        for j in 0..=p {
            values.extend((0..=top).map(|n| if n <= p { basis.to_legendre[(n, j)] } else { 0.0 }));
            derivatives.extend((0..top).map(|n| if n < p { basis.derivative_to_legendre[(n, j)] } else { 0.0 }));
        }
        if enriched {
            let scale = 1.0 / (2 * p + 1) as f64;
            values.extend((0..=top).map(|n| match n {
                _ if n == p + 1 => scale,
                _ if n + 1 == p => -scale,
                _ => 0.0,
            }));
            derivatives.extend((0..top).map(|n| if n == p { 1.0 } else { 0.0 }));
        }
        Self { values, derivatives }
    }
}

/// Columns that one task owns, at least; neighbours in a group share their tables.
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
            let at = m * t.trial + n;
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
            self.double_layer(a, trial, j, pa..pa + 1, scratch, |_, entries| add_block(tx, ty, 2 * a, entries));
        }
        let Some([kx, ky]) = columns.k.get_mut(range.clone()) else { return };
        self.double_layer(a, trial, j, 0..pa, scratch, |m, entries| add_block(kx, ky, row0 + 2 * m, entries));
        let Some([wx, wy]) = columns.w.get_mut(range) else { return };
        let last = 2 * self.space.node(a, pa);
        for i in 0..=pa {
            let row = if i < pa { row0 + 2 * i } else { last };
            add_entries(wx, wy, row, [self.hypersingular(a, i, scratch)]);
        }
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
        match layers {
            Some([[kx, ky], [tx, ty]]) => self.double_layer(a, trial, pc + 1, 0..pa + 1, scratch, |m, entries| {
                if m < pa { add_block(kx, ky, row0 + 2 * m, entries) } else { add_block(tx, ty, 2 * a, entries) }
            }),
            None => self.double_layer(a, trial, pc + 1, 0..pa + 1, scratch, |_, _| ()),
        }
        let Some([[wx, wy], [tx, ty]]) = bubbles else { return };
        let last = 2 * self.space.node(a, pa);
        for i in 0..=pa {
            let row = if i < pa { row0 + 2 * i } else { last };
            add_entries(wx, wy, row, [self.hypersingular(a, i, scratch)]);
        }
        add_entries(tx, ty, 2 * a, [self.hypersingular(a, pa + 1, scratch)]);
    }

    /// Entries [xx, yx, xy, yy] of K for the test degrees m in `rows` and function j of the trial element; keeps G̃ times
    /// its derivative for [`Self::hypersingular`].
    #[inline(always)]
    fn double_layer(
        &self,
        a: usize,
        trial: usize,
        j: usize,
        rows: Range<usize>,
        scratch: &mut Scratch,
        mut add: impl FnMut(usize, [f64; 4]),
    ) {
        let Scratch { tables: t, g_xx, g_yy, g_xy } = scratch;
        let (constants, half) = (&self.constants, self.half[a]);
        let (ma, nc) = (t.test, t.trial);
        let local = &self.locals[self.local_of[trial]];
        for g in [&mut *g_xx, &mut *g_yy, &mut *g_xy] {
            g.resize(ma, 0.0);
        }
        let derivative = &local.derivatives[j * nc..][..nc];
        let value = &local.values[j * (nc + 1)..][..nc + 1];
        for m in rows {
            let log = dot(&t.log[m * nc..][..nc], derivative);
            let xx = dot(&t.xx[m * nc..][..nc], derivative);
            let xy = dot(&t.xy[m * nc..][..nc], derivative);
            let d = 0.5 / std::f64::consts::PI * dot(&t.d[m * (nc + 1)..][..nc + 1], value);
            let yy = if m == 0 { 4.0 * derivative[0] - xx } else { -xx };
            // |d_a| { D/(2π) + H J }, (HJ)_i0 = H_i1, (HJ)_i1 = -H_i0
            add(
                m,
                [
                    half * (d + constants.h_rr * xy),
                    half * (constants.h_log * log + constants.h_rr * yy),
                    -half * (constants.h_log * log + constants.h_rr * xx),
                    half * (d - constants.h_rr * xy),
                ],
            );
            g_xx[m] = constants.c_w * (xx - log);
            g_yy[m] = constants.c_w * (yy - log);
            g_xy[m] = constants.c_w * xy;
        }
    }

    /// Entries xx, xy, yy of W for function i of the test element.
    #[inline(always)]
    fn hypersingular(&self, a: usize, i: usize, scratch: &Scratch) -> (f64, f64, f64) {
        let ma = scratch.tables.test;
        let b = &self.locals[self.local_of[a]].derivatives[i * ma..][..ma];
        (dot(b, &scratch.g_xx), dot(b, &scratch.g_xy), dot(b, &scratch.g_yy))
    }
}

/// Adds a 2×2 block [xx, yx, xy, yy] to two columns, from `row` on.
#[inline(always)]
fn add_block(x: &mut [f64], y: &mut [f64], row: usize, entries: [f64; 4]) {
    x[row] += entries[0];
    x[row + 1] += entries[1];
    y[row] += entries[2];
    y[row + 1] += entries[3];
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

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The columns of a matrix as slices.
fn column_slices(a: &mut Mat<f64>) -> impl Iterator<Item = &mut [f64]> {
    a.col_iter_mut().filter_map(|column| column.try_as_col_major_mut()).map(|column| column.as_slice_mut())
}

/// The next columns of a matrix; none of one that is not wanted.
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
