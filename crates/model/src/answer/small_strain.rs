//! Whether a body deforms beyond what small strains describe.

use steklov_elastic::plane::{cross, dot, minus};
use steklov_problem::{Condition, Scene};

use crate::solve::contact_rows::Trace;

/// Rotations (radian), and deformations over the diameter of the body, from which linear elasticity describes no body any more.
const LARGEST: f64 = 0.15;

/// Whether gaps or prescribed displacements, which unlike loads cannot be scaled, turn the boundary by more than 0.15 or
/// deform it by more than 0.15 of its diameter.
///
/// The motion c + ω (-y, x) about the mean of the nodes is the least-squares fit, ω = Σ x × u / Σ |x|²; the deformation is the
/// rest.
pub fn is_large(scene: &Scene, trace: Trace<'_>) -> bool {
    let moved = scene.problem.sides.iter().any(|side| match &side.condition {
        Condition::Displacement { values, .. } => values.iter().flatten().any(|v| v.constant() != Some(0.0)),
        _ => false,
    });
    if !moved && scene.contacts().next().is_none() || scene.is_cavity() {
        return false;
    }
    let points = &trace.space.points;
    let count = points.len() as f64;
    let mean = |of: &dyn Fn(usize) -> [f64; 2]| {
        let sum = (0..points.len()).map(of).fold([0.0; 2], |s, v| [s[0] + v[0], s[1] + v[1]]);
        sum.map(|s| s / count)
    };
    let displacement = |k: usize| [trace.displacement[2 * k], trace.displacement[2 * k + 1]];
    let (centre, moved) = (mean(&|k| points[k]), mean(&displacement));
    let relative = |k: usize| {
        let (x, u) = (points[k], displacement(k));
        (minus(x, centre), minus(u, moved))
    };
    let (mut turning, mut inertia) = (0.0, 0.0);
    for (x, u) in (0..points.len()).map(relative) {
        turning += cross(x, u);
        inertia += dot(x, x);
    }
    let rotation = turning / inertia;
    let left = |(x, u): ([f64; 2], [f64; 2])| (u[0] + rotation * x[1]).hypot(u[1] - rotation * x[0]);
    let deformation = (0..points.len()).map(|k| left(relative(k))).fold(0.0, f64::max);
    rotation.abs() > LARGEST || deformation > LARGEST * scene.problem.outline.diameter()
}
