//! One grid solved: bilinear elements on all its cells, or multiscale elements on coarse ones.

use std::sync::{Mutex, OnceLock};
use std::time::Instant;

use steklov_contact::ContactBoundary;
use steklov_elastic::RigidMotion;
use steklov_msfem::{Basis, CoarseCell, CoarseMesh, Extra, Grid, HeterogeneousBody, Loads, MsfemError, Multiscale};
use steklov_problem::{QuantityKind, Scene};

use super::cells::{basis, body};
use super::coupled::solve_coupled;
use super::duals::{DualData, Factors};
use super::estimate::estimate;
use super::layout::GridLayout;
use super::loads::{CellLoads, Tractions, check_gaps, loads};
use super::solution::{CoarseSolved, GridSolved};
use super::system::{Answer, System, without_motions};
use super::trace::{GridTrace, node_at};
use crate::data::on_mesh::OnMesh;
use crate::data::supports::Held;
use crate::energies::Energies;
use crate::error::SolveError;
use crate::solve::solution::Seconds;
use crate::stage::{Stage, watched};

/// Solves the scene on a grid.
///
/// # Errors
/// Data that are not finite, a free rigid motion that the loads drive, moduli of too many magnitudes, an observer that fails.
pub fn solve_grid(
    scene: &Scene,
    layout: &GridLayout,
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<GridSolved, SolveError> {
    let clock = Instant::now();
    observe(Stage::Progress("moduli, loads and supports", 0.0))?;
    let body = body(scene, layout)?;
    let acting = Acting::new(scene, layout, &body)?;
    let set_up = clock.elapsed().as_secs_f64();
    let Unestimated { mut solved, is_held, factors } = solve_unestimated(scene, layout, body, &acting, observe)?;
    solved.seconds.set_up += set_up;
    let clock = Instant::now();
    observe(Stage::Progress("estimate", 0.9))?;
    solved.estimate = estimate(scene, &solved, &acting.loads, acting.tractions.clone(), &is_held)?;
    solved.dual_data = Mutex::new(factors.map(|factors| DualData { acting, is_held, factors }));
    if solved.estimate.as_ref().is_some_and(|e| !e.error.is_finite()) {
        return Err(SolveError::NotFinite { energy: solved.energies.total });
    }
    solved.estimate_seconds += clock.elapsed().as_secs_f64();
    Ok(solved)
}

/// Solves the scene on a grid, without an estimate; `acting` is what acts on it where that is known.
///
/// # Errors
/// As [`solve_grid`].
pub(crate) fn solve_once(
    scene: &Scene,
    layout: &GridLayout,
    acting: Option<&Acting>,
) -> Result<GridSolved, SolveError> {
    let body = body(scene, layout)?;
    let observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError> = &mut |_| Ok(());
    let solved = match acting {
        Some(acting) => solve_unestimated(scene, layout, body, acting, observe)?.solved,
        None => {
            let acting = Acting::new(scene, layout, &body)?;
            solve_unestimated(scene, layout, body, &acting, observe)?.solved
        }
    };
    Ok(solved)
}

/// What acts on a grid, and where: the same whatever the moduli.
pub(crate) struct Acting {
    /// The boundary of the fine grid.
    pub(super) fine: GridTrace,
    pub(super) loads: Loads,
    pub(super) tractions: Tractions,
    /// Cells with the force by which their body force may be off.
    pub(super) uncertain: Vec<(usize, f64)>,
    /// Supports and contact of that boundary; none where coarse cells or a medium have their own.
    on_fine: Option<(Vec<Held>, Option<ContactBoundary>)>,
}

impl Acting {
    /// What acts in a scene on the grid of a body.
    ///
    /// # Errors
    /// Data that are not finite.
    pub(crate) fn new(scene: &Scene, layout: &GridLayout, body: &HeterogeneousBody) -> Result<Self, SolveError> {
        let fine = GridTrace::new(scene, &body.grid, |_| true)?;
        let CellLoads { loads, tractions, uncertain } = loads(scene, body, &fine)?;
        let alone = scene.surroundings().is_none() && layout.coarse.is_none();
        let on_fine = if alone { Some(on_boundary(scene, &fine)?) } else { None };
        Ok(Self { fine, loads, tractions, uncertain, on_fine })
    }

    /// What acts in a scene on the grid of a layout.
    ///
    /// # Errors
    /// As [`Acting::new`]; moduli that are impossible.
    pub(crate) fn of_layout(scene: &Scene, layout: &GridLayout) -> Result<Self, SolveError> {
        Self::new(scene, layout, &body(scene, layout)?)
    }
}

/// Supports and contact of a boundary.
fn on_boundary(scene: &Scene, trace: &GridTrace) -> Result<(Vec<Held>, Option<ContactBoundary>), SolveError> {
    let data = OnMesh { scene, mesh: &trace.mesh, space: &trace.space };
    let held = data.held()?;
    check_gaps(scene, trace)?;
    let boundary = data.contact(&held, &[])?;
    Ok((held, boundary))
}

/// A solution without an estimate.
struct Unestimated {
    solved: GridSolved,
    /// Which fine unknowns are held.
    is_held: Vec<bool>,
    /// For the dual problems of a body without a medium.
    factors: Option<Factors>,
}

fn solve_unestimated(
    scene: &Scene,
    layout: &GridLayout,
    body: HeterogeneousBody,
    acting: &Acting,
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<Unestimated, SolveError> {
    let Acting { fine, loads, on_fine, .. } = acting;
    let unestimated = match (scene.surroundings(), &layout.coarse, on_fine) {
        (Some(medium), ..) => {
            let is_held = vec![false; body.grid.dofs()];
            let solved = solve_coupled(scene, medium, body, fine.clone(), loads, layout, observe)?;
            Unestimated { solved, is_held, factors: None }
        }
        (None, Some(cells), _) => solve_coarse(scene, body, fine, loads, cells.clone(), observe)?,
        (None, None, Some(on_fine)) => solve_fine(scene, body, fine.clone(), loads, on_fine, observe)?,
        (None, None, None) => unreachable!("what acts on a fine grid alone has its supports"),
    };
    let solved = &unestimated.solved;
    let Energies { total, strain, load_work, .. } = solved.energies;
    if [total, strain, load_work].iter().chain(&solved.displacement).any(|v| !v.is_finite()) {
        return Err(SolveError::NotFinite { energy: total });
    }
    Ok(unestimated)
}

/// Stress as a traction on element e, times half its length: the moment against one end.
pub(super) fn moment([xx, yy, xy]: [f64; 3], trace: &GridTrace, e: usize) -> [f64; 2] {
    let ([nx, ny], half) = (trace.mesh.normal(e, 0.0), trace.mesh.length(e) / 2.0);
    [half * (xx * nx + xy * ny), half * (xy * nx + yy * ny)]
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

fn energies(answer: &Answer, strain: f64, load_work: f64) -> Energies {
    let friction_work = answer.contact.as_ref().map_or(0.0, |c| c.friction_work);
    Energies { total: strain - load_work + friction_work, strain, springs: 0.0, load_work, friction_work }
}

/// Fine unknowns that are prescribed.
fn held_unknowns(grid: &Grid, trace: &GridTrace, held: &[Held]) -> Vec<bool> {
    let mut is_held = vec![false; grid.dofs()];
    for (&[i, j], held) in trace.lattice.iter().zip(held) {
        let node = node_at(grid, [i, j]);
        (0..2).for_each(|k| is_held[2 * node + k] |= held.components[k].is_some());
    }
    is_held
}

/// Bilinear elements on all cells.
fn solve_fine(
    scene: &Scene,
    body: HeterogeneousBody,
    trace: GridTrace,
    loads: &Loads,
    (held, boundary): &(Vec<Held>, Option<ContactBoundary>),
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<Unestimated, SolveError> {
    let clock = Instant::now();
    observe(Stage::Progress("assembling K", 0.1))?;
    let grid = &body.grid;
    let system = System {
        stiffness: body.stiffness(),
        load: loads.nodal(&body),
        points: (0..grid.nodes()).map(|n| grid.point(n)).collect(),
        order: body.elimination_order(),
        at_boundary: trace.lattice.iter().map(|&p| node_at(grid, p)).collect(),
    };
    let assemble = clock.elapsed().as_secs_f64();
    observe(Stage::Stiffness("K", "node of the fine grid", &system.stiffness, &system.load))?;
    let clock = Instant::now();
    let traction = |u: &[f64], e: usize, _: usize| {
        let cell = trace.cell(grid, e).0;
        let values = body.cell_values(u, cell);
        moment(body.stress(cell, &values, [0.5; 2]), &trace, e)
    };
    let at_boundary = system.at_boundary.clone();
    let answer = system.solve(scene, &trace, held, boundary.clone(), &traction, observe)?;
    let factorise = clock.elapsed().as_secs_f64();
    let is_held = held_unknowns(grid, &trace, held);
    let solved = GridSolved {
        dofs: grid.dofs(),
        energies: energies(&answer, answer.energy / 2.0, answer.work),
        boundary_displacement: at_nodes(&answer.displacement, &at_boundary),
        displacement: answer.displacement,
        contact: answer.contact,
        balanced: answer.balanced,
        reactions: answer.reactions,
        works: answer.works,
        free_motions: answer.free_motions,
        estimate: None,
        seconds: Seconds { assemble, factorise, ..Seconds::default() },
        estimate_seconds: 0.0,
        coarse: None,
        trace,
        body,
        around: None,
        interface: None,
        jump_oscillation: Vec::new(),
        dual_data: Mutex::default(),
        quantities: OnceLock::new(),
    };
    let factors = Some(Factors { elimination: answer.elimination, held: held.clone(), coarse: None });
    Ok(Unestimated { solved, is_held, factors })
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
        works.push(steklov_algebra::dot(&field, rest));
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

/// Values of the nodes of the boundary, interleaved.
fn at_nodes(values: &[f64], nodes: &[usize]) -> Vec<f64> {
    nodes.iter().flat_map(|n| [values[2 * n], values[2 * n + 1]]).collect()
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

/// Multiscale elements on coarse cells.
fn solve_coarse(
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
    // two supports at a corner part its force by the mean stress of the coarse cell there
    let traction = |u: &[f64], e: usize, end: usize| {
        let points = trace.points(e);
        let side = if end == 0 { [points[0], points[1]] } else { [points[points.len() - 2], points[points.len() - 1]] };
        let stress = mean_stress(&problem, grid, grid.cell(trace.side(grid, side).0), u);
        stress.map_or([0.0; 2], |stress| moment(stress, &trace, e))
    };
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
    let factors = Some(Factors { elimination: answer.elimination, held: fine_held, coarse: Some((bases, held)) });
    Ok(Unestimated { solved, is_held, factors })
}
