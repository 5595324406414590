//! Stresses at vertices: infinite ones are told as such, finite ones are numbers.

use crate::place::Place;
use serde_json::{Value, json};

const L: &str = r#"title = "An L"
[body]
corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]
sides = ["bottom", "right", "step", "riser", "top", "left"]
[material]
young = 100.0
poisson = 0.3
[sides.top]
displacement = ["0", "0"]
[sides.right]
traction = ["0", "-1"]
[probe]
points = [[1.0, 1.0], [0.0, 2.0], [2.0, 0.0], [2.0, 1.0], [0.5, 0.5], [1.0, 1.5], [0.0, 0.0]]
[method]
tolerance = 1e-2
"#;

/// Which probe points have an infinite stress; the keys of each agree.
fn unbounded(o: &Value) -> Vec<bool> {
    let told = |p: &Value| {
        let infinite = p["stress_unbounded"] == json!(true);
        assert!(infinite || p.get("stress_unbounded").is_none(), "{p}");
        let numbers = p["stress"].as_array().unwrap();
        assert!(numbers.len() == 3 && numbers.iter().all(|s| s.is_null() == infinite), "{p}");
        assert!(p["displacement"].as_array().unwrap().iter().all(Value::is_f64), "{p}");
        infinite
    };
    o["probe"].as_array().unwrap().iter().map(told).collect()
}

/// A hole like an arrow head has three pointed corners, and one at which the body is; a hole like a D has two, at the ends of its arc.
/// The order in which corners are listed changes nothing.
#[test]
fn corners_of_holes_are_told_where_they_are() {
    let plate = |hole: &str, probe: &str| {
        format!(
            r#"title = "Holes"
[body]
corners = [[-4, -4], [4, -4], [4, 4], [-4, 4]]
sides = ["bottom", "right", "top", "left"]
[[body.holes]]
{hole}
[material]
young = 100.0
poisson = 0.3
[sides.top]
traction = ["0", "1"]
[sides.bottom]
traction = ["0", "-1"]
[probe]
points = {probe}
[method]
refine = "none"
degree = 2
"#
        )
    };
    let place = Place::new();
    let arrow = "[[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, 0.5]]";
    let d = "[[0.0, -1.0], [1.0, 0.0], [0.0, 1.0]]";
    let sides = r#"sides = ["a", "b", "c", "d"]"#;
    let arcs = "arcs = { a = { centre = [0, 0] }, b = { centre = [0, 0] } }";
    for (name, hole, probe, expected) in [
        ("left", format!("corners = {arrow}\n{sides}"), arrow, vec![true, true, true, false]),
        (
            "right",
            format!("corners = [[1.0, 0.0], [0.0, 0.5], [-1.0, 0.0], [0.0, 1.0]]\n{sides}"),
            arrow,
            vec![true, true, true, false],
        ),
        ("d", format!("corners = {d}\nsides = [\"a\", \"b\", \"c\"]\n{arcs}"), d, vec![true, false, true]),
    ] {
        let file = format!("{name}.toml");
        place.write(&file, plate(&hole, probe));
        let o = place.json(0, &[&file]);
        assert_eq!(unbounded(&o), expected, "{name}");
        let points: Vec<[f64; 2]> = serde_json::from_value(o["infinite_stress"].clone()).unwrap();
        let corners: Vec<[f64; 2]> = serde_json::from_str(probe).unwrap();
        assert_eq!(points.len(), expected.iter().filter(|e| **e).count(), "{name}: {points:?}");
        for (corner, expected) in corners.iter().zip(expected) {
            assert_eq!(points.contains(corner), expected, "{name}: {corner:?} {points:?}");
        }
    }
}

/// A re-entrant corner and the two ends of a held side; not the other corners.
#[test]
fn infinite_stresses_are_no_numbers() {
    let place = Place::new();
    place.write("l.toml", L);
    let expected = [true, true, false, false, false, false, false];
    let o = place.json(0, &["l.toml"]);
    assert_eq!(unbounded(&o), expected);
    // what is stored says the same, in words too
    let shown = place.run(["show", "l.vtkhdf", "--json"]).demand(0).json();
    assert_eq!(shown["probe"], o["probe"]);
    let words = place.run(["show", "l.vtkhdf"]).demand(0).out;
    let lines: Vec<&str> = words.lines().filter(|l| l.starts_with("probe")).collect();
    assert_eq!(lines.iter().map(|l| l.contains("stress unbounded")).collect::<Vec<_>>(), expected);
    let file = steklov_io::open(place.path("l.vtkhdf")).unwrap();
    let stored = steklov_io::load_dense(&file.group("solution/probe").unwrap(), "stress").unwrap();
    assert_eq!((0..7).map(|i| stored[(i, 0)].is_nan()).collect::<Vec<_>>(), expected);
    // on a grid as well
    let grid = ["method.model=\"fem\"", "method.refine=\"none\"", "grid={ coarse = [4, 4], fine = [2, 2] }"];
    let o = place.json(0, &[&["l.toml"][..], &grid.map(|set| ["--set", set]).concat()].concat());
    assert_eq!(unbounded(&o), expected);
}

