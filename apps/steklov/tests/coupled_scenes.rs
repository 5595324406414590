//! Bodies on grids in an unbounded medium: against closed forms and other discretisations, and what is refused.

use std::sync::atomic::AtomicUsize;

use steklov_document::SceneError;
use steklov_document::SceneErrorKind as Kind;
use steklov_model::grid::OnGrid;
use steklov_model::run::adaptive_loop::{self, Progress, Run};
use steklov_model::summary::Summary;
use steklov_problem::{DataErrorKind, Scene};

/// A square of one material in a medium of another, under remote stress.
const SQUARE: &str = r#"title = "square"
[body]
corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 10
poisson = 0.3
[exterior]
young = 10
poisson = 0.3
remote_stress = [1, -0.5, 0.25]
[grid]
coarse = [4, 4]
fine = [2, 2]
[probe]
points = [[0.1, 0.2], [0.5, 0.1], [0.7, 0.4], [-40, 3]]
[method]
model = "fem-bem"
refine = "none"
"#;

fn parse(text: &str, overrides: &[&str]) -> Result<Scene, SceneError> {
    let overrides: Vec<String> = overrides.iter().map(|&s| s.to_owned()).collect();
    steklov_document::parse(text, "scene.toml", &overrides)
}

fn finished(text: &str, overrides: &[&str]) -> (Scene, Run<OnGrid>) {
    let scene = parse(text, overrides).unwrap_or_else(|e| panic!("{}", e.render()));
    let progress = Progress::<OnGrid>::new(&scene, Vec::new()).unwrap();
    let run = adaptive_loop::run(&scene, progress, &AtomicUsize::new(0), &mut |_, _| Ok(())).unwrap();
    (scene, run)
}

fn solve(text: &str, overrides: &[&str]) -> Summary {
    let (scene, run) = finished(text, overrides);
    Summary::of_run(&scene, &run, None)
}

/// Largest difference of two lists of numbers.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A body of the material of the medium changes nothing, whatever the elements inside and outside: the field is that of the
/// remote stress, and no error is estimated.
#[test]
fn an_interface_between_equal_materials_is_invisible() {
    let variants: [&[&str]; 6] = [
        &[],
        &["method.model=\"msfem-bem\""],
        &["method.model=\"msfem-bem\"", "grid.basis=\"oscillatory\""],
        &["method.degree=3"],
        &["method.elements=24", "method.degree=2"],
        &["exterior.at_infinity=\"bounded\""],
    ];
    for plane in ["strain", "stress"] {
        for overrides in variants {
            let plane_key = format!("material.plane=\"{plane}\"");
            let overrides: Vec<&str> = overrides.iter().copied().chain([plane_key.as_str()]).collect();
            let summary = solve(SQUARE, &overrides);
            for probe in &summary.probe {
                let off = apart(&probe.stress, &[1.0, -0.5, 0.25]);
                assert!(off < 1e-10, "{overrides:?} {:?}: {off:e}", probe.point);
                let ([x, y], e, nu) = (probe.point, 10.0, 0.3);
                let (e, nu) = if plane == "strain" { (e / (1.0 - nu * nu), nu / (1.0 - nu)) } else { (e, nu) };
                let (xx, yy, xy) = ((1.0 + 0.5 * nu) / e, (-0.5 - nu) / e, 0.25 * (1.0 + nu) / e);
                let off = apart(&probe.displacement, &[xx * x + xy * y, xy * x + yy * y]);
                assert!(off < 1e-11 * x.abs().max(1.0), "{overrides:?} {:?}: {off:e}", probe.point);
            }
            assert!(summary.estimate_relative.unwrap() < 1e-6, "{overrides:?} {:?}", summary.estimate_relative);
            let exterior = summary.exterior.unwrap();
            assert!(exterior.balanced && exterior.constant.iter().all(|a| a.abs() < 1e-12), "{exterior:?}");
        }
    }
}

