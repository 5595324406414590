//! The mean deformed body with the spread of its boundary.

use super::axes::{BELOW, TICK_TEXT};
use super::body::{
    Bounds, Obstacle, SUBTITLE_TEXT, draw_walls, hatched, moved, place, undeformed_pen, view, walls, with_unit,
};
use super::canvas::{BLACK, Canvas, Pen, Rect, Title, WIDTH, clip, text_width, wrap};
use super::scale::{exaggeration, short};
use super::window::stretches;
use super::{Picture, PictureError, in_unit};
use kuva::render::color::Color;
use kuva::render::render::TextAnchor;

const SHADE: Color = Color::Rgb(198, 214, 229);

/// Standard deviations on each side of the mean.
const DEVIATIONS: f64 = 2.0;

/// Normals of two elements whose cross product is larger meet in a corner.
const CORNER: f64 = 0.3;

/// A closed loop of the boundary in traversal order (body to the left): N nodes.
#[derive(Debug, Clone)]
pub struct SpreadLoop {
    /// Undeformed points (N).
    pub points: Vec<[f64; 2]>,
    /// Mean displacements (N).
    pub mean: Vec<[f64; 2]>,
    /// Covariances `[xx, yy, xy]` of the displacements (N).
    pub covariance: Vec<[f64; 3]>,
}

/// A body whose displacement is random, to draw.
#[derive(Debug, Clone, Copy)]
pub struct Spread<'a> {
    /// Title, broken into at most three lines.
    pub title: &'a str,
    /// The boundary.
    pub loops: &'a [SpreadLoop],
    /// The obstacles of the mean input, one for each stretch of contact side.
    pub obstacles: &'a [Obstacle<'a>],
    /// Lower left and upper right corner of the part of the undeformed body that is drawn; None for all of it.
    pub window: Option<[[f64; 2]; 2]>,
    /// Factor > 0 of displacements, deviations and gaps; None chooses one that makes them visible.
    pub enlarge: Option<f64>,
    /// Name of the unit of lengths.
    pub unit: Option<&'a str>,
}

/// Draws the undeformed and the mean deformed outline, with a band of two standard deviations of the normal
/// displacement on both sides of the latter. Mean, deviations and gaps are drawn at one factor. Unless it is given, it
/// follows from the rule of [`super::body()`] for the largest mean displacement plus two deviations.
///
/// # Errors
/// [`PictureError::Raster`] if the pixels cannot be made.
///
/// # Panics
/// If the numbers of points and values differ.
pub fn spread(s: &Spread<'_>) -> Result<Picture, PictureError> {
    for l in s.loops {
        assert!(l.mean.len() == l.points.len() && l.covariance.len() == l.points.len(), "values for each point");
    }
    let window = s.window.unwrap_or([[f64::NEG_INFINITY; 2], [f64::INFINITY; 2]]);
    let [mean, off, both] = largest(s.loops, window);
    let all = || Bounds::of(s.loops.iter().flat_map(|l| &l.points));
    let bounds = s.window.map_or_else(all, |[low, high]| Bounds { low, high });
    let factor = s.enlarge.unwrap_or_else(|| exaggeration(both / bounds.size(), f64::INFINITY));
    let lines: Vec<_> = s.loops.iter().flat_map(|l| stretches(&outlines(l, factor), window)).collect();
    let cut: Vec<_> = s.obstacles.iter().flat_map(|o| o.inside(window)).collect();
    let obstacles: Vec<Obstacle<'_>> = cut.iter().map(|[points, gap]| Obstacle { points, gap }).collect();
    let walls = walls(&obstacles, factor);

    let title = Title::new(s.title);
    let told = wrap(&subtitle(s, factor, mean, off), SUBTITLE_TEXT, WIDTH - 60.0, 2);
    let top = 28.0 + title.height() + 20.0 * told.len() as f64;
    let shown: Vec<_> = lines.iter().flatten().flat_map(|o| [1, 2, 3].map(|k| line(o, k))).collect();
    let axes = place(&view(bounds, &shown, &walls), top);
    let f = axes.frame;
    let mut canvas = Canvas::new(f.bottom() + BELOW + 46.0);
    canvas.title(&title, 34.0);
    for (text, below) in told.iter().zip((0..told.len()).rev()) {
        canvas.text([WIDTH / 2.0, top - 18.0 - 20.0 * below as f64], text, SUBTITLE_TEXT, TextAnchor::Middle);
    }

    for outline in &lines {
        let piece = |w: &[[f64; 8]]| {
            [line(&w[0], 2), line(&w[1], 2), line(&w[1], 3), line(&w[0], 3)].map(|p| axes.at(p)).to_vec()
        };
        canvas.fill(&outline.windows(2).map(piece).collect::<Vec<_>>(), SHADE);
    }
    for outline in &lines {
        for (k, pen) in [(2, edge_pen()), (3, edge_pen()), (0, undeformed_pen()), (1, mean_pen())] {
            let through: Vec<_> = outline.iter().map(|o| axes.at(line(o, k))).collect();
            canvas.lines(&clip(&through, f), &pen);
        }
    }
    draw_walls(&mut canvas, &axes, &walls);
    let [x, y] = ["x", "y"].map(|name| in_unit(name, s.unit));
    axes.draw(&mut canvas, Some(&x), &y, axes.left_margin(), false);
    key(&mut canvas, [f.left + f.width / 2.0, f.bottom() + BELOW + 26.0], !walls.is_empty());
    canvas.finish()
}

