//! The stages that a step passes to its observer.

use faer::Mat;
use sprs::CsMat;
use steklov_bem_operators::Operators;
use steklov_contact::{Problem, Solution};
use steklov_coupling::{Trace, Transfer};
use steklov_msfem::Multiscale;

use crate::error::SolveError;
use crate::solve::stabilised::StabilisedSystem;

/// The data that a step passes to its observer while it has them.
pub enum Stage<'a> {
    /// V, K, W, M of a body, or of a subdomain, of this number, and the space they belong to.
    Operators(usize, &'a Operators),
    /// The number of each node of a subdomain of this number among all: those of the boundary, then those on cuts.
    Nodes(usize, &'a [usize]),
    /// S of a body of this number.
    Steklov(usize, &'a Mat<f64>),
    /// A sparse stiffness matrix and its load: its name and the meaning of n in its unknowns 2·n + component.
    Stiffness(&'static str, &'static str, &'a CsMat<f64>, &'a [f64]),
    /// The coarse cells of a grid with their bases.
    Basis(&'a Multiscale<'a>),
    /// V, K, W, M of the medium around a body.
    Medium(&'a Operators),
    /// The trace of a body on the interface with the medium, and the map to the boundary elements there.
    Interface(&'a Trace, &'a Transfer),
    /// A stiffness matrix reduced to some unknowns: its name and what these are.
    Condensed(&'static str, &'static str, &'a Mat<f64>),
    /// The condensed contact problem and its solution, of biorthogonal multipliers.
    Contact(&'a Problem, &'a Solution),
    /// The equations of stabilised multipliers and their answer.
    Stabilised(&'a StabilisedSystem<'a>),
    /// The step begins once more, after a fault of the linear algebra: its earlier stages do not count.
    Again,
    /// A part of the work begins; the number is its share of the work of the step that is then done, 0 to 1.
    Progress(&'static str, f64),
}

/// Does work that reports its progress; the work takes the step from one share to another.
pub(crate) fn watched<T, E: Into<SolveError>>(
    part: &'static str,
    [from, to]: [f64; 2],
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
    work: impl FnOnce(&mut dyn FnMut(f64) -> bool) -> Result<T, E>,
) -> Result<T, SolveError> {
    let mut stopped = None;
    let done = work(&mut |share| match observe(Stage::Progress(part, from + (to - from) * share)) {
        Ok(()) => true,
        Err(error) => {
            stopped = Some(error);
            false
        }
    });
    match stopped {
        Some(error) => Err(error),
        None => done.map_err(Into::into),
    }
}
