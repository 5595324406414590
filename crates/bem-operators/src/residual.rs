//! Residuals of a discrete solution in the boundary equations, element by element: a residual error indicator.
//!
//! With ψ = V⁻¹(K+½)u in the traction space, σ^h = S_hp u taken pointwise, E Young's modulus, h and p length and degree
//! of an element I:
//!
//! ```text
//! neumann(I)  = h/(pE) ‖t - σ^h‖²_I             where t is prescribed
//! equation(I) = hE/p ‖d/ds [(K+½)u - Vψ]‖²_I    on all elements, held ones too
//! ```
//! Both are energies (force per thickness times length). The root of their sum follows the energy norm of the error: on smooth
//! solutions it is 1.9 to 3.2 times the error for p = 1 to 8 and ν from -½ to ½ (with h in place of h/p in the second term
//! that factor grows like √p: the residual of the equation has no moments against the tractions, which gains the power of p).
//! They do not see how well nodal values meet held displacements, nor the residuals of contact.

use std::ops::Range;

use rayon::prelude::*;
use steklov_elastic::plane::dot;
use steklov_quadrature::{Rule, gauss_legendre};

use crate::{BemError, BoundaryField, Mesh, Site};

/// Squared residuals of one element (energy: force per thickness times length).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BoundaryResidual {
    /// h/(pE) ‖t - σ^h‖² over the components whose traction is prescribed; 0 elsewhere.
    pub neumann: f64,
    /// hE/p ‖d/ds [(K+½)u - Vψ]‖².
    pub equation: f64,
}

impl BoundaryResidual {
    /// Sum of the terms.
    pub fn total(&self) -> f64 {
        self.neumann + self.equation
    }
}

/// Residuals of all elements, in the order of the mesh.
///
/// `traction` gives the prescribed traction at a point (stress), component by component in x and y; `None` where the
/// displacement is held or contact decides. With a body force, `field` is the part without the particular solution u_p, and
/// its prescribed traction is t - σ(u_p)n.
///
/// *Use when* an indicator without unknowns of higher degree is needed. *Fails when* the traction is rough on the scale of an
/// element: a jump that is not at a mesh vertex is integrated to 10 % of the element. *Cost*: points × elements; 80 elements
/// take one core 50 ms (p = 2) to 110 ms (p = 10). Parallel over elements, the same bits for any number of threads.
///
/// # Errors
/// [`BemError::DataNotFinite`] where a prescribed traction is not finite.
///
/// Source: Carstensen and Stephan, *A posteriori error estimates for boundary element methods*, Math. Comp. 64 (1995);
/// Issaoui (2014), theorem 2.6, the terms of η_hp.
pub fn boundary_residuals(
    mesh: &Mesh,
    field: &BoundaryField,
    traction: &(dyn Fn(&Site) -> [Option<f64>; 2] + Sync),
) -> Result<Vec<BoundaryResidual>, BemError> {
    boundary_residuals_of(mesh, field, traction, 0..mesh.len(), Look::Close)
}

/// [`boundary_residuals`] of some elements, with the accuracy of `look`.
///
/// # Errors
/// As [`boundary_residuals`].
pub fn boundary_residuals_of(
    mesh: &Mesh,
    field: &BoundaryField,
    traction: &(dyn Fn(&Site) -> [Option<f64>; 2] + Sync),
    elements: Range<usize>,
    look: Look,
) -> Result<Vec<BoundaryResidual>, BemError> {
    let all: Vec<_> = elements.into_par_iter().map(|e| element_residual(mesh, field, traction, look, e)).collect();
    all.into_iter().collect()
}

fn element_residual(
    mesh: &Mesh,
    field: &BoundaryField,
    traction: &(dyn Fn(&Site) -> [Option<f64>; 2] + Sync),
    look: Look,
    e: usize,
) -> Result<BoundaryResidual, BemError> {
    let (mut neumann, mut equation) = (0.0, 0.0);
    // |γ'| over half of the length
    let half = mesh.length(e) / 2.0;
    let stretch = |t: f64| if mesh.is_line(e) { 1.0 } else { mesh.speed(e, t) / half };
    for panel in look.panels(mesh.degree[e], &[]) {
        for (&t, &w) in panel.points.iter().zip(&panel.weights) {
            let site = Site::new(mesh, e, t);
            let (steklov, slope) = field.boundary_derivatives(e, t, 0..mesh.len());
            let w = w * stretch(t);
            equation += w * dot(slope, slope);
            for (given, steklov) in traction(&site).into_iter().zip(steklov) {
                let Some(value) = given else { continue };
                if !value.is_finite() {
                    let (name, side) = ("traction".into(), mesh.side_names[mesh.side[e]].clone());
                    return Err(BemError::DataNotFinite { name, side, point: site.point, value });
                }
                neumann += w * (value - steklov).powi(2);
            }
        }
    }
    let (h, p, young) = (mesh.length(e), mesh.degree[e] as f64, field.material().young);
    // ds = h/2 dt
    let (neumann, equation) = (h / (p * young) * (h / 2.0) * neumann, h * young / p * (h / 2.0) * equation);
    Ok(BoundaryResidual { neumann, equation })
}

/// How accurately residuals are integrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// Integrated by [`residual_panels`]: to 1 % of their norm.
    Close,
    /// Sampled at 8 to 8 + 2p points of an element of degree p, to a factor of about two: enough to see whether they are large
    /// enough to count.
    Quick,
}

impl Look {
    /// The rules on an element of degree p, cut at the given kinks of the data too.
    pub fn panels(self, degree: usize, kinks: &[f64]) -> Vec<Rule> {
        match self {
            Self::Close => residual_panels(degree, kinks),
            Self::Quick => graded_panels(1, 2, degree, kinks),
        }
    }
}

/// Layers towards each end of an element, and their ratio.
const LAYERS: usize = 3;
const RATIO: f64 = 0.15;
/// Gauss points on a layer.
const POINTS: usize = 5;

/// Rules for squared residuals on an element of degree p: panels of [-1, 1] that get smaller towards both ends, where
/// σ^h and w' have logarithmic singularities, cut at the given kinks of the data too.
///
/// Three layers of ratio 0.15 with 5 points, and 5 + p/2 points on each half of the rest, miss about 1 % of the norm.
pub fn residual_panels(degree: usize, kinks: &[f64]) -> Vec<Rule> {
    graded_panels(LAYERS, POINTS, degree, kinks)
}

/// Rules on panels of [-1, 1] that get smaller towards both ends by layers of ratio 0.15, cut at the given points: `points` on
/// a layer, and p/2 more on each half of the rest.
pub fn graded_panels(layers: usize, points: usize, degree: usize, cuts: &[f64]) -> Vec<Rule> {
    let layer = |k: usize| RATIO.powi(k as i32);
    let mut breaks: Vec<f64> = (1..=layers).flat_map(|k| [layer(k) - 1.0, 1.0 - layer(k)]).collect();
    breaks.extend([-1.0, 0.0, 1.0]);
    breaks.extend(cuts.iter().filter(|t| t.abs() < 1.0));
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    let (inner, outer) = (gauss_legendre(points + degree / 2), gauss_legendre(points));
    let base = |middle: f64| if middle.abs() < 1.0 - RATIO { &inner } else { &outer };
    breaks.windows(2).map(|b| base((b[0] + b[1]) / 2.0).mapped(b[0], b[1])).collect()
}
