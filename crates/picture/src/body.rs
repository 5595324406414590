//! The deformed body, coloured by a field, over its undeformed outline and the obstacle.

use super::axes::{Axes, BELOW, LABEL_TEXT, TICK_TEXT};
use super::bands::{BANDS, bands, colour, interval, weighted};
use super::canvas::{BLACK, Canvas, GREY, Pen, Rect, Title, WIDTH, clip, text_width, wrap};
use super::colours::{Colours, beyond};
use super::scale::{Ticks, bar_ticks, exaggeration, short};
use super::window::part;
use super::{Picture, PictureError, in_unit};
use kuva::render::render::TextAnchor;

pub(super) const SUBTITLE_TEXT: u32 = 14;

/// Widest and tallest plotting area, and the smallest side it may have.
const WIDEST: f64 = 640.0;
const TALLEST: f64 = 620.0;
const SMALLEST: f64 = 210.0;

/// Height of an arrow at an end of the colours.
pub(super) const ARROW: f64 = 14.0;

/// Distance of the hatch lines of an obstacle.
const HATCH: f64 = 9.0;

/// The obstacle of one contact side, in traversal order of that side (body to the left).
#[derive(Debug, Clone, Copy)]
pub struct Obstacle<'a> {
    /// Points x of the undeformed side.
    pub points: &'a [[f64; 2]],
    /// Gap vectors g n at these points: the obstacle is the line through x + g n.
    pub gap: &'a [[f64; 2]],
}

/// A body to draw: P points, T triangles, in the units of the scene.
#[derive(Debug, Clone, Copy)]
pub struct Body<'a> {
    /// Title, broken into at most three lines.
    pub title: &'a str,
    /// Undeformed points (P).
    pub points: &'a [[f64; 2]],
    /// Displacements (P).
    pub displacement: &'a [[f64; 2]],
    /// Largest known displacement, which may lie between the points.
    pub largest: f64,
    /// Triangles (T).
    pub triangles: &'a [[usize; 3]],
    /// Values at the points (P) that colour the body. A triangle with a NaN stays white; an infinite value has the
    /// colour of the largest finite one.
    pub values: &'a [f64],
    /// Points at which the field is infinite, whatever `values` has there.
    pub infinite: &'a [[f64; 2]],
    /// Label of the values: "von Mises stress".
    pub label: &'a str,
    /// Noun for the values in a sentence: "stress".
    pub noun: &'a str,
    /// Values of the outer colours.
    pub colours: Colours,
    /// Boundary segments, each loop in traversal order.
    pub outline: &'a [[usize; 2]],
    /// The obstacles, one for each stretch of contact side.
    pub obstacles: &'a [Obstacle<'a>],
    /// Lower left and upper right corner of the part of the undeformed body that is drawn; None for all of it.
    pub window: Option<[[f64; 2]; 2]>,
    /// The largest factor k.
    pub most: Largest,
    /// Factor k > 0 of displacements and gaps; None chooses one that makes them visible.
    pub enlarge: Option<f64>,
    /// Names of the units of lengths, and of the values.
    pub units: [Option<&'a str>; 2],
}

/// The largest factor of displacements.
#[derive(Debug, Clone, Copy)]
pub struct Largest {
    /// The factor.
    pub factor: f64,
    /// Why it is not larger, a sentence without its end.
    pub why: &'static str,
}

impl Largest {
    /// No limit.
    pub const NONE: Self = Self { factor: f64::INFINITY, why: "" };
}

