//! Residuals of the grid's displacement in the equations of the body, cell by cell.

use rayon::prelude::*;
use steklov_msfem::{HeterogeneousBody, SideTraction};
use steklov_quadrature::gauss_legendre;

/// Residuals of bilinear elements in each cell of the bounding box of a grid, 0 in dropped ones, as squares of energies (force
/// times length per thickness).
///
/// They measure the error against the exact solution; [`steklov_msfem::Indicators`] measure the error of multiscale elements
/// against the grid.
///
/// Cost: 9 points a cell and 3 on each side. Parallel over cells, the same bits for any number of threads.
///
/// Source: Verfürth, *A posteriori error estimation techniques for finite element methods*, 2013, with moduli as weights;
/// the factor of interpolation is left out.
#[derive(Debug, Clone, PartialEq)]
pub struct CellIndicators {
    /// h²/E ‖f + div σ(u)‖², h the larger side of the cell.
    pub volume: Vec<f64>,
    /// Half of Σ h w ‖J/2‖² over the sides with a neighbour, J the jump of σ(u)n there, h the length of the side and
    /// w = 2/(E⁺ + E⁻); the other half belongs to the neighbour.
    pub jump: Vec<f64>,
    /// Σ h/E ‖t - σ(u)n‖² over the sides on the boundary, of the components that are given there.
    pub neumann: Vec<f64>,
}

impl CellIndicators {
    /// The residuals of a displacement u (length) of all nodes under a body force f (force per area per thickness);
    /// `traction(cell, side)` is the mean traction (stress) on a side of the boundary, None for a component that is not given there,
    /// as on an interface.
    ///
    /// # Panics
    /// If u has fewer values than the grid has unknowns.
    pub fn new(
        body: &HeterogeneousBody,
        u: &[f64],
        force: &(dyn Fn([f64; 2]) -> [f64; 2] + Sync),
        traction: &SideTraction<'_>,
    ) -> Self {
        let [nx, ny] = body.grid.cells;
        let terms = |cell: usize| {
            if body.grid.inside(cell / ny, cell % ny) {
                let [jump, neumann] = sides(body, u, traction, cell);
                [volume(body, u, force, cell), jump, neumann]
            } else {
                [0.0; 3]
            }
        };
        let all: Vec<[f64; 3]> = (0..nx * ny).into_par_iter().map(terms).collect();
        let [volume, jump, neumann] = [0, 1, 2].map(|k| all.iter().map(|terms| terms[k]).collect());
        Self { volume, jump, neumann }
    }

    /// The sum of all terms of each cell.
    pub fn squared(&self) -> Vec<f64> {
        (0..self.volume.len()).map(|c| self.volume[c] + self.jump[c] + self.neumann[c]).collect()
    }
}

fn volume(body: &HeterogeneousBody, u: &[f64], force: &(dyn Fn([f64; 2]) -> [f64; 2] + Sync), cell: usize) -> f64 {
    let (grid, young) = (&body.grid, body.young[cell]);
    let ([hx, hy], [x, y]) = (grid.spacing, grid.lattice_point(grid.cell(cell)));
    let u = body.cell_values(u, cell);
    // of the second derivatives only the mixed one: div σ = (λ + μ) (∂xy u_y, ∂xy u_x)
    let mixed = [0, 1].map(|i| (u[i] - u[2 + i] + u[4 + i] - u[6 + i]) / (hx * hy));
    let elasticity = body.elasticity_of(cell);
    let (lambda, mu) = (elasticity.unit_stress([0.0, 1.0, 0.0])[0], elasticity.unit_stress([0.0, 0.0, 1.0])[2]);
    let divergence = [1, 0].map(|i: usize| young * (lambda + mu) * mixed[i]);
    let rule = gauss_legendre(3).mapped(0.0, 1.0);
    let mut sum = 0.0;
    for (a, wa) in rule.points.iter().zip(&rule.weights) {
        for (b, wb) in rule.points.iter().zip(&rule.weights) {
            let f = force([x + a * hx, y + b * hy]);
            sum += wa * wb * hx * hy * ((f[0] + divergence[0]).powi(2) + (f[1] + divergence[1]).powi(2));
        }
    }
    hx.max(hy).powi(2) / young * sum
}

/// Jumps to the neighbours, and the residuals of given tractions.
fn sides(body: &HeterogeneousBody, u: &[f64], traction: &SideTraction<'_>, cell: usize) -> [f64; 2] {
    let grid = &body.grid;
    let [ix, iy] = grid.cell(cell);
    let [nx, ny] = grid.cells;
    // right, upper, left and lower neighbour, where there is one
    let neighbours = [
        (ix + 1 < nx).then_some([ix + 1, iy]),
        (iy + 1 < ny).then_some([ix, iy + 1]),
        ix.checked_sub(1).map(|ix| [ix, iy]),
        iy.checked_sub(1).map(|iy| [ix, iy]),
    ];
    let rule = gauss_legendre(3).mapped(0.0, 1.0);
    // (σ_xx, σ_xy) or (σ_xy, σ_yy) on the lower or upper line across an axis
    let across = |cell: usize, axis: usize, upper: bool, at: f64| {
        let side = f64::from(u8::from(upper));
        let local = if axis == 0 { [side, at] } else { [at, side] };
        let values = body.cell_values(u, cell);
        let [xx, yy, xy] = body.stress(cell, &values, local);
        if axis == 0 { [xx, xy] } else { [xy, yy] }
    };
    let (mut jump, mut neumann) = (0.0, 0.0);
    for (k, neighbour) in neighbours.into_iter().enumerate() {
        let (axis, upper) = (k % 2, k < 2);
        let length = grid.spacing[1 - axis];
        let Some([jx, jy]) = neighbour.filter(|&[jx, jy]| grid.inside(jx, jy)) else {
            // sides of a cell are counted from the lower one, to the left
            let given = traction(cell, [1, 2, 3, 0][k]);
            let outward = if upper { 1.0 } else { -1.0 };
            for (&at, w) in rule.points.iter().zip(&rule.weights) {
                let own = across(cell, axis, upper, at);
                let left = [0, 1].map(|i| given[i].map_or(0.0, |given| given - outward * own[i]));
                neumann += length * length / body.young[cell] * w * (left[0].powi(2) + left[1].powi(2));
            }
            continue;
        };
        let other = jx * ny + jy;
        let weight = 2.0 / (body.young[cell] + body.young[other]);
        for (&at, w) in rule.points.iter().zip(&rule.weights) {
            let (own, beyond) = (across(cell, axis, upper, at), across(other, axis, !upper, at));
            let half = [0, 1].map(|i| (own[i] - beyond[i]) / 2.0);
            jump += 0.5 * length * length * weight * w * (half[0].powi(2) + half[1].powi(2));
        }
    }
    [jump, neumann]
}
