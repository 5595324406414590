//! One mesh solved: operators, Steklov-Poincaré matrix, supports, contact, energies, reactions.

use std::time::Instant;

use faer::Mat;
use steklov_bem_operators::{
    BemError, BodyForce, BoundaryField, Condensation, Datum, Domain, Mesh, Operators, Partition, RigidMotion, Site, Space,
    Steklov, add_load, free_motions, side_moments,
};
use steklov_contact::{
    ContactBoundary, ContactError, Kkt, Outcome, Problem, SideData, Solution, active_set, contact_boundary, kkt, newton,
    resisted_motions, uzawa,
};

use crate::expression::Expression;
use crate::scene::{Condition, Friction, Scene, SceneError, Solver};

/// What a run hands to its observer while it has it.
pub enum Stage<'a> {
    /// V, K, W, M and the space they belong to.
    Operators(&'a Operators),
    /// S.
    Steklov(&'a Mat<f64>),
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

/// Contact on the solved mesh.
#[derive(Debug, Clone)]
pub struct ContactResult {
    /// Nodes and conditions.
    pub boundary: ContactBoundary,
    /// The condensed problem's nodes are those of `boundary`; the solver's answer.
    pub solution: Solution,
    /// The judge's measures; equilibrium over all unknowns of the body.
    pub audit: Kkt,
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
    /// Largest residual of equilibrium at unknowns without contact over the scale of forces.
    pub equilibrium: f64,
    /// Force of the support or obstacle on the body for each held or contacting side.
    pub reactions: Vec<(String, [f64; 2])>,
    /// Rigid motions that nothing resists and no load drives; the displacement has none of them.
    pub free_motions: Vec<RigidMotion>,
    /// Wall seconds.
    pub seconds: Seconds,
}

/// Solves the scene on a mesh.
///
/// # Errors
/// Data that are not finite, a free rigid motion that the loads drive, an observer that fails.
pub fn solve(scene: &Scene, mesh: Mesh, observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>) -> Result<Solved, SolveError> {
    let clock = Instant::now();
    let mut seconds = Seconds::default();
    observe(Stage::Progress("loads and supports", 0.0))?;
    let space = Space::new(&mesh);
    let data = Data { scene, mesh: &mesh, space: &space };
    let held = data.held()?;
    let tractions = data.load()?;
    let boundary = data.contact(&held)?;
    seconds.set_up = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    observe(Stage::Progress("assembling V, K, W", 0.05))?;
    let operators = Operators::assemble(&mesh, &space, &scene.material, None)?;
    let length = operators.length;
    seconds.assemble = clock.elapsed().as_secs_f64();
    observe(Stage::Operators(&operators))?;

    let clock = Instant::now();
    observe(Stage::Progress("Steklov-Poincaré matrix", 0.3))?;
    let Steklov { matrix, traction: traction_map } = Steklov::new(operators, Domain::Interior)?;
    observe(Stage::Steklov(&matrix))?;
    let body_force = scene.body_force.map(|b| BodyForce::new(b, scene.polygon.centroid(), &scene.material));
    let particular = body_force.map(|b| Particular::new(&b, &mesh, &space, &matrix));
    let mut load = tractions.clone();
    if let Some(p) = &particular {
        load.iter_mut().zip(&p.load).for_each(|(f, p)| *f += p);
    }

    observe(Stage::Progress("condensation", 0.75))?;
    let supports = Supports { space: &space, held: &held };
    let candidates = supports.free_motions();
    let free = match &boundary {
        None => balanced(&space, &load, &candidates)?,
        Some(boundary) => resisted_motions(boundary, &candidates, |r| work(&space, &load, r))?,
    };
    let partition = Partition {
        kept: boundary.as_ref().map_or(Vec::new(), ContactBoundary::unknowns),
        held: supports.dofs(),
        frames: boundary.as_ref().map_or(Vec::new(), ContactBoundary::frames),
    };
    let motions: Vec<Vec<f64>> = free.iter().map(|r| r.nodal(&space.points)).collect();
    let condensation = Condensation::new(matrix, &partition, &motions)?;
    let condensed = condensation.load(&load);
    seconds.factorise = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    observe(Stage::Progress("contact", 0.95))?;
    let (displacement, contact) = match boundary {
        None => (condensation.expand(&condensed, &[]), None),
        Some(boundary) => {
            let problem =
                Problem { stiffness: condensation.stiffness(), load: condensed.kept.clone(), nodes: boundary.nodes() };
            let solution = match scene.method.solver {
                Solver::Newton => newton(&problem, None)?,
                Solver::ActiveSet => active_set(&problem, None)?,
                Solver::Uzawa => uzawa(&problem, None, None)?,
            };
            let audit = kkt(&problem, &solution);
            let displacement = condensation.expand(&condensed, &solution.displacement);
            (displacement, Some(ContactResult { boundary, solution, audit }))
        }
    };
    let forces = condensation.multiply(&displacement);
    let mut residual: Vec<f64> = forces.iter().zip(&load).map(|(s, f)| s - f).collect();
    let contact_forces = contact.as_ref().map(|c| c.boundary.nodal_forces(&c.solution.multipliers, space.nodes()));
    if let Some(lambda) = &contact_forces {
        residual.iter_mut().zip(lambda).for_each(|(r, l)| *r += l);
    }
    let equilibrium = supports.equilibrium(&residual, &forces, &load);
    let contact = contact.map(|mut c| {
        c.audit.equilibrium = c.audit.equilibrium.max(equilibrium);
        c
    });

    let homogeneous: Vec<f64> = match &particular {
        None => displacement.clone(),
        Some(p) => displacement.iter().zip(&p.displacement).map(|(u, p)| u - p).collect(),
    };
    let traction = traction_map.apply(&homogeneous);
    let field = BoundaryField::new(&mesh, &space, &scene.material, &homogeneous, &traction, length);
    let friction_work = contact.as_ref().map_or(0.0, |c| c.boundary.friction_work(&displacement));
    let energies = energies(&displacement, &homogeneous, &forces, &tractions, &load, particular.as_ref(), friction_work);
    let mut reactions = supports.reactions(&residual, &mesh, &scene.sides, |e, j| {
        data.traction_moment(&field, body_force.as_ref(), e, j)
    });
    if let Some(c) = &contact {
        for (side, force) in c.boundary.resultants(&c.solution.multipliers) {
            reactions.push((side, force.map(|f| -f)));
        }
    }
    reactions.sort_by_key(|r| r.0);
    let reactions = reactions.into_iter().map(|(side, force)| (mesh.side_names[side].clone(), force)).collect();
    seconds.solve = clock.elapsed().as_secs_f64();
    Ok(Solved {
        displacement,
        field,
        body_force,
        energies,
        contact,
        equilibrium,
        reactions,
        free_motions: free,
        seconds,
        mesh,
        space,
    })
}