/// The line about the factor and the largest displacements.
fn subtitle(s: &Spread<'_>, factor: f64, mean: f64, off: f64) -> String {
    let scale = match factor {
        1.0 => "drawn to scale".to_owned(),
        _ => format!("displacements drawn {} times as large", short(factor, 3)),
    };
    let of = if s.window.is_some() { " of this part" } else { "" };
    let [mean, off] = [mean, off].map(|v| with_unit(v, s.unit));
    format!("{scale}; largest mean displacement{of} {mean}, largest deviation {off}")
}

/// The largest mean displacement u, the largest deviation s, and the largest u + 2 s on the boundary in a window.
fn largest(loops: &[SpreadLoop], window: [[f64; 2]; 2]) -> [f64; 3] {
    let mut largest = [0.0f64; 3];
    for l in loops {
        let at = |i: usize| {
            let ([x, y], [u, v], [xx, yy, xy]) = (l.points[i], l.mean[i], l.covariance[i]);
            [x, y, u, v, xx, yy, xy]
        };
        for [_, _, u, v, xx, yy, xy] in stretches(&closed(l.points.len(), at), window).into_iter().flatten() {
            let (mean, off) = (u.hypot(v), greatest_variance([xx, yy, xy]).max(0.0).sqrt());
            for (most, value) in largest.iter_mut().zip([mean, off, mean + DEVIATIONS * off]) {
                *most = if value.is_finite() { most.max(value) } else { *most };
            }
        }
    }
    largest
}

/// Values at the nodes of a closed line, the first one again at the end.
fn closed<const N: usize>(nodes: usize, at: impl Fn(usize) -> [f64; N]) -> Vec<[f64; N]> {
    (0..nodes).chain(if nodes > 0 { Some(0) } else { None }).map(at).collect()
}

/// The undeformed boundary, the mean deformed one, and both edges of the band: points (x, y) of the four lines in this order.
fn outlines(l: &SpreadLoop, factor: f64) -> Vec<[f64; 8]> {
    let deformed: Vec<_> = l.points.iter().zip(&l.mean).map(|(&p, &u)| moved(p, u, factor)).collect();
    let band = band(&deformed, &l.covariance, factor);
    closed(deformed.len(), |i| {
        let ([x, y], [u, v], [[a, b], [c, d]]) = (l.points[i], deformed[i], band[i]);
        [x, y, u, v, a, b, c, d]
    })
}

/// Point of one of the four lines.
fn line(outlines: &[f64; 8], k: usize) -> [f64; 2] {
    [outlines[2 * k], outlines[2 * k + 1]]
}

/// The larger eigenvalue of a covariance.
fn greatest_variance([xx, yy, xy]: [f64; 3]) -> f64 {
    (xx + yy) / 2.0 + ((xx - yy) / 2.0).hypot(xy)
}

/// Two standard deviations on each side of a closed line, at its nodes: along the normal; at a corner, at the point
/// where the bands of the two elements meet.
fn band(line: &[[f64; 2]], covariance: &[[f64; 3]], factor: f64) -> Vec<[[f64; 2]; 2]> {
    let n = line.len();
    let normal = |i: usize| {
        let (a, b) = (line[i % n], line[(i + 1) % n]);
        let d = [b[0] - a[0], b[1] - a[1]];
        let length = d[0].hypot(d[1]);
        if length > 0.0 { [d[1] / length, -d[0] / length] } else { [0.0; 2] }
    };
    (0..n)
        .map(|i| {
            let offset = offset(normal(i + n - 1), normal(i), covariance[i]).map(|v| DEVIATIONS * factor * v);
            [-1.0, 1.0].map(|sign| moved(line[i], offset, sign))
        })
        .collect()
}

/// The vector d with d·n = deviation of the displacement along n for both normals; if the normals nearly coincide,
/// along their mean.
fn offset(before: [f64; 2], after: [f64; 2], [xx, yy, xy]: [f64; 3]) -> [f64; 2] {
    let deviation = |n: [f64; 2]| (n[0] * n[0] * xx + n[1] * n[1] * yy + 2.0 * n[0] * n[1] * xy).max(0.0).sqrt();
    let cross = before[0] * after[1] - before[1] * after[0];
    if cross.abs() > CORNER {
        let (a, b) = (deviation(before), deviation(after));
        return [(a * after[1] - b * before[1]) / cross, (b * before[0] - a * after[0]) / cross];
    }
    let sum = [before[0] + after[0], before[1] + after[1]];
    let length = sum[0].hypot(sum[1]);
    // if the line turns back on itself, there is no mean
    let n = if length > 1e-6 { sum.map(|v| v / length) } else { after };
    n.map(|v| v * deviation(n))
}

