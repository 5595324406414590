use std::collections::HashMap;

use proptest::prelude::*;
use steklov_elastic::plane::{cross, distance, dot, minus};

use super::*;

type Edge = ([f64; 2], [f64; 2], usize);

fn loops(corners: &[&[[f64; 2]]]) -> Vec<Edge> {
    let edge = |l: usize, c: &[[f64; 2]], i: usize| (c[i], c[(i + 1) % c.len()], l);
    corners.iter().enumerate().flat_map(|(l, c)| (0..c.len()).map(move |i| edge(l, c, i))).collect()
}

fn doubled_area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    cross(minus(b, a), minus(c, a))
}

/// Checks all properties that hold for any polygon with `holes` holes; returns the triangulation.
fn judge(edges: &[Edge], target: usize, holes: usize) -> Triangulation {
    let t = triangulate(edges, target).unwrap();
    let p = &t.points;

    // Triangles are positive and fill the polygon.
    let o = edges[0].0;
    let exact: f64 = edges.iter().map(|e| doubled_area(o, e.0, e.1) / 2.0).sum();
    let scale: f64 = edges.iter().map(|e| doubled_area(o, e.0, e.1).abs() / 2.0).sum();
    let areas: Vec<f64> = t.triangles.iter().map(|&[i, j, k]| doubled_area(p[i], p[j], p[k]) / 2.0).collect();
    assert!(areas.iter().all(|&a| a > 0.0), "smallest area {:e}", areas.iter().copied().fold(f64::INFINITY, f64::min));
    let area: f64 = areas.iter().sum();
    // The second term is the rounding of the points themselves, which matters in a thin body.
    let size = bounding_box(edges).1;
    assert!((area - exact).abs() <= 1e-12 * scale + f64::EPSILON * size * size, "area {area}, polygon {exact}");

    // Conforming: a directed side belongs to one triangle; it has a partner or lies on the outline, never both.
    let mut sides = HashMap::new();
    for &[i, j, k] in &t.triangles {
        for side in [[i, j], [j, k], [k, i]] {
            assert_eq!(sides.insert(side, ()), None, "side {side:?} twice");
        }
    }
    let free = sides.keys().filter(|&&[i, j]| !sides.contains_key(&[j, i])).count();
    assert_eq!(free, t.outline.len());
    assert!(t.outline.iter().all(|&[i, j]| sides.contains_key(&[i, j]) && !sides.contains_key(&[j, i])));

    // Euler: V - E + F = 1 - holes, and every point is used.
    let lines = (sides.len() + free) / 2;
    assert_eq!(p.len() as i64 - lines as i64 + t.triangles.len() as i64, 1 - holes as i64);
    let mut used = vec![false; p.len()];
    t.triangles.iter().flatten().for_each(|&i| used[i] = true);
    assert!(used.iter().all(|&u| u));

    // Boundary entries say where a point lies, corners are there bit by bit, the rest keeps its distance.
    for (&q, entry) in p.iter().zip(&t.boundary) {
        if let Some((edge, s)) = *entry {
            let (a, b, _) = edges[edge];
            assert!((0.0..1.0).contains(&s));
            let off = (q[0] - a[0] - s * (b[0] - a[0])).hypot(q[1] - a[1] - s * (b[1] - a[1]));
            assert!(off <= 1e-15 * (size + a[0].abs() + a[1].abs()));
        }
    }
    for (edge, (start, _, _)) in edges.iter().enumerate() {
        assert_eq!(t.boundary.iter().filter(|&&b| b == Some((edge, 0.0))).count(), 1);
        let corner = t.boundary.iter().position(|&b| b == Some((edge, 0.0))).unwrap();
        assert_eq!(p[corner], *start);
    }
    t
}

/// Smallest distance of an interior point from the boundary and longest boundary segment.
fn clearance(edges: &[Edge], t: &Triangulation) -> (f64, f64) {
    let interior = t.points.iter().zip(&t.boundary).filter(|(_, b)| b.is_none());
    let near = interior
        .map(|(&q, _)| edges.iter().map(|&(a, b, _)| distance_to_segment(q, [a, b])).fold(f64::INFINITY, f64::min));
    let longest = t.outline.iter().map(|&[i, j]| distance(t.points[i], t.points[j])).fold(0.0, f64::max);
    (near.fold(f64::INFINITY, f64::min), longest)
}

const SQUARE: [[f64; 2]; 4] = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
const HOLE: [[f64; 2]; 4] = [[-0.2, -0.2], [-0.2, 0.2], [0.2, 0.2], [0.2, -0.2]];

#[test]
fn square_hole_and_l_shape() {
    for target in [3, 40, 600, 3000] {
        for (edges, holes) in [
            (loops(&[&SQUARE]), 0),
            (loops(&[&SQUARE, &HOLE]), 1),
            (loops(&[&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]]), 0),
        ] {
            let t = judge(&edges, target, holes);
            let n = t.points.len() as f64;
            if target >= 40 {
                assert!((0.75..1.3).contains(&(n / target as f64)), "{n} points for {target}");
            }
            let (near, longest) = clearance(&edges, &t);
            assert!(near > 0.3 * longest, "{near} of {longest}");
        }
    }
}

