//! The pictures of the study.

use std::path::{Path, PathBuf};

use steklov_figures::{positions, side_file};
use steklov_model::solve::contact_rows::ContactRow;
use steklov_picture::{Axis, PictureError};

use super::pairs::{PAIRS, Point};
use super::{InfSup, Pressure};
use crate::chart::{Drawing, Line, Pictures, linear, log};

/// Draws β over elements and over the degree, and the pressure along each contact side, into a folder; returns the files.
///
/// # Errors
/// When a picture cannot be drawn or written.
pub fn pictures(study: &InfSup<'_>, folder: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let mut all = Pictures::new(folder);
    let title = format!("{}: inf-sup constants", study.scene.title);
    for degree in study.degrees() {
        let lines = constants(study, |p| (p.degree == degree).then_some(p.elements as f64));
        if lines[0].curves[0].points.len() > 1 {
            let (title, x) = (format!("{title}, degree {degree}"), log("elements of the displacements"));
            all.draw(&format!("inf-sup-elements-{degree}"), &drawing(&title, x, lines))?;
        }
    }
    let coarsest = study.coarsest();
    let lines = constants(study, |p| (p.elements == coarsest).then_some(p.degree as f64));
    let (title, x) = (format!("{title}, {coarsest} elements"), linear("degree p of the displacements"));
    all.draw("inf-sup-degree", &drawing(&title, x, lines))?;
    let names = study.scene.problem.outline.side_names();
    for side in 0..names.len() {
        let of_side = |s: &'_ Pressure| s.rows.iter().filter(|r| r.side == side).copied().collect();
        let sides: Vec<(&Pressure, Vec<ContactRow>)> =
            study.pressures.solutions.iter().map(|s| (s, of_side(s))).collect();
        let sides: Vec<_> = sides.into_iter().filter(|(_, rows)| !rows.is_empty()).collect();
        if !sides.is_empty() {
            pressure(study, side, &sides, &mut all)?;
        }
    }
    Ok(all.files)
}

/// β of all pairs, at the points with an abscissa.
fn constants(study: &InfSup<'_>, x: impl Fn(&Point) -> Option<f64>) -> Vec<Line> {
    let of = |pair: usize, value: fn(&Point) -> f64| -> Vec<[f64; 2]> {
        study.of_pair(pair).filter_map(|p| Some([x(p)?, value(p)])).collect()
    };
    let line = |(k, pair): (usize, &super::Pair)| Line::new(pair.name, [of(k, |p| p.stabilised), of(k, |p| p.plain)]);
    PAIRS.iter().enumerate().map(line).collect()
}

fn drawing<'a>(title: &'a str, x: Axis<'a>, lines: Vec<Line>) -> Drawing<'a> {
    let axes = [x, linear("inf-sup constant")];
    Drawing { title, axes, quantities: &["stabilised", "not stabilised"], lines, ..Drawing::default() }
}

/// The pressures of a side.
fn pressure(
    study: &InfSup<'_>,
    side: usize,
    solutions: &[(&Pressure, Vec<ContactRow>)],
    all: &mut Pictures<'_>,
) -> Result<(), PictureError> {
    let names = study.scene.problem.outline.side_names();
    let along = |rows: &[ContactRow]| positions(&names[side], &rows.iter().collect::<Vec<_>>());
    let line = |(s, rows): &(&Pressure, Vec<ContactRow>)| {
        let points = along(rows).1.into_iter().zip(rows).map(|(s, r)| [s, r.pressure]);
        Line::new(format!("γ₀ = {:.0e} of the critical one", s.gamma / s.critical), [points.collect()])
    };
    let (x, _) = along(&solutions[0].1);
    let drawing = Drawing {
        title: &format!(
            "{}: pressure on {}, {} elements of degree {}, multipliers on halved ones",
            study.scene.title, names[side], study.pressures.elements, study.pressures.degree
        ),
        axes: [linear(&x), linear("pressure")],
        lines: solutions.iter().map(line).collect(),
        ..Drawing::default()
    };
    all.draw(&format!("pressure-{}", side_file(names, side)), &drawing)
}
