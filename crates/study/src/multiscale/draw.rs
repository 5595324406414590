//! The pictures of the study.

use std::path::{Path, PathBuf};

use steklov_picture::{Band, Guide, PictureError};

use super::MultiscaleStudy;
use super::contrast::{PARTS, Stiff};
use super::convergence::Point;
use super::laminates::{LAMINATES, Layers};
use super::measure::{BASES, FITTED};
use super::rates::Rate;
use crate::chart::{Dots, Drawing, Line, Pictures, known, linear, log};
use crate::show::runs;

const DOFS: &str = "degrees of freedom N of the coarse cells";
const ERROR: &str = "relative error, energy norm";
const RATIO: &str = "estimate / error";
const WITHIN: Band<'static> = Band { label: "within 25 %", y: [0.8, 1.25] };

/// Draws errors, effectivities and cost into a folder; returns the files.
///
/// # Errors
/// When a picture cannot be drawn or written.
pub fn pictures(study: &MultiscaleStudy<'_>, folder: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let mut all = Pictures::new(folder);
    if !study.convergence.points.is_empty() {
        errors(study, &mut all)?;
        sizes(study, &mut all)?;
        effectivities(study, &mut all)?;
    }
    if study.fine_grid.error().is_finite() {
        cost(study, &mut all)?;
    }
    if !study.laminates.points.is_empty() {
        resonance(study, &mut all)?;
    }
    if !study.contrast.points.is_empty() {
        contrast(study, &mut all)?;
    }
    Ok(all.files)
}

/// One line for each basis with known values.
fn by_basis(study: &MultiscaleStudy<'_>, values: &[fn(&Point) -> [f64; 2]]) -> Vec<Line> {
    let curve = |basis: usize, value: &fn(&Point) -> [f64; 2]| known(study.convergence.of(basis).map(value));
    let line = |(k, (name, _)): (usize, &(&str, _))| Line::new(*name, values.iter().map(|v| curve(k, v)));
    BASES.iter().enumerate().map(line).filter(Line::is_drawn).collect()
}

fn errors(study: &MultiscaleStudy<'_>, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    let fine = study.fine_grid.error();
    // as narrow as a visible line
    let band = Band { label: &format!("error of the fine grid itself, {fine:.2e}"), y: [fine / 1.03, 1.03 * fine] };
    let drawing = Drawing {
        title: &format!("{}: multiscale elements against the fine grid", study.scene.title),
        axes: [log(DOFS), log(ERROR)],
        quantities: &["error", "estimate"],
        lines: by_basis(study, &[|p| [p.dofs as f64, p.error], |p| [p.dofs as f64, p.estimate]]),
        band: fine.is_finite().then_some(band),
        ..Drawing::default()
    };
    all.draw("error-dofs", &drawing)
}

/// Errors in both norms over the size of the coarse cells, with the fitted powers in the key.
fn sizes(study: &MultiscaleStudy<'_>, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    let spacing = study.fine_grid.truth.body.grid.spacing;
    let size = |p: &Point| [0, 1].map(|k| spacing[k] * p.fine[k] as f64).into_iter().fold(0.0, f64::max);
    let rates = study.rates();
    let line = |(basis, (name, _)): (usize, &(&str, _))| {
        let curve = |value: fn(&Point) -> f64| known(study.convergence.of(basis).map(|p| [size(p), value(p)]));
        let fitted = |r: &&Rate| r.over == 0 && r.basis == basis && r.rates.iter().all(|r| r.is_finite());
        let fitted = rates.iter().find(fitted).map(|r| format!(": H^{:.2}, H^{:.2}", r.rates[0], r.rates[1]));
        Line::new(format!("{name}{}", fitted.unwrap_or_default()), [curve(|p| p.error), curve(|p| p.displacement)])
    };
    let drawing = Drawing {
        title: &format!("{}: energy and L² norm of the error against the fine grid", study.scene.title),
        axes: [log("size H of the coarse cells"), log("relative error")],
        quantities: &["energy norm", "displacement, L² norm"],
        lines: BASES.iter().enumerate().map(line).filter(Line::is_drawn).collect(),
        guides: &[Guide { label: "H", slope: 1.0 }, Guide { label: "H²", slope: 2.0 }],
        ..Drawing::default()
    };
    all.draw("error-size", &drawing)
}

fn effectivities(study: &MultiscaleStudy<'_>, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    let drawing = Drawing {
        title: &format!("{}: effectivity of the estimate", study.scene.title),
        axes: [log(DOFS), linear(RATIO)],
        lines: by_basis(study, &[|p| [p.dofs as f64, p.effectivity()]]),
        band: Some(WITHIN),
        ..Drawing::default()
    };
    all.draw("effectivity", &drawing)
}

