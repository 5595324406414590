//! The pictures of the study.

use std::path::{Path, PathBuf};

use steklov_picture::{Band, Guide, PictureError};

use super::CouplingStudy;
use super::convergence::{FORMS, Point};
use super::cost::{Cost, WAYS};
use super::effectivity::{Indicated, TERMS};
use super::own_loads::{ELEMENTS, Own};
use super::wrong::SYSTEMS;
use crate::chart::{Drawing, Line, Pictures, known, log};
use crate::show::runs;

const DOFS: &str = "displacement unknowns N of the body";
const ERROR: &str = "error, energy norm, (force length/thickness)^½";
const RATIO: &str = "indicators / error";
/// Values without a significant digit.
const ROUNDING: [f64; 2] = [1e-18, f64::EPSILON];
const CELLS: &str = "cells n along the shorter side of the body";
const BOTH: [&str; 2] = ["two-field, Schur", "three-field"];
const THREE_TO_TEN: Band<'static> = Band { label: "3 to 10", y: [3.0, 10.0] };

/// Draws errors, cost and conditions into a folder; returns the files.
///
/// # Errors
/// When a picture cannot be drawn or written.
pub fn pictures(study: &CouplingStudy<'_>, folder: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let mut all = Pictures::new(folder);
    errors(study, &mut all)?;
    effectivities(study, &mut all)?;
    costs(study, &mut all)?;
    conditions(study, &mut all)?;
    own_loads(study, &mut all)?;
    Ok(all.files)
}

/// Draws a picture that has points, both axes logarithmic.
fn draw(
    study: &CouplingStudy<'_>,
    all: &mut Pictures<'_>,
    name: &str,
    [title, x, y]: [&str; 3],
    rest: Drawing<'_>,
) -> Result<(), PictureError> {
    if !rest.lines.iter().any(Line::is_drawn) {
        return Ok(());
    }
    let title = &format!("{}: {title}", study.scene.title);
    all.draw(name, &Drawing { title, axes: [log(x), log(y)], ..rest })
}

/// Errors over unknowns, cells and seconds.
fn errors(study: &CouplingStudy<'_>, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    let body = "the body, against a known solution";
    let by_dofs = by_pair(study, |p| [p.dofs as f64, p.error]);
    let guides = &[rate("N^-1/2", -0.5)];
    draw(study, all, "error-dofs", [body, DOFS, ERROR], Drawing { guides, ..two(by_dofs) })?;
    let by_cells = by_pair(study, |p| [across(p.cells), p.error]);
    let guides = &[rate("n^-1", -1.0)];
    draw(study, all, "error-cells", [body, CELLS, ERROR], Drawing { guides, ..two(by_cells) })?;
    let tractions = by_pair(study, |p| [across(p.cells), p.traction]);
    let guides = &[rate("n^-1.5", -1.5), rate("n^-2", -2.0)];
    let labels = ["the traction of the medium", CELLS, "error, norm of V, (force length/thickness)^½"];
    draw(study, all, "traction-cells", labels, Drawing { guides, ..two(tractions) })?;
    let own = study.pairs.len().saturating_sub(1);
    let form = |(form, (name, _)): (usize, &(&str, _))| {
        Line::new(*name, [study.convergence.of(own, form).map(|p| [p.seconds, p.error]).collect()])
    };
    let lines = FORMS.iter().enumerate().map(form).collect();
    let title = &format!("the body, {}", study.pairs[own].name);
    let seconds = &format!("seconds of assembly, elimination and solution ({})", runs(study.repeat));
    draw(study, all, "error-seconds", [title, seconds, ERROR], Drawing { lines, ..Drawing::default() })
}

