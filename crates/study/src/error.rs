//! Why a study has no results.

use steklov_bem_operators::BemError;
use steklov_model::error::SolveError;
use steklov_problem::DataError;

/// Why a study has no results.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A scene that this study cannot treat.
    #[error(transparent)]
    Data(#[from] DataError),
    /// The reference cannot be solved.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The single layer matrix of the study's own mesh cannot be computed.
    #[error(transparent)]
    SingleLayer(#[from] BemError),
    /// No mesh of the fine run can be trusted.
    #[error(
        "no mesh of the reference is solved to the contact solver's criterion (tried: {steps}): \
         nothing can be compared; try another method.solver or other method.elements"
    )]
    NotSolved {
        /// Meshes of the fine run.
        steps: usize,
    },
}
