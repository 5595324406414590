//! The problems that adaptivity is judged on, what their true errors are measured with, and fits of errors.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use steklov_bem_operators::{Mark, Mesh, Subdivision};
use steklov_model::error::SolveError;
use steklov_model::run::adaptive_loop::{Event, Progress, Run, Step, run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_problem::{Cutting, Refine, Scene};
use steklov_study::reference::{TrueError, true_error};

use crate::{adapt, scene};

/// A problem with a known energy.
pub struct Judged {
    /// What it is called in tables.
    pub name: &'static str,
    /// Its scene; the first mesh is 16 elements of degree 1.
    pub scene: Scene,
    /// J, from several adaptive meshes of independent codes that agree to the digits given.
    pub energy: f64,
}

/// Block on a floor, wedge gap, the block with an unsymmetric load, stick inside contact, a kink off the middle, L-shape; without
/// cuts, whose elements have more unknowns.
pub fn judged() -> [Judged; 6] {
    let tilted = r#"sides.top.traction=["0", "-500*(0.5-x)^2*(0.5+x)^2*(1+0.8*x)"]"#;
    [
        ("block", "block-on-floor", None, -2.993_329_193_070_8),
        ("wedge", "wedge-gap", None, 0.647_194_015_986_9),
        ("tilted", "block-on-floor", Some(tilted), -3.001_529_843_060_5),
        ("stick", "stick-and-slip", None, 0.111_746_203_034),
        ("kink", "kink-in-an-element", None, 0.619_403_975_781_8),
        ("L", "l-shape", None, -12.436_959_264_6),
    ]
    .map(|(name, file, change, energy)| {
        let mut scene = scene(file, change.as_slice());
        (scene.method.tolerance, scene.method.cuts) = (Some(1e-6), Cutting::None);
        scene.method.max_dofs = Some(1500);
        Judged { name, scene, energy }
    })
}

impl Judged {
    /// (|J - J_ref|/|J_ref|)^½.
    pub fn energy_error(&self, step: &Step<BoundaryElements>) -> f64 {
        ((step.energy - self.energy).abs() / self.energy.abs()).sqrt()
    }
}

/// The first step from which the error stays at most so large; none if there is no such step.
pub fn step_below(errors: &[f64], level: f64) -> Option<usize> {
    let above = errors.iter().rposition(|&e| e.is_nan() || e > level);
    let first = above.map_or(0, |k| k + 1);
    (first < errors.len()).then_some(first)
}

/// The line y = a + b x by least squares: b and R² = 1 - (sum of squared residuals)/(sum of squared deviations of y).
pub fn line(x: &[f64], y: &[f64]) -> (f64, f64) {
    let n = x.len() as f64;
    let mean = |v: &[f64]| v.iter().sum::<f64>() / n;
    let (mx, my) = (mean(x), mean(y));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in x.iter().zip(y) {
        xx += (x - mx) * (x - mx);
        xy += (x - mx) * (y - my);
        yy += (y - my) * (y - my);
    }
    (xy / xx, xy * xy / (xx * yy))
}

/// A run, and the displacement of each of its steps.
pub type InSteps = (Run<BoundaryElements>, Vec<Vec<f64>>);

/// A scene solved without cuts, and the displacement of each step: true errors are measured with one operator of the body.
///
/// # Errors
/// Those of [`run`].
pub fn solved_in_steps(scene: &Scene) -> Result<InSteps, SolveError> {
    let mut displacements = Vec::new();
    let mut scene = scene.clone();
    scene.method.cuts = Cutting::None;
    let run = run(&scene, Progress::first(&scene), &AtomicUsize::new(0), &mut |_, event| {
        if let Event::Done { solved, .. } = event {
            displacements.push(solved.displacement.clone());
        }
        Ok(())
    })?;
    Ok((run, displacements))
}

/// A scene solved by the hp strategy without cuts, the displacement of each step, and the number of steps that are as far as its tolerance
/// and so many unknowns go: the others go on to an error that is small beside theirs, or to the second number of unknowns; there are none
/// if all estimates are in doubt.
///
/// # Errors
/// Those of [`run`].
pub fn solved_beyond(scene: &Scene, [most, of_reference]: [usize; 2]) -> Result<(InSteps, usize), SolveError> {
    let (mut displacements, tolerance) = (Vec::new(), scene.method.tolerance());
    let mut scene = scene.clone();
    (scene.method.refine, scene.method.cuts) = (Refine::Hp, Cutting::None);
    (scene.method.tolerance, scene.method.max_dofs) = (Some(FINE * tolerance), Some(of_reference));
    let (mut own, mut least, mut before) = (None, f64::INFINITY, f64::INFINITY);
    let stop = AtomicUsize::new(0);
    let run = run(&scene, Progress::first(&scene), &stop, &mut |number, event| {
        let Event::Done { solved, step, .. } = event else { return Ok(()) };
        displacements.push(solved.displacement.clone());
        let (relative, trusted) = (step.estimate().relative, step.estimate().doubts.is_empty());
        if own.is_none() && number > 0 && step.dofs > most {
            own = Some(number);
        } else if own.is_none() {
            least = if trusted { relative } else { least };
            // an estimate that is in doubt is confirmed by the next one
            let reached = relative <= tolerance && (trusted || before <= tolerance);
            own = reached.then_some(number + 1);
        }
        if own.is_some() && (least.is_infinite() || trusted && relative <= FINE * least) {
            stop.store(1, Ordering::Relaxed);
        }
        before = relative;
        Ok(())
    })?;
    let own = own.unwrap_or(displacements.len());
    Ok(((run, displacements), own))
}

/// A mesh by the hp strategy an order finer than the tolerance asks for, as far as so many unknowns go: true errors are
/// measured on refinements of it.
///
/// # Errors
/// Those of [`run`].
pub fn finer(scene: &Scene, max_dofs: usize) -> Result<Subdivision, SolveError> {
    let run = by_hp(scene, 0.1 * scene.method.tolerance(), max_dofs)?;
    Ok(kept(&run.last.mesh))
}

/// Solves a scene by the hp strategy, without cuts.
fn by_hp(scene: &Scene, tolerance: f64, max_dofs: usize) -> Result<Run<BoundaryElements>, SolveError> {
    let mut fine = scene.clone();
    (fine.method.refine, fine.method.cuts) = (Refine::Hp, Cutting::None);
    (fine.method.tolerance, fine.method.max_dofs) = (Some(tolerance), Some(max_dofs));
    adapt(&fine)
}

fn kept(mesh: &Mesh) -> Subdivision {
    Subdivision::new(mesh, &vec![Mark::Keep; mesh.len()])
}

/// A mesh whose error is at most this part of another one's tells that to half of its square.
const FINE: f64 = 0.05;

/// Meshes with falling errors: the true error of a mesh is measured on refinements of the first one that is fine enough for it.
pub struct Levels(Vec<(Subdivision, f64)>);

impl Levels {
    /// The steps of a run whose estimates are not in doubt, and the last one.
    pub fn of(run: &Run<BoundaryElements>) -> Self {
        let trusted = run.progress.steps.iter().filter(|step| step.estimate().doubts.is_empty());
        let level = |step: &Step<BoundaryElements>| (kept(&step.layout.mesh), step.estimate().relative);
        Self(trusted.chain([run.step()]).map(level).collect())
    }

    /// By the hp strategy, fine enough for errors that are not below a relative one, as far as so many unknowns go.
    ///
    /// # Errors
    /// Those of [`run`].
    pub fn new(scene: &Scene, least: f64, max_dofs: usize) -> Result<Self, SolveError> {
        Ok(Self::of(&by_hp(scene, FINE * least, max_dofs)?))
    }

    /// The distance of a step to the exact solution.
    ///
    /// # Errors
    /// Those of [`true_error`].
    pub fn true_error(
        &self,
        scene: &Scene,
        step: &Step<BoundaryElements>,
        displacement: &[f64],
    ) -> Result<TrueError, SolveError> {
        let last = self.0.len() - 1;
        let fine = |from: usize, error: f64| (from..last).find(|&k| self.0[k].1 <= FINE * error).unwrap_or(last);
        let mut level = fine(0, step.estimate().relative);
        loop {
            let truth = true_error(scene, &step.layout.mesh, displacement, &self.0[level].0)?;
            let error = truth.error / truth.norm;
            if level == last || self.0[level].1 <= FINE * error {
                return Ok(truth);
            }
            // an estimate that is in doubt may be far above the error
            level = fine(level + 1, error);
        }
    }
}

/// One of the [`judged`] problems down to 1e-6, and the displacement of each step: solved once for all tests.
///
/// # Panics
/// If there is no such problem, or it has no solution.
pub fn judged_in_steps(name: &str) -> &'static InSteps {
    static SOLVED: [OnceLock<InSteps>; 6] = [const { OnceLock::new() }; 6];
    let found = judged().into_iter().zip(&SOLVED).find(|(problem, _)| problem.name == name);
    let (problem, solved) = found.expect("a problem of that name");
    solved.get_or_init(|| solved_in_steps(&problem.scene).unwrap_or_else(|e| panic!("{name}: {e}")))
}
