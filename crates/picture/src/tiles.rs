//! Coloured plane regions: fields over a body in small panels of one scale, and boxes coloured by a degree.

use super::axes::{Axes, BELOW, TICK_TEXT};
use super::bands::{bands, colour};
use super::body::{Bounds, chains, colour_bar};
use super::canvas::{BLACK, Canvas, Pen, Rect, Title, WIDTH, text_width, wrap};
use super::contact::interval;
use super::mesh::Shades;
use super::{Picture, PictureError};
use kuva::render::color::Color;
use kuva::render::render::TextAnchor;
use std::collections::BTreeSet;

const CAPTION: f64 = 26.0;

/// Space for the colour bar.
const COLOURS: f64 = 120.0;

/// One field over the points of the body.
#[derive(Debug, Clone)]
pub struct Tile {
    /// Text above the panel.
    pub caption: String,
    /// Values at the points.
    pub values: Vec<f64>,
}

/// Draws fields over one body in rows of up to three, all coloured from -m to m with their largest absolute value m.
///
/// # Errors
/// [`PictureError::Raster`] if the pixels cannot be made.
///
/// # Panics
/// If a field does not have a value for each point.
pub fn tiles(
    title: &str,
    label: &str,
    points: &[[f64; 2]],
    triangles: &[[usize; 3]],
    outline: &[[usize; 2]],
    fields: &[Tile],
) -> Result<Picture, PictureError> {
    assert!(fields.iter().all(|f| f.values.len() == points.len()), "a value for each point");
    let title = Title::new(title);
    let top = 22.0 + title.height();
    let columns = fields.len().clamp(1, 3);
    let room = (WIDTH - 40.0 - COLOURS) / columns as f64;
    let bounds = Bounds::of(points.iter());
    let size = [0, 1].map(|i| bounds.high[i] - bounds.low[i]);
    let scale = ((room - 24.0) / size[0]).min(320.0 / size[1]);
    let height = scale * size[1];
    let rows = fields.len().div_ceil(columns).max(1);
    let all = Rect {
        left: 20.0,
        top: top + CAPTION,
        width: WIDTH - 40.0 - COLOURS,
        height: rows as f64 * (height + CAPTION + 14.0) - CAPTION,
    };
    let mut canvas = Canvas::new((all.bottom() + 14.0).max(230.0));
    canvas.title(&title, 34.0);
    let largest = fields.iter().flat_map(|f| &f.values).filter(|v| v.is_finite()).fold(0.0f64, |m, v| m.max(v.abs()));
    let ends = if largest > 0.0 { [-largest, largest] } else { [-1.0, 1.0] };
    for (k, field) in fields.iter().enumerate() {
        let left = all.left + (k % columns) as f64 * room + (room - scale * size[0]) / 2.0;
        let frame = Rect {
            left,
            top: all.top + (k / columns) as f64 * (height + CAPTION + 14.0),
            width: scale * size[0],
            height,
        };
        let axes = Axes { frame, x: [bounds.low[0], bounds.high[0]], y: [bounds.low[1], bounds.high[1]] };
        for (band, polygons) in bands(points, triangles, &field.values, ends).iter().enumerate() {
            let placed: Vec<Vec<_>> = polygons.iter().map(|p| p.iter().map(|&q| axes.at(q)).collect()).collect();
            canvas.fill(&placed, colour(band));
        }
        let lines: Vec<Vec<_>> =
            chains(outline).iter().map(|c| c.iter().map(|&i| axes.at(points[i])).collect()).collect();
        canvas.lines(&lines, &Pen::solid(BLACK, 1.2));
        canvas.text([frame.left, frame.top - 7.0], &field.caption, TICK_TEXT, TextAnchor::Start);
    }
    let bar = Rect { height: all.height.max(120.0), ..all };
    colour_bar(&mut canvas, bar, ends, label, [false; 2]);
    canvas.finish()
}

