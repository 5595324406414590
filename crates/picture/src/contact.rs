//! Pressure and shear along a contact side, in two panels over one axis.

use super::axes::{Axes, BELOW, TICK_TEXT};
use super::bands;
use super::canvas::{BLACK, Canvas, GREY, Pen, Rect, Title, WIDTH, clip, text_width};
use super::scale::short;
use super::{Picture, PictureError, in_unit};
use kuva::render::color::Color;
use kuva::render::render::TextAnchor;

const KEY: f64 = 30.0;
const PANEL: f64 = 230.0;
const RIGHT: f64 = 30.0;

const BLUE: Color = Color::Rgb(0, 84, 147);
const RED: Color = Color::Rgb(178, 58, 20);

/// A curve with more points than this has no markers.
const MARKERS: usize = 80;

/// A bound higher than this many times the largest shear leaves the panel, so that the shear can be read.
const FAR_BOUND: f64 = 5.0;

/// A contact shorter than the part `SMALL` of its side is shown with the part `BESIDE` of its length on both sides.
const SMALL: f64 = 0.5;
const BESIDE: f64 = 0.5;

/// Tractions below this part of the largest count as zero.
const NOTHING: f64 = 1e-9;

/// Contact tractions at N points of one contact side, in the units of the scene. A value that is not finite is left
/// out and breaks its curve.
#[derive(Debug, Clone, Copy)]
pub struct ContactSide<'a> {
    /// Title, broken into at most three lines.
    pub title: &'a str,
    /// Meaning of `position`, for instance "x" or "arc length along floor".
    pub x_label: &'a str,
    /// Name of the unit of tractions.
    pub stress: Option<&'a str>,
    /// Positions (N), in any order.
    pub position: &'a [f64],
    /// Pressure λ_n ≥ 0 (N).
    pub pressure: &'a [f64],
    /// Shear λ_t (N).
    pub shear: &'a [f64],
    /// Friction bound F ≥ 0 (N), drawn as ±F; no values if the side is frictionless.
    pub bound: &'a [f64],
}

/// Draws the pressure above; shear and, dashed, ±F below. Both panels contain zero.
///
/// If a side touches along less than half of its length, only the contact and half of the contact's length on both
/// sides are shown. Tractions on up to 2 % of the length that are far beyond the others leave their panel, and the key
/// states the largest. If F is everywhere more than five times the largest shear, it is cut off at the frame, and the
/// key says so.
///
/// # Errors
/// [`PictureError::Raster`] if the pixels cannot be made.
///
/// # Panics
/// If the numbers of values differ.
pub fn contact(side: &ContactSide<'_>) -> Result<Picture, PictureError> {
    let n = side.position.len();
    assert!(side.pressure.len() == n && side.shear.len() == n, "one pressure and one shear a position");
    assert!(side.bound.is_empty() || side.bound.len() == n, "one bound a position, or none");
    let [from, to] = window(side);
    let mut order: Vec<usize> = (0..n).filter(|&i| (from..=to).contains(&side.position[i])).collect();
    order.sort_by(|&i, &j| side.position[i].total_cmp(&side.position[j]));
    let curve = |values: &[f64], sign: f64| order.iter().map(|&i| [side.position[i], sign * values[i]]).collect();
    let pressure: Vec<[f64; 2]> = curve(side.pressure, 1.0);
    let shear: Vec<[f64; 2]> = curve(side.shear, 1.0);
    let bounds: Vec<Vec<[f64; 2]>> = match side.bound {
        [] => Vec::new(),
        bound => vec![curve(bound, 1.0), curve(bound, -1.0)],
    };

    let title = Title::new(side.title);
    let top = 14.0 + title.height() + KEY;
    let x = interval(pressure.iter().map(|p| p[0]), false);
    let far = hidden(side.shear, side.bound);
    let shown = bounds.iter().flatten().filter(|_| !far);
    let limits = [usual(&pressure), usual(&shear)];
    let within = |k: usize| move |v: f64| v.clamp(-limits[k], limits[k]);
    let panel = |k: usize, y: [f64; 2]| {
        let top = top + k as f64 * (PANEL + KEY + 12.0);
        Axes { frame: Rect { left: 0.0, top, width: WIDTH, height: PANEL }, x, y }
    };
    let mut panels = [
        panel(0, interval(pressure.iter().map(|p| p[1]).map(within(0)), true)),
        panel(1, interval(shear.iter().chain(shown).map(|p| p[1]).map(within(1)), true)),
    ];
    let left = panels[0].left_margin().max(panels[1].left_margin());
    for p in &mut panels {
        (p.frame.left, p.frame.width) = (left, WIDTH - left - RIGHT);
    }

    let mut canvas = Canvas::new(panels[1].frame.bottom() + BELOW + 10.0);
    canvas.title(&title, 32.0);
    panels[0].draw(&mut canvas, None, &in_unit("pressure", side.stress), left, true);
    panels[1].draw(&mut canvas, Some(side.x_label), &in_unit("shear", side.stress), left, true);
    zero(&mut canvas, &panels[0]);
    zero(&mut canvas, &panels[1]);

    draw(&mut canvas, &panels[0], &pressure, &pressure_pen(), Some(Marker::Disc));
    for b in &bounds {
        draw(&mut canvas, &panels[1], b, &bound_pen(), None);
    }
    draw(&mut canvas, &panels[1], &shear, &shear_pen(), Some(Marker::Square));

    let mut key = Key { canvas: &mut canvas, right: WIDTH - RIGHT, y: panels[0].frame.top - 10.0 };
    let unit = side.stress.unwrap_or("the unit of E");
    let [highest, strongest] = [(&pressure, limits[0]), (&shear, limits[1])].map(|(curve, limit)| {
        let largest = curve
            .iter()
            .map(|p| p[1])
            .filter(|v| v.is_finite())
            .fold(0.0, |m: f64, v| if v.abs() > m.abs() { v } else { m });
        if largest.abs() > limit { format!(" (to {} beyond this panel)", short(largest, 3)) } else { String::new() }
    });
    key.entry(&format!("pressure λₙ, in {unit}{highest}"), &pressure_pen(), Some(Marker::Disc));
    key.y = panels[1].frame.top - 10.0;
    key.right = WIDTH - RIGHT;
    if !bounds.is_empty() {
        let beyond = if far { " (beyond this panel)" } else { "" };
        key.entry(&format!("friction bound ±F{beyond}"), &bound_pen(), None);
    }
    key.entry(&format!("shear λₜ on what it touches, in {unit}{strongest}"), &shear_pen(), Some(Marker::Square));
    canvas.finish()
}

