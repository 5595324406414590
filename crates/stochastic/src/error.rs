//! What can be wrong with random input.

use steklov_contact::ContactError;

/// Why random input cannot be used, or a stochastic problem not be solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StochasticError {
    /// Linear algebra that went wrong.
    #[error("{0}")]
    Fault(#[from] steklov_algebra::Fault),
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
    /// More modes than are available.
    #[error("{wanted} modes are wanted, but only {available} can be had: take {available} or fewer")]
    Modes {
        /// Number of modes asked for.
        wanted: usize,
        /// Number of modes whose eigenvalues are resolved and above roundoff.
        available: usize,
    },
    /// A share of the variance that needs too many modes.
    #[error(
        "{modes} modes, the most that can be had, capture {captured} of the variance, not the {wanted} wanted: take a \
         smaller share, a longer correlation length or a smoother covariance"
    )]
    Captured {
        /// Share asked for.
        wanted: f64,
        /// Share of all available modes.
        captured: f64,
        /// Their number.
        modes: usize,
    },
    /// A correlation length too short for the discrete eigenvalue problem.
    #[error("the correlation length {correlation} is too short on a length of {length}: take at least {shortest}")]
    Unresolved {
        /// Correlation length.
        correlation: f64,
        /// Length of the side.
        length: f64,
        /// The shortest correlation length that is resolved there.
        shortest: f64,
    },
    /// A covariance that no torus within the limits has.
    #[error(
        "on a torus {times} times as long as the grid the covariance is not positive, as the field is too smooth or too long along \
         an axis: take a number of modes instead of all, few of which have most of its variance, or a shorter correlation length"
    )]
    Embedding {
        /// Length of the longest torus over that of the grid.
        times: usize,
    },
    /// The eigenvalues on a rectangle still change under refinement.
    #[error(
        "with {}×{} points the eigenvalues still change by {change} of the largest, more than {tolerance}: take fewer \
         modes, longer correlation lengths, or a covariance that is a product", points[0], points[1]
    )]
    Unconverged {
        /// Points in both directions.
        points: [usize; 2],
        /// Largest change at the last refinement.
        change: f64,
        /// Allowed change.
        tolerance: f64,
    },
    /// A decomposition failed.
    #[error("the decomposition of a {size}×{size} matrix failed: are its entries finite?")]
    Decomposition {
        /// Number of rows.
        size: usize,
    },
}
