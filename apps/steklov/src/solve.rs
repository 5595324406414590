//! One mesh solved: operators, Steklov-Poincaré matrix, supports, contact, energies, reactions.

use std::time::Instant;

use faer::Mat;
use steklov_bem_operators::{
    BemError, BodyForce, BoundaryField, Condensation, Domain, EnrichedSteklov, Enrichment, Mesh, Operators, PairCache,
    Partition, RigidMotion, Space, Steklov,
};
use steklov_contact::{ContactBoundary, ContactError, resisted_motions};

use crate::body_load::{Particular, crossed_work, energies};
use crate::contact::{CondensedBody, ContactFactors, ContactResult, solve_contact};
use crate::data::{Data, Loads};
use crate::motions::{balanced, edges, work};
use crate::run::Step;
use crate::scene::{Condition, Multiplier, Scene, SceneError};
use crate::stabilised::{Body, solve_stabilised};
use crate::supports::Supports;

/// What a run hands to its observer while it has it.
pub enum Stage<'a> {
    /// V, K, W, M and the space they belong to.
    Operators(&'a Operators),
    /// S.
    Steklov(&'a Mat<f64>),
    /// A step is solved and estimated, so many seconds after the run began.
    Step {
        /// The solution.
        solved: &'a Solved,
        /// What is kept of it.
        step: &'a Step,
        /// Wall seconds.
        seconds: f64,
    },
    /// A part of the work begins; the number is its share of the work of the step that is then done, 0 to 1.
    Progress(&'static str, f64),
}

/// Why a run stopped without a result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// The scene's data cannot be used.
    #[error(transparent)]
    Scene(#[from] Box<SceneError>),
    /// The boundary element part failed.
    #[error(transparent)]
    Bem(#[from] BemError),
    /// The contact part failed.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// Two held sides want different displacements where they meet.
    #[error(
        "sides \"{first}\" and \"{second}\" hold the point ({}, {}) at different displacements {component} = {a} and {b}: \
         make them equal there, or free one of them",
        .point[0],
        .point[1]
    )]
    Incompatible {
        /// One side.
        first: String,
        /// The other side.
        second: String,
        /// The common point.
        point: [f64; 2],
        /// x or y.
        component: char,
        /// Value on the first side.
        a: f64,
        /// Value on the second side.
        b: f64,
    },
    /// Displacements, energies or errors beyond the range of floating point.
    #[error(
        "the displacements, the energy ({energy}) or its estimated error leave the range of floating point numbers"
    )]
    NotFinite {
        /// J as computed.
        energy: f64,
    },
    /// The observer failed to store what it was given.
    #[error(transparent)]
    Io(#[from] steklov_io::IoError),
    /// The user stopped the run.
    #[error("interrupted before a step was finished: nothing was stored")]
    Interrupted,
}

impl From<SceneError> for SolveError {
    fn from(error: SceneError) -> Self {
        Self::Scene(Box::new(error))
    }
}

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

/// J = strain energy - load work + friction work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energies {
    /// J.
    pub total: f64,
    /// Half of a(u, u).
    pub strain: f64,
    /// Work of tractions and body force, without that of reactions.
    pub load_work: f64,
    /// Σ D_i F_i |u_t,i|.
    pub friction_work: f64,
}