/// Indicators over errors.
fn effectivities(study: &CouplingStudy<'_>, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    let indicated = &study.effectivity;
    let whole = |pair| {
        [0, 1].map(|form| indicated.of(pair, form).map(|i| [across(i.cells), i.whole]).collect::<Vec<_>>()).to_vec()
    };
    let band = Some(THREE_TO_TEN);
    let lines = named(study, whole);
    draw(study, all, "effectivity-cells", ["residual indicators", CELLS, RATIO], Drawing { band, ..two(lines) })?;
    let by_term = |pair| {
        let term = |k: usize| indicated.of(pair, 0).map(|i| [across(i.cells), i.terms[k]]).collect::<Vec<_>>();
        (0..4).map(term).collect()
    };
    let labels = ["residual indicators by term, two-field form", CELLS, RATIO];
    let by_term = Drawing { lines: named(study, by_term), quantities: &TERMS[..4], ..Drawing::default() };
    draw(study, all, "effectivity-terms", labels, by_term)?;
    let [x, y] = indicated.contrasts.first().map_or([0; 2], |i| i.cells);
    let over = |name: &str, value: &dyn Fn(&Indicated) -> f64| {
        // the two-field form has no equation with W
        let finite = |form| known(indicated.over_contrast(form).map(|i| [i.contrast, value(i)]));
        Line::new(name, [0, 1].map(finite))
    };
    let whole = over("all terms", &|i| i.whole);
    let terms = TERMS.iter().enumerate().map(|(k, name)| over(name, &|i| i.terms[k]));
    let lines = [whole].into_iter().chain(terms).collect();
    let title = &format!("residual indicators, {x} by {y} cells");
    let labels = [title, "E of the body / E of the medium", RATIO];
    draw(study, all, "effectivity-contrast", labels, Drawing { band, ..two(lines) })
}

/// Seconds and entries of the ways to solve.
fn costs(study: &CouplingStudy<'_>, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    let over_dofs = |name: &str, value: &dyn Fn(&Cost) -> f64| {
        Line::new(name, [study.costs.points.iter().map(|c| [c.dofs as f64, value(c)]).collect()])
    };
    let by_way = |value: fn(&Cost) -> [f64; 3]| {
        WAYS.iter().enumerate().map(|(way, name)| over_dofs(name, &|c| value(c)[way])).collect::<Vec<_>>()
    };
    let title = "from the matrices to the displacements";
    let mut lines = by_way(|c| c.seconds);
    lines.push(over_dofs("S alone, part of each", &|c| c.steklov));
    let guides = &[rate("N^3/2", 1.5), rate("N", 1.0)];
    let seconds = &format!("seconds ({})", runs(study.repeat));
    let drawing = Drawing { lines, guides, ..Drawing::default() };
    draw(study, all, "cost-seconds", [title, DOFS, seconds], drawing)?;
    let entries = "entries of factors and dense matrices";
    let drawing = Drawing { lines: by_way(|c| c.entries), guides: &guides[1..], ..Drawing::default() };
    draw(study, all, "cost-entries", [title, DOFS, entries], drawing)
}

/// The condition of the three-field form, and the systems that do not converge.
fn conditions(study: &CouplingStudy<'_>, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    let condition = |pair| {
        let points = || study.conditioning.of(pair);
        let three = points().map(|c| [across(c.cells), c.three]).collect();
        // values that are 0 or nearly 0 are drawn at the lower end of the band
        vec![three, points().map(|c| [across(c.cells), c.two.max(ROUNDING[0])]).collect()]
    };
    let quantities = &["three motions removed", "translations only"];
    let band = Some(Band { label: "rounding, 2⁻⁵² and less", y: ROUNDING });
    let labels = ["condition of the three-field matrix", CELLS, "smallest / largest eigenvalue, by magnitude"];
    let lines = named(study, condition);
    draw(study, all, "conditioning", labels, Drawing { quantities, lines, band, ..Drawing::default() })?;
    let system = |(system, name): (usize, &&str)| {
        Line::new(*name, [study.wrongs.of(system).map(|w| [across(w.cells), w.error]).collect()])
    };
    let lines = SYSTEMS.iter().enumerate().map(system).collect();
    let guides = &[rate("n^-1", -1.0)];
    let title = &format!("what must not be done, {}", study.pairs[0].name);
    draw(study, all, "wrong-signs", [title, CELLS, ERROR], Drawing { lines, guides, ..Drawing::default() })
}

