//! The part of the loads that the cells of a grid do not resolve: none of their functions feels it.

use std::f64::consts::PI;

use rayon::prelude::*;
use steklov_bem_operators::side_moments_and_squares;
use steklov_msfem::{HeterogeneousBody, Loads};
use steklov_problem::Scene;
use steklov_quadrature::gauss_legendre;

use super::trace::GridTrace;
use crate::data::on_mesh::OnMesh;
use crate::error::SolveError;

/// Rounding error of the resolved part of a square, relative to the square.
const ROUNDING: f64 = 1e-12;
/// Gauss points of a cell along an axis.
const POINTS: usize = 6;

/// The energy of loads that vary within a cell like a wave of its length h:
///
/// ```text
/// Σ_cells (h/2π)²/E ‖f - P f‖² + Σ_sides h/(πE) ‖t - P t‖²,     P the projection on bilinear or linear functions in L²
/// ```
///
/// # Errors
/// Loads that are not finite.
pub(super) fn load_oscillation(
    scene: &Scene,
    body: &HeterogeneousBody,
    loads: &Loads,
    fine: &GridTrace,
) -> Result<f64, SolveError> {
    Ok(of_body_force(scene, body, loads) + of_tractions(scene, body, fine)?)
}

fn of_body_force(scene: &Scene, body: &HeterogeneousBody, loads: &Loads) -> f64 {
    if scene.body().force.is_none() || scene.body().constant_force().is_some() {
        return 0.0;
    }
    let grid = &body.grid;
    let ([hx, hy], rule) = (grid.spacing, gauss_legendre(POINTS).mapped(0.0, 1.0));
    let of_cell = |&cell: &usize| -> f64 {
        let [x, y] = grid.lattice_point(grid.cell(cell));
        let mut square = 0.0;
        for (a, wa) in rule.points.iter().zip(&rule.weights) {
            for (b, wb) in rule.points.iter().zip(&rule.weights) {
                let [fx, fy] = scene.force_at([x + a * hx, y + b * hy]).unwrap_or([f64::NAN; 2]);
                square += wa * wb * hx * hy * (fx * fx + fy * fy);
            }
        }
        let h = hx.max(hy) / (2.0 * PI);
        h * h / body.young[cell] * rest(square, bilinear(&loads.body[cell], hx * hy))
    };
    let cells: Vec<usize> = grid.body_cells().collect();
    cells.par_iter().map(of_cell).collect::<Vec<f64>>().iter().sum()
}

/// ‖P f‖² of the moments of f against the four bilinear functions of a cell, both components; counter-clockwise.
fn bilinear(moments: &[f64; 8], area: f64) -> f64 {
    // the inverse of the mass matrix: 4 of each corner, -2 of neighbours, 1 of opposite ones, times 4 over the area
    let weight = |i: usize, j: usize| [4.0, -2.0, 1.0, -2.0][(4 + i - j) % 4];
    let pairs = (0..4).flat_map(|i| (0..4).map(move |j| (i, j)));
    let product = |(i, j): (usize, usize)| -> f64 {
        weight(i, j) * (moments[2 * i] * moments[2 * j] + moments[2 * i + 1] * moments[2 * j + 1])
    };
    4.0 / area * pairs.map(product).sum::<f64>()
}

fn of_tractions(scene: &Scene, body: &HeterogeneousBody, fine: &GridTrace) -> Result<f64, SolveError> {
    let data = OnMesh { scene, mesh: &fine.mesh, space: &fine.space };
    let mut sum = 0.0;
    data.each_traction(&mut |side, name, expression, _, direction| {
        if expression.constant().is_some() {
            return Ok(());
        }
        let function = data.function(expression);
        let found = side_moments_and_squares(data.mesh, data.space, side, &function.datum(name));
        let (moments, squares) = found.map_err(|error| data.located(error, expression))?;
        for ((e, moments), square) in moments.into_iter().zip(squares) {
            let (h, young) = (data.mesh.length(e), body.young[fine.cell(&body.grid, e).0]);
            let (a, b) = (moments[0], moments[1]);
            let [nx, ny] = direction(e);
            let linear = 4.0 / h * (a * a - a * b + b * b);
            sum += h / (PI * young) * (nx * nx + ny * ny) * rest(square, linear);
        }
        Ok(())
    })?;
    Ok(sum)
}

/// The square of the unresolved part.
fn rest(square: f64, resolved: f64) -> f64 {
    let rest = square - resolved;
    if rest > ROUNDING * square { rest } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steklov_elastic::plane::dot;

    /// The projection keeps bilinear fields unchanged.
    #[test]
    fn bilinear_fields_are_resolved() {
        let (hx, hy, rule) = (0.5, 2.0, gauss_legendre(3).mapped(0.0, 1.0));
        let field = |a: f64, b: f64| [1.0 - 2.0 * a + 3.0 * a * b, b - 0.5 * a * b];
        let (mut moments, mut square) = ([0.0; 8], 0.0);
        for (a, wa) in rule.points.iter().zip(&rule.weights) {
            for (b, wb) in rule.points.iter().zip(&rule.weights) {
                let (f, w) = (field(*a, *b), wa * wb * hx * hy);
                let hats = [(1.0 - a) * (1.0 - b), a * (1.0 - b), a * b, (1.0 - a) * b];
                (0..8).for_each(|k| moments[k] += w * hats[k / 2] * f[k % 2]);
                square += w * dot(f, f);
            }
        }
        assert!((bilinear(&moments, hx * hy) / square - 1.0).abs() < 1e-13);
        assert_eq!(rest(square, bilinear(&moments, hx * hy)), 0.0);
    }
}
