//! Curves of several strategies over their cost: convergence (logarithmic) and effectivity (linear, with a band).

use super::axes::{Axes, BELOW, TICK_TEXT};
use super::canvas::{BLACK, Canvas, Pen, Rect, Title, WIDTH, clip, text_width, wrap};
use super::graph::{Graph, Scale};
use super::guides::{Slope, place};
use super::markers::{around, colour, mark, pen};
use super::{Picture, PictureError};
use kuva::render::color::Color;
use kuva::render::render::TextAnchor;

const PLOT: f64 = 430.0;

/// Height of a line of the key and of a note, and the widest text of the key.
const LINE: f64 = 18.0;
const KEY_TEXT: f64 = 200.0;

/// Length of a sample line in the key.
const SAMPLE: f64 = 40.0;

/// A linear axis with a band ends at this many times the upper end of the band.
const VIEW: f64 = 4.0;

/// Points closer to each other than `ONE` count as one; dashes over another curve repeat after the length `PERIOD`.
const ONE: f64 = 3.0;
const PERIOD: f64 = 16.0;

/// An axis: its label and its scale.
#[derive(Debug, Clone, Copy)]
pub struct Axis<'a> {
    /// Name with unit, for instance "degrees of freedom" or "time in s".
    pub label: &'a str,
    /// Scale of the axis.
    pub scale: Scale,
}

/// One quantity of one strategy at N points.
#[derive(Debug, Clone, Copy)]
pub struct Curve<'a> {
    /// Points (x, y) (N), joined in this order. A point that the scales cannot show (not finite, or not positive on a
    /// logarithmic axis) is left out and breaks the curve.
    pub points: &'a [[f64; 2]],
    /// Whether each point has an open marker (N); empty if none has.
    pub flagged: &'a [bool],
}

/// One strategy.
#[derive(Debug, Clone, Copy)]
pub struct Series<'a> {
    /// Name in the key.
    pub name: &'a str,
    /// One curve for each quantity of the chart, or fewer.
    pub curves: &'a [Curve<'a>],
}

/// A slope to compare with, drawn as a triangle where no curve is.
#[derive(Debug, Clone, Copy)]
pub struct Guide<'a> {
    /// Label of the slope, for instance "N^-1.5".
    pub label: &'a str,
    /// dη/dξ with ξ = ln x, √x or x on a logarithmic, square-root or linear x axis, and η = ln y, √y or y.
    pub slope: f64,
}

/// A shaded interval of y.
#[derive(Debug, Clone, Copy)]
pub struct Band<'a> {
    /// Name in the key.
    pub label: &'a str,
    /// Lower and upper end.
    pub y: [f64; 2],
}

/// Everything that a chart shows.
#[derive(Debug, Clone, Copy)]
pub struct Chart<'a> {
    /// Title, broken into at most three lines.
    pub title: &'a str,
    /// The cost.
    pub x: Axis<'a>,
    /// The error, or another measured quantity.
    pub y: Axis<'a>,
    /// Names of the quantities: the first has solid lines, the others dashes and smaller markers. Not in the key if
    /// there is only one.
    pub quantities: &'a [&'a str],
    /// The strategies, each with a colour and a marker of its own.
    pub series: &'a [Series<'a>],
    /// Meaning of an open marker, for instance "not reliable"; it is in the key if there is an open marker.
    pub flag: &'a str,
    /// Slopes to compare with.
    pub guides: &'a [Guide<'a>],
    /// A shaded interval of y.
    pub band: Option<Band<'a>>,
}

