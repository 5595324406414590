//! Panels below each other, each with curves, shaded intervals, bars and marked values, and a key above it.

use super::axes::{Axes, BELOW, TICK_TEXT};
use super::canvas::{BLACK, Canvas, Pen, Rect, Title, WIDTH, clip, text_width};
use super::contact::interval;
use super::graph::{Graph, Scale};
use super::markers::{colour, mark, pen};
use super::{Picture, PictureError};
use kuva::render::color::Color;
use kuva::render::render::TextAnchor;

const RIGHT: f64 = 30.0;

/// Height of a panel, of a row of its key, and space between two panels.
const PANEL: f64 = 210.0;
const ROW: f64 = 20.0;
const BETWEEN: f64 = 22.0;

/// Length of a sample in the key, and the space that an entry takes besides its text.
const SAMPLE: f64 = 36.0;
const BESIDE: f64 = 66.0;

/// A curve with at most this many points has a marker at each, a longer one at about `FEW`.
const MARKERS: usize = 40;
const FEW: usize = 12;

const SHADE: Color = Color::Rgb(198, 214, 229);
const BAR: Color = Color::Rgb(170, 190, 208);

/// The shape of a layer. Values that are not finite are left out.
#[derive(Debug, Clone)]
pub enum Shape {
    /// The area between two curves: `[x, lower, upper]` in the order of x.
    Between(Vec<[f64; 3]>),
    /// A curve through points, with the colour, dashes and markers of a number.
    Curve(Vec<[f64; 2]>, usize),
    /// Points with the marker of a number, not joined.
    Points(Vec<[f64; 2]>, usize),
    /// Bars from zero: `[left, right, height]`.
    Bars(Vec<[f64; 3]>),
    /// Lines across the panel at values of x, solid (0), dashed (1) or dotted (2).
    Across(Vec<f64>, usize),
}

/// A shape and its name in the key; no name, no entry.
#[derive(Debug, Clone)]
pub struct Layer {
    /// Name.
    pub name: String,
    /// Its shape.
    pub shape: Shape,
}

/// Ends of the y axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ends {
    /// All values and zero.
    Zero,
    /// All values.
    Values,
    /// All values on a logarithmic axis.
    Log,
    /// From 0 to 1.
    Unit,
}

/// One panel.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Name of x with its unit.
    pub x: String,
    /// Name of y with its unit.
    pub y: String,
    /// The y axis.
    pub ends: Ends,
    /// The layers. Areas and bars are drawn first, then the grid, then lines and points.
    pub layers: Vec<Layer>,
}

/// Draws the panels below each other under a title in at most three lines.
///
/// # Errors
/// [`PictureError::Raster`] if the pixels cannot be made.
pub fn panels(title: &str, panels: &[Panel]) -> Result<Picture, PictureError> {
    let title = Title::new(title);
    let mut top = 16.0 + title.height();
    let mut graphs = Vec::new();
    for p in panels {
        let rows = rows(&p.layers);
        let frame = Rect { left: 0.0, top: top + ROW * rows.len() as f64 + 8.0, width: 600.0, height: PANEL };
        graphs.push((p, rows, graph(p, frame)));
        top = frame.bottom() + BELOW + BETWEEN;
    }
    let left = graphs.iter().map(|(_, _, g)| g.left_margin()).fold(0.0, f64::max);
    let mut canvas = Canvas::new((top - BETWEEN + 10.0).max(200.0));
    canvas.title(&title, 34.0);
    for (panel, rows, mut graph) in graphs {
        (graph.axes.frame.left, graph.axes.frame.width) = (left, WIDTH - left - RIGHT);
        draw(&mut canvas, panel, &graph);
        for (i, row) in rows.iter().enumerate() {
            let y = graph.axes.frame.top - 10.0 - ROW * (rows.len() - 1 - i) as f64;
            let width: f64 = row.iter().map(|l| entry_width(l)).sum();
            let mut x = (WIDTH - RIGHT - width).max(10.0);
            for layer in row {
                sample(&mut canvas, &layer.shape, [x, y]);
                canvas.text([x + SAMPLE + 8.0, y], &layer.name, TICK_TEXT, TextAnchor::Start);
                x += entry_width(layer);
            }
        }
    }
    canvas.finish()
}

fn entry_width(layer: &Layer) -> f64 {
    BESIDE + text_width(&layer.name, TICK_TEXT)
}

/// The entries of the key in as few rows as possible.
fn rows(layers: &[Layer]) -> Vec<Vec<&Layer>> {
    let mut rows: Vec<Vec<&Layer>> = Vec::new();
    let mut room = 0.0;
    for layer in layers.iter().filter(|l| !l.name.is_empty()) {
        let width = entry_width(layer);
        match rows.last_mut() {
            Some(row) if width <= room => row.push(layer),
            _ => {
                rows.push(vec![layer]);
                room = WIDTH - 2.0 * RIGHT;
            }
        }
        room -= width;
    }
    rows
}

fn graph(panel: &Panel, frame: Rect) -> Graph {
    let shapes = || panel.layers.iter().map(|l| &l.shape);
    let x = shapes().flat_map(|s| -> Vec<f64> {
        match s {
            Shape::Between(v) => v.iter().map(|p| p[0]).collect(),
            Shape::Curve(v, _) | Shape::Points(v, _) => v.iter().map(|p| p[0]).collect(),
            Shape::Bars(v) => v.iter().flat_map(|p| [p[0], p[1]]).collect(),
            Shape::Across(v, _) => v.clone(),
        }
    });
    let y: Vec<f64> = shapes()
        .flat_map(|s| -> Vec<f64> {
            match s {
                Shape::Between(v) => v.iter().flat_map(|p| [p[1], p[2]]).collect(),
                Shape::Curve(v, _) | Shape::Points(v, _) => v.iter().map(|p| p[1]).collect(),
                Shape::Bars(v) => v.iter().map(|p| p[2]).collect(),
                Shape::Across(..) => Vec::new(),
            }
        })
        .collect();
    let (scale, ends) = match panel.ends {
        Ends::Zero => (Scale::Linear, interval(y.into_iter(), true)),
        Ends::Values => (Scale::Linear, margin(interval(y.into_iter(), false))),
        Ends::Log => (Scale::Log, Scale::Log.interval(y.into_iter().map(|v| Scale::Log.of(v)))),
        Ends::Unit => (Scale::Linear, [-0.03, 1.06]),
    };
    Graph { axes: Axes { frame, x: interval(x, false), y: ends }, x: Scale::Linear, y: scale }
}

