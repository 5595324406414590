//! One grid solved: bilinear elements on all its cells, or multiscale elements on coarse ones.

use std::sync::{Mutex, OnceLock};
use std::time::Instant;

use steklov_contact::ContactBoundary;
use steklov_msfem::{Grid, HeterogeneousBody, Loads};
use steklov_problem::Scene;

use super::cells::body;
use super::coupled::solve_coupled;
use super::dual_solutions::{Equations, Factors, Supported};
use super::duals::DualData;
use super::estimate::estimate;
use super::layout::GridLayout;
use super::loads::{CellLoads, Tractions, check_gaps, loads};
use super::solution::GridSolved;
use super::solve_coarse::solve_coarse;
use super::system::{Answer, System};
use super::trace::{GridTrace, node_at};
use crate::data::on_mesh::OnMesh;
use crate::data::supports::Held;
use crate::energies::Energies;
use crate::error::SolveError;
use crate::solve::solution::Seconds;
use crate::stage::Stage;

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
pub(super) fn on_boundary(
    scene: &Scene,
    trace: &GridTrace,
) -> Result<(Vec<Held>, Option<ContactBoundary>), SolveError> {
    let data = OnMesh { scene, mesh: &trace.mesh, space: &trace.space };
    let held = data.held()?;
    check_gaps(scene, trace)?;
    let boundary = data.contact(&held, &[])?;
    Ok((held, boundary))
}

/// A solution without an estimate.
pub(super) struct Unestimated {
    pub solved: GridSolved,
    /// Which fine unknowns are held.
    pub is_held: Vec<bool>,
    /// For the dual problems.
    pub factors: Option<Factors>,
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
        (Some(medium), ..) => solve_coupled(scene, medium, body, fine.clone(), loads, layout, observe)?,
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

pub(super) fn energies(answer: &Answer, strain: f64, load_work: f64) -> Energies {
    let friction_work = answer.contact.as_ref().map_or(0.0, |c| c.friction_work);
    Energies { total: strain - load_work + friction_work, strain, springs: 0.0, load_work, friction_work }
}

/// Fine unknowns that are prescribed.
pub(super) fn held_unknowns(grid: &Grid, trace: &GridTrace, held: &[Held]) -> Vec<bool> {
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
        over_outcomes: None,
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
    let (elimination, contact) = (answer.elimination, answer.condensed);
    let equations = Equations::Supported(Box::new(Supported { elimination, contact, held: held.clone() }));
    let factors = Some(Factors { equations, coarse: None });
    Ok(Unestimated { solved, is_held, factors })
}

/// Values of the nodes of the boundary, interleaved.
pub(super) fn at_nodes(values: &[f64], nodes: &[usize]) -> Vec<f64> {
    nodes.iter().flat_map(|n| [values[2 * n], values[2 * n + 1]]).collect()
}
