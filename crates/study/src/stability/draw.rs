//! The pictures of the study.

use std::path::{Path, PathBuf};

use steklov_picture::{Axis, Chart, Curve, Picture, PictureError, Scale, Series, chart, write};

use super::beside::judged;
use super::incompressible::Point;
use super::table::mesh_name;
use super::{SingleLayer, Spectrum, Stabilisation, Stability};

/// A curve that owns its points.
struct Line {
    name: String,
    points: Vec<[f64; 2]>,
    /// Of another method: dashed.
    other: bool,
}

/// Draws errors over ν, eigenvalues over size and stabilised multipliers over γ₀ into a folder; returns the files.
///
/// # Errors
/// When a picture cannot be drawn or written.
pub fn pictures(study: &Stability<'_>, folder: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let energy = "energy error (|J - J_ref| / |J_ref|)^1/2";
    let mut files = Vec::new();
    let mut draw = |name: &str, picture: Picture| -> Result<(), PictureError> {
        files.extend(write(folder, name, &picture)?);
        Ok(())
    };
    let of = lines(study, |p| p.error);
    draw("incompressible-error", incompressible(study, "relative error, energy norm", &of)?)?;
    let mut of = lines(study, |p| p.energy_error);
    for (name, results) in judged(study.beside, &study.incompressible.truths) {
        let points = results.iter().map(|j| [0.5 - j.poisson, j.energy_error]).collect();
        of.push(Line { name: name.to_owned(), points, other: true });
    }
    draw("incompressible-energy", incompressible(study, energy, &of)?)?;
    draw("single-layer", single_layer(study)?)?;
    if let Some(all) = study.stabilisation {
        for (name, picture) in stabilisation(study, all)? {
            draw(name, picture)?;
        }
    }
    Ok(files)
}

/// A quantity of each mesh over ½ - ν.
fn lines(study: &Stability<'_>, value: fn(&Point) -> f64) -> Vec<Line> {
    let all = study.incompressible;
    let points = |mesh| all.of_mesh(mesh).map(|p| [0.5 - p.poisson, value(p)]).collect();
    all.meshes().into_iter().map(|mesh| Line { name: mesh_name(mesh), points: points(mesh), other: false }).collect()
}

fn incompressible(study: &Stability<'_>, label: &str, lines: &[Line]) -> Result<Picture, PictureError> {
    let none = Curve { points: &[], flagged: &[] };
    let curves: Vec<[Curve<'_>; 2]> = lines
        .iter()
        .map(|l| (l.other, Curve { points: &l.points, flagged: &[] }))
        .map(|(other, curve)| if other { [none, curve] } else { [curve, none] })
        .collect();
    let others = lines.iter().any(|l| l.other);
    let quantities = &["boundary elements", "other methods"][..if others { 2 } else { 1 }];
    let series: Vec<Series<'_>> = lines
        .iter()
        .zip(&curves)
        .map(|(l, curves)| Series { name: &l.name, curves: &curves[..quantities.len()] })
        .collect();
    let plane = if study.note().is_some() { " (plane stress)" } else { "" };
    chart(&Chart {
        title: &format!("{}: towards incompressible material{plane}", study.scene.title),
        x: Axis { label: "1/2 - Poisson's ratio (incompressible to the left)", scale: Scale::Log },
        y: Axis { label, scale: Scale::Log },
        quantities,
        series: &series,
        flag: "",
        guides: &[],
        band: None,
    })
}

fn single_layer(study: &Stability<'_>) -> Result<Picture, PictureError> {
    let SingleLayer { points, degenerate: [a, b], .. } = study.single_layer;
    let curve = |value: fn(&Spectrum) -> f64| -> (Vec<[f64; 2]>, Vec<bool>) {
        points.iter().map(|p| ([p.diameter, value(p).abs()], value(p) < 0.0)).unzip()
    };
    let all = [curve(|p| p.own), curve(|p| p.unit[0]), curve(|p| p.unit[1])];
    let curves: Vec<Curve<'_>> = all.iter().map(|(points, flagged)| Curve { points, flagged }).collect();
    chart(&Chart {
        title: &format!(
            "{}: single layer matrix V over the size of the body, singular at d = {a:.5} and {b:.5} if L = 1",
            study.scene.title
        ),
        x: Axis { label: "diameter d of the body in its unit of length", scale: Scale::Log },
        y: Axis { label: "|eigenvalue|, V over its diagonal", scale: Scale::Log },
        quantities: &["smallest", "second smallest"],
        series: &[
            Series { name: "log(L/r), L = d", curves: &curves[..1] },
            Series { name: "log(1/r), L = 1", curves: &curves[1..] },
        ],
        flag: "negative: V is indefinite",
        guides: &[],
        band: None,
    })
}

/// The critical γ₀ over elements and over the degree, and errors over γ₀.
fn stabilisation(study: &Stability<'_>, all: &Stabilisation) -> Result<Vec<(&'static str, Picture)>, PictureError> {
    let line = |name: String, points: Vec<[f64; 2]>| Line { name, points, other: false };
    let (mut degrees, mut counts): (Vec<usize>, Vec<usize>) =
        all.critical.iter().map(|c| (c.degree, c.elements)).unzip();
    for list in [&mut degrees, &mut counts] {
        list.sort_unstable();
        list.dedup();
    }
    let over_elements = |p: &usize| {
        let of = all.critical.iter().filter(|c| c.degree == *p);
        line(format!("p = {p}"), of.map(|c| [c.elements as f64, c.gamma_young]).collect())
    };
    let over_degree = |n: &usize| {
        let mut of: Vec<[f64; 2]> =
            all.critical.iter().filter(|c| c.elements == *n).map(|c| [c.degree as f64, c.gamma_young]).collect();
        of.sort_by(|a, b| a[0].total_cmp(&b[0]));
        line(format!("{n} elements"), of)
    };
    let over_gamma = |mesh: (usize, usize)| {
        let of = all.errors.iter().filter(|p| (p.elements, p.degree) == mesh);
        line(mesh_name(mesh), of.map(|p| [p.ratio, p.error]).collect())
    };
    let several = |l: &Line| l.points.len() > 1;
    let critical = Axis { label: "critical γ₀ times Young's modulus", scale: Scale::Linear };
    let figures = [
        (
            "stabilisation-elements",
            Axis { label: "elements", scale: Scale::Log },
            critical,
            degrees.iter().map(over_elements).filter(several).collect::<Vec<_>>(),
        ),
        (
            "stabilisation-degree",
            Axis { label: "degree p", scale: Scale::Linear },
            critical,
            counts.iter().map(over_degree).filter(several).collect(),
        ),
        (
            "stabilisation-error",
            Axis { label: "γ₀ over its critical value", scale: Scale::Log },
            Axis { label: "relative error, energy norm", scale: Scale::Log },
            all.meshes().into_iter().map(over_gamma).collect(),
        ),
    ];
    let title = format!("{}: stabilised multipliers, γ = γ₀ h/p²", study.scene.title);
    let drawn = figures.map(|(name, x, y, lines)| {
        let curves: Vec<[Curve<'_>; 1]> = lines.iter().map(|l| [Curve { points: &l.points, flagged: &[] }]).collect();
        let series: Vec<Series<'_>> =
            lines.iter().zip(&curves).map(|(l, curves)| Series { name: &l.name, curves }).collect();
        let quantities = &["value"];
        chart(&Chart { title: &title, x, y, quantities, series: &series, flag: "", guides: &[], band: None })
            .map(|picture| (name, picture))
    });
    drawn.into_iter().collect()
}
