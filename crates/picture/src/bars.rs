//! Groups of horizontal bars, a row for each name.

use super::axes::{Axes, BELOW, LABEL_TEXT, TICK_TEXT};
use super::canvas::{BLACK, Canvas, Pen, Rect, Title, WIDTH, text_width, wrap};
use super::contact::interval;
use super::scale::short;
use super::{Picture, PictureError};
use kuva::render::color::Color;
use kuva::render::render::TextAnchor;

/// Height of a row and of its bar, and space above a group for its name.
const ROW: f64 = 19.0;
const BAR: f64 = 12.0;
const HEAD: f64 = 34.0;

/// Widest name of a row.
const NAME: f64 = 240.0;

const FILL: Color = Color::Rgb(0, 84, 147);

/// Bars under one heading, one for each row.
#[derive(Debug, Clone)]
pub struct BarGroup {
    /// Text above the bars.
    pub caption: String,
    /// Lengths ≥ 0; one that is not finite or negative has no bar.
    pub values: Vec<f64>,
}

/// The number beside a bar; values below 1e-12 of the greatest are rounding errors and become 0.
fn number(value: f64, greatest: f64) -> String {
    short(if value > 1e-12 * greatest { value } else { 0.0 }, 2)
}

/// Draws the groups below each other over one axis from zero, with the value beside each bar.
///
/// # Errors
/// [`PictureError::Raster`] if the pixels cannot be made.
///
/// # Panics
/// If a group does not have a value for each row.
pub fn bars(title: &str, x: &str, rows: &[String], groups: &[BarGroup]) -> Result<Picture, PictureError> {
    assert!(groups.iter().all(|g| g.values.len() == rows.len()), "a value for each row");
    let title = Title::new(title);
    let names: Vec<String> =
        rows.iter().map(|r| wrap(r, TICK_TEXT, NAME, 1).into_iter().next().unwrap_or_default()).collect();
    let left = names.iter().map(|n| text_width(n, TICK_TEXT)).fold(60.0, f64::max) + 24.0;
    let top = 16.0 + title.height();
    let height = ROW * rows.len() as f64 + 6.0;
    let last = top + groups.len() as f64 * (HEAD + height);
    let mut canvas = Canvas::new((last + BELOW + 10.0).max(200.0));
    canvas.title(&title, 34.0);
    let shown = |v: &f64| v.is_finite() && *v >= 0.0;
    let ends = interval(groups.iter().flat_map(|g| &g.values).copied().filter(shown), true);
    for (k, group) in groups.iter().enumerate() {
        let frame = Rect { left, top: top + HEAD + k as f64 * (HEAD + height), width: WIDTH - left - 80.0, height };
        let axes = Axes { frame, x: [0.0, ends[1]], y: [0.0, 1.0] };
        canvas.text([left, frame.top - 8.0], &group.caption, LABEL_TEXT, TextAnchor::Start);
        axes.draw_x(&mut canvas, (k + 1 == groups.len()).then_some(x));
        for (i, (name, &value)) in names.iter().zip(&group.values).enumerate() {
            let middle = frame.top + 3.0 + ROW * (i as f64 + 0.5);
            canvas.text([left - 9.0, middle + 4.5], name, TICK_TEXT, TextAnchor::End);
            if shown(&value) {
                let right = axes.at([value, 0.0])[0];
                let (t, b) = (middle - BAR / 2.0, middle + BAR / 2.0);
                canvas.fill(&[vec![[left, t], [right, t], [right, b], [left, b]]], FILL);
                canvas.text([right + 7.0, middle + 4.5], &number(value, ends[1]), TICK_TEXT, TextAnchor::Start);
            }
        }
        canvas.line([left, frame.top], [left, frame.bottom()], &Pen::solid(BLACK, 1.0));
    }
    canvas.finish()
}
