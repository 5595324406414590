//! The stages that outcomes pass to their observer.

use steklov_problem::{DataError, Random};
use steklov_stochastic::CellBasis;

use super::outcomes::Answer;

/// E over that of the mean input, as a function of germs.
pub type Modulus<'a> = dyn Fn(&[f64]) -> Result<f64, DataError> + 'a;

/// The data that outcomes pass to their observer while they have them.
pub enum OutcomeStage<'a> {
    /// They begin, for the first time or once more after a fault: earlier stages do not count.
    Begin(&'a Random),
    /// The answers from number `first` on of `count`, in the order of the points.
    Answers {
        /// Number of the first of these.
        first: usize,
        /// Number of all.
        count: usize,
        /// The answers.
        answers: &'a [Answer],
    },
    /// The bases of all stochastic cells.
    Cells {
        /// One for each cell.
        bases: &'a [&'a CellBasis],
        /// E over that of the mean input as a function of germs, if it is random.
        modulus: Option<&'a Modulus<'a>>,
    },
}