/// Draws the body with equal scales in x and y.
///
/// Displacements and gaps are drawn at one factor k, so that body and obstacle touch in the picture where they touch in
/// truth. Unless k is given, it is 1 if the largest displacement is between 0.05 and 0.5 of the longer side of the body
/// (or of the window), else the largest of 1, 2, 5 times a power of ten that brings it to at most 0.1, or less if
/// `most` is less. The subtitle states k. An obstacle further away than a quarter of the body is cut off at the frame.
/// If a few values are far beyond the others, or beyond the given colours, the colours end in an arrow, and a line
/// states the outermost value and its place before the deformation.
///
/// # Errors
/// [`PictureError::Raster`] if the pixels cannot be made.
///
/// # Panics
/// If the lengths do not fit or a number of a point is out of range.
pub fn body(b: &Body<'_>) -> Result<Picture, PictureError> {
    let Some(window) = b.window else { return draw(b, Bounds::of(b.points.iter())) };
    let part = part(b, window);
    let obstacles: Vec<Obstacle<'_>> = part.obstacles.iter().map(|[points, gap]| Obstacle { points, gap }).collect();
    let body = Body {
        points: &part.points,
        displacement: &part.displacement,
        largest: 0.0,
        triangles: &part.triangles,
        values: &part.values,
        outline: &part.outline,
        obstacles: &obstacles,
        ..*b
    };
    draw(&body, Bounds { low: window[0], high: window[1] })
}

/// Draws all of a body; the undeformed one is shown within bounds.
fn draw(b: &Body<'_>, bounds: Bounds) -> Result<Picture, PictureError> {
    assert_eq!(b.points.len(), b.displacement.len(), "one displacement a point");
    assert_eq!(b.points.len(), b.values.len(), "one value a point");
    let largest = b.displacement.iter().map(|u| u[0].hypot(u[1])).filter(|u| u.is_finite()).fold(b.largest, f64::max);
    let factor = b.enlarge.unwrap_or_else(|| exaggeration(largest / bounds.size(), b.most.factor));
    let is_less = b.enlarge.is_none() && factor < exaggeration(largest / bounds.size(), f64::INFINITY);
    let deformed: Vec<_> = b.points.iter().zip(b.displacement).map(|(&p, &u)| moved(p, u, factor)).collect();
    let walls = walls(b.obstacles, factor);

    let title = Title::new(b.title);
    let colours = b.colours.ends(&weighted(b.points, b.triangles, b.values), interval);
    let mut arrows = beyond(b.values.iter().copied(), colours);
    let is_shown = |x: &&[f64; 2]| (0..2).all(|i| (bounds.low[i]..=bounds.high[i]).contains(&x[i]));
    let infinite: Vec<&[f64; 2]> = b.infinite.iter().filter(is_shown).collect();
    arrows[1] |= !infinite.is_empty();
    let told = outermost(b, arrows, &infinite);
    let told = told.map_or(Vec::new(), |text| wrap(&text, SUBTITLE_TEXT, WIDTH - 60.0, 2));
    let top = 48.0 + title.height() + 20.0 * told.len() as f64;
    let axes = place(&view(bounds, &deformed, &walls), top);
    let f = axes.frame;
    let mut canvas = Canvas::new(f.bottom() + BELOW + 46.0);
    canvas.title(&title, 34.0);
    canvas.text(
        [WIDTH / 2.0, 30.0 + title.height()],
        &subtitle(b, factor, is_less, largest),
        SUBTITLE_TEXT,
        TextAnchor::Middle,
    );
    for (text, below) in told.iter().zip((0..told.len()).rev()) {
        canvas.text([WIDTH / 2.0, top - 18.0 - 20.0 * below as f64], text, SUBTITLE_TEXT, TextAnchor::Middle);
    }

    for (k, band) in bands(&deformed, b.triangles, b.values, colours).iter().enumerate() {
        let placed: Vec<Vec<_>> = band.iter().map(|p| p.iter().map(|&q| axes.at(q)).collect()).collect();
        canvas.fill(&placed, colour(k));
    }
    let through = |points: &[[f64; 2]]| -> Vec<Vec<[f64; 2]>> {
        chains(b.outline)
            .iter()
            .flat_map(|c| clip(&c.iter().map(|&i| axes.at(points[i])).collect::<Vec<_>>(), f))
            .collect()
    };
    canvas.lines(&through(&deformed), &Pen::solid(BLACK, 1.4));
    canvas.lines(&through(b.points), &undeformed_pen());
    draw_walls(&mut canvas, &axes, &walls);
    let [x, y] = ["x", "y"].map(|name| in_unit(name, b.units[0]));
    axes.draw(&mut canvas, Some(&x), &y, axes.left_margin(), false);
    colour_bar(&mut canvas, f, colours, &in_unit(b.label, b.units[1]), arrows);
    key(&mut canvas, [f.left + f.width / 2.0, f.bottom() + BELOW + 26.0], !walls.is_empty());
    canvas.finish()
}

