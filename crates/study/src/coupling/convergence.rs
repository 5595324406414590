//! Errors of the three forms of the equations on finer and finer grids.

use std::time::Instant;

use steklov_bem_operators::Polygon;
use steklov_coupling::{CouplingError, Form, Interior, Radiation, Transmission};

use super::grids::Level;
use super::manufactured::{Manufactured, Pair};
use crate::median;
use crate::table::Column;
use crate::watch::{Found, Watch};

/// The forms and their names.
pub const FORMS: [(&str, Form); 3] =
    [("two-field", Form::TwoField), ("Schur", Form::Schur), ("three-field", Form::ThreeField)];

/// One form on one grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Number of the pair.
    pub pair: usize,
    /// Number in [`FORMS`].
    pub form: usize,
    /// Cells along x and y, over the bounding box.
    pub cells: [usize; 2],
    /// Displacement unknowns of the body.
    pub dofs: usize,
    /// Displacement unknowns on its outer boundary; the medium has as many.
    pub trace: usize,
    /// Error of the body in the energy norm ((force length/thickness)^½).
    pub error: f64,
    /// Energy norm of the exact field, same unit.
    pub norm: f64,
    /// Error of the medium's traction against the exact mean on each element, in the norm of the single layer, same
    /// unit.
    pub traction: f64,
    /// r of error ~ h^r from the grid before; NaN for the first.
    pub rate: f64,
    /// The same rate of the traction error.
    pub traction_rate: f64,
    /// Wall seconds: assembly, elimination, solution.
    pub seconds: f64,
}

/// Columns of the points.
pub(super) const POINTS: [Column<Point>; 11] = [
    ("pair", "1", "number of the pair of materials", |p| p.pair as f64),
    ("cells_x", "1", "cells along x", |p| p.cells[0] as f64),
    ("cells_y", "1", "cells along y", |p| p.cells[1] as f64),
    ("dofs", "1", "displacement unknowns of the body", |p| p.dofs as f64),
    ("trace", "1", "those on its outer boundary", |p| p.trace as f64),
    ("error", ENERGY, "error of the body, energy norm", |p| p.error),
    ("norm", ENERGY, "energy norm of the exact field", |p| p.norm),
    ("rate", "1", "r of error ~ h^r from the grid before", |p| p.rate),
    ("traction_error", ENERGY, "error of the traction to its mean on each element, norm of V", |p| p.traction),
    ("traction_rate", "1", "r of traction_error ~ h^r from the grid before", |p| p.traction_rate),
    ("seconds", "seconds", "assembly, elimination and solution", |p| p.seconds),
];

/// Unit of energy norms.
pub(super) const ENERGY: &str = "(force*length/thickness)^(1/2)";

/// Errors by pair, grid and form.
pub type Convergence = Found<Point>;

impl Convergence {
    /// The points of a pair and a form.
    pub fn of(&self, pair: usize, form: usize) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(move |p| (p.pair, p.form) == (pair, form))
    }
}

/// Solves with all pairs, forms and grids: the last pair `repeat` times, with medians of the seconds, the others once.
/// After a request to stop nothing more is solved.
pub fn convergence(
    polygon: &Polygon,
    pairs: &[Pair],
    levels: &[Level],
    repeat: usize,
    watch: &mut Watch<'_>,
) -> Convergence {
    let mut all = Convergence::default();
    for (pair, materials) in pairs.iter().enumerate() {
        let exact = Manufactured::new(polygon, materials);
        let runs = if pair + 1 == pairs.len() { repeat.max(1) } else { 1 };
        for level in levels {
            if watch.stopped() {
                return all;
            }
            let [x, y] = level.grid.cells;
            watch.tell(&materials.name, &format!("{x} by {y} cells"));
            let mut found = solve(&exact, level, runs);
            for point in found.iter_mut().flatten() {
                point.pair = pair;
                if let Some(before) = all.of(pair, point.form).last() {
                    let steps = (x as f64 / before.cells[0] as f64).ln();
                    point.rate = (before.error / point.error).ln() / steps;
                    point.traction_rate = (before.traction / point.traction).ln() / steps;
                }
            }
            all.take(format!("{}, {x} by {y} cells", materials.name), found);
        }
    }
    all
}

/// One pair on one grid, by all forms.
fn solve(exact: &Manufactured<'_>, level: &Level, runs: usize) -> Result<Vec<Point>, CouplingError> {
    let problem = exact.problem(&level.grid)?;
    let mut seconds = vec![Vec::new(); FORMS.len()];
    let mut points = Vec::new();
    for run in 0..runs {
        let start = Instant::now();
        let interior = Interior::fine(&problem.body, &problem.loads)?;
        let exterior = exact.exterior(&interior)?;
        let transmission = Transmission::new(interior, &exterior)?;
        let set_up = start.elapsed().as_secs_f64();
        let jump = exterior.space.interpolate(|x| exact.jump(x));
        for ((form, seconds), (_, equations)) in seconds.iter_mut().enumerate().zip(FORMS) {
            let start = Instant::now();
            let solved = transmission.solve(&jump, equations, Radiation::Decaying)?;
            seconds.push(set_up + start.elapsed().as_secs_f64());
            if run == 0 {
                let [error, norm] = exact.energy_error(&problem.body, &solved.displacement);
                points.push(Point {
                    pair: 0,
                    form,
                    cells: level.grid.cells,
                    dofs: level.grid.dofs(),
                    trace: level.trace,
                    error,
                    norm,
                    traction: exact.traction_error(&exterior, &solved.traction),
                    rate: f64::NAN,
                    traction_rate: f64::NAN,
                    seconds: f64::NAN,
                });
            }
        }
    }
    for (point, seconds) in points.iter_mut().zip(&mut seconds) {
        point.seconds = median(seconds);
    }
    Ok(points)
}
