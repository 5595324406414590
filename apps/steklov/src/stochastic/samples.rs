//! Statistics of samples, as they stream by.

use steklov_contact::Solution;
use steklov_stochastic::{Accumulator, Variable, density, quantiles, sample, solve_points};

use super::nodes::End;
use super::outcomes::Outcomes;
use super::result::{BINS, BLOCK, Quantity, StochasticResult, Watch, touches};
use crate::scene::Random;
use crate::solve::SolveError;

pub(super) fn of_samples(
    outcomes: &Outcomes<'_>,
    variables: &[Variable],
    random: &Random,
    paths: &[String],
    watch: &Watch<'_>,
) -> Result<StochasticResult, SolveError> {
    let settings = &random.stochastic;
    let count = settings.samples;
    // displacement, stress displacement, pressure, shear, touching, quantities
    let mut sums: [Accumulator; 6] = Default::default();
    let (mut points, mut young, mut values) = (Vec::new(), Vec::new(), vec![Vec::with_capacity(count); paths.len()]);
    let (mut iterations, mut unconverged) = (0, 0);
    for first in (0..count).step_by(BLOCK) {
        let block = BLOCK.min(count - first);
        let answers = solve_points(block, |i, warm: &mut Option<Solution>| {
            watch.check()?;
            let germs = sample(variables, settings.seed, (first + i) as u64);
            let answer = outcomes.answer(&germs, paths, warm)?;
            Ok::<_, SolveError>((germs, answer))
        })?;
        watch.tell(first + block, count);
        for (germs, answer) in answers {
            let touching: Vec<f64> =
                (0..answer.pressure.len()).map(|i| f64::from(u8::from(touches(&answer, i)))).collect();
            let parts = [
                &answer.displacement,
                &answer.stressed,
                &answer.pressure,
                &answer.shear,
                &touching,
                &answer.quantities,
            ];
            for (sum, part) in sums.iter_mut().zip(parts) {
                sum.push(1.0, part)?;
            }
            points.push(germs);
            young.push(answer.modulus);
            values.iter_mut().zip(&answer.quantities).for_each(|(all, v)| all.push(*v));
            iterations += answer.iterations;
            unconverged += usize::from(!answer.converged);
        }
    }
    let equal = vec![1.0; count];
    let (both, errors) = (sums[5].moments(), sums[5].standard_errors());
    let mut quantities = Vec::new();
    for (k, values) in values.into_iter().enumerate() {
        quantities.push(Quantity {
            name: paths[k].clone(),
            mean: both.mean[k],
            variance: both.variance[k],
            standard_error: Some(errors.mean[k]),
            truncation: None,
            quantiles: Some(quantiles(&values, &equal, &settings.quantiles)?),
            density: density(&values, &equal, BINS).ok(), // none of a constant
            effects: None,
            values,
        });
    }
    Ok(StochasticResult {
        labels: Vec::new(),
        probabilities: Vec::new(),
        weights: vec![1.0 / count as f64; count],
        points,
        young,
        quantities,
        displacement: sums[0].moments(),
        stress_displacement: sums[1].moments().mean,
        pressure: sums[2].moments(),
        shear: sums[3].moments(),
        probability: sums[4].moments().mean,
        displacements: Vec::new(),
        fields: Vec::new(),
        cells: None,
        truncation: None,
        truncation_measured: None,
        overlooked: false,
        unseen: None,
        checks: 0,
        end: End::Solved,
        truncation_by_germ: Vec::new(),
        coupled: false,
        solved: count,
        iterations,
        unconverged,
        seconds: 0.0,
    })
}
