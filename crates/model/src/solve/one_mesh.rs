//! One mesh solved: operators, Steklov-Poincaré matrix, supports, contact, energies, reactions.

use std::time::Instant;

use faer::{Col, Mat};
use steklov_bem_operators::{Assembly, Mesh, PairCache, Partition, Relative, Space};
use steklov_contact::ContactBoundary;
use steklov_elastic::{RigidMotion, free_motions};
use steklov_problem::{Multiplier, Scene, Solver};

use crate::data::body_load::Particular;
use crate::data::joints::TiedNode;
use crate::data::on_mesh::OnMesh;
use crate::data::parts::{Assembled, Carried, Piece, pieces};
use crate::data::springs::Springs;
use crate::data::supports::{Held, Supports};
use crate::error::SolveError;
use crate::mesh::layout::MeshedCuts;
use crate::solve::assemble::{Matrices, assemble};
use crate::solve::body::{Body, Factors, Loading};
use crate::solve::contact_solver::solve_problem;
use crate::solve::free_bodies::Loose;
use crate::solve::inclusion::Outside;
use crate::solve::rotations::{missed, orthonormal, project_off, project_off_basis};
use crate::solve::solution::{Seconds, Solved};
use crate::solve::stabilised::{self, StabilisedContact, solve_stabilised};
use crate::solve::thin::without_digits;
use crate::stage::Stage;

/// The particular solutions of body forces, or of the stress far from holes, and the forces S u_p of matrices that the motions of bodies
/// that turn will be taken out of.
fn particular(
    scene: &Scene,
    bodies: &[Assembled],
    (matrices, turning): (&Matrices, &[Vec<RigidMotion>]),
) -> Vec<Option<Particular>> {
    let of = |(k, Assembled { piece, .. }): (usize, &Assembled)| {
        let basis = orthonormal(&nodal(&turning[k], &piece.part.space.points));
        let product = |u: &[f64]| {
            let mut u = u.to_vec();
            project_off_basis(&mut u, &basis);
            let mut forces: Vec<f64> = (matrices.get(k) * Col::from_fn(u.len(), |i| u[i])).iter().copied().collect();
            project_off_basis(&mut forces, &basis);
            forces
        };
        Particular::of_body(scene, piece.body, piece, product)
    };
    bodies.iter().enumerate().map(of).collect()
}

fn nodal(motions: &[RigidMotion], points: &[[f64; 2]]) -> Vec<Vec<f64>> {
    motions.iter().map(|r| r.nodal(points)).collect()
}

/// The kept and held unknowns of the nodes, ties behind supports, and the rows of nodes that face other bodies.
fn partition(
    boundary: Option<&ContactBoundary>,
    supports: &Supports<'_>,
    tied: &[TiedNode],
) -> (Partition, Vec<Relative>) {
    let partition = Partition {
        kept: boundary.map_or(Vec::new(), ContactBoundary::kept),
        held: supports.dofs().into_iter().chain(tied.iter().map(|tied| (tied.dof, tied.jump))).collect(),
        frames: boundary.map_or(Vec::new(), ContactBoundary::frames),
    };
    let of_contact = boundary.iter().flat_map(|boundary| &boundary.rows).map(|row| row.relative.clone());
    (partition, of_contact.chain(tied.iter().map(|tied| tied.relative.clone())).collect())
}

/// The motions of each piece that supports and springs leave free, where it has curves on which nodal values are no rotations.
fn turning(data: &OnMesh<'_>, pieces: &[Piece], (held, springs): (&[Held], &Springs)) -> Vec<Vec<RigidMotion>> {
    let several = pieces.len() > 1;
    let is_cut = several && !data.scene.problem.has_several_bodies();
    let of = |piece: &Piece| {
        let part = &piece.part;
        let held: Vec<Held> = part.nodes.iter().map(|&node| held[node]).collect();
        let of_piece = Supports { space: &part.space, held: &held };
        let resisted = springs.resisted(|e| part.has(e));
        let candidates = match is_cut {
            // of a subdomain all motions, whatever holds the body
            true => free_motions(&part.space.points, &[]),
            false => data.scene.unresisted(piece.body, of_piece.free_motions(resisted)),
        };
        let is_medium = data.scene.problem.bodies[piece.body].far.is_some();
        let turns = !(several && is_medium) && missed(&part.mesh, &part.space, &candidates) > 0.0;
        if turns { candidates } else { Vec::new() }
    };
    pieces.iter().map(of).collect()
}

