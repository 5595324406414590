//! A sparse stiffness matrix reduced to some of its unknowns.

use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::{Accum, Mat, MatMut, Par};
use sprs::CsMat;
use steklov_algebra::{NoSparseFactor, PARTS, Pattern, SparseCholesky, Structure, check_cholesky, spoil, threads};

use crate::MsfemError;

/// Size from which factorisations use all threads.
const LARGE: usize = 400_000;

/// K with the unknowns R eliminated and the kept unknowns left: S_c = K_cc - K_cR K_RR⁻¹ K_Rc.
///
/// The kept unknowns come last in the order of elimination, with their diagonal entries doubled, which keeps the matrix
/// positive definite where only they hold the body: K' = K + D. With L₂₂ the last block of its factor,
/// S_c = L₂₂ L₂₂ᵀ - D; and with w = K'⁻¹ f, S' = L₂₂ L₂₂ᵀ, the reduced load is S' w_c, and
/// u = K'⁻¹ (f + S' (v - w_c)) is the field whose kept unknowns are v.
///
/// Cost: for n unknowns on a grid about 30 n log₂ n entries of the factor and 10 n^(3/2) operations, c³/3 more for c kept
/// ones. The factor's digits: about 16 less the logarithm of the contrast of moduli times the square of the cells across.
#[derive(Debug)]
pub struct Elimination {
    stiffness: CsMat<f64>,
    /// None where nothing is free.
    factor: Option<SparseCholesky>,
    /// Unknowns in the rows of the factor.
    free: Vec<usize>,
    /// Rows of the kept unknowns.
    kept: Vec<usize>,
    /// Prescribed unknowns.
    held: Vec<usize>,
    /// L₂₂.
    last: Mat<f64>,
    /// D.
    shift: Vec<f64>,
    par: Par,
}

/// A load and held displacements, reduced to the kept unknowns.
#[derive(Debug, Clone)]
pub struct ReducedLoad {
    /// The reduced load, in the order of the kept unknowns.
    pub kept: Vec<f64>,
    /// f - K u_held in the rows of the factor.
    rows: Vec<f64>,
    /// w_c.
    response: Vec<f64>,
    held: Vec<f64>,
}

impl Elimination {
    /// Eliminates all unknowns of K (CSR, both triangles) that are neither kept nor held. `order` has the nodes (unknowns
    /// 2·node, 2·node + 1) in an order that makes little fill.
    ///
    /// # Errors
    /// [`MsfemError::Singular`] when the eliminated unknowns can still move rigidly, [`MsfemError::Memory`].
    pub fn new(stiffness: CsMat<f64>, order: &[usize], kept: &[usize], held: &[usize]) -> Result<Self, MsfemError> {
        let size = stiffness.rows();
        let mut taken = vec![false; size];
        held.iter().for_each(|&u| taken[u] = true);
        let mut row = vec![usize::MAX; size];
        let free: Vec<usize> = (0..size).filter(|&u| !taken[u]).collect();
        free.iter().enumerate().for_each(|(k, &u)| row[u] = k);
        kept.iter().for_each(|&u| taken[u] = true);
        let eliminated = order.iter().flat_map(|n| [2 * n, 2 * n + 1]).filter(|&u| !taken[u]).map(|u| row[u]);
        let rows: Vec<usize> = eliminated.chain(kept.iter().map(|&u| row[u])).collect();
        let (mut pattern, mut entries) = (Pattern { start: vec![0], rows: Vec::new() }, Vec::new());
        let half = stiffness.nnz() / 2 + size;
        pattern.rows.reserve(half);
        entries.reserve(half);
        for &u in &free {
            let line = stiffness.outer_view(u).unwrap_or_else(|| unreachable!("the matrix is square"));
            for (other, &k) in line.iter() {
                if other >= u && row[other] != usize::MAX {
                    pattern.rows.push(row[other]);
                    entries.push(k);
                }
            }
            pattern.start.push(entries.len());
        }
        let kept: Vec<usize> = kept.iter().map(|&u| row[u]).collect();
        // the diagonal is the first entry of each column
        let shift: Vec<f64> = kept.iter().map(|&k| entries[pattern.start[k]]).collect();
        kept.iter().zip(&shift).for_each(|(&k, d)| entries[pattern.start[k]] += d);
        let par = if free.len() < LARGE { Par::Seq } else { threads(faer::get_global_parallelism()) };
        let factor = match free.is_empty() {
            true => None,
            false => {
                let size = free.len();
                let structure = Structure::new(pattern, &rows).map_err(|none| MsfemError::of_factor(none, size))?;
                Some(structure.factorise_checked(&entries, par).map_err(|none| match none {
                    NoSparseFactor::Pivot(k) => MsfemError::Singular { unknown: free[k], size },
                    none => MsfemError::of_factor(none, size),
                })?)
            }
        };
        let last = factor.as_ref().map_or(Mat::new(), |factor| factor.last_block(kept.len()));
        Ok(Self { stiffness, factor, free, kept, held: held.to_vec(), last, shift, par })
    }

