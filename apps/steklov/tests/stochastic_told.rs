//! What statistics cannot give is told and not taken as a number.

use crate::place::{BLOCK, Place};

/// The block with two germs, `a` and `b` on (-1, 1).
fn block(gap: &str, traction: &str, stochastic: &str) -> String {
    let germ = |name: &str| format!("[random.{name}]\ndistribution = \"uniform\"\nlow = -1.0\nhigh = 1.0\n");
    let text = BLOCK.replace("gap = \"0\"", &format!("gap = \"{gap}\"")).replace("\"-1\"", &format!("\"{traction}\""));
    format!("{text}{}{}[stochastic]\n{stochastic}", germ("a"), germ("b"))
}

#[test]
fn a_tolerance_that_is_missed_is_told() {
    let place = Place::new();
    let adaptive = "refine = \"adaptive\"\nmethod = \"collocation\"\nquantities = [\"energy\"]\nmax_nodes = 20\n";
    let load = "-exp(a) - exp(b/2)";
    for (tolerance, reason) in [("1e-9", "max_nodes"), ("0.5", "tolerance")] {
        place.write("block.toml", block("0", load, &format!("{adaptive}tolerance = {tolerance}\n")));
        let missed = reason == "max_nodes";
        let status = if missed { 3 } else { 0 };
        let ran = place.run(["solve", "--json", "--force", "block.toml"]).demand(status);
        let told = ran.json();
        let word = if missed { "max_nodes" } else { "solved" }; // the one mesh in space is
        assert_eq!(told["stochastic"]["solution"]["reason"], reason);
        assert_eq!((&told["reason"], &told["converged"]), (&word.into(), &(!missed).into()));
        assert_eq!(ran.err.contains("NOT REACHED"), missed, "{}", ran.err);
        assert!(!place.run(["solve", "--json", "--force", "--quiet", "block.toml"]).demand(status).err.contains("NOT"));
        let ran = place.run(["solve", "--force", "block.toml"]).demand(status);
        assert_eq!(ran.out.contains("stochastic tolerance NOT REACHED"), missed, "{}", ran.out);
    }
    for (settings, reason) in [("", "tolerance"), ("method = \"auto\"\n", "tolerance"), ("degree = 3\n", "solved")] {
        place.write("block.toml", block("0", load, settings));
        assert_eq!(place.json(0, &["block.toml"])["stochastic"]["solution"]["reason"], reason);
    }
}

#[test]
fn negative_variances_and_probabilities_of_a_sparse_grid_are_no_numbers() {
    let place = Place::new();
    let sparse = "method = \"sparse\"\nlevel = 1\nquantities = [\"contact.force.y\"]\n";
    // what differs in the middle only, where the weight is negative
    let bump = "exp(-100*(a^2 + b^2))";
    place.write("block.toml", block("0", &format!("-1 - {bump}"), sparse));
    let force = &place.json(0, &["block.toml"])["stochastic"]["contact"]["force"]["y"];
    assert!(force["variance"].is_null() && force["mean"].is_number(), "{force}");
    assert!(place.run(["solve", "--force", "block.toml"]).demand(0).out.contains("variance NOT RESOLVED"));
    place.write("block.toml", block("0", "-1 - a/9", sparse));
    let force = &place.json(0, &["block.toml"])["stochastic"]["contact"]["force"]["y"];
    let variance = force["variance"].as_f64().unwrap();
    assert!((variance - 4.0 / 243.0).abs() < 1e-12, "{variance}");
    // the ends of the floor touch in the middle outcome only
    place.write("block.toml", block(&format!("(x-1)^2*(1 - {bump})"), "-1", sparse));
    let out = place.run(["solve", "--force", "--plots", "drawn", "block.toml"]).demand(0).out;
    assert!(out.contains("probability of contact NOT RESOLVED"), "{out}");
}

#[test]
fn numbers_of_the_run_are_no_quantities_of_an_outcome() {
    let place = Place::new();
    for path in ["dofs", "iterations", "converged", "seconds.total", "energy_extrapolated"] {
        place.write("block.toml", block("0", "-1 - a/9 - b/9", &format!("quantities = [\"{path}\"]\n")));
        let err = place.run(["solve", "--force", "block.toml"]).demand(1).err;
        assert!(err.contains("not a number of the result") && err.contains(path), "{err}");
    }
    let paths = "quantities = [\"strain_energy\", \"contact.length\", \"probe.0.displacement.y\"]\n";
    place.write("block.toml", block("0", "-1 - a/9 - b/9", paths));
    place.json(0, &["block.toml"]);
}

#[test]
fn what_does_not_vary_has_no_effects() {
    let place = Place::new();
    let force_y = "quantities = [\"contact.force.y\"]\n";
    place.write("block.toml", block("0", "-1 - a/9 - b/3", force_y));
    let effects = &place.json(0, &["block.toml"])["stochastic"]["contact"]["force"]["y"]["effects"];
    let of = |germ: &str| effects[germ].as_f64().unwrap();
    assert!((of("a") - 0.1).abs() < 1e-12 && (of("b") - 0.9).abs() < 1e-12, "{effects}");
    // the load alone says how much is carried
    place.write("block.toml", block("0.001*(2 + a + b)*(x-1)^2", "-1", force_y));
    let force = &place.json(0, &["block.toml"])["stochastic"]["contact"]["force"]["y"];
    let out = place.run(["solve", "--force", "--plots", "drawn", "block.toml"]).demand(0).out;
    assert!(out.contains("contact.force.y: 2, constant but for rounding"), "{out}");
    let drawn = std::fs::read_to_string(place.path("drawn/block-density.svg")).unwrap();
    assert!(drawn.contains(">constant 2<"), "{drawn}");
    assert!(force["effects"].is_null() && (force["mean"].as_f64().unwrap() - 2.0).abs() < 1e-12, "{force}");
}
