//! The part of a body in a window of the undeformed plane.

use super::body::{Body, Obstacle};

/// A part of a body with its own numbering of points; obstacles are given by their points and gaps.
#[derive(Debug, Default)]
pub(super) struct Part {
    pub points: Vec<[f64; 2]>,
    pub displacement: Vec<[f64; 2]>,
    pub values: Vec<f64>,
    pub triangles: Vec<[usize; 3]>,
    pub outline: Vec<[usize; 2]>,
    pub obstacles: Vec<[Vec<[f64; 2]>; 2]>,
}

impl Part {
    fn push(&mut self, [x, y, u, v, value]: [f64; 5]) -> usize {
        self.points.push([x, y]);
        self.displacement.push([u, v]);
        self.values.push(value);
        self.points.len() - 1
    }
}

/// Cuts triangles, outline and obstacles at the sides of a window, with fields that are linear between points.
pub(super) fn part(b: &Body<'_>, window: [[f64; 2]; 2]) -> Part {
    let corner = |i: usize| {
        let ([x, y], [u, v]) = (b.points[i], b.displacement[i]);
        [x, y, u, v, b.values[i]]
    };
    let mut part = Part::default();
    // a point inside the window has one number, so that lines continue through it
    let mut numbers: Vec<Option<usize>> = vec![None; b.points.len()];
    let mut number = |part: &mut Part, i: usize, at: [f64; 5]| match at[..2] == corner(i)[..2] {
        true => *numbers[i].get_or_insert_with(|| part.push(at)),
        false => part.push(at),
    };
    for triangle in b.triangles.iter().filter(|t| t.iter().all(|&i| !b.values[i].is_nan())) {
        let corners = triangle.map(corner);
        if corners.iter().all(|p| is_inside(p, window)) {
            let numbers = [0, 1, 2].map(|k| number(&mut part, triangle[k], corners[k]));
            part.triangles.push(numbers);
            continue;
        }
        let polygon: Vec<usize> = inside(corners.to_vec(), window).into_iter().map(|p| part.push(p)).collect();
        part.triangles.extend((2..polygon.len()).map(|k| [polygon[0], polygon[k - 1], polygon[k]]));
    }
    for &[i, j] in b.outline {
        if let Some([p, q]) = segment([corner(i), corner(j)], window) {
            let ends = [number(&mut part, i, p), number(&mut part, j, q)];
            part.outline.push(ends);
        }
    }
    part.obstacles.extend(b.obstacles.iter().flat_map(|obstacle| obstacle.inside(window)));
    part
}

impl Obstacle<'_> {
    /// Points and gaps of the stretches in a window.
    pub(super) fn inside(&self, window: [[f64; 2]; 2]) -> Vec<[Vec<[f64; 2]>; 2]> {
        let at = |(p, g): (&[f64; 2], &[f64; 2])| [p[0], p[1], g[0], g[1]];
        let line: Vec<[f64; 4]> = self.points.iter().zip(self.gap).map(at).collect();
        let split = |line: Vec<[f64; 4]>| line.into_iter().map(|[x, y, g, h]| ([x, y], [g, h])).unzip();
        stretches(&line, window).into_iter().map(split).map(|(points, gaps)| [points, gaps]).collect()
    }
}

/// The stretches of a line in a window, with values that are linear between its points.
pub(super) fn stretches<const N: usize>(line: &[[f64; N]], window: [[f64; 2]; 2]) -> Vec<Vec<[f64; N]>> {
    let mut stretches: Vec<Vec<[f64; N]>> = Vec::new();
    let mut last = None;
    for ends in line.windows(2) {
        let Some([p, q]) = segment([ends[0], ends[1]], window) else { continue };
        match stretches.last_mut() {
            Some(stretch) if last == Some(p) => stretch.push(q),
            _ => stretches.push(vec![p, q]),
        }
        last = Some(q);
    }
    stretches
}

/// How far a point is beyond each side of a window, inwards.
fn depths<const N: usize>(p: &[f64; N], [low, high]: [[f64; 2]; 2]) -> [f64; 4] {
    [p[0] - low[0], high[0] - p[0], p[1] - low[1], high[1] - p[1]]
}

fn is_inside<const N: usize>(p: &[f64; N], window: [[f64; 2]; 2]) -> bool {
    depths(p, window).iter().all(|depth| *depth >= 0.0)
}

/// The point at which a line leaves the window at one of its sides.
fn crossing<const N: usize>(p: [f64; N], q: [f64; N], side: usize, window: [[f64; 2]; 2]) -> [f64; N] {
    let (a, b) = (depths(&p, window)[side], depths(&q, window)[side]);
    let s = a / (a - b);
    let mut at: [f64; N] = std::array::from_fn(|i| p[i] + (q[i] - p[i]) * s);
    at[side / 2] = window[side % 2][side / 2];
    at
}

