//! Sparse Cholesky factors, with the structure apart from the numbers.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{ColMut, Conj, Mat, MatMut, MatRef, Par, Side};

use crate::Fault;
use crate::probe::{Sparse, scaled_probe};
use crate::spoil::spoil;

/// Why a sparse matrix has no Cholesky factor.
#[derive(Debug, Clone, PartialEq)]
pub enum NoSparseFactor {
    /// The factor does not fit into memory.
    Memory,
    /// The pivot of this unknown is not positive: the matrix is not positive definite.
    Pivot(usize),
    /// The factor is wrong.
    Fault(Fault),
}

/// The places of the entries in the lower triangle of a symmetric sparse matrix, column by column; rows rise in each column.
#[derive(Debug, Clone, PartialEq)]
pub struct Pattern {
    /// Where each column starts, and the end.
    pub start: Vec<usize>,
    /// The row of each entry.
    pub rows: Vec<usize>,
}

impl Pattern {
    /// Number of rows and columns.
    pub fn size(&self) -> usize {
        self.start.len() - 1
    }

    /// The place of an entry of the matrix among the entries.
    pub fn place(&self, i: usize, j: usize) -> Option<usize> {
        let first = self.start[j];
        self.rows[first..self.start[j + 1]].binary_search(&i).ok().map(|k| first + k)
    }

    fn view(&self) -> SymbolicSparseColMatRef<'_, usize> {
        SymbolicSparseColMatRef::new_checked(self.size(), self.size(), &self.start, None, &self.rows)
    }
}

/// The structure of the factor L of P A Pᵀ: the same for all matrices of one pattern.
#[derive(Debug, Clone)]
pub struct Structure {
    /// The pattern of A.
    pub pattern: Arc<Pattern>,
    symbolic: Arc<SymbolicCholesky<usize>>,
}

/// L of P A Pᵀ = L Lᵀ for a sparse matrix A.
#[derive(Debug, Clone)]
pub struct SparseCholesky {
    symbolic: Arc<SymbolicCholesky<usize>>,
    values: Vec<f64>,
}

/// Below the operations of any factor, those of a diagonal matrix included, for which they are 0.
const SUPERNODAL: SupernodalThreshold = SupernodalThreshold(-1.0);
/// From this number of entries of a factor on, the available memory is checked.
const LARGE: usize = 1 << 26;

/// Available memory in bytes; None if the system does not report it.
fn available() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("MemAvailable:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kib| 1024 * kib)
}

impl Structure {
    /// The structure for a pattern whose unknowns are eliminated in this order.
    ///
    /// # Errors
    /// [`NoSparseFactor::Memory`] if the structure of the factor does not fit into memory.
    ///
    /// # Panics
    /// If the order is none of all unknowns.
    pub fn new(pattern: Pattern, order: &[usize]) -> Result<Self, NoSparseFactor> {
        let size = pattern.size();
        let mut inverse = vec![0; size];
        order.iter().enumerate().for_each(|(k, &unknown)| inverse[unknown] = k);
        Self::ordered(pattern, SymmetricOrdering::Custom(PermRef::new_checked(order, &inverse, size)))
    }

    /// The structure for a pattern whose unknowns are eliminated in an order of approximately minimum degree.
    ///
    /// # Errors
    /// As [`Self::new`].
    ///
    /// Source: Amestoy, Davis and Duff (1996).
    pub fn by_minimum_degree(pattern: Pattern) -> Result<Self, NoSparseFactor> {
        Self::ordered(pattern, SymmetricOrdering::Amd)
    }

    #[inline(never)]
    fn ordered(pattern: Pattern, ordering: SymmetricOrdering<'_, usize>) -> Result<Self, NoSparseFactor> {
        let params = CholeskySymbolicParams { supernodal_flop_ratio_threshold: SUPERNODAL, ..Default::default() };
        let symbolic = factorize_symbolic_cholesky(pattern.view(), Side::Lower, ordering, params)
            .map_err(|_| NoSparseFactor::Memory)?;
        Ok(Self { pattern: Arc::new(pattern), symbolic: Arc::new(symbolic) })
    }

    /// The order in which the unknowns are eliminated.
    pub fn order(&self) -> Vec<usize> {
        self.symbolic.perm().map_or_else(|| (0..self.pattern.size()).collect(), |p| p.arrays().0.to_vec())
    }