/// A box of the plane with a degree in each direction.
#[derive(Debug, Clone, Copy)]
pub struct DegreeBox {
    /// Lower left and upper right corner.
    pub corners: [[f64; 2]; 2],
    /// Degrees along x and y.
    pub degree: [usize; 2],
}

/// Draws boxes coloured by the larger of their degrees (the darker, the higher), with both degrees in figures if there
/// is room, and points in the boxes.
///
/// # Errors
/// [`PictureError::Raster`] if the pixels cannot be made.
pub fn boxes(
    title: &str,
    [x, y]: [&str; 2],
    boxes: &[DegreeBox],
    points: &[[f64; 2]],
) -> Result<Picture, PictureError> {
    let title = Title::new(title);
    let top = 24.0 + title.height();
    let ends = |i: usize| interval(boxes.iter().flat_map(|b| b.corners.map(|c| c[i])), false);
    let mut axes = Axes { frame: Rect { left: 0.0, top, width: 560.0, height: 520.0 }, x: ends(0), y: ends(1) };
    let margin = axes.left_margin();
    axes.frame.left = margin + 40.0;
    let f = axes.frame;
    let mut canvas = Canvas::new(f.bottom() + BELOW + 12.0);
    canvas.title(&title, 34.0);
    let degrees: BTreeSet<usize> = boxes.iter().map(|b| b.degree[0].max(b.degree[1])).collect();
    let shades = Shades::of(&degrees);
    for b in boxes {
        let [low, high] = b.corners.map(|c| axes.at(c));
        let corners = vec![low, [high[0], low[1]], high, [low[0], high[1]], low];
        canvas.fill(&[corners[..4].to_vec()], shades.colour(b.degree[0].max(b.degree[1])));
        canvas.lines(&[corners], &Pen::solid(BLACK, 1.0));
    }
    for &p in points.iter().filter(|p| p[0].is_finite() && p[1].is_finite()) {
        canvas.disc(axes.at(p), 3.0, BLACK);
    }
    for b in boxes {
        let [low, high] = b.corners.map(|c| axes.at(c));
        let text = format!("{} × {}", b.degree[0], b.degree[1]);
        let width = text_width(&text, TICK_TEXT) + 4.0;
        if high[0] - low[0] > width + 6.0 && low[1] - high[1] > 28.0 {
            // in the upper left corner, on its own ground
            let (l, t) = (low[0] + 3.0, high[1] + 3.0);
            canvas.fill(&[vec![[l, t], [l + width, t], [l + width, t + 17.0], [l, t + 17.0]]], WHITE);
            canvas.text([l + width / 2.0, t + 13.0], &text, TICK_TEXT, TextAnchor::Middle);
        }
    }
    axes.draw(&mut canvas, Some(x), y, margin, false);
    let left = f.right() + 26.0;
    canvas.text([left, f.top + 12.0], "larger degree", TICK_TEXT, TextAnchor::Start);
    let mut at = f.top + 24.0;
    for &degree in &degrees {
        let (l, r, t, b) = (left, left + 30.0, at, at + 14.0);
        canvas.fill(&[vec![[l, t], [r, t], [r, b], [l, b]]], shades.colour(degree));
        canvas.lines(&[vec![[l, t], [r, t], [r, b], [l, b], [l, t]]], &Pen::solid(BLACK, 0.7));
        canvas.text([r + 8.0, b - 2.0], &degree.to_string(), TICK_TEXT, TextAnchor::Start);
        at += 20.0;
    }
    canvas.disc([left + 15.0, at + 12.0], 3.0, BLACK);
    canvas.text([left + 38.0, at + 16.5], "points", TICK_TEXT, TextAnchor::Start);
    for (i, line) in wrap(&format!("figures: {x} × {y}"), TICK_TEXT, WIDTH - left - 10.0, 4).iter().enumerate() {
        canvas.text([left, at + 40.0 + 18.0 * i as f64], line, TICK_TEXT, TextAnchor::Start);
    }
    canvas.finish()
}

const WHITE: Color = Color::Rgb(255, 255, 255);
