//! The error of the fine grid itself: multiscale elements on it cannot have a smaller one.

use steklov_model::error::SolveError;
use steklov_model::grid::GridSolved;
use steklov_problem::{Scene, grid_of};

use super::measure::{NOT_CONVERGED, norm, on_all_cells, timed};
use crate::error::StudyError;
use crate::table::Column;
use crate::watch::Watch;

/// Parts of each cell along x and y in finer and finer grids.
const PARTS: [usize; 3] = [1, 2, 4];
/// Largest number of unknowns of finer grids, or the limit of the scene if that is larger.
pub const MOST_DOFS: usize = 1_000_000;

/// Bilinear elements on all cells, or on parts of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Parts of each cell along x and y.
    pub parts: usize,
    /// Displacement unknowns, held ones included.
    pub dofs: usize,
    /// J.
    pub energy: f64,
    /// Relative error against the extrapolated limit, or its estimate without one; NaN if not known.
    pub error: f64,
    /// Estimate of the relative error by the solution itself; NaN without one.
    pub estimate: f64,
    /// Wall seconds without the estimate.
    pub seconds: f64,
}

/// Columns of the levels.
pub(super) const LEVELS: [Column<Level>; 6] = [
    ("parts", "1", "parts of each fine cell along x and y", |l| l.parts as f64),
    ("dofs", "1", "displacement unknowns, held ones included", |l| l.dofs as f64),
    ("energy", "force*length/thickness", "J", |l| l.energy),
    ("error", "1", "relative error, energy norm, against the limit, or its estimate without one", |l| l.error),
    ("estimate", "1", "estimated relative error, energy norm", |l| l.estimate),
    ("seconds", "seconds", "set-up, assembly, factorisation and solution", |l| l.seconds),
];

/// The results of bilinear elements on the fine grid and on finer ones.
pub struct FineGrid {
    /// The solution on the fine grid.
    pub truth: GridSolved,
    /// The fine grid and finer ones.
    pub levels: Vec<Level>,
    /// The limit of J, and r of J_h - J = C h^r; None with fewer than three grids, or if their J do not fall steadily.
    pub limit: Option<[f64; 2]>,
    /// Why a finer grid has no solution.
    pub failures: Vec<(String, String)>,
}

impl FineGrid {
    /// Relative error of the fine grid in the energy norm; NaN if not known.
    pub fn error(&self) -> f64 {
        self.levels[0].error
    }

    /// The source of that error in words.
    pub fn source(&self) -> &'static str {
        match self.limit {
            Some(_) => "J of three grids, each half as wide as the one before, extrapolated at its rate",
            None if self.error().is_finite() => "estimated on the fine grid: no limit can be extrapolated",
            None => "not known: no limit can be extrapolated",
        }
    }
}

/// The limit of three values with the step h, h/2, h/4, and r of J_h - J = C h^r; None unless they fall, and more
/// slowly from step to step.
fn limit([a, b, c]: [f64; 3]) -> Option<[f64; 2]> {
    let (first, second) = (a - b, b - c);
    // smaller differences are rounding errors
    let noise = 1e-13 * (a.abs() + b.abs() + c.abs());
    (second > noise && first > 1.2 * second).then(|| [c - second * second / (first - second), (first / second).log2()])
}

/// Solves the fine grid and finer ones. After a request to stop nothing more is solved.
///
/// # Errors
/// The errors of the fine grid; [`SolveError::Interrupted`] after a stop before it is solved.
pub fn fine_grid(scene: &Scene, repeat: usize, watch: &mut Watch<'_>) -> Result<FineGrid, StudyError> {
    let most = scene.method.max_dofs().max(MOST_DOFS);
    let cells = grid_of(scene).map_err(SolveError::from)?.body_cells().count();
    let mut truth = None;
    let (mut levels, mut failures): (Vec<Level>, Vec<_>) = (Vec::new(), Vec::new());
    for parts in PARTS {
        // there are about as many nodes as cells
        if parts > 1 && 2 * cells * parts * parts > most {
            break;
        }
        watch.tell("fine grid", &format!("cells in {parts} by {parts} parts"));
        match timed(repeat, || on_all_cells(scene, parts, watch.interrupts)) {
            Ok((solved, _)) if !solved.converged() && truth.is_none() => {
                return Err(StudyError::NotSolved { steps: 1 });
            }
            Ok((solved, seconds)) if solved.converged() => {
                // an estimate of 0 is no estimate
                let estimate = solved.estimate.as_ref().filter(|e| e.fine_grid > 0.0);
                levels.push(Level {
                    parts,
                    dofs: solved.dofs,
                    energy: solved.energies.total,
                    error: f64::NAN,
                    estimate: estimate.map_or(f64::NAN, |e| e.fine_grid.sqrt() / norm(&solved)),
                    seconds,
                });
                truth.get_or_insert(solved);
            }
            Ok(_) => failures.push((format!("cells in {parts} parts"), NOT_CONVERGED.into())),
            Err(error) if truth.is_none() => return Err(error.into()),
            Err(SolveError::Interrupted) => break,
            Err(error) => failures.push((format!("cells in {parts} parts"), error.to_string())),
        }
    }
    let Some(truth) = truth else { unreachable!("the fine grid comes first") };
    let limit = match levels[..] {
        [a, b, c] => limit([a, b, c].map(|l| l.energy)),
        _ => None,
    };
    let scale = norm(&truth);
    for level in &mut levels {
        level.error = match limit {
            // J_h - J is half of the squared error
            Some([limit, _]) => (2.0 * (level.energy - limit)).sqrt() / scale,
            None => level.estimate,
        };
    }
    Ok(FineGrid { truth, levels, limit, failures })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn limits_of_powers_are_exact(j in -3.0..3.0_f64, c in 0.1..2.0_f64, rate in 0.4..4.0_f64) {
            let at = |h: f64| j + c * h.powf(rate);
            let [found, found_rate] = limit([at(1.0), at(0.5), at(0.25)]).unwrap();
            prop_assert!((found - j).abs() < 1e-9 && (found_rate - rate).abs() < 1e-6);
            // neither growing nor widening differences have a limit
            prop_assert_eq!(limit([at(0.25), at(0.5), at(1.0)]), None);
            prop_assert_eq!(limit([at(1.0), at(0.5), 2.0 * at(0.5) - at(1.0)]), None);
        }
    }
}
