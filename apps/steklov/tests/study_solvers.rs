//! The command `study --what solvers`: contact solvers on the same problems, and the superlinear convergence of Newton's method.

use crate::place::{Place, names};
use serde_json::Value;

const FILES: &str = "newton-order.png newton-order.svg newton-ratio.png newton-ratio.svg newton.csv solver-history.png \
                     solver-history.svg solver-iterations.png solver-iterations.svg solvers.csv solvers.h5";

/// A wedge under a block that its top holds: contact has two ends, and friction slips beside a place that sticks.
const WEDGE: &str = r#"title = "A wedge"
[body]
corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]
sides = ["floor", "right", "top", "left"]
[material]
young = 1000.0
poisson = 0.3
[sides.floor]
contact = { gap = "0.1*abs(x) - 0.05", friction = { tresca = "3" } }
[sides.top]
displacement = ["0", "0"]
"#;

fn column(points: &Value, name: &str) -> Vec<f64> {
    points.as_array().unwrap().iter().map(|p| p[name].as_f64().unwrap_or(f64::NAN)).collect()
}

/// Errors and ratios fit together, the ratios fall to nothing on every mesh, and Newton's answers are those of the other solvers.
#[test]
fn newtons_method_converges_superlinearly() {
    let place = Place::new();
    place.write("wedge.toml", WEDGE);
    let arguments = ["study", "wedge.toml", "--what", "solvers", "--json", "--quiet", "--set", "method.max_dofs=300"];
    let ran = place.run(arguments).demand(0);
    assert_eq!(names(&place.path("wedge-solvers")).join(" "), FILES);
    let o: Value = serde_json::from_str(&ran.out).unwrap();
    for solver in o["solvers"].as_array().unwrap() {
        assert_eq!(column(&solver["points"], "elements"), [16.0, 32.0, 64.0, 128.0], "{solver}");
        assert!(column(&solver["points"], "kkt").iter().all(|k| *k < 1e-9), "{solver}");
    }
    let newton = o["solvers"].as_array().unwrap().iter().find(|s| s["name"] == "semi-smooth Newton").unwrap();
    assert!(column(&newton["points"], "iterations").iter().all(|n| (3.0..15.0).contains(n)), "{newton}");

    let all = o["newton"].as_array().unwrap();
    for elements in [16.0, 32.0, 64.0, 128.0] {
        let on_mesh: Vec<&Value> = all.iter().filter(|i| i["elements"] == elements).collect();
        let of = |name: &str| on_mesh.iter().map(|i| i[name].as_f64().unwrap_or(f64::NAN)).collect::<Vec<f64>>();
        let (numbers, errors, ratios) = (of("iterate"), of("error"), of("ratio"));
        assert!(numbers.iter().enumerate().all(|(k, n)| *n == k as f64), "{numbers:?}");
        assert!(errors[0] > 1e-2 && errors[errors.len() - 1] < 1e-9, "{elements}: {errors:?}");
        for (k, ratio) in ratios.iter().enumerate().filter(|(_, ratio)| ratio.is_finite()) {
            assert!((ratio - errors[k + 1] / errors[k]).abs() < 1e-14, "{elements}: {errors:?} {ratios:?}");
        }
        let known: Vec<f64> = ratios.iter().copied().filter(|ratio| ratio.is_finite()).collect();
        let [.., before, last] = known[..] else { panic!("{elements}: {ratios:?}") };
        println!("{elements} elements: {known:.5?}");
        // linear convergence would keep the ratio of the first steps
        assert!(known[0] > 0.1 && before < 0.1 && last < 0.5 * before && last < 5e-3, "{elements}: {ratios:?}");
    }
}

/// A disc that Coulomb's friction and its weight hold: the line search stalls, and active sets find the answer.
const DISC: &str = r#"
body = { circle = { centre = [0, 0], radius = 1 }, side = "rim" }
material = { young = 1000, poisson = 0.3 }
sides.rim.contact = { gap = "1 + y", friction = { coulomb = "0.2" } }
body_force = { value = ["0", "-1"] }
"#;

/// Where Newton's method gives way its iterations are not those of another method.
#[test]
fn a_method_that_gives_way_is_told() {
    let place = Place::new();
    place.write("disc.toml", DISC);
    let arguments = ["study", "disc.toml", "--what", "solvers", "--json", "--quiet", "--set", "method.max_dofs=150"];
    let o: Value = serde_json::from_str(&place.run(arguments).demand(0).out).unwrap();
    let newton = o["solvers"].as_array().unwrap().iter().find(|s| s["name"] == "semi-smooth Newton").unwrap();
    let told = o["newton_failures"].as_array().unwrap();
    let gave_way: Vec<f64> = told.iter().map(|f| f["elements"].as_f64().unwrap()).collect();
    assert!(!gave_way.is_empty() && told.iter().all(|f| f["message"].as_str().unwrap().contains("active sets")), "{o}");
    assert_eq!(&newton["failures"], &o["newton_failures"]);
    for point in newton["points"].as_array().unwrap() {
        let elements = point["elements"].as_f64().unwrap();
        assert_eq!(point["iterations"].is_null(), gave_way.contains(&elements), "{point}");
        let iterates = o["newton"].as_array().unwrap().iter().filter(|i| i["elements"] == elements);
        let last = iterates.filter_map(|i| i["error"].as_f64()).next_back().unwrap();
        assert!((last > 1e-6) == gave_way.contains(&elements), "{elements}: {last}");
    }
}

#[test]
fn scenes_without_contact_or_on_a_grid_are_refused() {
    let place = Place::new();
    place.write("free.toml", WEDGE.replace("contact = {", "# contact = {"));
    let ran = place.run(["study", "free.toml", "--what", "solvers"]).demand(1);
    assert!(ran.err.contains("no side is in contact") && ran.err.contains("--what convergence"), "{}", ran.err);
    let grid = format!("{WEDGE}[grid]\ncoarse = [4, 4]\nfine = [2, 2]\n[method]\nmodel = \"fem\"\n");
    place.write("grid.toml", grid.replace("0.1*abs(x) - 0.05", "-0.05"));
    let ran = place.run(["study", "grid.toml", "--what", "solvers"]).demand(1);
    assert!(ran.err.contains("the scene has a grid") && ran.err.contains("method.model = \"bem\""), "{}", ran.err);
}
