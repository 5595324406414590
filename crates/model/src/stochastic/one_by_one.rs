//! Outcomes that are solved one by one, of whatever body: at the points of a sparse grid, and samples.

use rayon::prelude::*;
use steklov_contact::Solution;
use steklov_problem::{Random, Sampling};
use steklov_stochastic::{Points, Variable, smolyak, solve_points};

use super::corrected::of_corrected;
use super::in_body::BodySums;
use super::jumps::InGerms;
use super::kept::Kept;
use super::number::Number;
use super::outcomes::Answer;
use super::result::{StochasticResult, of_grid};
use super::samples::of_samples;
use super::stage::OutcomeStage;
use super::unseen::{beside_grid, beside_samples};
use super::watch::OutcomesWatch;
use crate::error::SolveError;

/// Whether the outcomes of random input are solved one by one, so that others can do it.
pub fn one_by_one(random: &Random) -> bool {
    matches!(random.stochastic.method, Sampling::Sparse | Sampling::Corrected | Sampling::MonteCarlo)
}

/// An outcome's germs to its answer; the solution of a similar outcome may be the start.
pub(super) type Answering<'a> = dyn Fn(&[f64], &mut Option<Solution>) -> Result<Answer, SolveError> + Sync + 'a;

/// Blocks that are answered elsewhere at a time.
const BLOCKS: usize = 16;

/// How the outcomes of a scene are answered one by one.
pub(super) struct OneByOne<'a> {
    /// The requested numbers.
    pub(super) numbers: &'a [Number],
    /// The scale of each of them.
    pub(super) scales: &'a [f64],
    /// The data in their germs.
    pub(super) data: &'a InGerms<'a>,
    pub(super) answer: &'a Answering<'a>,
    /// The germs by their effect.
    pub(super) kept: Kept,
    /// Most answers that are held with their fields in the body, a multiple of the points of a chain.
    pub(super) block: usize,
}

impl OneByOne<'_> {
    /// Solves at the points of the sparse grid, or at the samples, that a scene asks for; and beside them.
    ///
    /// # Errors
    /// An outcome that is impossible; an observer that fails; [`SolveError::Interrupted`].
    pub(super) fn solve(
        &self,
        random: &Random,
        watch: &OutcomesWatch<'_>,
        observe: &mut dyn FnMut(OutcomeStage<'_>) -> Result<(), SolveError>,
    ) -> Result<StochasticResult, SolveError> {
        let variables: Vec<Variable> = random.germs.iter().map(|g| g.variable.clone()).collect();
        if random.stochastic.method == Sampling::Corrected {
            return of_corrected(self, random, watch, observe);
        }
        if random.stochastic.method == Sampling::MonteCarlo {
            let mut result = of_samples(self, &variables, random, watch, observe)?;
            beside_samples(&mut result, self, random, watch)?;
            return Ok(result);
        }
        let grid = smolyak(&variables, random.stochastic.level)?;
        let (answers, sums) = self.at_points(&grid, watch, observe)?;
        let mut result = of_grid(grid.points.clone(), grid.weights.clone(), &answers, self.numbers)?;
        result.in_body = sums.moments();
        beside_grid(&mut result, (&grid, &answers), self, random, watch)?;
        Ok(result)
    }

    /// Answers at points with weights, and the sums of the fields in the body, which the answers no longer have.
    pub(super) fn at_points(
        &self,
        grid: &Points,
        watch: &OutcomesWatch<'_>,
        observe: &mut dyn FnMut(OutcomeStage<'_>) -> Result<(), SolveError>,
    ) -> Result<(Vec<Answer>, BodySums), SolveError> {
        let count = grid.points.len();
        let (mut answers, mut sums) = (Vec::with_capacity(count), BodySums::default());
        self.stream(count, &|i| grid.points[i].clone(), watch, &mut |first, _, mut block| {
            observe(OutcomeStage::Answers { first, count, answers: &block })?;
            for (i, answer) in block.iter_mut().enumerate() {
                sums.push(grid.weights[first + i], &std::mem::take(&mut answer.in_body));
            }
            answers.extend(block);
            Ok(())
        })?;
        Ok((answers, sums))
    }

    /// Answers `count` outcomes, their germs by number, and hands them on block by block.
    pub(super) fn stream(
        &self,
        count: usize,
        germs: &(dyn Fn(usize) -> Vec<f64> + Sync),
        watch: &OutcomesWatch<'_>,
        take: &mut dyn FnMut(usize, Vec<Vec<f64>>, Vec<Answer>) -> Result<(), SolveError>,
    ) -> Result<(), SolveError> {
        // others get several blocks at once: each of them is to have work
        let length = if watch.elsewhere.is_some() { BLOCKS * self.block } else { self.block };
        for first in (0..count).step_by(length) {
            let length = length.min(count - first);
            watch.check()?;
            let mut germs: Vec<Vec<f64>> = (first..first + length).into_par_iter().map(germs).collect();
            let mut answers = match watch.elsewhere {
                Some(elsewhere) => elsewhere(&germs)?,
                None => solve_points(length, |i, warm: &mut Option<Solution>| {
                    watch.check()?;
                    (self.answer)(&germs[i], warm)
                })?,
            };
            watch.tell(first + length, count);
            for first in (first..first + length).step_by(self.block) {
                let block = self.block.min(germs.len());
                take(first, germs.drain(..block).collect(), answers.drain(..block).collect())?;
            }
        }
        Ok(())
    }
}
