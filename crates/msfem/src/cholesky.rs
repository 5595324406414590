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
use faer::{ColMut, Conj, Mat, MatMut, Par, Side};
use steklov_algebra::{Sparse, scaled_probe, spoil};

use crate::MsfemError;

/// Lower triangle of a symmetric sparse matrix, column by column; rows rise in each column.
#[derive(Debug, Clone)]
pub(crate) struct Lower {
    pub start: Vec<usize>,
    pub rows: Vec<usize>,
}

impl Lower {
    pub fn size(&self) -> usize {
        self.start.len() - 1
    }

    fn view(&self) -> SymbolicSparseColMatRef<'_, usize> {
        SymbolicSparseColMatRef::new_checked(self.size(), self.size(), &self.start, None, &self.rows)
    }
}

/// The structure of the factor L of P A Pᵀ: the same for all matrices of one pattern.
#[derive(Debug, Clone)]
pub(crate) struct Structure {
    pub pattern: Arc<Lower>,
    symbolic: Arc<SymbolicCholesky<usize>>,
}

/// L of P A Pᵀ = L Lᵀ.
#[derive(Debug, Clone)]
pub(crate) struct Cholesky {
    symbolic: Arc<SymbolicCholesky<usize>>,
    values: Vec<f64>,
}

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
    /// [`MsfemError::Memory`] if the structure of the factor does not fit into memory: take a coarser grid.
    pub fn new(pattern: Lower, order: &[usize]) -> Result<Self, MsfemError> {
        let size = pattern.size();
        let mut inverse = vec![0; size];
        order.iter().enumerate().for_each(|(k, &unknown)| inverse[unknown] = k);
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let ordering = SymmetricOrdering::Custom(PermRef::new_checked(order, &inverse, size));
        let symbolic = factorize_symbolic_cholesky(pattern.view(), Side::Lower, ordering, params)
            .map_err(|_| MsfemError::Memory { size })?;
        Ok(Self { pattern: Arc::new(pattern), symbolic: Arc::new(symbolic) })
    }

    /// Factorises the matrix with these entries, and checks that the factor solves a system of it.
    ///
    /// # Errors
    /// As [`Self::factorise`], and [`MsfemError::Fault`] if the factor does not solve a system to rounding.
    pub fn factorise_checked(&self, entries: &[f64], par: Par) -> Result<Cholesky, MsfemError> {
        let Lower { start, rows } = &*self.pattern;
        let mut factor = self.factorise(entries, par)?;
        spoil(ColMut::from_slice_mut(&mut factor.values).as_mat_mut(), false);
        let matrix = Sparse { start, rows, entries };
        let wanted = matrix.times(&scaled_probe(start[..self.pattern.size()].iter().map(|&first| entries[first])));
        let mut solution = wanted.clone();
        factor.solve(ColMut::from_slice_mut(&mut solution).as_mat_mut(), par);
        matrix.check(&solution, &wanted)?;
        Ok(factor)
    }

    /// Factorises the matrix with these entries.
    ///
    /// # Errors
    /// [`MsfemError::Memory`] for a factor that does not fit into memory: take a coarser grid. [`MsfemError::Singular`] for a
    /// matrix that is not positive definite: hold the body, or lower the contrast of the moduli.
    pub fn factorise(&self, entries: &[f64], par: Par) -> Result<Cholesky, MsfemError> {
        let size = self.pattern.size();
        let memory = |_| MsfemError::Memory { size };
        if self.symbolic.len_val() > LARGE
            && available().is_some_and(|bytes| 8 * self.symbolic.len_val() as u64 > bytes)
        {
            return Err(MsfemError::Memory { size });
        }
        let mut values = Vec::new();
        values.try_reserve_exact(self.symbolic.len_val()).map_err(|_| MsfemError::Memory { size })?;
        values.resize(self.symbolic.len_val(), 0.0);
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<f64>(par, Default::default());
        let mut memory_of = MemBuffer::try_new(scratch).map_err(memory)?;
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
            Ok(_) => Ok(Cholesky { symbolic: Arc::clone(&self.symbolic), values }),
            Err(faer::linalg::cholesky::llt::factor::LltError::NonPositivePivot { index }) => {
                let unknown = self.symbolic.perm().map_or(index, |p| p.arrays().0[index.min(size - 1)]);
                Err(MsfemError::Singular { unknown, size })
            }
        }
    }
}

impl Cholesky {
    /// A⁻¹ B in place of B.
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

    /// The last `count` rows and columns of L, full storage: L₂₂ L₂₂ᵀ is the Schur complement of A after elimination of all
    /// other unknowns.
    pub fn last_block(&self, count: usize) -> Mat<f64> {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            unreachable!("all factors are supernodal")
        };
        let factor = faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef::new(symbolic, &self.values);
        let first = self.symbolic.nrows() - count;
        let mut block = Mat::zeros(count, count);
        for s in 0..symbolic.n_supernodes() {
            let node = factor.supernode(s);
            let (start, values) = (node.start(), node.val());
            let columns = values.ncols();
            if start + columns <= first {
                continue;
            }
            for j in first.max(start)..start + columns {
                for i in j..start + columns {
                    block[(i - first, j - first)] = values[(i - start, j - start)];
                }
                for (k, &row) in node.pattern().iter().enumerate() {
                    block[(row - first, j - first)] = values[(columns + k, j - start)];
                }
            }
        }
        block
    }
}
