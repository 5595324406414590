//! What can be wrong with random input.

use steklov_contact::ContactError;

/// Why random input cannot be used, or a stochastic problem not be solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StochasticError {
    /// A number is outside of what the formula allows.
    #[error("{what} is {value}; it must be {wanted}")]
    Number {
        /// What the number is.
        what: String,
        /// Its value.
        value: f64,
        /// What is allowed.
        wanted: &'static str,
    },
    /// Data of different sizes.
    #[error("{what}")]
    Inconsistent {
        /// Both sizes, in words.
        what: String,
    },
    /// The contact problem of a node failed.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// Coupled nodes need a positive definite matrix.
    #[error(
        "{what} has eigenvalues from {smallest} to {largest} and is not positive definite: hold the body, or solve node by \
         node (collocation)"
    )]
    NotCoercive {
        /// Which matrix.
        what: String,
        /// Smallest eigenvalue.
        smallest: f64,
        /// Largest eigenvalue.
        largest: f64,
    },
    /// A decomposition failed.
    #[error("the decomposition of a {size}×{size} matrix failed: are its entries finite?")]
    Decomposition {
        /// Number of rows.
        size: usize,
    },
}
