//! The residual indicator on every scene of the gallery, and the estimate where nothing but tractions can be wrong.

use steklov_problem::{Indicator, Refine, Scene};
use steklov_tests::{adapt, gallery, parse};

/// Scenes with a solution that their elements have.
const EXACT: [&str; 10] = ["01-", "02-", "03-", "04-", "05-", "08-", "09-", "10-", "11-", "13-"];
/// Scenes with a single mesh: the first one has nearly as many unknowns as are allowed here, or all but the quadratic multiplier.
const SINGLE: [&str; 3] = ["06-", "07-", "14-"];

/// The wedge once more, turned or by points: it is cut and refined alike.
const SAME: [&str; 2] = ["18-", "75-"];

/// A scene whose first mesh has more than a quarter of the unknowns that are allowed for the others.
const LARGE: &str = "74-";

/// Kinks beside element ends, oblique edges, elements of 1e-6: all terms are finite, and what steers the refinement goes down.
/// Where the solution is in the space of the first mesh nothing but rounding is left.
#[test]
fn the_residual_indicator_steers_every_scene() {
    for (name, mut scene) in gallery() {
        // a body in a medium has none, nor have several bodies, as the command says
        if scene.is_inclusion() || scene.problem.has_several_bodies() || SAME.iter().any(|same| name.starts_with(same))
        {
            continue;
        }
        // of random input the mean
        scene = Scene { random: None, ..scene };
        let [exact, single] = [&EXACT[..], &SINGLE].map(|scenes| scenes.iter().any(|number| name.starts_with(number)));
        (scene.method.indicator, scene.method.refine) = (Indicator::Residual, Refine::Hp);
        (scene.method.tolerance, scene.method.max_dofs) =
            (Some(1e-5), Some(if name.starts_with(LARGE) { 800 } else { 400 }));
        let run = adapt(&scene).unwrap_or_else(|e| panic!("{name}: {e}"));
        let totals: Vec<f64> =
            run.progress.steps.iter().map(|s| s.estimate().residuals.iter().map(|r| r.total()).sum()).collect();
        let (first, last) = (totals[0], totals[totals.len() - 1]);
        let strain = run.last.energies.strain;
        println!(
            "{name:24} {:2} steps {:4} dofs: {first:.1e} to {last:.1e} of {strain:.1e}",
            totals.len(),
            run.step().dofs
        );
        assert!(totals.iter().all(|t| t.is_finite()), "{name}: {totals:?}");
        if exact {
            assert!(first <= 1e-14 * strain, "{name}: {first:e} of {strain:e}");
        } else {
            assert!(first > 1e-8 * strain, "{name}: {first:e} of {strain:e}");
            assert!(if single { totals.len() == 1 } else { last < 0.1 * first }, "{name}: {totals:?}");
        }
    }
}

/// The displacement is known on all of the boundary: no correction of it is left, the traction has all of the error. J is the
/// energy of the traction; the exact one is that of another program, by finite elements of degrees up to 12 on meshes that are
/// geometric towards the sides. Estimates in doubt are judged like the others.
#[test]
fn held_everywhere_the_error_is_that_of_the_traction() {
    let text = r#"
        [body]
        corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
        sides = ["floor", "right", "top", "left"]
        [material]
        young = 1.0
        poisson = 0.3
        [sides.floor]
        displacement = ["0", "0"]
        [sides.right]
        displacement = ["0", "y*(1-y)"]
        [sides.top]
        displacement = ["0", "0"]
        [sides.left]
        displacement = ["0", "0"]
        [method]
        tolerance = 1e-6
        cuts = "none"                        # J errs by the difference of both errors: on cuts displacements err too
    "#;
    let scene = parse(text, &[]).unwrap_or_else(|e| panic!("{}", e.render()));
    let run = adapt(&scene).expect("it is solved");
    let exact = 0.034_571_078_430_4;
    let mut judged = 0;
    for (k, step) in run.progress.steps.iter().enumerate() {
        let (error, estimate) = (((exact - step.energy) / exact).abs().sqrt(), step.estimate());
        let effectivity = estimate.relative / error;
        println!("{:4} dofs: true {error:.2e}, estimate over it {effectivity:.2} {:?}", step.dofs, estimate.doubts);
        if error > 1e-5 {
            judged += 1;
            let range = if k == 0 { 0.5..2.0 } else { 0.8..1.25 };
            assert!(range.contains(&effectivity), "{effectivity} at {} unknowns", step.dofs);
        }
    }
    assert!(judged >= 7 && run.step().estimate().relative <= 1e-6, "{judged} steps judged");
    assert!((run.last.energies.total / exact - 1.0).abs() < 1e-10, "{} of {exact}", run.last.energies.total);
}