/// Errors with the scene's own loads over H and h, their parts, and effectivities of the residual estimator.
fn own_loads(study: &CouplingStudy<'_>, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    const H: &str = "size H of the coarse cells";
    const OWN: &str = "relative error of body and medium";
    let curve =
        |over, elements, value: fn(&Own) -> f64| known(study.own_loads.of(over, elements).map(|p| [p.width, value(p)]));
    let lines = |over, values: &[fn(&Own) -> f64]| -> Vec<Line> {
        let line = |(k, (name, _)): (usize, &(&str, _))| Line::new(*name, values.iter().map(|v| curve(over, k, *v)));
        ELEMENTS.iter().enumerate().map(line).filter(Line::is_drawn).collect()
    };
    let quantities = &["error", "residual estimator"];
    let labels = ["own loads, multiscale against bilinear elements", H, OWN];
    let over_h = lines(0, &[Own::error, |p| p.residual]);
    let guides = &[rate("H", 1.0)];
    draw(study, all, "own-error-coarse", labels, Drawing { quantities, lines: over_h, guides, ..Drawing::default() })?;
    let labels = ["own loads, error against the limit of fine grids", "size h of the fine cells", OWN];
    let over_fine = lines(
        1,
        &[
            |p| if p.elements == 0 { p.error() } else { p.total },
            |p| if p.elements == 0 { p.residual } else { f64::NAN },
        ],
    );
    let guides = &[rate("h", 1.0)];
    draw(study, all, "own-error-fine", labels, Drawing { quantities, lines: over_fine, guides, ..Drawing::default() })?;
    let parts: [fn(&Own) -> f64; 3] = [|p| p.errors[0], |p| p.errors[1], |p| p.errors[2]];
    let part = |over, k: usize, name: &str| Line::new(name, parts.iter().map(|v| curve(over, k, *v)));
    let lines_of =
        vec![part(0, 3, "coupled, over H"), part(0, 4, "oscillatory, over H"), part(1, 0, "bilinear, over h")];
    let quantities = &["body, energy norm", "displacement, norm of W", "traction, norm of V"];
    let labels = ["own loads, errors of body and medium", "size of the cells, H or h", OWN];
    draw(study, all, "own-parts", labels, Drawing { quantities, lines: lines_of, ..Drawing::default() })?;
    let residual = |over, k: usize, name: &str| Line::new(name, [curve(over, k, Own::effectivity)]);
    let lines = vec![
        residual(0, 3, "coupled, over H"),
        residual(0, 4, "oscillatory, over H"),
        residual(1, 0, "bilinear, over h"),
    ];
    let labels =
        ["own loads, residual estimator over error", "size of the cells, H or h", "residual estimator / error"];
    draw(study, all, "own-effectivity", labels, Drawing { lines, ..Drawing::default() })
}

/// Lines of the two-field and of the three-field form.
fn two(lines: Vec<Line>) -> Drawing<'static> {
    Drawing { quantities: &BOTH, lines, ..Drawing::default() }
}

fn rate(label: &'static str, slope: f64) -> Guide<'static> {
    Guide { label, slope }
}

/// Cells along the shorter side.
fn across(cells: [usize; 2]) -> f64 {
    cells[0].min(cells[1]) as f64
}

/// One line for each pair.
fn named(study: &CouplingStudy<'_>, curves: impl Fn(usize) -> Vec<Vec<[f64; 2]>>) -> Vec<Line> {
    study.pairs.iter().enumerate().map(|(k, pair)| Line::new(&pair.name, curves(k))).collect()
}

/// One line for each pair: the two-field form, which has the same errors as the Schur form, and the three-field form.
fn by_pair(study: &CouplingStudy<'_>, value: fn(&Point) -> [f64; 2]) -> Vec<Line> {
    named(study, |pair| [0, 2].map(|form| study.convergence.of(pair, form).map(value).collect()).to_vec())
}
