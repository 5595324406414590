//! Coloured rectangles of the plane in rows and columns: the common part of pictures of cells and of basis functions.

use super::axes::{Axes, BELOW, TICK_TEXT};
use super::bands::interval;
use super::body::{ARROW, Bounds, SUBTITLE_TEXT, arrows, colours};
use super::canvas::{BLACK, Canvas, PIXELS, Pen, Rect, Title, WIDTH, clip, text_width, wrap};
use super::raster::Raster;
use super::scale::{Ticks, bar_ticks};
use super::{Picture, PictureError, in_unit};
use kuva::render::color::Color;
use kuva::render::render::TextAnchor;
use std::ops::RangeInclusive;

/// Height that all rows together may take, and the largest side of a frame.
const ROWS: f64 = 1150.0;
const LARGEST: f64 = 620.0;

/// Smallest width and height of a frame, so that its ticks have room beside a very flat or tall body.
const SMALLEST: [f64; 2] = [90.0, 64.0];

/// Space right of a frame with a colour bar, and without one.
const COLOURS: f64 = 110.0;
const RIGHT: f64 = 22.0;

/// Height of a line of a caption, and space between two rows.
const LINE: f64 = 17.0;
const BETWEEN: f64 = 20.0;

/// An overlaid rectangle is left out if a side is shorter than `SHORTEST`, or than the body's side over `MOST_ALONG`.
const SHORTEST: f64 = 3.0;
const MOST_ALONG: f64 = 30.0;

/// A body thinner than this has no outline, because the outline would hide it.
const THIN: f64 = 5.0;

const WHITE: Color = Color::Rgb(255, 255, 255);

/// One coloured rectangle.
pub(super) struct FieldPanel<'a> {
    /// Text above the panel, before the label of the colours.
    pub caption: &'a str,
    /// Label of the colours.
    pub label: &'a str,
    /// Name of the unit of lengths.
    pub length: Option<&'a str>,
    /// The rectangle.
    pub bounds: Bounds,
    /// Values of the outer colours.
    pub ends: [f64; 2],
    /// Whether there are values below and above them.
    pub beyond: [bool; 2],
    /// Its pixels, from the numbers of pixels along x and y and the values of the outer colours.
    pub pixels: Box<dyn Fn([usize; 2], [f64; 2]) -> Raster + 'a>,
    /// Rectangles over it: lower left and upper right corners.
    pub overlay: &'a [[[f64; 2]; 2]],
}

/// Ends of the colours of values of either sign: with a negative value, from the smallest value to the largest, at
/// least to zero; else as [`interval`].
pub(super) fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for v in values.filter(|v| v.is_finite()) {
        (low, high) = (low.min(v), high.max(v));
    }
    if low < 0.0 { [low, high.max(0.0)] } else { interval(&[(low, 1.0), (high, 1.0)]) }
}

/// Draws panels of one part of the plane row by row, with the number of columns in the given range that draws them
/// largest. With `shared` all have the same colours, named once.
pub(super) fn field_panels(
    title: &str,
    panels: &[FieldPanel<'_>],
    columns: RangeInclusive<usize>,
    shared: bool,
) -> Result<Picture, PictureError> {
    let title = Title::new(title);
    let view = Bounds::of(panels.iter().flat_map(|p| [&p.bounds.low, &p.bounds.high]));
    let common =
        panels.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], p| [a.min(p.ends[0]), b.max(p.ends[1])]);
    let plan = Plan::new(&view, panels.len(), columns, shared);
    let captions: Vec<Vec<String>> = panels.iter().map(|p| plan.caption(p, shared)).collect();
    let head = LINE * captions.iter().map(Vec::len).max().unwrap_or(0) as f64 + 8.0;
    let first = 22.0 + title.height() + if shared { 26.0 } else { 0.0 } + head;
    let step = plan.frame[1] + head + BETWEEN;
    let last = first + step * panels.len().div_ceil(plan.columns).max(1) as f64 - head - BETWEEN;

    let mut canvas = Canvas::new((last + BELOW + 12.0).max(200.0));
    canvas.title(&title, 34.0);
    if shared && let Some(panel) = panels.first() {
        let bar = Rect { left: WIDTH - 92.0, top: first, width: 18.0, height: (last - first).min(400.0) };
        let bar = Rect { top: first + (last - first - bar.height) / 2.0, ..bar };
        let marks = bar_ticks(common[0], common[1], marks_of(bar.height));
        colours(&mut canvas, bar, common, &marks);
        let named = with_power(&format!("colours: {}", panel.label), &marks, SUBTITLE_TEXT, WIDTH - 40.0, 1).concat();
        canvas.text([WIDTH / 2.0, first - head - 8.0], &named, SUBTITLE_TEXT, TextAnchor::Middle);
    }
    for (k, (panel, caption)) in panels.iter().zip(&captions).enumerate() {
        let axes = plan.axes(&view, k, first.round() + step.round() * (k / plan.columns) as f64);
        let f = axes.frame;
        let colour_ends = if shared { common } else { panel.ends };
        paint(&mut canvas, &axes, panel, &plan, colour_ends)?;
        let [x, y] = ["x", "y"].map(|name| in_unit(name, panel.length));
        let x_title = (k + plan.columns >= panels.len()).then_some(x.as_str());
        axes.draw(&mut canvas, x_title, &y, axes.left_margin(), false);
        for (i, line) in caption.iter().enumerate() {
            let y = f.top - 8.0 - LINE * (caption.len() - 1 - i) as f64;
            canvas.text([f.left, y], line, TICK_TEXT, TextAnchor::Start);
        }
        if !shared {
            let [below, above] = panel.beyond.map(|more| if more { ARROW } else { 0.0 });
            let (left, top, height) = (f.right() + 20.0, f.top + above, f.height - above - below);
            let bar = Rect { left, top, width: 18.0, height };
            arrows(&mut canvas, bar, panel.beyond);
            colours(&mut canvas, bar, colour_ends, &bar_ticks(colour_ends[0], colour_ends[1], marks_of(f.height)));
        }
    }
    canvas.finish()
}