/// Draws the curves, with the key right of the frame.
///
/// A curve whose points all coincide with points of an earlier curve is drawn as dashes on top of it, with larger
/// markers around its markers. A linear y axis contains zero; if there is a band too, it ends at four times the band's
/// upper end, and a note below says how many points lie above. Other notes say how many points the scales cannot show,
/// and which slopes found no room.
///
/// # Errors
/// [`PictureError::Raster`] if the pixels cannot be made.
///
/// # Panics
/// If a curve has flags but not as many as points, or a strategy has more curves than there are quantities.
pub fn chart(c: &Chart<'_>) -> Result<Picture, PictureError> {
    for s in c.series {
        assert!(s.curves.len() <= c.quantities.len(), "as many quantities as curves");
        let complete = |k: &Curve<'_>| k.flagged.is_empty() || k.flagged.len() == k.points.len();
        assert!(s.curves.iter().all(complete), "one flag a point, or none");
    }
    let curves = || c.series.iter().enumerate().flat_map(|(k, s)| s.curves.iter().enumerate().map(move |q| (k, q)));
    let coordinates = |p: &[f64; 2]| [c.x.scale.of(p[0]), c.y.scale.of(p[1])];
    let shown = |p: &[f64; 2]| p.iter().all(|v| v.is_finite());
    let points: Vec<[f64; 2]> = curves().flat_map(|(_, (_, k))| k.points).map(coordinates).collect();
    let band = c.band.map(|b| b.y.map(|v| c.y.scale.of(v))).filter(shown);

    let x = c.x.scale.interval(points.iter().filter(|p| shown(p)).map(|p| p[0]));
    let highest = match band {
        Some(b) if c.y.scale == Scale::Linear => VIEW * b[1],
        _ => f64::INFINITY,
    };
    let y_values = points.iter().filter(|p| shown(p)).map(|p| p[1].min(highest));
    let y = c.y.scale.interval(y_values.chain(band.into_iter().flatten()));

    let title = Title::new(c.title);
    let top = 30.0 + title.height();
    let key = key(c);
    let key_width = key.iter().flat_map(|e| &e.text).map(|t| text_width(t, TICK_TEXT)).fold(0.0, f64::max);
    let key_height: f64 = key.iter().map(Entry::height).sum();
    let frame = Rect { left: 0.0, top, width: 500.0, height: PLOT.max(key_height) };
    let mut graph = Graph { axes: Axes { frame, x, y }, x: c.x.scale, y: c.y.scale };
    let left = graph.left_margin();
    let right = if key.is_empty() { 30.0 } else { SAMPLE + 44.0 + key_width };
    (graph.axes.frame.left, graph.axes.frame.width) = (left, WIDTH - left - right);
    let frame = graph.axes.frame;

    let placed = |k: &Curve<'_>| -> Vec<[f64; 2]> { k.points.iter().map(|p| graph.axes.at(coordinates(p))).collect() };
    let lines: Vec<Vec<[f64; 2]>> = curves().map(|(_, (_, k))| placed(k)).collect();
    let (slopes, homeless) = slopes(c.guides, &graph, &lines);

    let missing = points.iter().filter(|p| !shown(p)).count();
    let above = points.iter().filter(|p| shown(p) && p[1] > y[1]).count();
    let notes: Vec<String> =
        notes(missing, above, &homeless).iter().flat_map(|n| wrap(n, TICK_TEXT, WIDTH - 60.0, 3)).collect();
    let mut canvas = Canvas::new(frame.bottom() + BELOW + 12.0 + LINE * notes.len() as f64);
    canvas.title(&title, 34.0);
    if let Some(b) = band {
        canvas.fill(&[shade(&graph, b)], BAND);
    }
    graph.draw(&mut canvas, &axis_title(&c.x), &axis_title(&c.y));
    for s in &slopes {
        s.draw(&mut canvas);
    }
    for (c, ((k, (j, curve)), line)) in curves().zip(&lines).enumerate() {
        let beneath = lines[..c].iter().filter(|earlier| is_on(line, earlier)).count();
        let pen = if beneath == 0 { pen(colour(k), j) } else { on_top(colour(k), beneath) };
        canvas.lines(&clip(line, frame), &pen);
        for (i, &p) in line.iter().enumerate().filter(|(_, p)| shown(p) && p[1] >= frame.top) {
            let open = curve.flagged.get(i).copied().unwrap_or(false);
            // an outline around the marker beneath; a flagged point has an open marker there too
            if beneath == 0 || open {
                mark(&mut canvas, k, p, radius(j), colour(k), open);
            }
            if beneath > 0 {
                around(&mut canvas, k, p, (1.0 + 0.7 * beneath as f64) * radius(j), colour(k));
            }
        }
    }
    let mut y = frame.top + 12.0;
    for entry in &key {
        entry.draw(&mut canvas, [frame.right() + 18.0, y]);
        y += entry.height();
    }
    for (i, note) in notes.iter().enumerate() {
        let at = [30.0, frame.bottom() + BELOW + 16.0 + LINE * i as f64];
        canvas.text(at, note, TICK_TEXT, TextAnchor::Start);
    }
    canvas.finish()
}

const BAND: Color = Color::Rgb(205, 218, 205);

fn radius(quantity: usize) -> f64 {
    if quantity == 0 { 4.2 } else { 2.9 }
}

/// Whether each shown point of a line is also a point of another line.
fn is_on(line: &[[f64; 2]], other: &[[f64; 2]]) -> bool {
    let near = |p: &[f64; 2], q: &[f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]) < ONE;
    let mut shown = line.iter().filter(|p| p.iter().all(|v| v.is_finite())).peekable();
    shown.peek().is_some() && shown.all(|p| other.iter().any(|q| near(p, q)))
}

/// Dashes that leave the curves beneath visible; `beneath` is their number.
fn on_top(colour: Color, beneath: usize) -> Pen {
    let dash = PERIOD * 0.5f64.powi(beneath.min(3) as i32);
    Pen::dashed(colour, 2.0, dash, PERIOD - dash)
}

fn axis_title(axis: &Axis<'_>) -> String {
    let scale = if axis.scale == Scale::SquareRoot { " (square-root scale)" } else { "" };
    format!("{}{scale}", axis.label)
}

/// The part of the frame between two values of y.
fn shade(graph: &Graph, [low, high]: [f64; 2]) -> Vec<[f64; 2]> {
    let [left, right] = graph.axes.x;
    [[left, low], [right, low], [right, high], [left, high]].map(|p| graph.axes.at(p)).to_vec()
}

