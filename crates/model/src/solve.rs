//! One mesh solved: operators, Steklov-Poincaré matrix, supports, contact, energies, reactions.

use std::time::Instant;

use faer::{Col, Mat};
use sprs::CsMat;
use steklov_bem_operators::{
    BemError, BoundaryField, Condensation, Mesh, Operators, PairCache, ParticularSolution, Partition, Space, Steklov,
};
use steklov_contact::{ContactBoundary, ContactError};
use steklov_coupling::{Trace, Transfer};
use steklov_elastic::{Material, RigidMotion};
use steklov_problem::{DataError, Multiplier, Scene};

use crate::around::Around;
use crate::body::{Body, Factors, Given};
use crate::body_load::Particular;
use crate::contact::{ContactResult, solve_problem};
use crate::data::Data;
use crate::grid::{GridSolved, OnGrid};
use crate::inclusion::Outside;
use crate::motions::unresisted;
use crate::run::Step;
use crate::stabilised::{self, solve_stabilised};
use crate::supports::Supports;

/// What a run hands to its observer while it has it.
pub enum Stage<'a> {
    /// V, K, W, M and the space they belong to.
    Operators(&'a Operators),
    /// S.
    Steklov(&'a Mat<f64>),
    /// A sparse stiffness matrix: its name and what its unknowns 2·n + component are numbered by.
    Stiffness(&'static str, &'static str, &'a CsMat<f64>),
    /// V, K, W, M of the medium around a body.
    Medium(&'a Operators),
    /// The trace of a body on the interface with the medium, and what takes it to the boundary elements there.
    Interface(&'a Trace, &'a Transfer),
    /// A stiffness matrix reduced to some unknowns: its name and what these are.
    Condensed(&'static str, &'static str, &'a Mat<f64>),
    /// A step is solved and estimated, so many seconds after the run began.
    Step {
        /// The solution.
        solved: &'a Solved,
        /// What is kept of it.
        step: &'a Step,
        /// Wall seconds.
        seconds: f64,
    },
    /// The same on a grid.
    GridStep {
        /// The solution.
        solved: &'a GridSolved,
        /// What is kept of it.
        step: &'a Step<OnGrid>,
        /// Wall seconds.
        seconds: f64,
    },
    /// A part of the work begins; the number is its share of the work of the step that is then done, 0 to 1.
    Progress(&'static str, f64),
}

/// Why a run stopped without a result.
#[derive(Debug, thiserror::Error)]
pub enum SolveError {
    /// The scene's data cannot be used.
    #[error(transparent)]
    Data(#[from] Box<DataError>),
    /// The boundary element part failed.
    #[error(transparent)]
    Bem(#[from] BemError),
    /// The contact part failed.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// The finite element part failed.
    #[error(transparent)]
    Msfem(Box<steklov_msfem::MsfemError>),
    /// Body and medium could not be joined.
    #[error(transparent)]
    Coupling(Box<steklov_coupling::CouplingError>),
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
    /// The random input cannot be treated.
    #[error(transparent)]
    Stochastic(#[from] steklov_stochastic::StochasticError),
    /// An outcome of the random input has no solution.
    #[error("for {outcome}: {error}")]
    Outcome {
        /// Its germs.
        outcome: String,
        /// What is wrong.
        error: Box<SolveError>,
    },
    /// The observer failed, as in storing what it was given.
    #[error(transparent)]
    Observer(Box<dyn std::error::Error + Send + Sync>),
    /// The user stopped the run.
    #[error("interrupted before a step was finished: nothing was stored")]
    Interrupted,
}

impl From<DataError> for SolveError {
    fn from(error: DataError) -> Self {
        Self::Data(Box::new(error))
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

/// J = strain energy - load work + friction work. In an unbounded body under remote stress these are the energies of
/// u_c = u - ε_∞ x, J = ½⟨S u_c, u_c⟩ - ⟨t - σ_∞n, u_c⟩ + friction work: those of u are infinite.
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
    /// The elastic field without the particular solution.
    pub field: BoundaryField,
    /// The particular solution of the body force or of the remote stress.
    pub particular: Option<ParticularSolution>,
    /// Energies.
    pub energies: Energies,
    /// The medium around the body, if there is one.
    pub around: Option<Around>,
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

/// V, K, W of a mesh; `estimated`: what an estimate needs besides is kept in `cache`.
pub(crate) fn operators(
    (mesh, space): (&Mesh, &Space),
    material: &Material,
    estimated: bool,
    cache: &mut PairCache,
) -> Result<Operators, BemError> {
    match estimated {
        true => Operators::to_enrich(mesh, space, material, None, cache),
        false => Operators::assemble(mesh, space, material, None),
    }
}

/// The particular solution of the body force, or of the stress far from a hole, and the forces S u_p.
fn particular(data: &Data<'_>, matrix: &Mat<f64>) -> Option<Particular> {
    let Data { scene, mesh, space } = *data;
    let held = |e: usize, i: usize| scene.body().sides[mesh.side[e]].holds(i);
    let product = |u: &[f64]| (matrix * Col::from_fn(u.len(), |i| u[i])).iter().copied().collect();
    let solution = scene.particular_solution(1.0)?;
    Some(Particular::new(solution, scene.is_cavity(), mesh, space, held, product))
}

/// Solves the scene on a mesh; `estimated`: an estimate is to follow. Moments of pairs of elements are taken from `cache` where
/// it has them.
///
/// # Errors
/// Data that are not finite, a free rigid motion that the loads drive, an observer that fails.
pub fn solve(
    scene: &Scene,
    mesh: Mesh,
    estimated: bool,
    cache: &mut PairCache,
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<(Solved, Body, Factors), SolveError> {
    let clock = Instant::now();
    let mut seconds = Seconds::default();
    observe(Stage::Progress("loads and supports", 0.0))?;
    let space = Space::new(&mesh);
    let data = Data { scene, mesh: &mesh, space: &space };
    let held = data.held()?;
    let loads = data.load()?;
    let boundary = data.condensed_contact(&held)?;
    seconds.set_up = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    observe(Stage::Progress("assembling V, K, W", 0.05))?;
    let operators = operators((&mesh, &space), &scene.body().material(), estimated, cache)?;
    let length = operators.length;
    seconds.assemble = clock.elapsed().as_secs_f64();
    observe(Stage::Operators(&operators))?;

    let clock = Instant::now();
    observe(Stage::Progress("Steklov-Poincaré matrix", 0.3))?;
    let Steklov { mut matrix, traction: traction_map } = Steklov::new(operators, scene.domain())?;
    let outside = Outside::new(&data, estimated, cache)?;
    if let Some(outside) = &outside {
        outside.stiffen(&mut matrix);
    }
    observe(Stage::Steklov(&matrix))?;
    let particular = particular(&data, &matrix);
    let supports = Supports { space: &space, held: &held };
    let mut given = Given::new(loads, particular, boundary, supports.values(), &mesh, &space);
    let jump = outside.iter().flat_map(|outside| &outside.load);
    given.load.iter_mut().zip(jump).for_each(|(f, jump)| *f += jump);

    observe(Stage::Progress("condensation", 0.75))?;
    let candidates = scene.unresisted(supports.free_motions());
    let free = unresisted((&space.points, &given.load), given.boundary.as_ref(), &candidates)?;
    let partition = Partition {
        kept: given.boundary.as_ref().map_or(Vec::new(), ContactBoundary::kept),
        held: supports.dofs(),
        frames: given.boundary.as_ref().map_or(Vec::new(), ContactBoundary::frames),
    };
    let nodal = |motions: &[RigidMotion]| -> Vec<Vec<f64>> { motions.iter().map(|r| r.nodal(&space.points)).collect() };
    let motions = nodal(&free);
    let of_stabilised = stabilised::Body {
        traction: &traction_map,
        stiffness: &matrix,
        load: &given.load,
        held: &partition.held,
        rigid: &nodal(&candidates),
        free: &motions,
        particular: given.particular.as_ref(),
    };
    let wanted = given.boundary.is_some() && scene.method.multiplier == Multiplier::Stabilised;
    let stabilised = wanted.then(|| solve_stabilised(&data, &of_stabilised)).transpose()?;
    let condensation = Condensation::new(matrix, &partition, &motions)?;
    seconds.factorise = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    observe(Stage::Progress("contact", 0.95))?;
    let stiffness = if given.boundary.is_some() { condensation.stiffness() } else { Mat::new() };
    let material = scene.body().material();
    let mut body = Body { mesh, space, material, length, condensation, outside, stiffness, traction_map, held, free };
    given.stabilised = stabilised;
    let (mut solved, factors) =
        body.answer(scene, given, &mut |problem| solve_problem(problem, scene.method.solver))?;
    if scene.random.is_none() {
        // the contact problem has its own
        body.stiffness = Mat::new();
    }
    seconds.solve = clock.elapsed().as_secs_f64();
    solved.seconds = seconds;
    Ok((solved, body, factors))
}
