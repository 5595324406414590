//! Random input of scenes: what the plan says of it is what is solved, and what is impossible is refused before.

use crate::place::{BLOCK, Place};
use steklov_document::SceneError;
use steklov_plan::points;
use steklov_problem::Scene;

/// The block held at its floor, with this modulus.
fn held(young: &str, more: &str) -> String {
    let contact = "contact = { gap = \"0\", friction = { tresca = \"F\" } }";
    BLOCK.replace(contact, "displacement = [\"0\", \"0\"]").replace("young = 200.0", &format!("young = \"{young}\""))
        + more
}

const UNIFORM: &str = "[random.xi]\ndistribution = \"uniform\"\nlow = -1.0\nhigh = 1.0\n";
const NORMAL: &str = "[random.xi]\ndistribution = \"normal\"\nmean = 0.0\ndeviation = 1.0\n";

fn parse(text: &str, overrides: &[&str]) -> Result<Scene, SceneError> {
    let overrides: Vec<String> = overrides.iter().map(|&s| s.to_owned()).collect();
    steklov_document::parse(text, "scene.toml", &overrides)
}

/// A modulus that is clipped or steps near the ends of its germ is not affine; one that is clipped beyond them is.
#[test]
fn nodes_are_coupled_where_the_modulus_is_not_affine() {
    for (young, coupled) in [
        ("2000*(1+0.2*xi)", false),
        ("max(1400, 2000*(1+0.27*xi))", false),
        ("2000*(1+0.2*xi) + if(xi > 1.01, 4000, 0)", false),
        ("2000*(1+0.2*xi) + if(xi > 0.96, 4000, 0)", true),
        ("2000*(1+0.2*xi) + if(xi < -0.999, 4000, 0)", true),
        ("2000*(1+0.2*xi) + if(abs(xi - 0.5) < 0.05, 4000, 0)", true),
        ("max(1500, 2000*(1+0.27*xi))", true),
        ("2000*exp(0.1*xi)", true),
    ] {
        let scene = parse(&held(young, UNIFORM), &[]).unwrap();
        let plan = steklov_plan::plan(&scene);
        let decision = plan.modelled.iter().find(|d| d.what == "stochastic nodes").unwrap();
        assert_eq!(decision.choice, if coupled { "coupled" } else { "one by one" }, "{young}");
    }
}

/// 14 Gauss points of a normal germ stay within 6.1 deviations, 31 reach beyond 9; so do those of the outer one of two elements, whose
/// weight has the same tail. Levels 6 and 12 of a sparse grid have rules of 13 and 25 points.
#[test]
fn outcomes_are_looked_at_out_to_the_last_node() {
    let text = held("if(abs(xi) > 7.5, -1, 200)", NORMAL);
    for (method, sound, broken) in [
        ("collocation", &["stochastic.degree=13"][..], &["stochastic.degree=30"][..]),
        ("galerkin", &["stochastic.degree=13"], &["stochastic.degree=30"]),
        (
            "galerkin",
            &["stochastic.elements=2", "stochastic.degree=3"],
            &["stochastic.elements=2", "stochastic.degree=30"],
        ),
        ("sparse", &["stochastic.level=6"], &["stochastic.level=12"]),
    ] {
        let method = format!("stochastic.method=\"{method}\"");
        let with = |more: &[&str]| parse(&text, &[&[method.as_str()], more].concat());
        with(sound).unwrap_or_else(|e| panic!("{method} {sound:?}: {}", e.render()));
        let error = with(broken).expect_err(&format!("{method} {broken:?}"));
        assert!(error.message.contains("for xi = "), "{}", error.message);
    }
    parse(&text, &["stochastic.method=\"monte-carlo\""]).unwrap();
}

/// Two germs; every method solves at as many points as the plan says.
#[test]
fn the_plan_counts_the_points_that_are_solved() {
    let second = "[random.eta]\ndistribution = \"normal\"\nmean = 1.0\ndeviation = 0.1\n";
    let more = format!("{UNIFORM}{second}[stochastic]\nsamples = 7\nlevel = 2\ndegree = 2\nelements = 2\n");
    for (young, coupled) in [("2000*(1+0.1*xi)", false), ("2000*exp(0.1*xi)", true)] {
        let text = held(young, &more).replace("\"-1\"", "\"-eta\"");
        // the sparse grid: 3 by 3 points, and the 4 others of a rule of 5 along each axis
        for (method, expected) in [("galerkin", 36), ("collocation", 36), ("sparse", 17), ("monte-carlo", 7)] {
            let method_key = format!("stochastic.method=\"{method}\"");
            let scene = parse(&text, &[&method_key]).unwrap();
            let place = Place::new();
            place.write("scene.toml", &text);
            let o = place.json(0, &["scene.toml", "--set", &method_key]);
            let solved = &o["stochastic"]["solution"];
            assert_eq!(solved["solves"], expected, "{method}: {solved}");
            assert_eq!(points(&scene, scene.random.as_ref().unwrap()), f64::from(expected), "{method}");
            assert_eq!(solved["coupled"], coupled && method == "galerkin", "{method}");
        }
    }
}

/// More germs than have a rule for the spatial error: its samples are not those of the scene, and the answers' are.
#[test]
fn the_seed_does_not_move_the_mesh() {
    let germs: String =
        (0..5).map(|i| format!("[random.a{i}]\ndistribution = \"uniform\"\nlow = 0.8\nhigh = 1.2\n")).collect();
    let method = "[stochastic]\nmethod = \"monte-carlo\"\nsamples = 8\n";
    let load = "traction = [\"a0*x\", \"-a1*if(x < 1, a2, a3)*a4\"]";
    let text = held("200.0", &format!("{germs}{method}")).replace("traction = [\"0\", \"-1\"]", load);
    let text = text.replace("refine = \"none\"\nelements = 8", "max_dofs = 120\ntolerance = 0.2");
    let place = Place::new();
    place.write("scene.toml", &text);
    let [one, two] = ["stochastic.seed=1", "stochastic.seed=2"].map(|s| place.json(0, &["scene.toml", "--set", s]));
    assert_ne!(one["stochastic"]["energy"]["mean"], two["stochastic"]["energy"]["mean"]);
    assert!(one["estimate_relative"].as_f64().unwrap() > 0.0, "{one}");
    for key in ["dofs", "steps", "energy", "estimate", "estimate_relative"] {
        assert_eq!(one[key], two[key], "{key}");
    }
}