/// Lengths of another unit, far from the origin: the same stresses; displacements differ by the remote strain's alone.
#[test]
fn fields_do_not_depend_on_units_and_places() {
    let soft = &["exterior.young=2", "exterior.displacement_jump=[\"0.01*x\", \"-0.02*y\"]"];
    let one = solve(SQUARE, soft);
    let scaled = SQUARE
        .replace("[[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]", "[[0, 0], [3000, 0], [3000, 3000], [0, 3000]]")
        .replace(
            "[[0.1, 0.2], [0.5, 0.1], [0.7, 0.4], [-40, 3]]",
            "[[1800, 2100], [3000, 1800], [3600, 2700], [-118500, 10500]]",
        );
    let jump = "exterior.displacement_jump=[\"0.01*(x-1500)\", \"-0.02*(y-1500)\"]";
    let other = solve(&scaled, &["exterior.young=2", jump]);
    for (a, b) in one.probe.iter().zip(&other.probe) {
        let off = apart(&a.stress, &b.stress);
        assert!(off < 1e-9, "{:?} {off:e}", a.point);
    }
    let ratio = other.energy / one.energy / 9e6;
    assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
}

/// The errors of a known solution by an independent code (energy norm inside, norm of V of the traction's error against its
/// means): the estimate follows them, and
/// residuals are 3 to 10 times as large. The estimate has parts that these errors have not: what linear functions leave of the jump and of the loads.
#[test]
fn the_estimate_follows_the_error() {
    let text = std::fs::read_to_string("../../scenes/40-transmission.toml").unwrap();
    for ([e1, n1, e2, n2], errors, sharp) in [
        ([2.0, 0.3, 2.0, 0.3], [0.2184334348, 0.1023723681, 0.05013540328], [0.95, 1.65]),
        ([20.0, 0.25, 2.0, 0.3], [0.6072932356, 0.3073255658, 0.1544400171], [0.95, 1.65]),
        ([1.0, 0.35, 50.0, 0.2], [0.1457398885, 0.07282818724, 0.03635144816], [0.95, 1.65]),
    ] {
        for (n, error) in [4, 8, 16].into_iter().zip(errors) {
            let of = |indicator: &str| {
                let pair = [("E1", e1), ("n1", n1), ("E2", e2), ("n2", n2)];
                let mut overrides = pair.map(|(name, value)| format!("parameters.{name}={value:?}")).to_vec();
                overrides.extend([format!("grid.coarse=[{n}, {n}]"), format!("method.indicator=\"{indicator}\"")]);
                let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
                solve(&text, &overrides).estimate.unwrap() / error
            };
            let [bubble, residual] = ["bubble", "residual"].map(of);
            println!("{e1} | {e2}, n = {n}: {bubble:.3}, residuals {residual:.3}");
            assert!((sharp[0]..sharp[1]).contains(&bubble), "{e1} | {e2}, n = {n}: {bubble}");
            assert!((3.0..10.0).contains(&residual), "{e1} | {e2}, n = {n}: residuals {residual}");
        }
    }
}

/// A resultant: told, with a solution that grows; refused where it is to be bounded. Without one both have the same stresses.
#[test]
fn a_resultant_is_told_or_refused() {
    let weight = "body_force={ value = [\"0\", \"-1\"] }";
    let exterior = solve(SQUARE, &[weight]).exterior.unwrap();
    assert!(!exterior.balanced && apart(&exterior.resultant, &[0.0, -1.0]) < 1e-12, "{exterior:?}");
    let (scene, bounded) = (parse(SQUARE, &[weight, "exterior.at_infinity=\"bounded\""]).unwrap(), AtomicUsize::new(0));
    let progress = Progress::<OnGrid>::new(&scene, Vec::new()).unwrap();
    let Err(error) = adaptive_loop::run(&scene, progress, &bounded, &mut |_, _| Ok(())) else {
        panic!("a net force is bounded")
    };
    assert!(error.to_string().contains("resultant (0.000e0, -1.000e0)"), "{error}");

    let twist = "exterior.stress_jump=[\"y\", \"x\", \"0\"]";
    let [decaying, bounded] =
        ["decaying", "bounded"].map(|word| solve(SQUARE, &[twist, &format!("exterior.at_infinity=\"{word}\"")]));
    for (a, b) in decaying.probe.iter().zip(&bounded.probe) {
        assert!(apart(&a.stress, &b.stress) < 1e-11, "{:?}", a.point);
    }
    assert!((decaying.energy - bounded.energy).abs() < 1e-12 * decaying.energy.abs());
}