/// The line about values beyond an end of the colours: the outermost values and their places.
fn outermost(b: &Body<'_>, [below, above]: [bool; 2], infinite: &[&[f64; 2]]) -> Option<String> {
    let all = || b.points.iter().zip(b.values).filter(|(_, v)| !v.is_nan());
    let smallest = all().min_by(|a, b| a.1.total_cmp(b.1)).filter(|_| below);
    let largest = all().max_by(|a, b| a.1.total_cmp(b.1)).filter(|_| above);
    let place = |[x, y]: &[f64; 2]| format!("at ({}, {})", short(*x, 4), short(*y, 4));
    let noun = b.noun;
    match infinite {
        [] => {}
        [x] => return Some(format!("the {noun} is infinite {}", place(x))),
        [x, y] => return Some(format!("the {noun} is infinite {} and {}", place(x), place(y))),
        [x, more @ ..] => {
            return Some(format!("the {noun} is infinite {} and at {} other points", place(x), more.len()));
        }
    }
    if let Some((x, _)) = [smallest, largest].into_iter().flatten().find(|(_, v)| v.is_infinite()) {
        return Some(format!("the {noun} is infinite {}", place(x)));
    }
    let end = |(x, v): (&[f64; 2], &f64)| format!("{} {}", with_unit(*v, b.units[1]), place(x));
    match [smallest, largest].map(|found| found.map(end)) {
        [None, None] => None,
        [None, Some(largest)] => Some(format!("colours end below the largest {noun} that is drawn, {largest}")),
        [Some(smallest), None] => Some(format!("colours end above the smallest {noun} that is drawn, {smallest}")),
        [Some(smallest), Some(largest)] => Some(format!(
            "colours end above the smallest {noun} that is drawn, {smallest}, and below the largest, {largest}"
        )),
    }
}

/// A value with three digits and the name of its unit.
pub(super) fn with_unit(value: f64, unit: Option<&str>) -> String {
    let value = short(value, 3);
    match unit {
        Some(unit) => format!("{value} {unit}"),
        None => value,
    }
}

pub(super) fn moved(p: [f64; 2], u: [f64; 2], factor: f64) -> [f64; 2] {
    [p[0] + factor * u[0], p[1] + factor * u[1]]
}

/// The obstacles with their gaps at this factor.
pub(super) fn walls(obstacles: &[Obstacle<'_>], factor: f64) -> Vec<Vec<[f64; 2]>> {
    obstacles.iter().map(|o| o.points.iter().zip(o.gap).map(|(&p, &g)| moved(p, g, factor)).collect()).collect()
}

pub(super) fn draw_walls(canvas: &mut Canvas, axes: &Axes, walls: &[Vec<[f64; 2]>]) {
    for wall in walls {
        let line: Vec<_> = wall.iter().map(|&p| axes.at(p)).collect();
        hatched(canvas, &clip(&line, axes.frame), axes.frame);
    }
}

pub(super) fn undeformed_pen() -> Pen {
    Pen::dashed(GREY, 1.1, 6.0, 4.0)
}

/// The line about the factor, which may be less than wanted, and the largest displacement.
fn subtitle(b: &Body<'_>, factor: f64, is_less: bool, largest: f64) -> String {
    let of = if b.window.is_some() { " of this part" } else { "" };
    let largest = format!("the largest displacement{of} is {}", with_unit(largest, b.units[0]));
    let why = if is_less { format!(", as {}", b.most.why) } else { String::new() };
    if factor == 1.0 {
        return format!("drawn to scale{why}; {largest}");
    }
    let what = if !b.obstacles.is_empty() { "displacements and gaps" } else { "displacements" };
    format!("{what} drawn {} times as large{why}; {largest}", short(factor, 3))
}

/// Smallest box around points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl Bounds {
    pub fn of<'p>(points: impl Iterator<Item = &'p [f64; 2]>) -> Self {
        let mut bounds = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };
        for p in points.filter(|p| p[0].is_finite() && p[1].is_finite()) {
            for i in 0..2 {
                bounds.low[i] = bounds.low[i].min(p[i]);
                bounds.high[i] = bounds.high[i].max(p[i]);
            }
        }
        if bounds.low[0] > bounds.high[0] { Self { low: [0.0; 2], high: [1.0; 2] } } else { bounds }
    }

    /// Longer side.
    pub fn size(&self) -> f64 {
        (self.high[0] - self.low[0]).max(self.high[1] - self.low[1])
    }
}

