//! The results of all outcomes of a scene, and the statistics of the answers at points with weights.

use steklov_problem::Scene;
use steklov_stochastic::{Histogram, Moments, moments};

use super::in_body::BodyMoments;
use super::number::Number;
use super::outcomes::Answer;
use crate::error::SolveError;
use crate::estimators::Estimator;
use crate::solve::contact_rows::TOUCHING;

/// Answers that are held at a time while samples stream by.
pub(super) const BLOCK: usize = 1024;
/// Bins of densities.
pub(super) const BINS: usize = 40;
/// Relative rounding error of sums with weights of both signs.
const ROUNDING: f64 = 1e-10;
/// Errors this many times larger than those that the points show, and than the tolerance, come from something that the points
/// do not see.
pub(super) const OVERLOOKED: f64 = 2.0;
/// Probability of outcomes with data that are neither known nor excluded below which they do not count.
pub(super) const UNDECIDED: f64 = 1e-4;
/// Answers with more numbers than this together are not kept.
pub(super) const KEPT: usize = 8_000_000;

/// Statistics of one quantity.
#[derive(Debug, Clone)]
pub struct Quantity {
    /// Path in the JSON object.
    pub name: String,
    /// Its value at each point.
    pub values: Vec<f64>,
    /// Mean.
    pub mean: f64,
    /// Variance; NaN where the negative weights of a sparse grid make it negative.
    pub variance: f64,
    /// Standard error of the mean; Monte Carlo, plain or multilevel.
    pub standard_error: Option<f64>,
    /// Standard error of the variance; as above.
    pub variance_error: Option<f64>,
    /// Root mean square of the truncation error of polynomials, which is more than the error of the mean. For samples
    /// the largest change of the mean by outcomes that they have not seen.
    pub truncation: Option<f64>,
    /// Quantiles at the probabilities of the scene; none for a sparse grid, whose answers are not a surrogate, and for a
    /// spread that is rounding.
    pub quantiles: Option<Vec<f64>>,
    /// Values that the quantity cannot leave, where the mean does: a rule with negative weights.
    pub bounds_left: Option<[f64; 2]>,
    /// The density of samples.
    pub density: Option<Histogram>,
    /// The share of the variance that remains when all other germs are known, for each germ: Sobol's total effect. None
    /// without a surrogate or a variance.
    ///
    /// Source: Homma and Saltelli (1996).
    pub effects: Option<Vec<f64>>,
}

/// The expansion of a random field.
#[derive(Debug, Clone)]
pub struct FieldModes {
    /// Its name.
    pub name: String,
    /// Eigenvalues λ_m of the covariance.
    pub eigenvalues: Vec<f64>,
    /// Share of the variance that is kept.
    pub captured: f64,
    /// Share that the means over cells cannot have, however many modes there are; 0 without cells.
    pub unresolved: f64,
    /// Arc lengths `[s]` along the side, or points `[x, y]` of the body.
    pub points: Vec<Vec<f64>>,
    /// √λ_m b_m at each of them.
    pub modes: Vec<Vec<f64>>,
}

/// Cells of a stochastic mesh: for each the lower and upper ends and the degree in every germ.
#[derive(Debug, Clone)]
pub struct Cells {
    /// Lower ends.
    pub low: Vec<Vec<f64>>,
    /// Upper ends.
    pub high: Vec<Vec<f64>>,
    /// Degrees.
    pub degree: Vec<Vec<usize>>,
}

/// A level of multilevel Monte Carlo.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Cells of its grid along x and y.
    pub cells: [usize; 2],
    /// Outcomes that were solved on it, and on the coarser grid too but for the coarsest one.
    pub outcomes: usize,
    /// Cost of one of them, as a part of a solution on the finest grid, by count of operations.
    pub cost: f64,
    /// Variance of the difference from the coarser grid, of the coarsest one that of the value, for each quantity.
    pub variances: Vec<f64>,
}

