//! The scene's own moduli, loads and remote stress: multiscale elements in the medium over the size H of coarse cells on one fine
//! grid, and both kinds of elements over the size h of the fine cells.
//!
//! With u in the body, ξ and φ the displacement and traction of the medium, the error is that of the estimates of
//! Theorems 5.5 and 5.6: (a(e_u, e_u) + ⟨W e_ξ, e_ξ⟩ + ⟨V e_φ, e_φ⟩)^½. Boundary elements have degree 1 and the points
//! of the body's trace as vertices. The errors of multiscale elements refer to bilinear elements on the same fine grid.
//! The errors of bilinear elements refer to the limit of fine grids: to the finest grid, whose own squared error is
//! extrapolated from three grids and added; with fewer grids nothing is added.

use steklov_model::error::SolveError;
use steklov_model::grid::GridSolved;
use steklov_problem::{BasisInput, GridInput, Scene, check_body, grid_of};

use super::convergence::ENERGY;
use super::distance::{Truth, around};
use super::grids::{FEWEST, Level};
use crate::multiscale::{BASES, on_all_cells, on_coarse_cells};
use crate::table::Column;
use crate::watch::Watch;

/// The elements of the body and their names: bilinear elements on all fine cells, and the conforming bases.
pub const ELEMENTS: [(&str, Option<BasisInput>); 5] = [
    ("bilinear", None),
    (BASES[0].0, Some(BASES[0].1)),
    (BASES[1].0, Some(BASES[1].1)),
    (BASES[2].0, Some(BASES[2].1)),
    (BASES[3].0, Some(BASES[3].1)),
];
/// Strain energy over E u² that rounding may give a rigid motion u.
const ROUNDED: f64 = 1e-12;
/// The elements that are solved on all fine grids.
const COUPLED: usize = 3;

/// One kind of elements on one grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Own {
    /// 0 over H on one fine grid, 1 over h.
    pub over: usize,
    /// Number in [`ELEMENTS`].
    pub elements: usize,
    /// Coarse cells along x and y, over the bounding box; for bilinear elements the fine cells.
    pub coarse: [usize; 2],
    /// Fine cells along x and y.
    pub cells: [usize; 2],
    /// H or h: the longer side of a coarse or fine cell (length).
    pub width: f64,
    /// Displacement unknowns of the body.
    pub dofs: usize,
    /// Displacement unknowns on the interface.
    pub trace: usize,
    /// Errors of the body (energy norm), of ξ (W) and of φ (V), relative to all three norms of the solution together.
    pub errors: [f64; 3],
    /// All three against the limit of fine grids; NaN with fewer than three grids.
    pub total: f64,
    /// r of error ~ width^r from the grid before; NaN for the first.
    pub rate: f64,
    /// The estimate of [`GridSolved::estimate`], over the same norm.
    pub estimate: f64,
    /// The residual estimator; NaN for bases that do not solve the equations inside coarse cells.
    pub residual: f64,
    /// Wall seconds of one run without the estimate.
    pub seconds: f64,
}

impl Own {
    /// Root of the sum of the squared errors.
    pub fn error(&self) -> f64 {
        self.errors.iter().map(|e| e * e).sum::<f64>().sqrt()
    }

    /// Residual estimator over error.
    pub fn effectivity(&self) -> f64 {
        self.residual / self.error()
    }
}