/// The part of the plane to show: the undeformed and the deformed body, and the near part of the obstacles.
pub(super) fn view(undeformed: Bounds, deformed: &[[f64; 2]], walls: &[Vec<[f64; 2]>]) -> Bounds {
    let body = Bounds::of(deformed.iter().chain([&undeformed.low, &undeformed.high]));
    let near = 0.25 * body.size();
    let mut shown = body;
    for p in walls.iter().flatten().filter(|p| p[0].is_finite() && p[1].is_finite()) {
        for i in 0..2 {
            shown.low[i] = shown.low[i].min(p[i].max(body.low[i] - near));
            shown.high[i] = shown.high[i].max(p[i].min(body.high[i] + near));
        }
    }
    shown
}

/// Frame and intervals: equal scales, a margin of 6 % of the longer side, centred between the margins.
pub(super) fn place(shown: &Bounds, top: f64) -> Axes {
    let size = shown.size();
    let extent = [0, 1].map(|i| shown.high[i] - shown.low[i] + 0.12 * size);
    let scale = (WIDEST / extent[0]).min(TALLEST / extent[1]);
    let side = |i: usize| (scale * extent[i]).max(SMALLEST);
    let interval = |i: usize| {
        let (middle, half) = (shown.low[i] / 2.0 + shown.high[i] / 2.0, side(i) / scale / 2.0);
        [middle - half, middle + half]
    };
    let mut axes =
        Axes { frame: Rect { left: 0.0, top, width: side(0), height: side(1) }, x: interval(0), y: interval(1) };
    // The colour bar and its labels take about 130 at the right.
    let spare = WIDTH - axes.left_margin() - axes.frame.width - 130.0;
    axes.frame.left = axes.left_margin() + (spare / 2.0).max(0.0);
    axes
}

/// Point numbers of connected segments, joined into polylines.
pub(super) fn chains(segments: &[[usize; 2]]) -> Vec<Vec<usize>> {
    let mut result: Vec<Vec<usize>> = Vec::new();
    for &[a, b] in segments {
        match result.last_mut() {
            Some(chain) if chain.last() == Some(&a) => chain.push(b),
            _ => result.push(vec![a, b]),
        }
    }
    result
}

/// A line hatched on its right side in traversal order, which is the far side of an obstacle.
pub(super) fn hatched(canvas: &mut Canvas, pieces: &[Vec<[f64; 2]>], frame: Rect) {
    let mut strokes = Vec::new();
    for piece in pieces {
        let mut next = HATCH / 2.0;
        for w in piece.windows(2) {
            let (d, length) = ([w[1][0] - w[0][0], w[1][1] - w[0][1]], (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]));
            while next < length {
                let (s, t) = (next / length, [d[0] / length, d[1] / length]);
                let p = [w[0][0] + s * d[0], w[0][1] + s * d[1]];
                // In the picture y points down, so the right side is the tangent turned by (x, y) → (-y, x).
                let far = [p[0] - 6.0 * (t[0] + t[1]), p[1] + 6.0 * (t[0] - t[1])];
                strokes.extend(clip(&[p, far], frame));
                next += HATCH;
            }
            next -= length;
        }
    }
    canvas.lines(&strokes, &Pen::solid(BLACK, 0.9));
    canvas.lines(pieces, &Pen::solid(BLACK, 2.0));
}

