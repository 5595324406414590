//! Errors of the bases on smaller and smaller coarse cells.

use steklov_model::error::SolveError;
use steklov_problem::DataErrorKind::{Unsupported, Value};
use steklov_problem::{DataError, Scene, check_body, grid_of};

use super::measure::{BASES, NOT_CONVERGED, error, estimate, on_coarse_cells, timed};
use super::{FineGrid, MOST_DOFS};
use crate::table::Column;
use crate::watch::{Found, Watch};

/// One basis on one coarse grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Number in [`BASES`].
    pub basis: usize,
    /// Coarse cells along x and y, over the bounding box.
    pub coarse: [usize; 2],
    /// Fine cells in each of them.
    pub fine: [usize; 2],
    /// Displacement unknowns, held ones included.
    pub dofs: usize,
    /// Local problems: different patterns of moduli.
    pub patterns: usize,
    /// Relative error in the energy norm against bilinear elements on the same fine cells.
    pub error: f64,
    /// Relative error of the displacement in the L² norm against the same elements.
    pub displacement: f64,
    /// Estimate of the error in the energy norm; NaN for nonconforming bases.
    pub estimate: f64,
    /// Relative error against the exact solution, with the error of the fine grid; NaN if that is unknown.
    pub total: f64,
    /// Wall seconds without the estimate.
    pub seconds: f64,
}

impl Point {
    /// Estimate over error.
    pub fn effectivity(&self) -> f64 {
        self.estimate / self.error
    }
}

/// Columns of the points.
pub(super) const POINTS: [Column<Point>; 12] = [
    ("coarse_x", "1", "coarse cells along x", |p| p.coarse[0] as f64),
    ("coarse_y", "1", "coarse cells along y", |p| p.coarse[1] as f64),
    ("fine_x", "1", "fine cells of a coarse cell along x", |p| p.fine[0] as f64),
    ("fine_y", "1", "fine cells of a coarse cell along y", |p| p.fine[1] as f64),
    ("dofs", "1", "displacement unknowns, held ones included", |p| p.dofs as f64),
    ("patterns", "1", "different patterns of moduli: local problems", |p| p.patterns as f64),
    ("error", "1", "relative error, energy norm, against bilinear elements on all fine cells", |p| p.error),
    ("estimate", "1", "its estimate; NaN of bases that do not conform", |p| p.estimate),
    ("effectivity", "1", "estimate over error", Point::effectivity),
    ("total_error", "1", "relative error, energy norm, with that of the fine grid", |p| p.total),
    ("displacement_error", "1", "relative error of the displacement, L2 norm, against the fine cells", |p| {
        p.displacement
    }),
    ("seconds", "seconds", "set-up, bases, assembly, factorisation, fine displacements", |p| p.seconds),
];

/// Errors by basis and coarse grid.
pub type Convergence = Found<Point>;

impl Convergence {
    /// The points of a basis.
    pub fn of(&self, basis: usize) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(move |p| p.basis == basis)
    }
}

/// Numbers of fine cells in the studied coarse cells: the numbers of the scene, their halves, quarters and so on, as
/// long as they are whole and not both 1, if the body consists of such coarse cells.
///
/// # Errors
/// A scene without a grid or without such cells; a fine grid with more unknowns than both [`MOST_DOFS`] and the scene
/// allow.
pub fn coarse_cells(scene: &Scene) -> Result<Vec<[usize; 2]>, DataError> {
    let refuse = |kind, key, message: String, help: &str| Err(DataError::at(kind, &[key], message, help));
    let Some(input) = &scene.body().grid else {
        let message = "the study is about coarse cells on a fine grid, and the scene has no [grid]".to_owned();
        let help =
            "add [grid] coarse = [12, 2], fine = [16, 16] with the numbers of the body, or study --what convergence";
        return refuse(Unsupported, vec!["body"], message, help);
    };
    let grid = grid_of(scene)?;
    let mut sizes = Vec::new();
    let mut fine = input.fine;
    while fine != [1, 1] {
        if check_body(scene, [0, 1].map(|k| grid.cells[k] / fine[k]), "coarse").is_ok() {
            sizes.push(fine);
        }
        if fine.iter().any(|n| !n.is_multiple_of(2)) {
            break;
        }
        fine = fine.map(|n| n / 2);
    }
    if sizes.is_empty() {
        let message = format!(
            "the study needs coarse cells of more than one fine cell that fit the body, and grid.fine is [{}, {}]",
            input.fine[0], input.fine[1]
        );
        let help = "take fewer coarse cells and more fine ones in each: grid.fine = [8, 8]";
        return refuse(Value, vec!["grid", "fine"], message, help);
    }
    let dofs = grid.dofs();
    if dofs > scene.method.max_dofs().max(MOST_DOFS) {
        let message = format!(
            "the fine grid has {dofs} dofs, and the study solves all of them at once: {MOST_DOFS} at most, or method.max_dofs"
        );
        let help = "take fewer fine cells, or raise method.max_dofs as far as the memory allows";
        return refuse(Value, vec!["grid", "fine"], message, help);
    }
    Ok(sizes)
}

/// Solves with every basis on coarse cells of these sizes. After a request to stop nothing more is solved.
pub fn convergence(
    scene: &Scene,
    fine_grid: &FineGrid,
    sizes: &[[usize; 2]],
    repeat: usize,
    watch: &mut Watch<'_>,
) -> Convergence {
    let mut all = Convergence::default();
    for (basis, &(name, input)) in BASES.iter().enumerate() {
        for &fine in sizes {
            if watch.stopped() {
                return all;
            }
            let cells = fine_grid.truth.body.grid.cells;
            let coarse = [0, 1].map(|k| cells[k] / fine[k]);
            let at = format!("{name}, {} by {} coarse cells", coarse[0], coarse[1]);
            watch.tell(name, &at);
            let solved = timed(repeat, || on_coarse_cells(scene, fine, input, None, watch.interrupts));
            let point = solved.and_then(|(solved, seconds)| {
                let [error, displacement] = error(&fine_grid.truth, &solved)?;
                Ok(solved.converged().then_some(Point {
                    basis,
                    coarse,
                    fine,
                    dofs: solved.dofs,
                    patterns: solved.coarse.as_ref().map_or(0, |c| c.patterns),
                    error,
                    displacement,
                    estimate: estimate(&fine_grid.truth, &solved),
                    // both errors are orthogonal if the coarse functions are fine functions
                    total: error.hypot(fine_grid.error()),
                    seconds,
                }))
            });
            match point {
                Ok(Some(point)) => all.points.push(point),
                Ok(None) => all.failures.push((at, NOT_CONVERGED.into())),
                Err(SolveError::Interrupted) => return all,
                Err(error) => all.failures.push((at, error.to_string())),
            }
        }
    }
    all
}