/// The part of a convex polygon in a window.
fn inside(mut polygon: Vec<[f64; 5]>, window: [[f64; 2]; 2]) -> Vec<[f64; 5]> {
    for side in 0..4 {
        let depth = |p: &[f64; 5]| depths(p, window)[side];
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (k, &p) in polygon.iter().enumerate() {
            let q = polygon[(k + 1) % polygon.len()];
            if depth(&p) >= 0.0 {
                kept.push(p);
            }
            if depth(&p) * depth(&q) < 0.0 {
                kept.push(crossing(p, q, side, window));
            }
        }
        polygon = kept;
    }
    polygon
}

/// The part of a segment in a window.
fn segment<const N: usize>([mut p, mut q]: [[f64; N]; 2], window: [[f64; 2]; 2]) -> Option<[[f64; N]; 2]> {
    for side in 0..4 {
        let [a, b] = [&p, &q].map(|x| depths(x, window)[side]);
        match (a < 0.0, b < 0.0) {
            (true, true) => return None,
            (true, false) => p = crossing(p, q, side, window),
            (false, true) => q = crossing(p, q, side, window),
            (false, false) => {}
        }
    }
    Some([p, q])
}

#[cfg(test)]
mod tests {
    use super::super::body::Largest;
    use super::super::colours::Colours;
    use super::*;
    use proptest::prelude::*;

    const N: usize = 5;

    /// The unit square in triangles, displaced and coloured by linear functions, on a floor.
    fn with_square<T>(look: impl FnOnce(&Body<'_>) -> T) -> T {
        let at = |k: usize| [(k % (N + 1)) as f64 / N as f64, (k / (N + 1)) as f64 / N as f64];
        let points: Vec<[f64; 2]> = (0..(N + 1) * (N + 1)).map(at).collect();
        let cells = (0..N * N).map(|c| c / N * (N + 1) + c % N);
        let halves = |k: usize| [[k, k + 1, k + N + 2], [k, k + N + 2, k + N + 1]];
        let triangles: Vec<[usize; 3]> = cells.flat_map(halves).collect();
        let displacement: Vec<[f64; 2]> = points.iter().map(|[x, y]| [2.0 * x - y, x + 3.0 * y]).collect();
        let values: Vec<f64> = points.iter().map(|[x, y]| 1.0 + x - 4.0 * y).collect();
        let outline: Vec<[usize; 2]> = (0..N).map(|k| [k, k + 1]).collect();
        let gap: Vec<[f64; 2]> = points[..=N].iter().map(|[x, _]| [0.0, -x]).collect();
        let obstacles = [Obstacle { points: &points[..=N], gap: &gap }];
        look(&Body {
            title: "",
            points: &points,
            displacement: &displacement,
            largest: 9.0,
            triangles: &triangles,
            values: &values,
            infinite: &[],
            label: "",
            noun: "",
            colours: Colours::Automatic,
            outline: &outline,
            obstacles: &obstacles,
            window: None,
            most: Largest::NONE,
            enlarge: None,
            units: [None; 2],
        })
    }

    fn area(points: &[[f64; 2]], triangles: &[[usize; 3]]) -> f64 {
        let of = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|i| points[i]);
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
        };
        triangles.iter().map(of).sum()
    }

    proptest! {
        #[test]
        fn a_window_has_its_own_area_no_point_outside_and_the_same_fields(
            x in -0.5f64..1.0, y in -0.5f64..1.0, width in 0.01f64..1.5, height in 0.01f64..1.5
        ) {
            let window = [[x, y], [x + width, y + height]];
            let part = with_square(|b| part(b, window));
            let side = |low: f64, length: f64| ((low + length).min(1.0) - low.max(0.0)).max(0.0);
            prop_assert!((area(&part.points, &part.triangles) - side(x, width) * side(y, height)).abs() < 1e-12);
            for (k, p) in part.points.iter().enumerate() {
                prop_assert!(is_inside(p, window), "{p:?}");
                let [u, v] = part.displacement[k];
                let off = [2.0 * p[0] - p[1] - u, p[0] + 3.0 * p[1] - v, 1.0 + p[0] - 4.0 * p[1] - part.values[k]];
                prop_assert!(off.iter().all(|d| d.abs() < 1e-12), "{off:?}");
            }
            // the lower side and its floor are one line each, as long as the window shows
            let length = if y <= 0.0 && 0.0 <= y + height { side(x, width) } else { 0.0 };
            let drawn: f64 = part.outline.iter().map(|&[i, j]| part.points[j][0] - part.points[i][0]).sum();
            prop_assert!((drawn - length).abs() < 1e-12);
            prop_assert!(part.outline.windows(2).all(|w| w[0][1] == w[1][0]));
            prop_assert_eq!(part.obstacles.len(), usize::from(length > 0.0));
            for [points, gaps] in &part.obstacles {
                prop_assert!((points[points.len() - 1][0] - points[0][0] - length).abs() < 1e-12);
                prop_assert!(points.iter().zip(gaps).all(|(p, g)| (p[0] + g[1]).abs() < 1e-12));
            }
        }
    }
}
