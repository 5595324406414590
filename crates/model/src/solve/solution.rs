//! A solved mesh.

use steklov_bem_operators::{Location, Mesh, Space};
use steklov_elastic::RigidMotion;
use steklov_problem::{Scene, Spot};

use crate::data::body_load::Particulars;
use crate::energies::Energies;
use crate::quantities::EstimatedQuantity;
use crate::solve::contact::ContactResult;
use crate::solve::fields::{ElasticField, Field};
use crate::solve::medium::Around;
use crate::summary::Probe;

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
    /// The matrices that the estimate needs besides S.
    pub enrich: f64,
}

/// A node of a tie: the traction of the other body on the one that carries it.
#[derive(Debug, Clone, PartialEq)]
pub struct TieRow {
    /// Name of the interface.
    pub name: String,
    /// The point.
    pub point: [f64; 2],
    /// Length that it stands for.
    pub weight: f64,
    /// Traction on the body that carries the multipliers (stress).
    pub traction: [f64; 2],
}

/// What the spaces of one degree more add to numbers in the mean over outcomes of random input.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OverOutcomes {
    /// The quantities in the order of those of an estimate, with their dual weighted residuals.
    pub quantities: Vec<EstimatedQuantity>,
    /// The J extrapolated less J, and how far that may be off.
    pub energy: [f64; 2],
    /// The largest pressure of nodes.
    pub peak: f64,
    /// How far the lengths in contact and in stick may be off that nodes tell.
    pub lengths: [f64; 2],
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
    /// The forces of ties on the bodies that carry the multipliers, by the names of interfaces.
    pub tie_forces: Vec<(String, [f64; 2])>,
    /// Contact, if there is any.
    pub contact: Option<ContactResult>,
    /// Largest residual of equilibrium over the scale of forces.
    pub equilibrium: f64,
    /// Whether that is as small as rounding allows: else too many digits were lost to call the answer one.
    pub balanced: bool,
    /// Force on the body of the support, the springs or the obstacle of each side that has one.
    pub reactions: Vec<(String, [f64; 2])>,
    /// The moments and weighted forces that the scene asks for, in their order, of the forces at nodes; zero between bodies.
    pub works: Vec<f64>,
    /// Work of the reactions of supports and obstacles on what they prescribe, displacements and gaps.
    pub reaction_work: f64,
    /// What the enriched spaces add in the mean over outcomes of random input, if that is known.
    pub over_outcomes: Option<OverOutcomes>,
    /// Rigid motions that nothing resists and no load drives; the displacement has none of them.
    pub free_motions: Vec<RigidMotion>,
    /// Wall seconds.
    pub seconds: Seconds,
}

impl Solved {
    /// Its field.
    pub fn elastic_field(&self) -> ElasticField<'_> {
        ElasticField { mesh: &self.mesh, field: &self.field, particular: &self.particular }
    }

    /// Displacement and stress at a point inside a body.
    pub fn inside(&self, body: usize, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        self.elastic_field().inside(body, x)
    }

    /// Displacement and stress on the boundary, at the reference coordinate t of element e.
    pub fn on_boundary(&self, e: usize, t: f64) -> ([f64; 2], [f64; 3]) {
        self.elastic_field().on_boundary(e, t)
    }

    /// Traction at the reference coordinate t of element e.
    pub fn traction(&self, e: usize, t: f64) -> [f64; 2] {
        self.elastic_field().traction(e, t)
    }

    /// Displacement and stress at the edge parameter s of an edge of the polygon; at a corner or another vertex, where
    /// stresses of the elements beside it differ, their mean.
    pub fn on_edge(&self, edge: usize, s: f64) -> ([f64; 2], [f64; 3]) {
        self.elastic_field().on_edge(edge, s)
    }

    /// Displacement and stress at a point where something lies.
    pub fn at(&self, spot: Spot, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        match (spot.on, &self.around) {
            (Some((edge, s)), _) => self.on_edge(edge, s),
            (None, Some(around)) if spot.body > 0 => around.at(x),
            _ => self.inside(spot.body, x),
        }
    }

    /// Displacement and stress at a point: on the boundary those of the body.
    pub fn probe(&self, scene: &Scene, x: [f64; 2]) -> Probe {
        let (displacement, stress) = match (scene.problem.outline.contains(x), &self.around) {
            (Location::Boundary { edge, s }, _) => self.on_edge(edge, s),
            (Location::Outside, Some(around)) => around.at(x),
            _ => self.inside(scene.problem.outline.body_at(x).unwrap_or(0), x),
        };
        Probe::new(x, displacement, stress)
    }
}
