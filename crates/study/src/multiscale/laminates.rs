//! Resonance: errors when the period of a material approaches the size of coarse cells.
//!
//! The unit square with 256 × 256 cells, its left side held, a traction on its right side, with layers 1:10 of a period
//! from 1/4 to 1/32.

use std::sync::atomic::AtomicUsize;

use steklov_model::error::SolveError;
use steklov_problem::Scene;

use super::measure::{FITTED, error, estimate, on_all_cells, on_coarse_cells};
use super::plate::plate;
use crate::table::Column;
use crate::watch::{Found, Watch};

/// Layers along y, and layers at an angle to both axes: each layer is half of a period.
pub const LAMINATES: [(&str, &str); 2] = [("straight", "sin(2*pi*x*P)"), ("diagonal", "sin(2*pi*(x + 2*y)*P)")];

/// Fine cells along each side.
const FINE: usize = 256;
/// Numbers of periods and of coarse cells along a side.
const PERIODS: [usize; 4] = [4, 8, 16, 32];
const COARSE: [usize; 5] = [4, 8, 16, 32, 64];
/// The fixed numbers: coarse cells while periods change; periods of each laminate while coarse cells change.
const FIXED_COARSE: usize = 4;
const FIXED_PERIODS: [usize; 2] = [16, 32];

/// One basis on one coarse grid and one laminate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layers {
    /// Number in [`LAMINATES`].
    pub laminate: usize,
    /// Number in [`FITTED`].
    pub basis: usize,
    /// Periods along a side of the square.
    pub periods: usize,
    /// Coarse cells along a side.
    pub coarse: usize,
    /// Relative error in the energy norm against bilinear elements on the same fine cells.
    pub error: f64,
    /// Relative error of the displacement in the L² norm against the same elements.
    pub displacement: f64,
    /// Estimate of the error in the energy norm; NaN for nonconforming bases.
    pub estimate: f64,
}

/// Columns of the laminates.
pub(super) const LAYERS: [Column<Layers>; 8] = [
    ("laminate", "1", "0 straight layers, 1 diagonal ones", |l| l.laminate as f64),
    ("basis", "1", "0 coupled, 1 oscillatory, 2 oversampled by half a coarse cell", |l| l.basis as f64),
    ("periods", "1", "periods of layers along a side of the square: 1/eps", |l| l.periods as f64),
    ("coarse", "1", "coarse cells along a side: 1/H", |l| l.coarse as f64),
    ("error", "1", "relative error, energy norm, against bilinear elements on 256 x 256 cells", |l| l.error),
    ("estimate", "1", "its estimate; NaN of bases that do not conform", |l| l.estimate),
    ("effectivity", "1", "estimate over error", |l| l.estimate / l.error),
    ("displacement_error", "1", "relative error of the displacement, L2 norm, against the same cells", |l| {
        l.displacement
    }),
];

/// Errors on laminates, by laminate, periods, coarse cells and basis.
pub type Laminates = Found<Layers>;

impl Laminates {
    /// Points of a laminate and a basis with the fixed number of coarse cells, over the periods.
    pub fn over_periods(&self, laminate: usize, basis: usize) -> impl Iterator<Item = &Layers> {
        self.of(laminate, basis).filter(|l| l.coarse == FIXED_COARSE)
    }

    /// Points of a laminate and a basis with the fixed number of periods, over the coarse cells.
    pub fn over_cells(&self, laminate: usize, basis: usize) -> impl Iterator<Item = &Layers> {
        self.of(laminate, basis).filter(move |l| l.periods == FIXED_PERIODS[laminate])
    }

    fn of(&self, laminate: usize, basis: usize) -> impl Iterator<Item = &Layers> {
        self.points.iter().filter(move |l| (l.laminate, l.basis) == (laminate, basis))
    }
}

/// The square with this number of periods of layers.
fn square(laminate: usize, periods: usize) -> Result<Scene, SolveError> {
    let young = format!("5.5 + 4.5*sign({})", LAMINATES[laminate].1);
    let grid = [[FIXED_COARSE; 2], [FINE / FIXED_COARSE; 2]];
    plate([1.0, 1.0], &young, ("P", periods as f64), FINE, grid)
}

/// Solves on all laminates. After a request to stop nothing more is solved.
pub fn laminates(watch: &mut Watch<'_>) -> Laminates {
    let mut all = Laminates::default();
    for (laminate, (name, _)) in LAMINATES.iter().enumerate() {
        for periods in PERIODS {
            let at = format!("{name} layers, {periods} periods");
            watch.tell("laminates", &at);
            match one(laminate, periods, watch.interrupts, &mut all.points) {
                Err(SolveError::Interrupted) => return all,
                Err(error) => all.failures.push((at, error.to_string())),
                Ok(()) => {}
            }
        }
    }
    all
}

/// All coarse cells and bases on one laminate.
fn one(laminate: usize, periods: usize, interrupts: &AtomicUsize, points: &mut Vec<Layers>) -> Result<(), SolveError> {
    let scene = square(laminate, periods)?;
    let truth = on_all_cells(&scene, 1, interrupts)?;
    let wanted = |coarse: &&usize| **coarse == FIXED_COARSE || periods == FIXED_PERIODS[laminate];
    for &coarse in COARSE.iter().filter(wanted) {
        for (basis, (_, input)) in FITTED.iter().enumerate() {
            let fine = FINE / coarse;
            let solved = on_coarse_cells(&scene, [fine; 2], *input, Some(fine / 2), interrupts)?;
            let ([error, displacement], estimate) = (error(&truth, &solved)?, estimate(&truth, &solved));
            points.push(Layers { laminate, basis, periods, coarse, error, displacement, estimate });
        }
    }
    Ok(())
}
