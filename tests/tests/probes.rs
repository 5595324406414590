//! Results along lines and sides against closed forms, and against the points of the same scene.

use steklov_model::summary::{LinePoint, SidePoint, Summary};
use steklov_problem::{ProbeLine, Scene};
use steklov_tests::{Random, scene};

fn summary(scene: &Scene) -> Summary {
    steklov_model::solve(scene).unwrap_or_else(|e| panic!("{}: {e}", scene.title)).summary
}

fn solved(text: &str, overrides: &[&str]) -> Summary {
    summary(&steklov_tests::parse(text, overrides).unwrap_or_else(|e| panic!("{}", e.render())))
}

/// Largest distance of some numbers from others.
fn off<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, |m, d| if d.is_nan() { d } else { f64::max(m, d) })
}

fn is_nothing(p: &LinePoint) -> bool {
    p.displacement.iter().chain(&p.stress).all(|v| v.is_nan()) && p.von_mises.is_nan() && p.body.is_none()
}

const RING: &str = r#"
[body]
circle = { centre = [0.5, -0.25], radius = 2 }
side = "outer"
[[body.holes]]
circle = { centre = [0.5, -0.25], radius = 1 }
side = "hole"
[material]
young = 100
poisson = 0.3
[sides.hole]
pressure = 1
[probe]
lines = [{ from = [0.5, -0.25], to = [3, -0.25], points = 26 }, { from = [0.5, -1.25], to = [0.5, -2.25], points = 11 }]
sides = ["hole", "outer"]
[method]
tolerance = 1e-6
"#;

/// Lame's ring along two radii and both circles: radial and hoop stress A ∓ B/r², u_r = (1+ν)/E ((1-2ν) A r + B/r).
#[test]
fn a_ring_has_lames_stresses_along_radii_and_circles() {
    let told = solved(RING, &[]);
    let (a, b) = (1.0 / 3.0, 4.0 / 3.0);
    let exact = |r: f64| (a - b / (r * r), a + b / (r * r), 0.013 * (0.4 * a * r + b / r));
    let von_mises = |r: f64, t: f64| {
        let z = 0.3 * (r + t);
        (((r - t).powi(2) + (t - z).powi(2) + (z - r).powi(2)) / 2.0).sqrt()
    };
    let mut worst = 0.0_f64;
    for (line, radial) in told.probe_lines.iter().zip([0, 1]) {
        for (k, p) in line.points.iter().enumerate() {
            let r = (p.point[0] - 0.5).hypot(p.point[1] + 0.25);
            assert!(off([p.s], [k as f64 * 0.1]) < 1e-14);
            if !(1.0 - 1e-9..2.0 + 1e-9).contains(&r) {
                assert!(is_nothing(p) && radial == 0, "{p:?}");
                continue;
            }
            let (across, hoop, u) = exact(r);
            let (mut stress, mut displacement) = ([hoop, hoop, 0.0], [0.0; 2]);
            stress[radial] = across;
            displacement[radial] = if radial == 0 { u } else { -u };
            let error = off(p.stress, stress).max(off([p.von_mises], [von_mises(across, hoop)]));
            worst = worst.max(error).max(100.0 * off(p.displacement, displacement));
        }
    }
    let inside = |k: usize| told.probe_lines[k].points.iter().filter(|p| !is_nothing(p)).count();
    assert_eq!((inside(0), inside(1)), (11, 11));
    for (side, r, sign) in [(&told.probe_sides[0], 1.0, -1.0), (&told.probe_sides[1], 2.0, 1.0)] {
        let (across, hoop, u) = exact(r);
        assert!(off([side.points.last().unwrap().s], [std::f64::consts::TAU * r]) < 1e-12);
        assert!(side.points.windows(2).all(|w| w[0].s <= w[1].s + 1e-12 && w[1].piece == 0));
        for p in &side.points {
            // from the first corner on, the body to the left: clockwise about the hole
            let angle = sign * p.s / r;
            assert!(off(p.normal, [sign * angle.cos(), sign * angle.sin()]) < 1e-12, "{p:?}");
            assert!(off(p.point, [0.5 + r * angle.cos(), -0.25 + r * angle.sin()]) < 1e-12, "{p:?}");
            let found = [p.normal_traction, p.tangential_traction, p.hoop_stress, p.von_mises];
            let error = off(found, [across, 0.0, hoop, von_mises(across, hoop)]);
            let displacement = off([p.normal_displacement, p.tangential_displacement], [sign * u, 0.0]);
            worst = worst.max(error).max(100.0 * displacement);
        }
    }
    println!("off by {worst:.1e}");
    assert!(worst < 2e-5, "{worst}");
}

