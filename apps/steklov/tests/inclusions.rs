//! A body in an unbounded medium by boundary elements: what is told, stored, shown, drawn and resumed.

use crate::place::Place;
use serde_json::Value;
use steklov_io::{load_dense, load_points, load_vector, open, open_group, vtkhdf};

/// A stiff L in a medium under tension, its interface slipped by a traction of its own.
const L: &str = r#"title = "L in a medium"
[body]
corners = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
sides = ["a", "b", "c", "d", "e", "f"]
[material]
young = 20
poisson = 0.3
[exterior]
young = 2
poisson = 0.2
remote_stress = [1, 0, 0.5]
displacement_jump = ["-0.01*x", "0"]
[probe]
points = [[0.3, 0.7], [2, 0.5], [3, -4]]
[method]
tolerance = 1e-2
"#;

fn with(text: &str, arguments: &[&str]) -> (Place, Value) {
    let place = Place::new();
    place.write("l.toml", text);
    let told = place.json(0, &[&["l.toml"], arguments].concat());
    (place, told)
}

fn pairs(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

#[test]
fn the_result_is_shown_as_it_was_told() {
    let (place, mut told) = with(L, &[]);
    let mut shown = place.run(["show", "l.vtkhdf", "--json"]).demand(0).json();
    [&mut told, &mut shown].into_iter().for_each(|o| {
        o.as_object_mut().unwrap().remove("seconds");
    });
    assert_eq!(told, shown);
    let exterior = &told["exterior"];
    assert_eq!((&exterior["radiation"], &exterior["balanced"]), (&"decaying".into(), &true.into()));
    assert!(told["model"] == "bem" && pairs(&exterior["constant"]) == [0.0, 0.0] && told["steps"].as_u64() > Some(2));
    let plan = place.run(["plan", "l.toml"]).demand(0);
    assert!(plan.out.contains("boundary elements inside and outside"), "{}", plan.out);
    assert!(plan.out.contains("the medium holds the body"), "{}", plan.out);
}

/// `/coupling` has the medium on the last mesh, `/VTKHDF` body and medium, told apart by `region`; across the interface the displacements
/// differ by the jump and the tractions do not.
#[test]
fn body_and_medium_are_in_the_file() {
    let (place, told) = with(L, &[]);
    let file = open(place.path("l.vtkhdf")).unwrap();
    let at = open_group(&file, "coupling").unwrap();
    let [points, xi] = ["points", "displacement"].map(|name| load_points(&at, name).unwrap());
    let solution = open_group(&file, "solution").unwrap();
    assert_eq!(points, load_points(&solution, "points").unwrap());
    let u = load_points(&solution, "displacement").unwrap();
    // ε_∞ of the medium: σ = (1, 0, 0.5)
    let mu = 2.0 / 2.4;
    let [xx, yy, xy] = [0.8 / (2.0 * mu), -0.2 / (2.0 * mu), 0.5 / (2.0 * mu)];
    for ((&[x, y], u), xi) in points.iter().zip(&u).zip(&xi) {
        let medium = [xi[0] + xx * x + xy * y - 0.01 * x, xi[1] + xy * x + yy * y];
        assert!((u[0] - medium[0]).abs() < 1e-12 && (u[1] - medium[1]).abs() < 1e-12, "({x}, {y})");
    }
    assert_eq!(load_vector(&at, "remote_stress").unwrap(), [1.0, 0.0, 0.5]);

    let grid = vtkhdf::read(&file).unwrap();
    let field = |name: &str| grid.point_data.iter().find(|f| f.name == name).unwrap();
    let region = grid.cell_data.iter().find(|f| f.name == "region").unwrap();
    assert_eq!(region.values.len(), grid.lines.len() + grid.triangles.len());
    let area = |[i, j, k]: [usize; 3]| {
        let ([a, b], [c, d], [e, f]) = (grid.points[i], grid.points[j], grid.points[k]);
        0.5 * ((c - a) * (f - b) - (e - a) * (d - b))
    };
    let areas = [0.0, 1.0].map(|r| -> f64 {
        let cells = grid.triangles.iter().enumerate().filter(|(k, _)| region.values[grid.lines.len() + k] == r);
        cells.map(|(_, corners)| area(*corners)).sum()
    });
    let window = {
        let points = load_points(&open_group(&at, "exterior").unwrap(), "points").unwrap();
        let side = |k: usize| {
            let all = points.iter().map(|x| x[k]);
            all.clone().fold(f64::NEG_INFINITY, f64::max) - all.fold(f64::INFINITY, f64::min)
        };
        side(0) * side(1)
    };
    assert!((areas[0] - 3.0).abs() < 1e-9 && (areas[1] - (window - 3.0)).abs() < 1e-9, "{areas:?} {window}");
    for f in [field("displacement"), field("stress"), field("von_mises")] {
        assert_eq!(f.values.len(), f.components * grid.points.len());
        assert!(f.values.iter().all(|v| v.is_finite()));
    }
    // the points of the window are those of the medium
    let stored = load_dense(&open_group(&at, "exterior").unwrap(), "stress").unwrap();
    let (stress, first) = (field("stress"), grid.points.len() - stored.nrows());
    for i in [0, stored.nrows() / 2, stored.nrows() - 1] {
        (0..3).for_each(|k| assert_eq!(stress.values[3 * (first + i) + k], stored[(i, k)]));
    }
    assert_eq!(told["probe"].as_array().unwrap().len(), 3);
}

/// Interrupted and gone on with, or not: the same numbers. The pictures show the body without its medium.
#[test]
fn it_is_resumed_and_drawn() {
    let (place, whole) = with(L, &["--out", "whole.vtkhdf"]);
    place.json(3, &["l.toml", "--set", "method.max_steps=2", "--save", "matrices"]);
    let resumed = place.json(0, &["l.toml", "--resume", "--plots", "pictures"]);
    for key in ["energy", "estimate", "dofs", "steps", "probe", "exterior"] {
        assert_eq!(whole[key], resumed[key], "{key}");
    }
    assert!(place.path("pictures/l-body.svg").exists());
    let svg = String::from_utf8(place.read("pictures/l-body.svg")).unwrap();
    assert!(svg.contains("L in a medium"));
}

/// Loads with a resultant on a medium whose displacement is bounded have no solution: told at the place in the scene.
#[test]
fn a_net_force_is_told() {
    let place = Place::new();
    let text = L.replace("displacement_jump", "at_infinity = \"bounded\"\ntraction_jump = [1, 0]\ndisplacement_jump");
    place.write("l.toml", text);
    let ran = place.run(["solve", "l.toml"]);
    assert_ne!(ran.status, 0);
    assert!(ran.err.contains("at_infinity = \"decaying\"") && ran.err.contains("translation"), "{}", ran.err);
    // decaying: solved, and told as unbalanced
    let told = place.json(0, &["l.toml", "--set", "exterior.at_infinity=\"decaying\""]);
    assert_eq!(told["exterior"]["balanced"], false);
    assert!((pairs(&told["exterior"]["resultant"])[0] - 8.0).abs() < 1e-9, "{}", told["exterior"]);
}

/// The strategies are compared by their true errors, which have the jump's part in them.
#[test]
fn convergence_is_studied() {
    let (place, _) = with(L, &[]);
    let study = ["study", "l.toml", "--strategies", "hp,uniform-p", "--json", "--set", "method.tolerance=0.02"];
    let told = place.run(study).demand(0).json();
    let mut compared = 0;
    for strategy in told["strategies"].as_array().unwrap() {
        assert_eq!(strategy["reason"], "tolerance");
        for step in strategy["steps"].as_array().unwrap() {
            let effectivity = step["effectivity"].as_f64().unwrap();
            assert!(effectivity > 0.8 && effectivity < 1.3, "{step}");
            compared += 1;
        }
    }
    assert!(compared > 4, "{told}");
}

/// A body that is softer by any number of magnitudes is a hole; one that is stiffer loses digits, and says so.
#[test]
fn contrasts_are_solved_or_refused() {
    let place = Place::new();
    place.write("l.toml", L);
    let with = |young: &str| ["l.toml".to_owned(), "--set".to_owned(), format!("material.young={young}")];
    let probe = |told: &Value| pairs(&told["probe"][2]["displacement"]);
    let [soft, softer, stiff, stiffer] = ["1e-9", "1e-18", "1e4", "1e5"].map(|young| {
        let with = with(young);
        probe(&place.json(0, &with.each_ref().map(String::as_str)))
    });
    for (a, b, digits) in [(soft, softer, 1e-8), (stiff, stiffer, 1e-3)] {
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < digits), "{a:?} {b:?}");
    }
    let ran = place.run(["solve", "--force"].map(str::to_owned).into_iter().chain(with("1e18")));
    assert!(ran.status != 0 && ran.err.contains("so unequal materials"), "{}", ran.err);
}