/// Takes the part of rotations that nodal values miss on curves out of the matrices, so that it does not resist them.
fn release_rotations(bodies: &mut [Assembled], turning: Vec<Vec<RigidMotion>>, matrices: &mut Matrices) {
    let mut is_done = vec![false; matrices.different.len()];
    for ((body, motions), &number) in bodies.iter_mut().zip(turning).zip(&matrices.of) {
        // the motions of a translate are the same
        if !motions.is_empty() && !std::mem::replace(&mut is_done[number], true) {
            project_off(&mut matrices.different[number], &nodal(&motions, &body.piece.part.space.points));
        }
        body.turning = motions;
    }
}

/// Contact with stabilised multipliers; `candidates` are the motions that neither supports nor springs resist.
fn stabilise(
    data: &OnMesh<'_>,
    (body, stiffness): (&Assembled, &Mat<f64>),
    given: &Loading,
    held: &[(usize, f64)],
    candidates: &[RigidMotion],
    loose: &Loose,
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<StabilisedContact, SolveError> {
    let of_stabilised = stabilised::Body {
        traction: &body.traction_map,
        stiffness,
        load: &given.load,
        held,
        rigid: &nodal(candidates, &data.space.points),
        free: &loose.motions,
        particular: given.particular[0].as_ref(),
    };
    solve_stabilised(data, &of_stabilised, observe)
}

/// Adds springs to the matrices; the largest entry of the diagonal without them, if there are any. The rounding error in the
/// resistance of bodies to motions that springs alone hold is taken out first: springs may be softer.
fn add_springs(
    data: &OnMesh<'_>,
    springs: &Springs,
    bodies: &mut [Assembled],
    held: &[Held],
    matrices: &mut [Mat<f64>],
) -> Option<f64> {
    if springs.is_empty() {
        return None;
    }
    let diagonals = matrices.iter().flat_map(|s| (0..s.nrows()).map(|i| s[(i, i)]));
    let largest = diagonals.fold(0.0, f64::max);
    for (Assembled { piece, carried, .. }, matrix) in bodies.iter_mut().zip(matrices) {
        let part = &piece.part;
        if springs.resisted(|e| part.has(e)).is_empty() {
            continue;
        }
        let held: Vec<Held> = part.nodes.iter().map(|&node| held[node]).collect();
        let mut motions = Supports { space: &part.space, held: &held }.free_motions(Vec::new());
        if missed(&part.mesh, &part.space, &motions) > 0.0 {
            // what nodes miss of rotations on curves is strain
            motions.retain(|motion| motion.rotation == 0.0);
        }
        if !motions.is_empty() {
            project_off(matrix, &nodal(&motions, &part.space.points));
        }
        if !motions.is_empty() {
            let pull = |own: &[f64]| {
                let mut all = vec![0.0; data.space.dofs()];
                part.set(&mut all, own);
                part.own(&springs.pull(data.space, data.mesh.len(), &all).base)
            };
            *carried = Some(Carried::new(motions, &part.space.points, largest, pull));
        }
        springs.stiffen(matrix, piece);
    }
    Some(largest)
}

/// Beside more contact unknowns than these a body with cuts keeps the unknowns on cuts, so that the contact problem is sparse: as fast
/// at 300, where 220 more are on cuts, and four times as fast at 2,000.
const MANY: usize = 300;

/// Whether a solver makes use of a sparse contact problem. Systems under Coulomb's law, of Newton's method and of Uzawa's are full, and
/// smaller without the unknowns of cuts.
fn solves_sparse(solver: Solver, boundary: Option<&ContactBoundary>) -> bool {
    let mut conditions = boundary.iter().flat_map(|boundary| &boundary.contact).flat_map(|node| &node.conditions);
    matches!(solver, Solver::Auto | Solver::ActiveSet) && conditions.all(|condition| condition.coefficient == 0.0)
}

/// Solves the scene on a mesh, with cuts into subdomains or as it is; `estimated`: an estimate is to follow. Moments of pairs
/// of elements are taken from `cache` where it has them.
///
/// # Errors
/// Data that are not finite, a free rigid motion that the loads drive, an observer that fails.
pub fn solve(
    scene: &Scene,
    (mesh, cuts): (Mesh, Option<&MeshedCuts>),
    estimated: bool,
    cache: &mut PairCache,
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<(Solved, Body, Factors), SolveError> {
    let clock = Instant::now();
    let mut seconds = Seconds::default();
    cuts.map_or(Ok(()), |cuts| cuts.check(scene)).map_err(Box::new)?;
    observe(Stage::Progress("loads and supports", 0.0))?;
    let space = Space::new(&mesh);
    let data = OnMesh { scene, mesh: &mesh, space: &space };
    let (pieces, on_cuts) = pieces(&scene.problem, &mesh, &space, cuts);
    let points: Vec<[f64; 2]> = space.points.iter().chain(&on_cuts.points).copied().collect();
    let mut held = data.held()?;
    held.resize(points.len(), Held::default());
    let loads = data.load()?;
    let springs = data.springs()?;
    let turning = turning(&data, &pieces, (&held, &springs));
    let turns = |e: usize| pieces.iter().zip(&turning).any(|(piece, motions)| !motions.is_empty() && piece.part.has(e));
    let joints = data.joints(turns)?;
    let boundary = data.condensed_contact(&held, &joints)?;
    let tied = data.tied_nodes(&joints, &held, boundary.as_ref())?;
    seconds.set_up = clock.elapsed().as_secs_f64();

    let (mut matrices, mut bodies) = assemble(&data, pieces, estimated, cache, &mut seconds, observe)?;
    let clock = Instant::now();
    let outside = Outside::new(&data, estimated, cache)?;
    if let Some(outside) = &outside {
        outside.stiffen(&mut matrices.different[0]);
    }
    for k in 0..bodies.len() {
        observe(Stage::Steklov(k, matrices.get(k)))?;
    }
    let particular = particular(scene, &bodies, (&matrices, &turning));
    let largest_diagonal = add_springs(&data, &springs, &mut bodies, &held, &mut matrices.different);
    let supports = Supports { space: &space, held: &held };
    let mut values = supports.values();
    values.extend(tied.iter().map(|tied| tied.jump));
    let mut given = Loading::new(loads, particular, boundary, values, &bodies);
    if let Some(outside) = &outside {
        given.load.iter_mut().zip(&outside.load).for_each(|(f, jump)| *f += jump);
    }

    observe(Stage::Progress("condensation", 0.75))?;
    release_rotations(&mut bodies, turning, &mut matrices);
    let (free, loose) = data.unresisted_motions((&bodies, &points), (&joints, &tied), (&held, &springs), &mut given)?;
    let (partition, rows) = partition(given.boundary.as_ref(), &supports, &tied);
    if given.boundary.is_some() && scene.method.multiplier == Multiplier::Stabilised {
        let candidates = scene.unresisted(0, supports.free_motions(springs.resisted(|_| true)));
        let of_body = (&bodies[0], matrices.get(0));
        given.stabilised = Some(stabilise(&data, of_body, &given, &partition.held, &candidates, &loose, observe)?);
    }
    let Matrices { different, of } = matrices;
    let nodes = bodies.iter().map(|body| body.piece.part.nodes.clone());
    let of_bodies: Vec<(usize, Vec<usize>)> = of.into_iter().zip(nodes).collect();
    let is_held = loose.motions.is_empty() && loose.rotations.is_empty() && rows.is_empty();
    let is_sparse = partition.kept.len() > MANY && cuts.is_some() && is_held && scene.random.is_none();
    let condensation = match is_sparse && solves_sparse(scene.method.solver, given.boundary.as_ref()) {
        true => Assembly::of_blocks(different, &of_bodies, &partition),
        false => Assembly::new(different, &of_bodies, &partition, &rows, &loose.motions, &loose.rotations),
    };
    let condensation = condensation.map_err(|error| without_digits(error, &scene.problem, &bodies))?;
    seconds.factorise += clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    observe(Stage::Progress("contact", 0.95))?;
    let stiffness = if given.boundary.is_some() { condensation.stiffness()? } else { Mat::new().into() };
    let largest_diagonal = largest_diagonal.unwrap_or_else(|| condensation.largest_diagonal());
    let mut body = Body {
        elements: mesh.len() + on_cuts.part.len(),
        mesh,
        space,
        points,
        cuts: cuts.map(|cuts| cuts.cuts.clone()).filter(|cuts| cuts.count() > 1),
        pieces: bodies,
        condensation,
        outside,
        stiffness,
        joints,
        tied,
        held,
        springs,
        largest_diagonal,
        free,
        loose,
    };
    let (mut solved, factors) =
        body.answer(scene, given, &mut |problem| solve_problem(problem, scene.method.solver))?;
    if scene.random.is_none() {
        // the contact problem has its own
        body.stiffness = Mat::new().into();
    }
    seconds.solve = clock.elapsed().as_secs_f64();
    solved.seconds = seconds;
    Ok((solved, body, factors))
}
