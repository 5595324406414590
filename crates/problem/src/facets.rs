//! Polygons that stand for curves: each of their corners is a singular point that the part does not have.

use steklov_bem_operators::{Edge, Polygon};
use steklov_elastic::plane::{angle, cross, distance, dot, minus};

/// Straight edges in a row that turn alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Facets {
    /// Side of the first of them.
    pub side: usize,
    /// How many there are.
    pub edges: usize,
    /// Mean angle between successive ones (radian), always positive.
    pub turn: f64,
    /// The corners between them.
    pub corners: Vec<[f64; 2]>,
    /// Both ends of a curve that is not closed, each with the angle of the body (radian) between the curve and what joins it there,
    /// less that between the straight edge and this: half a turn, negative of curves that bulge into the body.
    pub ends: Vec<([f64; 2], f64)>,
    /// The curve that they stand for.
    pub curve: Drawn,
}

/// The curve that a polygon follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drawn {
    /// A whole circle.
    Circle {
        /// Its centre.
        centre: [f64; 2],
        /// Its radius.
        radius: f64,
    },
    /// An arc of a circle.
    Arc {
        /// Its centre.
        centre: [f64; 2],
    },
    /// Something else without corners.
    Smooth,
}

/// Corners turn by less than this (radian): 25°.
const SMALL: f64 = 25.0 * std::f64::consts::PI / 180.0;
/// Those below this are none.
const STRAIGHT: f64 = 1e-6;
/// Successive turns and lengths differ by this factor at most.
const ALIKE: f64 = 1.6;
/// Corners in a row that are seen as a curve.
const MANY: usize = 6;
/// Corners of a circle are at one distance from its centre, up to this part of it.
const ROUND: f64 = 1e-3;

/// The curves that the loops of an outline only approximate.
pub fn facets(outline: &Polygon) -> Vec<Facets> {
    (0..outline.loops().len()).flat_map(|l| of_loop(outline, &outline.traversal(l))).collect()
}

/// A corner: the edges before and after it in the order of traversal, and the angle between them.
#[derive(Clone, Copy)]
struct Corner<'a> {
    at: [f64; 2],
    before: &'a Edge,
    after: &'a Edge,
    turn: f64,
}

fn of_loop(outline: &Polygon, order: &[usize]) -> Vec<Facets> {
    let edges = outline.edges();
    let count = order.len();
    let corners: Vec<Corner<'_>> = (0..count)
        .map(|i| {
            let (before, after) = (&edges[order[(i + count - 1) % count]], &edges[order[i]]);
            let [d, e] = [before, after].map(|edge| {
                let ([a, b], sign) = (edge.listed(), if edge.reversed { -1.0 } else { 1.0 });
                [sign * (b[0] - a[0]), sign * (b[1] - a[1])]
            });
            let turn = angle(d, e);
            let at = after.listed()[usize::from(after.reversed)];
            Corner { at, before, after, turn }
        })
        .collect();
    let goes_on = |i: usize| follows(&corners[i], &corners[(i + 1) % count]);
    // begin after a corner where no curve goes on
    let first = (0..count).find(|&i| !goes_on(i));
    let Some(first) = first else {
        return if count >= MANY { vec![told(&corners, true)] } else { Vec::new() };
    };
    let turned: Vec<usize> = (1..=count).map(|k| (first + k) % count).collect();
    let mut runs: Vec<Vec<usize>> = vec![Vec::new()];
    for &i in &turned {
        let last = runs.len() - 1;
        runs[last].push(i);
        if !goes_on(i) {
            runs.push(Vec::new());
        }
    }
    let long = runs.into_iter().filter(|run| run.len() >= MANY);
    long.map(|run| told(&run.iter().map(|&i| corners[i]).collect::<Vec<_>>(), false)).collect()
}

/// Whether a polygon goes on along a curve from one corner to the next.
fn follows(a: &Corner<'_>, b: &Corner<'_>) -> bool {
    let alike = |x: f64, y: f64| x < ALIKE * y && y < ALIKE * x;
    let small = |turn: f64| (STRAIGHT..SMALL).contains(&turn.abs());
    let straight = [a.before, a.after, b.after].iter().all(|edge| edge.is_line());
    let length = |edge: &Edge| edge.length();
    straight
        && small(a.turn)
        && small(b.turn)
        && a.turn * b.turn > 0.0
        && alike(a.turn.abs(), b.turn.abs())
        && alike(length(a.before), length(a.after))
        && alike(length(a.after), length(b.after))
}