#[test]
fn triangles_of_the_square_are_well_shaped() {
    let t = judge(&loops(&[&SQUARE]), 600, 0);
    let angle = |[i, j, k]: [usize; 3]| {
        let (a, b, c) = (t.points[i], t.points[j], t.points[k]);
        let (u, v) = (minus(b, a), minus(c, a));
        cross(u, v).atan2(dot(u, v)).to_degrees()
    };
    let angles = t.triangles.iter().flat_map(|&[i, j, k]| [angle([i, j, k]), angle([j, k, i]), angle([k, i, j])]);
    let smallest = angles.fold(180.0, f64::min);
    assert!(smallest > 22.0, "smallest angle {smallest} degrees");
}

#[test]
fn slivers_and_near_touching_sides() {
    let one_degree = 1f64.to_radians();
    judge(&loops(&[&[[0.0, 0.0], [1.0, 0.0], [one_degree.cos(), one_degree.sin()]]]), 600, 0);
    judge(&loops(&[&[[0.0, 0.0], [1.0, 0.3], [1.0, 0.3 + 1e-6], [0.0, 1e-6]]]), 600, 0);
    judge(&loops(&[&[[0.0, 0.0], [10.0, 0.0], [10.0, 0.1], [0.0, 0.1]]]), 600, 0);
    // A slit of width 1e-6, and a hole 1e-6 from the outer boundary.
    let slit = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5 + 1e-6, 1.0], [0.5, 0.2], [0.5, 1.0], [0.0, 1.0]];
    judge(&loops(&[&slit]), 600, 0);
    let hole = [[0.3, 1e-6], [0.3, 0.4], [0.6, 0.4], [0.6, 1e-6]];
    judge(&loops(&[&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], &hole]), 600, 1);
    // Edges of very different length: a circle of 720 corners in a square.
    let circle: Vec<_> = (0..720).map(|i| -f64::from(i) * 0.5f64.to_radians()).collect();
    let circle: Vec<_> = circle.iter().map(|a| [0.1 * a.cos(), 0.1 * a.sin()]).collect();
    let t = judge(&loops(&[&SQUARE, &circle]), 600, 1);
    assert!(t.points.len() < 1300, "{} points", t.points.len());
}

#[test]
fn any_unit_of_length_gives_the_same_triangles() {
    let reference = judge(&loops(&[&SQUARE, &HOLE]), 300, 1);
    for unit in [2f64.powi(-300), 2f64.powi(-20), 2f64.powi(300)] {
        let scaled = |c: &[[f64; 2]]| c.iter().map(|p| [p[0] * unit, p[1] * unit]).collect::<Vec<_>>();
        let t = triangulate(&loops(&[&scaled(&SQUARE), &scaled(&HOLE)]), 300).unwrap();
        assert_eq!(t.triangles, reference.triangles);
        assert_eq!(t.boundary, reference.boundary);
    }
}

#[test]
fn bad_polygons_are_named() {
    let clockwise: Vec<_> = SQUARE.iter().rev().copied().collect();
    assert!(matches!(triangulate(&loops(&[&clockwise]), 50), Err(TriangulationError::NoArea { area }) if area == -1.0));
    let bow_tie = [[0.0, 0.0], [2.0, 0.0], [0.5, 1.0], [1.0, 1.0]];
    let bow = triangulate(&loops(&[&[[0.0, 0.0], [3.0, 2.0], [3.0, 0.0], [0.0, 1.0]]]), 50);
    assert!(matches!(bow, Err(TriangulationError::Crossing { .. } | TriangulationError::NoArea { .. })), "{bow:?}");
    assert!(matches!(triangulate(&loops(&[&bow_tie]), 50), Err(TriangulationError::Crossing { .. })));
    let mut open = loops(&[&SQUARE]);
    open[3].1 = [0.0, 0.0];
    assert_eq!(triangulate(&open, 50), Err(TriangulationError::NotClosed { edge: 3 }));
    let mut broken = loops(&[&SQUARE]);
    broken[2].0[1] = f64::NAN;
    assert!(matches!(triangulate(&broken, 50), Err(TriangulationError::NotFinite { edge: 2, .. })));
    assert!(triangulate(&[], 50).is_err());
}

proptest! {
    /// Star-shaped polygons about a point far from or near the origin, with a smaller copy of themselves as a hole.
    #[test]
    fn random_polygons(
        radii in prop::collection::vec(0.15f64..1.0, 3..24),
        turn in 0.0f64..6.3,
        shrink in 0.1f64..0.95,
        with_hole: bool,
        shift in prop::array::uniform2(-3.0f64..3.0),
        size in -6i32..6,
        target in 10usize..800,
    ) {
        let unit = 10f64.powi(size);
        let n = radii.len() as f64;
        let corner = |i: usize, by: f64| {
            let (sin, cos) = (turn + i as f64 * std::f64::consts::TAU / n).sin_cos();
            [unit * (shift[0] + by * radii[i] * cos), unit * (shift[1] + by * radii[i] * sin)]
        };
        let outer: Vec<_> = (0..radii.len()).map(|i| corner(i, 1.0)).collect();
        let hole: Vec<_> = (0..radii.len()).rev().map(|i| corner(i, shrink)).collect();
        if with_hole {
            judge(&loops(&[&outer, &hole]), target, 1);
        } else {
            judge(&loops(&[&outer]), target, 0);
        }
    }
}
