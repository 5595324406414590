//! The pictures of the study.

use std::path::{Path, PathBuf};

use steklov_picture::{Band, PictureError};

use super::Stochastic;
use super::chance::Measured;
use super::rules::{FAMILIES, Family};
use super::space::{CURVES, Point};
use crate::chart::{Drawing, Line, Pictures, known, log};
use crate::solvers;

const DOFS: &str = "degrees of freedom N";
const SECONDS: &str = "seconds";

/// Draws errors in chance, errors in space and the solvers into a folder; returns the files.
///
/// # Errors
/// When a picture cannot be drawn or written.
pub fn pictures(study: &Stochastic<'_>, folder: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let mut all = Pictures::new(folder);
    for quantity in study.chance.shown() {
        for (which, what) in [(0, "mean"), (1, "variance")] {
            // on grids outcomes of coarse grids, and of one system for all, do not count alike
            if !study.scene.is_on_grid() {
                in_chance(study, quantity, (which, what), ("", "outcomes solved", |m| m.solves as f64), &mut all)?;
            }
            in_chance(study, quantity, (which, what), ("-seconds", SECONDS, |m| m.seconds), &mut all)?;
        }
    }
    if study.space.reference.is_some() {
        for (which, names) in [(0, ["space-energy", "E[J]"]), (1, ["space-norm", "E[<u, Su>]"])] {
            in_space(study, which, names, ("", DOFS, |p| p.dofs as f64), &mut all)?;
            in_space(study, which, names, ("-seconds", SECONDS, |p| p.deterministic + p.seconds), &mut all)?;
        }
    }
    if let Some(solvers) = study.solvers.as_ref().filter(|s| !s.methods.is_empty()) {
        let title = |on: &str| format!("{}: contact solvers{on}, nominal outcome", study.scene.title);
        solvers::iterations(&title(""), solvers, &mut all)?;
        solvers::histories(&title, solvers, &mut all)?;
    }
    Ok(all.files)
}

/// The abscissa of errors: the end of the file's name, the label, and the value.
type Cost<T> = (&'static str, &'static str, fn(&T) -> f64);

/// Errors of mean (0) or variance (1) by all rules; standard errors if there are any.
fn in_chance(
    study: &Stochastic<'_>,
    quantity: usize,
    (which, what): (usize, &str),
    (end, label, cost): Cost<Measured>,
    all: &mut Pictures<'_>,
) -> Result<(), PictureError> {
    let chance = &study.chance;
    let of = |family: usize, value: &dyn Fn(&Measured) -> f64| {
        known(chance.of(family, quantity).map(|m| [cost(m), value(m)]))
    };
    let line = |(k, family): (usize, &Family)| {
        Line::new(family.name, [of(k, &|m| m.errors[which]), of(k, &|m| m.standard_errors[which])])
    };
    let mut lines: Vec<Line> = FAMILIES.iter().enumerate().map(line).filter(Line::is_drawn).collect();
    let both = lines.iter().any(|l| !l.curves[1].points.is_empty());
    let quantities = &["error", "standard error"][..if both { 2 } else { 1 }];
    lines.iter_mut().for_each(|l| l.curves.truncate(quantities.len()));
    let name = &chance.quantities[quantity].name;
    let error = format!("relative error of the {what} of {name}");
    // an error is known no better than the reference, in sight where the smallest one is not far from that
    let off = chance.quantities[quantity].uncertainty[which];
    let errors = chance.points.iter().filter(|m| m.quantity == quantity && m.errors[which] > 0.0);
    let smallest = errors.map(|m| m.errors[which]).fold(f64::INFINITY, f64::min);
    let label_of_band = format!("the reference may be off by {off:.0e}");
    let band = (off > 0.1 * smallest).then_some(Band { label: &label_of_band, y: [off.min(smallest) / 1.5, off] });
    let drawing = Drawing {
        title: &format!("{}: {what} of {name} by rules in chance", study.scene.title),
        axes: [log(label), log(&error)],
        quantities,
        lines,
        band,
        ..Drawing::default()
    };
    all.draw(&format!("{what}-{}{end}", name.replace('.', "-")), &drawing)
}

/// Errors of the mean of J (0) or of ⟨u, Su⟩ (1) by all strategies.
fn in_space(
    study: &Stochastic<'_>,
    which: usize,
    [file, symbol]: [&str; 2],
    (end, label, cost): Cost<Point>,
    all: &mut Pictures<'_>,
) -> Result<(), PictureError> {
    let space = &study.space;
    let line = |(k, (curve, ..)): (usize, &(&str, _, _, _))| {
        let name = match space.law(k, which).filter(|_| end.is_empty()) {
            Some(fit) => format!("{curve}: {}", fit.law.with_rate(fit.rate)),
            None => (*curve).to_owned(),
        };
        Line::new(name, [known(space.of(k).map(|p| [cost(p), p.errors[which]]))])
    };
    let error = format!("relative error of {symbol}");
    let drawing = Drawing {
        title: &format!("{}: {symbol} by strategies in space", study.scene.title),
        axes: [log(label), log(&error)],
        lines: CURVES.iter().enumerate().map(line).filter(Line::is_drawn).collect(),
        ..Drawing::default()
    };
    all.draw(&format!("{file}{end}"), &drawing)
}
