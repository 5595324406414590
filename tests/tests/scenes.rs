//! The gallery: every scene of `scenes/` is solved and compared with the numbers of its `[expect]` table.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use steklov_model::grid::OnGrid;
use steklov_model::run::adaptive_loop::Model;
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::stochastic::OutcomesWatch;
use steklov_model::summary::{Audit, Summary};
use steklov_plan::{Plan, plan};
use steklov_problem::Scene;
use steklov_tests::{adapt, attempt_grid, unbalanced_forces, unbalanced_nodes};

/// Measures of the audit and of equilibrium may be at most this.
const EXACT: f64 = 1e-10;
/// Resultants of bodies on grids may be off by so many times that, for they are sums over many cells; and that and what is left at
/// a node by the root of the contrast of moduli.
const ROUNDED: f64 = 10.0;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes")
}

/// The scenes in order; links to them are left out.
fn gallery() -> Vec<PathBuf> {
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder())
        .expect("the folder of the scenes")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml") && !path.is_symlink())
        .collect();
    paths.sort();
    assert!(!paths.is_empty(), "no scene in {}", folder().display());
    paths
}

fn name(path: &Path) -> String {
    path.file_stem().expect("a file name").to_string_lossy().into_owned()
}

fn read(path: &Path, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    steklov_document::read(path, &overrides).unwrap_or_else(|e| panic!("{}: {}", name(path), e.render()))
}

/// The summary of a solved scene, and the residual of equilibrium over the scale of forces.
fn solved(scene: &Scene) -> (Summary, f64) {
    if scene.body().grid.is_some() {
        let mut run = attempt_grid(scene).unwrap_or_else(|e| panic!("{}: {e}", scene.title));
        let outcomes = OnGrid::outcomes(scene, &mut run, &OutcomesWatch::NONE, &mut |_| Ok(()))
            .unwrap_or_else(|e| panic!("{}: {e}", scene.title));
        let (forces, nodes) = (unbalanced_forces(scene, &run.last), unbalanced_nodes(scene, &run.last));
        println!("{}: forces {forces:.1e}, nodes {nodes:?}", scene.title);
        let summary = Summary::of_run(scene, &run, outcomes.as_ref());
        let contrast = summary.grid.as_ref().map_or(1.0, |grid| grid.contrast);
        let equilibrium = (forces / ROUNDED).max(nodes.unwrap_or(0.0)) / contrast.max(1.0).sqrt();
        return (summary, equilibrium);
    }
    let mut run = adapt(scene).unwrap_or_else(|e| panic!("{}: {e}", scene.title));
    let equilibrium = run.last.equilibrium;
    let of_outcomes = scene.expect.iter().any(|expected| expected.path.starts_with("stochastic"));
    let outcomes = of_outcomes.then(|| {
        BoundaryElements::outcomes(scene, &mut run, &OutcomesWatch::NONE, &mut |_| Ok(()))
            .unwrap_or_else(|e| panic!("{}: {e}", scene.title))
    });
    (Summary::of_run(scene, &run, outcomes.flatten().as_ref()), equilibrium)
}

fn numbered(number: &str) -> PathBuf {
    gallery().into_iter().find(|p| name(p).starts_with(number)).unwrap_or_else(|| panic!("no scene {number}"))
}

fn worst(audit: &Audit) -> f64 {
    let Audit { equilibrium, penetration, tension, complementarity, friction } = *audit;
    [equilibrium, penetration, tension, complementarity, friction].into_iter().fold(0.0, f64::max)
}

