//! The contributions of all elements on one of them: distant elements contribute smoothly, so that few points suffice.

use steklov_bem_operators::{BoundaryField, Mesh, distance_to_segment};
use steklov_quadrature::{gauss_legendre, legendre_p};

use crate::subdivided::Subdivided;

/// Number of points that represent the contribution of distant elements.
const POINTS: usize = 8;
/// Distance of such elements from the middle of the element, in its lengths: 8 points represent logarithms there to about 1e-7.
const DISTANCE: f64 = 2.0;

/// W ξ + (K' + ½) φ and the slope of (K + ½) ξ - V φ on one element.
pub(crate) struct Split {
    /// Parts of elements that are near.
    near: Vec<usize>,
    /// Legendre coefficients of the contribution of the others: both components of both traces.
    far: [[f64; 4]; POINTS],
}

impl Split {
    pub fn new(field: &BoundaryField, parts: &Subdivided, mesh: &Mesh, e: usize) -> Self {
        let (middle, reach) = (mesh.point(e, 0.0), DISTANCE * mesh.length(e));
        let is_near = |b: &usize| distance_to_segment(middle, parts.mesh.ends(*b)) < reach;
        let (near, others): (Vec<usize>, Vec<usize>) = (0..parts.mesh.len()).partition(is_near);
        let mut far = [[0.0; 4]; POINTS];
        if !others.is_empty() {
            let rule = gauss_legendre(POINTS);
            let mut legendre = [0.0; POINTS];
            for (&t, w) in rule.points.iter().zip(&rule.weights) {
                let (child, s) = parts.place(e, t);
                let ([a, b], [c, d]) = field.boundary_derivatives(child, s, others.iter().copied());
                legendre_p(t, &mut legendre);
                for (m, (sum, p)) in far.iter_mut().zip(legendre).enumerate() {
                    let weight = (m as f64 + 0.5) * w * p;
                    sum.iter_mut().zip([a, b, c, d]).for_each(|(sum, value)| *sum += weight * value);
                }
            }
        }
        Self { near, far }
    }

    /// Both at the point t of the element, which is s of its part `child`.
    pub fn at(&self, field: &BoundaryField, t: f64, child: usize, s: f64) -> ([f64; 2], [f64; 2]) {
        let (mut traction, mut slope) = field.boundary_derivatives(child, s, self.near.iter().copied());
        let mut legendre = [0.0; POINTS];
        legendre_p(t, &mut legendre);
        for ([a, b, c, d], p) in self.far.iter().zip(legendre) {
            traction = [traction[0] + p * a, traction[1] + p * b];
            slope = [slope[0] + p * c, slope[1] + p * d];
        }
        (traction, slope)
    }
}
