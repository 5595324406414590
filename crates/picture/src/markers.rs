//! Markers that are distinct in grey, filled or open, and the colours and dashes of curves.

use super::canvas::{Canvas, Pen};
use kuva::render::color::Color;
use std::f64::consts::TAU;

/// Number of different shapes.
pub(super) const SHAPES: usize = 12;

/// Colours of curves, as different in lightness as their hues allow. Their number has no divisor in common with
/// [`SHAPES`], so 84 curves have different pairs of colour and shape.
const COLOURS: [Color; 7] = [
    Color::Rgb(0, 84, 147),
    Color::Rgb(204, 85, 0),
    Color::Rgb(20, 20, 20),
    Color::Rgb(0, 135, 90),
    Color::Rgb(140, 50, 120),
    Color::Rgb(80, 160, 215),
    Color::Rgb(150, 115, 20),
];

/// Colour of curve k.
pub(super) fn colour(k: usize) -> Color {
    COLOURS[k % COLOURS.len()].clone()
}

/// Line style of quantity j: solid, dashed, dotted, then long dashes.
pub(super) fn pen(colour: Color, j: usize) -> Pen {
    match j {
        0 => Pen::solid(colour, 1.8),
        1 => Pen::dashed(colour, 1.4, 6.0, 4.0),
        2 => Pen::dashed(colour, 1.6, 1.8, 3.4),
        _ => Pen::dashed(colour, 1.2, 14.0, 4.0),
    }
}

/// Corners of marker k around a centre; shapes with the same r look equally large.
fn outline(k: usize, [x, y]: [f64; 2], r: f64) -> Vec<[f64; 2]> {
    let regular = |n: usize, turn: f64, r: f64| -> Vec<[f64; 2]> {
        (0..n).map(|i| TAU * (i as f64 / n as f64 + turn)).map(|a| [r * a.cos(), r * a.sin()]).collect()
    };
    let turned = |c: &[[f64; 2]], turn: f64| -> Vec<[f64; 2]> {
        let (s, c1) = (TAU * turn).sin_cos();
        c.iter().map(|p| [r * (c1 * p[0] - s * p[1]), r * (s * p[0] + c1 * p[1])]).collect()
    };
    const THIN: f64 = 0.38;
    const WIDE: f64 = 1.25;
    let plus = [
        [WIDE, -THIN],
        [WIDE, THIN],
        [THIN, THIN],
        [THIN, WIDE],
        [-THIN, WIDE],
        [-THIN, THIN],
        [-WIDE, THIN],
        [-WIDE, -THIN],
        [-THIN, -THIN],
        [-THIN, -WIDE],
        [THIN, -WIDE],
        [THIN, -THIN],
    ];
    let bow = [[-1.15, -1.05], [1.15, 1.05], [1.15, -1.05], [-1.15, 1.05]];
    let corners = match k % SHAPES {
        0 => regular(24, 0.0, r),
        1 => regular(4, 0.125, 1.27 * r),
        2 => regular(3, -0.25, 1.45 * r),
        3 => regular(4, 0.0, 1.4 * r),
        4 => regular(3, 0.25, 1.45 * r),
        5 => turned(&plus, 0.0),
        6 => {
            let (tips, dents) = (regular(5, -0.25, 1.6 * r), regular(5, -0.15, 0.65 * r));
            tips.into_iter().zip(dents).flat_map(|(a, b)| [a, b]).collect()
        }
        7 => turned(&plus, 0.125),
        8 => regular(3, 0.5, 1.45 * r),
        9 => turned(&bow, 0.0),
        10 => regular(3, 0.0, 1.45 * r),
        _ => turned(&bow, 0.25),
    };
    corners.into_iter().map(|p| [x + p[0], y + p[1]]).collect()
}

/// Draws marker k, white inside if `open`.
pub(super) fn mark(canvas: &mut Canvas, k: usize, centre: [f64; 2], r: f64, colour: Color, open: bool) {
    let corners = outline(k, centre, r);
    let inside = if open { Color::Rgb(255, 255, 255) } else { colour.clone() };
    canvas.fill(std::slice::from_ref(&corners), inside);
    if open {
        // Repeating the second corner joins the ends.
        let closed = [&corners[..], &corners[..2]].concat();
        canvas.lines(&[closed], &Pen::solid(colour, 1.3));
    }
}

/// Draws the outline of marker k around a marker that is there already.
pub(super) fn around(canvas: &mut Canvas, k: usize, centre: [f64; 2], r: f64, colour: Color) {
    let corners = outline(k, centre, r);
    let closed = [&corners[..], &corners[..2]].concat();
    canvas.lines(&[closed], &Pen::solid(colour, 1.4));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a point lies inside of a polygon (even-odd rule).
    fn inside(polygon: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
        let edges = (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]));
        let crossings =
            edges.filter(|(a, b)| (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
        crossings.count() % 2 == 1
    }

    #[test]
    fn any_two_shapes_differ_in_a_good_part_of_their_area() {
        let grid: Vec<[f64; 2]> =
            (0..61).flat_map(|i| (0..61).map(move |j| [i, j].map(|v| f64::from(v) / 20.0 - 1.503))).collect();
        let masks: Vec<Vec<bool>> = (0..SHAPES)
            .map(|k| {
                let polygon = outline(k, [0.0, 0.0], 0.9);
                grid.iter().map(|&p| inside(&polygon, p)).collect()
            })
            .collect();
        for i in 0..SHAPES {
            for j in 0..i {
                let count = |f: fn(bool, bool) -> bool| {
                    masks[i].iter().zip(&masks[j]).filter(|(a, b)| f(**a, **b)).count() as f64
                };
                let (differ, either) = (count(|a, b| a != b), count(|a, b| a || b));
                assert!(differ > 0.15 * either, "shapes {i} and {j}: {differ} of {either}");
            }
        }
    }

    #[test]
    fn eighty_four_curves_have_pairs_of_colour_and_shape_of_their_own() {
        let pairs: std::collections::BTreeSet<_> = (0..84).map(|k| (format!("{:?}", colour(k)), k % SHAPES)).collect();
        assert_eq!(pairs.len(), 84);
    }
}