#[test]
fn every_scene_gives_the_numbers_that_it_promises() {
    let mut wrong = Vec::new();
    for path in gallery() {
        let name = name(&path);
        let scene = read(&path, &[]);
        if scene.expect.is_empty() {
            wrong.push(format!("{name}: no [expect] table"));
            continue;
        }
        let (summary, equilibrium) = solved(&scene);
        let residual = summary.audit.as_ref().map_or(0.0, worst).max(equilibrium);
        println!("{name}: {} dofs, converged {}, residual {residual:.1e}", summary.dofs, summary.converged);
        if !summary.converged || residual.is_nan() || residual > EXACT {
            wrong.push(format!("{name}: converged {}, residual {residual:e}", summary.converged));
        }
        for expected in &scene.expect {
            let path = &expected.path;
            if expected.source.is_empty() {
                wrong.push(format!("{name}: {path} has no source"));
            }
            let Some(got) = summary.at(path) else {
                wrong.push(format!("{name}: the result has no number at {path}"));
                continue;
            };
            let difference = got - expected.value;
            let line =
                format!("{path:28} {:>22.15e} {got:>22.15e} {difference:>9.1e} {:>7.0e}", expected.value, expected.tol);
            println!("  {line}");
            if difference.is_nan() || difference.abs() > expected.tol {
                wrong.push(format!("{name}: {line}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn scenes_are_numbered_and_their_plain_names_are_links() {
    for (k, path) in gallery().iter().enumerate() {
        let name = name(path);
        assert_eq!(name.split('-').next(), Some(format!("{:02}", k + 1).as_str()), "{name}");
        let readme = std::fs::read_to_string(folder().join("README.md")).expect("scenes/README.md");
        assert!(readme.contains(&format!("{name}.toml")), "{name} is not in the table of scenes/README.md");
    }
    for (link, target) in [("block-on-floor", "15-block-on-floor"), ("wedge-gap", "17-wedge-gap")] {
        let found = std::fs::read_link(folder().join(format!("{link}.toml"))).expect(link);
        assert_eq!(found, Path::new(&format!("{target}.toml")));
    }
}

/// choice by what is decided about
fn choices(decisions: &[steklov_plan::Decision]) -> BTreeMap<&str, &str> {
    decisions.iter().map(|d| (d.what.as_str(), d.choice.as_str())).collect()
}

#[test]
fn plans_are_the_least_model() {
    for path in gallery() {
        let name = name(&path);
        let scene = read(&path, &[]);
        let found: Plan = plan(&scene);
        assert_eq!(found, plan(&scene), "{name}: a plan is a function of the scene");
        let (modelled, left_out) = (choices(&found.modelled), choices(&found.left_out));
        // what the file says, read without the scene's own reader
        let text = std::fs::read_to_string(&path).expect("the scene");
        let table: toml::Table = text.parse().expect("TOML");
        let none = toml::Table::new();
        let sides = table.get("sides").map_or(&none, |sides| sides.as_table().expect("a table of sides"));
        let interfaces = table.get("interface").map_or(Vec::new(), |all| all.as_array().expect("a list").clone());
        let touches = sides.values().chain(&interfaces).any(|of| of.get("contact").is_some());

        let whole = |value: &toml::Value| value.as_integer().expect("a number of cells");
        let model = match table.get("grid") {
            None => "bem",
            Some(grid) if grid["fine"].as_array().expect("two numbers").iter().all(|n| whole(n) == 1) => "fem",
            Some(_) => "msfem",
        };
        let around = if model != "bem" && table.contains_key("exterior") { "-bem" } else { "" };
        assert_eq!(found.model, format!("{model}{around}"), "{name}");
        assert_eq!(left_out.get("grid in the body"), (model == "bem").then_some(&"none"), "{name}");
        let random = table.contains_key("random");
        assert_eq!(left_out.get("random input"), (!random).then_some(&"one solve"), "{name}");
        assert_eq!(modelled.contains_key("random input"), random, "{name}");
        assert_eq!(modelled.contains_key("contact solver"), touches, "{name}");
        assert_eq!(left_out.get("contact"), (!touches).then_some(&"no contact solver"), "{name}");
        let heavy = table.contains_key("body_force");
        assert_eq!(modelled.contains_key("body force"), heavy, "{name}");
        assert_eq!(left_out.contains_key("body force"), !heavy, "{name}");
        assert!(modelled.keys().all(|what| !left_out.contains_key(what)), "{name}: modelled and left out at once");
        // a displacement that decays in an unbounded medium has no rigid motion
        let decaying =
            |exterior: &toml::Value| exterior.get("at_infinity").is_none_or(|how| how.as_str() != Some("bounded"));
        // without a grid a body with holes is one of two bodies, and the tie to the medium holds it
        let separate = table.contains_key("material") && table["body"].get("holes").is_some() && model == "bem";
        let unbounded = table.get("exterior").is_some_and(decaying) && !separate;
        assert_eq!(modelled["supports"] == "none is needed", unbounded, "{name}");
        let holds = |side: &toml::Value| side.get("displacement").is_some();
        // with several bodies the sides of each are a table
        let of_body = |sides: &toml::Value| sides.as_table().is_some_and(|sides| sides.values().any(holds));
        let held = unbounded || sides.values().any(|side| holds(side) || of_body(side));
        assert!(held || modelled["supports"].contains("free"), "{name}: {}", modelled["supports"]);
    }
}

#[test]
fn active_set_and_newton_agree() {
    let mut compared = 0;
    for path in gallery() {
        let with = |solver: &str| {
            let scene = read(&path, &[&format!("method.solver=\"{solver}\""), "method.refine=\"none\""]);
            // of random input the mean
            Scene { random: None, expect: Vec::new(), ..scene }
        };
        let scene = with("active-set");
        if scene.contacts().next().is_none() {
            continue;
        }
        let active = solved(&scene).0;
        let Some(audit) = &active.audit else { continue };
        let newton = solved(&with("newton")).0;
        compared += 1;
        let difference = (newton.energy - active.energy).abs() / newton.energy.abs();
        let (n, a) = (newton.iterations, active.iterations);
        println!("{:24} {difference:.1e}, audit {:.1e}, steps {n} and {a}", name(&path), worst(audit));
        assert!(active.converged && worst(audit) <= EXACT && difference <= 1e-9, "{}: {difference:e}", name(&path));
    }
    assert!(compared >= 10, "only {compared} scenes with contact");
}

/// A turned scene has the same mesh, and so the same numbers but for rounding.
#[test]
fn turned_scenes_give_the_same_numbers() {
    for (straight, turned) in [("08", "09"), ("17", "18")] {
        let [a, b] = [straight, turned].map(|n| solved(&read(&numbered(n), &["method.refine=\"none\""])).0);
        for path in ["energy", "strain_energy", "friction_work", "contact.length", "contact.max_pressure"] {
            let (a, b) = (a.at(path).expect(path), b.at(path).expect(path));
            assert!((a - b).abs() <= 1e-10 * a.abs(), "{turned} {path}: {b} instead of {a}");
        }
    }
}

/// Half of a symmetric problem has half of its energy, up to the discretisation error: the axis is meshed too.
#[test]
fn half_a_block_has_half_the_energy() {
    let [whole, half] = ["15", "16"].map(|n| solved(&read(&numbered(n), &["method.tolerance=1e-6"])).0);
    for (path, tolerance) in [
        ("energy", 1e-10),
        ("strain_energy", 1e-9),
        ("friction_work", 1e-7),
        ("contact.length", 1e-5),
        ("contact.force.y", 1e-10),
    ] {
        let (whole, half) = (whole.at(path).expect(path), half.at(path).expect(path));
        println!("{path}: {whole:.12e} and twice {half:.12e}");
        assert!((whole - 2.0 * half).abs() <= tolerance * whole.abs(), "{path}: {whole} and twice {half}");
    }
}

/// Scene 06 with n edges for the circle: the displacement at a corner on the circle is wrong by O(n⁻²), and so is the work.
#[test]
fn polygonal_hole_converges_to_the_circle() {
    let text = std::fs::read_to_string(numbered("06")).expect("the scene");
    let error = |n: usize| {
        let mut table: toml::Table = text.parse().expect("TOML");
        let corner = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / n as f64;
            vec![angle.cos(), angle.sin()]
        };
        let mut hole = toml::Table::new();
        hole.insert("corners".into(), (0..n).map(corner).collect::<Vec<_>>().into());
        hole.insert("sides".into(), vec!["hole"; n].into());
        table["body"].as_table_mut().expect("a table").insert("holes".into(), vec![hole].into());
        table["method"].as_table_mut().expect("a table").insert("elements".into(), (2 * n as i64).into());
        let scene =
            steklov_document::parse(&table.to_string(), "hole.toml", &[]).unwrap_or_else(|e| panic!("{}", e.render()));
        let (summary, _) = solved(&scene);
        let error = |path: &str, exact: f64| (summary.at(path).expect(path) / exact - 1.0).abs();
        // exact, with p = 10, μ = 400, radius 1: u_r = p/(2μ), work p u_r over the circle
        let (u, work) = (0.0125, std::f64::consts::FRAC_PI_4);
        [error("probe.1.displacement.y", u), error("load_work", work)]
    };
    let (coarse, fine) = (error(16), error(64));
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        let rate = (coarse / fine).ln() / 4f64.ln();
        println!("{coarse:.2e} -> {fine:.2e}: rate {rate:.2}");
        assert!((1.85..2.1).contains(&rate) && fine < 2.5e-3, "{coarse:e} -> {fine:e}: rate {rate}");
    }
}