/// The largest absolute value of a curve; if it is far beyond the values on 98 % of the length, twice the largest of
/// these.
fn usual(curve: &[[f64; 2]]) -> f64 {
    let length = |i: usize| {
        let known = |k: usize| curve.get(k).filter(|p| p[1].is_finite()).map_or(curve[i][0], |p| p[0]);
        known(i + 1) - known(i.saturating_sub(1))
    };
    let sizes: Vec<(f64, f64)> = (0..curve.len()).map(|i| (curve[i][1].abs(), length(i))).collect();
    let largest = sizes.iter().map(|s| s.0).filter(|v| v.is_finite()).fold(0.0, f64::max);
    if largest > 0.0 { bands::interval(&sizes)[1] } else { 0.0 }
}

/// The interval of positions to show: the contact and its neighbourhood, or all.
fn window(side: &ContactSide<'_>) -> [f64; 2] {
    let span = |among: &dyn Fn(usize) -> bool| {
        let start = [f64::INFINITY, f64::NEG_INFINITY];
        let shown = (0..side.position.len()).filter(|&i| side.position[i].is_finite() && among(i));
        shown.map(|i| side.position[i]).fold(start, |[l, h], x| [l.min(x), h.max(x)])
    };
    let size = |i: usize| side.pressure[i].abs().max(side.shear[i].abs());
    let largest = (0..side.position.len()).map(size).filter(|v| v.is_finite()).fold(0.0, f64::max);
    let [low, high] = span(&|_| true);
    let [first, last] = span(&|i| size(i) > NOTHING * largest);
    let length = last - first;
    // a single node has no length
    if length > 0.0 && length < SMALL * (high - low) {
        [low.max(first - BESIDE * length), high.min(last + BESIDE * length)]
    } else {
        [low, high]
    }
}

fn pressure_pen() -> Pen {
    Pen::solid(BLUE, 2.0)
}

fn shear_pen() -> Pen {
    Pen::solid(RED, 2.0)
}

fn bound_pen() -> Pen {
    Pen::dashed(BLACK, 1.6, 8.0, 5.0)
}

#[derive(Debug, Clone, Copy)]
enum Marker {
    Disc,
    Square,
}

