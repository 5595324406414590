//! Errors of means and variances on one mesh, for each stochastic rule.
//!
//! A component of a vector (`.x`, `.y`) is compared with the whole vector, because a component that symmetry makes zero
//! has no size of its own.

use std::sync::atomic::Ordering;

use steklov_model::error::SolveError;
use steklov_model::grid::OnGrid;
use steklov_model::run::adaptive_loop::Run;
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::stochastic::{
    End, OutcomesWatch, StochasticResult, is_coupled, solve_stochastic, solve_stochastic_on_grid,
};
use steklov_problem::{Random, Scene, Stochastic};
use steklov_stochastic::Accumulator;

use super::relative;
use super::rules::{FAMILIES, Family, Finest, Kind, Rule, prefixes, reference, rules, with};
use crate::table::Column;
use crate::watch::Watch;

/// A quantity varies if its deviation is above this part of its size.
const VARIES: f64 = 1e-10;

/// A quantity of the reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Path in the JSON object.
    pub name: String,
    /// Mean.
    pub mean: f64,
    /// Variance.
    pub variance: f64,
    /// How far mean and variance may be off, over the scales: the change from the rule before the reference, or its standard errors.
    pub uncertainty: [f64; 2],
    /// The scales of the errors: (mean² + variance)^½, and the variance; for a component, those of the whole vector.
    pub scale: [f64; 2],
}

impl Quantity {
    /// Whether it is random.
    pub fn varies(&self) -> bool {
        self.variance.sqrt() > VARIES * self.scale[0]
    }
}

/// A quantity by a rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Number in [`FAMILIES`].
    pub family: usize,
    /// Number in [`Chance::quantities`].
    pub quantity: usize,
    /// Degree, elements, tolerance, level or samples of the rule.
    pub parameter: f64,
    /// Points that were solved.
    pub solves: usize,
    /// Mean and variance.
    pub moments: [f64; 2],
    /// Their errors over the scales.
    pub errors: [f64; 2],
    /// Standard errors of mean and variance over the scales; NaN of rules without samples.
    pub standard_errors: [f64; 2],
    /// Iterations of the contact solver.
    pub iterations: f64,
    /// Wall seconds; of the first samples of a run their part of its seconds.
    pub seconds: f64,
}

/// Columns of the rules.
pub(super) const RULES: [Column<Measured>; 10] = [
    ("parameter", "1", "degree, elements, tolerance, level or samples of the rule", |m| m.parameter),
    ("solves", "1", "outcomes that were solved", |m| m.solves as f64),
    ("mean", "as the quantity", "mean", |m| m.moments[0]),
    ("variance", "square of the quantity", "variance; of samples n/(n-1) times theirs", |m| m.moments[1]),
    ("mean_error", "1", "error of the mean over the root mean square of the quantity", |m| m.errors[0]),
    ("variance_error", "1", "error of the variance over it; NaN of what is not random", |m| m.errors[1]),
    ("mean_standard_error", "1", "standard error of the mean over the same; NaN of rules without samples", |m| {
        m.standard_errors[0]
    }),
    ("variance_standard_error", "1", "that of the variance", |m| m.standard_errors[1]),
    ("iterations", "1", "iterations of the contact solver, all outcomes together", |m| m.iterations),
    ("seconds", "seconds", "wall time of all outcomes; of the first samples of a run their part of it", |m| m.seconds),
];

/// Columns of the quantities.
pub(super) const QUANTITIES: [Column<Quantity>; 6] = [
    ("mean", "as the quantity", "mean by the reference", |q| q.mean),
    ("variance", "square of the quantity", "variance by the reference", |q| q.variance),
    ("mean_uncertainty", "1", "how far the mean may be off, over its scale", |q| q.uncertainty[0]),
    ("variance_uncertainty", "1", "how far the variance may be off, over its scale", |q| q.uncertainty[1]),
    ("mean_scale", "as the quantity", "root mean square that errors of means are relative to", |q| q.scale[0]),
    ("variance_scale", "square of the quantity", "what errors of variances are relative to", |q| q.scale[1]),
];

/// The cost of the outcomes of the scene's own rule, and of one deterministic solve of the same mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Outcomes that were solved.
    pub solves: usize,
    /// Iterations of the contact solver, all outcomes together.
    pub iterations: usize,
    /// Outcomes whose contact solver did not reach its criterion.
    pub unconverged: usize,
    /// Wall seconds of all outcomes, on the matrices of the mesh.
    pub seconds: f64,
    /// Wall seconds of one solve from the mesh on: set-up, assembly, factorisation, contact.
    pub deterministic: f64,
}

