//! Triangles of result files follow the solution: at random points the interpolated von Mises stress is that of the solution to half
//! a step of the colours, the displacement to 1/64 of the largest one, and points of the outline lie on the curves.

use std::path::Path;

use steklov_bem_operators::distance_to_segment;
use steklov_elastic::plane::{cross, distance, minus, norm};
use steklov_fields::triangulate::triangulate;
use steklov_io::vtkhdf::{self, Field, Grid};
use steklov_io::{create_atomically, open};
use steklov_model::run::adaptive_loop::Run;
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_picture::{BANDS, colour_interval, limited};
use steklov_plan::plan;
use steklov_problem::Scene;
use steklov_result::record::Record;
use steklov_tests::{Random, adapt, scene};

/// The part of seeded points with an error of at most half a step, and the largest error in steps: the 32nd part of the colours for
/// von Mises stress, of the largest displacement for displacement.
///
/// Points are spread over the area; those within a pixel of the outline are left out, as they may be outside of a curve.
fn judged(scene: &Scene, run: &Run<BoundaryElements>, grid: &Grid, count: usize) -> (f64, f64) {
    let values = |name: &str| &grid.point_data.iter().find(|f| f.name == name).expect("a field").values;
    let von_mises = values("von_mises");
    let ends = colour_interval(&grid.points, &grid.triangles, von_mises);
    let displacement = values("displacement");
    let farthest = displacement.chunks(3).map(|u| norm([u[0], u[1]])).fold(0.0, f64::max);
    let bodies = grid.point_data.iter().find(|f| f.name == "body").map(|f| &f.values);
    let mut sum = 0.0;
    let sums: Vec<f64> = grid
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| grid.points[i]);
            sum += cross(minus(b, a), minus(c, a)) / 2.0;
            sum
        })
        .collect();
    let span = |i: usize| {
        let of = || grid.points.iter().map(|p| p[i]);
        of().fold(f64::NEG_INFINITY, f64::max) - of().fold(f64::INFINITY, f64::min)
    };
    let pixel = span(0).max(span(1)) / 1200.0;
    let mut random = Random::new(7);
    let (mut right, mut all, mut largest) = (0, 0, 0.0f64);
    while all < count {
        let at = random.between(0.0, sum);
        let t = grid.triangles[sums.partition_point(|s| *s < at).min(sums.len() - 1)];
        let (r, s) = (random.between(0.0, 1.0).sqrt(), random.between(0.0, 1.0));
        let weights = [1.0 - r, r * (1.0 - s), r * s];
        let x = [0, 1].map(|k| (0..3).map(|i| weights[i] * grid.points[t[i]][k]).sum::<f64>());
        if grid.lines.iter().any(|line| distance_to_segment(x, line.map(|i| grid.points[i])) < pixel) {
            continue;
        }
        let body = bodies.map_or(0, |b| b[t[0]] as usize);
        let (true_displacement, stress) = run.last.inside(body, x);
        let true_value = scene.problem.bodies[body].material().von_mises(stress);
        let interpolated: f64 = (0..3).map(|i| weights[i] * limited(von_mises[t[i]], ends)).sum();
        let error = (true_value.clamp(ends[0], ends[1]) - interpolated.clamp(ends[0], ends[1])).abs();
        let moved = [0, 1].map(|k| (0..3).map(|i| weights[i] * displacement[3 * t[i] + k]).sum::<f64>());
        let steps = BANDS as f64 * (error / (ends[1] - ends[0])).max(distance(moved, true_displacement) / farthest);
        all += 1;
        right += usize::from(steps <= 0.5);
        largest = largest.max(steps);
    }
    (right as f64 / all as f64, largest)
}

/// The fields of a result on triangles of one size, with straight sides.
fn uniform(scene: &Scene, run: &Run<BoundaryElements>) -> Grid {
    let polygon = &scene.problem.outline;
    let edges: Vec<_> =
        polygon.traversal(0).iter().map(|&k| &polygon.edges()[k]).map(|e| (e.start, e.end, 0)).collect();
    let t = triangulate(&edges, 800).expect("triangles");
    let at = |i: usize| match t.boundary[i] {
        Some((k, s)) => {
            let edge = polygon.traversal(0)[k];
            let s = if polygon.edges()[edge].reversed { 1.0 - s } else { s };
            run.last.elastic_field().on_edge(edge, s)
        }
        None => run.last.inside(0, t.points[i]),
    };
    let values: Vec<_> = (0..t.points.len()).map(at).collect();
    let material = scene.problem.bodies[0].material();
    let field = |name: &str, components, values| Field { name: name.into(), unit: "1".into(), components, values };
    let point_data = vec![
        field("von_mises", 1, values.iter().map(|v| material.von_mises(v.1)).collect()),
        field("displacement", 3, values.iter().flat_map(|v| [v.0[0], v.0[1], 0.0]).collect()),
    ];
    Grid { points: t.points, triangles: t.triangles, lines: t.outline, point_data, ..Grid::default() }
}

fn solved(name: &str) -> (Scene, Run<BoundaryElements>, Grid) {
    let scene = scene(name, &[]);
    let run = adapt(&scene).unwrap_or_else(|e| panic!("{name}: {e}"));
    let grid = Record::new(&scene, plan(&scene), &run, None, Path::new("none.vtkhdf"), 0.0).grid;
    (scene, run, grid)
}

