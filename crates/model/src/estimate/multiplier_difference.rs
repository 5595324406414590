//! Where the answers of stabilised and biorthogonal multipliers differ, for refinement.
//!
//! ```text
//! η_λ²(I) = ‖u - u_b‖² d(I) / Σ d,     d(I) = ∫_I (h/p) |λ - λ_b|²
//! ```
//! ‖u - u_b‖² of the whole body is in the estimate; the elements share it as their multipliers differ, h/p standing for the norm of
//! order -½.

use steklov_contact::{MultiplierDegree, multiplier_trace};
use steklov_problem::Scene;
use steklov_quadrature::gauss_legendre;

use crate::solve::solution::Solved;

/// Part of an element's η² from which its multipliers limit it.
const MOST: f64 = 0.5;

/// η_λ² of every element, 0 without stabilised multipliers. `difference`: ‖u - u_b‖².
pub(crate) fn multiplier_indicators(solved: &Solved, difference: f64) -> Vec<f64> {
    let Solved { mesh, space, .. } = solved;
    let mut parts = vec![0.0; mesh.len()];
    let Some(contact) = &solved.contact else { return parts };
    let Some(stabilised) = &contact.stabilised else { return parts };
    for (e, part) in parts.iter_mut().enumerate() {
        let cells = stabilised.space.cells_of(mesh, e);
        if cells.is_empty() {
            continue;
        }
        let nodal = multiplier_trace(mesh, space, &contact.boundary, &contact.solution.multipliers, e);
        let (basis, mut phi) = (space.basis(e), vec![0.0; nodal.len()]);
        for cell in cells {
            let degree = basis.degree.max(stabilised.space.elements[cell.multiplier].degree);
            let rule = gauss_legendre(degree + 1).mapped(cell.span[0], cell.span[1]);
            for (&t, &w) in rule.points.iter().zip(&rule.weights) {
                basis.evaluate(t, &mut phi);
                let position = mesh.edge_parameter(e, t);
                let found = stabilised.space.value(cell.multiplier, position, &stabilised.solution.multipliers);
                for k in 0..2 {
                    let other: f64 = nodal.iter().zip(&phi).map(|(l, phi)| l[k] * phi).sum();
                    *part += w * mesh.length(e).powi(2) / basis.degree as f64 * (found[k] - other).powi(2);
                }
            }
        }
    }
    let sum: f64 = parts.iter().sum();
    let share = if sum > 0.0 { difference / sum } else { 0.0 };
    parts.iter_mut().for_each(|part| *part *= share);
    parts
}

/// Whether an element must be halved, as its multipliers limit it and have a degree of their own: `part` of its η² is η_λ².
pub(crate) fn limited_by_multipliers(scene: &Scene, part: f64, squared: f64) -> bool {
    !matches!(scene.method.multiplier_degree, MultiplierDegree::Relative(_)) && part > MOST * squared
}
