//! A stochastic mesh with the answers at the nodes of its cells.

use steklov_stochastic::{CellBasis, DirectionError, StochasticMesh, changes};

use super::events::{events, slips};
use super::outcome_checks::Miss;
use super::outcomes::Answer;
use super::result::End;

/// Squared errors this many times larger than those that coefficients show come from something that no node sees.
const UNSEEN: f64 = 16.0;

/// A stochastic mesh and the answers at its nodes.
pub(crate) struct Surrogate {
    pub(crate) mesh: StochasticMesh,
    pub(crate) cells: Vec<Cell>,
    /// Whether the nodes of a cell are coupled.
    pub(crate) coupled: bool,
    /// Its errors.
    pub(crate) told: Told,
    pub(crate) end: End,
    /// Points that were solved, those of cells that were refined later included.
    pub(crate) solved: usize,
}

/// Errors of a surrogate.
pub(crate) struct Told {
    /// (Σ of the squared errors)^½ over the mean energy norm: from the coefficients, with the errors at the ends of cells and
    /// of fresh outcomes, and from these alone.
    pub(crate) by_nodes: f64,
    pub(crate) relative: f64,
    pub(crate) measured: f64,
    /// The squared error of each quantity.
    pub(crate) quantities: Vec<f64>,
    /// Outcomes solved to look at ends and at fresh outcomes.
    pub(crate) checks: usize,
    /// Probability in which kinks and jumps of data may have been overlooked.
    pub(crate) undecided: f64,
}

/// A cell with its answers.
pub(crate) struct Cell {
    pub(crate) basis: CellBasis,
    pub(crate) answers: Vec<Answer>,
    /// The errors that the coefficients show.
    pub(super) errors: Vec<DirectionError>,
    /// Σ over the directions, for each quantity.
    pub(super) quantities: Vec<f64>,
    pub(super) misses: Vec<Miss>,
    /// Probability in which kinks and jumps of data are neither found nor excluded.
    pub(super) undecided: f64,
}

impl Cell {
    /// Errors including those that nodes do not see.
    pub(crate) fn errors(&self) -> Vec<DirectionError> {
        let of = |(d, &seen): (usize, &DirectionError)| {
            let misses = self.misses.iter().filter(|m| m.direction == d);
            match misses.max_by(|a, b| a.residual.squared.total_cmp(&b.residual.squared)) {
                Some(miss) if miss.residual.squared > seen.error => {
                    let error = miss.residual.squared;
                    let rough = miss.event || error > UNSEEN * seen.error;
                    DirectionError { error, decay: if rough { 1.0 } else { seen.decay } }
                }
                _ => seen,
            }
        };
        self.errors.iter().enumerate().map(of).collect()
    }

    /// Where to split in a direction: where what no node sees begins, if that is more than what they see, else where contact or stick
    /// change between nodes.
    pub(super) fn cut(&self, direction: usize) -> Option<f64> {
        let all: Vec<&Answer> = self.answers.iter().collect();
        let missed = self.misses.iter().filter(|m| m.direction == direction && m.at.is_some());
        missed
            .filter(|m| m.residual.squared > self.errors[direction].error)
            .max_by(|a, b| a.residual.squared.total_cmp(&b.residual.squared))
            .and_then(|m| m.at)
            .or_else(|| changes(&self.basis, direction, &events(&all)))
            .or_else(|| changes(&self.basis, direction, &slips(&all)))
    }
}