/// The colours with their values, right of the frame, and arrows where there are smaller or larger values.
pub(super) fn colour_bar(canvas: &mut Canvas, frame: Rect, [low, high]: [f64; 2], title: &str, more: [bool; 2]) {
    let height = frame.height.min(400.0);
    let bar = Rect { left: frame.right() + 26.0, top: frame.top + (frame.height - height) / 2.0, width: 18.0, height };
    let marks = bar_ticks(low, high, (height / 40.0) as usize);
    let right = colours(canvas, bar, [low, high], &marks);
    arrows(canvas, bar, more);
    canvas.text_upwards([right + 20.0, bar.top + height / 2.0], &marks.title(title), LABEL_TEXT);
}

/// Arrows below and above the colours in a box.
pub(super) fn arrows(canvas: &mut Canvas, bar: Rect, [below, above]: [bool; 2]) {
    let ends = [(below, bar.bottom(), ARROW, 0), (above, bar.top, -ARROW, BANDS - 1)];
    for (_, y, height, band) in ends.into_iter().filter(|end| end.0) {
        let (left, tip, right) = ([bar.left, y], [bar.left + bar.width / 2.0, y + height], [bar.right(), y]);
        canvas.fill(&[vec![left, right, tip]], colour(band));
        canvas.lines(&[vec![left, tip, right]], &Pen::solid(BLACK, 1.0));
    }
}

/// The colours from the bottom to the top of a box, and ticks at its right; returns the right end of their labels.
pub(super) fn colours(canvas: &mut Canvas, bar: Rect, [low, high]: [f64; 2], marks: &Ticks) -> f64 {
    let height = bar.height;
    for k in 0..BANDS {
        let step = height / BANDS as f64;
        let (bottom, top) = (bar.bottom() - k as f64 * step, bar.bottom() - (k + 1) as f64 * step);
        canvas.fill(&[vec![[bar.left, bottom], [bar.right(), bottom], [bar.right(), top], [bar.left, top]]], colour(k));
    }
    let (l, r, t, b) = (bar.left, bar.right(), bar.top, bar.bottom());
    let pen = Pen::solid(BLACK, 1.0);
    canvas.lines(&[vec![[l, t], [r, t], [r, b], [l, b], [l, t]]], &pen);
    let mut widest: f64 = 0.0;
    for (v, label) in marks.values.iter().zip(&marks.labels) {
        let y = b - (v - low) / (high - low) * height;
        canvas.line([r, y], [r + 5.0, y], &pen);
        canvas.text([r + 8.0, y + 4.5], label, TICK_TEXT, TextAnchor::Start);
        widest = widest.max(text_width(label, TICK_TEXT));
    }
    r + 8.0 + widest
}

/// The key of the lines, in a row centred on a point.
fn key(canvas: &mut Canvas, centre: [f64; 2], obstacle: bool) {
    let names = ["deformed", "undeformed", "obstacle"];
    let shown = &names[..if obstacle { 3 } else { 2 }];
    let width = |name: &str| 34.0 + 8.0 + text_width(name, TICK_TEXT) + 20.0;
    let total: f64 = shown.iter().map(|n| width(n)).sum();
    let mut x = (centre[0] - total / 2.0).max(20.0);
    for (i, name) in shown.iter().enumerate() {
        let line = vec![[x, centre[1] - 5.0], [x + 34.0, centre[1] - 5.0]];
        match i {
            0 => canvas.lines(&[line], &Pen::solid(BLACK, 1.4)),
            1 => canvas.lines(&[line], &undeformed_pen()),
            _ => {
                let frame = Rect { left: x - 9.0, top: centre[1] - 20.0, width: 60.0, height: 40.0 };
                hatched(canvas, &[line], frame);
            }
        }
        canvas.text([x + 42.0, centre[1]], name, TICK_TEXT, TextAnchor::Start);
        x += width(name);
    }
}
