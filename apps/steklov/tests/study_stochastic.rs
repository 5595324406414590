//! The command `study --what stochastic`: rates that are known, statistics in closed form, files that agree with each other,
//! refusals.

use std::sync::atomic::AtomicUsize;

use crate::place::{Place, names};
use serde_json::{Value, json};
use steklov_document::Source;
use steklov_model::run::adaptive_loop::{Progress, run};
use steklov_study::Watch;
use steklov_study::solvers::solvers;
use steklov_study::stochastic::{Stochastic, chance, pictures, report, space};

const FILES: &str = "mean-contact-force-y-seconds.png mean-contact-force-y-seconds.svg mean-contact-force-y.png \
                     mean-contact-force-y.svg mean-energy-seconds.png mean-energy-seconds.svg mean-energy.png mean-energy.svg \
                     solver-history.png solver-history.svg solver-iterations.png solver-iterations.svg solvers.csv \
                     space-energy-seconds.png space-energy-seconds.svg space-energy.png space-energy.svg \
                     space-norm-seconds.png space-norm-seconds.svg space-norm.png space-norm.svg space.csv stochastic.csv \
                     stochastic.h5 variance-contact-force-y-seconds.png variance-contact-force-y-seconds.svg \
                     variance-contact-force-y.png variance-contact-force-y.svg variance-energy-seconds.png \
                     variance-energy-seconds.svg variance-energy.png variance-energy.svg";

/// The block of the tests with E uniform in [1800, 2200].
fn random(block: &str) -> String {
    block.replace("young = 200.0", "young = \"E\"")
        + "[random.E]\ndistribution = \"uniform\"\nlow = 1800.0\nhigh = 2200.0\n[stochastic]\ndegree = 2\nsamples = 1000\n"
}

/// The block held at its floor: J and the displacements are those of E = 1 over E.
fn linear() -> String {
    random(
        &crate::place::BLOCK
            .replace("contact = { gap = \"0\", friction = { tresca = \"F\" } }", "displacement = [\"0\", \"0\"]"),
    )
}

/// The block pressed on the floor by an overlap, its top held: full contact, so that the force is linear in E.
fn pressed() -> String {
    let held = crate::place::BLOCK
        .replace("[sides.top]\ntraction = [\"0\", \"-1\"]", "[sides.top]\ndisplacement = [\"0\", \"0\"]");
    random(
        &held
            .replace("gap = \"0\"", "gap = \"-0.2\"")
            .replace("refine = \"none\"\nelements = 8", "max_dofs = 140\ntolerance = 0.01"),
    )
}

fn run_study(place: &Place, text: &str) -> (Value, String) {
    place.write("scene.toml", text);
    let ran = place.run(["study", "scene.toml", "--what", "stochastic", "--set", "method.max_dofs=140"]).demand(0);
    let file = steklov_io::open(place.path("scene-stochastic/stochastic.h5")).unwrap();
    (serde_json::from_str(&steklov_io::load_text(&file, "summary").unwrap()).unwrap(), ran.out)
}

fn called<'a>(list: &'a Value, name: &str) -> &'a Value {
    list.as_array().unwrap().iter().find(|o| o["name"] == name).unwrap_or_else(|| panic!("no {name} in {list}"))
}

fn column(rows: &Value, name: &str) -> Vec<f64> {
    rows["points"].as_array().unwrap().iter().map(|r| r[name].as_f64().unwrap_or(f64::NAN)).collect()
}

