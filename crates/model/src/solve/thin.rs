//! Bodies so thin that rounding leaves no digit of their stiffness.

use steklov_bem_operators::{BemError, Mesh};
use steklov_elastic::plane::{dot, minus};
use steklov_problem::Problem;

use crate::data::parts::Assembled;
use crate::error::SolveError;

/// Digits from which on bending takes what a mesh needs.
const MANY: f64 = 10.0;
/// Digits of a number.
const ALL: f64 = 16.0;

/// The error of a stiffness that has no factor. All motions of a body as a whole are known to be held: rounding causes it, and
/// for a thin body the error says so.
pub(crate) fn without_digits(error: BemError, problem: &Problem, bodies: &[Assembled]) -> SolveError {
    let BemError::StiffnessSingular { .. } = error else { return error.into() };
    let bounded = bodies.iter().filter(|body| problem.bodies[body.piece.body].far.is_none());
    let slender = bounded.map(|body| (usual_thickness(&body.piece.part.mesh), body.piece.part.mesh.diameter()));
    let Some((thickness, length)) = slender.min_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1))) else {
        return error.into();
    };
    // a beam resists bending by the cube of its thickness over its length
    let digits = (3.0 * (length / thickness).log10()).round();
    if digits < MANY { error.into() } else { SolveError::Thin { thickness, length, digits: digits.min(ALL) } }
}

/// Distance from the middle of an element to the nearest other one across its body, `bodies` of all elements; infinite if only its
/// neighbours are there.
pub(crate) fn thickness(mesh: &Mesh, bodies: &[usize], e: usize) -> f64 {
    let (middle, n) = (mesh.point(e, 0.0), mesh.normal(e, 0.0));
    let across = |f: usize| {
        let (c, d) = (mesh.point(f, 0.0), mesh.half_chord(f));
        let to = minus(c, middle);
        let t = -(dot(to, d) / dot(d, d)).clamp(-1.0, 1.0);
        let to = [to[0] + t * d[0], to[1] + t * d[1]];
        let (squared, inwards) = (dot(to, to), -dot(to, n));
        if inwards > 0.0 && inwards * inwards > 0.25 * squared { squared } else { f64::INFINITY }
    };
    let beside = |f: usize| f == e || mesh.next[e] == f || mesh.next[f] == e;
    let others = (0..mesh.len()).filter(|&f| bodies[f] == bodies[e] && !beside(f));
    others.map(across).fold(f64::INFINITY, f64::min).sqrt()
}

/// The thickness that half of the boundary stays below: beside corners an element sees the next side as across.
fn usual_thickness(mesh: &Mesh) -> f64 {
    let one = vec![0; mesh.len()];
    let mut elements: Vec<[f64; 2]> = (0..mesh.len()).map(|e| [thickness(mesh, &one, e), mesh.length(e)]).collect();
    elements.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut left = elements.iter().map(|e| e[1]).sum::<f64>() / 2.0;
    let half = elements.iter().find(|e| {
        left -= e[1];
        left <= 0.0
    });
    half.map_or(f64::INFINITY, |e| e[0])
}