fn told(run: &[Corner<'_>], closed: bool) -> Facets {
    let points: Vec<[f64; 2]> = run.iter().map(|corner| corner.at).collect();
    let curve = match centre(&points) {
        Some((centre, radius)) if closed => Drawn::Circle { centre, radius },
        Some((centre, _)) => Drawn::Arc { centre },
        None => Drawn::Smooth,
    };
    let turn = run.iter().map(|corner| corner.turn.abs()).sum::<f64>() / run.len() as f64;
    let (first, last) = (&run[0], &run[run.len() - 1]);
    let ends = vec![(first.before.start, first.turn / 2.0), (last.after.end, last.turn / 2.0)];
    let ends = if closed { Vec::new() } else { ends };
    Facets { side: run[0].after.side, edges: run.len() + usize::from(!closed), turn, corners: points, ends, curve }
}

/// Centre and radius of the circle that points lie on.
fn centre(points: &[[f64; 2]]) -> Option<([f64; 2], f64)> {
    let [a, b, c] = [points[0], points[points.len() / 3], points[2 * points.len() / 3]];
    let (p, q) = (minus(b, a), minus(c, a));
    let (pp, qq, det) = (dot(p, p), dot(q, q), 2.0 * cross(p, q));
    let centre = [a[0] + (pp * q[1] - qq * p[1]) / det, a[1] + (qq * p[0] - pp * q[0]) / det];
    let radius = distance(centre, a);
    points.iter().all(|&x| (distance(x, centre) - radius).abs() < ROUND * radius).then_some((centre, radius))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use steklov_bem_operators::{Loop, Polygon};

    use super::{Drawn, facets};

    fn polygon(corners: Vec<[f64; 2]>) -> Polygon {
        let sides = vec!["rim".to_owned(); corners.len()];
        Polygon::new(Loop::straight(corners, sides), vec![]).unwrap()
    }

    fn ellipse(count: usize, [a, b]: [f64; 2]) -> Vec<[f64; 2]> {
        (0..count).map(|k| TAU * k as f64 / count as f64).map(|t| [3.0 + a * t.cos(), b * t.sin()]).collect()
    }

    #[test]
    fn polygons_of_many_sides_are_circles_and_nuts_are_not() {
        for count in [16, 64, 257] {
            let found = facets(&polygon(ellipse(count, [2.0, 2.0])));
            let [one] = &found[..] else { panic!("{found:?}") };
            assert_eq!(one.edges, count);
            assert!((one.turn - TAU / count as f64).abs() < 1e-12);
            let Drawn::Circle { centre, radius } = one.curve else { panic!("{found:?}") };
            assert!((centre[0] - 3.0).abs() + centre[1].abs() + (radius - 2.0).abs() < 1e-12, "{centre:?} {radius}");
        }
        for count in [4, 6, 8, 12] {
            assert_eq!(facets(&polygon(ellipse(count, [2.0, 2.0]))), []);
        }
    }

    #[test]
    fn an_ellipse_and_a_rounded_corner_are_seen() {
        let found = facets(&polygon(ellipse(64, [2.0, 1.2])));
        assert_eq!(found.iter().map(|f| f.curve).collect::<Vec<_>>(), [Drawn::Smooth]);
        // a square with one corner rounded by 12 chords, and one that is cut off by two
        let rounded =
            (0..=12).map(|k| PI / 2.0 * f64::from(k) / 12.0).map(|t| [0.7 + 0.3 * t.cos(), 0.7 + 0.3 * t.sin()]);
        let corners = [[0.0, 0.0], [1.0, 0.0]].into_iter().chain(rounded).chain([[0.2, 1.0], [0.05, 0.9], [0.0, 0.7]]);
        let found = facets(&polygon(corners.collect()));
        let [one] = &found[..] else { panic!("{found:?}") };
        let Drawn::Arc { centre } = one.curve else { panic!("{found:?}") };
        assert!((centre[0] - 0.7).abs() + (centre[1] - 0.7).abs() < 1e-12);
        assert_eq!(one.edges, 12);
        // the body goes on behind both ends: 180° less the chord's half turn
        let half = PI / 2.0 / 12.0 / 2.0;
        for ((at, angle), x) in one.ends.iter().zip([[1.0, 0.7], [0.7, 1.0]]) {
            assert!((at[0] - x[0]).abs() + (at[1] - x[1]).abs() + (angle - half).abs() < 1e-12, "{at:?} {angle}");
        }
    }
}