/// A pressurised lining of the rock's own material is a hole in the rock: the same displacements as by boundary elements alone.
#[test]
fn a_lining_of_the_rock_is_the_rock() {
    let lined = |n: usize| {
        let text = SQUARE
            .replace("[material]", "[[body.holes]]\ncorners = [[-0.25, -0.25], [0.25, -0.25], [0.25, 0.25], [-0.25, 0.25]]\nsides = [\"wall\", \"wall\", \"wall\", \"wall\"]\n[sides.wall]\npressure = 1\n[material]")
            .replace("fine = [2, 2]", "fine = [1, 1]")
            .replace("[[0.1, 0.2], [0.5, 0.1], [0.7, 0.4], [-40, 3]]", "[[0.25, 0], [0.5, 0], [1, 0.5]]")
            .replace("coarse = [4, 4]", &format!("coarse = [{n}, {n}]"));
        solve(&text, &[]).probe
    };
    let hole = SQUARE
        .replace("[material]\nyoung = 10\npoisson = 0.3\n", "[sides.wall]\npressure = 1\n")
        .replace(
            "[[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]",
            "[[-0.25, -0.25], [0.25, -0.25], [0.25, 0.25], [-0.25, 0.25]]",
        )
        .replace("[\"bottom\", \"right\", \"top\", \"left\"]", "[\"wall\", \"wall\", \"wall\", \"wall\"]")
        .replace("[[0.1, 0.2], [0.5, 0.1], [0.7, 0.4], [-40, 3]]", "[[0.25, 0], [0.5, 0], [1, 0.5]]")
        .replace("model = \"fem-bem\"\nrefine = \"none\"", "refine = \"hp\"\ntolerance = 1e-5");
    let scene = parse(&hole, &[]).unwrap_or_else(|e| panic!("{}", e.render()));
    let progress = steklov_model::run::adaptive_loop::Progress::first(&scene);
    let done = adaptive_loop::run(&scene, progress, &AtomicUsize::new(0), &mut |_, _| Ok(())).unwrap();
    let errors = [16, 32, 64].map(|n| {
        let probes = lined(n);
        let off = probes.iter().map(|probe| {
            let (u, _) = match probe.point {
                [0.25, 0.0] => done.last.on_edge(1, 0.5),
                x => done.last.inside(0, x),
            };
            apart(&probe.displacement, &u) / 0.1
        });
        off.fold(0.0, f64::max)
    });
    // the corners of 270 degrees of the hole have the exponent 0.5445: displacements converge at twice that rate
    let rate = (errors[0] / errors[2]).log2() / 2.0;
    assert!(errors[2] < 6e-3 && (rate - 1.089).abs() < 0.1, "{errors:?} {rate}");
}

