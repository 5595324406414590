//! What the pairs of elements contribute to the columns of V, K and W.

use faer::Mat;

use crate::enrichment::Enrichment;
use crate::moments::{Geometry, Tables, first_is_outer, storage};
use crate::pass::{Block, Pass};
use crate::{Operators, Space};

/// The columns of V, K and W that belong to a group of consecutive elements: their traction coefficients, and their
/// nodes but the last one of each.
pub(crate) struct Columns<'a> {
    elements: std::ops::Range<usize>,
    v: Vec<&'a mut [f64]>,
    k: Vec<&'a mut [f64]>,
    w: Vec<&'a mut [f64]>,
    /// Of the enrichment, if there is one: K's rows of the top tractions in the same columns, and the columns of the
    /// top tractions and of the bubbles, two for each element, their rows those of the base and then the extra ones.
    k_top: Vec<&'a mut [f64]>,
    v_extra: Vec<&'a mut [f64]>,
    k_extra: Vec<&'a mut [f64]>,
    w_extra: Vec<&'a mut [f64]>,
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
    pub(crate) fn columns<'m>(
        &self,
        operators: &'m mut Operators,
        enrichment: Option<&'m mut Enrichment>,
    ) -> Vec<Columns<'m>> {
        let mut base = [&mut operators.v, &mut operators.k, &mut operators.w].map(column_slices);
        let mut extra = enrichment.map(|x| [&mut x.k_top, &mut x.v, &mut x.k, &mut x.w].map(column_slices));
        let mut groups = Vec::new();
        let (mut start, mut count) = (0, 0);
        for e in 0..self.len() {
            count += 2 * self.degree[e];
            if count >= TASK_COLUMNS || e + 1 == self.len() {
                let [v, k, w] = base.each_mut().map(|m| m.by_ref().take(count).collect());
                let [k_top, v_extra, k_extra, w_extra] = match &mut extra {
                    None => Default::default(),
                    Some([k_top, rest @ ..]) => {
                        let [v, k, w] = rest.each_mut().map(|m| m.by_ref().take(2 * (e + 1 - start)).collect());
                        [k_top.by_ref().take(count).collect(), v, k, w]
                    }
                };
                groups.push(Columns { elements: start..e + 1, v, k, w, k_top, v_extra, k_extra, w_extra });
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
        let more = usize::from(self.enriched);
        for test in block.rows.start..self.len() {
            for &trial in &trials {
                let (first, second) = (test.min(trial), test.max(trial));
                if !block.rows.contains(&first) {
                    continue;
                }
                let start = block.base[first - block.rows.start] + self.pair_offset(first, second);
                let first_outer = first_is_outer(self.segments[first], self.segments[second]);
                let (outer, inner) = if first_outer { (first, second) } else { (second, first) };
                let (m, n) = (self.order[outer] + 1, self.order[inner] + 1);
                let geometry = Geometry::with_log(self.segments[outer], self.segments[inner], self.log_half[inner]);
                let (pa, pc) = (self.degree[test], self.degree[trial]);
                let moments = &block.moments[start..start + storage(m - 1, n - 1)];
                scratch.tables.fill(&geometry, m, n, moments, outer == test, pa + more, pc + more);
                if group.contains(&trial) {
                    let column = 2 * (self.space.offset[trial] - self.space.offset[group.start]);
                    self.add_single_layer(test, trial, columns, column, &scratch.tables);
                    for j in 0..pc {
                        self.add_node(test, trial, j, columns, column + 2 * j, scratch);
                    }
                    if self.enriched {
                        self.add_bubble(test, trial, columns, scratch);
                    }
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
        let scale = self.segments[a].half().norm() * self.segments[c].half().norm() * constants.c_v;
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
            let [vx, vy] = &mut columns.v[column + 2 * n..][..2] else { continue };
            add_entries(vx, vy, row0, (0..pa).map(|m| entry(m, n)));
        }
        if self.enriched {
            let first = 2 * (c - columns.elements.start);
            let [vx, vy] = &mut columns.v_extra[first..][..2] else { return };
            add_entries(vx, vy, row0, (0..pa).map(|m| entry(m, pc)));
            add_entries(vx, vy, self.extra_row(a), [entry(pa, pc)]);
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
        let [kx, ky] = &mut columns.k[column..][..2] else { return };
        let top = |m: usize, entries: [f64; 4], kx: &mut [f64], ky: &mut [f64]| {
            kx[m] += entries[0];
            kx[m + 1] += entries[1];
            ky[m] += entries[2];
            ky[m + 1] += entries[3];
        };
        if self.enriched {
            let [tx, ty] = &mut columns.k_top[column..][..2] else { return };
            self.double_layer(a, trial, j, scratch, |m, entries| {
                if m < pa { top(row0 + 2 * m, entries, kx, ky) } else { top(2 * a, entries, tx, ty) }
            });
        } else {
            self.double_layer(a, trial, j, scratch, |m, entries| top(row0 + 2 * m, entries, kx, ky));
        }
        let [wx, wy] = &mut columns.w[column..][..2] else { return };
        let last = 2 * self.space.node(a, pa);
        for i in 0..=pa {
            let row = if i < pa { row0 + 2 * i } else { last };
            add_entries(wx, wy, row, [self.hypersingular(a, i, scratch)]);
        }
    }

    /// K and W for the bubble of the trial element.
    #[inline(always)]
    fn add_bubble(&self, a: usize, trial: usize, columns: &mut Columns<'_>, scratch: &mut Scratch) {
        let (row0, extra) = (2 * self.space.offset[a], self.extra_row(a));
        let (pa, pc) = (self.degree[a], self.degree[trial]);
        let first = 2 * (trial - columns.elements.start);
        let [kx, ky] = &mut columns.k_extra[first..][..2] else { return };
        self.double_layer(a, trial, pc + 1, scratch, |m, entries| {
            let row = if m < pa { row0 + 2 * m } else { extra };
            kx[row] += entries[0];
            kx[row + 1] += entries[1];
            ky[row] += entries[2];
            ky[row + 1] += entries[3];
        });
        let [wx, wy] = &mut columns.w_extra[first..][..2] else { return };
        let last = 2 * self.space.node(a, pa);
        for i in 0..=pa + 1 {
            let row = match i {
                _ if i < pa => row0 + 2 * i,
                _ if i == pa => last,
                _ => extra,
            };
            add_entries(wx, wy, row, [self.hypersingular(a, i, scratch)]);
        }
    }

    /// Entries [xx, yx, xy, yy] of K for each test degree m and function j of the trial element; keeps G̃ times its
    /// derivative for [`Self::hypersingular`].
    #[inline(always)]
    fn double_layer(
        &self,
        a: usize,
        trial: usize,
        j: usize,
        scratch: &mut Scratch,
        mut add: impl FnMut(usize, [f64; 4]),
    ) {
        let Scratch { tables: t, g_xx, g_yy, g_xy } = scratch;
        let (constants, half) = (&self.constants, self.segments[a].half().norm());
        let (ma, nc) = (t.test, t.trial);
        let local = &self.locals[self.local_of[trial]];
        for g in [&mut *g_xx, &mut *g_yy, &mut *g_xy] {
            g.resize(ma, 0.0);
        }
        let derivative = &local.derivatives[j * nc..][..nc];
        let value = &local.values[j * (nc + 1)..][..nc + 1];
        for m in 0..ma {
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

    /// Row of an element's extra unknown in the columns of the enrichment.
    fn extra_row(&self, a: usize) -> usize {
        self.space.dofs() + 2 * a
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

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The columns of a matrix as slices.
fn column_slices(a: &mut Mat<f64>) -> impl Iterator<Item = &mut [f64]> {
    a.col_iter_mut().filter_map(|column| column.try_as_col_major_mut()).map(|column| column.as_slice_mut())
}
