//! Cholesky factors in the storage of their matrix.

use faer::Mat;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::prelude::*;

use crate::Fault;
use crate::decompositions::Cholesky;
use crate::dense::{lower_product, lower_solve, parts};
use crate::operand::symmetric_upper;
use crate::probe::{check_cholesky, same_as_factor, scaled_probe};
use crate::spoil::spoil;

/// Why a matrix has no Cholesky factor.
#[derive(Debug, Clone, PartialEq)]
pub enum NoFactor {
    /// A pivot is not positive: the matrix is not positive definite.
    Pivot(usize),
    /// The factor is wrong.
    Fault(Fault),
}

impl NoFactor {
    /// The error of a matrix that is not positive definite, by its pivot, or of a fault.
    pub fn or<E: From<Fault>>(self, indefinite: impl FnOnce(usize) -> E) -> E {
        match self {
            Self::Pivot(pivot) => indefinite(pivot),
            Self::Fault(fault) => fault.into(),
        }
    }
}

/// Columns that are factorised at a time.
const PANEL: usize = 256;

/// Cholesky factor of a symmetric matrix (full storage) in its lower triangle; the strict upper triangle keeps its values.
///
/// Panel by panel: the diagonal block is factorised in a copy, because the library's own factorisation may use the
/// storage above the diagonal.
///
/// # Errors
/// The failing pivot, or a fault.
pub fn cholesky(mut a: MatMut<'_, f64>) -> Result<(), NoFactor> {
    let n = a.nrows();
    let diagonal: Vec<f64> = (0..n).map(|i| a[(i, i)]).collect();
    factorise(a.rb_mut()).map_err(NoFactor::Pivot)?;
    spoil(a.rb_mut(), true);
    let probe = scaled_probe(diagonal.iter().copied());
    same_as_factor(&probe, symmetric_upper(a.rb(), &diagonal), a.rb()).map_err(NoFactor::Fault)
}

/// Cholesky factor of the lower triangle of a matrix that stays as it is.
///
/// # Errors
/// The failing pivot, or a fault.
pub fn llt(a: &Mat<f64>) -> Result<Cholesky, NoFactor> {
    let factor = Cholesky::new(a.as_ref()).map_err(NoFactor::Pivot)?;
    check_cholesky(a.as_ref(), factor.lower()).map_err(NoFactor::Fault)?;
    Ok(factor)
}

fn factorise(mut a: MatMut<'_, f64>) -> Result<(), usize> {
    let (n, par) = (a.nrows(), parts(a.nrows()));
    for start in (0..n).step_by(PANEL) {
        let size = PANEL.min(n - start);
        let (mut block, _, mut below, mut rest) = a.rb_mut().get_mut(start.., start..).split_at_mut(size, size);
        let mut factor = block.to_owned();
        let mut memory = MemBuffer::new(cholesky_in_place_scratch::<f64>(size, par, Default::default()));
        let stack = MemStack::new(&mut memory);
        match cholesky_in_place(factor.as_mut(), LltRegularization::default(), par, stack, Default::default()) {
            Ok(_) => {}
            Err(LltError::NonPositivePivot { index }) => return Err(start + index),
        }
        for j in 0..size {
            for i in j..size {
                block[(i, j)] = factor[(i, j)];
            }
        }
        lower_solve(factor.as_ref(), below.rb_mut().transpose_mut());
        lower_product(rest.rb_mut(), below.rb(), below.rb().transpose(), -1.0);
    }
    Ok(())
}
