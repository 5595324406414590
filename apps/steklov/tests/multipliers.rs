//! Stabilised multipliers, Coulomb's law and rounding errors as the command tells of them.

use crate::place::Place;
use serde_json::{Value, json};

/// A block between a held top and a wedge under it, with Coulomb friction.
const WEDGE: &str = r#"title = "A block on a wedge"
[body]
corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]
sides = ["floor", "right", "top", "left"]
[material]
young = 1000.0
poisson = 0.3
[sides.floor]
contact = { gap = "abs(x)/10 - 0.05", friction = { coulomb = "0.3" } }
[sides.top]
displacement = ["0.01", "0"]
[method]
max_dofs = 400
"#;

const STABILISED: &str = "method.multiplier=\"stabilised\"";

fn wedge() -> Place {
    let place = Place::new();
    place.write("wedge.toml", WEDGE);
    place
}

/// Cattaneo and Mindlin: contact sticks on 2a sqrt(1 - Q/(μP)), whatever the multipliers.
#[test]
fn stabilised_multipliers_stick_as_far_as_they_should() {
    let place = Place::new();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/27-cattaneo-mindlin.toml");
    let o = place.json(0, &[scene, "--set", STABILISED]);
    let exact = 0.04 * 0.5f64.sqrt();
    let stick = o["contact"]["stick"].as_f64().unwrap();
    assert!((stick / exact - 1.0).abs() < 0.02, "{stick}, not {exact}");
}

/// Multipliers of a much higher degree than the displacements are integrated, and so are their gaps.
#[test]
fn multipliers_of_the_highest_degree() {
    let place = wedge();
    let energy = |degree: &str| {
        let sets = [STABILISED, "method.refine=\"none\"", degree].map(|s| ["--set", s]);
        place.json(0, &[&["wedge.toml"], sets.as_flattened()].concat())["energy"].as_f64().unwrap()
    };
    let (low, high) = (energy("method.multiplier_degree=8"), energy("method.multiplier_degree=64"));
    assert!((high / low - 1.0).abs() < 1e-3, "{high}, not {low}");
}

/// Forces of rounding errors alone, or drowned by them, make the estimate doubtful.
#[test]
fn an_audit_beyond_rounding_is_a_doubt() {
    let place = wedge();
    let nearly = "material.poisson=0.499999999999";
    let far = "sides.floor.contact={ gap = \"1e12\", friction = { coulomb = \"0.3\" } }";
    for (set, beyond) in [("material.poisson=0.3", false), (nearly, true), (far, true)] {
        let ran = place.run(["solve", "--json", "--quiet", "--force", "wedge.toml", "--set", set]);
        let o = ran.json();
        assert_eq!(o["audit"]["equilibrium"].as_f64().unwrap() > 1e-7, beyond, "{set}");
        let doubts = o["estimate_doubts"].as_array().unwrap();
        assert_eq!(doubts.contains(&json!("roundoff")), beyond, "{set}: {doubts:?}");
    }
}

/// Where Coulomb's solver finds nothing there is no contraction, and a line says what to try.
#[test]
fn no_solution_under_coulombs_law_has_no_contraction() {
    let place = wedge();
    let arguments = ["solve", "--force", "wedge.toml"];
    let held = place.json(0, &["wedge.toml", "--set", "method.tolerance=0.01"]);
    assert!(held["contact"]["contraction"].as_f64().is_some_and(|c| c < 1.0));
    place.write("wedge.toml", WEDGE.replace("coulomb = \"0.3\"", "coulomb = \"1e6\"").replace("400", "1200"));
    let ran = place.run(arguments.iter().chain(&["--json"])).demand(3);
    let o = ran.json();
    assert_eq!((&o["reason"], &o["contact"]["contraction"]), (&json!("solver"), &Value::Null));
    let advice = "lower the friction coefficients";
    assert!(ran.err.contains(advice), "{}", ran.err);
    assert!(!place.run(arguments.iter().chain(&["--json", "--quiet"])).demand(3).err.contains(advice));
    assert!(place.run(arguments).demand(3).out.contains(advice));
}

/// Coefficients far beyond those for which the fixed point contracts.
#[test]
fn large_coefficients_are_reached_by_way_of_smaller_ones() {
    let place = wedge();
    let sets = ["sides.floor.contact.friction.coulomb=\"10\"", "method.max_dofs=1200"].map(|s| ["--set", s]);
    let o = place.json(0, &[&["wedge.toml"], sets.as_flattened()].concat());
    let audit = o["audit"].as_object().unwrap();
    assert!(audit.values().all(|a| a.as_f64().unwrap() < 1e-9), "{audit:?}");
    assert!(o["contact"]["contraction"].as_f64().unwrap() > 1.0, "{}", o["contact"]["contraction"]);
}

#[test]
fn the_plan_names_the_multipliers_and_what_has_no_effect() {
    let place = wedge();
    place.write("jump.toml", WEDGE.replace("abs(x)/10 - 0.05", "x > 0.1"));
    let free = WEDGE.replace("contact = { gap = \"abs(x)/10 - 0.05\", friction = { coulomb = \"0.3\" } }", "");
    place.write("free.toml", free);
    for (scene, sets, part, there) in [
        ("wedge.toml", &[][..], "mesh same", false),
        ("wedge.toml", &[STABILISED], "mesh same, degree auto, gamma auto", true),
        (
            "wedge.toml",
            &[STABILISED, "method.gamma=1e-5", "method.multiplier_mesh=\"finer\"", "method.multiplier_degree=2"],
            "mesh finer, degree 2, gamma 1e-5",
            true,
        ),
        ("wedge.toml", &[STABILISED], "refines more", false),
        ("wedge.toml", &[STABILISED, "method.multiplier_degree=0"], "refines more", true),
        ("wedge.toml", &[STABILISED, "method.multiplier_mesh=\"coarser\""], "refines more", true),
        ("wedge.toml", &["method.solver=\"uzawa\""], "rarely", false),
        ("wedge.toml", &[STABILISED, "method.solver=\"uzawa\""], "uzawa (as the scene says: it rarely", true),
        ("wedge.toml", &[STABILISED], "no effect without contact", false),
        ("free.toml", &[], "no effect without contact", false),
        ("free.toml", &[STABILISED], "stabilised (the scene asks for it, but it has no effect without contact)", true),
        ("free.toml", &["method.solver=\"newton\""], "no effect without contact", true),
        ("jump.toml", &[], "17 elements instead of 16 (the data have kinks or jumps", true),
        ("free.toml", &["method.elements=3"], "4 elements instead of 3 (every straight edge needs one)", true),
        ("free.toml", &[], "16 (equal on an edge", true),
    ] {
        let sets = sets.iter().flat_map(|s| ["--set", s]);
        let plan = place.run(["plan", scene].into_iter().chain(sets.clone())).demand(0).out;
        assert_eq!(plan.contains(part), there, "{:?}: {part}\n{plan}", sets.collect::<Vec<_>>());
    }
}