#[test]
fn what_a_medium_excludes_is_refused_at_its_place() {
    let holes = "[[body.holes]]\ncorners = [[-0.25, -0.25], [0.25, -0.25], [0.25, 0.25], [-0.25, 0.25]]\nsides = [\"wall\", \"wall\", \"wall\", \"wall\"]\n";
    let held = format!("{holes}[sides.wall]\ndisplacement = [0, 0]\n[material]");
    for (from, to, kind, offending, message, remedy) in [
        (
            "young = 10\npoisson = 0.3\nremote",
            "young = -1\npoisson = 0.3\nremote",
            Kind::Data(DataErrorKind::Value),
            "-1",
            "Young's modulus is -1",
            "positive",
        ),
        (
            "[1, -0.5, 0.25]",
            "[1, -0.5]",
            Kind::Data(DataErrorKind::Value),
            "[1, -0.5]",
            "has 2 entries",
            "xx, yy and xy",
        ),
        ("remote_stress", "remote_stres", Kind::UnknownKey, "remote_stres", "unknown key", "remote_stress"),
        (
            "[grid]",
            "displacement_jump = [\"1/(x-0.5)\", \"0\"]\n[grid]",
            Kind::Data(DataErrorKind::Data),
            "\"1/(x-0.5)\"",
            "displacement jump of side \"bottom\" is inf",
            "finite",
        ),
        (
            "[grid]",
            "displacement_jump = [\"s\", \"0\"]\n[grid]",
            Kind::Data(DataErrorKind::Data),
            "\"s\"",
            "is 1 before and 0 after the corner (0.5, -0.5)",
            "continuous",
        ),
        (
            "[grid]",
            "displacement_jump = [\"sign(x)\", \"0\"]\n[grid]",
            Kind::Data(DataErrorKind::Data),
            "\"sign(x)\"",
            "jumps from -1 to 1",
            "does not tear",
        ),
        (
            "[grid]",
            "traction_jump = [\"0\", \"log(x)\"]\n[grid]",
            Kind::Data(DataErrorKind::Data),
            "\"log(x)\"",
            "traction jump of side \"bottom\" is NaN",
            "finite",
        ),
        (
            "[grid]",
            "stress_jump = [\"0\", \"0\"]\n[grid]",
            Kind::Data(DataErrorKind::Value),
            "[\"0\", \"0\"]",
            "has 2 entries",
            "xx, yy and xy",
        ),
        (
            "[grid]",
            "at_infinity = \"free\"\n[grid]",
            Kind::Data(DataErrorKind::Value),
            "\"free\"",
            "is not a choice",
            "decaying, bounded",
        ),
        (
            "[grid]",
            "plane = \"stress\"\n[grid]",
            Kind::Data(DataErrorKind::Conflict),
            "\"stress\"",
            "not that of the body",
            "remove it",
        ),
        (
            "[grid]",
            "[sides.left]\ntraction = [1, 0]\n[grid]",
            Kind::Data(DataErrorKind::Conflict),
            "[sides.left]",
            "meets the medium",
            "jump",
        ),
        (
            "[material]",
            &held,
            Kind::Data(DataErrorKind::Unsupported),
            "[sides.wall]",
            "not held or touched",
            "pressure",
        ),
        ("\"fem-bem\"", "\"fem\"", Kind::Data(DataErrorKind::Conflict), "\"fem\"", "no medium around", "fem-bem"),
        (
            "coarse = [4, 4]",
            "basis = \"periodic\"\ncoarse = [4, 4]",
            Kind::Data(DataErrorKind::Unsupported),
            "\"periodic\"",
            "no single displacement",
            "coupled",
        ),
        ("remote_stress = [1, -0.5, 0.25]\n", "", Kind::MissingKey, "title", "nothing loads", "remote_stress"),
    ] {
        assert_eq!(SQUARE.matches(from).count(), 1, "{from:?}");
        let overrides: &[&str] = if to.contains("periodic") { &["method.model=\"msfem-bem\""] } else { &[] };
        let text = SQUARE.replace(from, to).replace("[0.1, 0.2], ", "");
        let error = parse(&text, overrides).err().unwrap_or_else(|| panic!("accepted: {to:?}"));
        let text = error.render();
        assert_eq!(error.kind, kind, "{text}");
        assert!(text.contains(message) && text.contains(remedy), "{to:?}: {message:?} {remedy:?} are not in\n{text}");
        assert!(kind == Kind::MissingKey || text.contains(offending), "{text}");
    }
}

/// An outline that meets itself at a point cannot be joined with a medium.
#[test]
fn a_body_that_touches_itself_is_refused() {
    let corners = "[[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]";
    let touching = "[[-0.5, -0.5], [0, -0.5], [0, 0], [0.5, 0], [0.5, 0.5], [0, 0.5], [0, 0], [-0.5, 0]]";
    let text = SQUARE
        .replace(corners, touching)
        .replace("[\"bottom\", \"right\", \"top\", \"left\"]", "[\"a\",\"b\",\"c\",\"d\",\"e\",\"f\",\"g\",\"h\"]");
    let error = parse(&text, &[]).unwrap_err();
    assert_eq!(error.kind, Kind::Data(DataErrorKind::Geometry));
    assert!(error.render().contains("move the corner away"), "{}", error.render());
}
