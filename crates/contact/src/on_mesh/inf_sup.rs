//! The discrete inf-sup constant of a pair of displacement and multiplier spaces.
//!
//! ```text
//! β = inf_μ sup_v b(μ, v) / (‖v‖ ‖μ‖),    ‖v‖² = <S v, v>,    ‖μ‖ = sup_w b(μ, w) / ‖w‖ over all w
//! ```
//! With b(μ, v) = μᵀB v, sup_v b(μ, v)²/‖v‖² = μᵀ B S⁻¹ Bᵀ μ: β² is the least eigenvalue of that form of the discrete space
//! against the same form of a much finer one. β ≤ 1; where it tends to 0 with h or 1/p, pressures oscillate.

use faer::Mat;
use steklov_algebra::{add_product, llt, solve_lower, symmetric_eigen};
use steklov_bem_operators::Dof;

use crate::ContactError;
use crate::on_mesh::stabilised::{add_springs, free_unknowns};

/// The inf-sup constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InfSup {
    /// β.
    pub beta: f64,
}

/// B S⁻¹ Bᵀ over the displacements that are not held, of the two components of [`pairing`](crate::pairing): unknown 2·node along n,
/// 2·node+1 along t. `rigid`: the rigid motions that the supports leave; each counts with a spring of the size of S.
///
/// # Errors
/// [`ContactError::Decomposition`] when S is not positive on these displacements.
pub fn dual_form(
    pairing: &[Mat<f64>; 2],
    stiffness: &Mat<f64>,
    held: &[(Dof, f64)],
    rigid: &[Vec<f64>],
) -> Result<Mat<f64>, ContactError> {
    let free = free_unknowns(stiffness.nrows(), held);
    let n = free.len();
    let mut s = Mat::from_fn(n, n, |i, j| stiffness[(free[i], free[j])]);
    add_springs(&mut s, &free, rigid);
    let factor = llt(&s).map_err(|none| none.or(|_| ContactError::Decomposition { size: n }))?;
    let mut x = Mat::from_fn(n, 2 * pairing[0].nrows(), |i, j| pairing[j % 2][(j / 2, free[i])]);
    let of_x = solve_lower(factor.lower(), x.as_mut(), None)?;
    let mut dual = Mat::zeros(x.ncols(), x.ncols());
    add_product(dual.as_mut(), x.transpose(), x.as_ref(), 1.0, Some(&of_x))?;
    Ok(dual)
}

/// β of a discrete form against that of a much finer displacement space, both from [`dual_form`] or a stabilised one.
///
/// # Errors
/// [`ContactError::Decomposition`] when the reference is not positive: the finer space is not fine enough.
///
/// Source: Chapelle and Bathe (1993), with the dual norm in place of that of L².
pub fn inf_sup(discrete: &Mat<f64>, reference: &Mat<f64>) -> Result<InfSup, ContactError> {
    let failed = ContactError::Decomposition { size: reference.nrows() };
    let factor = llt(reference).map_err(|none| none.or(|_| failed.clone()))?;
    let mut x = discrete.clone();
    solve_lower(factor.lower(), x.as_mut(), None)?;
    let mut x = x.transpose().to_owned();
    solve_lower(factor.lower(), x.as_mut(), None)?;
    let eigen = symmetric_eigen(x.as_ref()).map_err(|_| failed)?;
    Ok(InfSup { beta: eigen.values[0].max(0.0).sqrt() })
}
