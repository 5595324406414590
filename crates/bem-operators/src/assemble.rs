//! One pass over the unordered pairs of elements gives V, K and W.
//!
//! The pass works on blocks of rows of pairs so that the moments of a block fit a small buffer. In a block, first all
//! moments are computed, in parallel over pairs; then every element adds what it contributes to its own columns of V,
//! K and W, in parallel over columns and in a fixed order within each: the matrices have the same bits for any number
//! of threads.

use faer::Mat;
use rayon::prelude::*;
use sprs::{CsMat, TriMat};

use crate::far::{Batch, Classifier, KINDS, LANES, flush, kind_index};
use crate::moments::{Geometry, Segment, Tables, first_is_outer, same, storage};
use crate::near;
use crate::{BemError, Material, Mesh, Space};

/// Galerkin matrices of the single layer V, the double layer K and the hypersingular operator W, and the mass matrix M.
///
/// ```text
/// V: traction × traction          <Vφ,ψ>      (length³ per stress, times 1/length²: its entries carry |d_a||d_b|/μ)
/// K: traction × displacement      <Ku,ψ>      principal value
/// W: displacement × displacement  <Wu,v>      (stress)
/// M: traction × displacement      <u,ψ>       sparse
/// ```
/// Traction unknowns are Legendre coefficients by element, component fastest; displacement unknowns are nodal, component
/// fastest (see [`Space`]).
#[derive(Debug, Clone)]
pub struct Operators {
    /// Single layer matrix, symmetric.
    pub v: Mat<f64>,
    /// Double layer matrix.
    pub k: Mat<f64>,
    /// Hypersingular matrix, symmetric.
    pub w: Mat<f64>,
    /// Mass matrix.
    pub mass: CsMat<f64>,
    /// Length L in log(L/r).
    pub length: f64,
    /// Diameter of the boundary.
    pub diameter: f64,
}

/// Doubles that the moments of one block of pairs may take: 32 MiB.
const BLOCK_STORAGE: usize = 1 << 22;
/// Pairs that one task computes, so that batches fill up.
const TASK_PAIRS: usize = 1024;

impl Operators {
    /// Assembles V, K, W and M; `length` is L in log(L/r), by default the diameter of the boundary, which keeps V positive
    /// definite at any size of the body.
    ///
    /// Cost: N²/(8p²) pairs of 0.1 to 1 µs for N unknowns of degree p; memory 3 N² doubles and a small buffer.
    /// # Errors
    /// [`BemError::Mesh`] when elements are not closed loops or have no length.
    /// # Source
    /// Hsiao, Wendland, *Boundary Integral Equations*, 2008, chapter 2 (kernels); integration by parts after Maue 1949 and Günter.
    pub fn assemble(mesh: &Mesh, space: &Space, material: &Material, length: Option<f64>) -> Result<Self, BemError> {
        mesh.check()?;
        let diameter = mesh.diameter();
        let length = length.unwrap_or(diameter);
        let n = space.dofs();
        let (mut v, mut k, mut w) = (Mat::zeros(n, n), Mat::zeros(n, n), Mat::zeros(n, n));
        let pass = Pass::new(mesh, space, material, length);
        let mut owners = pass.columns(&mut v, &mut k, &mut w);
        let mut buffer = Vec::new();
        let arch = pulp::Arch::new();
        for rows in pass.blocks() {
            pass.moments(rows.clone(), &mut buffer);
            let block = Block { base: pass.pair_base(rows.clone()), rows, moments: &buffer };
            owners.par_iter_mut().for_each_init(Scratch::default, |scratch, columns| {
                arch.dispatch(|| pass.add(columns, &block, scratch));
            });
        }
        drop(owners);
        Ok(Self { v, k, w, mass: mass(mesh, space), length, diameter })
    }
}

/// <u,ψ> = Σ_a |d_a| 2/(2m+1) ψ_a[m]·û_a[m].
fn mass(mesh: &Mesh, space: &Space) -> CsMat<f64> {
    let n = space.dofs();
    let mut triplets = TriMat::new((n, n));
    for e in 0..mesh.len() {
        let to_legendre = &space.basis(e).to_legendre;
        for m in 0..space.degree(e) {
            let scale = mesh.length(e) / (2 * m + 1) as f64;
            for (j, node) in space.element_nodes(e).enumerate() {
                for i in 0..2 {
                    triplets.add_triplet(2 * (space.offset[e] + m) + i, 2 * node + i, scale * to_legendre[(m, j)]);
                }
            }
        }
    }
    triplets.to_csr()
}

