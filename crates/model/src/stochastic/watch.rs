//! How the solution of many outcomes is watched, stopped, and given to other programs.

use steklov_stochastic::CHAIN;

use super::outcomes::Answer;
use crate::error::SolveError;

/// Answers outcomes, by their germs, elsewhere: in the order of the germs, and to the bits of
/// [`Prepared::answers`](super::Prepared::answers) on the last mesh, if lists that are divided are divided at multiples of [`TOGETHER`].
pub type Elsewhere<'a> = dyn Fn(&[Vec<f64>]) -> Result<Vec<Answer>, SolveError> + Sync + 'a;

/// Outcomes that follow each other, each beginning where the last one ended.
pub const TOGETHER: usize = CHAIN;

/// Watches the solution of many outcomes.
#[derive(Clone, Copy)]
pub struct OutcomesWatch<'a> {
    /// Receives how many points of how many are done.
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
    /// Says whether the user wants it to end.
    pub stopped: &'a (dyn Fn() -> bool + Sync),
    /// Answers the outcomes that are solved one by one; none: they are solved here.
    pub elsewhere: Option<&'a Elsewhere<'a>>,
}

impl OutcomesWatch<'_> {
    /// Nobody watches.
    pub const NONE: Self = OutcomesWatch { progress: &|_, _| {}, stopped: &|| false, elsewhere: None };

    pub(crate) fn tell(&self, done: usize, count: usize) {
        (self.progress)(done, count);
    }

    pub(crate) fn check(&self) -> Result<(), SolveError> {
        if (self.stopped)() { Err(SolveError::Interrupted) } else { Ok(()) }
    }
}
