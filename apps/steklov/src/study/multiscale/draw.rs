//! The pictures of the study.

use std::path::{Path, PathBuf};

use super::convergence::Point;
use super::measure::BASES;
use super::{FineGrid, MultiscaleStudy};
use crate::picture::{Axis, Band, Chart, Curve, Picture, PictureError, Scale, Series, chart, write};

/// A line of a chart: a name, and for each quantity its points and which of them are in doubt.
pub(super) struct Line {
    pub name: String,
    pub curves: Vec<Vec<([f64; 2], bool)>>,
}

/// Draws errors, effectivities and cost into a folder; returns the files.
///
/// # Errors
/// When a picture cannot be drawn or written.
pub fn pictures(study: &MultiscaleStudy<'_>, folder: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let mut files = Vec::new();
    let mut draw = |name: &str, picture: Picture| -> Result<(), PictureError> {
        files.extend(write(folder, name, &picture)?);
        Ok(())
    };
    if !study.convergence.points.is_empty() {
        draw("error-dofs", errors(study)?)?;
        draw("effectivity", effectivities(study)?)?;
    }
    if study.fine_grid.error().is_finite() {
        draw("error-seconds", cost(study)?)?;
    }
    Ok(files)
}

const DOFS: Axis<'static> = Axis { label: "degrees of freedom N of the coarse cells", scale: Scale::Log };

/// A line a basis, of those that have one of the values.
fn by_basis(study: &MultiscaleStudy<'_>, values: &[fn(&Point) -> [f64; 2]]) -> Vec<Line> {
    let line = |(k, (name, _)): (usize, &(&str, crate::scene::BasisInput))| Line {
        name: (*name).to_owned(),
        curves: values.iter().map(|v| known(study.convergence.of(k).map(|p| (v(p), false)))).collect(),
    };
    BASES.iter().enumerate().map(line).collect()
}

/// Points whose values are known.
pub(super) fn known(points: impl Iterator<Item = ([f64; 2], bool)>) -> Vec<([f64; 2], bool)> {
    points.filter(|(p, _)| p.iter().all(|v| v.is_finite())).collect()
}

fn errors(study: &MultiscaleStudy<'_>) -> Result<Picture, PictureError> {
    let lines = by_basis(study, &[|p| [p.dofs as f64, p.error], |p| [p.dofs as f64, p.estimate]]);
    let fine = study.fine_grid.error();
    // as wide as a line can be seen
    let band = Band { label: &format!("error of the fine grid itself, {fine:.2e}"), y: [fine / 1.03, 1.03 * fine] };
    drawn(&Drawing {
        title: &format!("{}: multiscale elements against the fine grid", study.scene.title),
        x: DOFS,
        y: Axis { label: "relative error, energy norm", scale: Scale::Log },
        quantities: &["error", "estimate"],
        lines: &lines,
        flag: "",
        band: fine.is_finite().then_some(band),
    })
}

fn effectivities(study: &MultiscaleStudy<'_>) -> Result<Picture, PictureError> {
    let lines = by_basis(study, &[|p| [p.dofs as f64, p.effectivity()]]);
    drawn(&Drawing {
        title: &format!("{}: effectivity of the estimate", study.scene.title),
        x: DOFS,
        y: Axis { label: "estimate / error", scale: Scale::Linear },
        quantities: &["estimate / error"],
        lines: &lines,
        flag: "",
        band: Some(Band { label: "within 25 %", y: [0.8, 1.25] }),
    })
}

fn cost(study: &MultiscaleStudy<'_>) -> Result<Picture, PictureError> {
    let FineGrid { levels, .. } = study.fine_grid;
    let fem = known(levels.iter().map(|l| ([l.seconds, l.error], false)));
    let mut lines = vec![Line { name: "bilinear, finer and finer grids".into(), curves: vec![fem] }];
    lines.extend(by_basis(study, &[|p| [p.seconds, p.total]]));
    let runs = if study.repeat > 1 { format!("median of {} runs", study.repeat) } else { "one run".into() };
    drawn(&Drawing {
        title: &format!("{}: error against the limit of fine grids", study.scene.title),
        x: Axis { label: &format!("seconds ({runs})"), scale: Scale::Log },
        y: Axis { label: "relative error, energy norm, fine grid's included", scale: Scale::Log },
        quantities: &["error"],
        lines: &lines,
        flag: "",
        band: None,
    })
}

/// What a chart shows.
pub(super) struct Drawing<'a> {
    pub title: &'a str,
    pub x: Axis<'a>,
    pub y: Axis<'a>,
    pub quantities: &'a [&'a str],
    pub lines: &'a [Line],
    /// What doubt means.
    pub flag: &'a str,
    pub band: Option<Band<'a>>,
}

/// Draws the lines that have points.
pub(super) fn drawn(d: &Drawing<'_>) -> Result<Picture, PictureError> {
    let lines: Vec<(&str, Vec<(Vec<[f64; 2]>, Vec<bool>)>)> = d
        .lines
        .iter()
        .filter(|l| l.curves.iter().any(|c| !c.is_empty()))
        .map(|l| (&l.name[..], l.curves.iter().map(|c| c.iter().copied().unzip()).collect()))
        .collect();
    let curves: Vec<Vec<Curve<'_>>> =
        lines.iter().map(|(_, all)| all.iter().map(|(points, flagged)| Curve { points, flagged }).collect()).collect();
    let series: Vec<Series<'_>> =
        lines.iter().zip(&curves).map(|((name, _), curves)| Series { name, curves }).collect();
    let (quantities, band) = (d.quantities, d.band);
    chart(&Chart { title: d.title, x: d.x, y: d.y, quantities, series: &series, flag: d.flag, guides: &[], band })
}
