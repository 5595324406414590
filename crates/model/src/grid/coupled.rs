//! A grid in an unbounded medium: finite elements inside, boundary elements around them.

use std::sync::{Mutex, OnceLock};
use std::time::Instant;

use steklov_bem_operators::{Datum, Mesh, Site};
use steklov_contact::oscillation;
use steklov_coupling::{
    Coupled, CouplingError, Factored, Form, InterfaceIndicators, Interior, Jumps, Medium, Transmission,
};
use steklov_elastic::Material;
use steklov_elastic::plane::{distance, dot, minus};
use steklov_msfem::{Bases, CoarseMesh, Extra, HeterogeneousBody, Loads, Multiscale};
use steklov_problem::{Scene, Surroundings};

use super::cells::basis;
use super::dual_solutions::{Equations, Factors};
use super::in_medium::InMedium;
use super::layout::GridLayout;
use super::solution::{CoarseSolved, GridSolved};
use super::solve::Unestimated;
use super::trace::{GridTrace, node_at};
use crate::data::supports::Held;
use crate::energies::Energies;
use crate::error::SolveError;
use crate::solve::equilibrium::UNBALANCED;
use crate::solve::medium::Around;
use crate::solve::solution::Seconds;
use crate::stage::{Stage, watched};

/// Parts of the solution that both kinds of elements have.
struct Joined {
    exterior: Medium,
    coupled: Coupled,
    factored: Factored,
    /// How far the forces are out of balance.
    imbalance: f64,
    seconds: Seconds,
}

/// The body of a solution.
struct Inner {
    body: HeterogeneousBody,
    trace: GridTrace,
    /// Displacement of the fine nodes, and of the nodes of the trace.
    displacement: Vec<f64>,
    boundary_displacement: Vec<f64>,
    coarse: Option<(CoarseSolved, Bases)>,
    dofs: usize,
}

