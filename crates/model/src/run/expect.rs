//! `[expect]` of a scene: numbers that its result is to have, and whether it has them.

use serde_json::{Value, json};
use steklov_expression::nearest;
use steklov_problem::{DataError, DataErrorKind as Kind, Law, Scene};

use crate::estimators::{Estimator, Estimators, IN_CELLS, IN_COARSE_CELLS, ON_BOUNDARY, ON_INTERFACE, TRUNCATION};
use crate::quantities::named;
use crate::stochastic::paths_of;
use crate::summary::{
    Audit, BodySummary, ContactSummary, Expected, GridSummary, InterfaceSummary, LinePoint, LineProbe, MediumSummary,
    NormalsSummary, Probe, ReachSummary, SidePoint, SideProbe, Stabilisation, Summary,
};

/// The entries of `[expect]` beside the numbers of a result.
pub(crate) fn expected(scene: &Scene, summary: &Summary) -> Vec<Expected> {
    if scene.expect.is_empty() {
        return Vec::new();
    }
    let numbers = serde_json::to_value(summary).unwrap_or_default();
    let of = |entry: &steklov_problem::Expectation| {
        let value = Summary::number_at(&numbers, &entry.path);
        let holds = value.is_some_and(|value| (value - entry.value).abs() <= entry.tol);
        Expected { path: entry.path.clone(), value, expected: entry.value, tol: entry.tol, holds }
    };
    scene.expect.iter().map(of).collect()
}

/// Whether the result of a scene can have numbers at all paths of its `[expect]`.
///
/// # Errors
/// The first path at which it has none, with the one that is most like it.
pub fn check_expect(scene: &Scene) -> Result<(), DataError> {
    if scene.expect.is_empty() {
        return Ok(());
    }
    let shape = shape(scene);
    let lists = [
        ("probe", scene.probe.len()),
        ("probe_lines", scene.probe_lines.len()),
        ("probe_sides", scene.probe_sides.len()),
    ];
    for entry in &scene.expect {
        let keys: Vec<&str> = entry.path.split('.').collect();
        if is_number(&shape, &keys, &lists) {
            continue;
        }
        let mut paths = Vec::new();
        collect(&shape, String::new(), &mut paths);
        let help = match nearest(&entry.path, paths.iter().map(String::as_str)) {
            Some(near) => format!("did you mean {near}?"),
            None => "take paths of the JSON object: energy, contact.force.y, reactions.SIDE.x, probe.0.displacement.y"
                .to_owned(),
        };
        let message = format!("the result of this scene has no number at {:?}", entry.path);
        let nested = [&["expect"][..], &keys].concat();
        return Err(DataError::at(Kind::Unknown, &[vec!["expect", &entry.path], nested], message, help));
    }
    Ok(())
}

/// Whether there is a number at the end of these keys; lists have any length, except those whose lengths are given.
fn is_number(value: &Value, keys: &[&str], lists: &[(&str, usize)]) -> bool {
    let Some((key, rest)) = keys.split_first() else { return value.is_number() || value.is_boolean() };
    match value {
        Value::Object(entries) => (1..=keys.len()).any(|n| {
            let name = keys[..n].join(".");
            let length = lists.iter().find(|(list, _)| *list == name).map(|(_, length)| *length);
            let is_beyond = |key: &&str| key.parse().is_ok_and(|k: usize| length.is_some_and(|length| k >= length));
            let value = entries.get(&name).filter(|_| !keys.get(n).is_some_and(is_beyond));
            value.is_some_and(|value| is_number(value, &keys[n..], lists))
        }),
        Value::Array(items) if items.iter().all(Value::is_number) => {
            Summary::component(key).is_some_and(|k| k < items.len()) && rest.is_empty()
        }
        Value::Array(items) => key.parse::<usize>().is_ok() && items.first().is_some_and(|v| is_number(v, rest, lists)),
        _ => false,
    }
}

/// The paths of all numbers; for lists those of the first entry.
fn collect(value: &Value, path: String, paths: &mut Vec<String>) {
    let join = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match value {
        Value::Object(entries) => entries.iter().for_each(|(key, value)| collect(value, join(key), paths)),
        Value::Array(items) if items.iter().all(Value::is_number) => {
            let names: &[&str] = match items.len() {
                2 => &["x", "y"],
                3 => &["xx", "yy", "xy"],
                _ => &[],
            };
            paths.extend(names.iter().map(|name| join(name)));
        }
        Value::Array(items) => items.iter().take(1).for_each(|value| collect(value, join("0"), paths)),
        Value::Number(_) | Value::Bool(_) => paths.push(path),
        _ => {}
    }
}