/// Whether the bound is so high everywhere that the shear would look like zero beside it.
fn hidden(shear: &[f64], bound: &[f64]) -> bool {
    let largest = shear.iter().map(|t| t.abs()).filter(|t| t.is_finite()).fold(0.0, f64::max);
    let least = bound.iter().copied().filter(|f| f.is_finite()).fold(f64::INFINITY, f64::min);
    largest > 0.0 && least > FAR_BOUND * largest
}

/// Interval of the finite values with a small margin; with `zero` it contains 0.
pub(super) fn interval(values: impl Iterator<Item = f64>, zero: bool) -> [f64; 2] {
    let start = if zero { [0.0, 0.0] } else { [f64::INFINITY, f64::NEG_INFINITY] };
    let [low, high] = values.filter(|v| v.is_finite()).fold(start, |[l, h], v| [l.min(v), h.max(v)]);
    if low > high || (low == 0.0 && high == 0.0) {
        [0.0, 1.0]
    } else if low == high {
        [low - 0.5 * low.abs(), high + 0.5 * high.abs()]
    } else {
        let margin = if zero { 0.06 } else { 0.02 } * (high - low);
        let inside = |v: f64| zero && v == 0.0;
        [low - if inside(low) { 0.3 * margin } else { margin }, high + if inside(high) { 0.3 * margin } else { margin }]
    }
}

/// A thin line at zero.
fn zero(canvas: &mut Canvas, axes: &Axes) {
    let ends = [axes.at([axes.x[0], 0.0]), axes.at([axes.x[1], 0.0])];
    canvas.line(ends[0], ends[1], &Pen::solid(GREY, 1.0));
}

fn draw(canvas: &mut Canvas, axes: &Axes, curve: &[[f64; 2]], pen: &Pen, marker: Option<Marker>) {
    let placed: Vec<_> = curve.iter().map(|&p| axes.at(p)).collect();
    canvas.lines(&clip(&placed, axes.frame), pen);
    if let Some(marker) = marker.filter(|_| placed.len() <= MARKERS) {
        let f = axes.frame;
        let inside = |p: &&[f64; 2]| (f.top..=f.bottom()).contains(&p[1]);
        placed.iter().filter(inside).for_each(|&p| mark(canvas, p, marker, pen));
    }
}

fn mark(canvas: &mut Canvas, [x, y]: [f64; 2], marker: Marker, pen: &Pen) {
    const R: f64 = 3.6;
    match marker {
        Marker::Disc => canvas.disc([x, y], R, pen.colour.clone()),
        Marker::Square => {
            let corners = vec![[x - R, y - R], [x + R, y - R], [x + R, y + R], [x - R, y + R]];
            canvas.fill(&[corners], pen.colour.clone());
        }
    }
}

/// A row of names above a panel, filled from the right.
struct Key<'c> {
    canvas: &'c mut Canvas,
    right: f64,
    y: f64,
}

impl Key<'_> {
    fn entry(&mut self, name: &str, pen: &Pen, marker: Option<Marker>) {
        let start = self.right - text_width(name, TICK_TEXT);
        let y = self.y - 4.5;
        self.canvas.line([start - 46.0, y], [start - 8.0, y], pen);
        if let Some(marker) = marker {
            mark(self.canvas, [start - 27.0, y], marker, pen);
        }
        self.canvas.text([start, self.y], name, TICK_TEXT, TextAnchor::Start);
        self.right = start - 70.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_contact_is_shown_with_its_neighbourhood() {
        let position: Vec<f64> = (0..=100).map(f64::from).collect();
        let ends = |from: f64, to: f64| {
            let pressure: Vec<f64> = position.iter().map(|x| if (from..=to).contains(x) { 2.0 } else { 0.0 }).collect();
            let shear = vec![0.0; pressure.len()];
            let (title, x_label, stress) = ("", "", None);
            window(&ContactSide {
                title,
                x_label,
                stress,
                position: &position,
                pressure: &pressure,
                shear: &shear,
                bound: &[],
            })
        };
        assert_eq!(ends(40.0, 60.0), [30.0, 70.0]);
        assert_eq!(ends(0.0, 20.0), [0.0, 30.0]);
        assert_eq!(ends(20.0, 80.0), [0.0, 100.0]);
        assert_eq!(ends(50.0, 50.0), [0.0, 100.0]);
        assert_eq!(ends(50.5, 50.6), [0.0, 100.0], "no contact");
    }
}
