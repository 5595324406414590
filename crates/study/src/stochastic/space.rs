//! Errors of the mean energy and of the mean of the energy norm squared over the unknowns in space.
//!
//! All strategies begin on the scene's first mesh; the reference is the last step of the hp strategy, which continues
//! to a smaller tolerance, with the scene's stochastic rule. With one outcome, the middle one (q = 0), errors in space
//! are visible until the stochastic error is larger.

use std::sync::atomic::{AtomicUsize, Ordering};

use steklov_model::error::SolveError;
use steklov_model::run::adaptive_loop::{Progress, Reason, Run, run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::stochastic::{OutcomesWatch, solve_stochastic};
use steklov_problem::{Random, Refine, Scene, Stochastic};

use super::relative;
use super::rules::{settled, single, with};
use crate::fit::{Fit, Law, fit};
use crate::table::Column;
use crate::watch::Watch;

/// Curves: the name, the strategy, whether it has one outcome only, the law of the errors.
pub const CURVES: [(&str, Refine, bool, Law); 4] = [
    ("uniform-h, p = 1, q = 0", Refine::UniformH, true, Law::Algebraic),
    ("uniform-h, p = 1", Refine::UniformH, false, Law::Algebraic),
    ("uniform-p", Refine::UniformP, false, Law::Algebraic),
    ("hp", Refine::Hp, false, Law::SquareRoot),
];

/// The quantities on every mesh: J and half of ⟨u, Su⟩.
const PATHS: [&str; 2] = ["energy", "strain_energy"];
/// The tolerance of the reference is this part of the scene's.
const FINER: f64 = 0.01;
/// A step of the hp strategy has an error if it has at most this part of the reference's unknowns.
const COARSER: f64 = 0.7;
/// A law is reported if it fits this well (R²).
const FITS: f64 = 0.9;
/// Highest degree of uniform-p.
const MAX_DEGREE: usize = 10;

/// A mesh with a stochastic rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Number in [`CURVES`].
    pub curve: usize,
    /// Elements.
    pub elements: usize,
    /// Highest degree.
    pub degree: usize,
    /// Displacement unknowns.
    pub dofs: usize,
    /// Estimated relative error in the energy norm; NaN without one.
    pub estimate: f64,
    /// Outcomes that were solved.
    pub solves: usize,
    /// Iterations of the contact solver, all outcomes together.
    pub iterations: usize,
    /// Means of J and of ⟨u, Su⟩.
    pub means: [f64; 2],
    /// Their relative errors; NaN if the reference is not finer.
    pub errors: [f64; 2],
    /// Wall seconds of a deterministic solve: set-up, assembly, factorisation, contact.
    pub deterministic: f64,
    /// Wall seconds of all outcomes.
    pub seconds: f64,
}

/// Columns of the points.
pub(super) const POINTS: [Column<Point>; 12] = [
    ("elements", "1", "boundary elements", |p| p.elements as f64),
    ("degree", "1", "highest degree", |p| p.degree as f64),
    ("dofs", "1", "displacement unknowns", |p| p.dofs as f64),
    ("estimate", "1", "estimated relative error, energy norm", |p| p.estimate),
    ("solves", "1", "outcomes that were solved", |p| p.solves as f64),
    ("iterations", "1", "iterations of the contact solver, all outcomes together", |p| p.iterations as f64),
    ("energy", "force*length/thickness", "mean of J", |p| p.means[0]),
    ("norm_squared", "force*length/thickness", "mean of <u, S u>", |p| p.means[1]),
    ("energy_error", "1", "relative error of the mean of J; NaN near the reference", |p| p.errors[0]),
    ("norm_squared_error", "1", "that of the mean of <u, S u>", |p| p.errors[1]),
    ("seconds_deterministic", "seconds", "set-up, assembly, factorisation and contact of one outcome", |p| {
        p.deterministic
    }),
    ("seconds", "seconds", "all outcomes, on those matrices", |p| p.seconds),
];

/// Errors in space.
#[derive(Debug, Clone, Default)]
pub struct Space {
    /// Points by curve and mesh.
    pub points: Vec<Point>,
    /// The last step of the hp strategy; None after a request to stop.
    pub reference: Option<Point>,
    /// How far its means may be off, relative: their change from the step before.
    pub uncertainty: [f64; 2],
    /// Strategies that failed, and why.
    pub failures: Vec<(String, String)>,
    /// The stochastic rule in words.
    pub rule: String,
}

impl Space {
    /// The points of a curve.
    pub fn of(&self, curve: usize) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(move |p| p.curve == curve)
    }

    /// The law of the errors of a curve: 0 for J, 1 for ⟨u, Su⟩; None with one outcome, because errors then do not tend
    /// to 0, and if it fits badly.
    pub fn law(&self, curve: usize, which: usize) -> Option<Fit> {
        let (_, _, single, law) = CURVES[curve];
        let errors: Vec<(usize, f64)> = self.of(curve).map(|p| (p.dofs, p.errors[which])).collect();
        if single { None } else { fit(law, &errors).filter(|f| f.r_squared >= FITS && f.rate < 0.0) }
    }
}

