//! The pictures of the study.

use std::path::{Path, PathBuf};

use steklov_picture::PictureError;

use super::{Judged, QuantityStudy, Series};
use crate::chart::{Dots, Drawing, Line, Pictures, linear, log};

/// Largest number of quantities in a chart.
const DRAWN: usize = 8;
/// Uncertainties over errors are drawn up to this.
const FARTHEST: f64 = 1e3;

/// Draws errors and uncertainties over the unknowns, and the part of uncertainties that are within a multiple of their errors.
///
/// # Errors
/// When a picture cannot be drawn or written.
pub fn pictures(study: &QuantityStudy<'_>, folder: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let mut all = Pictures::new(folder);
    let title = study.scene.title.as_str();
    let drawing = Drawing {
        title,
        axes: [log("degrees of freedom N"), log("error of the quantity over its value")],
        quantities: &["true error", "uncertainty"],
        lines: chosen(study).into_iter().map(errors).filter(Line::is_drawn).collect(),
        flag: "in doubt",
        ..Drawing::default()
    };
    all.draw("quantities", &drawing)?;
    let of = |in_doubt: bool| {
        let points = study.series.iter().flat_map(|series| &series.points);
        points.filter(move |point| point.doubts.is_empty() != in_doubt).map(|point| point.smoothed)
    };
    let lines = [("without doubts", false), ("in doubt", true)];
    let drawing = Drawing {
        title,
        axes: [log("uncertainty over true error"), linear("part of the uncertainties that are below")],
        lines: lines
            .map(|(name, in_doubt)| Line::new(name, [distribution(of(in_doubt))]))
            .into_iter()
            .filter(Line::is_drawn)
            .collect(),
        ..Drawing::default()
    };
    all.draw("quantities-ratio", &drawing)?;
    Ok(all.files)
}

/// The quantities that are drawn: of each kind the one with the largest value, then more until there are enough.
fn chosen<'s>(study: &'s QuantityStudy<'_>) -> Vec<&'s Series> {
    let size = |series: &Series| series.points.last().map_or(0.0, |point| point.value.abs());
    let mut sorted: Vec<&Series> = study.series.iter().collect();
    sorted.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let mut chosen: Vec<&Series> = Vec::new();
    for series in sorted {
        if chosen.iter().all(|other| other.kind() != series.kind()) {
            chosen.push(series);
        }
    }
    chosen.truncate(DRAWN);
    chosen.sort_by(|a, b| a.path.cmp(&b.path));
    chosen
}

/// Errors and uncertainties of a quantity relative to its last value.
fn errors(series: &Series) -> Line {
    let size = series.points.last().map_or(1.0, |point| point.value.abs());
    let curve = |of: fn(&Judged) -> f64, flags: bool| {
        let known = series.points.iter().filter(|point| of(point) > 0.0 && size > 0.0);
        let dot = |point: &Judged| ([point.dofs as f64, of(point) / size], flags && !point.doubts.is_empty());
        let (points, flagged) = known.map(dot).unzip();
        Dots { points, flagged }
    };
    Line {
        name: series.path.clone(),
        curves: vec![curve(|point| point.error, false), curve(|point| point.uncertainty, true)],
    }
}

/// The part of these numbers that are below, over them.
fn distribution(ratios: impl Iterator<Item = f64>) -> Vec<[f64; 2]> {
    let mut sorted: Vec<f64> = ratios.filter(|ratio| ratio.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len() as f64;
    let points = sorted.into_iter().enumerate().map(|(k, ratio)| [ratio, (k + 1) as f64 / count]);
    points.filter(|[ratio, _]| *ratio <= FARTHEST).collect()
}