/// A block with constant stress: what lines and sides of all models on it tell is exact.
#[test]
fn a_uniform_stress_is_exact_in_all_models() {
    let text = r#"
[body]
corners = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["floor", "right", "top", "left"]
[material]
young = 100
poisson = 0.25
plane = "stress"
[sides.floor]
displacement = ["free", "0"]
[sides.left]
displacement = ["0", "free"]
[sides.top]
traction = ["0", "-3"]
[sides.right]
traction = ["5", "0"]
[grid]
coarse = [4, 2]
fine = [2, 2]
[probe]
lines = [{ from = [-0.5, 0.25], to = [2.5, 0.25], points = 31 }, { from = [0, 0], to = [2, 1] }, { from = [0, 1], to = [2, 1] }]
sides = ["right", "top"]
"#;
    let von_mises = 49.0_f64.sqrt();
    for model in ["bem", "fem", "msfem"] {
        let told = solved(text, &[&format!("method.model={model:?}"), "method.refine=\"none\""]);
        let exact = |[x, y]: [f64; 2]| [0.0575 * x, -0.0425 * y];
        let points = told.probe_lines.iter().flat_map(|line| &line.points);
        let (outside, inside): (Vec<_>, Vec<_>) = points.partition(|p| is_nothing(p));
        assert_eq!((outside.len(), inside.len()), (10, 223), "{model}");
        let of_line = |p: &&LinePoint| {
            off(p.stress, [5.0, -3.0, 0.0])
                .max(off([p.von_mises], [von_mises]))
                .max(off(p.displacement, exact(p.point)))
        };
        let mut worst = inside.iter().map(of_line).fold(0.0, f64::max);
        for (side, normal, hoop) in [(&told.probe_sides[0], 5.0, -3.0), (&told.probe_sides[1], -3.0, 5.0)] {
            for p in &side.points {
                worst = worst.max(off([p.normal_traction, p.tangential_traction, p.hoop_stress], [normal, 0.0, hoop]));
                let u = exact(p.point);
                let [un, ut] = if hoop < 0.0 { u } else { [u[1], -u[0]] };
                worst = worst.max(off([p.normal_displacement, p.tangential_displacement], [un, ut]));
                worst = worst.max(off([p.von_mises], [von_mises]));
            }
        }
        let count = |k: usize| told.probe_sides[k].points.len();
        if model != "bem" {
            assert_eq!((count(0), count(1)), (4, 8), "{model}: one in the middle of each fine cell");
        }
        println!("{model}: off by {worst:.1e}");
        assert!(worst < 1e-10, "{model}: {worst}");
    }
}

