//! Boundary meshes with their degrees, several steps of a refinement in one figure.

use super::axes::TICK_TEXT;
use super::bands::{BANDS, colour};
use super::canvas::{BLACK, Canvas, Pen, Rect, Title, WIDTH, text_width, wrap};
use super::guides::misses;
use super::strips::{STRIP, Side, Strips, sides};
use super::{Picture, PictureError};
use kuva::render::color::Color;
use kuva::render::render::TextAnchor;
use std::collections::BTreeSet;

const CAPTION_TEXT: u32 = 14;
const NUMBER_TEXT: u32 = 12;

/// Space between the figure and the edge of the picture.
const EDGE: f64 = 20.0;

/// Height of a caption in two lines, and space below a panel.
const CAPTION: f64 = 42.0;
const BELOW: f64 = 24.0;

/// Width of a body beside strips, and left end of the strips.
const BESIDE: f64 = 232.0;
const STRIPS: f64 = 312.0;

/// Space around a body for the numbers at its elements.
const AROUND: f64 = 26.0;

/// Width of the coloured line.
const LINE: f64 = 5.0;

/// Half the length of the tick at a vertex, and the smallest distance between two ticks.
const TICK: f64 = 7.5;
const TICKS_APART: f64 = 3.0;

/// An element shorter than this has no number.
const NUMBERED: f64 = 18.0;

/// Size of a box of the key.
const BOX: [f64; 2] = [30.0, 14.0];

/// One mesh of N elements. Elements follow each other along each loop with the body on their left.
#[derive(Debug, Clone, Copy)]
pub struct MeshPanel<'a> {
    /// Text above the mesh, in at most two lines, for instance "step 5: 45 elements, 282 dofs".
    pub caption: &'a str,
    /// End points (N). An element with a coordinate that is not finite is left out.
    pub elements: &'a [[[f64; 2]; 2]],
    /// Polynomial degrees (N).
    pub degree: &'a [usize],
    /// Numbers of the named sides (N).
    pub side: &'a [usize],
}

/// Meshes of one body, with one key of the degrees.
#[derive(Debug, Clone, Copy)]
pub struct MeshFigure<'a> {
    /// Title, broken into at most three lines.
    pub title: &'a str,
    /// Names of the sides.
    pub side_names: &'a [String],
    /// The meshes, in reading order.
    pub panels: &'a [MeshPanel<'a>],
}

