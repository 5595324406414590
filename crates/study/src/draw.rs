//! The pictures of a study.

use std::path::{Path, PathBuf};

use steklov_figures::contact_pictures;
use steklov_picture::{
    Axis, Band, Chart, Curve, MeshFigure, MeshPanel, PictureError, Scale, Series, chart, meshes, write,
};

use super::strategy::{Point, Strategy};
use super::{Law, Study};

/// Meshes of a strategy in one figure at most.
const PANELS: usize = 6;

/// A quantity of a chart: its name and its value at a step.
type Quantity = (&'static str, fn(&Point) -> f64);

const ERROR: Quantity = ("true error", |p| p.error);
const ESTIMATE: Quantity = ("estimate", |p| p.estimate);
const ENERGY_ERROR: Quantity = ("energy error", |p| p.energy_error);
const EFFECTIVITY: Quantity = ("estimate / error", Point::effectivity);

const DOFS: Axis<'static> = Axis { label: "degrees of freedom N", scale: Scale::Log };
const ROOT: Axis<'static> = Axis { label: "degrees of freedom N", scale: Scale::SquareRoot };

/// Draws the charts, the meshes of each strategy and the contact sides of the last one that has any into a folder;
/// returns the files.
///
/// # Errors
/// When a picture cannot be drawn or written.
pub fn pictures(study: &Study<'_>, folder: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let seconds = format!(
        "seconds ({})",
        if study.repeat > 1 { format!("median of {} runs", study.repeat) } else { "one run".into() }
    );
    let seconds = Axis { label: &seconds, scale: Scale::Log };
    let error = Axis { label: "relative error, energy norm", scale: Scale::Log };
    let energy = Axis { label: "energy error (|J - J_ref| / |J_ref|)^1/2", scale: Scale::Log };
    let ratio = Axis { label: EFFECTIVITY.0, scale: Scale::Linear };
    let dofs: fn(&Point) -> f64 = |p| p.dofs as f64;
    let time: fn(&Point) -> f64 = |p| p.seconds;
    let both = &[ERROR, ESTIMATE][..];
    let within = Band { label: "within 25 %", y: [0.8, 1.25] };
    let mut files = Vec::new();
    let mut draw = |name: &str, c: &Comparison<'_>| -> Result<(), PictureError> {
        files.extend(write(folder, name, &comparison(study, c)?)?);
        Ok(())
    };
    let law = Some(Law::Algebraic);
    draw("error-dofs", &Comparison { x: DOFS, cost: dofs, y: error, quantities: both, law, band: None })?;
    let law = Some(Law::SquareRoot);
    draw("error-root-dofs", &Comparison { x: ROOT, cost: dofs, y: error, quantities: both, law, band: None })?;
    let law = None;
    draw("error-seconds", &Comparison { x: seconds, cost: time, y: error, quantities: both, law, band: None })?;
    let quantities = &[ENERGY_ERROR][..];
    draw("energy-dofs", &Comparison { x: DOFS, cost: dofs, y: energy, quantities, law, band: None })?;
    draw("energy-seconds", &Comparison { x: seconds, cost: time, y: energy, quantities, law, band: None })?;
    let quantities = &[EFFECTIVITY][..];
    draw("effectivity", &Comparison { x: DOFS, cost: dofs, y: ratio, quantities, law, band: Some(within) })?;
    for strategy in study.strategies.iter().filter(|s| !s.points.is_empty()) {
        files.extend(mesh_pictures(study, strategy, folder)?);
    }
    if let Some(strategy) = study.strategies.iter().rev().find(|s| !s.contact.is_empty()) {
        let title =
            format!("{}, {} step {}", study.scene.title, strategy.name, strategy.points.len().saturating_sub(1));
        let names = study.scene.body().outline.side_names();
        files.extend(contact_pictures(&title, names, &strategy.contact, folder, "contact")?);
    }
    Ok(files)
}

/// What a chart compares.
struct Comparison<'a> {
    x: Axis<'a>,
    cost: fn(&Point) -> f64,
    y: Axis<'a>,
    quantities: &'a [Quantity],
    /// The fitted law that the key names.
    law: Option<Law>,
    band: Option<Band<'a>>,
}

fn comparison(study: &Study<'_>, c: &Comparison<'_>) -> Result<steklov_picture::Picture, PictureError> {
    let drawn: Vec<Vec<Drawn>> =
        study.strategies.iter().map(|s| c.quantities.iter().map(|q| drawn(s, c.cost, q)).collect()).collect();
    let curves: Vec<Vec<Curve<'_>>> = drawn
        .iter()
        .map(|all| all.iter().map(|d| Curve { points: &d.points, flagged: &d.flagged }).collect())
        .collect();
    let names: Vec<String> = study.strategies.iter().map(|s| name(s, c.law)).collect();
    let series: Vec<Series<'_>> = names.iter().zip(&curves).map(|(name, curves)| Series { name, curves }).collect();
    let quantities: Vec<&str> = c.quantities.iter().map(|q| q.0).collect();
    chart(&Chart {
        title: &study.scene.title,
        x: c.x,
        y: c.y,
        quantities: &quantities,
        series: &series,
        flag: "estimate not reliable",
        guides: &[],
        band: c.band,
    })
}

/// The points of a curve, and which of them are in doubt.
struct Drawn {
    points: Vec<[f64; 2]>,
    flagged: Vec<bool>,
}

/// A quantity where it is known: true errors are measured at some steps only.
fn drawn(strategy: &Strategy, cost: fn(&Point) -> f64, quantity: &Quantity) -> Drawn {
    // doubts are about estimates
    let of_estimate = [ESTIMATE.0, EFFECTIVITY.0].contains(&quantity.0);
    let known = strategy.points.iter().filter(|p| (quantity.1)(p).is_finite());
    let (points, flagged) = known.map(|p| ([cost(p), (quantity.1)(p)], of_estimate && !p.doubts.is_empty())).unzip();
    Drawn { points, flagged }
}

/// A strategy's name with the law of its errors, if it is of that sort.
fn name(strategy: &Strategy, law: Option<Law>) -> String {
    match strategy.fits().iter().find(|f| Some(f.law) == law) {
        Some(fit) => format!("{}: {}", strategy.name, fit.law.with_rate(fit.rate)),
        None => strategy.name.clone(),
    }
}

fn mesh_pictures(study: &Study<'_>, strategy: &Strategy, folder: &Path) -> Result<[PathBuf; 2], PictureError> {
    let steps = strategy.some(PANELS);
    let elements: Vec<Vec<[[f64; 2]; 2]>> = steps
        .iter()
        .map(|&k| &strategy.points[k].mesh)
        .map(|mesh| (0..mesh.len()).map(|e| mesh.ends(e)).collect())
        .collect();
    let captions: Vec<String> = steps
        .iter()
        .map(|&k| (k, &strategy.points[k]))
        .map(|(k, p)| format!("step {k}: {} elements, {} dofs", p.mesh.len(), p.dofs))
        .collect();
    let panels: Vec<MeshPanel<'_>> = steps
        .iter()
        .zip(elements.iter().zip(&captions))
        .map(|(&k, (elements, caption))| {
            let mesh = &strategy.points[k].mesh;
            MeshPanel { caption, elements, degree: &mesh.degree, side: &mesh.side }
        })
        .collect();
    let title = format!("{}: meshes of {}", study.scene.title, strategy.name);
    let figure = MeshFigure { title: &title, side_names: study.scene.body().outline.side_names(), panels: &panels };
    write(folder, &format!("meshes-{}", strategy.file_name()), &meshes(&figure)?)
}