/// 1/E has mean ln(b/a)/(b - a) and mean square 1/(ab). Gauss rules of n points err by ϱ^-2n in the mean, ϱ² = 398 that of
/// the largest ellipse without E = 0, and by (n - c) ϱ^-2n in the variance, where that pole is double; two points in each of n elements by n⁻⁴; samples by what their standard errors tell.
#[test]
fn rates_and_statistics_of_a_linear_body_are_those_of_the_inverse_modulus() {
    let (o, out) = run_study(&Place::new(), &linear());
    let energy = called(&o["chance"]["quantities"], "energy");
    let rule = |name: &str| called(&energy["rules"], name);
    let nominal = column(rule("one element of degree q"), "mean")[0];
    let (a, b, middle) = (1800.0f64, 2200.0, 2000.0);
    let mean = (b / a).ln() / (b - a);
    let variance = 1.0 / (a * b) - mean * mean;
    for (name, exact) in [("mean", middle * mean * nominal), ("variance", (middle * nominal).powi(2) * variance)] {
        let found = energy[name].as_f64().unwrap();
        assert!((found / exact - 1.0).abs() < 1e-10, "{name}: {found} {exact}");
    }
    let x = middle / ((b - a) / 2.0);
    let factor = (x + (x * x - 1.0).sqrt()).powi(2);
    for (name, rising) in [("mean_error", 1), ("variance_error", 2)] {
        let errors = column(rule("one element of degree q"), name);
        assert_eq!(errors.len(), 9);
        let ratios: Vec<f64> = errors[rising..rising + 3].windows(2).map(|e| e[0] / e[1]).collect();
        println!("{name}: factors {ratios:?} of {factor}");
        for (k, ratio) in ratios.iter().enumerate() {
            let n = (rising + k + 1) as f64; // points of the coarser rule
            let expected = if rising == 1 { 0.95..1.0 } else { (n - 1.0) / n..n / (n + 1.0) };
            assert!(expected.contains(&(ratio / factor)), "{name}: {ratios:?}");
        }
        assert!(errors[8] < 1e-12, "{name}: {errors:?}");
        let halved: Vec<f64> =
            column(rule("elements of degree 1"), name)[1..5].windows(2).map(|e| e[0] / e[1]).collect();
        assert!(halved.iter().all(|r| (r / 16.0 - 1.0).abs() < 0.05), "{name}: {halved:?}");
    }
    let samples = rule("Monte Carlo");
    for name in ["mean", "variance"] {
        let (errors, standard) =
            (column(samples, &format!("{name}_error")), column(samples, &format!("{name}_standard_error")));
        println!("Monte Carlo, {name}: {errors:?} ± {standard:?}");
        assert_eq!(column(samples, "solves"), [10.0, 30.0, 100.0, 300.0, 1000.0]);
        assert!(errors.iter().zip(&standard).skip(1).all(|(e, s)| e < &(4.0 * s)), "{errors:?} {standard:?}");
        assert!((standard[4] / standard[2] * 10.0f64.sqrt() - 1.0).abs() < 0.2, "{standard:?}");
    }
    assert_eq!(o["solvers"], Value::Null);
    assert!(out.contains("contact solvers: left out, no side is in contact"), "{out}");
}

/// In full contact the force is linear in E: one point gives its mean, two its variance. Uzawa takes more iterations the
/// finer the mesh, the others do not. HDF5, CSV, JSON object and table tell the same.
#[test]
fn contact_is_studied_and_the_files_agree() {
    let place = Place::new();
    let (o, out) = run_study(&place, &pressed());
    assert_eq!(names(&place.path("scene-stochastic")).join(" "), FILES);
    for name in FILES.split_whitespace().filter(|n| n.ends_with("png") || n.ends_with("svg")) {
        let start = if name.ends_with("png") { &b"\x89PNG\r\n\x1a\n"[..] } else { b"<" };
        assert!(place.read(&format!("scene-stochastic/{name}")).starts_with(start), "{name}");
    }
    assert_eq!((&o["complete"], &o["interrupted"], &o["failures"]), (&json!(true), &json!(false), &json!([])));
    let quantities = &o["chance"]["quantities"];
    let force = called(&called(quantities, "contact.force.y")["rules"], "one element of degree q").clone();
    let (mean, variance) = (column(&force, "mean_error"), column(&force, "variance_error"));
    assert!(mean[0] < 1e-12 && (variance[0] - 1.0).abs() < 1e-12 && variance[1] < 1e-10, "{mean:?} {variance:?}");
    assert_eq!(called(quantities, "contact.force.x")["random"], false);

    for name in ["uniform-h, p = 1", "uniform-p", "hp"] {
        let errors = column(called(&o["space"]["curves"], name), "energy_error");
        let known: Vec<f64> = errors.iter().copied().filter(|e| e.is_finite()).collect();
        assert!(known.len() > 1 && known[known.len() - 1] < 0.5 * known[0], "{name}: {errors:?}");
    }
    let dofs = column(called(&o["space"]["curves"], "uniform-h, p = 1"), "dofs");
    assert_eq!(dofs, [32.0, 64.0, 128.0]);
    assert_eq!(column(called(&o["space"]["curves"], "uniform-h, p = 1, q = 0"), "solves"), [1.0; 3]);

    let of = |name: &str| column(called(&o["solvers"], name), "iterations");
    let (uzawa, active, interior) = (of("Uzawa"), of("active set"), of("interior point"));
    let newton = of("semi-smooth Newton");
    println!("Uzawa {uzawa:?}, active set {active:?}, interior point {interior:?}");
    assert_eq!(uzawa.len(), 3);
    assert!(uzawa.windows(2).all(|n| n[1] > 1.5 * n[0]), "{uzawa:?}");
    for k in 0..3 {
        assert!(
            uzawa[k] > 5.0 * active[k] && uzawa[k] > 5.0 * interior[k] && uzawa[k] > 5.0 * newton[k],
            "{uzawa:?} {active:?} {interior:?}"
        );
    }
    for solver in o["solvers"].as_array().unwrap() {
        assert!(column(solver, "kkt").iter().all(|k| *k < 1e-9), "{solver}");
    }

    let file = steklov_io::open(place.path("scene-stochastic/stochastic.h5")).unwrap();
    let csv = |name: &str| String::from_utf8(place.read(&format!("scene-stochastic/{name}"))).unwrap();
    let mut rows = 0;
    for (k, quantity) in quantities.as_array().unwrap().iter().enumerate() {
        for (f, family) in quantity["rules"].as_array().unwrap().iter().enumerate() {
            check(&file.group(&format!("chance/{k:03}/{f:03}")).unwrap(), family);
            let start = format!("{},{},", family["name"], quantity["name"]);
            let count = csv("stochastic.csv").lines().filter(|l| l.starts_with(&start)).count();
            assert_eq!(count, column(family, "mean").len(), "{start}");
            rows += count;
        }
    }
    assert_eq!(csv("stochastic.csv").lines().count(), rows + 1);
    for (group, table, list) in
        [("space", "space.csv", &o["space"]["curves"]), ("solvers", "solvers.csv", &o["solvers"])]
    {
        let mut rows = 1;
        for (k, one) in list.as_array().unwrap().iter().enumerate() {
            check(&file.group(&format!("{group}/{k:03}")).unwrap(), one);
            rows += one["points"].as_array().unwrap().len();
        }
        assert_eq!(csv(table).lines().count(), rows, "{table}");
    }
    let history = steklov_io::load_vector(&file.group("solvers/000").unwrap(), "history").unwrap();
    assert!(history.len() as f64 >= uzawa[2] && history[uzawa[2] as usize - 1] <= 1e-10);
    for part in
        ["A block", "method.max_dofs=140", "adaptive stochastic mesh", "Uzawa", "E[<u, Su>]", "32 in scene-stochastic"]
    {
        assert!(out.contains(part), "no {part} in\n{out}");
    }
}

