//! Why a study has no results.

use std::path::PathBuf;

use steklov_bem_operators::BemError;
use steklov_io::IoError;
use steklov_model::error::SolveError;
use steklov_picture::PictureError;
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
    /// A study of boundary elements of a scene on a grid.
    #[error(
        "the model of the scene is \"{model}\", and this study is of boundary elements: take the study \"{other}\", or \
         method.model = \"bem\" if the body is of one material"
    )]
    OnGrid {
        /// The model of the scene.
        model: &'static str,
        /// The study of such scenes.
        other: &'static str,
    },
    /// Multipliers of contact to compare, without contact.
    #[error("the option multipliers compares those of contact, and no side of the scene is in contact: leave it out")]
    NoContact,
    /// An option of another study.
    #[error("{option} belongs to the study \"{study}\", and not to \"{other}\"")]
    Misplaced {
        /// The option.
        option: &'static str,
        /// The study that has it.
        study: &'static str,
        /// The study that was asked for.
        other: &'static str,
    },
    /// The HDF5 file cannot be written.
    #[error(transparent)]
    Io(#[from] IoError),
    /// A picture cannot be drawn or written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Another file cannot be written.
    #[error("nothing can be written into {}: {source}", folder.display())]
    Write {
        /// The folder.
        folder: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
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
