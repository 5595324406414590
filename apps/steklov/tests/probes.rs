//! Lines and sides of `[probe]` in file, JSON object, tables and charts.

use crate::place::{Place, names};
use serde_json::json;

const RING: &str = r#"title = "Ring"
[units]
length = "mm"
stress = "MPa"
[body]
circle = { centre = [0, 0], radius = 2 }
side = "rim"
[[body.holes]]
circle = { centre = [0, 0], radius = 1 }
side = "hole/1"
[material]
young = 100
poisson = 0.3
[sides."hole/1"]
pressure = 1
[probe]
lines = [{ from = [0, 0], to = [2.6, 0], points = 27 }, { from = [0, 1.25], to = [0, 1.75], points = 2 }]
sides = ["hole/1"]
[expect]
"probe_lines.0.points.15.stress.yy" = { value = 0.925925925925926, tol = 1e-4, source = "Lame" }
"probe_sides.0.points.0.hoop_stress" = { value = 1.6666666666666667, tol = 1e-3, source = "Lame" }
[method]
tolerance = 1e-4
"#;

#[test]
fn lines_and_sides_are_stored_told_and_drawn() {
    let place = Place::new();
    place.write("ring.toml", RING);
    let told = place.run(["solve", "ring.toml", "--json", "--quiet", "--plots", "plots"]).demand(0).out;
    place.write("told.json", told.clone());
    let drawn = names(&place.path("plots"));
    let parts = ["line-1.csv", "line-1.png", "line-1.svg", "line-2.csv", "line-2.png", "line-2.svg"];
    let of_side = ["side-hole_1.csv", "side-hole_1.png", "side-hole_1.svg"];
    let wanted: Vec<String> = parts.iter().chain(&of_side).map(|part| format!("ring-probe-{part}")).collect();
    let probes: Vec<&String> = drawn.iter().filter(|name| name.contains("probe")).collect();
    assert_eq!(probes, wanted.iter().collect::<Vec<_>>());
    let script = format!("{}/tests/python/read_probes.py", env!("CARGO_MANIFEST_DIR"));
    let tables = ["plots/ring-probe-line-1.csv", "plots/ring-probe-side-hole_1.csv"];
    place.python(&script, &["ring.vtkhdf", "told.json", tables[0], tables[1]]).demand(0);
    let read = |name: &str| String::from_utf8(place.read(name)).unwrap();
    let line = read("plots/ring-probe-line-1.svg");
    for label in ["distance from (0, 0) in mm", "stress in MPa", "displacement in mm", "von Mises", "σyy"] {
        assert!(line.contains(label), "{label}");
    }
    assert!(read("plots/ring-probe-side-hole_1.svg").contains("arc length along hole/1 in mm"));

    // a stored result tells and draws the same
    let shown = place.run(["show", "ring.vtkhdf", "--json", "--plots", "again", "--csv", "tables"]).demand(0).json();
    let o: serde_json::Value = serde_json::from_str(&told).unwrap();
    assert_eq!([&shown["probe_lines"], &shown["probe_sides"]], [&o["probe_lines"], &o["probe_sides"]]);
    assert!(o["expect"].as_array().unwrap().iter().all(|e| e["holds"] == json!(true)), "{}", o["expect"]);
    assert_eq!(o["probe_lines"][0]["points"][0]["stress"], json!([null, null, null]));
    for name in &wanted {
        assert_eq!(place.read(&format!("plots/{name}")), place.read(&format!("again/{name}")), "{name}");
    }
    for name in tables {
        assert_eq!(place.read(name), place.read(&name.replace("plots", "tables")));
    }
    let words = place.run(["show", "ring.vtkhdf"]).demand(0).out;
    for text in [
        "line 1      (0, 0) to (2.6, 0): 11 of 27 points in a body, von Mises stress up to 2.31",
        "side        hole/1: ",
    ] {
        assert!(words.contains(text), "{words}");
    }
}

/// Words and charts tell of infinite stresses, and draw the others.
#[test]
fn infinite_stresses_are_told_and_not_drawn() {
    let place = Place::new();
    let corner = "[body]\ncorners = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]\n\
                  sides = [\"bottom\", \"right\", \"notch\", \"notch\", \"top\", \"left\"]\n\
                  [material]\nyoung = 100\npoisson = 0.3\n[sides.top]\ndisplacement = [\"0\", \"0\"]\n\
                  [sides.right]\ntraction = [\"0\", \"-1\"]\n[probe]\nsides = [\"notch\", \"bottom\"]\n";
    place.write("corner.toml", corner);
    let words = place.run(["solve", "corner.toml", "--quiet", "--plots", "plots"]).demand(0).out;
    let of = |side: &str| words.lines().find(|l| l.starts_with(&format!("side        {side}: "))).unwrap().to_owned();
    assert!(of("notch").ends_with("stress unbounded at (1, 1)"), "{words}");
    assert!(of("bottom").contains("von Mises stress up to "), "{words}");
    let chart = |side: &str| String::from_utf8(place.read(&format!("plots/corner-probe-side-{side}.svg"))).unwrap();
    assert!(chart("notch").contains("1 % of the length") && !chart("bottom").contains("1 %"));
}

/// A result without lines and sides has none of their keys; paths in `[expect]` beyond them are refused.
#[test]
fn nothing_is_told_of_what_was_not_asked_for() {
    let place = Place::new();
    let o = place.json(0, &["block.toml"]);
    assert!(o.get("probe_lines").is_none() && o.get("probe_sides").is_none());
    place.write("far.toml", RING.replace("probe_lines.0.", "probe_lines.2."));
    let ran = place.run(["solve", "far.toml", "--quiet"]).demand(1);
    assert!(ran.err.contains("no number at \"probe_lines.2.points.15.stress.yy\""), "{}", ran.err);
    assert!(ran.err.contains("did you mean"), "{}", ran.err);
}