/// An object with all numbers that a result of the scene may have.
fn shape(scene: &Scene) -> Value {
    let problem = &scene.problem;
    let touches = problem.interfaces().iter().any(|interface| matches!(interface.law, Law::Contact(_)));
    let several = problem.has_several_bodies();
    let audit = Audit { equilibrium: 0.0, penetration: 0.0, tension: 0.0, complementarity: 0.0, friction: 0.0 };
    let contact = ContactSummary {
        ends: Some(vec![[0.0; 2]]),
        contraction: Some(0.0),
        stabilisation: Some(Stabilisation { gamma: 0.0, critical_gamma: 0.0 }),
        ..ContactSummary::default()
    };
    let [von_mises, max_principal, min_principal] = [Some(0.0); 3];
    let of_point = Probe::new([0.0; 2], [0.0; 2], [0.0; 3]);
    let probe = Probe { von_mises, max_principal, min_principal, stress_unbounded: true, ..of_point };
    let summary = Summary {
        energy_extrapolated: Some(0.0),
        energy_uncertainty: Some(0.0),
        spring_energy: problem.has_springs().then_some(0.0),
        estimate: Some(0.0),
        estimate_relative: Some(0.0),
        estimators: scene.method.has_residuals().then(of_estimators),
        contact: touches.then_some(contact),
        audit: touches.then_some(audit),
        bodies: if several { vec![of_body()] } else { Vec::new() },
        interfaces: if several { vec![of_interface(audit)] } else { Vec::new() },
        reach: if several { vec![of_reach()] } else { Vec::new() },
        reactions: problem.sides.iter().map(|side| (side.name.clone(), [0.0; 2])).collect(),
        probe: if scene.probe.is_empty() { Vec::new() } else { vec![probe] },
        named: named(scene, &vec![0.0; 2 * scene.quantities.len()], |_| false),
        infinite_stress: Vec::new(),
        probe_lines: if scene.probe_lines.is_empty() { Vec::new() } else { vec![of_line()] },
        probe_sides: if scene.probe_sides.is_empty() { Vec::new() } else { vec![of_side()] },
        stochastic: scene
            .random
            .as_ref()
            .map(|random| of_outcomes(&paths_of(scene, random), random.stochastic.quantiles.len())),
        grid: scene.is_on_grid().then(of_grid),
        exterior: scene.far().map(|_| of_medium()),
        ..Summary::default()
    };
    serde_json::to_value(summary).unwrap_or_default()
}

/// All of them with all parts: which apply is known after the run.
fn of_estimators() -> Estimators {
    let of = |names: &[&'static str]| Some(Estimator::new(names.iter().map(|&name| (name, 0.0)), 0.0));
    let [on_boundary, in_coarse_cells] = [&ON_BOUNDARY[..], &IN_COARSE_CELLS].map(|parts| {
        let names = parts.iter().map(|(name, _)| *name);
        names.collect::<Vec<_>>()
    });
    Estimators {
        contact: of(&on_boundary),
        stabilised: of(&on_boundary),
        stochastic: of(&[&on_boundary[..], &[TRUNCATION]].concat()),
        multiscale: of(&in_coarse_cells),
        coupling: of(&[&in_coarse_cells[..], &IN_CELLS, &ON_INTERFACE].concat()),
    }
}

fn of_line() -> LineProbe {
    let point = LinePoint {
        s: 0.0,
        point: [0.0; 2],
        body: None,
        displacement: [0.0; 2],
        stress: [0.0; 3],
        von_mises: 0.0,
        stress_unbounded: true,
    };
    LineProbe { from: [0.0; 2], to: [0.0; 2], points: vec![point] }
}

fn of_side() -> SideProbe {
    let point = SidePoint {
        piece: 0,
        s: 0.0,
        point: [0.0; 2],
        normal: [0.0; 2],
        displacement: [0.0; 2],
        normal_displacement: 0.0,
        tangential_displacement: 0.0,
        normal_traction: 0.0,
        tangential_traction: 0.0,
        hoop_stress: 0.0,
        stress: [0.0; 3],
        von_mises: 0.0,
        stress_unbounded: true,
    };
    SideProbe { side: String::new(), points: vec![point] }
}

fn of_body() -> BodySummary {
    BodySummary { name: String::new(), dofs: 0, strain_energy: 0.0, estimate: Some(0.0) }
}

fn of_interface(audit: Audit) -> InterfaceSummary {
    InterfaceSummary {
        name: String::new(),
        kind: String::new(),
        sides: [Vec::new(), Vec::new()],
        length: 0.0,
        stick: Some(0.0),
        slip: Some(0.0),
        max_pressure: Some(0.0),
        force: [0.0; 2],
        ends: Some(vec![[0.0; 2]]),
        audit: Some(audit),
        normals: Some(NormalsSummary { angle: 0.0, energy_change: 0.0 }),
    }
}

fn of_reach() -> ReachSummary {
    ReachSummary { bodies: [String::new(), String::new()], point: [0.0; 2], depth: 0.0 }
}

fn of_grid() -> GridSummary {
    GridSummary {
        cells: [0; 2],
        fine_dofs: 0,
        basis: None,
        coarse_cells: Some(0),
        patterns: Some(0),
        estimate_multiscale: Some(0.0),
        estimate_fine_grid: Some(0.0),
        estimate_medium: Some(0.0),
        boundary_elements: Some(0),
        contrast: 0.0,
        crossing_contrast: Some(0.0),
        crossing_at: Some([0.0; 2]),
        crossing_share: Some(0.0),
    }
}

fn of_medium() -> MediumSummary {
    MediumSummary { radiation: String::new(), resultant: [0.0; 2], balanced: true, constant: [0.0; 2], length: 0.0 }
}

/// The statistics of quantities, and the numbers of how they were found.
fn of_outcomes(paths: &[String], quantiles: usize) -> Value {
    let mut all = json!({ "solution": {
        "points": 0, "solves": 0, "checks": 0, "cells": 0, "truncation_relative": 0.0, "unseen": 0.0,
        "truncation_measured": 0.0, "iterations": 0, "unconverged": 0, "seconds": 0.0,
    } });
    for path in paths {
        all[path] = json!({
            "mean": 0.0, "variance": 0.0, "quantiles": vec![0.0; quantiles], "standard_error": 0.0, "variance_error": 0.0,
            "truncation": 0.0,
        });
    }
    all
}
