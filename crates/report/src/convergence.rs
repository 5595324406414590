//! How the estimate falls from step to step.

use serde::Serialize;
use steklov_picture::{Axis, Chart, Curve, Picture, PictureError, Scale, Series, chart};
use steklov_result::history::StepNumbers;

use crate::numbers::number;

/// A step as the page tells it.
#[derive(Serialize)]
pub(crate) struct Row {
    dofs: usize,
    energy: String,
    estimate: String,
    doubts: String,
    iterations: usize,
    seconds: String,
}

pub(crate) fn rows(steps: &[StepNumbers]) -> Vec<Row> {
    let row = |step: &StepNumbers| Row {
        dofs: step.dofs,
        energy: number(step.energy, 10),
        estimate: step.estimate.map_or("none".into(), |estimate| number(estimate, 4)),
        doubts: step.doubts.join(", "),
        iterations: step.iterations,
        seconds: number(step.seconds, 3),
    };
    steps.iter().map(row).collect()
}

/// The estimate over unknowns and over seconds, of two steps or more that have one.
pub(crate) fn charts(title: &str, steps: &[StepNumbers]) -> Result<Vec<(String, Picture)>, PictureError> {
    let mut seconds = 0.0;
    let mut points: [Vec<[f64; 2]>; 2] = [Vec::new(), Vec::new()];
    let mut flagged = Vec::new();
    for step in steps {
        seconds += step.seconds;
        let Some(estimate) = step.estimate else { continue };
        points[0].push([step.dofs as f64, estimate]);
        points[1].push([seconds, estimate]);
        flagged.push(!step.doubts.is_empty());
    }
    if flagged.len() < 2 {
        return Ok(Vec::new());
    }
    let over = |label: &'static str, points: &[[f64; 2]]| {
        let curves = [Curve { points, flagged: &flagged }];
        chart(&Chart {
            title,
            x: Axis { label, scale: Scale::Log },
            y: Axis { label: "estimated error, energy norm", scale: Scale::Log },
            quantities: &["estimate"],
            series: &[Series { name: "estimate", curves: &curves }],
            flag: "not reliable",
            guides: &[],
            band: None,
        })
    };
    Ok(vec![
        ("convergence-unknowns".to_owned(), over("unknowns", &points[0])?),
        ("convergence-seconds".to_owned(), over("seconds of all steps so far", &points[1])?),
    ])
}

/// The work of all steps, for the caption.
pub(crate) fn total(steps: &[StepNumbers]) -> String {
    number(steps.iter().map(|step| step.seconds).sum(), 3)
}