/// A solved mesh.
pub struct Solved {
    /// The mesh.
    pub mesh: Mesh,
    /// Its unknowns.
    pub space: Space,
    /// Nodal displacement, interleaved.
    pub displacement: Vec<f64>,
    /// The elastic field without the body force's particular solution.
    pub field: BoundaryField,
    /// The particular solution of the body force.
    pub body_force: Option<BodyForce>,
    /// Energies.
    pub energies: Energies,
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

/// Relative residual of equilibrium beyond which an answer has lost too many digits.
pub(crate) const UNBALANCED: f64 = 1e-7;

/// What is left of a solution's matrices, for its estimate and the next mesh.
pub struct Factors {
    /// S, the free unknowns eliminated.
    pub condensation: Condensation,
    /// What S₊ of the enriched spaces needs besides, if the solution is to be estimated.
    pub enriched: Option<EnrichedSteklov>,
    /// Nodal displacement without the body force's particular solution, of biorthogonal multipliers.
    pub homogeneous: Vec<f64>,
    /// J of that displacement.
    pub energy: f64,
    /// ‖u - u_b‖², energy norm, of the displacements of stabilised and biorthogonal multipliers; 0 if they are one.
    pub difference: f64,
    /// Load of the bubbles, less that of the particular solution.
    pub extra_load: Vec<f64>,
    /// What the polynomials of each element leave of its prescribed tractions, h/(p+2) ‖t - Π t‖² (stress² length²).
    pub unresolved: Vec<f64>,
    /// The condensed contact problem.
    pub contact: Option<ContactFactors>,
}

/// Solves the scene on a mesh; `estimated`: with what an estimate needs. Moments of pairs of elements are taken from `cache`
/// where it has them.
///
/// # Errors
/// Data that are not finite, a free rigid motion that the loads drive, an observer that fails.
pub fn solve(
    scene: &Scene,
    mesh: Mesh,
    estimated: bool,
    cache: &mut PairCache,
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<(Solved, Factors), SolveError> {
    let clock = Instant::now();
    let mut seconds = Seconds::default();
    observe(Stage::Progress("loads and supports", 0.0))?;
    let space = Space::new(&mesh);
    let data = Data { scene, mesh: &mesh, space: &space };
    let held = data.held()?;
    let Loads { nodal: tractions, bubbles: mut extra_load, unresolved } = data.load()?;
    let boundary = data.contact(&held)?;
    seconds.set_up = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    observe(Stage::Progress("assembling V, K, W", 0.05))?;
    let (operators, enrichment) = if estimated {
        let (operators, enrichment) = Enrichment::assemble(&mesh, &space, &scene.material, None, cache)?;
        (operators, Some(enrichment))
    } else {
        (Operators::assemble(&mesh, &space, &scene.material, None)?, None)
    };
    let length = operators.length;
    seconds.assemble = clock.elapsed().as_secs_f64();
    observe(Stage::Operators(&operators))?;

    let clock = Instant::now();
    observe(Stage::Progress("Steklov-Poincaré matrix", 0.3))?;
    let (Steklov { matrix, traction: traction_map }, enriched) = match enrichment {
        None => (Steklov::new(operators, Domain::Interior)?, None),
        Some(enrichment) => {
            let (steklov, enriched) = Steklov::enriched(operators, enrichment)?;
            (steklov, Some(enriched))
        }
    };
    observe(Stage::Steklov(&matrix))?;
    let body_force = scene.body_force.map(|b| BodyForce::new(b, scene.polygon.centroid(), &scene.material));
    let particular = body_force.map(|b| Particular::new(&b, &mesh, &space, &matrix));
    let mut load = tractions.clone();
    if let Some(p) = &particular {
        load.iter_mut().zip(&p.load).for_each(|(f, p)| *f += p);
    }
    if let Some(b) = &body_force {
        extra_load.iter_mut().zip(b.bubble_load(&mesh, &space)).for_each(|(f, t)| *f -= t);
    }

    observe(Stage::Progress("condensation", 0.75))?;
    let supports = Supports { space: &space, held: &held };
    let candidates = supports.free_motions();
    let free = match &boundary {
        None => balanced(&space, &load, &candidates)?,
        Some(boundary) => resisted_motions(&candidates, &edges(boundary), |r| work(&space, &load, r))?,
    };
    let partition = Partition {
        kept: boundary.as_ref().map_or(Vec::new(), ContactBoundary::kept),
        held: supports.dofs(),
        frames: boundary.as_ref().map_or(Vec::new(), ContactBoundary::frames),
    };
    let nodal = |motions: &[RigidMotion]| -> Vec<Vec<f64>> { motions.iter().map(|r| r.nodal(&space.points)).collect() };
    let motions = nodal(&free);
    let stabilised = match (&boundary, scene.method.multiplier) {
        (Some(_), Multiplier::Stabilised) => {
            let body = Body {
                traction: &traction_map,
                stiffness: &matrix,
                load: &load,
                held: &partition.held,
                rigid: &nodal(&candidates),
                free: &motions,
                particular: particular.as_ref(),
            };
            Some(solve_stabilised(&data, &body)?)
        }
        _ => None,
    };
    let condensation = Condensation::new(matrix, &partition, &motions)?;
    let condensed = condensation.load(&load);
    seconds.factorise = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    observe(Stage::Progress("contact", 0.95))?;
    let (displacement, contact, contact_factors) = match boundary {
        None => (condensation.expand(&condensed, &[]), None, None),
        Some(boundary) => {
            let body = CondensedBody {
                mesh: &mesh,
                space: &space,
                condensation: &condensation,
                load: &load,
                condensed: &condensed,
                free: &free,
            };
            let (displacement, result, factors) = solve_contact(&body, boundary, scene.method.solver)?;
            (displacement, Some(result), Some(factors))
        }
    };
    // what adaptivity and the estimate rest on
    let companion = displacement;
    let companion_friction = contact.as_ref().map_or(0.0, |c| c.friction_work);
    let (displacement, contact) = match (contact, stabilised) {
        (Some(contact), Some(s)) => {
            let (displacement, audit, friction_work) = (s.displacement.clone(), s.audit, s.friction_work);
            (displacement, Some(ContactResult { audit, friction_work, stabilised: Some(s), ..contact }))
        }
        (contact, _) => (companion.clone(), contact),
    };
    let forces = condensation.multiply(&displacement);
    let mut residual: Vec<f64> = forces.iter().zip(&load).map(|(s, f)| s - f).collect();
    if let Some(c) = &contact {
        match &c.stabilised {
            Some(s) => residual.iter_mut().zip(&s.forces).for_each(|(r, f)| *r += f),
            None => {
                for (node, force) in c.boundary.nodal_forces(&c.solution.multipliers) {
                    residual[2 * node] += force[0];
                    residual[2 * node + 1] += force[1];
                }
            }
        }
    }
    let equilibrium = supports.equilibrium(&residual, &forces, &load, 0.0);
    // without a load a body may move as a whole or not at all: forces of roundoff are no scale of their own
    let largest = |values: &[f64]| values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let unloaded = largest(&load) == 0.0;
    let gap = contact.as_ref().map_or(0.0, |c| c.boundary.largest_gap());
    let moved = largest(&displacement) + gap;
    let floor = if unloaded { 1e-6 * condensation.largest_diagonal() * moved } else { 0.0 };
    let balanced = supports.equilibrium(&residual, &forces, &load, floor) <= UNBALANCED;
    let contact = contact.map(|mut c| {
        c.audit.equilibrium = c.audit.equilibrium.max(equilibrium);
        c
    });

    let of_displacement = |displacement: &[f64], forces: &[f64], friction_work: f64| {
        let homogeneous: Vec<f64> = match &particular {
            None => displacement.to_vec(),
            Some(p) => displacement.iter().zip(&p.displacement).map(|(u, p)| u - p).collect(),
        };
        let traction = traction_map.apply(&homogeneous);
        let field = BoundaryField::new(&mesh, &space, &scene.material, &homogeneous, &traction, length);
        let crossed = body_force.map_or(0.0, |b| crossed_work(&field, &b, &mesh, &space));
        let energies = energies(displacement, forces, &tractions, particular.as_ref(), crossed, friction_work);
        (homogeneous, field, energies)
    };
    let friction_work = contact.as_ref().map_or(0.0, |c| c.friction_work);
    let (homogeneous, field, energies) = of_displacement(&displacement, &forces, friction_work);
    let (homogeneous, companion_energy, difference) = match &contact {
        Some(ContactResult { stabilised: Some(_), .. }) => {
            let apart: Vec<f64> = displacement.iter().zip(&companion).map(|(a, b)| a - b).collect();
            let stiff = condensation.multiply(&apart);
            let (homogeneous, _, energies) =
                of_displacement(&companion, &condensation.multiply(&companion), companion_friction);
            (homogeneous, energies.total, apart.iter().zip(&stiff).map(|(a, b)| a * b).sum::<f64>().max(0.0))
        }
        _ => (homogeneous, energies.total, 0.0),
    };
    let Energies { total, strain, load_work, .. } = energies;
    if [total, strain, load_work].iter().chain(&displacement).any(|v| !v.is_finite()) {
        return Err(SolveError::NotFinite { energy: total });
    }
    let mut reactions = supports
        .reactions(&residual, &mesh, &scene.sides, |e, j| data.traction_moment(&field, body_force.as_ref(), e, j));
    if let Some(c) = &contact {
        for (side, condition) in scene.sides.iter().enumerate() {
            if matches!(condition.condition, Condition::Contact { .. }) {
                reactions.push((side, c.force(side)));
            }
        }
    }
    reactions.sort_by_key(|r| r.0);
    let reactions = reactions.into_iter().map(|(side, force)| (mesh.side_names[side].clone(), force)).collect();
    seconds.solve = clock.elapsed().as_secs_f64();
    let factors = Factors {
        condensation,
        enriched,
        homogeneous,
        energy: companion_energy,
        difference,
        extra_load,
        unresolved,
        contact: contact_factors,
    };
    let solved = Solved {
        displacement,
        field,
        body_force,
        energies,
        contact,
        equilibrium,
        balanced,
        reactions,
        free_motions: free,
        seconds,
        mesh,
        space,
    };
    Ok((solved, factors))
}