/// Why no more outcomes were solved.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum End {
    /// The requested outcomes are solved.
    #[default]
    Solved,
    /// The estimated truncation is down at the tolerance.
    Tolerance,
    /// The stochastic mesh has as many nodes as allowed.
    MaxNodes,
    /// Refinement does not lead to the tolerance.
    Rounds,
}

impl End {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Solved, Self::Tolerance, Self::MaxNodes, Self::Rounds];

    /// The word of the JSON object.
    pub fn word(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::Tolerance => "tolerance",
            Self::MaxNodes => "max_nodes",
            Self::Rounds => "rounds",
        }
    }
}

/// All outcomes of a scene.
#[derive(Debug, Clone, Default)]
pub struct StochasticResult {
    /// Names of the germs.
    pub labels: Vec<String>,
    /// Germs of each point.
    pub points: Vec<Vec<f64>>,
    /// Weights, sum 1.
    pub weights: Vec<f64>,
    /// Young's modulus of each point, of several bodies that of the first one with a random modulus; on grids its mean over the body.
    pub young: Vec<f64>,
    /// Probabilities of the quantiles.
    pub probabilities: Vec<f64>,
    /// The quantities.
    pub quantities: Vec<Quantity>,
    /// Displacement of the nodes of the boundary.
    pub displacement: Moments,
    /// Mean of E/E₀ times the nodal displacement: the displacement of E₀ with the mean stress; nothing on grids.
    pub stress_displacement: Vec<f64>,
    /// Young's moduli of the cells of a body on a grid in the first few samples; nothing where they do not vary.
    pub moduli: Vec<Vec<f64>>,
    /// The fields in a body on a grid.
    pub in_body: Option<BodyMoments>,
    /// λ_n of each contact condition.
    pub pressure: Moments,
    /// λ_t.
    pub shear: Moments,
    /// Probability of contact at each contact condition; NaN where negative weights put it out of [0, 1].
    pub probability: Vec<f64>,
    /// Displacements at the points, where they are kept.
    pub displacements: Vec<Vec<f64>>,
    /// The random fields.
    pub fields: Vec<FieldModes>,
    /// The stochastic mesh.
    pub cells: Option<Cells>,
    /// The germs of the polynomials that outcomes correct, where they do not have all: their numbers, and the largest share of the
    /// others in the linear variance of a quantity.
    pub kept: Option<(Vec<usize>, f64)>,
    /// The levels of multilevel Monte Carlo, from the coarsest on.
    pub levels: Vec<Level>,
    /// Error of the truncation over the energy norm, both in mean square: estimated, or measured if that is more; none without a
    /// stochastic mesh.
    pub truncation: Option<f64>,
    /// The error that fresh outcomes show.
    pub truncation_measured: Option<f64>,
    /// Whether outcomes have shown what the points do not, beyond the tolerance.
    pub overlooked: bool,
    /// Probability below which other contact, slip or data than those of the points cannot be excluded; none where nothing is left open.
    pub unseen: Option<f64>,
    /// Outcomes solved to look between the points.
    pub checks: usize,
    /// Why no more outcomes were solved.
    pub end: End,
    /// The residual estimator in the mean over the outcomes, if requested.
    pub estimator: Option<Estimator>,
    /// Square of it for each germ.
    pub truncation_by_germ: Vec<f64>,
    /// Whether the nodes of a stochastic cell were coupled.
    pub coupled: bool,
    /// Points that were solved.
    pub solved: usize,
    /// Iterations of the contact solver, all points together.
    pub iterations: usize,
    /// Points whose contact solver did not reach its criterion, or whose forces do not balance.
    pub unconverged: usize,
    /// Wall seconds.
    pub seconds: f64,
}

impl StochasticResult {
    /// Whether the outcomes are in doubt: they show what the points do not, or may do so.
    pub fn is_doubtful(&self) -> bool {
        self.overlooked || self.unseen.is_some() || self.quantities.iter().any(|q| q.bounds_left.is_some())
    }
}

