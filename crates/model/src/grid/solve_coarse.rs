//! Multiscale elements on the coarse cells of a grid, solved.

use std::sync::{Mutex, OnceLock};
use std::time::Instant;

use steklov_algebra::dot;
use steklov_elastic::RigidMotion;
use steklov_msfem::{Basis, CoarseCell, CoarseMesh, Extra, Grid, HeterogeneousBody, Loads, MsfemError, Multiscale};
use steklov_problem::{QuantityKind, Scene};

use super::cells::basis;
use super::dual_solutions::{Equations, Factors, Supported};
use super::solution::{CoarseSolved, GridSolved};
use super::solve::{Unestimated, at_nodes, energies, held_unknowns, moment, on_boundary};
use super::system::{System, without_motions};
use super::trace::{GridTrace, node_at};
use crate::data::on_mesh::OnMesh;
use crate::data::supports::Held;
use crate::error::SolveError;
use crate::solve::solution::Seconds;
use crate::stage::{Stage, watched};

/// Multiscale elements on coarse cells.
pub(super) fn solve_coarse(
    scene: &Scene,
    body: HeterogeneousBody,
    fine: &GridTrace,
    loads: &Loads,
    cells: Vec<CoarseCell>,
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<Unestimated, SolveError> {
    let clock = Instant::now();
    let grid = &body.grid;
    let mesh = CoarseMesh::new(grid, cells)?;
    let basis = basis(scene);
    let mut problem = Multiscale::new(&body, mesh, basis)?;
    let (trace, at_boundary) = coarse_trace(scene, &problem)?;
    let (held, boundary) = on_boundary(scene, &trace)?;
    let fine_held = OnMesh { scene, mesh: &fine.mesh, space: &fine.space }.held()?;
    let lift = lift(&problem, fine, &fine_held, &trace, &held);
    let extra = Extra { bubbles: !loads.body.is_empty() && basis != Basis::Q1 && basis.is_conforming(), lift };
    let set_up = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    let system = coarse_system(&mut problem, loads, &extra, at_boundary, observe)?;
    let assemble = clock.elapsed().as_secs_f64();
    observe(Stage::Stiffness("K_H", "coarse vertex that does not hang", &system.stiffness, &system.load))?;
    observe(Stage::Basis(&problem))?;

    let clock = Instant::now();
    let at_boundary = system.at_boundary.clone();
    let traction = |u: &[f64], e: usize, end: usize| corner_moment(&problem, &trace, u, e, end);
    let answer = system.solve(scene, &trace, &held, boundary, &traction, observe)?;
    let factorise = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    let mut displacement = watched("fine displacements", [0.6, 0.9], observe, |go_on| {
        problem.downscale(&answer.displacement, loads, &extra, go_on)
    })?;
    let works = works(scene, &problem, (&displacement, loads), &answer.works, [(fine, &fine_held), (&trace, &held)])?;
    let (strain, load_work) = field_energies(&problem, &displacement, &answer.displacement, loads, &extra)?;
    let solve = clock.elapsed().as_secs_f64();
    let is_held = held_unknowns(grid, fine, &fine_held);
    let (dofs, patterns) = (problem.dofs(), problem.patterns());
    let mut vertices = problem.vertex_displacement(&answer.displacement).into_flattened();
    let (mesh, bases) = problem.into_bases();
    let mut boundary_displacement = at_nodes(&answer.displacement, &at_boundary);
    let (at_vertices, on_trace) = ((&mut vertices[..], &mesh.vertices[..]), (&mut boundary_displacement[..], &trace));
    without_free_motions(grid, &mut displacement, at_vertices, on_trace, &answer.free_motions);
    let solved = GridSolved {
        dofs,
        energies: energies(&answer, strain, load_work),
        boundary_displacement,
        displacement,
        contact: answer.contact,
        balanced: answer.balanced,
        reactions: answer.reactions,
        over_outcomes: None,
        works,
        free_motions: answer.free_motions,
        estimate: None,
        seconds: Seconds { set_up, assemble, factorise, solve, enrich: 0.0 },
        estimate_seconds: 0.0,
        coarse: Some(CoarseSolved {
            mesh,
            basis,
            displacement: vertices.chunks_exact(2).map(|u| [u[0], u[1]]).collect(),
            bubbles: extra.bubbles,
            patterns,
            lift: extra.lift,
        }),
        trace,
        body,
        around: None,
        interface: None,
        jump_oscillation: Vec::new(),
        dual_data: Mutex::default(),
        quantities: OnceLock::new(),
    };
    let (elimination, contact) = (answer.elimination, answer.condensed);
    let equations = Equations::Supported(Box::new(Supported { elimination, contact, held: fine_held }));
    let factors = Some(Factors { equations, coarse: Some((bases, held)) });
    Ok(Unestimated { solved, is_held, factors })
}

/// Two supports at a corner part its force by the mean stress of the coarse cell there: its moment on element e against one end.
fn corner_moment(problem: &Multiscale<'_>, trace: &GridTrace, u: &[f64], e: usize, end: usize) -> [f64; 2] {
    let (grid, points) = (&problem.body.grid, trace.points(e));
    let side = if end == 0 { [points[0], points[1]] } else { [points[points.len() - 2], points[points.len() - 1]] };
    let stress = mean_stress(problem, grid, grid.cell(trace.side(grid, side).0), u);
    stress.map_or([0.0; 2], |stress| moment(stress, trace, e))
}

/// Mean stress of the coarse cell around a fine one: its homogenised tensor times the strain in its middle.
fn mean_stress(problem: &Multiscale<'_>, grid: &Grid, [ix, iy]: [usize; 2], u: &[f64]) -> Option<[f64; 3]> {
    let around = |c: &CoarseCell| (0..2).all(|k| (c.first[k]..c.first[k] + c.size[k]).contains(&[ix, iy][k]));
    let cell = problem.mesh.cells.iter().position(around)?;
    let size = problem.mesh.cells[cell].size;
    let [lx, ly] = [0, 1].map(|k| size[k] as f64 * grid.spacing[k]);
    let vertices = problem.vertex_displacement(u);
    let [a, b, c, d] = problem.mesh.corners[cell].map(|vertex| vertices[vertex]);
    let along = |k: usize| (b[k] - a[k] + c[k] - d[k]) / (2.0 * lx);
    let across = |k: usize| (d[k] - a[k] + c[k] - b[k]) / (2.0 * ly);
    let strain = [along(0), across(1), across(0) + along(1)];
    let tensor = problem.cell_basis(cell).ok()?.tensor(grid.spacing);
    Some(tensor.map(|row| row.iter().zip(strain).map(|(c, e)| c * e).sum()))
}

/// Relative difference of prescribed displacements that counts as rounding.
const ROUNDING: f64 = 1e-13;

/// Displacements prescribed on the fine boundary less the trace of those at the vertices.
pub(super) fn lift(
    problem: &Multiscale<'_>,
    fine: &GridTrace,
    held: &[Held],
    trace: &GridTrace,
    coarse: &[Held],
) -> Vec<f64> {
    let grid = &problem.body.grid;
    let mut lift = vec![0.0; grid.dofs()];
    let mut place = 0;
    let mut lifted = false;
    // both boundaries run in the same order, and begin at the same corners
    for e in 0..trace.mesh.len() {
        let points = trace.points(e);
        let count = points.len() - 1;
        let along = usize::from(points[0][0] == points[count][0]);
        let (cell, side) = trace.cell(grid, e);
        let mut weights = problem.trace_weights(cell, side);
        if points[count][along] < points[0][along] {
            weights = weights.iter().rev().map(|w| 1.0 - w).collect();
        }
        for step in 0..count {
            let f = place + step;
            let linear = 1.0 - step as f64 / count as f64;
            for k in 0..2 {
                let ends = [&coarse[e], &coarse[trace.mesh.next[e]]].map(|h| h.components[k].map(|(value, _)| value));
                if let (Some((value, _)), [Some(a), Some(b)]) = (held[f].components[k], ends) {
                    let w = if k == along { weights[step] } else { linear };
                    let extra = if step == 0 { 0.0 } else { value - w * a - (1.0 - w) * b };
                    // rounding of linear data is no lift: it would count as a load
                    let extra =
                        if extra.abs() > ROUNDING * value.abs().max(a.abs()).max(b.abs()) { extra } else { 0.0 };
                    lift[2 * node_at(grid, fine.lattice[f]) + k] = extra;
                    lifted |= extra != 0.0;
                }
            }
        }
        place += count;
    }
    if lifted { lift } else { Vec::new() }
}

/// The moments and weighted forces that the scene asks for, those of vertices being `of_vertices`: a weight that differs from the traces
/// between them does work on the forces of the fine nodes, Σ w·(K u - f) with w as the basis extends it.
fn works(
    scene: &Scene,
    problem: &Multiscale<'_>,
    (displacement, loads): (&[f64], &Loads),
    of_vertices: &[f64],
    [(fine, fine_held), (trace, held)]: [(&GridTrace, &[Held]); 2],
) -> Result<Vec<f64>, SolveError> {
    let weighted = scene.quantities.iter().filter(|quantity| quantity.kind.weighted_side().is_some());
    let mut works = Vec::new();
    let mut rest: Option<Vec<f64>> = None;
    for (quantity, &of_vertices) in weighted.zip(of_vertices) {
        let Some((side, w)) =
            quantity.kind.weighted_side().filter(|_| !matches!(quantity.kind, QuantityKind::Moment { .. }))
        else {
            works.push(of_vertices);
            continue;
        };
        let [own_fine, own] = [(fine, fine_held), (trace, held)].map(|(trace, held)| weights_at(trace, held, side, &w));
        let lift = lift(problem, fine, &own_fine, trace, &own);
        let mut coarse = vec![0.0; problem.dofs()];
        let at = |p: [usize; 2]| vertex_at(problem, p).and_then(|v| problem.unknown[v]);
        for (&place, held) in trace.lattice.iter().zip(&own) {
            let Some(unknown) = at(place) else { continue };
            (0..2).for_each(|k| coarse[unknown + k] = held.components[k].map_or(0.0, |(value, _)| value));
        }
        let extra = Extra { bubbles: false, lift };
        let field = problem.downscale(&coarse, &Loads::default(), &extra, &mut |_| true)?;
        let rest = rest.get_or_insert_with(|| {
            let (forces, load) = (problem.body.forces(displacement), loads.nodal(problem.body));
            forces.iter().zip(&load).map(|(ku, f)| ku - f).collect()
        });
        works.push(dot(&field, rest));
    }
    Ok(works)
}

/// w where a side holds the nodes of a boundary, 0 where another one does.
pub(super) fn weights_at(trace: &GridTrace, held: &[Held], side: usize, w: &dyn Fn([f64; 2]) -> [f64; 2]) -> Vec<Held> {
    let of_node = |(held, &x): (&Held, &[f64; 2])| {
        let w = w(x);
        let value = |k: usize, own: usize| (if own == side { w[k] } else { 0.0 }, own);
        Held { components: [0, 1].map(|k| held.components[k].map(|(_, own)| value(k, own))) }
    };
    held.iter().zip(&trace.space.points).map(of_node).collect()
}

/// The number of the vertex at a lattice point.
fn vertex_at(problem: &Multiscale<'_>, p: [usize; 2]) -> Option<usize> {
    problem.mesh.vertices.binary_search_by_key(&[p[1], p[0]], |v| [v[1], v[0]]).ok()
}

/// Strain energy and load work of the fine displacement; cell by cell where the basis is not conforming.
fn field_energies(
    problem: &Multiscale<'_>,
    displacement: &[f64],
    coarse: &[f64],
    loads: &Loads,
    extra: &Extra,
) -> Result<(f64, f64), MsfemError> {
    if !problem.basis.is_conforming() {
        return broken_energies(problem, coarse, loads, extra);
    }
    let load = loads.nodal(problem.body);
    let work = displacement.iter().zip(&load).map(|(u, f)| u * f).sum();
    Ok((problem.body.energy(displacement, displacement) / 2.0, work))
}

/// Strain energy and load work of a field that is not continuous, cell by cell.
fn broken_energies(
    problem: &Multiscale<'_>,
    coarse: &[f64],
    loads: &Loads,
    extra: &Extra,
) -> Result<(f64, f64), MsfemError> {
    let (mut strain, mut work) = (0.0, 0.0);
    problem.downscale_cells(coarse, loads, extra, &mut |_| true, |cell, field| {
        for (fine, u) in problem.fine_values(cell, field) {
            strain += problem.body.cell_energy(fine, &u) / 2.0;
            work += loads.cell(fine).iter().zip(&u).map(|(f, u)| f * u).sum::<f64>();
        }
    })?;
    Ok((strain, work))
}

/// The points of the unknowns of a multiscale problem.
fn unknown_points(problem: &Multiscale<'_>) -> Vec<[f64; 2]> {
    let mut points = vec![[0.0; 2]; problem.dofs() / 2];
    for (vertex, unknown) in problem.mesh.vertices.iter().zip(&problem.unknown) {
        if let Some(unknown) = unknown {
            points[unknown / 2] = problem.body.grid.lattice_point(*vertex);
        }
    }
    points
}

/// Removes the rigid motions that nothing resists from the fine displacement, as for bilinear elements, and the same motions
/// from the displacements of the coarse vertices and of the boundary.
fn without_free_motions(
    grid: &Grid,
    fine: &mut [f64],
    (vertices, at): (&mut [f64], &[[usize; 2]]),
    (boundary, trace): (&mut [f64], &GridTrace),
    motions: &[RigidMotion],
) {
    let fine_points: Vec<[f64; 2]> = (0..grid.nodes()).map(|n| grid.point(n)).collect();
    let vertex_points: Vec<[f64; 2]> = at.iter().map(|&v| grid.lattice_point(v)).collect();
    let mut alike = [(vertices, &vertex_points[..]), (boundary, &trace.space.points[..])];
    without_motions((fine, &fine_points), &mut alike, motions);
}

/// The boundary with a node at each coarse vertex, and the nodes of the problem there.
fn coarse_trace(scene: &Scene, problem: &Multiscale<'_>) -> Result<(GridTrace, Vec<usize>), SolveError> {
    let vertex_at = |p: [usize; 2]| vertex_at(problem, p);
    let trace = GridTrace::new(scene, &problem.body.grid, |p| vertex_at(p).is_some())?;
    let node_of = |p: [usize; 2]| {
        let unknown = vertex_at(p).and_then(|v| problem.unknown[v]);
        unknown.unwrap_or_else(|| unreachable!("vertices on the boundary do not hang")) / 2
    };
    let at_boundary = trace.lattice.iter().map(|&p| node_of(p)).collect();
    Ok((trace, at_boundary))
}

/// The equations of the coarse vertices.
fn coarse_system(
    problem: &mut Multiscale<'_>,
    loads: &Loads,
    extra: &Extra,
    at_boundary: Vec<usize>,
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<System, SolveError> {
    let coarse = watched("bases of coarse cells", [0.05, 0.4], observe, |go_on| problem.assemble(loads, extra, go_on))?;
    Ok(System {
        stiffness: coarse.stiffness,
        load: coarse.load,
        points: unknown_points(problem),
        order: problem.elimination_order(),
        at_boundary,
    })
}