/// Errors in chance.
#[derive(Debug, Clone, Default)]
pub struct Chance {
    /// Displacement unknowns of the mesh.
    pub dofs: usize,
    /// Estimated error of the mesh, relative, energy norm; NaN if there is none.
    pub estimate: f64,
    /// The reference in words.
    pub reference: String,
    /// Outcomes of the reference.
    pub solves: usize,
    /// The quantities; empty after a request to stop.
    pub quantities: Vec<Quantity>,
    /// Points by family, rule and quantity.
    pub points: Vec<Measured>,
    /// The scene's own rule.
    pub cost: Option<Cost>,
    /// Rules that failed, and why.
    pub failures: Vec<(String, String)>,
}

impl Chance {
    /// The first two quantities that are random.
    pub fn shown(&self) -> Vec<usize> {
        (0..self.quantities.len()).filter(|&k| self.quantities[k].varies()).take(2).collect()
    }

    /// A quantity by the rules of a family.
    pub fn of(&self, family: usize, quantity: usize) -> impl Iterator<Item = &Measured> {
        self.points.iter().filter(move |m| (m.family, m.quantity) == (family, quantity))
    }
}

/// Solves all outcomes on one mesh or grid by some settings.
type Solve<'s> = &'s dyn Fn(&Random) -> Result<StochasticResult, SolveError>;

/// Solves by all rules on the last mesh of a run. After a request to stop no more rules are tried.
///
/// # Errors
/// The errors of the reference: an impossible outcome, a quantity that is no number of the result.
pub fn chance(
    scene: &Scene,
    random: &Random,
    run: &mut Run<BoundaryElements>,
    watch: &mut Watch<'_>,
) -> Result<Chance, SolveError> {
    let step = run.step();
    let deterministic = step.seconds[..4].iter().sum();
    let estimate = step.estimate.as_ref().map_or(f64::NAN, |e| e.relative);
    let chance = Chance { dofs: step.dofs, estimate, ..Chance::default() };
    let body = match run.matrices(scene) {
        Err(SolveError::Interrupted) => return Ok(chance),
        body => body?,
    };
    let interrupts = watch.interrupts;
    let stopped = || interrupts.load(Ordering::Relaxed) > 0;
    let of_outcomes = OutcomesWatch { stopped: &stopped, ..OutcomesWatch::NONE };
    let solve = |random: &Random| solve_stochastic(scene, random, body, &of_outcomes, &mut |_| Ok(()));
    let coupled = is_coupled(scene, random)?;
    chance.by_all_rules((scene, random), (&solve, deterministic), coupled, watch)
}

/// As [`chance`], on the last grid of a run.
///
/// # Errors
/// As [`chance`].
pub fn chance_on_grid(
    scene: &Scene,
    random: &Random,
    run: &Run<OnGrid>,
    watch: &mut Watch<'_>,
) -> Result<Chance, SolveError> {
    let step = run.step();
    let estimate = step.estimate.as_ref().map_or(f64::NAN, |e| e.relative);
    let chance = Chance { dofs: step.dofs, estimate, ..Chance::default() };
    let interrupts = watch.interrupts;
    let stopped = || interrupts.load(Ordering::Relaxed) > 0;
    let of_outcomes = OutcomesWatch { stopped: &stopped, ..OutcomesWatch::NONE };
    let solve = |random: &Random| solve_stochastic_on_grid(scene, random, &step.layout, &of_outcomes, &mut |_| Ok(()));
    chance.by_all_rules((scene, random), (&solve, step.seconds[..4].iter().sum()), false, watch)
}

