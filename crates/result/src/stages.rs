//! Stages of a step, stored while they exist: matrices, contact problems, stabilised multipliers, multiscale bases.

mod basis;
mod saved_outcomes;
mod stabilisation;

use steklov_io::{
    File, Group, IoError, copy, create_group, invalid, label, open_group, save, save_dense, save_integers, save_sparse,
    save_vector,
};
use steklov_model::stage::Stage;

pub(crate) use self::saved_outcomes::stochastic;
pub use self::saved_outcomes::{SavedOutcomes, copy_outcomes};
use crate::steps;

/// `/steps/NNN`, created if missing.
pub(crate) fn step_group(file: &File, number: usize) -> Result<Group, IoError> {
    let steps = if file.link_exists("steps") { open_group(file, "steps")? } else { create_group(file, "steps")? };
    let name = steps::name(number);
    if steps.link_exists(&name) { open_group(&steps, &name) } else { create_group(&steps, &name) }
}

/// The group `matrices` of a step, created if missing.
fn matrices(step: &Group) -> Result<Group, IoError> {
    if step.link_exists("matrices") { open_group(step, "matrices") } else { create_group(step, "matrices") }
}

/// The group of a body or a subdomain in them, which is there.
fn body_group(step: &Group, body: usize) -> Result<Group, IoError> {
    let of_step = matrices(step)?;
    if body == 0 { Ok(of_step) } else { open_group(&of_step, &format!("body_{body}")) }
}

/// Groups of a step.
const CONTACT: &str = "contact_problem";
const STABILISATION: &str = "stabilisation";
const BASIS: &str = "basis";

/// Stages of every step that are stored besides its result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Saved {
    /// All matrices from which contact is condensed, as `/steps/NNN/matrices`.
    Matrices,
    /// The condensed contact problem and its solution, as `/steps/NNN/contact_problem`.
    Contact,
    /// Stabilised multipliers, their forms and the equations they obey, as `/steps/NNN/stabilisation`.
    Stabilisation,
    /// The multiscale basis of a grid, as `/steps/NNN/basis`.
    Basis,
    /// All outcomes of random input, the bases and mass matrices of stochastic cells and eigenpairs of random fields,
    /// in `/stochastic`. They belong to the run, not to a step.
    Stochastic,
}

/// All of them.
pub const SAVED: [Saved; 5] = [Saved::Matrices, Saved::Contact, Saved::Stabilisation, Saved::Basis, Saved::Stochastic];

/// The groups of a step with saved stages.
pub(crate) fn groups() -> impl Iterator<Item = &'static str> {
    SAVED.into_iter().filter_map(Saved::group)
}

impl Saved {
    /// The group of a step in which it is stored; None if it belongs to the run.
    pub(crate) fn group(self) -> Option<&'static str> {
        Some(match self {
            Self::Stochastic => return None,
            Self::Matrices => "matrices",
            Self::Contact => CONTACT,
            Self::Stabilisation => STABILISATION,
            Self::Basis => BASIS,
        })
    }

    /// Whether `self` asks for this stage; nothing asks for progress.
    fn is_of(self, stage: &Stage<'_>) -> bool {
        match stage {
            Stage::Progress(..) => false,
            Stage::Again => true,
            Stage::Contact(..) => self == Self::Contact,
            Stage::Stabilised(..) => self == Self::Stabilisation,
            Stage::Basis(..) => self == Self::Basis,
            _ => self == Self::Matrices,
        }
    }
}

/// Stores a stage of a step while it exists, if it is to be saved.
///
/// # Errors
/// When the file cannot be written.
pub fn save_stage(file: &File, number: usize, stage: &Stage<'_>, saved: &[Saved]) -> Result<(), IoError> {
    if !saved.iter().any(|saved| saved.is_of(stage)) {
        return Ok(());
    }
    let step = step_group(file, number)?;
    const DISPLACEMENT: &str = "displacement unknown: nodes in the order of /solution/points, component fastest";
    match stage {
        Stage::Operators(0, operators) => save(&step, "matrices", *operators),
        // each body after the first has a group of its own
        Stage::Operators(body, operators) => save(&matrices(&step)?, &format!("body_{body}"), *operators),
        Stage::Nodes(body, nodes) => {
            let meaning = "number of each node of the subdomain: those of /solution/points, then those on cuts";
            save_integers(&body_group(&step, *body)?, "nodes", nodes, &label("1", meaning, &["node of the subdomain"]))
        }
        Stage::Steklov(body, s) => {
            let meaning = label(
                "stress",
                "Steklov-Poincare operator <S u, v>, without springs: S = W + (M/2 + K)^T V^-1 (M/2 + K); of a medium bounded at infinity S_B = S - S 1 (1^T S 1)^-1 1^T S, 1 the translations; with a medium tied on the same mesh that of the medium in it",
                &[DISPLACEMENT, DISPLACEMENT],
            );
            save_dense(&body_group(&step, *body)?, "S", s.as_ref(), &meaning)
        }
        Stage::Stiffness(name, unknowns, matrix, load) => {
            let (at, axis) = (matrices(&step)?, format!("displacement unknown: 2 {unknowns} + component"));
            let axes = [axis.as_str(); 2];
            save_sparse(&at, name, matrix, &label("stress", "stiffness matrix <K u, v>", &axes))?;
            let meaning =
                format!("f: {name} u = f + forces of supports, contact and medium, on other unknowns {name} u = f");
            save_vector(&at, "f", load, &label("force/thickness", &meaning, &axes[..1]))
        }
        Stage::Medium(operators) => save(&matrices(&step)?, "medium", *operators),
        Stage::Interface(trace, transfer) => {
            let at = matrices(&step)?;
            save(&at, "trace", *trace)?;
            save(&at, "transfer", *transfer)
        }
        Stage::Condensed(name, unknowns, matrix) => {
            let axes = [*unknowns; 2];
            let meaning = label("stress", "stiffness matrix, all other unknowns eliminated", &axes);
            save_dense(&matrices(&step)?, name, matrix.as_ref(), &meaning)
        }
        Stage::Contact(problem, solution) => {
            let at = create_group(&step, CONTACT)?;
            save(&at, "problem", *problem)?;
            save(&at, "solution", *solution)
        }
        Stage::Basis(problem) => basis::save_basis(&step, problem),
        Stage::Stabilised(system) => stabilisation::save_system(&step, system),
        Stage::Again => saved.iter().filter_map(|saved| saved.group()).try_for_each(|name| unlink(&step, name)),
        Stage::Progress(..) => Ok(()),
    }
}

/// Removes an entry, if it is there.
pub(crate) fn unlink(group: &Group, name: &str) -> Result<(), IoError> {
    if group.link_exists(name) { group.unlink(name).map_err(|e| invalid(group, name, e.to_string())) } else { Ok(()) }
}

/// Copies the saved stages of the first `number` steps from another file, as far as they are there.
///
/// # Errors
/// When one of the files cannot be read or written.
pub fn copy_saved(from: &File, file: &File, number: usize) -> Result<(), IoError> {
    let steps = open_group(from, "steps")?;
    for k in 0..number {
        let step = open_group(&steps, &steps::name(k))?;
        for name in groups().filter(|name| step.link_exists(name)) {
            copy(&step, name, &step_group(file, k)?)?;
        }
    }
    Ok(())
}
