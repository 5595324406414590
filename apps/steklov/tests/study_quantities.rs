//! The command `study --what quantities`: error bars of quantities judged by their true errors.

use crate::place::{Place, names};
use serde_json::Value;

const FILES: &str =
    "quantities-ratio.png quantities-ratio.svg quantities.csv quantities.h5 quantities.png quantities.svg";

/// Westergaard's waves: contact ends at a quarter, and the pressure at the crest is known.
const WAVES: &str = r#"title = "Waves"
[body]
corners = [[0, 0], [0.5, 0], [0.5, 3], [0, 3]]
sides = ["floor", "right", "top", "left"]
[material]
young = 1
poisson = 0.3
[sides.floor]
contact = { gap = "0.01*(1 - cos(2*pi*x))" }
[sides.right]
displacement = ["0", "free"]
[sides.left]
displacement = ["0", "free"]
[sides.top]
pressure = 0.01726149809664721
[quantities]
crest = { pressure_at = [0, 0] }
[method]
tolerance = 1e-4
"#;

#[test]
fn errors_are_the_true_ones_and_shares_those_of_the_rows() {
    let place = Place::new();
    place.write("waves.toml", WAVES);
    let ran = place.run(["study", "waves.toml", "--what", "quantities", "--json", "--quiet"]).demand(0);
    assert_eq!(names(&place.path("waves-quantities")).join(" "), FILES);
    let o: Value = serde_json::from_str(&ran.out).unwrap();
    assert_eq!((&o["complete"], &o["failure"]), (&Value::Bool(true), &Value::Null));

    let quantities = o["quantities"].as_array().unwrap();
    // half of the wave length in contact, and Westergaard's pressure
    for (name, exact) in [("contact.length", 0.25), ("pressure.crest", 0.048_822_889_4)] {
        let quantity = quantities.iter().find(|q| q["name"] == name).unwrap();
        let mut known = 0;
        for point in quantity["points"].as_array().unwrap() {
            let of = |key: &str| point[key].as_f64().unwrap_or(f64::NAN);
            if of("effectivity").is_finite() {
                known += 1;
                // the bar of the reference is a twentieth of the error at most
                let true_error = (of("value") - exact).abs();
                assert!((of("error") - true_error).abs() < 0.05 * true_error, "{name}: {point}");
                assert!((of("effectivity") * of("error") / of("uncertainty") - 1.0).abs() < 1e-12, "{name}: {point}");
                assert!(of("smoothed") <= of("effectivity"), "{name}: {point}");
            }
        }
        assert!(known > 1, "{name}: {quantity}");
    }
    let points = || quantities.iter().flat_map(|q| q["points"].as_array().unwrap());
    for (k, in_doubt) in [false, true].into_iter().enumerate() {
        let is = |p: &&Value| p["effectivity"].is_number() && p["doubts"].as_array().unwrap().is_empty() != in_doubt;
        let ratios: Vec<f64> = points().filter(is).map(|p| p["effectivity"].as_f64().unwrap()).collect();
        let shares = &o["shares"][k];
        assert_eq!(shares["count"], ratios.len(), "{shares}");
        let above = ratios.iter().filter(|r| **r >= 0.5).count() as f64 / ratios.len() as f64;
        assert!((shares["above_0.5"].as_f64().unwrap() - above).abs() < 1e-12, "{shares} {above}");
        assert_eq!(shares["least"].as_f64(), ratios.iter().copied().reduce(f64::min), "{shares}");
    }
    let csv = std::fs::read_to_string(place.path("waves-quantities/quantities.csv")).unwrap();
    assert!(csv.starts_with("quantity,step,dofs,value,uncertainty,error,effectivity,smoothed,doubts\n"), "{csv}");
    assert_eq!(csv.lines().count(), 1 + points().count());
}

/// Halved cells against cells of a quarter of the last ones, and coarse cells that adapt against fine cells of a quarter.
#[test]
fn grids_are_judged_by_finer_ones() {
    let place = Place::new();
    let scene = |grid: &str| {
        format!(
            "title = \"Plate\"\n[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"lower\", \"right\", \"upper\", \"left\"]\n\
             [material]\nyoung = 10\npoisson = 0.3\n[sides.left]\ndisplacement = [0, 0]\n[sides.right]\ntraction = [1, \"y\"]\n\
             [probe]\npoints = [[1.13, 0.37], [0.71, 0.82]]\n[quantities]\nmean = {{ mean_displacement = \"right\" }}\n\
             [grid]\n{grid}\n"
        )
    };
    let cases = [
        ("halved", "coarse = [8, 4]\nfine = [1, 1]\n[method]\nmodel = \"fem\"\ntolerance = 1e-9\nmax_dofs = 20000", 5),
        ("coarse", "coarse = [4, 2]\nfine = [8, 8]\n[method]\nmodel = \"msfem\"\ntolerance = 1e-9\nmax_steps = 3", 3),
    ];
    for (name, grid, steps) in cases {
        place.write(&format!("{name}.toml"), scene(grid));
        let ran = place.run(["study", &format!("{name}.toml"), "--what", "quantities", "--json", "--quiet"]).demand(0);
        let o: Value = serde_json::from_str(&ran.out).unwrap();
        let quantities = o["quantities"].as_array().unwrap();
        let mean = quantities.iter().find(|q| q["name"] == "mean_displacement.mean.x").unwrap();
        assert_eq!(mean["points"].as_array().unwrap().len(), steps, "{name}: {mean}");
        let shares = &o["shares"][0];
        let of = |key: &str| shares[key].as_f64().unwrap_or(f64::NAN);
        assert!(of("count") > 20.0 && of("above_0.5") >= 0.95 && of("below_10") >= 0.8, "{name}: {shares}");
    }
}

#[test]
fn what_has_no_bars_at_steps_is_refused() {
    let place = Place::new();
    place.write("waves.toml", WAVES);
    let one_mesh = ["study", "waves.toml", "--what", "quantities", "--set", "method.refine=\"none\""];
    let ran = place.run(one_mesh).demand(1);
    assert!(ran.err.contains("its mesh is not refined") && ran.err.contains("method.refine = \"hp\""), "{}", ran.err);

    let random = WAVES
        .replace("0.01726149809664721", "\"0.017 + 0.001*g\"")
        .replace("[quantities]\ncrest = { pressure_at = [0, 0] }", "")
        + "[random.g]\ndistribution = \"uniform\"\nlow = -1.0\nhigh = 1.0\n[stochastic]\ndegree = 2\n";
    place.write("random.toml", &random);
    let ran = place.run(["study", "random.toml", "--what", "quantities"]).demand(1);
    assert!(ran.err.contains("random input") && ran.err.contains("--what stochastic"), "{}", ran.err);
}

/// Where nothing presses every number is exact, and the study says why it has no ratios.
#[test]
fn an_exact_answer_leaves_nothing_to_judge() {
    let place = Place::new();
    place.write("waves.toml", WAVES);
    let nothing = ["study", "waves.toml", "--what", "quantities", "--quiet", "--set", "sides.top.pressure=0"];
    let ran = place.run(nothing).demand(0);
    assert!(ran.out.contains("there is nothing to judge"), "{}", ran.out);
    let ran = place.run(["study", "waves.toml", "--what", "quantities", "--quiet", "--out", "pressed"]).demand(0);
    assert!(!ran.out.contains("there is nothing to judge"), "{}", ran.out);
}