/// The triangles of the slopes, and the labels of those that found no place.
fn slopes<'a>(guides: &[Guide<'a>], graph: &Graph, lines: &[Vec<[f64; 2]>]) -> (Vec<Slope<'a>>, Vec<&'a str>) {
    let (f, axes) = (graph.axes.frame, &graph.axes);
    // Coordinates are decimal logarithms; slopes refer to natural logarithms.
    let unit = |s: Scale| if s == Scale::Log { std::f64::consts::LN_10 } else { 1.0 };
    let pixels_x = f.width / (axes.x[1] - axes.x[0]) / unit(graph.x);
    let pixels_y = f.height / (axes.y[1] - axes.y[0]) / unit(graph.y);
    let (mut found, mut homeless) = (Vec::new(), Vec::new());
    for g in guides {
        match place(g.label, g.slope * pixels_y / pixels_x, f, lines, &found) {
            Some(s) => found.push(s),
            None => homeless.push(g.label),
        }
    }
    (found, homeless)
}

fn notes(missing: usize, above: usize, homeless: &[&str]) -> Vec<String> {
    let count =
        |n: usize, one: &str, many: &str| if n == 1 { format!("1 point {one}") } else { format!("{n} points {many}") };
    let mut notes = Vec::new();
    if missing > 0 {
        notes.push(format!(
            "{} (not finite, or not positive on a logarithmic axis).",
            count(missing, "is left out", "are left out")
        ));
    }
    if above > 0 {
        notes.push(format!("{} above the frame.", count(above, "lies", "lie")));
    }
    if !homeless.is_empty() {
        notes.push(format!("No room for the slope {}.", homeless.join(", ")));
    }
    notes
}

#[derive(Debug, Clone, Copy)]
enum Sample {
    Series(usize),
    Quantity(usize),
    Open,
    Band,
}

/// A sample and its name, in at most two lines.
struct Entry {
    sample: Sample,
    text: Vec<String>,
}

impl Entry {
    fn height(&self) -> f64 {
        LINE * self.text.len().max(1) as f64 + 4.0
    }

    fn draw(&self, canvas: &mut Canvas, [x, y]: [f64; 2]) {
        let (ends, middle) = ([[x, y - 4.5], [x + SAMPLE, y - 4.5]], [x + SAMPLE / 2.0, y - 4.5]);
        match self.sample {
            Sample::Series(k) => {
                canvas.lines(&[ends.to_vec()], &pen(colour(k), 0));
                mark(canvas, k, middle, radius(0), colour(k), false);
            }
            Sample::Quantity(j) => canvas.lines(&[ends.to_vec()], &pen(BLACK, j)),
            Sample::Open => mark(canvas, 0, middle, radius(0), BLACK, true),
            Sample::Band => {
                let [l, r, t, b] = [x, x + SAMPLE, y - 11.0, y + 2.0];
                canvas.fill(&[vec![[l, t], [r, t], [r, b], [l, b]]], BAND);
            }
        }
        for (i, line) in self.text.iter().enumerate() {
            canvas.text([x + SAMPLE + 8.0, y + LINE * i as f64], line, TICK_TEXT, TextAnchor::Start);
        }
    }
}

fn key(c: &Chart<'_>) -> Vec<Entry> {
    let mut entries = Vec::new();
    let mut add = |sample, name: &str| entries.push(Entry { sample, text: wrap(name, TICK_TEXT, KEY_TEXT, 2) });
    for (k, s) in c.series.iter().enumerate() {
        add(Sample::Series(k), s.name);
    }
    if c.quantities.len() > 1 {
        c.quantities.iter().enumerate().for_each(|(j, name)| add(Sample::Quantity(j), name));
    }
    if c.series.iter().flat_map(|s| s.curves).any(|k| k.flagged.contains(&true)) {
        add(Sample::Open, c.flag);
    }
    if let Some(band) = c.band {
        add(Sample::Band, band.label);
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_on_another_one_leaves_it_visible() {
        let points = [[10.0, 1.0], [100.0, 0.1], [1000.0, 0.01]];
        let off = points.map(|[x, y]| [x, 0.3 * y]);
        let strokes = |second: &[[f64; 2]]| {
            let curves = [&points[..], second].map(|points| [Curve { points, flagged: &[] }]);
            let series = [Series { name: "a", curves: &curves[0] }, Series { name: "b", curves: &curves[1] }];
            let axis = Axis { label: "", scale: Scale::Log };
            let bare = Chart {
                title: "",
                x: axis,
                y: axis,
                quantities: &["error"],
                series: &series,
                flag: "",
                guides: &[],
                band: None,
            };
            let svg = chart(&bare).unwrap().svg;
            let widest = |path: &&str| path.contains("#cc5500") && path.contains('M');
            svg.split("<path").filter(widest).map(|path| path.matches('M').count()).max().unwrap()
        };
        // one stroke, or many dashes
        assert_eq!(strokes(&off), 1);
        assert!(strokes(&points) > 10);
        assert!(strokes(&points[..2]) > 5, "part of it");
    }
}