/// Largest number of ticks on a colour bar.
fn marks_of(height: f64) -> usize {
    (height / 28.0).clamp(4.0, 10.0) as usize
}

/// A text in at most `lines` lines, with the power of ten of the ticks, which is never cut off.
fn with_power(text: &str, marks: &Ticks, size: u32, width: f64, lines: usize) -> Vec<String> {
    let power = marks.title("");
    let mut result = wrap(text, size, width - text_width(&power, size), lines);
    if let Some(last) = result.last_mut() {
        last.push_str(&power);
    }
    result
}

/// The pixels of a panel, its outline and the rectangles over it.
fn paint(
    canvas: &mut Canvas,
    axes: &Axes,
    panel: &FieldPanel<'_>,
    plan: &Plan,
    ends: [f64; 2],
) -> Result<(), PictureError> {
    let Bounds { low, high } = panel.bounds;
    let corner = axes.at([low[0], high[1]]).map(|p| (PIXELS * p).round() / PIXELS);
    let size = [0, 1].map(|i| (((high[i] - low[i]) / plan.pixel[i]).round() as usize).max(1));
    let raster = (panel.pixels)(size, ends);
    let [width, height] = size.map(|n| n as f64 / PIXELS);
    canvas.raster(Rect { left: corner[0], top: corner[1], width, height }, &raster)?;
    if width.min(height) >= THIN {
        canvas.lines(&raster.outline(corner), &Pen::solid(BLACK, 1.0));
    }
    let mut lines = Vec::new();
    let is_large =
        |[a, b]: &&[[f64; 2]; 2]| (0..2).all(|i| MOST_ALONG * (b[i] - a[i]) >= (1.0 - 1e-9) * (high[i] - low[i]));
    for [a, b] in panel.overlay.iter().filter(is_large) {
        let ([l, b], [r, t]) = (axes.at(*a), axes.at(*b));
        if r - l >= SHORTEST && b - t >= SHORTEST {
            lines.extend(clip(&[[l, b], [r, b], [r, t], [l, t], [l, b]], axes.frame));
        }
    }
    // dark on a light ground, visible on every colour
    canvas.lines(&lines, &Pen::solid(WHITE, 1.8));
    canvas.lines(&lines, &Pen::solid(BLACK, 0.7));
    Ok(())
}

/// Sizes that all panels share.
struct Plan {
    columns: usize,
    /// Space for tick labels left of a frame, space between the left ends of two columns.
    left: f64,
    stride: f64,
    right: f64,
    /// Sides of the frames, and of a pixel in the units of the plane.
    frame: [f64; 2],
    pixel: [f64; 2],
    /// Pixels of the part of the plane.
    pixels: [usize; 2],
}