    /// S_c, full storage, in the order of the kept unknowns.
    ///
    /// # Errors
    /// [`MsfemError::Fault`].
    pub fn stiffness(&self) -> Result<Mat<f64>, MsfemError> {
        let n = self.last.nrows();
        let mut reduced = Mat::zeros(n, n);
        // cut into the same parts whatever the number of threads, for the same bits
        matmul(
            reduced.as_mut(),
            BlockStructure::TriangularLower,
            Accum::Replace,
            self.last.as_ref(),
            BlockStructure::TriangularLower,
            self.last.transpose(),
            BlockStructure::TriangularUpper,
            1.0,
            threads(Par::rayon(PARTS)),
        );
        spoil(reduced.as_mut(), true);
        check_cholesky(reduced.as_ref(), self.last.as_ref())?;
        for (k, d) in self.shift.iter().enumerate() {
            reduced[(k, k)] -= d;
        }
        for j in 0..reduced.ncols() {
            for i in 0..j {
                reduced[(i, j)] = reduced[(j, i)];
            }
        }
        Ok(reduced)
    }

    /// K u.
    pub fn multiply(&self, u: &[f64]) -> Vec<f64> {
        let line = |row: sprs::CsVecView<'_, f64>| row.iter().map(|(j, k)| k * u[j]).sum();
        self.stiffness.outer_iterator().map(line).collect()
    }

    /// Largest diagonal entry of K.
    pub fn largest_diagonal(&self) -> f64 {
        self.stiffness.diag().iter().fold(0.0, |m: f64, (_, k)| m.max(*k))
    }

    /// Reduces a load of all unknowns and values of the held ones, in their order.
    pub fn reduce(&self, load: &[f64], held: &[f64]) -> ReducedLoad {
        let mut prescribed = vec![0.0; load.len()];
        self.held.iter().zip(held).for_each(|(&u, value)| prescribed[u] = *value);
        let known = if held.iter().all(|v| *v == 0.0) { vec![0.0; load.len()] } else { self.multiply(&prescribed) };
        let rows: Vec<f64> = self.free.iter().map(|&u| load[u] - known[u]).collect();
        let response = if rows.iter().all(|f| *f == 0.0) {
            vec![0.0; self.kept.len()]
        } else if self.kept.is_empty() {
            Vec::new()
        } else {
            let w = self.solve(rows.clone());
            self.kept.iter().map(|&k| w[k]).collect()
        };
        ReducedLoad { kept: self.shifted(&response), rows, response, held: held.to_vec() }
    }

    /// The field of all unknowns whose kept ones are v.
    pub fn expand(&self, reduced: &ReducedLoad, v: &[f64]) -> Vec<f64> {
        let mut rows = reduced.rows.clone();
        let change: Vec<f64> = v.iter().zip(&reduced.response).map(|(v, w)| v - w).collect();
        self.kept.iter().zip(self.shifted(&change)).for_each(|(&k, f)| rows[k] += f);
        let u = self.solve(rows);
        let mut field = vec![0.0; self.stiffness.rows()];
        self.free.iter().zip(u).for_each(|(&unknown, u)| field[unknown] = u);
        self.held.iter().zip(&reduced.held).for_each(|(&unknown, u)| field[unknown] = *u);
        // they are known better than the solution of a large system
        self.kept.iter().zip(v).for_each(|(&k, v)| field[self.free[k]] = *v);
        field
    }

    /// The fields of several loads and values of the held unknowns, where none is kept: one pass over the factor for all of them.
    pub fn fields(&self, loads: &[Vec<f64>], held: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let reduced: Vec<ReducedLoad> = loads.iter().zip(held).map(|(load, held)| self.reduce(load, held)).collect();
        let n = self.free.len();
        let mut rows: Vec<f64> = reduced.iter().flat_map(|r| r.rows.iter().copied()).collect();
        if let Some(factor) = &self.factor {
            factor.solve(MatMut::from_column_major_slice_mut(&mut rows, n, loads.len()), self.par);
        }
        let field = |(k, reduced): (usize, &ReducedLoad)| {
            let mut field = vec![0.0; self.stiffness.rows()];
            self.free.iter().zip(&rows[k * n..]).for_each(|(&unknown, u)| field[unknown] = *u);
            self.held.iter().zip(&reduced.held).for_each(|(&unknown, u)| field[unknown] = *u);
            field
        };
        reduced.iter().enumerate().map(field).collect()
    }

    /// S' x = L₂₂ L₂₂ᵀ x.
    fn shifted(&self, x: &[f64]) -> Vec<f64> {
        let n = x.len();
        let column = |k: usize| &self.last.col_as_slice(k)[k..];
        let transposed: Vec<f64> = (0..n).map(|k| column(k).iter().zip(&x[k..]).map(|(l, x)| l * x).sum()).collect();
        let mut product = vec![0.0; n];
        for (k, t) in transposed.iter().enumerate() {
            product[k..].iter_mut().zip(column(k)).for_each(|(p, l)| *p += l * t);
        }
        product
    }

    fn solve(&self, mut rows: Vec<f64>) -> Vec<f64> {
        let n = rows.len();
        if let Some(factor) = &self.factor {
            factor.solve(MatMut::from_column_major_slice_mut(&mut rows, n, 1), self.par);
        }
        rows
    }
}
