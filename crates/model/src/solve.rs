//! One mesh solved: operators, Steklov-Poincaré matrix, supports, contact, energies, reactions.

use std::time::Instant;

use faer::{Col, Mat};
use steklov_bem_operators::{Condensation, Mesh, PairCache, Partition, Space, Steklov};
use steklov_contact::ContactBoundary;
use steklov_elastic::RigidMotion;
use steklov_problem::{Multiplier, Scene};

use crate::assemble::operators;
use crate::body::{Body, Factors, Given};
use crate::body_load::Particular;
use crate::contact::solve_problem;
use crate::data::Data;
use crate::error::SolveError;
use crate::inclusion::Outside;
use crate::motions::unresisted;
use crate::solution::{Seconds, Solved};
use crate::stabilised::{self, solve_stabilised};
use crate::stage::Stage;
use crate::supports::Supports;

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
