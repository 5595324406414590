//! The pointwise Steklov-Poincaré trace as a matrix: from nodal displacements to σ^h = S_hp u at points of the boundary.
//!
//! ```text
//! σ^h(u)(x) = A(x) û' + B(x) ψ,     ψ = V⁻¹H u = L⁻ᵀ (L⁻¹H) u
//! ```
//! A and B are the rows that [`BoundaryField::steklov_trace`](crate::BoundaryField::steklov_trace) applies to one field,
//! û' are the Legendre coefficients of du/dt. Every element of the boundary contributes to every point.

use faer::Mat;
use rayon::prelude::*;
use steklov_algebra::{add_product, solve_lower};
use steklov_elastic::Material;
use steklov_quadrature::legendre_p;

use crate::near::MAX_ORDER;
use crate::potential::{AtPoint, BoundaryField};
use crate::{BemError, Mesh, Space, TractionMap};

/// σ^h at the reference coordinates of the elements `(e, t)`: rows 2i and 2i+1 are its x and y components at point i,
/// columns the nodal displacements (stress per displacement).
///
/// *Use when* σ^h of all basis functions is wanted, as stabilised multipliers do. Between element ends σ^h is smooth; at
/// every element end it has a logarithmic singularity, so that integrals of its square want rules graded to these.
/// *Cost*: m points and n unknowns: m n Legendre functions and 6 m n² operations. Parallel over points; the same bits for
/// any number of threads.
///
/// # Errors
/// [`BemError::Fault`].
///
/// Source: Issaoui (2014), equation (3.7).
pub fn steklov_trace_rows(
    mesh: &Mesh,
    space: &Space,
    material: &Material,
    traction: &TractionMap,
    points: &[(usize, f64)],
) -> Result<Mat<f64>, BemError> {
    let n = space.dofs();
    let zeros = vec![0.0; n];
    // the geometry alone; L does not enter derivatives
    let field = BoundaryField::new(mesh, space, material, &zeros, &zeros, 1.0);
    let rows: Vec<[Vec<f64>; 4]> = points.par_iter().map(|&(e, t)| point_rows(&field, space, e, t)).collect();
    let mut result = Mat::from_fn(2 * points.len(), n, |i, j| rows[i / 2][i % 2][j]);
    let (factor, solved, of_solved) = traction.factors();
    let mut densities = Mat::from_fn(n, 2 * points.len(), |j, i| rows[i / 2][2 + i % 2][j]);
    solve_lower(factor, densities.as_mut(), None)?;
    add_product(result.as_mut(), densities.transpose(), solved, 1.0, of_solved)?;
    Ok(result)
}

/// The x and y rows on nodal displacements (through û'), and on the coefficients of the traction.
fn point_rows(field: &BoundaryField, space: &Space, e: usize, t: f64) -> [Vec<f64>; 4] {
    let k = &field.constants;
    let own = &field.elements[e];
    let slope_own = own.curve.derivative(t);
    let speed = slope_own.norm();
    let tangent = slope_own / speed;
    let mut rows = [(); 4].map(|()| vec![0.0; space.dofs()]);
    let mut at = AtPoint::default();
    let mut legendre = [0.0; MAX_ORDER];
    let legendre = &mut legendre[..own.traction.len()];
    legendre_p(t, legendre);
    for (b, piece) in field.elements.iter().enumerate() {
        at.on_boundary(piece, own, b == e, t);
        let half = piece.half;
        let derivative = &space.basis(b).derivative_to_legendre;
        for n in 0..piece.traction.len() {
            let (log, [xx, yy, xy]) = at.slope(n, tangent);
            // -c_W (-log I + rr) on û'
            let a = [[-k.c_w * (xx - log), -k.c_w * xy], [-k.c_w * xy, -k.c_w * (yy - log)]];
            for (j, node) in space.element_nodes(b).enumerate() {
                let d = derivative[(n, j)];
                for i in 0..2 {
                    rows[i][2 * node] += a[i][0] * d;
                    rows[i][2 * node + 1] += a[i][1] * d;
                }
            }
            // K' = K'_Δ + J d/ds (2μV - V_Δ), and ψ/2 on the element itself
            let (hxx, hyy, hxy) = (k.h_log * log + k.h_rr * xx, k.h_log * log + k.h_rr * yy, k.h_rr * xy);
            let scalar = match b == e {
                true if own.curve.is_line() => 0.5 * legendre[n],
                true => half * (0.5 * legendre[n] / speed + at.adjoint(n, tangent)),
                false => half * at.adjoint(n, tangent),
            };
            let c = 2 * (space.offset[b] + n);
            rows[2][c] = scalar - half * hxy;
            rows[2][c + 1] = -half * hyy;
            rows[3][c] = half * hxx;
            rows[3][c + 1] = scalar + half * hxy;
        }
    }
    rows
}
