//! Solutions on coarse cells measured against the one on all fine cells.

use std::sync::atomic::{AtomicUsize, Ordering};

use steklov_model::error::SolveError;
use steklov_model::grid::{CoarseSolved, GridLayout, GridSolved, solve_grid};
use steklov_model::stage::Stage;
use steklov_msfem::{CoarseMesh, Extra, Loads, MsfemError, Multiscale};
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

/// Those that are made of the material, which the examples have; the last is enlarged by half a coarse cell.
pub const FITTED: [(&str, BasisInput); 3] = [BASES[2], BASES[3], BASES[4]];

/// What is said of a solution that is none.
pub(super) const NOT_CONVERGED: &str = "the contact solver did not reach its criterion";

/// After a wish to stop nothing more is solved.
fn stopped(interrupts: &AtomicUsize) -> impl FnMut(Stage<'_>) -> Result<(), SolveError> + '_ {
    |_| if interrupts.load(Ordering::Relaxed) > 0 { Err(SolveError::Interrupted) } else { Ok(()) }
}

/// Bilinear elements on all cells, each cut into `parts` × `parts`.
pub(super) fn on_all_cells(scene: &Scene, parts: usize, interrupts: &AtomicUsize) -> Result<GridSolved, SolveError> {
    solve_grid(scene, &GridLayout { parts, coarse: None, around: None }, &mut stopped(interrupts))
}

/// Multiscale elements on coarse cells of `fine` cells each. `oversample` as in [`GridInput`].
pub(super) fn on_coarse_cells(
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

/// What [`timed`] gives: the solution, and the median of its seconds.
pub(super) type Timed = (GridSolved, f64);

/// Solves `repeat` times, at least once; wall seconds without those of the estimate.
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

/// Σ_T a_T(u_h - u_H, u_h - u_H)^½ over a(u_h, u_h)^½: u_h on all cells, u_H on coarse ones, T the coarse cells, in each of which
/// a basis that does not conform has a field of its own.
pub(super) fn error(truth: &GridSolved, solved: &GridSolved) -> Result<f64, SolveError> {
    let squared = match &solved.coarse {
        Some(coarse) if !coarse.basis.is_conforming() => broken(truth, coarse)?,
        _ => {
            let difference: Vec<f64> =
                truth.displacement.iter().zip(&solved.displacement).map(|(a, b)| a - b).collect();
            truth.body.energy(&difference, &difference)
        }
    };
    Ok(squared.max(0.0).sqrt() / norm(truth))
}

/// The squared error, cell by cell.
fn broken(truth: &GridSolved, coarse: &CoarseSolved) -> Result<f64, MsfemError> {
    let body = &truth.body;
    let mut problem = Multiscale::new(body, coarse.mesh.clone(), coarse.basis)?;
    // the bases once more, those of equal cells once
    problem.assemble(&Loads::default(), &Extra::default(), &mut |_| true)?;
    let mut values = vec![0.0; problem.dofs()];
    for (unknown, u) in problem.unknown.iter().zip(&coarse.displacement) {
        if let Some(unknown) = unknown {
            values[*unknown..*unknown + 2].copy_from_slice(u);
        }
    }
    let mut squared = 0.0;
    let extra = Extra { lift: coarse.lift.clone(), ..Extra::default() };
    problem.downscale_cells(&values, &Loads::default(), &extra, &mut |_| true, |cell, field| {
        for (fine, u) in problem.fine_values(cell, field) {
            let exact = body.cell_values(&truth.displacement, fine);
            squared += body.cell_energy(fine, &std::array::from_fn(|a| u[a] - exact[a]));
        }
    })?;
    Ok(squared)
}

/// The estimate of that error; NaN of bases that do not conform.
pub(super) fn estimate(truth: &GridSolved, solved: &GridSolved) -> f64 {
    solved.estimate.as_ref().map_or(f64::NAN, |e| e.multiscale.sqrt() / norm(truth))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An L with displacements that are no polynomials of degree one on its sides.
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
        // enlarged by nothing, the oversampled basis is the coupled one, but counts as one that does not conform
        let scene = steklov_document::parse(L, "L", &[]).unwrap();
        let run = &AtomicUsize::new(0);
        let truth = on_all_cells(&scene, 1, run).unwrap();
        let error = |basis, oversample| {
            let solved = on_coarse_cells(&scene, [4, 4], basis, oversample, run).unwrap();
            (error(&truth, &solved).unwrap(), estimate(&truth, &solved))
        };
        let (whole, estimated) = error(BasisInput::Coupled, None);
        let (by_cells, unknown) = error(BasisInput::Oversampled, Some(0));
        assert!((by_cells - whole).abs() < 1e-9 * whole, "{by_cells} {whole}");
        assert!(whole > 0.01 && estimated > whole && unknown.is_nan(), "{whole} {estimated}");
        let enlarged = error(BasisInput::Oversampled, None).0;
        assert!((enlarged - whole).abs() > 0.01 * whole, "{enlarged} {whole}");
        let at_once = on_all_cells(&scene, 1, &AtomicUsize::new(1));
        assert!(matches!(at_once, Err(SolveError::Interrupted)));
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
