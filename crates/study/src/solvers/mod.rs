//! Contact solvers compared on the same condensed problems, and how fast the semi-smooth Newton method converges.
//!
//! ```text
//! uniform meshes ─► condensed contact problems ─► Solvers (iterations, seconds, measures by iteration) ─┐
//!                                             └─► Newton (errors of the iterates)                      ─┴► report, draw
//! ```

mod compare;
mod newton;
mod report;
mod draw;

use steklov_document::Source;
use steklov_problem::{DataError, DataErrorKind, Scene};

use crate::contact_sides;
use crate::error::StudyError;
use crate::watch::Watch;

pub(crate) use compare::METHODS;
pub use compare::{Method, SOLVERS, Solvers, solvers};
pub use draw::pictures;
pub(crate) use draw::{histories, iterations};
pub use newton::{Iterate, Newton};
pub use report::report;
pub(crate) use report::{parts, table};

/// A finished study.
#[derive(Debug)]
pub struct ContactSolvers<'a> {
    /// The scene as it was run, settings included.
    pub scene: &'a Scene,
    /// The texts from which it was read.
    pub source: &'a Source,
    /// The cost of solvers.
    pub solvers: Solvers,
    /// The iterates of the semi-smooth Newton method, mesh by mesh.
    pub newton: Vec<Newton>,
    /// Whether the user stopped it.
    pub interrupted: bool,
}

/// Checks that a scene can be studied.
///
/// # Errors
/// A scene without contact, or on a grid.
pub fn check(scene: &Scene) -> Result<(), DataError> {
    if contact_sides(scene).is_empty() {
        let message = "the study is about solvers of contact, and no side is in contact".to_owned();
        let help = "give a side contact = { gap = \"0\" }, or study --what convergence";
        return Err(DataError::at(DataErrorKind::Unsupported, &[vec!["sides"]], message, help));
    }
    if scene.is_on_grid() {
        let message = "the study is about contact of boundary elements, and the scene has a grid".to_owned();
        let help = "leave the grid out, or set method.model = \"bem\"";
        return Err(DataError::at(DataErrorKind::Unsupported, &[vec!["grid"]], message, help));
    }
    Ok(())
}

/// All solvers on uniform meshes.
///
/// # Errors
/// The errors of assembly on the meshes. A solver that fails is reported in its place.
pub fn study<'a>(
    scene: &'a Scene,
    source: &'a Source,
    watch: &mut Watch<'_>,
) -> Result<ContactSolvers<'a>, StudyError> {
    let (mut solvers, mut newton) = (Solvers::default(), Vec::new());
    compare::problems(scene, watch, &mut |on_mesh, watch| {
        solvers.add(&on_mesh, watch);
        newton.push(Newton::new(&on_mesh));
    })?;
    Ok(ContactSolvers { scene, source, solvers, newton, interrupted: watch.stopped() })
}

impl ContactSolvers<'_> {
    /// Whether nobody stopped it. Solvers may fail: that is a result.
    pub fn complete(&self) -> bool {
        !self.interrupted
    }
}
