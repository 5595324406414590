//! Coulomb friction from the scene to the numbers: closed forms, published values, limits, refusals, the estimate.

use std::path::Path;

use steklov_bem_operators::{Mark, Subdivision};
use steklov_contact::{Problem, Solution, TipKind, fixed_point, interior_point, kkt, newton};
use steklov_model::run::adaptive_loop::Run;
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_problem::Scene;
use steklov_study::reference::true_error;
use steklov_tests::{adapt, summary};

fn scene(name: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenes/{name}.toml"));
    steklov_document::read(&path, &overrides).unwrap_or_else(|e| panic!("{name}: {}", e.render()))
}

fn run(scene: &Scene) -> Run<BoundaryElements> {
    adapt(scene).unwrap_or_else(|e| panic!("{}: {e}", scene.title))
}

/// The condensed problem of a scene's first mesh, and its solution.
fn condensed(scene: &Scene) -> (Problem, Solution) {
    let mesh = steklov_model::mesh::first_mesh::first_mesh(scene);
    let solved =
        steklov_model::solve::one_mesh::solve(scene, (mesh, None), false, &mut Default::default(), &mut |_| Ok(()));
    let (solved, _, factors) = solved.unwrap_or_else(|e| panic!("{}: {e}", scene.title));
    (factors.contact.expect("contact").problem, solved.contact.expect("contact").solution)
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |m, v| m.max(v.abs()))
}

fn off(a: &[f64], b: &[f64]) -> f64 {
    largest(a.iter().zip(b).map(|(a, b)| a - b)) / largest(b.iter().copied())
}

/// SSNV128: x in mm and u_x in 1e-5 m, published to 5 %.
#[test]
fn the_pressed_plate_moves_as_published_and_digits_agree() {
    let published = [2.86, 2.72, 2.28, 1.98, 1.50];
    let strategies = [
        &["method.tolerance=1e-6"][..],
        &["method.tolerance=1e-6", "method.elements=27", "method.degree=2"],
        &["method.tolerance=3e-5", "method.refine=\"hp-decay\""],
    ];
    let mut energies = Vec::new();
    let found: Vec<Vec<f64>> = strategies
        .iter()
        .map(|overrides| {
            let summary = summary(&scene("26-ssnv128", overrides));
            assert!(summary.converged, "{summary:?}");
            energies.push((summary.energy_extrapolated.expect("J"), summary.energy_uncertainty.expect("J")));
            let contraction = summary.contact.expect("contact").contraction.expect("Coulomb friction");
            assert!((0.3..0.45).contains(&contraction), "{contraction}");
            summary.probe.iter().map(|p| p.displacement[0] * 100.0).collect()
        })
        .collect();
    // J is not stationary under Coulomb's law: its uncertainty must tell
    for (energy, uncertainty) in &energies[1..] {
        let (difference, allowed) = ((energy - energies[0].0).abs(), uncertainty + energies[0].1);
        println!("J differs by {difference:.1e} of {allowed:.1e}");
        assert!(difference < allowed && allowed < 1e-4, "{difference:e} {allowed:e}");
    }
    for (k, published) in published.into_iter().enumerate() {
        println!("{published} {:.6} {:.6} {:.6}", found[0][k], found[1][k], found[2][k]);
        assert!((found[0][k] / published - 1.0).abs() < 0.05, "{} {published}", found[0][k]);
        assert!((found[0][k] - found[1][k]).abs() < 3e-6 * published, "{} {}", found[0][k], found[1][k]);
        assert!((found[0][k] - found[2][k]).abs() < 1e-5 * published, "{} {}", found[0][k], found[2][k]);
    }
}

/// c/a between the located ends of stick and of contact, for a/size of 1/10, 1/25 and 1/50.
#[test]
fn cattaneo_and_mindlin_give_the_stick_zone_of_a_small_contact() {
    let exact = 0.5f64.sqrt();
    let mut errors = Vec::new();
    for a in ["0.1", "0.04", "0.02"] {
        let scene = scene("27-cattaneo-mindlin", &[&format!("parameters.a={a}"), "material.poisson=0.4999999"]);
        let run = run(&scene);
        let width = |kind: TipKind| {
            let places: Vec<f64> = run.step().layout.located.iter().filter(|l| l.kind == kind).map(|l| l.s).collect();
            assert_eq!(places.len(), 2, "{:?}", run.step().layout.located);
            2.0 * (places[1] - places[0]).abs()
        };
        let (contact, stick) = (width(TipKind::ContactEnd), width(TipKind::StickEnd));
        println!("a = {a}: contact {contact:.6}, c/a = {:.6} of {exact:.6}", stick / contact);
        errors.push((stick / contact / exact - 1.0).abs());
    }
    assert!(errors[2] < 2e-4 && errors.iter().all(|e| *e < 5e-4), "{errors:?}");
}

/// The body's size counts with (a/size)²: a quarter of it in a body of twice the size.
#[test]
fn the_nafems_cylinder_reaches_hertz_as_the_body_grows() {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/28-nafems-cylinder.toml"));
    let text = text.expect("the scene");
    let errors: Vec<[f64; 2]> = [25.0, 50.0, 100.0]
        .into_iter()
        .map(|size: f64| {
            let corners = format!("[[0, 0], [{size}, 0], [{size}, {size}], [0, {size}]]");
            let text = text.replace("[[0, 0], [100, 0], [100, 100], [0, 100]]", &corners);
            let scene = steklov_document::parse(&text, "cylinder.toml", &["method.tolerance=1e-5".into()]);
            let contact = summary(&scene.unwrap_or_else(|e| panic!("{}", e.render()))).contact.expect("contact");
            let errors = [contact.length / 6.21463 - 1.0, contact.max_pressure / 3585.36 - 1.0];
            println!("size {size}: a off by {:.2e}, p0 by {:.2e}", errors[0], errors[1]);
            errors.map(f64::abs)
        })
        .collect();
    assert!(errors[2].iter().all(|e| *e < 1e-3) && errors[0][0] > 2.0 * errors[2][0], "{errors:?}");
}