/// Draws each mesh as the outline of the body, a tick at each vertex and the elements coloured by degree (the darker,
/// the higher), with the degree in figures at elements that are long enough.
///
/// Sides that have an element shorter than 2 % of them in one of the meshes (at most eight of them, the most refined
/// ones) are drawn again beside each body, with elements of equal width: the degrees as bars upwards, the lengths as
/// bars downwards on a logarithmic axis. Linear elements have lengths alone. Meshes without such sides are in rows of
/// up to three.
///
/// # Errors
/// [`PictureError::Raster`] if the pixels cannot be made.
///
/// # Panics
/// If the numbers of elements, degrees and sides differ or a side has no name.
pub fn meshes(figure: &MeshFigure<'_>) -> Result<Picture, PictureError> {
    for p in figure.panels {
        let n = p.elements.len();
        assert!(p.degree.len() == n && p.side.len() == n, "one degree and one side an element");
        assert!(p.side.iter().all(|&s| s < figure.side_names.len()), "a name for each side");
    }
    let (graded, hidden) = sides(figure.panels);
    let degrees: BTreeSet<usize> = figure.panels.iter().flat_map(|p| p.degree).copied().collect();
    let shades = Shades::of(&degrees);

    let title = Title::new(figure.title);
    let top = 26.0 + title.height();
    let cells = cells(figure.panels, !graded.is_empty(), top);
    let below = cells.iter().map(|c| c.bottom() + BELOW).fold(top, f64::max);
    let per_row = ((WIDTH - 2.0 * EDGE - 80.0) / BOX[0]) as usize;
    let key_height = 40.0 * degrees.len().div_ceil(per_row) as f64;
    let notes: Vec<String> = notes(&graded, hidden, degrees.last() > Some(&1))
        .iter()
        .flat_map(|n| wrap(n, TICK_TEXT, WIDTH - 60.0, 3))
        .collect();
    let mut canvas = Canvas::new((below + key_height + 18.0 * notes.len() as f64 + 16.0).max(200.0));
    canvas.title(&title, 34.0);
    let strips = Strips::new(figure.panels, &graded, figure.side_names);
    for (panel, cell) in figure.panels.iter().zip(&cells) {
        // Beside strips there is more room for the caption than for the body.
        let room = if graded.is_empty() { cell.width } else { STRIPS - EDGE - 10.0 };
        for (i, line) in wrap(panel.caption, CAPTION_TEXT, room, 2).iter().enumerate() {
            let at = [cell.left, cell.top - CAPTION + 15.0 + 18.0 * i as f64];
            canvas.text(at, line, CAPTION_TEXT, TextAnchor::Start);
        }
        let named: Vec<_> = graded.iter().map(|&s| (s, figure.side_names[s].as_str())).collect();
        body(&mut canvas, *cell, panel, &shades, &named);
        if !graded.is_empty() {
            strips.draw(&mut canvas, [STRIPS, WIDTH - EDGE], cell.top, panel, &shades);
        }
    }
    key(&mut canvas, below, &degrees, per_row, &shades);
    for (i, note) in notes.iter().enumerate() {
        let at = [WIDTH / 2.0, below + key_height + 8.0 + 18.0 * i as f64];
        canvas.text(at, note, TICK_TEXT, TextAnchor::Middle);
    }
    canvas.finish()
}

fn notes(graded: &[Side], hidden: usize, degrees: bool) -> Vec<String> {
    let mut notes = Vec::new();
    if !graded.is_empty() {
        let what = if degrees { "degrees above, lengths below" } else { "their lengths" };
        notes.push(format!("Bars: the elements of a side in order, with the body on the left; {what}."));
    }
    if hidden > 0 {
        notes.push(format!("{hidden} more sides with elements under 2 % of their length are not drawn as bars."));
    }
    notes
}

/// Colours of the degrees.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shades {
    low: usize,
    high: usize,
}

impl Shades {
    /// For the degrees of a picture.
    pub fn of(degrees: &BTreeSet<usize>) -> Self {
        Self { low: degrees.first().copied().unwrap_or(1), high: degrees.last().copied().unwrap_or(1) }
    }

    /// Bright for the lowest degree, dark for the highest.
    pub fn colour(&self, degree: usize) -> Color {
        let range = (self.high - self.low).max(1) as f64;
        let share = (degree - self.low) as f64 / range;
        colour(((BANDS - 1) as f64 * (1.0 - share)).round() as usize)
    }
}

