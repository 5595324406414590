//! A solved mesh.

use steklov_bem_operators::{Mesh, Space};
use steklov_elastic::RigidMotion;

use crate::around::Around;
use crate::body_load::Particulars;
use crate::contact::ContactResult;
use crate::energies::Energies;
use crate::fields::Field;
use crate::interfaces::TieRow;

/// Wall seconds of the parts of a step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Seconds {
    /// Mesh, loads, supports.
    pub set_up: f64,
    /// V, K, W.
    pub assemble: f64,
    /// S and its condensation.
    pub factorise: f64,
    /// Contact and back substitution.
    pub solve: f64,
}

/// A solved mesh.
pub struct Solved {
    /// The mesh.
    pub mesh: Mesh,
    /// Its unknowns.
    pub space: Space,
    /// Nodal displacement, interleaved.
    pub displacement: Vec<f64>,
    /// The elastic field without the particular solution.
    pub field: Field,
    /// The particular solutions of body forces and of a remote stress.
    pub particular: Particulars,
    /// Energies.
    pub energies: Energies,
    /// The medium around the body, if there is one.
    pub around: Option<Around>,
    /// Half of a(u, u) of each body.
    pub strain_of_bodies: Vec<f64>,
    /// The nodes of ties between bodies.
    pub ties: Vec<TieRow>,
    /// Contact, if there is any.
    pub contact: Option<ContactResult>,
    /// Largest residual of equilibrium over the scale of forces.
    pub equilibrium: f64,
    /// Whether that is as small as rounding allows: else too many digits were lost to call the answer one.
    pub balanced: bool,
    /// Force of the support or obstacle on the body for each held or contacting side.
    pub reactions: Vec<(String, [f64; 2])>,
    /// Rigid motions that nothing resists and no load drives; the displacement has none of them.
    pub free_motions: Vec<RigidMotion>,
    /// Wall seconds.
    pub seconds: Seconds,
}
