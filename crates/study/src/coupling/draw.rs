//! The pictures of the study.

use std::path::{Path, PathBuf};

use steklov_picture::{Axis, Band, Chart, Curve, Guide, Picture, PictureError, Scale, Series, chart, write};

use super::CouplingStudy;
use super::convergence::{FORMS, Point};
use super::cost::{Cost, WAYS};
use super::effectivity::{Indicated, TERMS};
use super::wrong::SYSTEMS;

/// A line of a chart: a name, and the points of each quantity.
struct Line {
    name: String,
    curves: Vec<Vec<[f64; 2]>>,
}

/// What a chart shows.
struct Drawing<'a> {
    title: &'a str,
    x: &'a str,
    y: &'a str,
    quantities: &'a [&'a str],
    lines: Vec<Line>,
    guides: &'a [Guide<'a>],
    band: Option<Band<'a>>,
}

/// Draws errors, cost and conditions into a folder; returns the files.
///
/// # Errors
/// When a picture cannot be drawn or written.
pub fn pictures(study: &CouplingStudy<'_>, folder: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let mut files = Vec::new();
    let mut draw = |name: &str, drawing: Drawing<'_>| -> Result<(), PictureError> {
        if drawing.lines.iter().any(|l| l.curves.iter().any(|c| !c.is_empty())) {
            files.extend(write(folder, name, &drawn(&drawing)?)?);
        }
        Ok(())
    };
    errors(study, &mut draw)?;
    effectivities(study, &mut draw)?;
    costs(study, &mut draw)?;
    conditions(study, &mut draw)?;
    Ok(files)
}

/// Draws one picture of a name.
type Draw<'a> = dyn FnMut(&str, Drawing<'_>) -> Result<(), PictureError> + 'a;

/// Errors over unknowns, cells and seconds.
fn errors(study: &CouplingStudy<'_>, draw: &mut Draw<'_>) -> Result<(), PictureError> {
    let title = &study.scene.title;
    let body = format!("{title}: the body, against a known solution");
    draw(
        "error-dofs",
        Drawing {
            title: &body,
            x: "displacement unknowns N of the body",
            y: ERROR,
            quantities: &BOTH,
            lines: by_pair(study, |p| [p.dofs as f64, p.error]),
            guides: &[rate("N^-1/2", -0.5)],
            band: None,
        },
    )?;
    draw(
        "error-cells",
        Drawing {
            title: &body,
            x: CELLS,
            y: ERROR,
            quantities: &BOTH,
            lines: by_pair(study, |p| [across(p.cells), p.error]),
            guides: &[rate("n^-1", -1.0)],
            band: None,
        },
    )?;
    draw(
        "traction-cells",
        Drawing {
            title: &format!("{title}: the traction of the medium"),
            x: CELLS,
            y: "error, norm of V, (force length/thickness)^½",
            quantities: &BOTH,
            lines: by_pair(study, |p| [across(p.cells), p.traction]),
            guides: &[rate("n^-1.5", -1.5), rate("n^-2", -2.0)],
            band: None,
        },
    )?;
    let own = study.pairs.len().saturating_sub(1);
    let form = |(form, (name, _)): (usize, &(&str, steklov_coupling::Form))| Line {
        name: (*name).to_owned(),
        curves: vec![study.convergence.of(own, form).map(|p| [p.seconds, p.error]).collect()],
    };
    draw(
        "error-seconds",
        Drawing {
            title: &format!("{title}: the body, {}", study.pairs[own].name),
            x: &format!("seconds of assembly, elimination and solution ({})", runs(study)),
            y: ERROR,
            quantities: &["error"],
            lines: FORMS.iter().enumerate().map(form).collect(),
            guides: &[],
            band: None,
        },
    )?;
    Ok(())
}

/// Indicators over errors.
fn effectivities(study: &CouplingStudy<'_>, draw: &mut Draw<'_>) -> Result<(), PictureError> {
    let title = &study.scene.title;
    let all = study.effectivity;
    let ratio = "indicators / error";
    let three_to_ten = Some(Band { label: "3 to 10", y: [3.0, 10.0] });
    draw(
        "effectivity-cells",
        Drawing {
            title: &format!("{title}: residual indicators"),
            x: CELLS,
            y: ratio,
            quantities: &BOTH,
            lines: named(study, |pair| {
                [0, 1].map(|form| all.of(pair, form).map(|i| [across(i.cells), i.whole]).collect()).to_vec()
            }),
            guides: &[],
            band: three_to_ten,
        },
    )?;
    draw(
        "effectivity-terms",
        Drawing {
            title: &format!("{title}: residual indicators by term, two-field form"),
            x: CELLS,
            y: ratio,
            quantities: &TERMS[..4],
            lines: named(study, |pair| {
                (0..4).map(|k| all.of(pair, 0).map(|i| [across(i.cells), i.terms[k]]).collect()).collect()
            }),
            guides: &[],
            band: None,
        },
    )?;
    let [x, y] = all.contrasts.first().map_or([0; 2], |i| i.cells);
    let over = |name: &str, value: &dyn Fn(&Indicated) -> f64| Line {
        name: name.to_owned(),
        // two fields have no equation with W
        curves: [0, 1]
            .map(|form| {
                let points = all.over_contrast(form).map(|i| [i.contrast, value(i)]);
                points.filter(|p| p[1].is_finite()).collect()
            })
            .to_vec(),
    };
    let whole = over("all terms", &|i| i.whole);
    let terms = TERMS.iter().enumerate().map(|(k, name)| over(name, &|i| i.terms[k]));
    draw(
        "effectivity-contrast",
        Drawing {
            title: &format!("{title}: residual indicators, {x} by {y} cells"),
            x: "E of the body / E of the medium",
            y: ratio,
            quantities: &BOTH,
            lines: [whole].into_iter().chain(terms).collect(),
            guides: &[],
            band: three_to_ten,
        },
    )?;
    Ok(())
}