/// The fields that are the mean over points.
fn averaged(weights: &[f64], answers: &[&Answer]) -> Result<(Moments, Vec<f64>, Moments, Moments), SolveError> {
    let of = |f: &(dyn Fn(&Answer) -> Vec<f64> + Sync)| -> Vec<Vec<f64>> { answers.iter().map(|a| f(a)).collect() };
    let stress = moments(weights, &of(&|a| a.stressed.clone()))?.mean;
    Ok((
        moments(weights, &of(&|a| a.displacement.clone()))?,
        stress,
        moments(weights, &of(&|a| a.pressure.clone()))?,
        moments(weights, &of(&|a| a.shear.clone()))?,
    ))
}

/// Statistics of the answers at points with weights.
pub(super) fn of_grid(
    points: Vec<Vec<f64>>,
    weights: Vec<f64>,
    answers: &[Answer],
    numbers: &[Number],
) -> Result<StochasticResult, SolveError> {
    let all: Vec<&Answer> = answers.iter().collect();
    let (displacement, stress_displacement, pressure, shear) = averaged(&weights, &all)?;
    let mut quantities = Vec::new();
    for (k, number) in numbers.iter().enumerate() {
        let values: Vec<f64> = answers.iter().map(|a| a.quantities[k]).collect();
        let both = moments(&weights, &values.iter().map(|v| vec![*v]).collect::<Vec<_>>())?;
        let mean = both.mean[0];
        let squares = |of: &dyn Fn(f64) -> f64| -> f64 {
            weights.iter().zip(&values).map(|(w, v)| of(*w) * (v - mean).powi(2)).sum()
        };
        let negative = squares(&|w| w) < -ROUNDING * squares(&f64::abs);
        quantities.push(Quantity {
            name: number.path.clone(),
            values,
            mean,
            variance: if negative { f64::NAN } else { both.variance[0] },
            standard_error: None,
            variance_error: None,
            truncation: None,
            quantiles: None,
            bounds_left: None,
            density: None,
            effects: None,
        });
    }
    let touching = |i: usize| {
        let touches = answers.iter().zip(&weights).filter(|(a, _)| touches(a, i));
        let share = touches.map(|(_, w)| w).sum::<f64>();
        if (-ROUNDING..=1.0 + ROUNDING).contains(&share) { share.clamp(0.0, 1.0) } else { f64::NAN }
    };
    let size = answers.iter().map(|a| a.displacement.len()).sum::<usize>();
    Ok(StochasticResult {
        probability: (0..pressure.mean.len()).map(touching).collect(),
        young: answers.iter().map(|a| a.modulus).collect(),
        displacements: if size <= KEPT { answers.iter().map(|a| a.displacement.clone()).collect() } else { Vec::new() },
        iterations: answers.iter().map(|a| a.iterations).sum(),
        unconverged: answers.iter().filter(|a| !a.converged).count(),
        solved: points.len(),
        quantities,
        displacement,
        stress_displacement,
        pressure,
        shear,
        points,
        weights,
        ..StochasticResult::default()
    })
}

pub(super) fn touches(answer: &Answer, condition: usize) -> bool {
    let largest = answer.pressure.iter().fold(0.0, |m: f64, p| m.max(*p));
    answer.pressure[condition] > TOUCHING * largest
}

/// Values that a quantity cannot leave, though polynomials may.
pub(super) fn bounds(scene: &Scene, path: &str) -> [f64; 2] {
    let edges = scene.problem.outline.edges().iter().filter(|e| scene.contact(e.side).is_some());
    match path {
        "contact.length" | "contact.stick" | "contact.slip" => [0.0, edges.map(|e| e.length()).sum()],
        "contact.max_pressure" | "strain_energy" | "spring_energy" | "friction_work" => [0.0, f64::INFINITY],
        _ => [f64::NEG_INFINITY, f64::INFINITY],
    }
}