/// Pure bending, σ_xx = y: boundary elements of degree 2 have it. Bilinear elements have no quadratic displacement, whose slope across
/// a cell is missing in the stress at its side: the error falls as h.
#[test]
fn pure_bending_is_exact_or_of_first_order_on_grids() {
    let text = r#"
[body]
corners = [[0, -1], [4, -1], [4, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 100
poisson = 0.3
[sides.right]
traction = ["y", "0"]
[sides.left]
traction = ["-y", "0"]
[probe]
lines = [{ from = [2, -1], to = [2, 1], points = 21 }]
sides = ["top", "right"]
[grid]
coarse = [4, 2]
fine = [4, 4]
[method]
refine = "none"
"#;
    let error = |overrides: &[&str]| {
        let told = solved(text, overrides);
        let inner = |p: &&SidePoint| (p.point[0] - 2.0).abs() < 1.0;
        let of_top = |p: &SidePoint| off([p.hoop_stress, p.normal_traction, p.tangential_traction], [1.0, 0.0, 0.0]);
        let of_line = |p: &LinePoint| off(p.stress, [p.point[1], 0.0, 0.0]);
        let top = told.probe_sides[0].points.iter().filter(inner).map(of_top).fold(0.0, f64::max);
        let right =
            told.probe_sides[1].points.iter().map(|p| off([p.normal_traction], [p.point[1]])).fold(0.0, f64::max);
        [told.probe_lines[0].points.iter().map(of_line).fold(0.0, f64::max), top, right]
    };
    let exact = error(&["method.model=\"bem\"", "method.degree=2"]);
    let grids = [4, 8].map(|n| error(&["method.model=\"fem\"", &format!("grid.fine=[{n}, {n}]")]));
    println!("{exact:?} {grids:?}");
    assert!(exact.iter().all(|e| *e < 1e-9), "{exact:?}");
    for (coarse, fine) in grids[0].iter().zip(grids[1]) {
        assert!((1.9..2.1).contains(&(coarse / fine)) && *coarse < 0.07, "{grids:?}");
    }
}

/// Two tied blocks of unlike stiffness and one apart: points name their body, where two meet the first; gaps are empty.
#[test]
fn points_of_several_bodies_name_theirs() {
    let block = |name: &str, x: f64, young: f64| {
        format!(
            "[[body]]\nname = {name:?}\ncorners = [[{x:?}, 0], [{:?}, 0], [{:?}, 1], [{x:?}, 1]]\n\
             sides = [\"bottom\", \"right\", \"top\", \"left\"]\nmaterial = {{ young = {young:?}, poisson = 0 }}\n",
            x + 1.0,
            x + 1.0
        )
    };
    let text = block("b", 1.0, 50.0)
        + &block("a", 0.0, 100.0)
        + &block("c", 2.5, 10.0)
        + "[[interface]]\nbetween = [\"a.right\", \"b.left\"]\ntied = true\n\
           [sides.a.left]\ndisplacement = [\"0\", \"0\"]\n[sides.b.right]\ntraction = [\"1\", \"0\"]\n\
           [sides.c.bottom]\ndisplacement = [\"0\", \"0\"]\n[sides.c.top]\ntraction = [\"0\", \"2\"]\n\
           [probe]\nlines = [{ from = [-0.5, 0.3], to = [4, 0.3], points = 46 }, { from = [1, 0.1], to = [1, 0.9] }]\n\
           sides = [\"b.left\"]\n";
    let told = solved(&text, &[]);
    for p in &told.probe_lines[0].points {
        let x = p.point[0];
        let inside = |from: f64, to: f64| (from - 1e-9..=to + 1e-9).contains(&x);
        let (body, stress, displacement) = match x {
            _ if inside(1.0, 2.0) => ("b", [1.0, 0.0, 0.0], [0.01 + (x - 1.0) / 50.0, 0.0]),
            _ if inside(0.0, 1.0) => ("a", [1.0, 0.0, 0.0], [x / 100.0, 0.0]),
            _ if inside(2.5, 3.5) => ("c", [0.0, 2.0, 0.0], [0.0, 0.06]),
            _ => {
                assert!(is_nothing(p), "{p:?}");
                continue;
            }
        };
        assert_eq!(p.body.as_deref(), Some(body), "{p:?}");
        assert!(off(p.stress, stress) < 1e-9 && off(p.displacement, displacement) < 1e-11, "{p:?}");
    }
    // b is first in the scene
    assert!(told.probe_lines[1].points.iter().all(|p| p.body.as_deref() == Some("b")));
    let side = &told.probe_sides[0];
    assert_eq!(side.side, "b.left");
    assert!(side.points.iter().all(|p| off([p.normal_traction, p.normal_displacement], [1.0, -0.01]) < 1e-9));
}

/// A disc in a medium of its own material under remote stress is not noticed: both sides of their interface, by all models that
/// have one. In a hole of the body there is nothing.
#[test]
fn lines_go_on_into_the_medium() {
    let square = r#"
[body]
corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
sides = ["wall", "wall", "wall", "wall"]
[material]
young = 50
poisson = 0.3
[grid]
coarse = [4, 4]
fine = [2, 2]
[exterior]
young = 50
poisson = 0.3
remote_stress = [2, -1, 0.5]
[probe]
lines = [{ from = [-3, 0.2], to = [3, 0.1], points = 61 }]
sides = ["wall"]
[method]
refine = "none"
"#;
    for model in ["bem", "fem-bem", "msfem-bem"] {
        let told = solved(square, &[&format!("method.model={model:?}")]);
        let mut worst = 0.0_f64;
        for p in &told.probe_lines[0].points {
            let inside = p.point[0].abs() <= 1.0 + 1e-9;
            assert_eq!(p.body.as_deref(), Some(if inside { "body" } else { "medium" }), "{model}: {p:?}");
            worst = worst.max(off(p.stress, [2.0, -1.0, 0.5]));
        }
        for p in &told.probe_sides[0].points {
            let [nx, ny] = p.normal;
            let normal = 2.0 * nx * nx - ny * ny + nx * ny;
            worst = worst.max(off(p.stress, [2.0, -1.0, 0.5])).max(off([p.normal_traction], [normal]));
        }
        println!("{model}: off by {worst:.1e}");
        assert!(worst < 1e-8, "{model}: {worst}");
    }
    let hole = "[[body.holes]]\ncorners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]\n\
                sides = [\"hole\", \"hole\", \"hole\", \"hole\"]\n[material]";
    let told = solved(&square.replace("[material]", hole), &["method.model=\"fem-bem\""]);
    let empty: Vec<f64> = told.probe_lines[0].points.iter().filter(|p| is_nothing(p)).map(|p| p.point[0]).collect();
    assert_eq!(empty.len(), 9, "{empty:?}");
    assert!(empty.iter().all(|x| x.abs() < 0.45), "{empty:?}");
}

/// No number where stresses are infinite: at a re-entrant corner, at the ends of a held side, at the tips of a crack.
#[test]
fn infinite_stresses_are_no_numbers() {
    let corner = r#"
[body]
corners = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
sides = ["bottom", "right", "step", "riser", "top", "left"]
[material]
young = 100
poisson = 0.3
[sides.top]
displacement = ["0", "0"]
[sides.right]
traction = ["0", "-1"]
[probe]
lines = [{ from = [0, 0], to = [2, 2], points = 41 }]
sides = ["step", "top", "bottom"]
[method]
tolerance = 1e-2
"#;
    let told = solved(corner, &[]);
    let unbounded = |p: &&LinePoint| p.stress_unbounded && p.stress[0].is_nan() && p.von_mises.is_nan();
    let places: Vec<_> =
        told.probe_lines[0].points.iter().filter(unbounded).map(|p| (p.point, p.displacement)).collect();
    assert!(matches!(places[..], [([1.0, 1.0], [u, _])] if u.is_finite()), "{places:?}");
    let of_side = |k: usize| -> Vec<[f64; 2]> {
        let points = told.probe_sides[k].points.iter();
        points
            .filter(|p| p.stress_unbounded && p.hoop_stress.is_nan() && p.normal_traction.is_nan())
            .map(|p| p.point)
            .collect()
    };
    assert_eq!((of_side(0), of_side(1)), (vec![[1.0, 1.0]], vec![[1.0, 2.0], [0.0, 2.0]]));
    assert!(of_side(2).is_empty());

    let crack = |normal: &str| {
        format!(
            "[body]\ncorners = [[-2, -2], [2, -2], [2, 2], [-2, 2]]\nsides = [\"bottom\", \"right\", \"top\", \"left\"]\n\
             [[body.cracks]]\npoints = [[-0.5, 0], [0.5, 0]]\n[material]\nyoung = 100\npoisson = 0.3\n\
             [sides.bottom]\ntraction = [\"0\", \"-({normal})\"]\n[sides.top]\ntraction = [\"0\", \"{normal}\"]\n\
             [probe]\npoints = [[0.5, 0]]\nlines = [{{ from = [-1, 0], to = [1, 0], points = 9 }}]\nsides = [\"crack.left\"]\n\
             [method]\ntolerance = 1e-2\n"
        )
    };
    let told = solved(&crack("1"), &[]);
    let at: Vec<f64> = told.probe_lines[0].points.iter().filter(unbounded).map(|p| p.point[0]).collect();
    assert_eq!(at, [-0.5, 0.5]);
    assert!(told.probe[0].stress_unbounded);
    let ends: Vec<f64> =
        told.probe_sides[0].points.iter().filter(|p| p.stress_unbounded).map(|p| p.point[0].abs()).collect();
    assert_eq!(ends, [0.5, 0.5]);
}

/// Along random lines the numbers are those of `points`, of all models and of the mean of random input.
#[test]
fn lines_are_rows_of_points() {
    let mut random = Random::new(11);
    let names = ["kirsch", "15-block-on-floor", "random-modulus", "bar-of-random-cells", "transmission"];
    for name in names {
        let scene = scene(name, &["method.tolerance=1e-2"]);
        let outline = &scene.problem.outline;
        let corners: Vec<[f64; 2]> = outline.edges().iter().map(|e| e.start).collect();
        let mut any = || {
            let [a, b] = [0, 1].map(|_| corners[random.below(corners.len())]);
            let part = random.between(0.0, 1.0);
            [0, 1].map(|i| a[i] + part * (b[i] - a[i]))
        };
        let (line, points) = loop {
            let line = ProbeLine { from: any(), to: any(), points: 17 };
            let there = |(_, x): &(f64, [f64; 2])| scene.problem.spot(*x).is_some();
            let points: Vec<[f64; 2]> = line.places().into_iter().filter(there).map(|(_, x)| x).collect();
            if points.len() > 3 && line.check(&scene.problem).is_ok() {
                break (line, points);
            }
        };
        let told = summary(&Scene { probe: points, probe_lines: vec![line], ..scene });
        let along: Vec<&LinePoint> =
            told.probe_lines[0].points.iter().filter(|p| !p.displacement[0].is_nan()).collect();
        assert_eq!(along.len(), told.probe.len(), "{name}");
        for (a, b) in along.iter().zip(&told.probe) {
            assert_eq!(
                (a.point, a.displacement, a.stress_unbounded),
                (b.point, b.displacement, b.stress_unbounded),
                "{name}"
            );
            assert!(a.stress == b.stress || a.stress[0].is_nan() && b.stress[0].is_nan(), "{name}: {a:?} {b:?}");
        }
        println!("{name}: {} points from {:?} to {:?}", along.len(), line.from, line.to);
    }
}

/// A side over the first corner of its loop is one piece; edges that do not join are pieces one after the other, on all loops.
#[test]
fn sides_are_told_piece_after_piece() {
    let square = |sides: [&str; 4], hole: [&str; 4]| {
        format!(
            "[body]\ncorners = [[0, 0], [3, 0], [3, 3], [0, 3]]\nsides = {sides:?}\n\
             [[body.holes]]\ncorners = [[1, 1], [2, 1], [2, 2], [1, 2]]\nsides = {hole:?}\n\
             [material]\nyoung = 1\npoisson = 0.3\n[sides.held]\ndisplacement = [0, 0]\n[body_force]\nvalue = [0, -1]\n[probe]\nsides = [\"wall\"]\n\
             [method]\nrefine = \"none\"\n"
        )
    };
    let ends = |text: &str, model: &str| {
        let told = solved(text, &[&format!("method.model={model:?}"), "grid={ coarse = [3, 3], fine = [2, 2] }"]);
        let points = &told.probe_sides[0].points;
        let pieces = points.last().unwrap().piece + 1;
        let of = |piece: usize| points.iter().filter(move |p| p.piece == piece);
        // along each piece s grows by the way from point to point, and t points that way
        for pair in points.windows(2).filter(|pair| pair[0].piece == pair[1].piece) {
            let way = [0, 1].map(|i| pair[1].point[i] - pair[0].point[i]);
            let corner = pair[0].normal != pair[1].normal;
            let [nx, ny] = pair[0].normal;
            assert!(corner || off([-ny * way[0] + nx * way[1]], [pair[1].s - pair[0].s]) < 1e-12, "{pair:?}");
        }
        let of_piece = |piece: usize| (of(piece).next().unwrap().s, of(piece).next_back().unwrap().s);
        (0..pieces).map(of_piece).collect::<Vec<_>>()
    };
    let (free, held) = ("free", "held");
    let over_the_corner = square(["wall", held, "wall", "wall"], [free; 4]);
    assert_eq!(ends(&over_the_corner, "bem"), [(0.0, 9.0)]);
    assert_eq!(ends(&over_the_corner, "fem"), [(0.25, 8.75)]);
    let apart = square(["wall", held, "wall", held], ["wall"; 4]);
    assert_eq!(ends(&apart, "bem"), [(0.0, 3.0), (3.0, 6.0), (6.0, 10.0)]);
    assert_eq!(ends(&apart, "msfem"), [(0.25, 2.75), (3.25, 5.75), (6.25, 9.75)]);
}
