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
    /// An interval holds (almost) nothing of a distribution, so that nothing can be conditioned on it.
    #[error(
        "the interval [{}, {}] has the probability {probability:e}; widen it or move it to where the density is",
        interval[0], interval[1]
    )]
    NoProbability {
        /// Its ends: values of a variable, germs of a cell.
        interval: [f64; 2],
        /// Its probability.
        probability: f64,
    },
    /// The contact problem of a node failed.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// A decomposition failed.
    #[error("the decomposition of a {size}×{size} matrix failed: are its entries finite?")]
    Decomposition {
        /// Number of rows.
        size: usize,
    },
}