/// Constants of the kernels, with μ, κ and ν of plane strain.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Constants {
    /// c_V = 1/(8πμ(1-ν)).
    pub(crate) c_v: f64,
    pub(crate) kappa: f64,
    /// c_W = μ/(2π(1-ν)).
    pub(crate) c_w: f64,
    /// H = `h_log` LOG I + `h_rr` rr = 2μ c_V (-κ LOG I + rr) + LOG I/(2π).
    pub(crate) h_log: f64,
    pub(crate) h_rr: f64,
}

impl Constants {
    pub(crate) fn new(material: &Material) -> Self {
        let (mu, nu, kappa) = (material.mu(), material.nu(), material.kappa());
        let pi = std::f64::consts::PI;
        let c_v = 1.0 / (8.0 * pi * mu * (1.0 - nu));
        let h_rr = 1.0 / (4.0 * pi * (1.0 - nu));
        Self { c_v, kappa, c_w: mu / (2.0 * pi * (1.0 - nu)), h_log: 0.5 / pi - h_rr * kappa, h_rr }
    }
}

/// The columns of V, K and W that belong to a group of consecutive elements: their traction coefficients, and their
/// nodes but the last one of each.
struct Columns<'a> {
    elements: std::ops::Range<usize>,
    v: Vec<&'a mut [f64]>,
    k: Vec<&'a mut [f64]>,
    w: Vec<&'a mut [f64]>,
}

/// The moments of the pairs (a, b), a in `rows`, b ≥ a; those of row a start at `base[a - rows.start]`.
struct Block<'a> {
    rows: std::ops::Range<usize>,
    base: Vec<usize>,
    moments: &'a [f64],
}

#[derive(Default)]
struct Scratch {
    tables: Tables,
    /// G̃ times the trial derivative for each test degree.
    g_xx: Vec<f64>,
    g_yy: Vec<f64>,
    g_xy: Vec<f64>,
}

/// The small matrices of a degree, node by node.
struct Local {
    /// Legendre coefficients n = 0..=p of each nodal function.
    values: Vec<f64>,
    /// Legendre coefficients n = 0..p of its derivative with respect to t.
    derivatives: Vec<f64>,
}

impl Local {
    fn new(space: &Space, e: usize) -> Self {
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

struct Pass<'a> {
    space: &'a Space,
    segments: Vec<Segment>,
    degree: Vec<usize>,
    previous: Vec<usize>,
    /// log(|d|/L) of each element.
    log_half: Vec<f64>,
    /// Σ (p+1) over the elements before e.
    prefix: Vec<usize>,
    /// Position of each degree in `locals`, and the classifiers by it.
    local_of: Vec<usize>,
    locals: Vec<Local>,
    classifiers: Vec<Classifier>,
    constants: Constants,
}

impl<'a> Pass<'a> {
    fn new(mesh: &Mesh, space: &'a Space, material: &Material, length: f64) -> Self {
        let segments: Vec<Segment> = (0..mesh.len()).map(|e| mesh.segment(e)).collect();
        let log_half = segments.iter().map(|s| (s.half().norm() / length).ln()).collect();
        let degree = mesh.degree.clone();
        let mut prefix = vec![0];
        let mut degrees = degree.clone();
        degrees.sort_unstable();
        degrees.dedup();
        for &p in &degree {
            prefix.push(prefix[prefix.len() - 1] + p + 1);
        }
        let local_of = degree.iter().map(|p| degrees.binary_search(p).unwrap_or(0)).collect();
        let first_with = |p: usize| degree.iter().position(|&q| q == p).unwrap_or(0);
        let locals = degrees.iter().map(|&p| Local::new(space, first_with(p))).collect();
        let classifiers = degrees.iter().map(|&p| Classifier::new(p + 1)).collect();
        let previous = mesh.previous();
        let constants = Constants::new(material);
        Self { space, segments, degree, previous, log_half, prefix, local_of, locals, classifiers, constants }
    }

    fn len(&self) -> usize {
        self.segments.len()
    }

    /// Splits the matrices into the columns of groups of elements.
    fn columns<'m>(&self, v: &'m mut Mat<f64>, k: &'m mut Mat<f64>, w: &'m mut Mat<f64>) -> Vec<Columns<'m>> {
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