/// Columns of the points.
pub(super) const OWN: [Column<Own>; 19] = [
    ("over", "1", "0 over H on one fine grid, 1 over h", |p| p.over as f64),
    ("elements", "1", "0 bilinear; multiscale: 1 q1, 2 linear, 3 coupled, 4 oscillatory", |p| p.elements as f64),
    ("coarse_x", "1", "coarse cells along x; fine ones of bilinear elements", |p| p.coarse[0] as f64),
    ("coarse_y", "1", "the same along y", |p| p.coarse[1] as f64),
    ("cells_x", "1", "fine cells along x", |p| p.cells[0] as f64),
    ("cells_y", "1", "fine cells along y", |p| p.cells[1] as f64),
    ("width", "length", "longer side of a coarse cell (over H) or of a fine one (over h)", |p| p.width),
    ("dofs", "1", "displacement unknowns of the body", |p| p.dofs as f64),
    ("trace", "1", "displacement unknowns of the boundary elements", |p| p.trace as f64),
    (
        "body_error",
        "1",
        "error of the body, energy norm, over norm; against bilinear elements on the same fine cells, of those against the limit of fine grids",
        |p| p.errors[0],
    ),
    ("displacement_error", "1", "error of the displacement of the medium, norm of W, over norm", |p| p.errors[1]),
    ("traction_error", "1", "error of the traction of the medium, norm of V, over norm", |p| p.errors[2]),
    ("error", "1", "root of the sum of the three squares", Own::error),
    ("total_error", "1", "the same against the limit of fine grids", |p| p.total),
    ("rate", "1", "r of error ~ width^r from the grid before", |p| p.rate),
    ("estimate", "1", "estimate of the error as solve tells it, over norm", |p| p.estimate),
    ("residual", "1", "residual estimator over norm; NaN of q1 and linear", |p| p.residual),
    ("effectivity", "1", "residual estimator over error", Own::effectivity),
    ("seconds", "seconds", "one run without the estimate", |p| p.seconds),
];

/// Unit and meaning of [`OwnLoads::norm`].
pub(super) const NORM: (&str, &str) = (ENERGY, "(2 strain energy of body and medium)^(1/2) of the finest grid");

/// Errors with the scene's own loads.
#[derive(Debug, Clone, Default)]
pub struct OwnLoads {
    /// Over h from coarse to fine, then over H.
    pub points: Vec<Own>,
    /// (2 strain energy)^½ of the finest grid, to which all errors are relative; 0 without a solution.
    pub norm: f64,
    /// The failures, each with its reason.
    pub failures: Vec<(String, String)>,
}

impl OwnLoads {
    /// The points of a kind of elements, over H (0) or h (1).
    pub fn of(&self, over: usize, elements: usize) -> impl Iterator<Item = &Own> {
        self.points.iter().filter(move |p| (p.over, p.elements) == (over, elements))
    }
}

/// The scene on a grid of single cells, with the boundary elements of the trace.
fn on_cells(scene: &Scene, cells: [usize; 2]) -> Scene {
    let mut scene = scene.clone();
    scene.body_mut().grid = scene.body().grid.map(|grid| GridInput { coarse: cells, fine: [1, 1], ..grid });
    (scene.method.elements, scene.method.degree, scene.method.estimators) = (None, 1, true);
    scene
}

/// Solves bilinear elements on all grids that the moduli fit, the coupled basis on the scene's coarse cells of each
/// grid, and all bases on coarse cells of the scene's own fine grid, or of the finest one. No points if the loads cause
/// no strain. After a request to stop nothing more is solved.
pub fn own_loads(scene: &Scene, levels: &[Level], watch: &mut Watch<'_>) -> OwnLoads {
    let mut all = OwnLoads::default();
    let fits = |level: &&Level| on_cells(scene, level.grid.cells).check().is_ok();
    let grids: Vec<[usize; 2]> = levels.iter().filter(fits).map(|level| level.grid.cells).collect();
    if let Err(error) = measured(scene, &grids, watch, &mut all)
        && !matches!(error, SolveError::Interrupted)
    {
        all.failures.push(("own loads".into(), error.to_string()));
    }
    with_rates(&mut all.points);
    all
}

/// A point, its squared errors, and its squared errors against the finest grid.
struct Found {
    point: Own,
    squared: [f64; 3],
    to_finest: [f64; 3],
}

