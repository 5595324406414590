//! High contrast: cases in which multiscale bases fail, and whether an estimate shows it.
//!
//! A plate of 2 × 1 with 8 × 4 coarse cells of 16 × 16 fine ones, its left side held, a traction on its right one. Stiff parts
//! lie inside of the coarse cells, across their edges, or as channels along them.

use std::sync::atomic::AtomicUsize;

use steklov_model::error::SolveError;
use steklov_model::grid::{FAILING, GridSolved};
use steklov_msfem::{Indicators, crossing_contrast};

use super::measure::{FITTED, error, estimate, norm, on_all_cells, on_coarse_cells};
use super::plate::plate;
use crate::table::Column;
use crate::watch::{Found, Watch};

/// Names of the stiff parts, and expressions that are positive in them.
pub const PARTS: [(&str, &str); 3] = [
    ("inside coarse cells", "-max(cos(8*pi*x), cos(8*pi*y))"),
    ("across coarse edges", "min(cos(8*pi*x), cos(8*pi*y))"),
    ("channels", "min(cos(2*pi*(4*y - 0.4375)) - sqrt(0.5), 0.90625 - abs(x - 1))"),
];
/// Exponents of the contrasts.
const POWERS: std::ops::RangeInclusive<i32> = 1..=6;
/// Fine cells along a coarse cell.
const FINE: usize = 16;

/// One basis at one contrast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stiff {
    /// Number in [`PARTS`].
    pub part: usize,
    /// Number in [`FITTED`].
    pub basis: usize,
    /// Modulus of the stiff parts over that of the others.
    pub contrast: f64,
    /// Relative error in the energy norm against bilinear elements on the same fine cells.
    pub error: f64,
    /// Estimate by nodal residuals over the error; NaN for nonconforming bases.
    pub nodal: f64,
    /// Estimate by jumps of tractions over the error; NaN for nonconforming bases.
    pub jump: f64,
    /// Largest contrast along a coarse edge.
    pub crossing: f64,
}

impl Stiff {
    /// Whether the program warns about a solution at such a contrast.
    pub fn warned(&self) -> bool {
        self.crossing >= FAILING
    }
}

/// Columns of the contrasts.
pub(super) const STIFF: [Column<Stiff>; 8] = [
    ("part", "1", "stiff parts 0 inside of coarse cells, 1 across their edges, 2 channels", |s| s.part as f64),
    ("basis", "1", "0 coupled, 1 oscillatory, 2 oversampled by half a coarse cell", |s| s.basis as f64),
    ("contrast", "1", "modulus of the stiff parts over that of the others", |s| s.contrast),
    ("error", "1", "relative error, energy norm, against bilinear elements on the same fine cells", |s| s.error),
    ("nodal", "1", "estimate by nodal residuals over the error; NaN of bases that do not conform", |s| s.nodal),
    ("jump", "1", "estimate by jumps of tractions over the error; NaN of bases that do not conform", |s| s.jump),
    ("crossing", "1", "largest contrast along a coarse edge", |s| s.crossing),
    ("warned", "1", "1 where solve warns that stiff parts cross coarse edges", |s| f64::from(u8::from(s.warned()))),
];

/// Errors at high contrast, by part, contrast and basis.
pub type Contrast = Found<Stiff>;

impl Contrast {
    /// The points of a kind of stiff parts and a basis.
    pub fn of(&self, part: usize, basis: usize) -> impl Iterator<Item = &Stiff> {
        self.points.iter().filter(move |s| (s.part, s.basis) == (part, basis))
    }
}

/// Solves with all contrasts. After a request to stop nothing more is solved.
pub fn contrast(watch: &mut Watch<'_>) -> Contrast {
    let mut all = Contrast::default();
    for (part, (name, _)) in PARTS.iter().enumerate() {
        for power in POWERS {
            let at = format!("stiff parts {name}, contrast 1e{power}");
            watch.tell("contrast", &at);
            match one(part, 10.0_f64.powi(power), watch.interrupts, &mut all.points) {
                Err(SolveError::Interrupted) => return all,
                Err(error) => all.failures.push((at, error.to_string())),
                Ok(()) => {}
            }
        }
    }
    all
}

/// All bases at one contrast.
fn one(part: usize, contrast: f64, interrupts: &AtomicUsize, points: &mut Vec<Stiff>) -> Result<(), SolveError> {
    let young = format!("(C + 1)/2 + (C - 1)/2*sign({})", PARTS[part].1);
    let scene = plate([2.0, 1.0], &young, ("C", contrast), 4 * FINE, [[8, 4], [FINE; 2]])?;
    let truth = on_all_cells(&scene, 1, interrupts)?;
    for (basis, (_, input)) in FITTED.iter().enumerate() {
        let solved = on_coarse_cells(&scene, [FINE; 2], *input, Some(FINE / 2), interrupts)?;
        let [error, _] = error(&truth, &solved)?;
        let Some(coarse) = &solved.coarse else { unreachable!("coarse cells were asked for") };
        let crossing = crossing_contrast(&solved.body, &coarse.mesh, FAILING).largest;
        let nodal = estimate(&truth, &solved) / error;
        let jump = if coarse.basis.is_conforming() { jumps(&solved) / norm(&truth) / error } else { f64::NAN };
        points.push(Stiff { part, basis, contrast, error, nodal, jump, crossing });
    }
    Ok(())
}

/// The estimate by jumps of tractions, for the plate held on the left with the traction (0, -1) on the right.
fn jumps(solved: &GridSolved) -> f64 {
    let (body, Some(coarse)) = (&solved.body, &solved.coarse) else { return f64::NAN };
    let traction = |_: usize, side: usize| match side {
        1 => [Some(0.0), Some(-1.0)],
        3 => [None; 2],
        _ => [Some(0.0); 2],
    };
    let terms = Indicators::new(body, &coarse.mesh, &[], &solved.displacement, &traction);
    terms.squared().iter().sum::<f64>().sqrt()
}
