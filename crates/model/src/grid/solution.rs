//! A solved grid.

use std::sync::{Mutex, OnceLock};

use steklov_coupling::InterfaceIndicators;
use steklov_elastic::RigidMotion;
use steklov_msfem::{Basis, CoarseMesh, HeterogeneousBody};

use super::duals::{DualData, GridQuantity};
use super::error_parts::GridEstimate;
use super::trace::GridTrace;
use crate::bars::Bars;
use crate::energies::Energies;
use crate::solve::contact::ContactResult;
use crate::solve::contact_rows::Trace;
use crate::solve::medium::Around;
use crate::solve::solution::Seconds;

/// A solved grid.
pub struct GridSolved {
    /// Cells, moduli, Poisson's ratio.
    pub body: HeterogeneousBody,
    /// The coarse cells and what belongs to them; `None` for bilinear elements on the fine grid.
    pub coarse: Option<CoarseSolved>,
    /// The boundary elements on which supports and contact are set up.
    pub(crate) trace: GridTrace,
    /// Displacement of their nodes, interleaved.
    pub(crate) boundary_displacement: Vec<f64>,
    /// Displacement of the fine nodes, interleaved.
    pub displacement: Vec<f64>,
    /// Unknowns of the system that was solved, held ones included.
    pub dofs: usize,
    /// Energies.
    pub energies: Energies,
    /// Contact, if there is any.
    pub contact: Option<ContactResult>,
    /// Whether the forces balance as far as rounding allows.
    pub balanced: bool,
    /// Force of the support or obstacle on the body for each held or contacting side.
    pub reactions: Vec<(String, [f64; 2])>,
    /// The moments and weighted forces that the scene asks for, in their order.
    pub(crate) works: Vec<f64>,
    /// The error bars of means over outcomes of random input, for the grid alone, if they are known.
    pub(crate) over_outcomes: Option<Bars>,
    /// Rigid motions that nothing resists and no load drives; the displacement has none of them.
    pub free_motions: Vec<RigidMotion>,
    /// The estimated error.
    pub estimate: Option<GridEstimate>,
    /// Wall seconds.
    pub seconds: Seconds,
    /// Wall seconds of the estimate.
    pub estimate_seconds: f64,
    /// The unbounded medium around the body.
    pub around: Option<Around>,
    /// The residuals of the equations where both meet.
    pub(crate) interface: Option<InterfaceIndicators>,
    /// The part of the jump of the displacement that its nodes miss, an energy for each boundary element.
    pub(crate) jump_oscillation: Vec<f64>,
    /// What the dual problems of its numbers take, and these numbers once they are known.
    pub(super) dual_data: Mutex<Option<DualData>>,
    pub(super) quantities: OnceLock<(Vec<GridQuantity>, Option<GridQuantity>)>,
}

/// The coarse part of a multiscale solution.
pub struct CoarseSolved {
    /// Coarse cells.
    pub mesh: CoarseMesh,
    /// Their basis.
    pub basis: Basis,
    /// Displacement of the vertices, those that hang included (length).
    pub displacement: Vec<[f64; 2]>,
    /// Whether the response to the load inside of each cell is added.
    pub bubbles: bool,
    /// Number of different patterns of moduli, each with one local problem.
    pub patterns: usize,
    /// Displacement of fine nodes on the boundary less that of the basis functions, as [`steklov_msfem::Extra::lift`] has it.
    pub lift: Vec<f64>,
}

impl GridSolved {
    /// The boundary of the body.
    pub fn trace(&self) -> Trace<'_> {
        Trace { mesh: &self.trace.mesh, space: &self.trace.space, displacement: &self.boundary_displacement }
    }

    /// Whether the contact solver reached its criterion and the forces balance.
    pub fn converged(&self) -> bool {
        self.balanced && self.contact.as_ref().is_none_or(ContactResult::converged)
    }
}