/// Seconds and entries of the ways to solve.
fn costs(study: &CouplingStudy<'_>, draw: &mut Draw<'_>) -> Result<(), PictureError> {
    let title = &study.scene.title;
    for (name, y, seconds) in [
        ("cost-seconds", &format!("seconds ({})", runs(study))[..], true),
        ("cost-entries", "entries of factors and dense matrices", false),
    ] {
        let value = |way: usize| move |c: &Cost| if seconds { c.seconds[way] } else { c.entries[way] };
        let mut lines: Vec<Line> = WAYS.iter().enumerate().map(|(way, name)| cost(study, name, value(way))).collect();
        if seconds {
            lines.push(cost(study, "S alone, part of each", |c| c.steklov));
        }
        draw(
            name,
            Drawing {
                title: &format!("{title}: from the matrices to the displacements"),
                x: "displacement unknowns N of the body",
                y,
                quantities: &["cost"],
                lines,
                guides: if seconds { &[GROWTH, LINEAR] } else { &[LINEAR] },
                band: None,
            },
        )?;
    }
    Ok(())
}

/// The condition of the three-field form, and what does not converge.
fn conditions(study: &CouplingStudy<'_>, draw: &mut Draw<'_>) -> Result<(), PictureError> {
    let title = &study.scene.title;
    let condition = |pair: usize| {
        let points = || study.conditioning.of(pair);
        let three = points().map(|c| [across(c.cells), c.three]).collect();
        // what is 0 or nearly 0 is seen at the lower end of the band
        vec![three, points().map(|c| [across(c.cells), c.two.max(ROUNDING[0])]).collect()]
    };
    draw(
        "conditioning",
        Drawing {
            title: &format!("{title}: condition of the three-field matrix"),
            x: CELLS,
            y: "smallest / largest eigenvalue, by magnitude",
            quantities: &["three motions removed", "translations only"],
            lines: named(study, condition),
            guides: &[],
            band: Some(Band { label: "rounding, 2⁻⁵² and less", y: ROUNDING }),
        },
    )?;
    let system = |(system, name): (usize, &&str)| Line {
        name: (*name).to_owned(),
        curves: vec![study.wrongs.of(system).map(|w| [across(w.cells), w.error]).collect()],
    };
    draw(
        "wrong-signs",
        Drawing {
            title: &format!("{title}: what must not be done, {}", study.pairs[0].name),
            x: CELLS,
            y: ERROR,
            quantities: &["error"],
            lines: SYSTEMS.iter().enumerate().map(system).collect(),
            guides: &[rate("n^-1", -1.0)],
            band: None,
        },
    )?;
    Ok(())
}

/// How often each run was made.
fn runs(study: &CouplingStudy<'_>) -> String {
    if study.repeat > 1 { format!("median of {} runs", study.repeat) } else { "one run".into() }
}

fn rate(label: &'static str, slope: f64) -> Guide<'static> {
    Guide { label, slope }
}

const ERROR: &str = "error, energy norm, (force length/thickness)^½";
/// What no digit can be told of.
const ROUNDING: [f64; 2] = [1e-18, f64::EPSILON];
const CELLS: &str = "cells n along the shorter side of the body";
const BOTH: [&str; 2] = ["two-field, Schur", "three-field"];
const GROWTH: Guide<'static> = Guide { label: "N^3/2", slope: 1.5 };
const LINEAR: Guide<'static> = Guide { label: "N", slope: 1.0 };

/// Cells along the shorter side.
fn across(cells: [usize; 2]) -> f64 {
    cells[0].min(cells[1]) as f64
}

/// A line a pair.
fn named(study: &CouplingStudy<'_>, curves: impl Fn(usize) -> Vec<Vec<[f64; 2]>>) -> Vec<Line> {
    study.pairs.iter().enumerate().map(|(k, pair)| Line { name: pair.name.clone(), curves: curves(k) }).collect()
}

/// A line a pair: the two-field form, of which the Schur form has the errors, and the three-field form.
fn by_pair(study: &CouplingStudy<'_>, value: fn(&Point) -> [f64; 2]) -> Vec<Line> {
    named(study, |pair| [0, 2].map(|form| study.convergence.of(pair, form).map(value).collect()).to_vec())
}

/// A line of the cost.
fn cost(study: &CouplingStudy<'_>, name: &str, value: impl Fn(&Cost) -> f64) -> Line {
    let points = study.costs.points.iter().map(|c| [c.dofs as f64, value(c)]).collect();
    Line { name: name.to_owned(), curves: vec![points] }
}

/// Draws on logarithmic axes.
fn drawn(d: &Drawing<'_>) -> Result<Picture, PictureError> {
    let curves: Vec<Vec<Curve<'_>>> =
        d.lines.iter().map(|l| l.curves.iter().map(|points| Curve { points, flagged: &[] }).collect()).collect();
    let series: Vec<Series<'_>> =
        d.lines.iter().zip(&curves).map(|(l, curves)| Series { name: &l.name, curves }).collect();
    let [x, y] = [d.x, d.y].map(|label| Axis { label, scale: Scale::Log });
    let (title, quantities, guides, band) = (d.title, d.quantities, d.guides, d.band);
    chart(&Chart { title, x, y, quantities, series: &series, flag: "", guides, band })
}