#[test]
fn fields_are_right_to_half_a_step_of_the_colours() {
    for name in ["15-block-on-floor", "19-l-shape", "20-crack", "54-elliptic-hole", "56-gear-tooth", "60-two-cylinders"]
    {
        let (scene, run, grid) = solved(name);
        let (part, largest) = judged(&scene, &run, &grid, 2000);
        println!("{name}: {} points, {:.2} % right, at most {largest:.2} steps", grid.points.len(), 100.0 * part);
        assert!(part >= 0.99, "{name}: {part}");
    }
}

#[test]
fn triangles_of_one_size_do_not_follow_the_solution() {
    for name in ["15-block-on-floor", "20-crack", "56-gear-tooth"] {
        let (scene, run, _) = solved(name);
        let (part, largest) = judged(&scene, &run, &uniform(&scene, &run), 2000);
        println!("{name}: {:.2} % right, at most {largest:.2} steps", 100.0 * part);
        assert!(part < 0.99, "{name}: {part}");
    }
}

#[test]
fn the_outline_lies_on_the_curves() {
    for name in ["52-brazilian-disc", "54-elliptic-hole", "56-gear-tooth", "60-two-cylinders"] {
        let (scene, run, grid) = solved(name);
        let mesh = &run.last.mesh;
        let ends = (0..mesh.len()).map(|e| mesh.ends(e));
        let size = ends.map(|[a, b]| distance(a, b)).fold(0.0, f64::max);
        for &[i, _] in &grid.lines {
            let x = grid.points[i];
            let from = |e: usize| match mesh.is_line(e) {
                true => distance_to_segment(x, mesh.ends(e)),
                false => mesh.curve(e).nearest(x).0,
            };
            let away = (0..mesh.len()).map(from).fold(f64::INFINITY, f64::min);
            assert!(away < 1e-9 * size, "{}: {x:?} is {away} from the outline", scene.title);
        }
    }
}

/// The displacement at x of the lines along y = 0 that run in the direction `sign`, interpolated; NaN beside them.
fn along(grid: &Grid, displacement: &[f64], x: f64, sign: f64) -> [f64; 2] {
    let on = |[i, j]: &&[usize; 2]| {
        let (a, b) = (grid.points[*i], grid.points[*j]);
        a[1].abs().max(b[1].abs()) < 1e-12 && sign * (x - a[0]) >= 0.0 && sign * (b[0] - x) > 0.0
    };
    let Some(&[i, j]) = grid.lines.iter().find(on) else { return [f64::NAN; 2] };
    let s = (x - grid.points[i][0]) / (grid.points[j][0] - grid.points[i][0]);
    [0, 1].map(|k| (1.0 - s) * displacement[3 * i + k] + s * displacement[3 * j + k])
}

#[test]
fn both_faces_of_a_crack_open_as_in_the_solution() {
    let (_, run, grid) = solved("66-crack-that-closes");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("crack.vtkhdf");
    create_atomically(&path, false, |file| vtkhdf::write(file, &grid)).expect("a file");
    let read = vtkhdf::read(&open(&path).expect("a file")).expect("a grid");
    let displacement = &read.point_data.iter().find(|f| f.name == "displacement").expect("a field").values;
    let mesh = &run.last.mesh;
    // the face whose body lies above is traversed to the right
    let true_value = |x: f64, sign: f64| {
        let on = |e: &usize| {
            let [a, b] = mesh.ends(*e);
            a[1].abs().max(b[1].abs()) < 1e-12 && sign * (x - a[0]) >= 0.0 && sign * (b[0] - x) > 0.0
        };
        let e = (0..mesh.len()).find(on).expect("an element");
        let [a, b] = mesh.ends(e);
        run.last.elastic_field().on_boundary(e, 2.0 * (x - a[0]) / (b[0] - a[0]) - 1.0).0
    };
    let (mut largest, mut error, mut at_tips) = (0.0f64, 0.0f64, 0.0f64);
    for i in 0..2000 {
        let x = -0.4 + 0.8 * (f64::from(i) + 0.5) / 2000.0;
        let jump = |of: &dyn Fn(f64) -> [f64; 2]| minus(of(1.0), of(-1.0));
        let drawn = jump(&|sign| along(&read, displacement, x, sign));
        let solved = jump(&|sign| true_value(x, sign));
        assert!(drawn[0].is_finite(), "no face at {x}");
        largest = largest.max(norm(solved));
        // a root grows from each tip, and no segment is shorter than a sixteenth of a pixel
        match x.abs() < 0.4 - 2.0 / 1200.0 {
            true => error = error.max(distance(drawn, solved)),
            false => at_tips = at_tips.max(distance(drawn, solved)),
        }
    }
    let percent = |error: f64| 100.0 * error / largest;
    println!("opening {largest:.4e}, {:.3} % off, {:.3} % in the pixels at the tips", percent(error), percent(at_tips));
    assert!(error < 0.01 * largest && at_tips < 0.01 * largest, "{error} {at_tips} of {largest}");
}
