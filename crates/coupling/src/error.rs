//! What can be wrong with a transmission problem.

use steklov_bem_operators::{BemError, PolygonError};
use steklov_msfem::MsfemError;

/// Why a transmission problem cannot be set up or solved; each carries the numbers that show what to change.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CouplingError {
    /// Linear algebra that went wrong.
    #[error("{0}")]
    Fault(#[from] steklov_algebra::Fault),
    /// A body whose outer boundary is not one closed curve.
    #[error("the body has no outer boundary that is one simple curve: {what}")]
    Outline {
        /// What is wrong, and where.
        what: String,
    },
    /// Boundary elements that are not on the outer boundary of the grid.
    #[error("the boundary elements do not lie on the outer boundary of the grid: {what}")]
    Boundary {
        /// Which element, and what is wrong with it.
        what: String,
    },
    /// Data of wrong size or value.
    #[error("{what}")]
    Inconsistent {
        /// What was given and what is needed.
        what: String,
    },
    /// Loads with a resultant, where the displacement is to be bounded at infinity.
    #[error(
        "the body force and the jump of tractions have the resultant ({:.3e}, {:.3e}), {:.1e} of the sum of their absolute \
         values: a displacement that is bounded at infinity needs less than {:.0e}; balance the loads, or take \
         the solution that grows as a logarithm",
        .force[0], .force[1], .relative, .tolerance
    )]
    Unbalanced {
        /// Resultant (force per thickness).
        force: [f64; 2],
        /// Its part of the sum of absolute values.
        relative: f64,
        /// What is allowed.
        tolerance: f64,
    },
    /// A body and a medium of stiffnesses so far apart that too few digits are left.
    #[error(
        "the stiffness of the body is {contrast:.1e} times that of the medium around it: it must be less than {limit:.0e} \
         times (and more than the inverse of that for the three-field form); treat the stiffer of both as rigid"
    )]
    Contrast {
        /// Largest diagonal entry of the body's reduced stiffness over that of W.
        contrast: f64,
        /// What is allowed.
        limit: f64,
    },
    /// A system on the interface that has no solution in floating point.
    #[error(
        "the system of body and medium, with {size} unknowns of the interface, has no finite solution (stiffness of the body \
         over that of the medium: {contrast:.1e}): check the units of moduli and lengths"
    )]
    Singular {
        /// Number of unknowns of the trace.
        size: usize,
        /// Largest diagonal entry of the body's reduced stiffness over that of W.
        contrast: f64,
    },
    /// An error of the grid or of its multiscale elements.
    #[error(transparent)]
    Msfem(#[from] MsfemError),
    /// An error of the boundary elements.
    #[error(transparent)]
    Bem(#[from] BemError),
    /// An outer boundary that is no polygon.
    #[error(transparent)]
    Polygon(#[from] PolygonError),
}