fn margin([low, high]: [f64; 2]) -> [f64; 2] {
    let m = 0.05 * (high - low);
    [low - m, high + m]
}

fn draw(canvas: &mut Canvas, panel: &Panel, graph: &Graph) {
    let frame = graph.axes.frame;
    let at = |p: [f64; 2]| graph.axes.at([p[0], graph.y.of(p[1])]);
    let placed = |points: &[[f64; 2]]| points.iter().map(|&p| at(p)).collect::<Vec<_>>();
    let finite = |p: &[f64; 3]| p.iter().all(|v| v.is_finite());
    for layer in &panel.layers {
        match &layer.shape {
            Shape::Between(values) => {
                let strip = |w: &[[f64; 3]]| {
                    let [a, b] = [w[0], w[1]];
                    vec![at([a[0], a[1]]), at([b[0], b[1]]), at([b[0], b[2]]), at([a[0], a[2]])]
                };
                let strips: Vec<_> = values.windows(2).filter(|w| w.iter().all(finite)).map(strip).collect();
                canvas.fill(&strips, SHADE);
            }
            Shape::Bars(bars) => {
                let corners = |[l, r, h]: [f64; 3]| [[l, 0.0], [r, 0.0], [r, h], [l, h]].map(at).to_vec();
                canvas.fill(&bars.iter().filter(|b| finite(b)).map(|&b| corners(b)).collect::<Vec<_>>(), BAR);
            }
            _ => {}
        }
    }
    graph.draw(canvas, &panel.x, &panel.y);
    for layer in &panel.layers {
        match &layer.shape {
            Shape::Between(values) => {
                for side in [1, 2] {
                    let edge: Vec<_> = values.iter().map(|v| at([v[0], v[side]])).collect();
                    canvas.lines(&clip(&edge, frame), &edge_pen());
                }
            }
            Shape::Bars(bars) => {
                let outline = |[l, r, h]: [f64; 3]| [[l, 0.0], [l, h], [r, h], [r, 0.0]].map(at).to_vec();
                let outlines: Vec<_> = bars.iter().filter(|b| finite(b)).map(|&b| outline(b)).collect();
                canvas.lines(&outlines, &edge_pen());
            }
            Shape::Curve(points, number) => {
                let line = placed(points);
                canvas.lines(&clip(&line, frame), &curve_pen(*number));
                let step = if line.len() <= MARKERS { 1 } else { line.len().div_ceil(FEW) };
                // markers of different curves do not coincide
                marks(canvas, line.into_iter().skip((step * number / 7) % step).step_by(step), *number);
            }
            Shape::Points(points, number) => marks(canvas, placed(points).into_iter(), *number),
            Shape::Across(values, style) => {
                let ends = |x: f64| [x; 2].map(|x| graph.axes.at([x, 0.0])[0]);
                let lines = values.iter().map(|&x| ends(x)).filter(|p| p[0].is_finite());
                let lines: Vec<_> = lines.map(|[a, b]| vec![[a, frame.bottom()], [b, frame.top]]).collect();
                canvas.lines(&lines, &across_pen(*style));
            }
        }
    }
}

fn marks(canvas: &mut Canvas, points: impl Iterator<Item = [f64; 2]>, number: usize) {
    points
        .filter(|p| p[0].is_finite() && p[1].is_finite())
        .for_each(|p| mark(canvas, number, p, 3.4, colour(number), false));
}

fn edge_pen() -> Pen {
    Pen::solid(Color::Rgb(90, 120, 150), 0.9)
}

fn curve_pen(number: usize) -> Pen {
    pen(colour(number), number % 4)
}

fn across_pen(style: usize) -> Pen {
    Pen { width: 1.8, ..pen(BLACK, style) }
}

/// Draws the sample of a shape in the key; y is the base line of its text.
fn sample(canvas: &mut Canvas, shape: &Shape, [x, y]: [f64; 2]) {
    let line = vec![[x, y - 4.5], [x + SAMPLE, y - 4.5]];
    let (l, r, t, b) = (x, x + SAMPLE, y - 11.0, y + 2.0);
    let area = vec![[l, b], [r, b], [r, t], [l, t]];
    match shape {
        Shape::Between(_) => {
            canvas.fill(&[area], SHADE);
            canvas.lines(&[vec![[l, b], [r, b]], vec![[l, t], [r, t]]], &edge_pen());
        }
        Shape::Bars(_) => {
            canvas.fill(std::slice::from_ref(&area), BAR);
            canvas.lines(&[area], &edge_pen());
        }
        Shape::Curve(_, number) => {
            canvas.lines(&[line], &curve_pen(*number));
            marks(canvas, [[x + SAMPLE / 2.0, y - 4.5]].into_iter(), *number);
        }
        Shape::Points(_, number) => marks(canvas, [[x + SAMPLE / 2.0, y - 4.5]].into_iter(), *number),
        Shape::Across(_, style) => canvas.lines(&[line], &across_pen(*style)),
    }
}
