//! The report of a model on its last solution.

use steklov_contact::Located;

use crate::answer::largest_stress::LargestStress;
use crate::bars::Bars;
use crate::doubt::Doubt;
use crate::energies::Energies;
use crate::estimators::Estimators;
use crate::solve::contact::ContactResult;
use crate::solve::contact_rows::Trace;
use crate::solve::medium::Around;
use crate::summary::{
    BodySummary, GridSummary, InterfaceSummary, LineProbe, MediumSummary, Probe, ReachSummary, SideProbe,
};

/// Error bars of means over outcomes of random input, for the mesh alone.
pub struct OfMeans {
    /// Those of the quantities.
    pub bars: Bars,
    /// How far J is from the extrapolated one, and how far that may be off; none on a grid, where `bars` have it.
    pub energy: Option<[f64; 2]>,
    /// How far the lengths in contact and in stick may be off that nodes tell; none on a grid.
    pub lengths: Option<[f64; 2]>,
}

/// The report of a model on its last solution.
pub struct Report<'a> {
    /// Energies.
    pub energies: Energies,
    /// J of the data, and how far it may be off.
    pub energy: Option<[f64; 2]>,
    /// The estimated error (energy norm), and over the scale of the solution.
    pub error: Option<[f64; 2]>,
    /// Residual estimators, if requested.
    pub estimators: Option<Estimators>,
    /// What makes the estimate unreliable.
    pub doubts: Vec<Doubt>,
    /// The boundary.
    pub trace: Trace<'a>,
    /// Contact, if there is any.
    pub contact: Option<&'a ContactResult>,
    /// Where zones of contact and stick end, where that is known better than by nodes.
    pub located: Option<&'a [Located]>,
    /// How far each of these may be off (length); none where that is not known.
    pub off: Option<Vec<f64>>,
    /// Force of the support or obstacle on the body for each held or contacting side.
    pub reactions: &'a [(String, [f64; 2])],
    /// Displacement and stress at the points of the scene.
    pub probe: Vec<Probe>,
    /// The named quantities of the scene in their order.
    pub named: Vec<f64>,
    /// Which of them are within an element of an end of contact.
    pub near: Vec<bool>,
    /// What has error bars; empty where these are not known.
    pub bars: Bars,
    /// What has error bars in the mean over outcomes of random input, where these are known.
    pub over_outcomes: Option<OfMeans>,
    /// The largest von Mises stress; none where it is infinite or not known.
    pub largest_stress: Option<LargestStress>,
    /// The same along its lines.
    pub lines: Vec<LineProbe>,
    /// The same along its sides, with tractions.
    pub sides: Vec<SideProbe>,
    /// The grid of finite elements.
    pub grid: Option<GridSummary>,
    /// The medium around the body, solved.
    pub around: Option<&'a Around>,
    /// The reported numbers of an unbounded medium.
    pub exterior: Option<MediumSummary>,
    /// Several bodies.
    pub bodies: Vec<BodySummary>,
    /// The interfaces between them.
    pub interfaces: Vec<InterfaceSummary>,
    /// Places where they lie in each other.
    pub reach: Vec<ReachSummary>,
}
