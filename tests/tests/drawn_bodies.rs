//! What is drawn of several bodies and of cracks: bodies that touch are seen to touch, and lines only where there is a boundary.

use std::path::Path;

use steklov_bem_operators::distance_to_segment;
use steklov_elastic::plane::{cross, distance, norm};
use steklov_io::vtkhdf::Grid;
use steklov_picture::exaggeration;
use steklov_plan::plan;
use steklov_result::record::Record;
use steklov_tests::{adapt, scene};

fn solved(name: &str) -> Record {
    let scene = scene(name, &[]);
    let run = adapt(&scene).unwrap_or_else(|e| panic!("{name}: {e}"));
    Record::new(&scene, plan(&scene), &run, None, Path::new("none.vtkhdf"), 0.0)
}

fn size(grid: &Grid) -> f64 {
    let extent = |i: usize| {
        let along = || grid.points.iter().map(|p| p[i]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    extent(0).max(extent(1))
}

/// The lines of each body, moved by k times their displacements.
fn moved(grid: &Grid, k: f64) -> [Vec<[[f64; 2]; 2]>; 2] {
    let field = |name: &str| &grid.point_data.iter().find(|f| f.name == name).expect("a field").values;
    let (u, body) = (field("displacement"), field("body"));
    let at = |i: usize| [0, 1].map(|c| grid.points[i][c] + k * u[3 * i + c]);
    [0.0, 1.0].map(|b| grid.lines.iter().filter(|l| body[l[0]] == b).map(|l| l.map(at)).collect())
}

/// Whether a point is inside of closed lines, by the crossings of a ray that runs along no side of the scenes.
fn is_inside(lines: &[[[f64; 2]; 2]], x: [f64; 2]) -> bool {
    let (sin, cos) = 0.7351f64.sin_cos();
    let turned = |p: [f64; 2]| [cos * (p[0] - x[0]) - sin * (p[1] - x[1]), sin * (p[0] - x[0]) + cos * (p[1] - x[1])];
    let crosses = |[a, b]: &[[f64; 2]; 2]| {
        let (a, b) = (turned(*a), turned(*b));
        (a[1] > 0.0) != (b[1] > 0.0) && (cross(a, b) > 0.0) == (b[1] > a[1])
    };
    lines.iter().filter(|line| crosses(line)).count() % 2 == 1
}

fn away(lines: &[[[f64; 2]; 2]], x: [f64; 2]) -> f64 {
    lines.iter().map(|line| distance_to_segment(x, *line)).fold(f64::INFINITY, f64::min)
}

/// How deep one of two bodies is in the other, and how far they are apart, in parts of their extent. A medium is outside of its lines.
fn overlap_and_distance(grid: &Grid, medium: Option<usize>, k: f64) -> [f64; 2] {
    let bodies = moved(grid, k);
    let [mut depth, mut apart] = [0.0f64, f64::INFINITY];
    for [one, other] in [[0, 1], [1, 0]] {
        for &[x, _] in &bodies[one] {
            let away = away(&bodies[other], x);
            apart = apart.min(away);
            if is_inside(&bodies[other], x) != (medium == Some(other)) {
                depth = depth.max(away);
            }
        }
    }
    [depth, apart].map(|d| d / size(grid))
}

#[test]
fn bodies_that_touch_are_drawn_so() {
    for (name, medium, is_limited) in [
        ("60-two-cylinders", None, true),
        ("62-shrink-fit-rings", None, true),
        ("64-pin-in-a-hole", Some(1), true),
        ("65-lining-with-friction", Some(1), false),
    ] {
        let record = solved(name);
        let largest = record.displacement.iter().map(|u| norm(*u)).fold(0.0, f64::max);
        let ratio = largest / size(&record.grid);
        let [wanted, drawn] = [f64::INFINITY, record.largest_factor().factor].map(|most| exaggeration(ratio, most));
        let [free, limited] = [wanted, drawn].map(|k| overlap_and_distance(&record.grid, medium, k));
        println!("{name}: {wanted} times {free:?}, {drawn} times {limited:?}");
        assert_eq!(drawn < wanted, is_limited, "{name}");
        assert!(limited.iter().all(|d| *d < 5e-3), "{name}: {limited:?}");
        assert_eq!(free.iter().any(|d| *d > 5e-3), is_limited, "{name}: {free:?}");
    }
}

#[test]
fn no_line_is_drawn_beyond_the_tips_of_a_crack() {
    // faces from (-0.4, 0) to (0.4, 0) in a square with sides 2
    let grid = solved("66-crack-that-closes").grid;
    let length = |of: fn(f64) -> bool| -> f64 {
        let lines = grid.lines.iter().map(|l| l.map(|i| grid.points[i]));
        lines.filter(|[a, b]| of(a[1].abs().max(b[1].abs()))).map(|[a, b]| distance(a, b)).sum()
    };
    assert!((length(|y| y < 1e-12) - 1.6).abs() < 1e-12, "faces");
    assert!((length(|_| true) - 9.6).abs() < 1e-12, "all");
}

/// Corners of a tunnel, whose displacements have infinite slopes, are drawn without loops that could be seen.
#[test]
fn no_loop_is_seen_at_a_corner() {
    let record = solved("45-tunnel");
    let grid = &record.grid;
    let u = &grid.point_data.iter().find(|f| f.name == "displacement").expect("a field").values;
    // the largest distance of a crossing from its corner, in parts of the extent
    let loops = |k: f64| -> f64 {
        let at = |i: usize| [0, 1].map(|c| grid.points[i][c] + k * u[3 * i + c]);
        let lines: Vec<[[f64; 2]; 2]> = grid.lines.iter().map(|l| l.map(at)).collect();
        let is_corner = |i: &usize| grid.points[*i].iter().all(|x| x.abs() == 1.0);
        let corners: Vec<[f64; 2]> = grid.lines.as_flattened().iter().copied().filter(is_corner).map(at).collect();
        let apart = |[a, b]: [[f64; 2]; 2], x: [f64; 2]| cross([b[0] - a[0], b[1] - a[1]], [x[0] - a[0], x[1] - a[1]]);
        let meet = |l: [[f64; 2]; 2], m: [[f64; 2]; 2]| {
            apart(l, m[0]) * apart(l, m[1]) < 0.0 && apart(m, l[0]) * apart(m, l[1]) < 0.0
        };
        let crosses = |i: &usize| (0..lines.len()).any(|j| meet(lines[*i], lines[j]));
        let off = |i: usize| corners.iter().map(|c| distance(lines[i][0], *c)).fold(f64::INFINITY, f64::min);
        (0..lines.len()).filter(crosses).map(off).fold(0.0, f64::max) / size(grid)
    };
    let largest = record.displacement.iter().map(|u| norm(*u)).fold(0.0, f64::max);
    let ratio = largest / size(grid);
    let [wanted, drawn] = [f64::INFINITY, record.largest_factor().factor].map(|most| exaggeration(ratio, most));
    let found = [wanted, drawn].map(loops);
    println!("{wanted} times: {}, {drawn} times: {}", found[0], found[1]);
    assert!(found[0] > 1e-2 && found[1] < 5e-3 && drawn < wanted, "{wanted} times, {drawn} times: {found:?}");
}
