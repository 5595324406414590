//! Bodies so thin that rounding leaves no digit of their stiffness.

use steklov_bem_operators::{BemError, Mesh};
use steklov_problem::Problem;

use crate::error::SolveError;
use crate::estimate::thickness;
use crate::parts::Assembled;

/// Digits from which on bending takes what a mesh needs.
const MANY: f64 = 10.0;
/// Digits of a number.
const ALL: f64 = 16.0;

/// The error of a stiffness that has no factor. All motions of a body as a whole are known to be held: it is of rounding, and of a
/// thin body is told as such.
pub(crate) fn without_digits(error: BemError, problem: &Problem, bodies: &[Assembled]) -> SolveError {
    let BemError::StiffnessSingular { .. } = error else { return error.into() };
    let bounded = bodies.iter().filter(|body| problem.bodies[body.piece.body].far.is_none());
    let slender = bounded.map(|body| (usual_thickness(&body.piece.mesh), body.piece.mesh.diameter()));
    let Some((thickness, length)) = slender.min_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1))) else {
        return error.into();
    };
    // a beam resists bending by the cube of its thickness over its length
    let digits = (3.0 * (length / thickness).log10()).round();
    if digits < MANY { error.into() } else { SolveError::Thin { thickness, length, digits: digits.min(ALL) } }
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