impl Plan {
    fn new(view: &Bounds, panels: usize, columns: RangeInclusive<usize>, shared: bool) -> Self {
        let extent = [0, 1].map(|i| view.high[i] - view.low[i]);
        let tall = Rect { left: 0.0, top: 0.0, width: LARGEST, height: LARGEST };
        let left = Axes { frame: tall, x: [view.low[0], view.high[0]], y: [view.low[1], view.high[1]] }.left_margin();
        let (right, bar) = if shared { (RIGHT, COLOURS) } else { (COLOURS, 0.0) };
        let mut best: Option<(f64, usize, f64)> = None;
        for columns in columns {
            let stride = (WIDTH - 16.0 - bar) / columns as f64;
            let width = (stride - left - right).clamp(SMALLEST[0], LARGEST);
            let row = (ROWS - BELOW) / panels.div_ceil(columns).max(1) as f64 - BETWEEN - 2.0 * LINE;
            let scale = (width / extent[0]).min(row.clamp(SMALLEST[1], LARGEST) / extent[1]);
            let fits = stride - left - right >= SMALLEST[0];
            if best.is_none_or(|b| fits && scale > b.0 * (1.0 + 1e-9)) {
                best = Some((scale, columns, stride));
            }
        }
        let (scale, columns, stride) = best.unwrap_or((1.0, 1, WIDTH));
        let pixels = extent.map(|e| ((PIXELS * scale * e).round() as usize).max(1));
        let frame = [0, 1].map(|i| (pixels[i] as f64 / PIXELS).max(SMALLEST[i]));
        let pixel = [0, 1].map(|i| extent[i] / pixels[i] as f64);
        Self { columns, left, stride, right, frame, pixel, pixels }
    }

    fn caption(&self, panel: &FieldPanel<'_>, shared: bool) -> Vec<String> {
        let FieldPanel { caption, label, ends, .. } = panel;
        let room = self.stride - self.left - 4.0;
        if shared {
            return wrap(caption, TICK_TEXT, room, 3);
        }
        let text = if caption.is_empty() { (*label).to_owned() } else { format!("{caption}: {label}") };
        with_power(&text, &bar_ticks(ends[0], ends[1], marks_of(self.frame[1])), TICK_TEXT, room, 3)
    }

    /// Frame and intervals of panel k; the corners of the part of the plane lie on pixels of the picture.
    fn axes(&self, view: &Bounds, k: usize, top: f64) -> Axes {
        let [width, height] = self.frame;
        let spare = (self.stride - self.left - self.right - width).max(0.0);
        let left = 8.0 + (k % self.columns) as f64 * self.stride + self.left + spare / 2.0;
        let ends = |i: usize| {
            let blank = ((PIXELS * self.frame[i]) as usize - self.pixels[i]) / 2;
            let low = view.low[i] - blank as f64 * self.pixel[i];
            [low, low + PIXELS * self.frame[i] * self.pixel[i]]
        };
        Axes { frame: Rect { left: left.round(), top, width, height }, x: ends(0), y: ends(1) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_of_either_sign() {
        let of = |v: &[f64]| ends(v.iter().copied());
        assert_eq!(of(&[-2.0, -1.0]), [-2.0, 0.0]);
        assert_eq!(of(&[-2.0, f64::NAN, 1.0, f64::INFINITY]), [-2.0, 1.0]);
        assert_eq!(of(&[1.0, 4.0]), [0.0, 4.0]);
        assert_eq!(of(&[3.0, 4.0]), [3.0, 4.0]);
        assert_eq!((of(&[]), of(&[f64::NAN])), ([0.0, 1.0], [0.0, 1.0]));
    }

    #[test]
    fn flat_bodies_stand_below_each_other_tall_ones_beside_and_many_square_ones_in_rows() {
        let plan = |size: [f64; 2], panels: usize, shared: bool| {
            Plan::new(&Bounds { low: [0.0; 2], high: size }, panels, 1..=panels, shared)
        };
        for (size, panels, columns) in
            [([6.0, 1.0], 4, 1), ([1.0, 6.0], 2, 2), ([60.0, 1.0], 5, 1), ([1.0, 60.0], 3, 3), ([1.0, 1.0], 4, 2)]
        {
            for shared in [false, true] {
                let plan = plan(size, panels, shared);
                assert_eq!(plan.columns, columns, "{size:?}");
                let aspect = plan.pixels[0] as f64 / plan.pixels[1] as f64;
                let rounding = 0.5 / plan.pixels.into_iter().min().unwrap() as f64;
                assert!((aspect * size[1] / size[0] - 1.0).abs() < 3.0 * rounding);
            }
        }
    }
}