fn mean_pen() -> Pen {
    Pen::solid(BLACK, 1.8)
}

fn edge_pen() -> Pen {
    Pen::solid(Color::Rgb(90, 120, 150), 0.9)
}

/// The key of the lines and the band, in a row centred on a point.
fn key(canvas: &mut Canvas, centre: [f64; 2], obstacle: bool) {
    let names = ["mean", "± 2 standard deviations", "undeformed", "obstacle of the mean input"];
    let shown = &names[..if obstacle { 4 } else { 3 }];
    let width = |name: &str| 34.0 + 8.0 + text_width(name, TICK_TEXT) + 20.0;
    let total: f64 = shown.iter().map(|n| width(n)).sum();
    let mut x = (WIDTH / 2.0).min(centre[0]) - total / 2.0;
    x = x.max(20.0);
    for (i, name) in shown.iter().enumerate() {
        let (y, end) = (centre[1] - 5.0, x + 34.0);
        let line = vec![[x, y], [end, y]];
        match i {
            0 => canvas.lines(&[line], &mean_pen()),
            1 => {
                let (t, b) = (y - 6.0, y + 6.0);
                canvas.fill(&[vec![[x, b], [end, b], [end, t], [x, t]]], SHADE);
                canvas.lines(&[vec![[x, b], [end, b]], vec![[x, t], [end, t]]], &edge_pen());
            }
            2 => canvas.lines(&[line], &undeformed_pen()),
            _ => {
                let frame = Rect { left: x - 9.0, top: y - 15.0, width: 60.0, height: 40.0 };
                hatched(canvas, &[line], frame);
            }
        }
        canvas.text([x + 42.0, centre[1]], name, TICK_TEXT, TextAnchor::Start);
        x += width(name);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_band_of_a_square_is_a_rectangle_of_the_deviations() {
        let square = [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let band = band(&square, &[[0.04, 0.01, 0.0]; 5], 1.0);
        let outer = [[-0.4, -0.2], [0.5, -0.2], [1.4, -0.2], [1.4, 1.2], [-0.4, 1.2]];
        for (b, (o, p)) in band.iter().zip(outer.iter().zip(&square)) {
            for i in 0..2 {
                assert!((b[1][i] - o[i]).abs() < 1e-15, "{band:?}");
                assert!((b[0][i] + b[1][i] - 2.0 * p[i]).abs() < 1e-15, "the mean is in the middle");
            }
        }
    }

    #[test]
    fn a_window_has_its_own_largest_values() {
        let square = SpreadLoop {
            points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            mean: vec![[0.0, 0.0], [0.0, 4.0], [0.0, 4.0], [0.0, 0.0]],
            covariance: vec![[0.0; 3], [0.0, 9.0, 0.0], [0.0, 9.0, 0.0], [0.0; 3]],
        };
        let all = [[f64::NEG_INFINITY; 2], [f64::INFINITY; 2]];
        assert_eq!(largest(std::slice::from_ref(&square), all), [4.0, 3.0, 10.0]);
        // linear between nodes
        let got = largest(std::slice::from_ref(&square), [[-1.0, -1.0], [0.25, 0.5]]);
        assert_eq!(got[0], 1.0);
        assert!((got[1] - 1.5).abs() < 1e-15, "{got:?}");
        assert_eq!(largest(&[square], [[0.2, 0.2], [0.8, 0.8]]), [0.0; 3]);
    }

    proptest! {
        #[test]
        fn the_offset_has_the_deviation_along_each_normal(
            a in -3.0f64..3.0, turn in -2.5f64..2.5, s in 0.1f64..2.0, t in 0.1f64..2.0, r in -0.99f64..0.99
        ) {
            let (n, m) = ([a.cos(), a.sin()], [(a + turn).cos(), (a + turn).sin()]);
            let c = [s * s, t * t, r * s * t];
            let along = |n: [f64; 2]| (n[0] * n[0] * c[0] + n[1] * n[1] * c[1] + 2.0 * n[0] * n[1] * c[2]).sqrt();
            let d = offset(n, m, c);
            if turn.sin().abs() > CORNER {
                prop_assert!((d[0] * n[0] + d[1] * n[1] - along(n)).abs() < 1e-12);
                prop_assert!((d[0] * m[0] + d[1] * m[1] - along(m)).abs() < 1e-12);
            } else {
                let length = d[0].hypot(d[1]);
                prop_assert!((length - along(d.map(|v| v / length))).abs() < 1e-12);
                prop_assert!(length * length <= greatest_variance(c) * (1.0 + 1e-12));
            }
        }
    }
}