impl Chance {
    /// The reference, the scene's own rule, then all rules; `deterministic`: wall seconds of one solve of the mesh.
    fn by_all_rules(
        mut self,
        (scene, random): (&Scene, &Random),
        (solve, deterministic): (Solve<'_>, f64),
        coupled: bool,
        watch: &mut Watch<'_>,
    ) -> Result<Self, SolveError> {
        let finest = reference(scene, random);
        match self.judge(random, solve, &finest, watch) {
            Err(SolveError::Interrupted) => return Ok(self),
            judged => judged?,
        }
        let names: Vec<String> = self.quantities.iter().map(|q| q.name.clone()).collect();
        let named = |s: &Stochastic| with(random, Stochastic { quantities: Some(names.clone()), ..s.clone() });
        watch.tell("outcomes", "by the scene's own rule");
        match solve(&named(&random.stochastic)) {
            Ok(r) => {
                let StochasticResult { solved: solves, iterations, unconverged, seconds, .. } = r;
                self.cost = Some(Cost { solves, iterations, unconverged, seconds, deterministic });
            }
            Err(SolveError::Interrupted) => return Ok(self),
            Err(error) => self.failures.push(("the scene's own rule".into(), error.to_string())),
        }
        // a family that has all outcomes that it may have
        let mut ended = None;
        for rule in rules(scene, random, &finest.finest, coupled) {
            if ended == Some(rule.family) {
                continue;
            }
            let Family { name, parameter, kind } = FAMILIES[rule.family];
            let last = self.solved(rule.family);
            let what = format!("{name}: {parameter} = {}", rule.parameter);
            watch.tell(name, &format!("{parameter} = {}", rule.parameter));
            match solve(&named(&rule.settings)) {
                Ok(result) if kind == Kind::Samples => self.add_samples(&rule, &result)?,
                // a smaller tolerance that changes nothing
                Ok(result) if kind == Kind::ToTolerance && last == Some(result.solved) => {}
                Ok(result) => {
                    ended = Some(rule.family).filter(|_| kind == Kind::ToTolerance && result.end == End::MaxNodes);
                    self.add(&rule, &result);
                }
                Err(SolveError::Interrupted) => break,
                Err(error) => self.failures.push((what, error.to_string())),
            }
        }
        Ok(self)
    }

    /// Solves by the reference rule and by the rule before it.
    fn judge(
        &mut self,
        random: &Random,
        solve: Solve<'_>,
        rule: &Finest,
        watch: &mut Watch<'_>,
    ) -> Result<(), SolveError> {
        watch.tell("reference in chance", &rule.name);
        let before = solve(&with(random, rule.before.clone()))?;
        let names: Vec<String> = before.quantities.iter().map(|q| q.name.clone()).collect();
        // the other component of a vector comes after all quantities
        let other = |name: &String| match (name.strip_suffix(".x"), name.strip_suffix(".y")) {
            (Some(vector), _) => Some(format!("{vector}.y")),
            (_, Some(vector)) => Some(format!("{vector}.x")),
            _ => None,
        };
        let quantities = names.iter().cloned().chain(names.iter().filter_map(other)).collect();
        let result = solve(&with(random, Stochastic { quantities: Some(quantities), ..rule.finest.clone() }))?;
        (self.solves, self.reference) = (result.solved, rule.name.clone());
        let mut others = result.quantities[names.len()..].iter();
        for ((name, q), b) in names.iter().zip(&result.quantities).zip(&before.quantities) {
            let other = other(name).and_then(|_| others.next()).map_or([0.0; 2], |o| [o.mean, o.variance]);
            let variance = q.variance + other[1];
            let size = (q.mean * q.mean + other[0] * other[0] + variance).sqrt();
            let scale = [size, if variance.sqrt() > VARIES * size { variance } else { 0.0 }];
            let change = [(q.mean - b.mean).abs(), (q.variance - b.variance).abs()];
            let off = [q.standard_error.unwrap_or(change[0]), q.variance_error.unwrap_or(change[1])];
            let uncertainty = [0, 1].map(|k| relative(off[k], 0.0, scale[k]));
            let (mean, variance) = (q.mean, q.variance);
            self.quantities.push(Quantity { name: name.clone(), mean, variance, uncertainty, scale });
        }
        Ok(())
    }

    /// Outcomes of the last rule of a family.
    fn solved(&self, family: usize) -> Option<usize> {
        self.of(family, 0).last().map(|m| m.solves)
    }

    fn measured(&self, rule: &Rule, quantity: usize, moments: [f64; 2], standard_errors: [f64; 2]) -> Measured {
        let q = &self.quantities[quantity];
        let reference = [q.mean, q.variance];
        let over = |k: usize| if q.scale[k] > 0.0 { standard_errors[k] / q.scale[k] } else { f64::NAN };
        Measured {
            family: rule.family,
            quantity,
            parameter: rule.parameter,
            solves: 0,
            moments,
            errors: [0, 1].map(|k| relative(moments[k], reference[k], q.scale[k])),
            standard_errors: [over(0), over(1)],
            iterations: f64::NAN,
            seconds: f64::NAN,
        }
    }

    fn add(&mut self, rule: &Rule, result: &StochasticResult) {
        for (k, q) in result.quantities.iter().enumerate() {
            let standard_errors = [q.standard_error, q.variance_error].map(|error| error.unwrap_or(f64::NAN));
            let one = self.measured(rule, k, [q.mean, q.variance], standard_errors);
            let (iterations, seconds) = (result.iterations as f64, result.seconds);
            self.points.push(Measured { solves: result.solved, iterations, seconds, ..one });
        }
    }

    /// Adds Monte Carlo runs of several lengths: the first samples of a run are a shorter run.
    fn add_samples(&mut self, rule: &Rule, result: &StochasticResult) -> Result<(), SolveError> {
        let all = result.points.len();
        for (k, q) in result.quantities.iter().enumerate() {
            let mut sums = Accumulator::default();
            let mut done = 0;
            for n in prefixes(all) {
                q.values[done..n].iter().try_for_each(|v| sums.push(1.0, &[*v]))?;
                done = n;
                let (moments, errors) = (sums.moments(), sums.standard_errors());
                let unbiased = moments.variance[0] * n as f64 / (n.max(2) - 1) as f64;
                let one = self.measured(rule, k, [moments.mean[0], unbiased], [errors.mean[0], errors.variance[0]]);
                let iterations = if n == all { result.iterations as f64 } else { f64::NAN };
                let seconds = result.seconds * n as f64 / all as f64;
                self.points.push(Measured { parameter: n as f64, solves: n, iterations, seconds, ..one });
            }
        }
        Ok(())
    }
}
