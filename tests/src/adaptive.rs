//! The problems that adaptivity is judged on, what their true errors are measured with, and fits of errors.

use std::sync::atomic::AtomicUsize;

use steklov_bem_operators::{Mark, Subdivision};
use steklov_model::error::SolveError;
use steklov_model::run::adaptive_loop::{Event, Progress, Run, Step, run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_problem::{Cutting, Refine, Scene};

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

    /// Solves it, mesh by mesh.
    ///
    /// # Panics
    /// If it has no solution.
    pub fn solved(&self) -> Run<BoundaryElements> {
        adapt(&self.scene).unwrap_or_else(|e| panic!("{}: {e}", self.name))
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

/// A scene solved without cuts, and the displacement of each step: true errors are measured with one operator of the body.
///
/// # Errors
/// Those of [`run`].
pub fn solved_in_steps(scene: &Scene) -> Result<(Run<BoundaryElements>, Vec<Vec<f64>>), SolveError> {
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

/// A mesh by the hp strategy an order finer than the tolerance asks for, as far as so many unknowns go: true errors are
/// measured on refinements of it.
///
/// # Errors
/// Those of [`run`].
pub fn finer(scene: &Scene, max_dofs: usize) -> Result<Subdivision, SolveError> {
    let mut fine = scene.clone();
    (fine.method.refine, fine.method.cuts) = (Refine::Hp, Cutting::None);
    fine.method.tolerance = Some(fine.method.tolerance() * 0.1);
    fine.method.max_dofs = Some(max_dofs);
    let mesh = adapt(&fine)?.last.mesh;
    Ok(Subdivision::new(&mesh, &vec![Mark::Keep; mesh.len()]))
}