    /// Number of entries of the factor, zeros in its supernodes included.
    pub fn factor_entries(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Factorises the matrix with these entries, and checks that the factor solves a system of it.
    ///
    /// # Errors
    /// As [`Self::factorise`], and [`NoSparseFactor::Fault`] if the factor does not solve a system to rounding.
    #[inline(never)]
    pub fn factorise_checked(&self, entries: &[f64], par: Par) -> Result<SparseCholesky, NoSparseFactor> {
        let Pattern { start, rows } = &*self.pattern;
        let mut factor = self.factorise(entries, par)?;
        spoil(ColMut::from_slice_mut(&mut factor.values).as_mat_mut(), false);
        let matrix = Sparse { start, rows, entries };
        let wanted = matrix.times(&scaled_probe(start[..self.pattern.size()].iter().map(|&first| entries[first])));
        let mut solution = wanted.clone();
        factor.solve(ColMut::from_slice_mut(&mut solution).as_mat_mut(), par);
        matrix.check(&solution, &wanted).map_err(NoSparseFactor::Fault)?;
        Ok(factor)
    }

    /// Factorises the matrix with these entries.
    ///
    /// # Errors
    /// [`NoSparseFactor::Memory`] for a factor that does not fit into memory, [`NoSparseFactor::Pivot`] for a matrix that is not
    /// positive definite.
    #[inline(never)]
    pub fn factorise(&self, entries: &[f64], par: Par) -> Result<SparseCholesky, NoSparseFactor> {
        let size = self.pattern.size();
        let count = self.factor_entries();
        if count > LARGE && available().is_some_and(|bytes| 8 * count as u64 > bytes) {
            return Err(NoSparseFactor::Memory);
        }
        let mut values = Vec::new();
        values.try_reserve_exact(count).map_err(|_| NoSparseFactor::Memory)?;
        values.resize(count, 0.0);
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<f64>(par, Default::default());
        let mut memory_of = MemBuffer::try_new(scratch).map_err(|_| NoSparseFactor::Memory)?;
        let matrix = SparseColMatRef::new(self.pattern.view(), entries);
        let stack = MemStack::new(&mut memory_of);
        let regularization = LltRegularization::default();
        let done = self.symbolic.factorize_numeric_llt(
            &mut values,
            matrix,
            Side::Lower,
            regularization,
            par,
            stack,
            Default::default(),
        );
        match done {
            Ok(_) => Ok(SparseCholesky { symbolic: Arc::clone(&self.symbolic), values }),
            Err(faer::linalg::cholesky::llt::factor::LltError::NonPositivePivot { index }) => {
                let unknown = self.symbolic.perm().map_or(index, |p| p.arrays().0[index.min(size - 1)]);
                Err(NoSparseFactor::Pivot(unknown))
            }
        }
    }
}

impl SparseCholesky {
    /// A⁻¹ B in place of B.
    #[inline(never)]
    pub fn solve(&self, rhs: MatMut<'_, f64>, par: Par) {
        let scratch = self.symbolic.solve_in_place_scratch::<f64>(rhs.ncols(), par);
        let mut memory = MemBuffer::new(scratch);
        LltRef::new(&*self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            rhs,
            par,
            MemStack::new(&mut memory),
        );
    }

    /// The diagonal of L, in the order of the unknowns.
    pub fn diagonal(&self) -> Vec<f64> {
        let (order, mut diagonal) = (self.symbolic.perm().map(|p| p.arrays().0), vec![0.0; self.symbolic.nrows()]);
        self.each_supernode(|start, values, _| {
            for j in 0..values.ncols() {
                diagonal[order.map_or(start + j, |order| order[start + j])] = values[(j, j)];
            }
        });
        diagonal
    }

    /// The last `count` rows and columns of L, full storage: L₂₂ L₂₂ᵀ is the Schur complement of A after elimination of all
    /// other unknowns.
    pub fn last_block(&self, count: usize) -> Mat<f64> {
        let first = self.symbolic.nrows() - count;
        let mut block = Mat::zeros(count, count);
        self.each_supernode(|start, values, below| {
            let columns = values.ncols();
            for j in first.max(start)..start + columns {
                for i in j..start + columns {
                    block[(i - first, j - first)] = values[(i - start, j - start)];
                }
                for (k, &row) in below.iter().enumerate() {
                    block[(row - first, j - first)] = values[(columns + k, j - start)];
                }
            }
        });
        block
    }

    /// Calls `of` with the first column of each supernode, its entries, and the rows of those below its triangle.
    fn each_supernode(&self, mut of: impl FnMut(usize, MatRef<'_, f64>, &[usize])) {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            unreachable!("all factors are supernodal")
        };
        let factor = faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef::new(symbolic, &self.values);
        for s in 0..symbolic.n_supernodes() {
            let node = factor.supernode(s);
            of(node.start(), node.val(), node.pattern());
        }
    }
}
