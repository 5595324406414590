//! The pictures of the study.

use std::path::{Path, PathBuf};

use steklov_picture::{Guide, PictureError};

use super::compare::SOLVERS;
use super::{ContactSolvers, Newton, Solvers};
use crate::chart::{Drawing, Line, Pictures, known, linear, log};

/// Largest number of iterations of a history that are drawn.
const DRAWN: usize = 40;
/// A measure of 0 is drawn at this value.
const FLOOR: f64 = 1e-17;

const DOFS: &str = "degrees of freedom N";

/// Draws the cost of the solvers and the convergence of the semi-smooth Newton method; returns the files.
///
/// # Errors
/// When a picture cannot be drawn or written.
pub fn pictures(study: &ContactSolvers<'_>, folder: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let mut all = Pictures::new(folder);
    if !study.solvers.methods.is_empty() {
        let title = |on: &str| format!("{}: contact solvers{on}", study.scene.title);
        iterations(&title(""), &study.solvers, &mut all)?;
        histories(&title, &study.solvers, &mut all)?;
    }
    if study.newton.iter().any(|newton| newton.iterates.len() > 1) {
        ratios(study, &mut all)?;
        orders(study, &mut all)?;
    }
    Ok(all.files)
}

/// ‖e_{k+1}‖/‖e_k‖ over k: it tends to 0 if the convergence is superlinear.
fn ratios(study: &ContactSolvers<'_>, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    let line = |newton: &Newton| {
        let points = newton.iterates.iter().map(|i| [i.number as f64, i.ratio]);
        Line::new(format!("{} elements", newton.elements), [known(points)])
    };
    let drawing = Drawing {
        title: &format!("{}: semi-smooth Newton", study.scene.title),
        axes: [linear("iterate k"), log("error of iterate k + 1 over that of k, energy norm")],
        lines: study.newton.iter().map(line).filter(Line::is_drawn).collect(),
        ..Drawing::default()
    };
    all.draw("newton-ratio", &drawing)
}

/// ‖e_{k+1}‖ over ‖e_k‖, beside the slopes of linear and quadratic convergence.
fn orders(study: &ContactSolvers<'_>, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    let line = |newton: &Newton| {
        let points = newton.iterates.iter().map(|i| [i.error, i.error * i.ratio]);
        Line::new(format!("{} elements", newton.elements), [known(points)])
    };
    let guides = [Guide { label: "linear", slope: 1.0 }, Guide { label: "quadratic", slope: 2.0 }];
    let drawing = Drawing {
        title: &format!("{}: semi-smooth Newton", study.scene.title),
        axes: [log("error of iterate k, relative, energy norm"), log("error of iterate k + 1")],
        lines: study.newton.iter().map(line).filter(Line::is_drawn).collect(),
        guides: &guides,
        ..Drawing::default()
    };
    all.draw("newton-order", &drawing)
}

/// Iterations over the unknowns.
pub(crate) fn iterations(title: &str, solvers: &Solvers, all: &mut Pictures<'_>) -> Result<(), PictureError> {
    let line = |(k, (name, _)): (usize, &(&str, _))| {
        Line::new(*name, [known(solvers.of(k).map(|m| [m.dofs as f64, m.iterations]))])
    };
    let drawing = Drawing {
        title,
        axes: [log(DOFS), log("iterations to 1e-10")],
        lines: SOLVERS.iter().enumerate().map(line).collect(),
        ..Drawing::default()
    };
    all.draw("solver-iterations", &drawing)
}

/// Measures by iteration on the finest mesh; `title` receives the description of that mesh.
pub(crate) fn histories(
    title: &dyn Fn(&str) -> String,
    solvers: &Solvers,
    all: &mut Pictures<'_>,
) -> Result<(), PictureError> {
    let line = |(k, (name, _)): (usize, &(&str, _))| {
        let history = solvers.finest().find(|m| m.solver == k).map_or(&[][..], |m| &m.history);
        // evenly spaced in the logarithm of the iteration
        let mut kept: Vec<usize> = (0..DRAWN)
            .map(|i| ((history.len() as f64).powf(i as f64 / (DRAWN - 1) as f64)).round() as usize)
            .filter(|n| (1..=history.len()).contains(n))
            .collect();
        kept.dedup();
        Line::new(*name, [kept.into_iter().map(|n| [n as f64, history[n - 1].max(FLOOR)]).collect()])
    };
    let elements = solvers.finest().next().map_or(0, |m| m.elements);
    let drawing = Drawing {
        title: &title(&format!(" on {elements} elements")),
        axes: [log("iteration"), log("the solver's own relative measure (0 as 1e-17)")],
        lines: SOLVERS.iter().enumerate().map(line).collect(),
        ..Drawing::default()
    };
    all.draw("solver-history", &drawing)
}