    /// Where the moments of the pair (a, b), b ≥ a, start behind those of (a, a).
    fn pair_offset(&self, a: usize, b: usize) -> usize {
        let rows = self.degree[a] + 1;
        (2 * rows + 1) * (self.prefix[b] - self.prefix[a]) + rows * (b - a)
    }

    /// Consecutive ranges of first elements whose pairs fit the buffer.
    fn blocks(&self) -> Vec<std::ops::Range<usize>> {
        let n = self.len();
        let mut blocks = Vec::new();
        let (mut start, mut used) = (0, 0);
        for a in 0..n {
            let size = self.pair_offset(a, n);
            if used > 0 && used + size > BLOCK_STORAGE {
                blocks.push(start..a);
                (start, used) = (a, 0);
            }
            used += size;
        }
        blocks.push(start..n);
        blocks
    }

    /// Moments of all pairs (a, b), a in `rows`, b ≥ a.
    fn moments(&self, rows: std::ops::Range<usize>, buffer: &mut Vec<f64>) {
        let n = self.len();
        buffer.resize(rows.clone().map(|a| self.pair_offset(a, n)).sum(), 0.0);
        let mut tasks: Vec<Vec<(usize, &mut [f64])>> = vec![Vec::new()];
        let (mut rest, mut pairs) = (&mut buffer[..], 0);
        for a in rows {
            let (row, tail) = rest.split_at_mut(self.pair_offset(a, n));
            rest = tail;
            if pairs >= TASK_PAIRS {
                tasks.push(Vec::new());
                pairs = 0;
            }
            pairs += n - a;
            let last = tasks.len() - 1;
            tasks[last].push((a, row));
        }
        tasks.into_par_iter().for_each(|task| self.moments_of_rows(task));
    }

    fn moments_of_rows(&self, mut rows: Vec<(usize, &mut [f64])>) {
        let arch = pulp::Arch::new();
        let kinds = self.locals.len();
        let mut open = vec![u32::MAX; kinds * kinds * KINDS];
        let mut batches: Vec<(Batch, [(usize, usize); LANES])> = Vec::new();
        let mut sums = Vec::new();
        for r in 0..rows.len() {
            let a = rows[r].0;
            let pa = self.degree[a];
            same(pa + 1, pa + 1, &mut rows[r].1[..storage(pa, pa)]);
            for b in a + 1..self.len() {
                let start = self.pair_offset(a, b);
                let (outer, inner) = if first_is_outer(self.segments[a], self.segments[b]) { (a, b) } else { (b, a) };
                let (so, si) = (self.segments[outer], self.segments[inner]);
                let touching = self.previous[a] == b || self.previous[b] == a;
                let kind = if touching { None } else { self.classifiers[self.local_of[outer]].kind(so, si) };
                let (m, n) = (self.degree[outer] + 1, self.degree[inner] + 1);
                let Some(kind) = kind else {
                    near::moments(so, si, m, n, &mut rows[r].1[start..start + storage(m - 1, n - 1)]);
                    continue;
                };
                let key = (self.local_of[outer] * kinds + self.local_of[inner]) * KINDS + kind_index(kind);
                if open[key] == u32::MAX {
                    open[key] = batches.len() as u32;
                    batches.push((Batch::new(kind, m, n), [(0, 0); LANES]));
                }
                let (batch, places) = &mut batches[open[key] as usize];
                places[batch.len()] = (r, start);
                if batch.push(so, si) {
                    flush(arch, batch, places, &mut sums, |(r, start): (usize, usize), batch, lane, sums| {
                        batch.extract(sums, lane, &mut rows[r].1[start..]);
                    });
                }
            }
        }
        for (batch, places) in &mut batches {
            flush(arch, batch, places, &mut sums, |(r, start): (usize, usize), batch, lane, sums| {
                batch.extract(sums, lane, &mut rows[r].1[start..]);
            });
        }
    }

    /// Adds to the columns of a group what the pairs of a block contribute: its elements as trial elements, and of the
    /// elements before them the end node, which is a first node of the group.
    #[inline(always)]
    fn add(&self, columns: &mut Columns<'_>, block: &Block<'_>, scratch: &mut Scratch) {
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

    /// Start of each row's moments in a block's buffer.
    fn pair_base(&self, rows: std::ops::Range<usize>) -> Vec<usize> {
        let mut base = Vec::with_capacity(rows.len());
        let mut start = 0;
        for a in rows {
            base.push(start);
            start += self.pair_offset(a, self.len());
        }
        base
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
