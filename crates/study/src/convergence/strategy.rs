//! One strategy: its runs, its seconds, its true errors.

use std::time::Instant;

use steklov_bem_operators::Mesh;
use steklov_model::data::on_mesh::OnMesh;
use steklov_model::error::SolveError;
use steklov_model::estimate::residual::{estimator, knows_residuals};
use steklov_model::estimators::Estimator;
use steklov_model::run::adaptive_loop::{Event, Progress, Reason, Run, Step, run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::solve::contact_rows::{ContactRow, contact_rows};
use steklov_model::solve::solution::Solved;
use steklov_problem::{Cutting, Multiplier, Refine, Scene};

use super::{MEASURED, chosen};
use crate::fit::{Fit, Law, fit};
use crate::median;
use crate::reference::Reference;
use crate::watch::Watch;

/// The strategies and their names in scenes.
pub const NAMES: [(&str, Refine); 5] = [
    ("uniform-h", Refine::UniformH),
    ("uniform-p", Refine::UniformP),
    ("h", Refine::H),
    ("hp-decay", Refine::HpDecay),
    ("hp", Refine::Hp),
];

/// The multipliers and their names in scenes.
pub const MULTIPLIERS: [(&str, Multiplier); 2] =
    [("biorthogonal", Multiplier::Biorthogonal), ("stabilised", Multiplier::Stabilised)];

/// The scene with biorthogonal multipliers: true errors are distances to its solution, which on a fine mesh agrees with
/// that of all multipliers.
pub(crate) fn for_truth(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.method.multiplier = Multiplier::Biorthogonal;
    scene
}

/// Relative errors below this are rounding errors.
const ROUNDED: f64 = 1e-9;

/// A step of a strategy.
#[derive(Debug, Clone)]
pub struct Point {
    /// Its mesh.
    pub mesh: Mesh,
    /// Displacement unknowns.
    pub dofs: usize,
    /// Seconds from the beginning of the run to the end of this step, the median of the repeated runs.
    pub seconds: f64,
    /// J.
    pub energy: f64,
    /// (|J - J_ref|/|J_ref|)^½.
    pub energy_error: f64,
    /// ⟨S e, e⟩^½ over that of the reference solution; NaN if it was not measured.
    pub error: f64,
    /// Estimate of the error, over the same norm.
    pub estimate: f64,
    /// J of the enriched spaces, and how far the exact J may be from it.
    pub extrapolated: [f64; 2],
    /// Parts of the estimate, over the same norm: correction, oscillation, tips.
    pub parts: [f64; 3],
    /// The residual estimator and its parts, over the same norm; None if the scene has none.
    pub residual: Option<Estimator>,
    /// Why the estimate is in doubt; empty if it is not.
    pub doubts: Vec<&'static str>,
}

impl Point {
    /// Estimate over error; NaN if the error was not measured.
    pub fn effectivity(&self) -> f64 {
        self.estimate / self.error
    }

    /// Residual estimator over error; NaN if one of them is unknown.
    pub fn residual_effectivity(&self) -> f64 {
        self.residual.as_ref().map_or(f64::NAN, |residual| residual.value / self.error)
    }

    /// Highest degree of its mesh.
    pub fn max_degree(&self) -> usize {
        self.mesh.degree.iter().copied().max().unwrap_or(0)
    }

    fn new(
        step: &Step<BoundaryElements>,
        (error, residual): (Option<f64>, Option<&Estimator>),
        reference: &Reference,
        mut times: Vec<f64>,
    ) -> Self {
        let (estimate, norm) = (step.estimate(), reference.norm);
        let oscillation: f64 = estimate.indicators.iter().map(|i| i.oscillation).sum();
        Self {
            mesh: step.layout.mesh.clone(),
            dofs: step.dofs,
            seconds: median(&mut times),
            energy: step.energy,
            energy_error: reference.energy_error(step.energy),
            error: error.map_or(f64::NAN, |e| e / norm),
            estimate: estimate.error / norm,
            extrapolated: [estimate.energy, estimate.uncertainty],
            parts: [estimate.correction, oscillation, estimate.tips].map(|p| p.max(0.0).sqrt() / norm),
            residual: residual.map(|residual| residual.over(norm)),
            doubts: estimate.doubts.iter().map(|d| d.word()).collect(),
        }
    }
}

/// The constants of a residual estimator η over the measured steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constants {
    /// The largest error over η: the error is at most this times η.
    pub reliability: f64,
    /// The largest η over error: η is at most this times the error.
    pub efficiency: f64,
    /// Steps that were measured.
    pub steps: usize,
}

/// How a strategy ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum End {
    /// The reason why the run ended.
    Run(Reason),
    /// An error; the steps before it are kept.
    Failed(String),
}

impl End {
    /// The word of the JSON object.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Run(reason) => reason.word(),
            Self::Failed(_) => "failed",
        }
    }
}

/// A strategy and its steps.
#[derive(Debug, Clone)]
pub struct Strategy {
    /// Its name in scenes, with the name of its multiplier if several are compared.
    pub name: String,
    /// The steps.
    pub points: Vec<Point>,
    /// How it ended.
    pub end: End,
    /// The contact table of the last step; empty without contact.
    pub contact: Vec<ContactRow>,
}

impl Strategy {
    /// Its name as part of a file name.
    pub(super) fn file_name(&self) -> String {
        self.name.replace(", ", "-")
    }

    /// At most `most` of the steps: the first, the last and some between.
    pub(super) fn some(&self, most: usize) -> Vec<usize> {
        chosen(&self.points.iter().map(|p| p.dofs).collect::<Vec<_>>(), most)
    }