/// Solves the scene on a grid and in the medium around it.
///
/// # Errors
/// Those of [`Transmission`] and of the multiscale bases; an observer that fails.
pub(super) fn solve_coupled(
    scene: &Scene,
    medium: Surroundings<'_>,
    body: HeterogeneousBody,
    fine: GridTrace,
    loads: &Loads,
    layout: &GridLayout,
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<Unestimated, SolveError> {
    let (grid, clock) = (&body.grid, Instant::now());
    let Some(cells) = &layout.coarse else {
        observe(Stage::Progress("assembling K", 0.05))?;
        let interior = Interior::fine(&body, loads)?;
        observe(Stage::Stiffness("K", "node of the fine grid", &interior.stiffness, &interior.load))?;
        let assemble = clock.elapsed().as_secs_f64();
        let mut joined = join(scene, medium, interior, layout, observe)?;
        joined.seconds.assemble += assemble;
        let displacement = joined.coupled.displacement.clone();
        let at_boundary: Vec<usize> = fine.lattice.iter().map(|&p| node_at(grid, p)).collect();
        let boundary_displacement =
            at_boundary.iter().flat_map(|n| [displacement[2 * n], displacement[2 * n + 1]]).collect();
        let dofs = grid.dofs();
        let inner = Inner { body, trace: fine, displacement, boundary_displacement, coarse: None, dofs };
        return solved(scene, medium, loads, joined, inner);
    };
    let basis = basis(scene);
    let mut problem = Multiscale::new(&body, CoarseMesh::new(grid, cells.clone())?, basis)?;
    let interior = watched("bases of coarse cells", [0.05, 0.4], observe, |go_on| -> Result<_, CouplingError> {
        Interior::coarse(&mut problem, loads, go_on)
    })?;
    observe(Stage::Stiffness("K_H", "coarse vertex that does not hang", &interior.stiffness, &interior.load))?;
    observe(Stage::Basis(&problem))?;
    let assemble = clock.elapsed().as_secs_f64();
    let mut joined = join(scene, medium, interior, layout, observe)?;
    joined.seconds.assemble += assemble;
    let clock = Instant::now();
    let bubbles = !loads.body.is_empty() && basis != steklov_msfem::Basis::Q1;
    let extra = Extra { bubbles, lift: Vec::new() };
    let displacement = watched("fine displacements", [0.7, 0.9], observe, |go_on| {
        problem.downscale(&joined.coupled.displacement, loads, &extra, go_on)
    })?;
    joined.seconds.solve += clock.elapsed().as_secs_f64();
    let vertices = problem.vertex_displacement(&joined.coupled.displacement);
    let vertex_at = |p: [usize; 2]| problem.mesh.vertices.binary_search_by_key(&[p[1], p[0]], |v| [v[1], v[0]]).ok();
    let trace = GridTrace::new(scene, grid, |p| vertex_at(p).is_some())?;
    let on_boundary = trace.lattice.iter().map(|&p| vertex_at(p).map_or([f64::NAN; 2], |v| vertices[v]));
    let boundary_displacement = on_boundary.flatten().collect();
    let (patterns, dofs) = (problem.patterns(), problem.dofs());
    let (mesh, bases) = problem.into_bases();
    let coarse = CoarseSolved { mesh, basis, displacement: vertices, bubbles, patterns, lift: Vec::new() };
    let coarse = Some((coarse, bases));
    let inner = Inner { body, trace, displacement, boundary_displacement, coarse, dofs };
    solved(scene, medium, loads, joined, inner)
}

/// Boundary elements on the trace of the body, and the solution on the interface.
fn join(
    scene: &Scene,
    medium: Surroundings<'_>,
    interior: Interior,
    layout: &GridLayout,
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<Joined, SolveError> {
    let clock = Instant::now();
    observe(Stage::Progress("assembling V, K, W", 0.4))?;
    let mesh = boundary_mesh(scene, layout, &interior)?;
    let exterior = Medium::new(mesh, medium.material, None)?;
    observe(Stage::Medium(&exterior.operators))?;
    let jump = exterior.space.interpolate(|x| jump_at(scene, x));
    let assemble = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    observe(Stage::Progress("factorisation", 0.5))?;
    let trace = interior.trace.clone();
    let problem = Transmission::new(interior, &exterior)?;
    observe(Stage::Interface(&trace, &problem.transfer))?;
    observe(Stage::Condensed("A_interface", "unknown of the trace beside this matrix", &problem.stiffness))?;
    let factorise = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    observe(Stage::Progress("interface", 0.6))?;
    // the two-field form, its tractions eliminated
    let factor = problem.factor()?;
    let coupled = problem.solve_with(&factor, &jump, medium.radiation)?;
    let imbalance = problem.imbalance(&coupled);
    let factored = problem.into_factored(factor);
    let seconds = Seconds { assemble, factorise, solve: clock.elapsed().as_secs_f64(), ..Seconds::default() };
    Ok(Joined { exterior, coupled, factored, imbalance, seconds })
}

/// The boundary elements of a layout: those between the points of the trace, or as many as the scene asks for, cut where
/// earlier steps have cut them.
fn boundary_mesh(scene: &Scene, layout: &GridLayout, interior: &Interior) -> Result<Mesh, SolveError> {
    let degree = scene.method.degree;
    Ok(match (&layout.around, scene.method.elements.is_some()) {
        (Some(mesh), true) => mesh.clone(),
        (Some(mesh), false) => interior.trace.mesh_with(mesh)?,
        (None, true) => Mesh::uniform(&interior.trace.polygon, scene.method.elements(), degree),
        (None, false) => interior.trace.mesh(1, degree)?,
    })
}

/// The edge of the interface next to a point, and its parameter there.
fn on_interface(scene: &Scene, x: [f64; 2]) -> (usize, f64) {
    let place = |(k, edge): (usize, &steklov_bem_operators::Edge)| {
        let ([a, b], length) = (edge.listed(), edge.length());
        let along = dot(minus(x, a), minus(b, a)) / (length * length);
        let s = along.clamp(0.0, 1.0);
        let y = edge.point(s);
        (distance(x, y), k, s)
    };
    let nearest = scene.interface().map(place).min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map_or((0, 0.0), |(_, k, s)| (k, s))
}

/// u0 at a point of the interface.
pub(super) fn jump_at(scene: &Scene, x: [f64; 2]) -> [f64; 2] {
    let (edge, s) = on_interface(scene, x);
    scene.displacement_jump(edge, s)
}

/// The solution of body and medium, their energies and the residuals of the equations between them.
fn solved(
    scene: &Scene,
    medium: Surroundings<'_>,
    loads: &Loads,
    joined: Joined,
    inner: Inner,
) -> Result<Unestimated, SolveError> {
    let Joined { exterior, coupled, factored, imbalance, seconds } = joined;
    let Inner { body, trace, displacement, boundary_displacement, coarse, dofs } = inner;
    let load_work = loads.nodal(&body).iter().zip(&displacement).map(|(f, u)| f * u).sum();
    let strain = body.energy(&displacement, &displacement) / 2.0 + exterior.energy(&coupled);
    let clock = Instant::now();
    let jumps = Jumps {
        displacement: &|x| jump_at(scene, x),
        traction: &|x, n| {
            let (edge, s) = on_interface(scene, x);
            scene.traction_jump(edge, s, n)
        },
        halvings: 0,
    };
    let jump_oscillation = jump_oscillation(scene, medium, &body, &exterior)?;
    let interface = InterfaceIndicators::new(&exterior, &body, &displacement, &coupled, Form::Schur, &jumps)?;
    let estimate_seconds = clock.elapsed().as_secs_f64();
    let (coarse, bases) = coarse.unzip();
    let around =
        Around::new(medium, exterior.mesh.clone(), exterior.space.clone(), exterior.operators.length, &coupled);
    let (is_held, free) = (vec![false; body.grid.dofs()], vec![Held::default(); trace.space.nodes()]);
    let solved = GridSolved {
        dofs,
        energies: Energies { total: strain - load_work, strain, springs: 0.0, load_work, friction_work: 0.0 },
        boundary_displacement,
        displacement,
        contact: None,
        balanced: imbalance <= UNBALANCED,
        reactions: Vec::new(),
        over_outcomes: None,
        works: Vec::new(),
        free_motions: Vec::new(),
        estimate: None,
        seconds,
        estimate_seconds,
        coarse,
        trace,
        body,
        around: Some(around),
        interface: Some(interface),
        jump_oscillation,
        dual_data: Mutex::default(),
        quantities: OnceLock::new(),
    };
    let equations = Equations::InMedium(Box::new(InMedium { exterior, coupled, factored }));
    let factors = Some(Factors { equations, coarse: bases.map(|bases| (bases, free)) });
    Ok(Unestimated { solved, is_held, factors })
}

/// The part of the jump of the displacement that the nodes of each boundary element miss, as an energy: both sides give way to
/// it.
fn jump_oscillation(
    scene: &Scene,
    medium: Surroundings<'_>,
    body: &HeterogeneousBody,
    exterior: &Medium,
) -> Result<Vec<f64>, SolveError> {
    let (mesh, space) = (&exterior.mesh, &exterior.space);
    let mut energies = vec![0.0; mesh.len()];
    let around = medium.material.plane_modulus();
    let plane_modulus = |cell: usize| {
        let poisson = body.elasticity_of(cell).poisson;
        Material { young: body.young[cell], poisson, ..scene.body().material() }.plane_modulus()
    };
    for expression in medium.tie.displacement_jump.iter().flatten().filter(|jump| jump.constant().is_none()) {
        let value = |site: &Site| {
            let s = on_interface(scene, site.point).1;
            expression.eval(site.point[0], site.point[1], s)
        };
        let datum = Datum { name: "displacement jump", value: &value, kinks: &|_| Vec::new(), rounding: None };
        for (e, energy) in energies.iter_mut().enumerate() {
            let ([x, y], [nx, ny], within) = (mesh.point(e, 0.0), mesh.normal(e, 0.0), 1e-6 * mesh.length(e));
            let cell = body.grid.locate([x - within * nx, y - within * ny]);
            let body = cell.map_or(around, |(cell, _)| plane_modulus(cell));
            *energy += oscillation(mesh, space, e, &datum)? / (2.0 * (1.0 / body + 1.0 / around));
        }
    }
    Ok(energies)
}
