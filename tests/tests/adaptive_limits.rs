//! Adaptive runs at their limits: loads finer than the mesh, thin bodies, numbers at the ends of their range, steps that
//! fail.

use std::sync::atomic::AtomicUsize;

use steklov_bem_operators::{Mesh, PairCache};
use steklov_model::doubt::Doubt;
use steklov_model::error::SolveError;
use steklov_model::run::adaptive_loop::{Event, Progress, Reason, Step, run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::solve::one_mesh::solve;
use steklov_model::stage::Stage;
use steklov_problem::Scene;
use steklov_study::reference::true_error;
use steklov_tests::{Case, On, View, adapt, finer, parse, scene, solved_in_steps};

fn on_floor(top: On) -> Case {
    Case::square(0.3).on("floor", On::held("0", "0")).on("top", top)
}

fn strip(thickness: &str) -> Case {
    let t: f64 = thickness.parse().unwrap();
    let case = Case::new(&[[0.0, 0.0], [1.0, 0.0], [1.0, t], [0.0, t]], &["floor", "right", "top", "left"], 0.3);
    case.on("floor", On::held("0", "0")).on("top", On::pressure("x"))
}

fn parsed(case: &Case, overrides: &[&str]) -> Scene {
    parse(&case.toml(&View::PLAIN), overrides).unwrap_or_else(|e| panic!("{}", e.render()))
}

/// Estimate over true error of each step, and whether it is in doubt for a reason.
fn effectivities(scene: &Scene, dofs: usize, doubt: Doubt) -> Vec<(f64, bool)> {
    let (run, displacements) = solved_in_steps(scene).unwrap();
    assert_eq!(run.reason, Reason::Tolerance);
    let fine = finer(scene, dofs).unwrap();
    let judged = |(step, displacement): (&Step<BoundaryElements>, &Vec<f64>)| {
        let truth = true_error(scene, &step.layout.mesh, displacement, &fine).unwrap();
        let estimate = step.estimate();
        let found = (estimate.error / truth.error, estimate.doubts.contains(&doubt));
        println!(
            "{:4} dofs, error {:.2e}, estimate over it {:.2} {}",
            step.dofs,
            truth.error / truth.norm,
            found.0,
            found.1
        );
        found
    };
    run.progress.steps.iter().zip(&displacements).map(judged).collect()
}

/// h/(p+2) ‖t - Π_(p+1) t‖² of x³ is that of its part (2/5) a³ P_3 on an element of half length a, and 0 from degree 2 on.
#[test]
fn what_degrees_do_not_follow_of_a_cubic_load() {
    for (degree, pressed) in [(1, false), (2, false), (1, true), (2, true)] {
        let top = if pressed { On::pressure("x^3") } else { On::traction("3*x^3", "-4*x^3") };
        let scene = parsed(&on_floor(top), &[]);
        let mesh = Mesh::uniform(&scene.problem.outline, 12, degree);
        let (solved, _, factors) =
            solve(&scene, (mesh, None), true, &mut PairCache::default(), &mut |_| Ok(())).unwrap();
        let h = 1.0 / 3.0_f64;
        let cubic = h / 3.0 * (h / 7.0) * (0.4 * (h / 2.0).powi(3)).powi(2) * if pressed { 1.0 } else { 25.0 };
        for e in 0..solved.mesh.len() {
            let top = solved.mesh.side_names[solved.mesh.side[e]] == "top";
            let want = if top && degree == 1 { cubic } else { 0.0 };
            let found = factors.unresolved[e];
            assert!((found - want).abs() < 1e-9 * cubic, "degree {degree}, element {e}: {found} {want}");
        }
    }
}

/// Loads that change within an element: no estimate far below the error goes without a doubt, and the tolerance is
/// reached in the end without one.
#[test]
fn loads_finer_than_the_elements_are_in_doubt() {
    let pole = "-1/((x - 0.0629)^2 + 1e-8)";
    let waves = "-abs(sin(50*x))";
    for (load, refine, tolerance) in [(pole, "hp", "0.05"), (waves, "h", "0.017"), (waves, "hp-decay", "0.017")] {
        println!("{load} with {refine}");
        // meshes of hp have vertices about the pole from the first one on
        let shown = refine == "hp";
        let refine = format!("method.refine=\"{refine}\"");
        let tolerance = format!("method.tolerance={tolerance}");
        let scene = parsed(&on_floor(On::traction("0", load)), &[&refine, &tolerance]);
        let found = effectivities(&scene, 900, Doubt::Data);
        assert!(found[0].1 || shown, "the first mesh does not follow the load");
        assert!(found.iter().all(|&(e, doubted)| doubted || (0.75..1.5).contains(&e)), "{found:?}");
        assert!(!found[found.len() - 1].1, "the last mesh does");
    }
}

/// Linear elements, which tractions of degree 1 do not see all of: the estimate is the error where it is smooth and where corners
/// are singular.
#[test]
fn linear_elements_tell_their_error() {
    let square = on_floor(On::traction("x*(1-x)", "-1-x^2"));
    let corners = [[0.4, 0.0], [0.6, 0.0], [0.6, 0.8], [1.0, 0.8], [1.0, 1.0], [0.0, 1.0], [0.0, 0.8], [0.4, 0.8]];
    let tee = Case::new(&corners, &["floor", "a", "b", "c", "top", "d", "e", "f"], 0.3);
    let tee = tee.on("floor", On::held("0", "0")).on("top", On::traction("0.3", "-1-x^2"));
    for (case, tolerance) in [(square, "0.03"), (tee, "0.08")] {
        for refine in ["h", "uniform-h"] {
            println!("{refine} to {tolerance}");
            let (refine, tolerance) = (format!("method.refine=\"{refine}\""), format!("method.tolerance={tolerance}"));
            let found = effectivities(&parsed(&case, &[&refine, &tolerance]), 1500, Doubt::Coarse);
            assert!(found.iter().all(|&(e, doubted)| doubted || (0.9..1.3).contains(&e)), "{found:?}");
            assert!((0.9..1.3).contains(&found[found.len() - 1].0), "{found:?}");
        }
    }
}

/// A held strip under a load that rises along it: while its elements are long beside its thickness the bubbles miss most of
/// the error, and say so.
#[test]
fn elements_longer_than_the_body_is_thick_are_in_doubt() {
    for thickness in ["1e-2", "1e-4", "1e-6"] {
        println!("thickness {thickness}");
        let scene = parsed(&strip(thickness), &["method.tolerance=1e-4"]);
        let found = effectivities(&scene, 900, Doubt::Coarse);
        assert!(found[0].1 && found.iter().all(|&(e, doubted)| doubted || (0.7..2.5).contains(&e)), "{found:?}");
        // in doubt or not, in the end it is right
        assert!((0.7..2.5).contains(&found[found.len() - 1].0), "{found:?}");
    }
    // a bar no thinner than its elements are long is not in doubt for that
    let scene = parsed(&strip("0.5"), &["method.elements=24", "method.tolerance=1e-3"]);
    let found = effectivities(&scene, 600, Doubt::Coarse);
    assert!(found.iter().skip(3).all(|f| !f.1), "{found:?}");
}

/// The estimate scales with the loads and the moduli to the last bit.
#[test]
fn estimates_scale_to_the_ends_of_the_range() {
    let at = |load: f64, modulus: f64| {
        let overrides = [format!("material.young={:e}", 1000.0 * modulus), "method.max_dofs=200".into()];
        let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
        let case = on_floor(On::traction(&format!("x*{load:e}"), &format!("-{load:e}*(1 + x^2)")));
        let run = adapt(&parsed(&case, &overrides)).unwrap();
        let estimate = run.step().estimate();
        (run.progress.steps.len(), run.step().dofs, estimate.relative, estimate.error, estimate.correction)
    };
    let (steps, dofs, relative, error, correction) = at(1.0, 1.0);
    assert!(steps > 3 && relative > 0.0);
    let two = 2.0_f64;
    for (load, modulus) in
        [(300, 0), (-300, 0), (0, 300), (0, -300), (300, 300), (-300, -300), (-300, 300), (300, -300)]
    {
        // the energy goes with load²/modulus
        let energy = two.powi(2 * load - modulus);
        let want = (steps, dofs, relative, error * energy.sqrt(), correction * energy);
        assert_eq!(at(two.powi(load), two.powi(modulus)), want, "2^{load}, 2^{modulus}");
    }
}

/// A step that fails leaves those before it, as if they had been all that was asked for; the first step's error is the
/// run's, and so is one of the disk.
#[test]
fn a_step_that_fails_keeps_those_before_it() {
    let scene_of = |overrides: &[&str]| scene("block-on-floor", overrides);
    let failing = |at: usize, error: fn() -> SolveError| {
        let scene = scene_of(&[]);
        run(&scene, Progress::first(&scene), &AtomicUsize::new(0), &mut |number, event| match event {
            Event::Stage(Stage::Steklov(_, _)) if number == at => Err(error()),
            _ => Ok(()),
        })
    };
    let broken = || SolveError::NotFinite { energy: f64::NAN };
    let kept = failing(3, broken).unwrap();
    let asked = adapt(&scene_of(&["method.max_steps=3"])).unwrap();
    assert!(kept.reason == Reason::Failed && !kept.converged() && asked.reason == Reason::MaxSteps);
    assert!(matches!(kept.error, Some(SolveError::NotFinite { .. })) && asked.error.is_none());
    assert_eq!(kept.last.displacement, asked.last.displacement);
    assert_eq!(kept.progress.next, asked.progress.next);
    assert_eq!(kept.progress.steps.len(), 3);
    assert!(matches!(failing(0, broken), Err(SolveError::NotFinite { .. })));
    let disk = || steklov_result::store::observed(steklov_io::IoError::Exists { path: "full".into() });
    assert!(matches!(failing(3, disk), Err(SolveError::Observer(_))));
}
