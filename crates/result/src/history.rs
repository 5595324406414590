//! The numbers of the steps of a result file, for all models.

use steklov_io::{File, Group, IoError, invalid, load_integers, load_number, load_texts, load_vector};

use crate::steps::groups;

/// The numbers of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct StepNumbers {
    /// Displacement unknowns, held ones included.
    pub dofs: usize,
    /// J (force times length over thickness).
    pub energy: f64,
    /// Estimated error in the energy norm.
    pub estimate: Option<f64>,
    /// Why the estimate is not to be trusted: words of [`steklov_model::doubt::Doubt`]. For grids only those of the
    /// last step are known; they are in the summary.
    pub doubts: Vec<String>,
    /// Iterations of the contact solver; 0 without contact.
    pub iterations: usize,
    /// Wall seconds of this step.
    pub seconds: f64,
}

/// The numbers of all steps of a result file, at least one.
///
/// # Errors
/// A file that is not one of this program's, truncated or altered.
pub fn history(file: &File) -> Result<Vec<StepNumbers>, IoError> {
    groups(file)?.iter().map(step).collect()
}

fn step(at: &Group) -> Result<StepNumbers, IoError> {
    let dofs = load_integers(at, "dofs")?;
    let &[dofs] = dofs.as_slice() else {
        return Err(invalid(at, "dofs", format!("{} numbers, not 1", dofs.len())));
    };
    Ok(StepNumbers {
        dofs,
        energy: load_number(at, "energy")?,
        estimate: at.link_exists("estimate").then(|| load_number(at, "estimate")).transpose()?,
        doubts: if at.link_exists("doubts") { load_texts(at, "doubts")? } else { Vec::new() },
        iterations: load_vector(at, "history")?.len().saturating_sub(1),
        seconds: load_vector(at, "seconds")?.iter().sum(),
    })
}