/// The rectangles in which the bodies are drawn: in a column beside strips, or in rows.
fn cells(panels: &[MeshPanel<'_>], strips: bool, top: f64) -> Vec<Rect> {
    let n = panels.len();
    if strips {
        let cell = |i: usize| Rect {
            left: EDGE,
            top: top + CAPTION + i as f64 * (CAPTION + STRIP + BELOW),
            width: BESIDE,
            height: STRIP,
        };
        return (0..n).map(cell).collect();
    }
    let columns = match n {
        0 | 1 => 1,
        2 | 4 => 2,
        _ => 3,
    };
    let width = (WIDTH - 2.0 * EDGE) / columns as f64 - 10.0;
    let flatness = panels.iter().filter_map(|p| extent(p)).map(|(_, e)| e[1] / e[0]).fold(0.0, f64::max);
    let height =
        (flatness * (width - 2.0 * AROUND) + 2.0 * AROUND).clamp(100.0, if columns == 1 { 560.0 } else { 300.0 });
    let cell = |i: usize| Rect {
        left: EDGE + 5.0 + (i % columns) as f64 * (width + 10.0),
        top: top + CAPTION + (i / columns) as f64 * (CAPTION + height + BELOW),
        width,
        height,
    };
    (0..n).map(cell).collect()
}

/// Lower left corner and size of the box around a mesh; None if it has no size.
fn extent(panel: &MeshPanel<'_>) -> Option<([f64; 2], [f64; 2])> {
    let start = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let points = panel.elements.iter().filter(|e| finite(e)).flatten();
    let (low, high) =
        points.fold(start, |(l, h), p| ([l[0].min(p[0]), l[1].min(p[1])], [h[0].max(p[0]), h[1].max(p[1])]));
    let size = [high[0] - low[0], high[1] - low[1]];
    let usable = size.iter().all(|s| s.is_finite()) && size[0].max(size[1]) > 0.0;
    usable.then_some((low, size))
}

/// Whether all coordinates of an element are finite.
pub(super) fn finite(element: &[[f64; 2]; 2]) -> bool {
    element.iter().flatten().all(|v| v.is_finite())
}

/// One mesh with equal scales in x and y, centred in its cell, with the names of the sides given by number.
fn body(canvas: &mut Canvas, cell: Rect, panel: &MeshPanel<'_>, shades: &Shades, named: &[(usize, &str)]) {
    let Some((low, size)) = extent(panel) else { return };
    let scale = ((cell.width - 2.0 * AROUND) / size[0]).min((cell.height - 2.0 * AROUND) / size[1]);
    let centre = [cell.left + cell.width / 2.0, cell.top + cell.height / 2.0];
    let at = |p: [f64; 2]| {
        [centre[0] + scale * (p[0] - low[0] - size[0] / 2.0), centre[1] - scale * (p[1] - low[1] - size[1] / 2.0)]
    };
    let drawn: Vec<usize> = (0..panel.elements.len()).filter(|&i| finite(&panel.elements[i])).collect();
    let lines: Vec<Vec<[f64; 2]>> = drawn.iter().map(|&i| panel.elements[i].map(at).to_vec()).collect();
    canvas.lines(&joined(&lines), &Pen::solid(BLACK, LINE + 2.4));
    for (line, &i) in lines.iter().zip(&drawn) {
        canvas.fill(&[thick(line)], shades.colour(panel.degree[i]));
    }
    canvas.lines(&vertices(&lines), &Pen::solid(BLACK, 1.3));

    // Numbers outside, then names inside; a text that would cover another is left out.
    let mut taken: Vec<Rect> = Vec::new();
    let mut write = |canvas: &mut Canvas, [x, y]: [f64; 2], text: &str, size: u32| {
        let width = 0.9 * text_width(text, size);
        let area = Rect { left: x - width / 2.0, top: y - 6.0, width, height: 12.0 };
        let apart =
            |o: &Rect| area.left > o.right() || o.left > area.right() || area.top > o.bottom() || o.top > area.bottom();
        let inside = area.left >= cell.left && area.right() <= cell.right();
        if inside && taken.iter().all(apart) && lines.iter().all(|l| misses(l, area)) {
            canvas.text([x, y + 4.5], text, size, TextAnchor::Middle);
            taken.push(area);
        }
    };
    for (line, &i) in lines.iter().zip(&drawn) {
        let (middle, [nx, ny], length) = frame_of(line);
        if length >= NUMBERED {
            let number = panel.degree[i].to_string();
            write(canvas, [middle[0] + 15.0 * nx, middle[1] + 14.0 * ny], &number, NUMBER_TEXT);
        }
    }
    for &(side, name) in named {
        let on: Vec<&Vec<[f64; 2]>> =
            lines.iter().zip(&drawn).filter(|(_, i)| panel.side[**i] == side).map(|l| l.0).collect();
        if let Some(([x, y], [nx, ny])) = half_way(&on) {
            let inwards = nx.abs() * text_width(name, TICK_TEXT) / 2.0 + ny.abs() * 8.0 + 12.0;
            write(canvas, [x - inwards * nx, y - inwards * ny], name, TICK_TEXT);
        }
    }
}

/// Point half-way along some elements, and the outer normal there.
fn half_way(lines: &[&Vec<[f64; 2]>]) -> Option<([f64; 2], [f64; 2])> {
    let mut rest = lines.iter().map(|l| frame_of(l).2).sum::<f64>() / 2.0;
    for line in lines {
        let (_, normal, length) = frame_of(line);
        if length > 0.0 && rest <= length {
            let s = rest / length;
            return Some(([0, 1].map(|i| line[0][i] + s * (line[1][i] - line[0][i])), normal));
        }
        rest -= length;
    }
    None
}

/// The rectangle of an element with blunt ends, so that short elements keep their length.
fn thick(line: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let (_, n, _) = frame_of(line);
    let off = |p: [f64; 2], s: f64| [p[0] + s * LINE / 2.0 * n[0], p[1] + s * LINE / 2.0 * n[1]];
    vec![off(line[0], 1.0), off(line[1], 1.0), off(line[1], -1.0), off(line[0], -1.0)]
}

/// Middle, outer normal and length of an element in the picture (y downwards, body on the left); a point has no normal.
fn frame_of(line: &[[f64; 2]]) -> ([f64; 2], [f64; 2], f64) {
    let (a, b) = (line[0], line[1]);
    let d = [b[0] - a[0], b[1] - a[1]];
    let length = d[0].hypot(d[1]);
    let normal = if length > 0.0 { [-d[1] / length, d[0] / length] } else { [0.0, 0.0] };
    ([(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0], normal, length)
}

/// Runs of connected elements.
fn runs(lines: &[Vec<[f64; 2]>]) -> impl Iterator<Item = &[Vec<[f64; 2]>]> {
    lines.chunk_by(|a, b| a[1] == b[0])
}

/// Whether the last element of a run ends where the first begins.
fn closed(run: &[Vec<[f64; 2]>]) -> bool {
    run.len() > 1 && run[run.len() - 1][1] == run[0][0]
}

/// Each run as one line; a closed one goes on to its second point, which joins its ends.
fn joined(lines: &[Vec<[f64; 2]>]) -> Vec<Vec<[f64; 2]>> {
    let join = |run: &[Vec<[f64; 2]>]| {
        let again = closed(run).then_some(run[0][1]);
        std::iter::once(run[0][0]).chain(run.iter().map(|l| l[1])).chain(again).collect()
    };
    runs(lines).map(join).collect()
}

/// A tick across the line at each vertex, along the mean of the two normals. Ticks that would be too close to their
/// neighbours are left out.
fn vertices(lines: &[Vec<[f64; 2]>]) -> Vec<Vec<[f64; 2]>> {
    let distance = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
    let mut ticks = Vec::new();
    for run in runs(lines) {
        let around = closed(run);
        let first = run[0][0];
        let before = if around { &run[run.len() - 1] } else { &run[0] };
        let starts = run.iter().zip(std::iter::once(before).chain(run)).map(|(l, m)| (l[0], l, m));
        let last = &run[run.len() - 1];
        let end = (!around).then_some((last[1], last, last));
        let mut drawn: Option<[f64; 2]> = None;
        for (p, one, other) in starts.chain(end) {
            let near = |q: Option<[f64; 2]>| q.is_some_and(|q| distance(p, q) < TICKS_APART);
            if near(drawn) || around && near(drawn.and(Some(first))) {
                continue;
            }
            let (a, b) = (frame_of(one).1, frame_of(other).1);
            let sum = [a[0] + b[0], a[1] + b[1]];
            let length = sum[0].hypot(sum[1]);
            // Where the line turns back on itself there is no mean.
            let n = if length > 1e-6 { sum.map(|v| v / length) } else { a };
            ticks.push([-1.0, 1.0].map(|s| [p[0] + s * TICK * n[0], p[1] + s * TICK * n[1]]).to_vec());
            drawn = Some(p);
        }
    }
    ticks
}

/// The degrees with their colours, in rows.
fn key(canvas: &mut Canvas, top: f64, degrees: &BTreeSet<usize>, per_row: usize, shades: &Shades) {
    let all: Vec<usize> = degrees.iter().copied().collect();
    for (row, some) in all.chunks(per_row.max(1)).enumerate() {
        let label = text_width("degree", TICK_TEXT) + 8.0;
        let mut x = (WIDTH - label - BOX[0] * some.len() as f64) / 2.0;
        let y = top + 40.0 * row as f64;
        canvas.text([x, y + 12.0], "degree", TICK_TEXT, TextAnchor::Start);
        x += label;
        for &degree in some {
            let [l, r, t, b] = [x, x + BOX[0], y, y + BOX[1]];
            canvas.fill(&[vec![[l, t], [r, t], [r, b], [l, b]]], shades.colour(degree));
            canvas.lines(&[vec![[l, t], [r, t], [r, b], [l, b], [l, t], [r, t]]], &Pen::solid(BLACK, 0.8));
            canvas.text([x + BOX[0] / 2.0, b + 14.0], &degree.to_string(), NUMBER_TEXT, TextAnchor::Middle);
            x += BOX[0];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lightness(c: &Color) -> f64 {
        match c {
            Color::Rgb(r, g, b) => 0.2126 * f64::from(*r) + 0.7152 * f64::from(*g) + 0.0722 * f64::from(*b),
            other => panic!("not a plain colour: {other:?}"),
        }
    }

    #[test]
    fn higher_degrees_are_darker() {
        let shades = Shades::of(&(1..=12).collect());
        let all: Vec<f64> = (1..=12).map(|p| lightness(&shades.colour(p))).collect();
        assert!(all.windows(2).all(|w| w[0] > w[1] + 3.0), "{all:?}");
        // A single degree and none.
        let _ = (Shades::of(&BTreeSet::from([7])).colour(7), Shades::of(&BTreeSet::new()));
    }

    #[test]
    fn normals_point_out_of_the_body() {
        // Bottom side of a square in the picture: to the right, body above (smaller y), outside below.
        assert_eq!(frame_of(&[[0.0, 5.0], [2.0, 5.0]]), ([1.0, 5.0], [0.0, 1.0], 2.0));
        assert_eq!(frame_of(&[[1.0, 1.0]; 2]).1, [0.0, 0.0]);
    }

    #[test]
    fn ticks_keep_their_distance_and_loops_are_closed() {
        let square = [[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]];
        let mut lines: Vec<Vec<[f64; 2]>> = (0..4).map(|i| vec![square[i], square[(i + 1) % 4]]).collect();
        let ticks = vertices(&lines);
        assert_eq!(ticks.len(), 4);
        // At a corner the tick halves the angle.
        let along = [ticks[1][1][0] - ticks[1][0][0], ticks[1][1][1] - ticks[1][0][1]];
        assert!((along[0].abs() - along[1].abs()).abs() < 1e-12 && along[0].abs() > TICK);
        assert_eq!(joined(&lines), [[&square[..], &square[..2]].concat()]);
        assert_eq!(joined(&lines[..2]), [square[..3].to_vec()]);
        assert_eq!(vertices(&lines[..2]).len(), 3);
        assert_eq!(half_way(&[&lines[0], &lines[1]]).unwrap().0, [100.0, 0.0]);
        // A geometric mesh towards one end: 40 layers, but few of them are wide enough for a tick.
        let mut ends: Vec<f64> = (0..40).map(|k| 100.0 * 0.5f64.powi(k)).chain([0.0]).collect();
        ends.reverse();
        lines = ends.windows(2).map(|w| vec![[w[0], 0.0], [w[1], 0.0]]).collect();
        let at: Vec<f64> = vertices(&lines).iter().map(|t| (t[0][0] + t[1][0]) / 2.0).collect();
        assert!(at.windows(2).all(|w| w[1] - w[0] >= TICKS_APART) && at.len() > 5, "{at:?}");
        assert!(at.contains(&100.0) && at.contains(&0.0));
    }
}
