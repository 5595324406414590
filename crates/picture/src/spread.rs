//! The mean deformed body with the spread of its boundary.

use super::axes::{BELOW, TICK_TEXT};
use super::body::{Bounds, Obstacle, SUBTITLE_TEXT, draw_walls, hatched, moved, place, undeformed_pen, view, walls};
use super::canvas::{BLACK, Canvas, Pen, Rect, Title, WIDTH, clip, text_width};
use super::scale::{exaggeration, short};
use super::{Picture, PictureError};
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

/// Draws the undeformed and the mean deformed outline, with a band of two standard deviations of the normal displacement
/// on both sides of the latter. Mean, deviations and gaps are drawn at one factor, by the rule of [`super::body()`]
/// for the largest mean displacement with its two deviations.
///
/// # Errors
/// [`PictureError::Raster`] if the pixels cannot be made.
///
/// # Panics
/// If the numbers of points and values differ.
pub fn spread(title: &str, loops: &[SpreadLoop], obstacles: &[Obstacle<'_>]) -> Result<Picture, PictureError> {
    let norm = |u: [f64; 2]| u[0].hypot(u[1]);
    let largest = |values: &mut dyn Iterator<Item = f64>| values.filter(|v| v.is_finite()).fold(0.0, f64::max);
    let deviation = |c: &[f64; 3]| greatest_variance(*c).max(0.0).sqrt();
    let (mut mean, mut off, mut both) = (0.0f64, 0.0f64, 0.0f64);
    for l in loops {
        assert!(l.mean.len() == l.points.len() && l.covariance.len() == l.points.len(), "values for each point");
        mean = mean.max(largest(&mut l.mean.iter().map(|u| norm(*u))));
        off = off.max(largest(&mut l.covariance.iter().map(deviation)));
        let sum = |(u, c): (&[f64; 2], &[f64; 3])| norm(*u) + DEVIATIONS * deviation(c);
        both = both.max(largest(&mut l.mean.iter().zip(&l.covariance).map(sum)));
    }
    let bounds = Bounds::of(loops.iter().flat_map(|l| &l.points));
    let factor = exaggeration(both / bounds.size(), f64::INFINITY);
    let deformed: Vec<Vec<_>> =
        loops.iter().map(|l| l.points.iter().zip(&l.mean).map(|(&p, &u)| moved(p, u, factor)).collect()).collect();
    let bands: Vec<Vec<[[f64; 2]; 2]>> =
        deformed.iter().zip(loops).map(|(line, l)| band(line, &l.covariance, factor)).collect();
    let walls = walls(obstacles, factor);

    let title = Title::new(title);
    let top = 26.0 + title.height() + 22.0;
    let shown: Vec<_> = deformed.iter().flatten().copied().chain(bands.iter().flatten().flatten().copied()).collect();
    let axes = place(&view(bounds, &shown, &walls), top);
    let f = axes.frame;
    let mut canvas = Canvas::new(f.bottom() + BELOW + 46.0);
    canvas.title(&title, 34.0);
    let scale = match factor {
        1.0 => "drawn to scale".to_owned(),
        _ => format!("displacements drawn {} times as large", short(factor, 3)),
    };
    let subtitle =
        format!("{scale}; largest mean displacement {}, largest deviation {}", short(mean, 3), short(off, 3));
    canvas.text([WIDTH / 2.0, top - 18.0], &subtitle, SUBTITLE_TEXT, TextAnchor::Middle);

    for band in &bands {
        let next = |i: usize| band[(i + 1) % band.len()];
        let piece = |i: usize| [band[i][0], next(i)[0], next(i)[1], band[i][1]].map(|p| axes.at(p)).to_vec();
        canvas.fill(&(0..band.len()).map(piece).collect::<Vec<_>>(), SHADE);
    }
    let mut through = |line: &[[f64; 2]], pen: &Pen| {
        let around: Vec<_> = line.iter().chain(line.first()).map(|&p| axes.at(p)).collect();
        canvas.lines(&clip(&around, f), pen);
    };
    for ((l, line), band) in loops.iter().zip(&deformed).zip(&bands) {
        for side in [0, 1] {
            through(&band.iter().map(|b| b[side]).collect::<Vec<_>>(), &edge_pen());
        }
        through(&l.points, &undeformed_pen());
        through(line, &mean_pen());
    }
    draw_walls(&mut canvas, &axes, &walls);
    axes.draw(&mut canvas, Some("x"), "y", axes.left_margin(), false);
    key(&mut canvas, [f.left + f.width / 2.0, f.bottom() + BELOW + 26.0], !walls.is_empty());
    canvas.finish()
}

/// The larger eigenvalue of a covariance.
fn greatest_variance([xx, yy, xy]: [f64; 3]) -> f64 {
    (xx + yy) / 2.0 + ((xx - yy) / 2.0).hypot(xy)
}

/// Two standard deviations on each side of a closed line, at its nodes: along the normal, and at a corner where the
/// bands of the two elements meet.
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

/// The vector d with d·n = deviation of the displacement along n for both normals; for normals that are nearly one, along
/// their mean.
fn offset(before: [f64; 2], after: [f64; 2], [xx, yy, xy]: [f64; 3]) -> [f64; 2] {
    let deviation = |n: [f64; 2]| (n[0] * n[0] * xx + n[1] * n[1] * yy + 2.0 * n[0] * n[1] * xy).max(0.0).sqrt();
    let cross = before[0] * after[1] - before[1] * after[0];
    if cross.abs() > CORNER {
        let (a, b) = (deviation(before), deviation(after));
        return [(a * after[1] - b * before[1]) / cross, (b * before[0] - a * after[0]) / cross];
    }
    let sum = [before[0] + after[0], before[1] + after[1]];
    let length = sum[0].hypot(sum[1]);
    // where the line turns back on itself there is no mean
    let n = if length > 1e-6 { sum.map(|v| v / length) } else { after };
    n.map(|v| v * deviation(n))
}

fn mean_pen() -> Pen {
    Pen::solid(BLACK, 1.8)
}

fn edge_pen() -> Pen {
    Pen::solid(Color::Rgb(90, 120, 150), 0.9)
}

/// What the lines and the band mean, in a row centred on a point.
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