/// The condition changes on a straight side: from held to free, and at the edge of a flat obstacle; at a right angle a side that
/// slides is a plane of symmetry, and a held one is not.
#[test]
fn changes_of_the_condition_count() {
    let place = Place::new();
    let text = |floor: &str| {
        format!(
            "[body]\ncorners = [[-1, 0], [0, 0], [1, 0], [1, 1], [-1, 1]]\nsides = [\"gone\", \"floor\", \"right\", \"top\", \"left\"]\n\
             [material]\nyoung = 100\npoisson = 0.3\n[sides.floor]\n{floor}\n[sides.left]\ndisplacement = [\"0\", \"free\"]\n\
             [sides.top]\npressure = \"1+x\"\n[probe]\npoints = [[0, 0], [1, 0], [-1, 0], [1, 1], [0.5, 0]]\n\
             [method]\ntolerance = 1e-2\n"
        )
    };
    for (floor, expected) in [
        ("displacement = [\"0\", \"0\"]", [true, true, false, false, false]),
        ("displacement = [\"free\", \"0\"]", [true, false, false, false, false]),
        ("contact = {}", [true, false, false, false, false]),
        ("contact = { gap = \"1\" }\n[sides.right]\ndisplacement = [\"0\", \"0\"]", [false, true, false, true, false]),
        // apart at the edge: the obstacle recedes there
        ("contact = { gap = \"0.1*(x-0.5)^2\" }", [false; 5]),
    ] {
        place.write("scene.toml", text(floor));
        let ran = place.run(["solve", "scene.toml", "--json", "--force"]);
        assert!(ran.status == 0 || ran.status == 3, "{floor}: {}", ran.err);
        assert_eq!(unbounded(&ran.json()), expected, "{floor}");
    }
}

/// A linear field goes around a re-entrant corner, which has a stress then; a body in a medium of its own modulus has no corners.
#[test]
fn fields_that_are_known_to_be_smooth_have_stresses() {
    let place = Place::new();
    let linear = L.replace("displacement = [\"0\", \"0\"]", "displacement = [\"0.01*x\", \"0.02*y\"]");
    let held = "[sides.bottom]\ndisplacement = [\"0.01*x\", \"0.02*y\"]\n[sides.step]\ndisplacement = [\"0.01*x\", \"0.02*y\"]\n\
                [sides.riser]\ndisplacement = [\"0.01*x\", \"0.02*y\"]\n[sides.left]\ndisplacement = [\"0.01*x\", \"0.02*y\"]\n[probe]";
    let linear = linear.replace("traction = [\"0\", \"-1\"]", "displacement = [\"0.01*x\", \"0.02*y\"]");
    place.write("linear.toml", linear.replace("[probe]", held));
    let o = place.json(0, &["linear.toml"]);
    assert_eq!(unbounded(&o), [false; 7]);
    for p in o["probe"].as_array().unwrap() {
        let [lambda, mu] = [100.0 * 0.3 / (1.3 * 0.4), 100.0 / 2.6];
        let exact = [lambda * 0.03 + 2.0 * mu * 0.01, lambda * 0.03 + 2.0 * mu * 0.02, 0.0];
        for (told, exact) in p["stress"].as_array().unwrap().iter().zip(exact) {
            assert!((told.as_f64().unwrap() - exact).abs() < 1e-8, "{p}");
        }
    }
    let inclusion = |young: f64| {
        format!(
            "[body]\ncorners = [[0, 0], [1, 0], [1, 1], [0, 1]]\nsides = [\"a\", \"a\", \"a\", \"a\"]\n[material]\nyoung = {young}\n\
             poisson = 0.3\n[exterior]\nyoung = 10.0\npoisson = 0.3\nremote_stress = [1, 0, 0]\n[probe]\npoints = [[0, 0], [0.5, 0]]\n\
             [method]\ntolerance = 1e-2\n"
        )
    };
    for (young, expected) in [(10.0, [false, false]), (100.0, [true, false]), (1.0, [true, false])] {
        place.write("inclusion.toml", inclusion(young));
        assert_eq!(unbounded(&place.json(0, &["inclusion.toml"])), expected, "{young}");
    }
}

/// Patch tests are exact on one element a side: nothing of their estimate, which is rounding, is in doubt.
#[test]
fn exact_answers_are_not_doubted() {
    let scenes = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let place = Place::new();
    let numbers = ["01", "02", "03", "04", "05", "08", "09", "10", "11", "13"];
    let mut names = crate::place::names(&scenes);
    names.retain(|name| numbers.iter().any(|n| name.starts_with(n)));
    assert_eq!(names.len(), numbers.len());
    for name in names {
        let scene = scenes.join(&name);
        let o = place.json(0, &[scene.to_str().unwrap(), "--out", "exact.vtkhdf"]);
        assert_eq!(o["estimate_doubts"], json!([]), "{name}");
        assert!(o["estimate_relative"].as_f64().unwrap() < 1e-11, "{name}");
    }
}

/// A load that all functions and bubbles of the mesh are blind to, P₃ along one element: the answer to the rest of it looks exact.
#[test]
fn an_error_that_nothing_on_the_mesh_sees_is_doubted() {
    let place = Place::new();
    let text = |load: &str| {
        format!(
            "[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"bottom\", \"right\", \"top\", \"left\"]\n[material]\nyoung = 100\n\
             poisson = 0.3\n[sides.bottom]\ndisplacement = [\"free\", \"0\"]\n[sides.left]\ndisplacement = [\"0\", \"free\"]\n\
             [sides.right]\ntraction = [\"{load}\", \"0\"]\n[method]\nrefine = \"none\"\nelements = 4\n"
        )
    };
    for (load, blind) in [("3", false), ("3 + ((2*s-1)*(5*(2*s-1)^2 - 3))", true)] {
        place.write("scene.toml", text(load));
        let o = place.json(0, &["scene.toml"]);
        assert!(o["estimate_relative"].as_f64().unwrap() < 1e-11, "{load}");
        assert_eq!(o["estimate_doubts"] != json!([]), blind, "{load}: {}", o["estimate_doubts"]);
        if blind {
            let finer = place.json(0, &["scene.toml", "--set", "method.elements=12"]);
            assert!(finer["estimate_relative"].as_f64().unwrap() > 1e-3, "{finer}");
        }
    }
}