/// Bit by bit the columns of HDF5 are those of the JSON object, and they say what they mean.
fn check(group: &steklov_io::Group, object: &Value) {
    let bits = |v: &[f64]| v.iter().map(|x| if x.is_nan() { 0 } else { (x + 0.0).to_bits() }).collect::<Vec<_>>();
    let rows = object["points"].as_array().unwrap();
    let Some(first) = rows.first() else { return };
    for name in first.as_object().unwrap().keys() {
        assert_eq!(bits(&column(object, name)), bits(&steklov_io::load_vector(group, name).unwrap()), "{name}");
        assert!(!steklov_io::load_label(group, name).unwrap().meaning.is_empty());
    }
}

/// After a wish to stop there is what there is, and it can be told and drawn.
#[test]
fn interruptions_keep_what_is_finished() {
    let scene = steklov_document::parse(&pressed(), "scene", &[]).unwrap();
    let random = scene.random.as_ref().unwrap();
    let (stopped, tell) = (AtomicUsize::new(1), &mut |_: &str, _: &str| {});
    let mut last = run(&scene, Progress::first(&scene), &stopped, &mut |_, _| Ok(())).unwrap();
    let chance = chance(&scene, random, &mut last, &mut Watch::new(&stopped, tell)).unwrap();
    let space = space(&scene, random, &mut Watch::new(&stopped, tell)).unwrap();
    let solvers = solvers(&scene, &mut Watch::new(&stopped, tell)).unwrap().unwrap();
    assert!(chance.points.is_empty() && space.points.is_empty() && solvers.methods.is_empty());
    let study = Stochastic {
        scene: &scene,
        source: &Source::default(),
        chance,
        space,
        solvers: Some(solvers),
        interrupted: true,
    };
    assert!(!study.complete() && report(&study).text().contains("interrupted: what was finished is here"));
    let folder = tempfile::tempdir().unwrap();
    assert!(pictures(&study, folder.path()).unwrap().is_empty());
}

#[test]
fn what_cannot_be_studied_is_refused() {
    let place = Place::new();
    std::fs::create_dir(place.path("full")).unwrap();
    place.write("full/old", "old");
    place.write("scene.toml", linear());
    let before = place.names();
    for (scene, arguments, parts) in [
        ("block.toml", &[][..], &["block.toml", "no datum of the scene uses any", "declare a name under [random]"][..]),
        ("scene.toml", &["--strategies", "hp"], &["--strategies belongs to --what convergence"]),
        ("scene.toml", &["--multipliers", "stabilised"], &["--multipliers belongs to --what convergence"]),
        ("scene.toml", &["--beside", "none.json"], &["--beside belongs to --what stability"]),
        ("scene.toml", &["--out", "full"], &["full exists", "--force"]),
        (
            "scene.toml",
            &["--set", "stochastic.quantities=[\"pressure\"]"],
            &["\"pressure\" is not a number of the result"],
        ),
    ] {
        let ran = place.run(["study", scene, "--what", "stochastic", "--quiet"].iter().chain(arguments)).demand(1);
        assert!(parts.iter().all(|part| ran.err.contains(part)), "{parts:?}: {}", ran.err);
    }
    assert_eq!(place.names(), before);
}

