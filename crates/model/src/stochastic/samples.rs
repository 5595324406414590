//! Statistics of samples, as they stream by.

use steklov_problem::Random;
use steklov_stochastic::{Accumulator, Variable, density, quantiles, sample};

use super::in_body::BodySums;
use super::one_by_one::OneByOne;
use super::outcomes::Answer;
use super::result::{BINS, Quantity, StochasticResult, touches};
use super::stage::OutcomeStage;
use super::watch::OutcomesWatch;
use crate::error::SolveError;

/// The kept data of the outcomes that have gone by.
struct Passed {
    /// Displacement, stress displacement, pressure, shear, touching, quantities.
    sums: [Accumulator; 6],
    in_body: BodySums,
    points: Vec<Vec<f64>>,
    young: Vec<f64>,
    /// The values of each quantity.
    values: Vec<Vec<f64>>,
    iterations: usize,
    unconverged: usize,
}

impl Passed {
    fn push(&mut self, germs: Vec<f64>, answer: &Answer) -> Result<(), SolveError> {
        self.in_body.push(1.0, &answer.in_body);
        let touching: Vec<f64> = (0..answer.pressure.len()).map(|i| f64::from(u8::from(touches(answer, i)))).collect();
        let Answer { displacement, stressed, pressure, shear, quantities, .. } = answer;
        let parts = [displacement, stressed, pressure, shear, &touching, quantities];
        for (sum, part) in self.sums.iter_mut().zip(parts) {
            sum.push(1.0, part)?;
        }
        self.points.push(germs);
        self.young.push(answer.modulus);
        self.values.iter_mut().zip(quantities).for_each(|(all, v)| all.push(*v));
        self.iterations += answer.iterations;
        self.unconverged += usize::from(!answer.converged);
        Ok(())
    }
}

/// Statistics of seeded samples.
///
/// # Errors
/// An outcome that is impossible; an observer that fails; [`SolveError::Interrupted`].
pub(super) fn of_samples(
    outcomes: &OneByOne<'_>,
    variables: &[Variable],
    random: &Random,
    watch: &OutcomesWatch<'_>,
    observe: &mut dyn FnMut(OutcomeStage<'_>) -> Result<(), SolveError>,
) -> Result<StochasticResult, SolveError> {
    let settings = &random.stochastic;
    let count = settings.samples;
    let mut passed = Passed {
        sums: Default::default(),
        in_body: BodySums::default(),
        points: Vec::new(),
        young: Vec::new(),
        values: vec![Vec::with_capacity(count); outcomes.numbers.len()],
        iterations: 0,
        unconverged: 0,
    };
    let germs = |i: usize| sample(variables, settings.seed, i as u64);
    outcomes.stream(count, &germs, watch, &mut |first, germs, answers| {
        observe(OutcomeStage::Answers { first, count, answers: &answers })?;
        for (germs, answer) in germs.into_iter().zip(&answers) {
            passed.push(germs, answer)?;
        }
        Ok(())
    })?;
    let [displacement, stressed, pressure, shear, touching, both] = passed.sums;
    let (both, errors) = (both.moments(), both.standard_errors());
    let equal = vec![1.0; count];
    let mut quantities = Vec::new();
    for (k, values) in passed.values.into_iter().enumerate() {
        quantities.push(Quantity {
            name: outcomes.numbers[k].path.clone(),
            mean: both.mean[k],
            variance: both.variance[k],
            standard_error: Some(errors.mean[k]),
            variance_error: Some(errors.variance[k]),
            truncation: None,
            bounds_left: None,
            quantiles: Some(quantiles(&values, &equal, &settings.quantiles)?),
            density: density(&values, &equal, BINS).ok(), // none of a constant
            effects: None,
            values,
        });
    }
    Ok(StochasticResult {
        weights: vec![1.0 / count as f64; count],
        quantities,
        displacement: displacement.moments(),
        stress_displacement: stressed.moments().mean,
        in_body: passed.in_body.moments(),
        pressure: pressure.moments(),
        shear: shear.moments(),
        probability: touching.moments().mean,
        points: passed.points,
        young: passed.young,
        solved: count,
        iterations: passed.iterations,
        unconverged: passed.unconverged,
        ..StochasticResult::default()
    })
}