/// Runs the strategies, with all outcomes on each of their meshes. After a request to stop nothing more is solved.
///
/// # Errors
/// The errors of the first mesh.
pub fn space(scene: &Scene, random: &Random, watch: &mut Watch<'_>) -> Result<Space, SolveError> {
    let (settings, rule) = settled(scene, random);
    let mut space = Space { rule, ..Space::default() };
    // the reference first: hp
    for strategy in [Refine::Hp, Refine::UniformH, Refine::UniformP] {
        let curves: Vec<(usize, Stochastic)> = (0..CURVES.len())
            .filter(|&k| CURVES[k].1 == strategy)
            .map(|k| (k, if CURVES[k].2 { single(random) } else { settings.clone() }))
            .collect();
        let name = CURVES[curves[0].0].0;
        let told = format!("{} in space", name.split(',').next().unwrap_or(name));
        match meshes(scene, random, strategy, &curves, &told, watch, &mut space.points) {
            Err(SolveError::Interrupted) => break,
            Err(error) if space.points.is_empty() => return Err(error),
            Err(error) => space.failures.push((name.into(), error.to_string())),
            Ok(()) => {}
        }
        if watch.stopped() {
            break;
        }
    }
    space.points.sort_by_key(|p| p.curve);
    space.judge();
    Ok(space)
}

/// The meshes of a strategy, one by one.
fn meshes(
    scene: &Scene,
    random: &Random,
    strategy: Refine,
    curves: &[(usize, Stochastic)],
    name: &str,
    watch: &mut Watch<'_>,
    points: &mut Vec<Point>,
) -> Result<(), SolveError> {
    let mut scene = scene.clone();
    scene.method.refine = strategy;
    scene.method.tolerance = Some(scene.method.tolerance() * FINER);
    if strategy == Refine::UniformH {
        scene.method.degree = 1;
    }
    let mut progress = Progress::first(&scene);
    let (max_dofs, max_steps) = (scene.method.max_dofs(), scene.method.max_steps);
    loop {
        scene.method.max_steps = progress.steps.len() + 1;
        let mut run = run(&scene, progress, watch.interrupts, &mut |step, event| {
            watch.tell_step(name, "", step, &event);
            Ok(())
        })?;
        for (curve, settings) in curves {
            watch.tell(name, &format!("step {}, outcomes", run.progress.steps.len()));
            points.push(point(&scene, random, &mut run, *curve, settings, watch.interrupts)?);
        }
        let next = run.progress.next.dofs();
        let degree = run.step().layout.mesh.degree.iter().copied().max().unwrap_or(0);
        let raised = strategy == Refine::UniformP && degree >= MAX_DEGREE;
        let on = run.reason == Reason::MaxSteps && run.progress.steps.len() < max_steps && next <= max_dofs;
        if !on || raised || watch.stopped() {
            return Ok(());
        }
        progress = run.progress;
    }
}

/// All outcomes on the last mesh of a run.
fn point(
    scene: &Scene,
    random: &Random,
    run: &mut Run<BoundaryElements>,
    curve: usize,
    settings: &Stochastic,
    interrupts: &AtomicUsize,
) -> Result<Point, SolveError> {
    let quantities = Some(PATHS.map(String::from).to_vec());
    let random = with(random, Stochastic { quantities, ..settings.clone() });
    let stopped = || interrupts.load(Ordering::Relaxed) > 0;
    let result = solve_stochastic(
        scene,
        &random,
        run.matrices(scene)?,
        &OutcomesWatch { stopped: &stopped, ..OutcomesWatch::NONE },
        &mut |_| Ok(()),
    )?;
    let step = run.step();
    Ok(Point {
        curve,
        elements: step.layout.mesh.len(),
        degree: step.layout.mesh.degree.iter().copied().max().unwrap_or(0),
        dofs: step.dofs,
        estimate: step.estimate.as_ref().map_or(f64::NAN, |e| e.relative),
        solves: result.solved,
        iterations: result.iterations,
        means: [result.quantities[0].mean, 2.0 * result.quantities[1].mean],
        errors: [f64::NAN; 2],
        deterministic: step.seconds[..4].iter().sum(),
        seconds: result.seconds,
    })
}

impl Space {
    /// Computes the errors of all points against the last hp step.
    fn judge(&mut self) {
        let hp = CURVES.len() - 1;
        let Some(&truth) = self.points.iter().rfind(|p| p.curve == hp) else { return };
        for p in &mut self.points {
            if p.curve != hp || p.dofs as f64 <= COARSER * truth.dofs as f64 {
                p.errors = [0, 1].map(|k| relative(p.means[k], truth.means[k], truth.means[k].abs()));
            }
        }
        let before = self.points.iter().rfind(|p| p.curve == hp && p.dofs < truth.dofs);
        self.uncertainty =
            [0, 1].map(|k| before.map_or(f64::NAN, |b| relative(b.means[k], truth.means[k], truth.means[k].abs())));
        self.reference = Some(truth);
    }
}
