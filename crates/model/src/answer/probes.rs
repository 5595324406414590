//! Results along lines and sides.

use rayon::prelude::*;
use steklov_bem_operators::Mesh;
use steklov_elastic::plane::{dot, turned};
use steklov_elastic::principal;
use steklov_problem::{ProbeLine, Scene, Spot};

use crate::summary::{LinePoint, LineProbe, Probe, SidePoint, SideProbe};

/// Displacement and stress.
type State = ([f64; 2], [f64; 3]);

/// Gives points the invariants of their stresses where these are finite.
pub(crate) fn tell_invariants(scene: &Scene, probes: &mut [Probe]) {
    for probe in probes.iter_mut().filter(|probe| probe.stress.iter().all(|s| s.is_finite())) {
        let [von_mises, larger, smaller] = invariants(scene, probe.point, probe.stress);
        (probe.von_mises, probe.max_principal, probe.min_principal) = (Some(von_mises), Some(larger), Some(smaller));
    }
}

/// Von Mises stress and the principal stresses in the plane of a stress at a point, the larger one first.
pub(crate) fn invariants(scene: &Scene, x: [f64; 2], stress: [f64; 3]) -> [f64; 3] {
    let body = scene.problem.spot(x).map_or(0, |spot| spot.body);
    let [larger, smaller] = principal(stress);
    [scene.problem.bodies[body].material().von_mises(stress), larger, smaller]
}

/// Step of differences of invariants, over the stress.
const STEP: f64 = 1e-4;

/// The derivatives of the invariants of a stress by its components.
pub(crate) fn slopes(stress: [f64; 3], invariants: impl Fn([f64; 3]) -> [f64; 3]) -> [[f64; 3]; 3] {
    let step = STEP * stress.iter().fold(f64::MIN_POSITIVE, |m: f64, s| m.max(s.abs()));
    let mut slopes = [[0.0; 3]; 3];
    for i in 0..3 {
        let moved = |by: f64| {
            let mut stress = stress;
            stress[i] += by;
            invariants(stress)
        };
        let (up, down) = (moved(step), moved(-step));
        (0..3).for_each(|k| slopes[k][i] = (up[k] - down[k]) / (2.0 * step));
    }
    slopes
}

/// Displacement and stress along the lines of a scene, as `at` has them at a point where something lies.
pub(crate) fn lines(scene: &Scene, at: impl Fn(Spot, [f64; 2]) -> State + Sync) -> Vec<LineProbe> {
    let line = |line: &ProbeLine| LineProbe { from: line.from, to: line.to, points: points(scene, line.places(), &at) };
    scene.probe_lines.iter().map(line).collect()
}

/// Displacement and stress at points, each with its distance along a line; NaN where no body is.
pub(crate) fn points(
    scene: &Scene,
    places: Vec<(f64, [f64; 2])>,
    at: impl Fn(Spot, [f64; 2]) -> State + Sync,
) -> Vec<LinePoint> {
    let problem = &scene.problem;
    let names = problem.bodies.len() > 1;
    let point = |(s, x): (f64, [f64; 2])| {
        let spot = problem.spot(x);
        let (displacement, stress) = spot.map_or(([f64::NAN; 2], [f64::NAN; 3]), |spot| at(spot, x));
        let body = spot.map(|spot| &problem.bodies[spot.body]);
        LinePoint {
            s,
            point: x,
            body: body.filter(|_| names).map(|body| body.name.clone()),
            displacement,
            stress,
            von_mises: body.map_or(f64::NAN, |body| body.material().von_mises(stress)),
            stress_unbounded: false,
        }
    };
    places.into_par_iter().map(point).collect()
}

/// Displacement, traction and stress along sides: `at` has displacement, stress and traction at a reference coordinate of an element
/// of the boundary, `coordinates` those coordinates.
pub(crate) fn along_sides(
    scene: &Scene,
    mesh: &Mesh,
    sides: &[usize],
    coordinates: impl Fn(usize) -> Vec<f64>,
    at: impl Fn(usize, f64) -> (State, [f64; 2]),
) -> Vec<SideProbe> {
    let probe = |&side: &usize| {
        let material = scene.problem.bodies[scene.problem.body_of_side(side)].material();
        let (mut points, mut before) = (Vec::new(), 0.0);
        for (piece, elements) in pieces(mesh, side).into_iter().enumerate() {
            for e in elements {
                let length = mesh.length(e);
                for t in coordinates(e) {
                    let ((displacement, stress), traction) = at(e, t);
                    let (normal, [xx, yy, xy]) = (mesh.normal(e, t), stress);
                    let tangent = turned(normal);
                    let along = [xx * tangent[0] + xy * tangent[1], xy * tangent[0] + yy * tangent[1]];
                    points.push(SidePoint {
                        piece,
                        s: before + length * part(mesh, e, t),
                        point: mesh.point(e, t),
                        normal,
                        displacement,
                        normal_displacement: dot(displacement, normal),
                        tangential_displacement: dot(displacement, tangent),
                        normal_traction: dot(traction, normal),
                        tangential_traction: dot(traction, tangent),
                        hoop_stress: dot(along, tangent),
                        stress,
                        von_mises: material.von_mises(stress),
                        stress_unbounded: false,
                    });
                }
                before += length;
            }
        }
        SideProbe { side: scene.problem.sides[side].name.clone(), points }
    };
    sides.iter().map(probe).collect()
}

/// The part of the length of an element up to a reference coordinate.
fn part(mesh: &Mesh, e: usize, t: f64) -> f64 {
    let [start, end] = mesh.arc[e];
    (mesh.arc_fraction(e, t) - start) / (end - start)
}

/// The elements of a side in the order in which the boundary is traversed, those that join each other together.
fn pieces(mesh: &Mesh, side: usize) -> Vec<Vec<usize>> {
    let previous = mesh.previous();
    let own: Vec<usize> = (0..mesh.len()).filter(|&e| mesh.side[e] == side).collect();
    let begins = own.iter().copied().filter(|&e| mesh.side[previous[e]] != side);
    let mut seen = vec![false; mesh.len()];
    let mut all = Vec::new();
    // a closed piece begins at its first element
    for first in begins.chain(own.iter().copied()) {
        let (mut piece, mut e) = (Vec::new(), first);
        while mesh.side[e] == side && !seen[e] {
            seen[e] = true;
            piece.push(e);
            e = mesh.next[e];
        }
        if !piece.is_empty() {
            all.push(piece);
        }
    }
    all
}

/// Takes the stresses from points where they are infinite.
pub(crate) fn tell_unbounded(
    points: &mut [Probe],
    lines: &mut [LineProbe],
    sides: &mut [SideProbe],
    infinite: impl Fn([f64; 2]) -> bool,
) {
    for p in points.iter_mut().filter(|p| infinite(p.point)) {
        (p.stress, p.stress_unbounded) = ([f64::NAN; 3], true);
    }
    let in_a_body = |p: &&mut LinePoint| !p.displacement[0].is_nan();
    for p in lines.iter_mut().flat_map(|l| &mut l.points).filter(in_a_body).filter(|p| infinite(p.point)) {
        (p.stress, p.von_mises, p.stress_unbounded) = ([f64::NAN; 3], f64::NAN, true);
    }
    for p in sides.iter_mut().flat_map(|s| &mut s.points).filter(|p| infinite(p.point)) {
        (p.normal_traction, p.tangential_traction, p.hoop_stress) = (f64::NAN, f64::NAN, f64::NAN);
        (p.stress, p.von_mises, p.stress_unbounded) = ([f64::NAN; 3], f64::NAN, true);
    }
}
