//! Errors of solutions on coarse cells against the solution on all fine cells.

use std::sync::atomic::{AtomicUsize, Ordering};

use steklov_model::error::SolveError;
use steklov_model::grid::{CoarseSolved, GridLayout, GridSolved, solve_grid};
use steklov_model::stage::Stage;
use steklov_msfem::{CoarseMesh, Extra, HeterogeneousBody, Loads, MsfemError, Multiscale};
use steklov_problem::{BasisInput, GridInput, Scene, grid_of};

use crate::median;

/// The bases and their names in scenes, in the order in which they are studied.
pub const BASES: [(&str, BasisInput); 5] = [
    ("q1", BasisInput::Q1),
    ("linear", BasisInput::Linear),
    ("coupled", BasisInput::Coupled),
    ("oscillatory", BasisInput::Oscillatory),
    ("oversampled", BasisInput::Oversampled),
];

/// The bases that follow the material, as used in the examples; the last is enlarged by half a coarse cell.
pub const FITTED: [(&str, BasisInput); 3] = [BASES[2], BASES[3], BASES[4]];

/// The message for a solution that did not converge.
pub(super) const NOT_CONVERGED: &str = "the contact solver did not reach its criterion";

/// The observer that ends a solve after a request to stop.
fn stopped(interrupts: &AtomicUsize) -> impl FnMut(Stage<'_>) -> Result<(), SolveError> + '_ {
    |_| if interrupts.load(Ordering::Relaxed) > 0 { Err(SolveError::Interrupted) } else { Ok(()) }
}

/// Bilinear elements on all cells, each cut into `parts` × `parts`.
pub(crate) fn on_all_cells(scene: &Scene, parts: usize, interrupts: &AtomicUsize) -> Result<GridSolved, SolveError> {
    solve_grid(scene, &GridLayout { parts, coarse: None, around: None }, &mut stopped(interrupts))
}

/// Multiscale elements on coarse cells of `fine` cells each. `oversample` as in [`GridInput`].
pub(crate) fn on_coarse_cells(
    scene: &Scene,
    fine: [usize; 2],
    basis: BasisInput,
    oversample: Option<usize>,
    interrupts: &AtomicUsize,
) -> Result<GridSolved, SolveError> {
    let mut scene = scene.clone();
    let grid = grid_of(&scene)?;
    let coarse = [0, 1].map(|k| grid.cells[k] / fine[k]);
    scene.body_mut().grid = Some(GridInput { coarse, fine, basis, oversample });
    let coarse = Some(CoarseMesh::uniform(&grid, fine)?.cells);
    solve_grid(&scene, &GridLayout { parts: 1, coarse, around: None }, &mut stopped(interrupts))
}

/// The result of [`timed`]: the solution, and the median of its seconds.
pub(super) type Timed = (GridSolved, f64);

/// Solves `repeat` times, at least once; wall seconds without the estimate.
pub(super) fn timed(
    repeat: usize,
    mut solve: impl FnMut() -> Result<GridSolved, SolveError>,
) -> Result<Timed, SolveError> {
    let seconds = |s: &GridSolved| {
        let s = &s.seconds;
        s.set_up + s.assemble + s.factorise + s.solve
    };
    let first = solve()?;
    let mut all = vec![seconds(&first)];
    for _ in 1..repeat {
        all.push(seconds(&solve()?));
    }
    Ok((first, median(&mut all)))
}

/// a(u, u)^½ of a solution.
pub(super) fn norm(solved: &GridSolved) -> f64 {
    (2.0 * solved.energies.strain).sqrt()
}

/// The relative errors in the energy norm and of the displacement in the L² norm: Σ_T a_T(u_h - u_H, u_h - u_H)^½ over
/// a(u_h, u_h)^½, and ‖u_h - u_H‖ over ‖u_h‖. u_h is on all cells, u_H on coarse ones; T are the coarse cells, in each
/// of which a nonconforming basis has a field of its own. Both are exact for bilinear fields on the fine cells.
pub(super) fn error(truth: &GridSolved, solved: &GridSolved) -> Result<[f64; 2], SolveError> {
    let body = &truth.body;
    let [energy, square] = match &solved.coarse {
        Some(coarse) if !coarse.basis.is_conforming() => broken(truth, coarse)?,
        _ => {
            let difference: Vec<f64> =
                truth.displacement.iter().zip(&solved.displacement).map(|(a, b)| a - b).collect();
            [body.energy(&difference, &difference), square(body, &difference)]
        }
    };
    Ok([energy.max(0.0).sqrt() / norm(truth), (square / self::square(body, &truth.displacement)).sqrt()])
}

/// ∫ u·u over the body, from the values of u at the fine nodes (length⁴).
fn square(body: &HeterogeneousBody, u: &[f64]) -> f64 {
    let spacing = body.grid.spacing;
    body.grid.body_cells().map(|cell| cell_square(spacing, &body.cell_values(u, cell))).sum()
}

/// ∫ u·u of a bilinear field over a rectangle, from its values at the corners, counter-clockwise, in closed form.
fn cell_square([hx, hy]: [f64; 2], u: &[f64; 8]) -> f64 {
    // hx hy / 36 times 4 for a corner with itself, 1 with the opposite corner, 2 with the adjacent ones
    let weight = |a: usize, b: usize| [4.0, 2.0, 1.0, 2.0][(4 + a - b) % 4];
    let row =
        |a: usize| (0..4).map(|b| weight(a, b) * (u[2 * a] * u[2 * b] + u[2 * a + 1] * u[2 * b + 1])).sum::<f64>();
    hx * hy / 36.0 * (0..4).map(row).sum::<f64>()
}

/// The squared errors, cell by cell: energy and ∫ |e|².
fn broken(truth: &GridSolved, coarse: &CoarseSolved) -> Result<[f64; 2], MsfemError> {
    let body = &truth.body;
    let mut problem = Multiscale::new(body, coarse.mesh.clone(), coarse.basis)?;
    // computes the bases again, once for equal cells
    problem.assemble(&Loads::default(), &Extra::default(), &mut |_| true)?;
    let mut values = vec![0.0; problem.dofs()];
    for (unknown, u) in problem.unknown.iter().zip(&coarse.displacement) {
        if let Some(unknown) = unknown {
            values[*unknown..*unknown + 2].copy_from_slice(u);
        }
    }
    let mut squared = [0.0; 2];
    let extra = Extra { lift: coarse.lift.clone(), ..Extra::default() };
    problem.downscale_cells(&values, &Loads::default(), &extra, &mut |_| true, |cell, field| {
        for (fine, u) in problem.fine_values(cell, field) {
            let exact = body.cell_values(&truth.displacement, fine);
            let difference = std::array::from_fn(|a| u[a] - exact[a]);
            squared[0] += body.cell_energy(fine, &difference);
            squared[1] += cell_square(body.grid.spacing, &difference);
        }
    })?;
    Ok(squared)
}

/// The estimate of the error in the energy norm; NaN for nonconforming bases.
pub(super) fn estimate(truth: &GridSolved, solved: &GridSolved) -> f64 {
    solved.estimate.as_ref().map_or(f64::NAN, |e| e.multiscale.sqrt() / norm(truth))
}

#[cfg(test)]
mod tests {
    use steklov_elastic::Plane;
    use steklov_msfem::{Elasticity, Grid};

    use super::*;

    /// An L-shaped body whose displacements are not linear on its sides.
    const L: &str = r#"title = "L"
[body]
corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]
sides = ["floor", "right", "step", "inner", "top", "left"]
[material]
poisson = 0.3
cells = { size = 0.125, young = { uniform = [1, 9], seed = 7 } }
[sides.floor]
displacement = ["x^2", "sin(x)"]
[sides.left]
displacement = [0, "y^2"]
[sides.top]
traction = [1, -1]
[grid]
coarse = [4, 4]
fine = [4, 4]
"#;

    #[test]
    fn fields_cell_by_cell_have_the_error_of_the_whole() {
        // the oversampled basis, enlarged by nothing, equals the coupled one, but counts as nonconforming
        let scene = steklov_document::parse(L, "L", &[]).unwrap();
        let run = &AtomicUsize::new(0);
        let truth = on_all_cells(&scene, 1, run).unwrap();
        let error = |basis, oversample| {
            let solved = on_coarse_cells(&scene, [4, 4], basis, oversample, run).unwrap();
            let [energy, displacement] = error(&truth, &solved).unwrap();
            (energy, displacement, estimate(&truth, &solved))
        };
        let (whole, displaced, estimated) = error(BasisInput::Coupled, None);
        let (by_cells, displaced_by_cells, unknown) = error(BasisInput::Oversampled, Some(0));
        assert!((by_cells - whole).abs() < 1e-9 * whole, "{by_cells} {whole}");
        assert!((displaced_by_cells - displaced).abs() < 1e-9 * displaced, "{displaced_by_cells} {displaced}");
        assert!(whole > 0.01 && estimated > whole && unknown.is_nan(), "{whole} {estimated}");
        let enlarged = error(BasisInput::Oversampled, None).0;
        assert!(displaced > 1e-3 && displaced < whole, "{displaced} {whole}");
        assert!((enlarged - whole).abs() > 0.01 * whole, "{enlarged} {whole}");
        let at_once = on_all_cells(&scene, 1, &AtomicUsize::new(1));
        assert!(matches!(at_once, Err(SolveError::Interrupted)));
    }

    /// u = (a + b x + c y + d x y, x y) over the rectangle (0, 3) × (0, 2), cell by cell on any grid.
    #[test]
    fn the_square_of_a_bilinear_field_is_its_integral() {
        let [a, b, c, d] = [0.7, -1.3, 0.4, 2.1];
        // ∫ xⁱ yʲ = 3^(i+1)/(i+1) 2^(j+1)/(j+1)
        let moment = |i: i32, j: i32| 3f64.powi(i + 1) / f64::from(i + 1) * 2f64.powi(j + 1) / f64::from(j + 1);
        let squares = a * a * moment(0, 0) + b * b * moment(2, 0) + c * c * moment(0, 2) + (d * d + 1.0) * moment(2, 2);
        let mixed = a * b * moment(1, 0) + a * c * moment(0, 1) + (a * d + b * c) * moment(1, 1);
        let exact = squares + 2.0 * (mixed + b * d * moment(2, 1) + c * d * moment(1, 2));
        for cells in [[1, 1], [2, 5], [7, 3]] {
            let grid = Grid::rectangle([3.0, 2.0], cells).unwrap();
            let u: Vec<f64> = (0..grid.nodes())
                .map(|node| grid.point(node))
                .flat_map(|[x, y]| [a + b * x + c * y + d * x * y, x * y])
                .collect();
            let elasticity = Elasticity::new(0.3, Plane::Strain).unwrap();
            let body = HeterogeneousBody::new(grid, vec![1.0; cells[0] * cells[1]], elasticity).unwrap();
            let found = square(&body, &u);
            assert!((found - exact).abs() < 1e-12 * exact, "{cells:?}: {found} {exact}");
        }
    }

    #[test]
    fn seconds_are_medians_of_as_many_runs_as_are_asked_for() {
        let scene = steklov_document::parse(L, "L", &[]).unwrap();
        for (repeat, wanted) in [(0, 1), (1, 1), (3, 3)] {
            let mut runs = 0;
            let solve = || {
                runs += 1;
                on_all_cells(&scene, 1, &AtomicUsize::new(0))
            };
            let (_, seconds) = timed(repeat, solve).unwrap();
            assert!(seconds > 0.0);
            assert_eq!(runs, wanted);
        }
    }
}
