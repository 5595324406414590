//! Strategies of refinement compared: true errors and estimates against unknowns and seconds.

use std::sync::atomic::AtomicUsize;

use steklov_bem_operators::{Mark, Mesh, Subdivision};

use crate::reference::true_error;
use crate::run::{Progress, Reason, run};
use crate::scene::{Refine, Scene};
use crate::solve::{SolveError, Stage};

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
    /// ⟨S e, e⟩^½ over ⟨S u, u⟩^½; NaN where it was not measured.
    pub error: f64,
    /// Its estimate.
    pub estimate: f64,
    /// J of the enriched spaces and how far the exact one may be from it.
    pub extrapolated: [f64; 2],
    /// Parts of the estimate: correction, oscillation, tips, each relative.
    pub parts: [f64; 3],
    /// Why the estimate is in doubt; empty if it is not.
    pub doubts: Vec<&'static str>,
}

/// A strategy and its steps.
#[derive(Debug, Clone)]
pub struct Strategy {
    /// Its name in scenes.
    pub name: &'static str,
    /// The steps.
    pub points: Vec<Point>,
    /// Why it ended.
    pub reason: Reason,
}

/// What the errors are measured against.
#[derive(Debug, Clone)]
pub struct Reference {
    /// J.
    pub energy: f64,
    /// Fine mesh with which every mesh is refined for its true error.
    pub subdivision: Subdivision,
    /// Displacement unknowns of the fine mesh.
    pub dofs: usize,
    /// Relative error (energy norm) that is estimated of it.
    pub estimate: f64,
}

/// Relative error (energy norm) that the reference aims at.
const REFERENCE_TOLERANCE: f64 = 3e-8;
/// Unknowns of the reference at most.
const REFERENCE_DOFS: usize = 1400;

/// A fine mesh by the hp strategy.
///
/// # Errors
/// As [`run`].
pub fn reference(scene: &Scene, interrupts: &AtomicUsize) -> Result<Reference, SolveError> {
    let mut fine = scene.clone();
    fine.method.refine = Refine::Hp;
    fine.method.marking = None;
    fine.method.tolerance = REFERENCE_TOLERANCE;
    fine.method.max_dofs = REFERENCE_DOFS;
    let run = run(&fine, Progress::first(&fine), interrupts, &mut |_, _| Ok(()))?;
    let mesh = &run.last.mesh;
    Ok(Reference {
        energy: run.last.energies.total,
        subdivision: Subdivision::new(mesh, &vec![Mark::Keep; mesh.len()]),
        dofs: run.last.space.dofs(),
        estimate: run.step().estimate.relative,
    })
}

/// Runs a strategy `repeat` times and measures its errors.
///
/// # Errors
/// As [`run`].
pub fn strategy(
    scene: &Scene,
    refine: Refine,
    name: &'static str,
    reference: &Reference,
    repeat: usize,
    interrupts: &AtomicUsize,
) -> Result<Strategy, SolveError> {
    let mut scene = scene.clone();
    scene.method.refine = refine;
    let mut seconds: Vec<Vec<f64>> = Vec::new();
    let mut displacements = Vec::new();
    let mut last = None;
    for round in 0..repeat.max(1) {
        displacements.clear();
        let mut ends = Vec::new();
        let finished = run(&scene, Progress::first(&scene), interrupts, &mut |_, stage| {
            if let Stage::Step { solved, seconds } = stage {
                displacements.push(solved.displacement.clone());
                ends.push(seconds);
            }
            Ok(())
        })?;
        seconds.push(ends);
        if round + 1 == repeat.max(1) {
            last = Some((finished.progress.steps, finished.reason));
        }
    }
    let Some((steps, reason)) = last else { unreachable!("it ran at least once") };
    let mut points = Vec::new();
    for (k, (step, displacement)) in steps.into_iter().zip(&displacements).enumerate() {
        let truth = true_error(&scene, &step.mesh, displacement, &reference.subdivision)?;
        let mut times: Vec<f64> = seconds.iter().filter_map(|s| s.get(k).copied()).collect();
        times.sort_by(f64::total_cmp);
        points.push(Point {
            dofs: step.dofs,
            seconds: times[times.len() / 2],
            energy: step.energy,
            energy_error: ((step.energy - reference.energy).abs() / reference.energy.abs()).sqrt(),
            error: truth.error / truth.norm,
            estimate: step.estimate.error / truth.norm,
            extrapolated: [step.estimate.energy, step.estimate.uncertainty],
            parts: [
                step.estimate.correction,
                step.estimate.indicators.iter().map(|i| i.oscillation).sum(),
                step.estimate.tips,
            ]
            .map(|p: f64| p.sqrt() / truth.norm),
            doubts: step.estimate.doubts.iter().map(|d| d.word()).collect(),
            mesh: step.mesh,
        });
    }
    Ok(Strategy { name, points, reason })
}
