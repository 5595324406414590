//! The pictures of the study.

use std::path::{Path, PathBuf};

use steklov_picture::PictureError;

use super::beside::judged;
use super::incompressible::Point;
use super::report::mesh_name;
use super::{SingleLayer, Spectrum, Stabilisation, Stability};
use crate::chart::{Dots, Drawing, Line, Pictures, linear, log};

const ERROR: &str = "relative error, energy norm";

/// Draws errors over ν, eigenvalues over size and stabilised multipliers over γ₀ into a folder; returns the files.
///
/// # Errors
/// When a picture cannot be drawn or written.
pub fn pictures(study: &Stability<'_>, folder: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let mut all = Pictures::new(folder);
    incompressible(study, &mut all)?;
    single_layer(study, &mut all)?;
    if let Some(found) = &study.stabilisation {
        stabilisation(study, found, &mut all)?;
    }
    Ok(all.files)
}

/// A quantity of each mesh over ½ - ν.
fn by_mesh(study: &Stability<'_>, value: fn(&Point) -> f64) -> Vec<Line> {
    let all = &study.incompressible;
    let line = |mesh| Line::new(mesh_name(mesh), [all.of_mesh(mesh).map(|p| [0.5 - p.poisson, value(p)]).collect()]);
    all.meshes().into_iter().map(line).collect()
}

/// Errors as ν → ½; the errors of other methods are dashed.
fn incompressible(study: &Stability<'_>, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    let plane = if study.note().is_some() { " (plane stress)" } else { "" };
    let title = &format!("{}: towards incompressible material{plane}", study.scene.title);
    let x = log("1/2 - Poisson's ratio (incompressible to the left)");
    let lines = by_mesh(study, |p| p.error);
    let drawing = Drawing { title, axes: [x, log(ERROR)], lines, ..Drawing::default() };
    all.draw("incompressible-error", &drawing)?;
    let mut lines = by_mesh(study, |p| p.energy_error);
    for (name, results) in judged(&study.beside, &study.incompressible.truths) {
        let points = results.iter().map(|j| [0.5 - j.poisson, j.energy_error]).collect();
        lines.push(Line::new(name, [Vec::new(), points]));
    }
    let quantities = &["boundary elements", "other methods"][..if study.beside.is_empty() { 1 } else { 2 }];
    let axes = [x, log("energy error (|J - J_ref| / |J_ref|)^1/2")];
    all.draw("incompressible-energy", &Drawing { title, axes, quantities, lines, ..Drawing::default() })
}

/// Eigenvalues of V over the size.
fn single_layer(study: &Stability<'_>, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    let SingleLayer { points, degenerate: [a, b], .. } = &study.single_layer;
    let curve = |value: fn(&Spectrum) -> f64| {
        let (points, flagged) = points.iter().map(|p| ([p.diameter, value(p).abs()], value(p) < 0.0)).unzip();
        Dots { points, flagged }
    };
    let line = |name: &str, curves| Line { name: name.to_owned(), curves };
    let drawing = Drawing {
        title: &format!(
            "{}: single layer matrix V over the size of the body, singular at d = {a:.5} and {b:.5} if L = 1",
            study.scene.title
        ),
        axes: [log("diameter d of the body in its unit of length"), log("|eigenvalue|, V over its diagonal")],
        quantities: &["smallest", "second smallest"],
        lines: vec![
            line("log(L/r), L = d", vec![curve(|p| p.own)]),
            line("log(1/r), L = 1", vec![curve(|p| p.unit[0]), curve(|p| p.unit[1])]),
        ],
        flag: "negative: V is indefinite",
        ..Drawing::default()
    };
    all.draw("single-layer", &drawing)
}

/// The critical γ₀ over elements and over the degree, and errors over γ₀.
fn stabilisation(study: &Stability<'_>, found: &Stabilisation, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    let over_elements = |p: usize| {
        let of = found.critical.iter().filter(|c| c.degree == p);
        Line::new(format!("p = {p}"), [of.map(|c| [c.elements as f64, c.gamma_young]).collect()])
    };
    let over_degree = |n: usize| {
        let of = found.critical.iter().filter(|c| c.elements == n);
        let mut points: Vec<[f64; 2]> = of.map(|c| [c.degree as f64, c.gamma_young]).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Line::new(format!("{n} elements"), [points])
    };
    let over_gamma = |mesh| Line::new(mesh_name(mesh), [found.of_mesh(mesh).map(|p| [p.ratio, p.error]).collect()]);
    let several = |l: &Line| l.curves[0].points.len() > 1;
    let title = &format!("{}: stabilised multipliers, γ = γ₀ h/p²", study.scene.title);
    let critical = linear("critical γ₀ times Young's modulus");
    let mut draw = |name: &str, axes, lines| all.draw(name, &Drawing { title, axes, lines, ..Drawing::default() });
    let lines = found.degrees().into_iter().map(over_elements).filter(several).collect();
    draw("stabilisation-elements", [log("elements"), critical], lines)?;
    let lines = found.elements().into_iter().map(over_degree).filter(several).collect();
    draw("stabilisation-degree", [linear("degree p"), critical], lines)?;
    let lines = found.meshes().into_iter().map(over_gamma).collect();
    draw("stabilisation-error", [log("γ₀ over its critical value"), log(ERROR)], lines)
}
