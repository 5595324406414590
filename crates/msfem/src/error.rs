//! What can be wrong with a heterogeneous body and its grid.

use steklov_algebra::NoSparseFactor;

/// Why a problem on a grid cannot be set up or solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MsfemError {
    /// A grid that is none.
    #[error("{what}")]
    Grid {
        /// What is wrong, with the numbers.
        what: String,
    },
    /// A modulus that is not a positive number.
    #[error(
        "Young's modulus of cell ({}, {}) with the centre ({}, {}) is {value:?}: it must be positive and finite",
        .cell[0], .cell[1], .centre[0], .centre[1]
    )]
    Modulus {
        /// Column and row of the cell.
        cell: [usize; 2],
        /// Its centre.
        centre: [f64; 2],
        /// Its modulus.
        value: f64,
    },
    /// Data of different sizes.
    #[error("{what}")]
    Inconsistent {
        /// Both sizes, in words.
        what: String,
    },
    /// A stiffness matrix that has no Cholesky factor.
    #[error(
        "the stiffness matrix of {size} unknowns is not positive definite at unknown {unknown}: hold the body against all \
         rigid motions, and keep the contrast of the moduli below 1e12"
    )]
    Singular {
        /// Where the factorisation stopped.
        unknown: usize,
        /// Number of unknowns.
        size: usize,
    },
    /// Linear algebra that went wrong.
    #[error("{0}")]
    Fault(#[from] steklov_algebra::Fault),
    /// Poisson's ratio out of range.
    #[error("Poisson's ratio is {value}: it must lie between -1 and 1/2")]
    Poisson {
        /// The ratio.
        value: f64,
    },
    /// Not enough memory for a factorisation.
    #[error(
        "the factor of a matrix of {size} unknowns does not fit into memory: take a coarser grid, or multiscale elements \
         (model = \"msfem\")"
    )]
    Memory {
        /// Number of unknowns.
        size: usize,
    },
    /// A body force that cannot be integrated.
    #[error("the body force {what} near the point ({}, {})", .point[0], .point[1])]
    Force {
        /// Where.
        point: [f64; 2],
        /// What is wrong.
        what: &'static str,
    },
    /// The caller stopped the work.
    #[error("stopped before the work was done")]
    Stopped,
}

impl MsfemError {
    /// The error of a matrix of so many unknowns that has no factor.
    pub fn of_factor(none: NoSparseFactor, size: usize) -> Self {
        match none {
            NoSparseFactor::Memory => Self::Memory { size },
            NoSparseFactor::Pivot(unknown) => Self::Singular { unknown, size },
            NoSparseFactor::Fault(fault) => fault.into(),
        }
    }
}