fn measured(scene: &Scene, grids: &[[usize; 2]], watch: &mut Watch<'_>, all: &mut OwnLoads) -> Result<(), SolveError> {
    let Some(&last) = grids.last() else { return Ok(()) };
    let own = grid_of(scene)?.cells;
    let own = if grids.contains(&own) { own } else { last };
    let sizes = sizes(scene, own);
    let coarse = match &scene.body().grid {
        Some(grid) if grid.fine != [1, 1] => Some(grid.coarse),
        _ => sizes.last().map(|m| own.map(|n| n / m)),
    };
    watch.tell("own loads", "the finest grid");
    let solved = on_all_cells(&on_cells(scene, last), 1, watch.interrupts)?;
    if is_at_rest(&solved) {
        return Ok(());
    }
    let finest = Truth::new(converged(solved)?)?;
    all.norm = finest.norm();
    let mut found: Vec<Found> = Vec::new();
    for &cells in grids {
        let at = |what: &str| format!("{what}, {} by {} cells", cells[0], cells[1]);
        watch.tell("own loads", &at("bilinear"));
        let scene = on_cells(scene, cells);
        let solved;
        let truth = if cells == last {
            &finest
        } else {
            solved = Truth::new(converged(on_all_cells(&scene, 1, watch.interrupts)?)?)?;
            &solved
        };
        let squared = finest.squared(&truth.solved);
        found.push(Found { point: point(&truth.solved, (1, 0), cells, finest.norm()), squared, to_finest: squared });
        let mut add = |over: usize, elements: usize, coarse: [usize; 2]| -> Result<(), SolveError> {
            let fine = [0, 1].map(|k| cells[k] / coarse[k]);
            let Some(basis) = ELEMENTS[elements].1 else { return Ok(()) };
            watch.tell(
                "own loads",
                &at(&format!("{}, {} by {} coarse ones", ELEMENTS[elements].0, coarse[0], coarse[1])),
            );
            let solved = converged(on_coarse_cells(&scene, fine, basis, None, watch.interrupts)?)?;
            let (squared, to_finest) = (truth.squared(&solved), finest.squared(&solved));
            found.push(Found { point: point(&solved, (over, elements), coarse, finest.norm()), squared, to_finest });
            Ok(())
        };
        let divides = |coarse: &[usize; 2]| (0..2).all(|k| cells[k] > coarse[k] && cells[k].is_multiple_of(coarse[k]));
        if let Some(coarse) = coarse.filter(divides) {
            add(1, COUPLED, coarse)?;
        }
        if cells == own {
            for (elements, m) in (1..ELEMENTS.len()).flat_map(|e| sizes.iter().rev().map(move |m| (e, m))) {
                add(0, elements, own.map(|n| n / m))?;
            }
        }
    }
    all.points = relative(&found, all.norm);
    Ok(())
}

/// Fine cells of a coarse cell along x and y: 2, 4, 8 ..., as long as the body consists of such coarse cells and has
/// enough of them along its shorter side.
fn sizes(scene: &Scene, cells: [usize; 2]) -> Vec<usize> {
    let fits = |m: &usize| {
        let coarse = cells.map(|n| n / m);
        cells.iter().all(|n| n.is_multiple_of(*m))
            && coarse[0].min(coarse[1]) >= FEWEST
            && check_body(scene, coarse, "coarse").is_ok()
    };
    (1..12).map(|k| 1 << k).take_while(fits).collect()
}

/// Whether all strain is rounding, as with a constant jump: errors relative to the strain energy then have no meaning.
fn is_at_rest(solved: &GridSolved) -> bool {
    let largest = |values: &[f64]| values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let young = largest(&solved.body.young).max(around(solved).material.young);
    solved.energies.strain <= ROUNDED * young * largest(&solved.displacement).powi(2)
}

fn converged(solved: GridSolved) -> Result<GridSolved, SolveError> {
    if solved.converged() {
        Ok(solved)
    } else {
        Err(SolveError::Observer("the forces of body and medium do not balance".into()))
    }
}

