//! The body: its stiffness, its loads and the displacement on its outer boundary.

use sprs::CsMat;
use steklov_msfem::{Extra, HeterogeneousBody, Loads, Multiscale};

use crate::{CouplingError, Outline, Trace};

/// The linear system of an unsupported body, for any kind of elements.
#[derive(Debug, Clone)]
pub struct Interior {
    /// Stiffness matrix A of all unknowns, two a node (stress).
    pub stiffness: CsMat<f64>,
    /// ∫ f·v + ∫ t0·v, the body force and the jump of tractions (force per thickness).
    pub load: Vec<f64>,
    /// Nodes in an order of elimination with little fill.
    pub order: Vec<usize>,
    /// The displacement on the outer boundary.
    pub trace: Trace,
}

impl Interior {
    /// Bilinear elements on all fine cells.
    ///
    /// # Errors
    /// As [`Outline::new`].
    pub fn fine(body: &HeterogeneousBody, loads: &Loads) -> Result<Self, CouplingError> {
        let outline = Outline::new(&body.grid)?;
        Ok(Self {
            stiffness: body.stiffness(),
            load: loads.nodal(body),
            order: body.elimination_order(),
            trace: Trace::fine(&body.grid, &outline),
        })
    }

    /// Multiscale elements with a conforming basis; [`Multiscale::downscale`] brings the unknowns back to the fine nodes.
    /// `go_on` is called as by [`Multiscale::assemble`].
    ///
    /// # Errors
    /// As [`Outline::new`], [`Trace::coarse`] and [`Multiscale::assemble`].
    pub fn coarse(
        problem: &mut Multiscale<'_>,
        loads: &Loads,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Self, CouplingError> {
        let outline = Outline::new(&problem.body.grid)?;
        let trace = Trace::coarse(problem, &outline)?;
        // the response of the cells' insides to their load does no work on the basis: the system is the same with it
        let system = problem.assemble(loads, &Extra::default(), go_on)?;
        Ok(Self { stiffness: system.stiffness, load: system.load, order: problem.elimination_order(), trace })
    }
}