fn cost(study: &MultiscaleStudy<'_>, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    let fem = known(study.fine_grid.levels.iter().map(|l| [l.seconds, l.error]));
    let fem = Line::new("bilinear, finer and finer grids", [fem]);
    let multiscale = by_basis(study, &[|p| [p.seconds, p.total]]);
    let seconds = format!("seconds ({})", runs(study.repeat));
    let drawing = Drawing {
        title: &format!("{}: error against the limit of fine grids", study.scene.title),
        axes: [log(&seconds), log("relative error, energy norm, fine grid's included")],
        lines: [fem].into_iter().filter(Line::is_drawn).chain(multiscale).collect(),
        ..Drawing::default()
    };
    all.draw("error-seconds", &drawing)
}

/// Errors and effectivities over the period of layers and over the size of coarse cells: one line for each basis, the
/// two laminates solid and dashed.
fn resonance(study: &MultiscaleStudy<'_>, pictures: &mut Pictures<'_>) -> Result<(), PictureError> {
    let all = &study.laminates;
    let points = |over_periods: bool, laminate: usize, basis: usize| -> Vec<&Layers> {
        if over_periods {
            all.over_periods(laminate, basis).collect()
        } else {
            all.over_cells(laminate, basis).collect()
        }
    };
    for (over_periods, x, name) in
        [(true, "period ε of the layers", "resonance-period"), (false, "size H of the coarse cells", "resonance-cells")]
    {
        let width = |l: &Layers| 1.0 / if over_periods { l.periods } else { l.coarse } as f64;
        let lines = |value: fn(&Layers) -> f64| -> Vec<Line> {
            let curve = |laminate, basis| {
                known(points(over_periods, laminate, basis).into_iter().map(|l| [width(l), value(l)]))
            };
            let line = |(basis, (name, _)): (usize, &(&str, _))| {
                Line::new(*name, (0..LAMINATES.len()).map(|laminate| curve(laminate, basis)))
            };
            FITTED.iter().enumerate().map(line).filter(Line::is_drawn).collect()
        };
        let fixed = |l: &&Layers| match over_periods {
            true => format!("H = 1/{}", l.coarse),
            false => format!("ε = 1/{}", l.periods),
        };
        let fixed = |laminate| points(over_periods, laminate, 0).first().map_or(String::new(), fixed);
        let names: Vec<String> = (0..LAMINATES.len()).map(|k| format!("{}, {}", LAMINATES[k].0, fixed(k))).collect();
        let quantities: &[&str] = &names.iter().map(|n| &n[..]).collect::<Vec<_>>();
        let title = "Layers 1:10 on the unit square, 256 × 256 cells";
        let displacement = "relative error of the displacement, L² norm";
        let values: [fn(&Layers) -> f64; 2] = [|l| l.error, |l| l.displacement];
        for (value, (end, label)) in values.into_iter().zip([("", ERROR), ("-displacement", displacement)]) {
            let (axes, lines) = ([log(x), log(label)], lines(value));
            pictures
                .draw(&format!("{name}{end}"), &Drawing { title, axes, quantities, lines, ..Drawing::default() })?;
        }
        let (axes, lines, band) = ([log(x), linear(RATIO)], lines(|l| l.estimate / l.error), Some(WITHIN));
        let drawing = Drawing { title, axes, quantities, lines, band, ..Drawing::default() };
        pictures.draw(&format!("{name}-effectivity"), &drawing)?;
    }
    Ok(())
}

/// Errors of all bases, then effectivities of the coupled one, over the contrast: one line for each kind of stiff
/// parts.
fn contrast(study: &MultiscaleStudy<'_>, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    let curve = |part: usize, basis: usize, value: fn(&Stiff) -> f64| {
        let known = study.contrast.of(part, basis).filter(|s| value(s).is_finite());
        let (points, flagged) = known.map(|s| ([s.contrast, value(s)], s.warned())).unzip();
        Dots { points, flagged }
    };
    let lines = |curves: &dyn Fn(usize) -> Vec<Dots>| -> Vec<Line> {
        let line = |(part, (name, _)): (usize, &(&str, &str))| Line { name: (*name).to_owned(), curves: curves(part) };
        PARTS.iter().enumerate().map(line).filter(Line::is_drawn).collect()
    };
    let x = log("contrast of the moduli");
    let flag = "contrast along coarse edges: solve warns";
    let drawing = Drawing {
        title: "Plate with stiff parts, 8 × 4 coarse cells of 16 × 16",
        axes: [x, log(ERROR)],
        quantities: &FITTED.map(|c| c.0),
        lines: lines(&|part| (0..FITTED.len()).map(|basis| curve(part, basis, |s| s.error)).collect()),
        flag,
        ..Drawing::default()
    };
    all.draw("contrast-error", &drawing)?;
    let drawing = Drawing {
        title: "Plate with stiff parts, coupled basis: effectivity of two estimates",
        axes: [x, log(RATIO)],
        quantities: &["nodal residuals", "jumps of tractions"],
        lines: lines(&|part| vec![curve(part, 0, |s| s.nodal), curve(part, 0, |s| s.jump)]),
        flag,
        band: Some(WITHIN),
        ..Drawing::default()
    };
    all.draw("contrast-effectivity", &drawing)
}
