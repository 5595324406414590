//! Pictures of the expansions of random fields.

use steklov_elastic::plane::minus;
use steklov_model::stochastic::{FieldModes, StochasticResult};
use steklov_picture::{Ends, Layer, Panel, Picture, PictureError, Shape, Tile, in_unit, panels, tiles};
use steklov_result::record::Record;

use crate::draw::file_name;

/// Largest number of modes that are drawn.
const MODES: usize = 6;

/// The spectrum of each field, and its first modes: modes along a side are in the same picture, modes over the body in
/// a picture of their own.
pub(super) fn pictures(stored: &Record, result: &StochasticResult) -> Result<Vec<(String, Picture)>, PictureError> {
    let mut pictures = Vec::new();
    for (k, field) in result.fields.iter().enumerate() {
        let part = file_name(&field.name);
        let taken = result.fields[..k].iter().any(|other| file_name(&other.name) == part);
        let part = if taken { format!("{part}-{k}") } else { part };
        let on_body = field.points.first().is_some_and(|p| p.len() == 2);
        let mut all = vec![spectrum(field)];
        if !on_body {
            all.push(modes(field, stored.summary.units.length.as_deref()));
        }
        let title = format!("{}: random field {}", stored.summary.title, field.name);
        pictures.push((format!("field-{part}"), panels(&title, &all)?));
        if on_body && !stored.grid.triangles.is_empty() {
            pictures.push((format!("modes-{part}"), on_the_body(stored, field)?));
        }
    }
    Ok(pictures)
}

fn spectrum(field: &FieldModes) -> Panel {
    let values: Vec<[f64; 2]> = field.eigenvalues.iter().enumerate().map(|(m, v)| [(m + 1) as f64, *v]).collect();
    // an axis of six numbers or more has its ticks at whole numbers
    let ends = vec![[0.4, f64::NAN], [values.len().max(6) as f64 + 0.6, f64::NAN]];
    let name = format!("eigenvalues: {:.4} % of the variance kept", 100.0 * field.captured);
    Panel {
        x: "mode".to_owned(),
        y: "eigenvalue".to_owned(),
        ends: Ends::Log,
        layers: vec![
            Layer { name, shape: Shape::Curve(values, 0) },
            Layer { name: String::new(), shape: Shape::Points(ends, 0) },
        ],
    }
}

fn modes(field: &FieldModes, length: Option<&str>) -> Panel {
    let curve = |m: usize| field.points.iter().zip(&field.modes).map(|(s, b)| [s[0], b[m]]).collect();
    let shown = 0..field.eigenvalues.len().min(MODES);
    Panel {
        x: in_unit("arc length along the side", length),
        y: "√λ times mode".to_owned(),
        ends: Ends::Zero,
        layers: shown.map(|m| Layer { name: format!("mode {}", m + 1), shape: Shape::Curve(curve(m), m) }).collect(),
    }
}

fn on_the_body(stored: &Record, field: &FieldModes) -> Result<Picture, PictureError> {
    let grid = &stored.grid;
    let low = grid.points.iter().fold([f64::INFINITY; 2], |l, p| [l[0].min(p[0]), l[1].min(p[1])]);
    let shown = 0..field.eigenvalues.len().min(MODES);
    let tile = |m: usize| Tile {
        caption: format!("mode {}", m + 1),
        values: grid.points.iter().map(|p| at(field, minus(*p, low), m)).collect(),
    };
    let title = format!("{}: modes of {}", stored.summary.title, field.name);
    let all: Vec<Tile> = shown.map(tile).collect();
    tiles(&title, "√λ times mode", &grid.points, &grid.triangles, &grid.lines, &all)
}

/// Bilinear value of a mode at a point, measured from the lower left of the body; the stored points are a grid, x
/// fastest.
fn at(field: &FieldModes, point: [f64; 2], mode: usize) -> f64 {
    let columns = field.points.iter().take_while(|p| p[1] == field.points[0][1]).count();
    let rows = field.points.len() / columns.max(1);
    if columns < 2 || rows < 2 {
        return f64::NAN;
    }
    let last = &field.points[field.points.len() - 1];
    let place = |i: usize, steps: usize| {
        let x = (point[i] / last[i] * steps as f64).clamp(0.0, steps as f64);
        let cell = (x as usize).min(steps - 1);
        (cell, x - cell as f64)
    };
    let ((i, s), (j, t)) = (place(0, columns - 1), place(1, rows - 1));
    let value = |i: usize, j: usize| field.modes[j * columns + i][mode];
    let along = |j: usize| (1.0 - s) * value(i, j) + s * value(i + 1, j);
    (1.0 - t) * along(j) + t * along(j + 1)
}
