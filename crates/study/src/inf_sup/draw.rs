//! The pictures of the study.

use std::path::{Path, PathBuf};

use steklov_figures::{positions, side_file};
use steklov_model::report::ContactRow;
use steklov_picture::{Axis, Chart, Curve, Picture, PictureError, Scale, Series, chart, write};

use super::pairs::{PAIRS, Point};
use super::{InfSup, Pressure};

/// Draws β over elements and over the degree, and the pressure along each contact side, into a folder; returns the files.
///
/// # Errors
/// When a picture cannot be drawn or written.
pub fn pictures(study: &InfSup<'_>, folder: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let mut files = Vec::new();
    let mut draw = |name: &str, picture: Picture| -> Result<(), PictureError> {
        files.extend(write(folder, name, &picture)?);
        Ok(())
    };
    let elements = Axis { label: "elements of the displacements", scale: Scale::Log };
    for degree in study.degrees() {
        let some = |p: &Point| p.degree == degree;
        if study.of_pair(0).filter(|p| some(p)).count() > 1 {
            let title = format!("{}: inf-sup constants, degree {degree}", study.scene.title);
            let picture = constants(study, &title, elements, &some, |p| p.elements as f64)?;
            draw(&format!("inf-sup-elements-{degree}"), picture)?;
        }
    }
    let coarsest = study.coarsest();
    let title = format!("{}: inf-sup constants, {coarsest} elements", study.scene.title);
    let degree = Axis { label: "degree p of the displacements", scale: Scale::Linear };
    draw("inf-sup-degree", constants(study, &title, degree, &|p| p.elements == coarsest, |p| p.degree as f64)?)?;
    let names = study.scene.body().outline.side_names();
    for side in 0..names.len() {
        let sides: Vec<(&Pressure, Vec<&ContactRow>)> = study
            .pressures
            .solutions
            .iter()
            .map(|s| (s, s.rows.iter().filter(|r| r.side == side).collect()))
            .filter(|(_, rows): &(_, Vec<_>)| !rows.is_empty())
            .collect();
        if !sides.is_empty() {
            draw(&format!("pressure-{}", side_file(names, side)), pressure(study, &names[side], &sides)?)?;
        }
    }
    Ok(files)
}

/// β of all pairs at some of the points.
fn constants(
    study: &InfSup<'_>,
    title: &str,
    x: Axis<'_>,
    some: &dyn Fn(&Point) -> bool,
    abscissa: fn(&Point) -> f64,
) -> Result<Picture, PictureError> {
    let of = |pair: usize, value: fn(&Point) -> f64| -> Vec<[f64; 2]> {
        study.of_pair(pair).filter(|p| some(p)).map(|p| [abscissa(p), value(p)]).collect()
    };
    let points: Vec<[Vec<[f64; 2]>; 2]> =
        (0..PAIRS.len()).map(|k| [of(k, |p| p.stabilised), of(k, |p| p.plain)]).collect();
    let curves: Vec<[Curve<'_>; 2]> =
        points.iter().map(|both| both.each_ref().map(|points| Curve { points, flagged: &[] })).collect();
    let series: Vec<Series<'_>> =
        PAIRS.iter().zip(&curves).map(|(pair, curves)| Series { name: pair.name, curves }).collect();
    chart(&Chart {
        title,
        x,
        y: Axis { label: "inf-sup constant", scale: Scale::Linear },
        quantities: &["stabilised", "not stabilised"],
        series: &series,
        flag: "",
        guides: &[],
        band: None,
    })
}

/// The pressures of a side.
fn pressure(
    study: &InfSup<'_>,
    side: &str,
    solutions: &[(&Pressure, Vec<&ContactRow>)],
) -> Result<Picture, PictureError> {
    let (label, _) = positions(side, &solutions[0].1);
    let points: Vec<Vec<[f64; 2]>> = solutions
        .iter()
        .map(|(_, rows)| positions(side, rows).1.into_iter().zip(rows).map(|(s, r)| [s, r.pressure]).collect())
        .collect();
    let curves: Vec<[Curve<'_>; 1]> = points.iter().map(|points| [Curve { points, flagged: &[] }]).collect();
    let names: Vec<String> =
        solutions.iter().map(|(s, _)| format!("γ₀ = {:.0e} of the critical one", s.gamma / s.critical)).collect();
    let series: Vec<Series<'_>> = names.iter().zip(&curves).map(|(name, curves)| Series { name, curves }).collect();
    let all = study.pressures;
    chart(&Chart {
        title: &format!(
            "{}: pressure on {side}, {} elements of degree {}, multipliers on halved ones",
            study.scene.title, all.elements, all.degree
        ),
        x: Axis { label: &label, scale: Scale::Linear },
        y: Axis { label: "pressure", scale: Scale::Linear },
        quantities: &["pressure"],
        series: &series,
        flag: "",
        guides: &[],
        band: None,
    })
}
