//! The pictures of a study.

use std::path::{Path, PathBuf};

use steklov_figures::{StepMesh, contact_pictures};
use steklov_picture::{Axis, Band, Picture, PictureError, Scale, write};

use super::Study;
use super::strategy::{Point, Strategy};
use crate::chart::{Dots, Drawing, Line, Pictures, linear, log};
use crate::fit::Law;
use crate::show::runs;

/// Largest number of meshes of a strategy in one figure.
const PANELS: usize = 6;

/// A quantity of a chart: its name and its value at a step.
type Quantity = (&'static str, fn(&Point) -> f64);

const ERROR: Quantity = ("true error", |p| p.error);
const ESTIMATE: Quantity = ("estimate", |p| p.estimate);
const ENERGY_ERROR: Quantity = ("energy error", |p| p.energy_error);
const EFFECTIVITY: Quantity = ("estimate / error", Point::effectivity);
const RESIDUAL_EFFECTIVITY: Quantity = ("residual estimator / error", Point::residual_effectivity);

/// Draws into a folder the charts, the meshes of each strategy at `steps` (some steps if it is empty), and the contact
/// sides of the last strategy that has any; returns the files.
///
/// # Errors
/// When a picture cannot be drawn or written.
pub fn pictures(study: &Study<'_>, steps: &[usize], folder: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let mut all = Pictures::new(folder);
    let seconds = format!("seconds ({})", runs(study.repeat));
    let energy = log("energy error (|J - J_ref| / |J_ref|)^1/2");
    let (dofs, seconds) = (log("degrees of freedom N"), log(&seconds));
    let by_dofs: fn(&Point) -> f64 = |p| p.dofs as f64;
    let by_seconds: fn(&Point) -> f64 = |p| p.seconds;
    // with the fitted law that the key names
    for (name, x, cost, law) in [
        ("error-dofs", dofs, by_dofs, Some(Law::Algebraic)),
        ("error-root-dofs", Axis { scale: Scale::SquareRoot, ..dofs }, by_dofs, Some(Law::SquareRoot)),
        ("error-seconds", seconds, by_seconds, None),
    ] {
        let axes = [x, log("relative error, energy norm")];
        let (lines, quantities) = (lines(study, cost, &[ERROR, ESTIMATE], law), &[ERROR.0, ESTIMATE.0]);
        all.draw(name, &Drawing { axes, lines, quantities, ..drawing(study) })?;
    }
    for (name, x, cost) in [("energy-dofs", dofs, by_dofs), ("energy-seconds", seconds, by_seconds)] {
        let lines = lines(study, cost, &[ENERGY_ERROR], None);
        all.draw(name, &Drawing { axes: [x, energy], lines, ..drawing(study) })?;
    }
    let both = [EFFECTIVITY, RESIDUAL_EFFECTIVITY];
    let known = study.strategies.iter().flat_map(|s| &s.points).any(|p| p.residual_effectivity().is_finite());
    let shown = &both[..if known { 2 } else { 1 }];
    let names: Vec<&str> = shown.iter().map(|(name, _)| *name).collect();
    let axes = [dofs, linear(if known { "estimate over true error" } else { EFFECTIVITY.0 })];
    let lines = lines(study, by_dofs, shown, None);
    let band = Some(Band { label: "within 25 %", y: [0.8, 1.25] });
    all.draw("effectivity", &Drawing { axes, lines, band, quantities: &names, ..drawing(study) })?;
    for strategy in study.strategies.iter().filter(|s| !s.points.is_empty()) {
        let mut steps: Vec<usize> = steps.iter().copied().filter(|&step| step < strategy.points.len()).collect();
        if steps.is_empty() {
            steps = strategy.some(PANELS);
        }
        let picture = mesh_picture(&study.scene.title, strategy, &steps)?;
        all.files.extend(write(folder, &format!("meshes-{}", strategy.file_name()), &picture)?);
    }
    if let Some(strategy) = study.strategies.iter().rev().find(|s| !s.contact.is_empty()) {
        let title =
            format!("{}, {} step {}", study.scene.title, strategy.name, strategy.points.len().saturating_sub(1));
        let names = study.scene.problem.outline.side_names();
        all.files.extend(contact_pictures(&title, &study.scene.units, names, &strategy.contact, folder, "contact")?);
    }
    Ok(all.files)
}

fn drawing<'a>(study: &Study<'a>) -> Drawing<'a> {
    Drawing { title: &study.scene.title, flag: "estimate not reliable", ..Drawing::default() }
}

/// One line for each strategy.
fn lines(study: &Study<'_>, cost: fn(&Point) -> f64, quantities: &[Quantity], law: Option<Law>) -> Vec<Line> {
    let line = |s: &Strategy| {
        let curves = quantities.iter().map(|quantity| curve(s, cost, quantity));
        Line { name: name(s, law), curves: curves.collect() }
    };
    study.strategies.iter().map(line).collect()
}

/// A quantity at the steps at which it is known: true errors are measured at some steps only.
fn curve(strategy: &Strategy, cost: fn(&Point) -> f64, quantity: &Quantity) -> Dots {
    // doubts concern estimates
    let of_estimate = [ESTIMATE.0, EFFECTIVITY.0].contains(&quantity.0);
    let known = strategy.points.iter().filter(|p| (quantity.1)(p).is_finite());
    let (points, flagged) = known.map(|p| ([cost(p), (quantity.1)(p)], of_estimate && !p.doubts.is_empty())).unzip();
    Dots { points, flagged }
}

/// The name of a strategy, with the law of its errors if one of this kind was fitted.
fn name(strategy: &Strategy, law: Option<Law>) -> String {
    match strategy.fits().iter().find(|f| Some(f.law) == law) {
        Some(fit) => format!("{}: {}", strategy.name, fit.law.with_rate(fit.rate)),
        None => strategy.name.clone(),
    }
}

/// Draws the meshes of some steps of a strategy.
///
/// # Errors
/// When the picture cannot be drawn.
///
/// # Panics
/// If there is no such step.
pub fn mesh_picture(title: &str, strategy: &Strategy, steps: &[usize]) -> Result<Picture, PictureError> {
    let of_step = |&step: &usize| {
        let Point { dofs, mesh, .. } = &strategy.points[step];
        StepMesh { step, dofs: *dofs, mesh }
    };
    let steps: Vec<StepMesh<'_>> = steps.iter().map(of_step).collect();
    steklov_figures::mesh_picture(&format!("{title}: meshes of {}", strategy.name), &steps)
}