/// The numbers of a solution without its errors.
fn point(solved: &GridSolved, (over, elements): (usize, usize), coarse: [usize; 2], norm: f64) -> Own {
    let (grid, estimate) = (&solved.body.grid, solved.estimate.as_ref());
    let cells = if over == 0 { coarse } else { grid.cells };
    let side = |k: usize| grid.spacing[k] * grid.cells[k] as f64 / cells[k] as f64;
    let is_coarse = solved.coarse.is_some();
    // against the same fine grid, the error of the grid itself does not count
    let told = estimate.map(|e| if is_coarse { (e.multiscale + e.medium).sqrt() } else { e.error });
    let residual = estimate.and_then(|e| e.estimators().coupling).map(|r| r.value);
    let s = &solved.seconds;
    Own {
        over,
        elements,
        coarse,
        cells: grid.cells,
        width: side(0).max(side(1)),
        dofs: solved.dofs,
        trace: around(solved).space.dofs(),
        errors: [f64::NAN; 3],
        total: f64::NAN,
        rate: f64::NAN,
        estimate: told.map_or(f64::NAN, |e| e / norm),
        residual: residual.map_or(f64::NAN, |e| e / norm),
        seconds: s.set_up + s.assemble + s.factorise + s.solve,
    }
}

/// The points with their errors; errors against the finest grid are extended to the limit of fine grids.
fn relative(found: &[Found], norm: f64) -> Vec<Own> {
    let bilinear: Vec<&Found> = found.iter().filter(|f| f.point.elements == 0).collect();
    let beyond = match bilinear[..] {
        [.., a, b, _] => [0, 1, 2].map(|k| beyond(a.squared[k], b.squared[k])),
        _ => [None; 3],
    };
    let with = |squared: [f64; 3]| [0, 1, 2].map(|k| squared[k] + beyond[k].unwrap_or(0.0));
    let root = |squared: f64| squared.max(0.0).sqrt() / norm;
    let one = |f: &Found| {
        let to_limit = with(f.to_finest);
        let errors = if f.point.elements == 0 { to_limit } else { f.squared };
        let total = if beyond[0].is_some() { root(to_limit.iter().sum()) } else { f64::NAN };
        Own { errors: errors.map(root), total, ..f.point }
    };
    // the error of the finest grid is known only by extrapolation
    let is_known = |f: &&Found| f.point.elements > 0 || f.to_finest != [0.0; 3] || beyond.iter().any(Option::is_some);
    found.iter().filter(is_known).map(one).collect()
}

/// The squared error of a grid, from the squared distances to it of the solutions on cells four times and twice as
/// wide: e² ~ h^r, and distance² = e² - (its own e²). None if the distances do not fall fast enough.
fn beyond(quarter: f64, half: f64) -> Option<f64> {
    let factor = quarter / half - 1.0;
    // below that the widths do not determine a power
    (factor > 1.1).then(|| half / (factor - 1.0))
}

/// Rates from one point of a series to the next.
fn with_rates(points: &mut [Own]) {
    for k in 1..points.len() {
        let own = points[k];
        let before = points[..k].iter().rev().find(|p| (p.over, p.elements) == (own.over, own.elements));
        if let Some(before) = before {
            points[k].rate = (before.error() / own.error()).ln() / (before.width / own.width).ln();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_the_finest_grid_is_that_of_its_power() {
        for [c, rate] in [[0.3, 2.0], [4.0, 1.4], [1.0, 3.0]] {
            let squared = |h: f64| c * h.powf(rate);
            let distance = |h: f64| squared(h) - squared(1.0);
            let found = beyond(distance(4.0), distance(2.0)).unwrap();
            assert!((found - squared(1.0)).abs() < 1e-12 * found, "{found}");
        }
        assert_eq!(beyond(1.0, 1.0), None);
        assert_eq!(beyond(f64::NAN, 1.0), None);
    }
}