/// A bar in tension of E = ½ (1 + ½ a) in half of its cells and ½ (1 + ½ b) in the others, a and b uniform on [-1, 1]: the end
/// moves by the mean of two independent 2/(1 + ½ a). Galerkin and sparse grids have Gauss rules and Legendre polynomials of a
/// function with a pole at -2, whose coefficients fall by 2 + √3; samples err by what they tell.
#[test]
fn grids_are_studied_by_all_methods_that_solve_them() {
    let text = r#"
title = "Bar of two random halves"
[body]
corners = [[0, 0], [1, 0], [1, 0.5], [0, 0.5]]
sides = ["bottom", "end", "top", "clamp"]
[material]
poisson = 0.0
[material.cells]
size = 0.125
young = "0.5*(1 + 0.5*a*if(x < 0.5, 1, 0) + 0.5*b*if(x < 0.5, 0, 1))"
[grid]
coarse = [8, 4]
fine = [1, 1]
[sides.clamp]
displacement = [0, "free"]
[sides.bottom]
displacement = ["free", 0]
[sides.end]
traction = [1, 0]
[probe]
points = [[1, 0]]
[method]
refine = "none"
[random]
a = { distribution = "uniform", low = -1, high = 1 }
b = { distribution = "uniform", low = -1, high = 1 }
[stochastic]
samples = 1000
quantities = ["probe.0.displacement.x"]
"#;
    let place = Place::new();
    let (o, out) = run_study(&place, text);
    let tip = called(&o["chance"]["quantities"], "probe.0.displacement.x");
    let mean = 2.0 * 3f64.ln();
    let variance = 2.0 * 0.25 * (4.0 / (0.5 * 1.5) - mean * mean);
    for (name, exact) in [("mean", mean), ("variance", variance)] {
        let found = tip[name].as_f64().unwrap();
        assert!((found / exact - 1.0).abs() < 1e-9, "{name}: {found} {exact}");
    }
    let rule = |name: &str| called(&tip["rules"], name);
    let used = |name: &str| !rule(name)["points"].as_array().unwrap().is_empty();
    for name in ["one element of degree q", "elements of degree 1", "elements of degree 3", "adaptive stochastic mesh"]
    {
        assert!(!used(name), "{name}");
    }
    // the mean errs by the square of what is left out, (2 + √3)^(-2p - 2), a variance by that too
    let errors = column(rule("Galerkin, total degree"), "mean_error");
    let ratios: Vec<f64> = errors[1..6].windows(2).map(|e| e[0] / e[1]).collect();
    println!("Galerkin: {errors:?}, ratios {ratios:?}");
    assert!(ratios.iter().all(|r| (r / (2.0 + 3f64.sqrt()).powi(2) - 1.0).abs() < 0.1), "{ratios:?}");
    let sparse = column(rule("sparse grid"), "mean_error");
    assert!(sparse.len() == 6 && sparse.windows(2).all(|e| e[1] < 0.2 * e[0]), "{sparse:?}");
    for name in ["corrected polynomials", "multilevel Monte Carlo", "Monte Carlo"] {
        let [errors, standard, seconds] =
            ["mean_error", "mean_standard_error", "seconds"].map(|key| column(rule(name), key));
        println!("{name}: {errors:?} ± {standard:?}");
        assert!(errors.iter().zip(&standard).skip(2).all(|(e, s)| e < &(4.0 * s)), "{name}: {errors:?} {standard:?}");
        assert!(seconds.iter().all(|s| s.is_finite()), "{seconds:?}");
    }
    assert_eq!((&o["complete"], &o["solvers"]), (&json!(true), &Value::Null));
    assert!(o["space"]["curves"].as_array().unwrap().iter().all(|c| c["points"] == json!([])));
    assert!(out.contains("Galerkin of total degree 11") && out.contains("of boundary elements alone"), "{out}");
    let files = "mean-probe-0-displacement-x-seconds.png mean-probe-0-displacement-x-seconds.svg stochastic.csv stochastic.h5 \
                 variance-probe-0-displacement-x-seconds.png variance-probe-0-displacement-x-seconds.svg";
    assert_eq!(names(&place.path("scene-stochastic")).join(" "), files);
}