/// The wedge of the thesis with μ = 0.3: the fixed point is down at 5e-10 after ten Tresca problems, and agrees with Newton's
/// method; the Tresca problem of the solution gives it back.
#[test]
fn the_wedge_contracts() {
    for (elements, degree) in [(64, 2), (32, 4)] {
        let overrides = [format!("method.elements={elements}"), format!("method.degree={degree}")];
        let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
        let (problem, answer) = condensed(&scene("25-coulomb-wedge", &overrides));
        let fixed = fixed_point(&problem, None).expect("held");
        println!("{:?}", fixed.history);
        assert!(fixed.converged() && fixed.history.iter().take(10).any(|c| *c < 5e-10), "{:?}", fixed.history);
        let newton = newton(&problem, None).expect("held");
        let tresca = interior_point(&problem.tresca(&answer.multipliers)).expect("held");
        for other in [&fixed, &newton, &tresca] {
            assert!(other.converged() && kkt(&problem, other).worst() < 1e-10, "{:?}", kkt(&problem, other));
            assert!(off(&other.displacement, &answer.displacement) < 1e-9);
        }
        let work = [&answer, &tresca].map(|s| problem.friction_work(&s.displacement, &s.multipliers));
        assert!((work[0] - work[1]).abs() < 1e-9 * work[0], "{work:?}");
    }
}

#[test]
fn no_coefficient_is_no_friction() {
    let text = "[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"floor\", \"right\", \"top\", \"left\"]\n\
                [material]\nyoung = 10.0\npoisson = 0.3\n[sides.top]\ndisplacement = [\"0.01\", \"-0.02*x\"]\n\
                [method]\nrefine = \"none\"\ndegree = 3\n[sides.floor]\n";
    let solve = |contact: &str| {
        let scene = steklov_document::parse(&format!("{text}contact = {contact}\n"), "test.toml", &[]);
        run(&scene.unwrap_or_else(|e| panic!("{}", e.render()))).last.displacement
    };
    let [smooth, none, some] = ["", ", friction = { coulomb = \"0\" }", ", friction = { coulomb = \"0.1\" }"]
        .map(|friction| solve(&format!("{{ gap = \"(x-1)^2/40\"{friction} }}")));
    assert!(off(&none, &smooth) < 1e-12 && off(&some, &smooth) > 1e-4);
}

/// The block of 2 by 1 is pressed by 2 and pulled by q: friction holds it up to q = 2 μ.
#[test]
fn a_pull_beyond_the_coefficient_is_refused() {
    let pulled = |q: f64| {
        let text = format!(
            "[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"floor\", \"right\", \"top\", \"left\"]\n\
             [material]\nyoung = 10.0\npoisson = 0.3\n[sides.floor]\ncontact = {{ gap = \"0\", friction = {{ coulomb = \"0.3\" }} }}\n\
             [sides.top]\ntraction = [\"{q}/2\", \"-1\"]\n[method]\nrefine = \"none\"\nelements = 24\n"
        );
        adapt(&steklov_document::parse(&text, "test.toml", &[]).unwrap_or_else(|e| panic!("{}", e.render())))
    };
    for q in [0.0, 0.3, -0.55, 0.59] {
        let run = pulled(q).unwrap_or_else(|e| panic!("{q}: {e}"));
        let contact = run.last.contact.as_ref().expect("contact");
        assert!(contact.solution.converged() && contact.audit.worst() < 1e-10, "{q}: {:?}", contact.audit);
        let force = run.last.reactions[0].1;
        assert!((force[0] + q).abs() < 1e-9 && (force[1] - 2.0).abs() < 1e-9, "{force:?}");
    }
    let error = pulled(0.61).map(|_| ()).expect_err("it slides").to_string();
    assert!(error.contains("coefficient"), "{error}");
}

/// The estimate beside the true error, from the third step on.
#[test]
fn the_estimate_is_near_the_true_error() {
    for name in ["25-coulomb-wedge", "26-ssnv128"] {
        let fine = run(&scene(name, &["method.tolerance=1e-5"]));
        let finest = &fine.step().layout.mesh;
        let fine = Subdivision::new(finest, &vec![Mark::Keep; finest.len()]);
        let mut trusted = 0;
        for tolerance in ["2e-2", "5e-3", "1e-3", "3e-4"] {
            let scene = scene(name, &[&format!("method.tolerance={tolerance}")]);
            let run = run(&scene);
            let truth = true_error(&scene, &run.last.mesh, &run.last.displacement, &fine).expect("solved");
            let estimate = run.step().estimate();
            let ratio = estimate.error / truth.error;
            println!(
                "{name} {:4} dofs: {:.2e} of {:.2e}: {ratio:.2} {:?}",
                run.step().dofs,
                estimate.error,
                truth.error,
                estimate.doubts
            );
            assert!((0.6..1.7).contains(&ratio) || !estimate.doubts.is_empty(), "{name}: {ratio}");
            trusted += usize::from(estimate.doubts.is_empty());
        }
        assert!(trusted >= 3, "{name}: {trusted} of 4 estimates are without a doubt");
    }
}
