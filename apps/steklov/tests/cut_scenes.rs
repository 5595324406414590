//! Bodies that are cut into subdomains, `method.cuts = "auto"`: planned, told, stored, resumed, and equal to those without cuts.

use crate::place::Place;
use serde_json::Value;

/// The plate with twelve holes, held on the left, under a body force that is affine.
fn heavy() -> Place {
    let place = Place::new();
    let scene = include_str!("../../../scenes/74-plate-with-holes.toml");
    let (scene, _) = scene.split_once("# degree 12").unwrap();
    let held = scene.replace("traction = [\"-1\", \"0\"]", "displacement = [\"0\", \"0\"]");
    assert_ne!(held, scene);
    let more =
        "[body_force]\nvalue = [\"0.3 + 0.1*y\", \"-1 + 0.2*x\"]\n[probe]\npoints = [[1, 1], [2, 1], [3.01, 1.99]]\n";
    place.write("plate.toml", &(held + more));
    place
}

fn without_times(mut o: Value) -> Value {
    let object = o.as_object_mut().unwrap();
    ["seconds", "peak_memory_bytes", "file"].iter().for_each(|key| drop(object.remove(*key)));
    o
}

/// The stored result is shown with the same bits, is continued to the same bits, and does not know the number of threads.
#[test]
fn results_are_the_same_bits_stored_resumed_and_with_more_threads() {
    let place = heavy();
    let whole = without_times(place.json(0, &["plate.toml", "--threads", "1"]));
    let shown = place.run(["show", "plate.vtkhdf", "--json"]).demand(0).json();
    assert_eq!(whole, without_times(shown));
    assert!(whole["steps"].as_u64().unwrap() > 3);
    place.json(3, &["plate.toml", "--threads", "2", "--set", "method.max_steps=2"]);
    let resumed = place.json(0, &["plate.toml", "--resume"]);
    assert_eq!(whole, without_times(resumed));
    let cuts = steklov_io::open(place.path("plate.vtkhdf")).unwrap().group("steps/001/cuts").unwrap();
    assert!(steklov_io::load_dense(&cuts, "lines").unwrap().nrows() > 10);
}

#[test]
fn they_are_those_without_cuts() {
    let place = heavy();
    let solve = |cuts: &str| {
        let cuts = format!("method.cuts=\"{cuts}\"");
        place.json(0, &["plate.toml", "--set", &cuts, "--set", "method.tolerance=3e-5"])
    };
    let [whole, cut] = ["none", "auto"].map(solve);
    let number = |o: &Value| o.as_f64().unwrap();
    let near = |a: &Value, b: &Value, tolerance: f64, what: &str| {
        let (a, b) = (number(a), number(b));
        assert!((a - b).abs() <= tolerance * a.abs().max(b.abs()).max(1.0), "{what}: {a} {b}");
    };
    near(&whole["energy_extrapolated"], &cut["energy_extrapolated"], 1e-8, "J");
    for k in 0..3 {
        let of = |o: &Value| o["probe"][k].clone();
        let (whole, cut) = (of(&whole), of(&cut));
        (0..2).for_each(|i| near(&whole["displacement"][i], &cut["displacement"][i], 1e-6, "displacement"));
        (0..3).for_each(|i| near(&whole["stress"][i], &cut["stress"][i], 2e-4, "stress"));
    }
}

#[test]
fn the_plan_tells_cuts_or_why_there_are_none() {
    let place = heavy();
    let plan = |set: &str| place.run(["plan", "plate.toml", "--set", set]).demand(0).out;
    let cut = plan("title=\"as it is\"");
    for part in ["subdomains", "unknowns without cuts", "times fewer operations", "that of each subdomain"] {
        assert!(cut.contains(part), "{part}: {cut}");
    }
    for (set, why) in [
        ("method.cuts=\"none\"", "as the scene says"),
        ("method.tolerance=0.5", "cuts pay from"),
        ("method.estimators=true", "residual estimators"),
        ("method.multiplier=\"stabilised\"", "stabilised multipliers"),
        ("method.refine=\"none\"", "one mesh"),
        ("method.refine=\"h\"", "refinement other than"),
    ] {
        let told = plan(set);
        assert!(told.contains(why), "{set}: {told}");
    }
}

/// A pressure in a narrow place moves all subdomains but one rigidly, with rotations that their arcs of degree 1 miss: the run goes on
/// to J of that without cuts.
#[test]
fn a_narrow_pressure_on_one_hole_is_resolved() {
    let place = Place::new();
    let mut scene =
        String::from("[body]\ncorners = [[0, 0], [3, 0], [3, 2], [0, 2]]\nsides = [\"b\", \"r\", \"t\", \"l\"]\n");
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)] {
        let (x, y, radius) = (f64::from(i) + 0.5, f64::from(j) + 0.47, 0.3 + 0.02 * f64::from(i));
        scene += &format!("[[body.holes]]\ncircle = {{ centre = [{x}, {y}], radius = {radius} }}\nside = \"h\"\n");
    }
    scene += "[material]\nyoung = 1\npoisson = 0.3\n[sides.l]\ndisplacement = [\"0\", \"free\"]\n";
    scene += "[sides.b]\ndisplacement = [\"free\", \"0\"]\n";
    scene += "[sides.h]\npressure = \"exp(-1000000*((x-0.29)^2+(y-0.683)^2))\"\n[method]\ncuts = \"auto\"\n";
    place.write("plate.toml", &scene);
    let cut = place.json(0, &["plate.toml"]);
    assert!(cut["estimate_doubts"].as_array().unwrap().is_empty(), "{cut}");
    let whole = place.json(0, &["plate.toml", "--set", "method.cuts=\"none\"", "--set", "method.tolerance=1e-5"]);
    let number = |o: &Value, key: &str| o[key].as_f64().unwrap();
    let off = (number(&cut, "energy_extrapolated") - number(&whole, "energy_extrapolated")).abs();
    let told = number(&cut, "energy_uncertainty") + number(&whole, "energy_uncertainty");
    assert!(off <= told && told < 1e-4 * number(&whole, "strain_energy"), "{off} {told}");
}
