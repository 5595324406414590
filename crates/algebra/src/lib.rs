//! Dense algebra that is checked: products, triangular solves and Cholesky factors, in place and on many threads.
//!
//! Each result of the library's parallel kernels is applied to a seeded vector, and so are the inputs of that result. This
//! takes n² operations where the kernels take n³; the two vectors differ by rounding, or there is a [`Fault`].
//!
//! Source: Freivalds (1977) for products, with rounding in them.
//!
//! The product of a result with the vector, its [`Image`], is passed to the checks of later results computed from it, which
//! need not read it again. Sparse factors ([`Structure`]), solutions of dense systems (`steklov-contact`,
//! `steklov-coupling`) and spectra are checked by the same vector. Not checked, since none of it runs on several threads of
//! the library: local problems of multiscale bases, matrices of ten rows or fewer, Newton matrices of the interior point
//! method, whose residuals are taken from S itself, products column by column of stochastic nodes, eigenpairs of random fields
//! and of Gauss rules. Not checked either: solves with one right-hand side, whose residual is checked afterwards, and systems
//! that only studies set up, which are references themselves.
//!
//! LU factors, spectra, singular values and least squares ([`Lu`], [`symmetric_eigen`], [`svd`], [`least_squares`] and the
//! like) are here because the library is generic: what calls it compiles it again, half a minute for a decomposition, and
//! what calls this crate does not. They have the bits of the library and are not checked.
//!
//! ```
//! use steklov_algebra::faer::Mat;
//! use steklov_algebra::{check_cholesky, check_solution, cholesky};
//!
//! // A_ij = min(i, j) is L Lᵀ, L full of ones on and below its diagonal
//! let a = Mat::from_fn(40, 40, |i, j| 1.0 + i.min(j) as f64);
//! let mut l = a.clone();
//! cholesky(l.as_mut()).expect("positive definite");
//! assert!((0..40).all(|i| (0..=i).all(|j| (l[(i, j)] - 1.0).abs() < 1e-13)));
//!
//! // one entry that is wrong, and an answer that is none, are found in n² operations
//! check_cholesky(a.as_ref(), l.as_ref())?;
//! l[(30, 20)] += 1e-9;
//! assert!(check_cholesky(a.as_ref(), l.as_ref()).is_err());
//! assert!(check_solution(a.as_ref(), &[1.0; 40], &[0.0; 40]).is_err());
//! # Ok::<(), steklov_algebra::Fault>(())
//! ```

mod cholesky;
mod decompositions;
mod dense;
mod dot;
mod fault;
mod operand;
mod probe;
mod sparse;
mod spoil;
mod symmetric;

// the crates whose types appear in the interface
pub use faer;

pub use cholesky::{NoFactor, cholesky, llt};
pub use decompositions::{
    Cholesky, Lu, NoSpectrum, Svd, SymmetricEigen, eigenvalues, least_squares, singular_values, solve_full_lu, svd,
    symmetric_eigen, symmetric_eigen_on_one_thread, symmetric_eigenvalues,
};
pub use dense::{Image, PARTS, add_product, add_to_lower, parts, solve_lower, solve_lower_transposed};
pub use dot::dot;
pub use fault::{Fault, is_fault, once_more, threads};
pub use probe::{Sparse, check_cholesky, check_inverse, check_solution, check_spectrum, scaled_probe};
pub use sparse::{NoSparseFactor, Pattern, SparseCholesky, Structure};
pub use spoil::spoil;
#[cfg(feature = "faults")]
pub use spoil::{Spoiler, disarm};
pub use symmetric::{SparseSymmetric, Symmetric};
