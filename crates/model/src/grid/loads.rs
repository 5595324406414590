//! Loads and gaps of a scene on a grid.

use std::collections::HashMap;

use steklov_bem_operators::{Mesh, Site};
use steklov_msfem::{HeterogeneousBody, Loads, MsfemError};
use steklov_problem::steklov_expression::Expression;
use steklov_problem::{Condition, Contact, DataError, DataErrorKind, Scene};

use super::trace::GridTrace;
use crate::data::on_mesh::{OnMesh, SideLoad};
use crate::error::SolveError;

/// Mean tractions (stress) on fine sides (cell, side) of the boundary; None where the displacement is given.
pub(super) type Tractions = HashMap<(usize, usize), [Option<f64>; 2]>;

/// What acts on the cells of a grid.
pub(super) struct CellLoads {
    /// Tractions side by side of the cells on the boundary, and the body force.
    pub loads: Loads,
    /// The means of the tractions.
    pub tractions: Tractions,
    /// Cells whose body force is not known to rounding, each with the force by which it may be off.
    pub uncertain: Vec<(usize, f64)>,
}

/// What acts on the cells of a grid whose boundary is `fine`.
pub(super) fn loads(scene: &Scene, body: &HeterogeneousBody, fine: &GridTrace) -> Result<CellLoads, SolveError> {
    let (mut loads, mut tractions) = (Loads::default(), Tractions::default());
    let data = OnMesh { scene, mesh: &fine.mesh, space: &fine.space };
    for e in 0..fine.mesh.len() {
        if let Condition::Displacement { values, .. } = &scene.problem.sides[fine.mesh.side[e]].condition {
            let given = values.each_ref().map(|value| value.is_none().then_some(0.0));
            tractions.insert(fine.cell(&body.grid, e), given);
        }
    }
    for (e, moments) in data.side_loads()?.into_iter().chain(remote_tractions(scene, &fine.mesh)) {
        let (cell, side) = fine.cell(&body.grid, e);
        loads.add_side(cell, side, moments);
        let mean = tractions.entry((cell, side)).or_insert([Some(0.0); 2]);
        for i in 0..2 {
            mean[i] = mean[i].map(|t| t + (moments[0][i] + moments[1][i]) / fine.mesh.length(e));
        }
    }
    let mut uncertain = Vec::new();
    if let Some(components) = &scene.body().force {
        let force = |x: [f64; 2]| scene.force_at(x).unwrap_or([f64::NAN; 2]);
        let turns = |at: [f64; 2], size: [f64; 2]| components.iter().any(|f| turns_in(f, at, size));
        let set = loads.set_body_force_that_turns(body, force, turns);
        uncertain = set.map_err(|error| body_force_error(scene, error))?;
    }
    Ok(CellLoads { loads, tractions, uncertain })
}

/// Whether an expression has a kink or a jump between the corners and middles of a rectangle.
fn turns_in(expression: &Expression, at: [f64; 2], size: [f64; 2]) -> bool {
    expression.switches().iter().any(|switch| {
        let value = |k: usize| {
            let [i, j] = [k % 3, k / 3].map(|i| i as f64 / 2.0);
            expression.switch_value(switch, at[0] + i * size[0], at[1] + j * size[1], 0.0)
        };
        let (low, high) = (0..9).map(value).fold((0.0, 0.0), |(low, high): (f64, f64), v| (low.min(v), high.max(v)));
        low < 0.0 && high > 0.0
    })
}

/// Moments of the traction of the remote stress where the body meets the medium around it.
fn remote_tractions(scene: &Scene, mesh: &Mesh) -> Vec<SideLoad> {
    let Some(remote) = scene.remote_stress() else { return Vec::new() };
    let edges = scene.problem.outline.edges();
    let meets = |e: &usize| edges[mesh.edge[*e]].loop_index == 0;
    let moments = |e: usize| remote.traction(mesh.point(e, 0.0), mesh.normal(e, 0.0)).map(|t| t * mesh.length(e) / 2.0);
    (0..mesh.len()).filter(meets).map(|e| (e, [moments(e); 2])).collect()
}

/// An error about the body force at its place in the scene.
fn body_force_error(scene: &Scene, error: MsfemError) -> SolveError {
    let (MsfemError::Force { point, .. }, Some([x, y])) = (&error, &scene.body().force) else { return error.into() };
    match scene.force_at(*point) {
        Err(error) => error.into(),
        Ok(_) => DataError::of_values(if x.constant().is_some() { y } else { x }, &error.to_string()).into(),
    }
}

/// The gap of a contact side may jump only where the grid has a point: between two it would be smeared.
pub(super) fn check_gaps(scene: &Scene, trace: &GridTrace) -> Result<(), SolveError> {
    const NEAR: f64 = 1e-7;
    for e in 0..trace.mesh.len() {
        let side = &scene.problem.sides[trace.mesh.side[e]];
        let Some(Contact { gap, .. }) = scene.contact(trace.mesh.side[e]) else { continue };
        let at = |t: f64| {
            let site = Site::new(&trace.mesh, e, t);
            (site.point[0], site.point[1], site.s)
        };
        let value = |t: f64| {
            let (x, y, s) = at(t);
            gap.eval(x, y, s)
        };
        for t in gap.kinks(at).into_iter().filter(|t| t.abs() < 1.0 - 10.0 * NEAR) {
            let (before, after) = (value(t - NEAR), value(t + NEAR));
            let scale = [before, after, value(-1.0), value(1.0)].iter().fold(0.0, |m: f64, g| m.max(g.abs()));
            if (before - after).abs() > 1e-3 * scale {
                let (x, y, _) = at(t);
                let message = format!(
                    "the gap of side \"{}\" jumps from {before} to {after} at ({x}, {y}), between two points of the grid",
                    side.name
                );
                let help = "choose [grid] so that this is a point of the (coarse) grid, or use model = \"bem\"";
                let keys = [vec!["sides", side.name.as_str(), "contact", "gap"]];
                return Err(DataError::at(DataErrorKind::Unsupported, &keys, message, help).into());
            }
        }
    }
    Ok(())
}
