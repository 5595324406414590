//! The pictures of the study.

use std::path::{Path, PathBuf};

use steklov_picture::{Axis, Band, Chart, Curve, Picture, PictureError, Scale, Series, chart, write};

use super::contrast::{CONTRASTED, PARTS, Stiff};
use super::convergence::Point;
use super::laminates::{LAMINATES, Layers, RESONATING};
use super::measure::BASES;
use super::{FineGrid, MultiscaleStudy};

/// A line of a chart: a name, and a curve for each quantity.
struct Line {
    name: String,
    curves: Vec<Dots>,
}

/// Points of a curve, and which of them are in doubt.
struct Dots {
    points: Vec<[f64; 2]>,
    doubtful: Vec<bool>,
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
    if !study.laminates.points.is_empty() {
        for (name, picture) in resonance(study)? {
            draw(name, picture)?;
        }
    }
    if !study.contrast.points.is_empty() {
        draw("contrast-error", contrast(study, false)?)?;
        draw("contrast-effectivity", contrast(study, true)?)?;
    }
    Ok(files)
}

const DOFS: Axis<'static> = Axis { label: "degrees of freedom N of the coarse cells", scale: Scale::Log };

/// A line a basis, of those that have one of the values.
fn by_basis(study: &MultiscaleStudy<'_>, values: &[fn(&Point) -> [f64; 2]]) -> Vec<Line> {
    let line = |(k, (name, _)): (usize, &(&str, steklov_problem::BasisInput))| Line {
        name: (*name).to_owned(),
        curves: values.iter().map(|v| known(study.convergence.of(k).map(|p| (v(p), false)))).collect(),
    };
    BASES.iter().enumerate().map(line).collect()
}

/// Points whose values are known.
fn known(points: impl Iterator<Item = ([f64; 2], bool)>) -> Dots {
    let (points, doubtful) = points.filter(|(p, _)| p.iter().all(|v| v.is_finite())).unzip();
    Dots { points, doubtful }
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

/// Errors and effectivities over the period of layers and over the size of coarse cells: a line a basis, the two laminates
/// solid and dashed.
fn resonance(study: &MultiscaleStudy<'_>) -> Result<[(&'static str, Picture); 4], PictureError> {
    let all = study.laminates;
    let eps: fn(&Layers) -> f64 = |l| 1.0 / l.periods as f64;
    let size: fn(&Layers) -> f64 = |l| 1.0 / l.coarse as f64;
    let error: fn(&Layers) -> f64 = |l| l.error;
    let effectivity: fn(&Layers) -> f64 = |l| l.estimate / l.error;
    let drawing = |over_periods: bool, value: fn(&Layers) -> f64, label: &str, band: Option<Band<'_>>| {
        let line = |(basis, (name, _)): (usize, &(&str, steklov_problem::BasisInput))| {
            let curve = |laminate: usize| match over_periods {
                true => known(all.over_periods(laminate, basis).map(|l| ([eps(l), value(l)], false))),
                false => known(all.over_cells(laminate, basis).map(|l| ([size(l), value(l)], false))),
            };
            Line { name: (*name).to_owned(), curves: (0..LAMINATES.len()).map(curve).collect() }
        };
        let lines: Vec<Line> = RESONATING.iter().enumerate().map(line).collect();
        let fixed = |laminate: usize| match over_periods {
            true => all.over_periods(laminate, 0).next().map_or(String::new(), |l| format!("H = 1/{}", l.coarse)),
            false => all.over_cells(laminate, 0).next().map_or(String::new(), |l| format!("ε = 1/{}", l.periods)),
        };
        let names: Vec<String> = (0..LAMINATES.len()).map(|k| format!("{}, {}", LAMINATES[k].0, fixed(k))).collect();
        drawn(&Drawing {
            title: "Layers 1:10 on the unit square, 256 × 256 cells",
            x: Axis {
                label: if over_periods { "period ε of the layers" } else { "size H of the coarse cells" },
                scale: Scale::Log,
            },
            y: Axis { label, scale: if band.is_some() { Scale::Linear } else { Scale::Log } },
            quantities: &names.iter().map(|n| &n[..]).collect::<Vec<_>>(),
            lines: &lines,
            flag: "",
            band,
        })
    };
    let relative = "relative error, energy norm";
    let ratio = "estimate / error";
    let within = || Some(Band { label: "within 25 %", y: [0.8, 1.25] });
    Ok([
        ("resonance-period", drawing(true, error, relative, None)?),
        ("resonance-period-effectivity", drawing(true, effectivity, ratio, within())?),
        ("resonance-cells", drawing(false, error, relative, None)?),
        ("resonance-cells-effectivity", drawing(false, effectivity, ratio, within())?),
    ])
}

/// Errors of all bases, or effectivities of the coupled one, over the contrast: a line a place of the stiff parts.
fn contrast(study: &MultiscaleStudy<'_>, effectivity: bool) -> Result<Picture, PictureError> {
    let all = study.contrast;
    let curve = |part: usize, basis: usize, value: fn(&Stiff) -> f64| {
        known(all.of(part, basis).map(|s| ([s.contrast, value(s)], s.warned())))
    };
    let line = |(part, (name, _)): (usize, &(&str, &str))| Line {
        name: (*name).to_owned(),
        curves: match effectivity {
            true => vec![curve(part, 0, |s| s.nodal), curve(part, 0, |s| s.jump)],
            false => (0..CONTRASTED.len()).map(|basis| curve(part, basis, |s| s.error)).collect(),
        },
    };
    let lines: Vec<Line> = PARTS.iter().enumerate().map(line).collect();
    let bases = CONTRASTED.map(|c| c.0);
    drawn(&Drawing {
        title: if effectivity {
            "Plate with stiff parts, coupled basis: effectivity of two estimates"
        } else {
            "Plate with stiff parts, 8 × 4 coarse cells of 16 × 16"
        },
        x: Axis { label: "contrast of the moduli", scale: Scale::Log },
        y: Axis {
            label: if effectivity { "estimate / error" } else { "relative error, energy norm" },
            scale: Scale::Log,
        },
        quantities: if effectivity { &["nodal residuals", "jumps of tractions"] } else { &bases },
        lines: &lines,
        flag: "contrast along coarse edges: solve warns",
        band: effectivity.then_some(Band { label: "within 25 %", y: [0.8, 1.25] }),
    })
}

/// What a chart shows.
struct Drawing<'a> {
    title: &'a str,
    x: Axis<'a>,
    y: Axis<'a>,
    quantities: &'a [&'a str],
    lines: &'a [Line],
    /// What doubt means.
    flag: &'a str,
    band: Option<Band<'a>>,
}

/// Draws the lines that have points.
fn drawn(d: &Drawing<'_>) -> Result<Picture, PictureError> {
    let lines: Vec<&Line> = d.lines.iter().filter(|l| l.curves.iter().any(|c| !c.points.is_empty())).collect();
    let curves: Vec<Vec<Curve<'_>>> = lines
        .iter()
        .map(|l| l.curves.iter().map(|c| Curve { points: &c.points, flagged: &c.doubtful }).collect())
        .collect();
    let series: Vec<Series<'_>> =
        lines.iter().zip(&curves).map(|(l, curves)| Series { name: &l.name, curves }).collect();
    let (quantities, band) = (d.quantities, d.band);
    chart(&Chart { title: d.title, x: d.x, y: d.y, quantities, series: &series, flag: d.flag, guides: &[], band })
}
