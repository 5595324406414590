//! The pictures of the study.

use std::path::{Path, PathBuf};

use steklov_picture::{Axis, Chart, Curve, Picture, PictureError, Scale, Series, chart, write};

use super::chance::Measured;
use super::rules::FAMILIES;
use super::solvers::SOLVERS;
use super::space::CURVES;
use super::{Solvers, Stochastic};

/// Iterations of a history that are drawn at most.
const DRAWN: usize = 40;
/// A measure of 0 is drawn here.
const FLOOR: f64 = 1e-17;

/// A line of a chart: a name and the points of its curves.
type Line = (String, Vec<Vec<[f64; 2]>>);

/// Draws errors in chance, errors in space and the solvers into a folder; returns the files.
///
/// # Errors
/// When a picture cannot be drawn or written.
pub fn pictures(study: &Stochastic<'_>, folder: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let mut files = Vec::new();
    let mut draw = |name: &str, picture: Picture| -> Result<(), PictureError> {
        files.extend(write(folder, name, &picture)?);
        Ok(())
    };
    let chance = study.chance;
    for quantity in chance.shown() {
        let name = &chance.quantities[quantity].name;
        for (k, what) in ["mean", "variance"].into_iter().enumerate() {
            draw(&format!("{what}-{}", name.replace('.', "-")), in_chance(study, quantity, k, what)?)?;
        }
    }
    if study.space.reference.is_some() {
        for (which, name, symbol) in [(0, "space-energy", "E[J]"), (1, "space-norm", "E[<u, Su>]")] {
            draw(name, in_space(study, which, symbol)?)?;
        }
    }
    if let Some(solvers) = study.solvers.filter(|s| !s.methods.is_empty()) {
        draw("solver-iterations", iterations(study, solvers)?)?;
        draw("solver-history", histories(study, solvers)?)?;
    }
    Ok(files)
}

/// Errors of mean (0) or variance (1) by all rules.
fn in_chance(study: &Stochastic<'_>, quantity: usize, which: usize, what: &str) -> Result<Picture, PictureError> {
    let chance = study.chance;
    let of = |family: usize, value: &dyn Fn(&Measured) -> f64| -> Vec<[f64; 2]> {
        let all = chance.of(family, quantity).map(|m| [m.solves as f64, value(m)]);
        all.filter(|p| p[1].is_finite()).collect()
    };
    let line = |family: usize| -> Line {
        let curves = vec![of(family, &|m| m.errors[which]), of(family, &|m| m.standard_errors[which])];
        (FAMILIES[family].0.to_owned(), curves)
    };
    let lines: Vec<Line> = (0..FAMILIES.len()).map(line).filter(|l| l.1.iter().any(|c| !c.is_empty())).collect();
    let name = &chance.quantities[quantity].name;
    drawn(
        &format!("{}: {what} of {name} by rules in chance", study.scene.title),
        Axis { label: "outcomes solved", scale: Scale::Log },
        Axis { label: &format!("relative error of the {what} of {name}"), scale: Scale::Log },
        &["error", "standard error"],
        &lines,
    )
}

fn in_space(study: &Stochastic<'_>, which: usize, symbol: &str) -> Result<Picture, PictureError> {
    let space = study.space;
    let line = |k: usize| -> Line {
        let name = match space.law(k, which) {
            Some(fit) => format!("{}: {}", CURVES[k].0, fit.law.with_rate(fit.rate)),
            None => CURVES[k].0.to_owned(),
        };
        let known = space.of(k).filter(|p| p.errors[which].is_finite());
        (name, vec![known.map(|p| [p.dofs as f64, p.errors[which]]).collect()])
    };
    let lines: Vec<Line> = (0..CURVES.len()).map(line).filter(|l| !l.1[0].is_empty()).collect();
    drawn(
        &format!("{}: {symbol} by strategies in space", study.scene.title),
        Axis { label: "degrees of freedom N", scale: Scale::Log },
        Axis { label: &format!("relative error of {symbol}"), scale: Scale::Log },
        &["error"],
        &lines,
    )
}

fn iterations(study: &Stochastic<'_>, solvers: &Solvers) -> Result<Picture, PictureError> {
    let line = |k: usize| -> Line {
        let known = solvers.of(k).filter(|m| m.iterations.is_finite());
        (SOLVERS[k].0.to_owned(), vec![known.map(|m| [m.dofs as f64, m.iterations]).collect()])
    };
    let lines: Vec<Line> = (0..SOLVERS.len()).map(line).collect();
    drawn(
        &format!("{}: contact solvers, nominal outcome", study.scene.title),
        Axis { label: "degrees of freedom N", scale: Scale::Log },
        Axis { label: "iterations to 1e-10", scale: Scale::Log },
        &["iterations"],
        &lines,
    )
}

fn histories(study: &Stochastic<'_>, solvers: &Solvers) -> Result<Picture, PictureError> {
    let line = |(k, name): (usize, &str)| -> Line {
        let all = solvers.finest().find(|m| m.solver == k).map_or(&[][..], |m| &m.history);
        // evenly spaced in the logarithm of the iteration
        let mut kept: Vec<usize> = (0..DRAWN)
            .map(|i| ((all.len() as f64).powf(i as f64 / (DRAWN - 1) as f64)).round() as usize)
            .filter(|n| (1..=all.len()).contains(n))
            .collect();
        kept.dedup();
        (name.to_owned(), vec![kept.into_iter().map(|n| [n as f64, all[n - 1].max(FLOOR)]).collect()])
    };
    let lines: Vec<Line> = SOLVERS.iter().map(|s| s.0).enumerate().map(line).collect();
    let elements = solvers.finest().next().map_or(0, |m| m.elements);
    drawn(
        &format!("{}: contact solvers on {elements} elements, nominal outcome", study.scene.title),
        Axis { label: "iteration", scale: Scale::Log },
        Axis { label: "the solver's own relative measure (0 as 1e-17)", scale: Scale::Log },
        &["measure"],
        &lines,
    )
}

fn drawn(title: &str, x: Axis<'_>, y: Axis<'_>, quantities: &[&str], lines: &[Line]) -> Result<Picture, PictureError> {
    let used = lines.iter().flat_map(|l| l.1.iter().enumerate()).filter(|(_, c)| !c.is_empty());
    let quantities = &quantities[..used.map(|(k, _)| k + 1).max().unwrap_or(1)];
    let curves: Vec<Vec<Curve<'_>>> = lines
        .iter()
        .map(|l| l.1[..quantities.len()].iter().map(|points| Curve { points, flagged: &[] }).collect())
        .collect();
    let series: Vec<Series<'_>> =
        lines.iter().zip(&curves).map(|((name, _), curves)| Series { name, curves }).collect();
    chart(&Chart { title, x, y, quantities, series: &series, flag: "", guides: &[], band: None })
}
