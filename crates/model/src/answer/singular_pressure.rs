//! Whether the exact contact pressure is infinite somewhere, so that the largest nodal one is a number of the mesh.

use std::f64::consts::PI;

use steklov_bem_operators::Mesh;
use steklov_elastic::plane::{angle, distance};
use steklov_expression::{Expression, OnEdge, Track};
use steklov_problem::{Condition, Scene};

use crate::answer::corners::is_unbounded_between_bodies;
use crate::solve::contact_rows::{ContactRow, TOUCHING};

/// Distance from a kink, as part of the edge, at which the gap is examined.
const NEAR: f64 = 1e-6;
/// Slopes that differ by less than this part of the largest are no kink, and jumps below this part of the range no step.
const SMOOTH: f64 = 1e-4;

/// True where contact lies on a convex kink or at a step of the gap (a ridge or an edge of the obstacle); where it reaches an
/// end of the contact boundary at which the body goes on under more than a right angle, or more than 60° where it sticks, a
/// plane of symmetry excepted; and at a re-entrant corner inside the contact boundary. A smooth end at a right angle is
/// bounded. For bodies that meet, exponents decide.
pub(crate) fn is_unbounded(scene: &Scene, mesh: &Mesh, rows: &[ContactRow]) -> bool {
    let largest = rows.iter().fold(0.0, |m: f64, r| m.max(r.pressure));
    let pressed = |r: &&ContactRow| r.pressure > TOUCHING * largest;
    let distance = |r: &ContactRow, x: [f64; 2]| distance(r.point, x);
    let touched = |x: [f64; 2], reach: f64| rows.iter().filter(pressed).any(|r| distance(r, x) <= reach);
    let stuck = |x: [f64; 2]| rows.iter().filter(pressed).any(|r| r.point == x && r.shear.abs() < r.bound);
    let gap_of = |side: usize| scene.contact(side).map(|contact| &contact.gap);
    let longest_on = |k: usize| {
        let on_edge = (0..mesh.len()).filter(|&e| mesh.edge[e] == k);
        on_edge.map(|e| mesh.length(e)).fold(0.0, f64::max)
    };
    for (k, edge) in scene.problem.outline.edges().iter().enumerate() {
        let Some(gap) = gap_of(edge.side) else { continue };
        let path = |s: f64| OnEdge::new(edge, gap).at(s);
        let along = gap.along(edge);
        let inside: Vec<f64> =
            along.kinks.iter().copied().filter(|&s| s > 3.0 * NEAR && s < 1.0 - 3.0 * NEAR).collect();
        if inside.iter().any(|&s| is_ridge(gap, path, s) && touched(edge.point(s), 0.51 * longest_on(k))) {
            return true;
        }
    }
    let previous = mesh.previous();
    for e in 0..mesh.len() {
        let before = previous[e];
        let obstacle = |side: usize| gap_of(side).is_some() && scene.problem.joint(side).is_none();
        let (here, there) = (obstacle(mesh.side[e]), obstacle(mesh.side[before]));
        let (a, b) = (mesh.tangent(before, 1.0), mesh.tangent(e, -1.0));
        // turning to the left is a convex corner: interior angle π - turn
        let angle = PI - angle(a, b);
        let corner = mesh.vertices[e];
        let infinite = match (here, there) {
            (true, true) => angle > PI + 1e-9 && touched(corner, 0.0),
            (false, false) => false,
            _ => {
                let other = mesh.side[if here { before } else { e }];
                let held = matches!(scene.problem.sides[other].condition, Condition::Displacement { .. });
                let reach = if held { mesh.length(e).max(mesh.length(before)) } else { 0.0 };
                let obtuse = angle > PI / 2.0 + 1e-9;
                let square = (angle - PI / 2.0).abs() < 1e-9;
                let mirror = square && is_mirror(scene, mesh, if here { before } else { e });
                touched(corner, reach) && !mirror && (obtuse || stuck(corner) && angle > PI / 3.0)
            }
        };
        if infinite {
            return true;
        }
    }
    is_unbounded_between_bodies(scene, rows)
}

/// Whether the side of an element is held by a constant along its normal only, which lies along an axis, and is free of
/// traction along it: the body may go on as its mirror image.
fn is_mirror(scene: &Scene, mesh: &Mesh, e: usize) -> bool {
    let Condition::Displacement { values, traction: None } = &scene.problem.sides[mesh.side[e]].condition else {
        return false;
    };
    let constant = |i: usize| values[i].as_ref().is_some_and(|v| v.constant().is_some());
    (0..2).any(|i| mesh.normal(e, 0.0)[i].abs() > 1.0 - 1e-12 && constant(i) && values[1 - i].is_none())
}

/// Whether the gap has a step or bends upwards at the edge parameter s.
fn is_ridge(gap: &Expression, path: impl Fn(f64) -> (f64, f64, f64), s: f64) -> bool {
    let value = |s: f64| {
        let (x, y, s) = path(s);
        gap.eval(x, y, s)
    };
    // one-sided values and slopes
    let side = |step: f64| {
        let (near, far) = (value(s + step), value(s + 2.0 * step));
        (2.0 * near - far, (far - near) / step)
    };
    let ((left, slope_left), (right, slope_right)) = (side(-NEAR), side(NEAR));
    let samples = (0..=64).map(|i| value(f64::from(i) / 64.0));
    let (low, high) = samples.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let step = (right - left).abs() > SMOOTH * (high - low);
    step || slope_right - slope_left > SMOOTH * slope_left.abs().max(slope_right.abs()).max(high - low)
}