    /// Whether it reached its tolerance, rounding errors or a limit.
    pub fn complete(&self) -> bool {
        !matches!(self.end, End::Failed(_) | End::Run(Reason::Interrupted | Reason::Solver))
    }

    /// The constants of the residual estimator; None if no step was measured. Rounding errors are left out.
    pub fn constants(&self) -> Option<Constants> {
        let known = self.points.iter().filter(|p| p.error > ROUNDED).map(Point::residual_effectivity);
        let ratios: Vec<f64> = known.filter(|ratio| ratio.is_finite()).collect();
        let largest = |of: fn(f64) -> f64| ratios.iter().fold(0.0, |m: f64, ratio| m.max(of(*ratio)));
        let (reliability, efficiency) = (largest(f64::recip), largest(|ratio| ratio));
        (!ratios.is_empty()).then_some(Constants { reliability, efficiency, steps: ratios.len() })
    }

    /// Laws fitted to its true errors: a power law, for hp strategies exponential laws.
    pub fn fits(&self) -> Vec<Fit> {
        let laws = if self.name.starts_with("hp") { &[Law::SquareRoot, Law::CubeRoot][..] } else { &[Law::Algebraic] };
        let errors: Vec<(usize, f64)> = self.points.iter().map(|p| (p.dofs, p.error)).collect();
        laws.iter().filter_map(|&law| fit(law, &errors)).collect()
    }
}

/// Runs a strategy `repeat` times and measures the errors of some of its steps, evenly spaced in log N. After a request
/// to stop nothing more is run or measured.
///
/// An error of the solver ends the strategy, not the study: [`End::Failed`].
pub fn strategy(
    scene: &Scene,
    (name, refine): (&str, Refine),
    reference: &Reference,
    repeat: usize,
    watch: &mut Watch<'_>,
) -> Strategy {
    let mut scene = scene.clone();
    // errors are measured with one Steklov-Poincaré operator of the body
    (scene.method.refine, scene.method.cuts) = (refine, Cutting::None);
    let truth = for_truth(&scene);
    let what = |k: usize| format!("{name}, run {k} of {}", repeat.max(1));
    let first = Round::new(&scene, &what(1), true, watch);
    let run = match &first.run {
        Ok(run) => run,
        Err(error) => {
            let end = match error {
                SolveError::Interrupted => End::Run(Reason::Interrupted),
                error => End::Failed(error.to_string()),
            };
            return Strategy { name: name.into(), points: Vec::new(), end, contact: Vec::new() };
        }
    };
    let mut ends = vec![first.ends];
    while ends.len() < repeat && !watch.stopped() {
        ends.push(Round::new(&scene, &what(ends.len() + 1), false, watch).ends);
    }
    let steps = &run.progress.steps;
    let dofs: Vec<usize> = steps.iter().map(|s| s.dofs).collect();
    let measured = chosen(&dofs, MEASURED);
    let mut points = Vec::with_capacity(steps.len());
    for (k, (step, (displacement, residual))) in steps.iter().zip(&first.left).enumerate() {
        // an error that cannot be measured is unknown; the point keeps its estimate
        let error = (measured.contains(&k) && !watch.stopped()).then(|| {
            watch.tell(&format!("{name}, true errors"), &format!("step {} of {}", k + 1, steps.len()));
            reference.true_error(&truth, step, displacement, watch.interrupts).ok().flatten()
        });
        let times = ends.iter().filter_map(|e| e.get(k).copied()).collect();
        points.push(Point::new(step, (error.flatten(), residual.as_ref()), reference, times));
    }
    let contact = run.last.contact.as_ref().map_or(Vec::new(), |c| contact_rows(run.last.trace(), c));
    let end = run.error.as_ref().map_or(End::Run(run.reason), |error| End::Failed(error.to_string()));
    Strategy { name: name.into(), points, end, contact }
}

/// One run, and the results of its steps.
struct Round {
    run: Result<Run<BoundaryElements>, SolveError>,
    /// Nodal displacement and residual estimator of each step.
    left: Vec<(Vec<f64>, Option<Estimator>)>,
    /// Seconds from the beginning of the run to the end of each step.
    ends: Vec<f64>,
}

impl Round {
    /// `first`: whether the results of steps are evaluated; later runs are for the seconds alone.
    fn new(scene: &Scene, what: &str, first: bool, watch: &mut Watch<'_>) -> Self {
        let (mut left, mut ends) = (Vec::new(), Vec::new());
        // the run does not need what is evaluated here
        let mut looking = 0.0;
        let run = run(scene, Progress::first(scene), watch.interrupts, &mut |step, event| {
            watch.tell_step(what, "", step, &event);
            if let Event::Done { solved, step, seconds } = event {
                ends.push(seconds - looking);
                if !first {
                    return Ok(());
                }
                let clock = Instant::now();
                // an estimator that cannot be computed is unknown
                left.push((solved.displacement.clone(), residual(scene, solved, step).ok().flatten()));
                looking += clock.elapsed().as_secs_f64();
            }
            Ok(())
        });
        Self { run, left, ends }
    }
}

/// The residual estimator of a step; None if the scene has none.
fn residual(scene: &Scene, solved: &Solved, step: &Step<BoundaryElements>) -> Result<Option<Estimator>, SolveError> {
    if !knows_residuals(scene) {
        return Ok(None);
    }
    let known = step.estimate.as_ref().map(|estimate| &estimate.residuals).filter(|known| !known.is_empty());
    let residuals = match known {
        Some(known) => known.clone(),
        None => OnMesh { scene, mesh: &solved.mesh, space: &solved.space }.all_residuals(solved)?,
    };
    Ok(Some(estimator(&residuals, solved)))
}
