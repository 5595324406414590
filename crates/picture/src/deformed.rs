//! Coarse cells that basis functions displace.

use super::basis::BasisFunction;
use kuva::render::render::TextAnchor;

use super::canvas::{BLACK, Canvas, GREY, Pen, Title, WIDTH};
use super::{Picture, PictureError};

/// A displacement of 1 is drawn as this part of a side of the cell.
const FACTOR: f64 = 0.3;
/// Largest number of lines in each direction inside a cell, its sides not counted.
const LINES: usize = 7;
/// Space between cells, and below a cell for its caption.
const SPACE: f64 = 24.0;
const CAPTION: f64 = 44.0;
const CAPTION_TEXT: u32 = 13;

/// Draws the lines of a coarse cell as each function displaces them, and the cell itself dashed, in `columns` columns.
///
/// # Errors
/// [`PictureError::Raster`] if the pixels cannot be made.
///
/// # Panics
/// If there is no column.
pub fn deformed_cells(title: &str, functions: &[BasisFunction<'_>], columns: usize) -> Result<Picture, PictureError> {
    assert!(columns > 0, "a column");
    let title = Title::new(title);
    let panel = (WIDTH - SPACE * (columns + 1) as f64) / columns as f64;
    // a cell with room for its displacement on both sides
    let side = panel / (1.0 + 2.0 * FACTOR);
    let top = 40.0 + title.height();
    let row = panel + CAPTION;
    let mut canvas = Canvas::new(top + row * functions.len().div_ceil(columns) as f64 + 10.0);
    canvas.title(&title, 34.0);
    for (k, function) in functions.iter().enumerate() {
        let corner = [SPACE + (k % columns) as f64 * (panel + SPACE), top + (k / columns) as f64 * row];
        let scale = side / function.size[0].max(function.size[1]);
        let centre = [corner[0] + panel / 2.0, corner[1] + panel / 2.0];
        let at = |[x, y]: [f64; 2]| {
            [centre[0] + scale * (x - function.size[0] / 2.0), centre[1] - scale * (y - function.size[1] / 2.0)]
        };
        let ([m, n], longest) = (function.cells, function.size[0].max(function.size[1]));
        let node = |i: usize, j: usize, k: f64| {
            let (x, y) = (function.x[j * (m + 1) + i], function.y[j * (m + 1) + i]);
            let place = [function.size[0] * i as f64 / m as f64, function.size[1] * j as f64 / n as f64];
            at([place[0] + k * longest * x, place[1] + k * longest * y])
        };
        let line = |along: usize, at: usize, k: f64| -> Vec<[f64; 2]> {
            let points = 0..=[m, n][along];
            points.map(|p| if along == 0 { node(p, at, k) } else { node(at, p, k) }).collect()
        };
        let sides = |k: f64| [line(0, 0, k), line(0, n, k), line(1, 0, k), line(1, m, k)];
        let inner = |along: usize| {
            let across = [n, m][along];
            let step = across.div_ceil(LINES + 1).max(1);
            (step..across).step_by(step).map(move |at| line(along, at, FACTOR)).collect::<Vec<_>>()
        };
        canvas.lines(&[inner(0), inner(1)].concat(), &Pen::solid(GREY, 0.7));
        canvas.lines(&sides(0.0), &Pen::dashed(GREY, 1.0, 5.0, 4.0));
        canvas.lines(&sides(FACTOR), &Pen::solid(BLACK, 1.4));
        canvas.text([centre[0], corner[1] + panel + 16.0], function.name, CAPTION_TEXT, TextAnchor::Middle);
    }
    canvas.finish()
}
