//! The residual indicator on every scene of the gallery, and the estimate where nothing but tractions can be wrong.

use steklov::scene::{Indicator, Refine};
use steklov_tests::{adapt, gallery, parse};

/// Kinks beside element ends, oblique edges, elements of 1e-6: all terms are finite, and what steers the refinement goes down.
#[test]
fn the_residual_indicator_steers_every_scene() {
    for (name, mut scene) in gallery() {
        (scene.method.indicator, scene.method.refine) = (Indicator::Residual, Refine::Hp);
        (scene.method.tolerance, scene.method.max_dofs) = (1e-5, 400);
        let run = adapt(&scene).unwrap_or_else(|e| panic!("{name}: {e}"));
        let totals: Vec<f64> =
            run.progress.steps.iter().map(|s| s.estimate().residuals.iter().map(|r| r.total()).sum()).collect();
        let (first, last) = (totals[0], totals[totals.len() - 1]);
        println!("{name:24} {:2} steps {:4} dofs: {first:.1e} to {last:.1e}", totals.len(), run.step().dofs);
        assert!(totals.iter().all(|t| t.is_finite()), "{name}: {totals:?}");
        let exact = run.step().estimate().relative < 1e-7;
        assert!(exact || totals.len() == 1 || last < 0.1 * first, "{name}: {totals:?}");
    }
}

/// The displacement is known on all of the boundary: no correction of it is left, the traction has all of the error. J is the
/// energy of the traction, so that its own error is known from a finer mesh.
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
    "#;
    let scene = parse(text, &[]).unwrap_or_else(|e| panic!("{}", e.render()));
    let fine = adapt(&scene).expect("it is solved");
    let exact = fine.last.energies.total;
    for step in &fine.progress.steps {
        let (error, estimate) = (((exact - step.energy) / exact).abs().sqrt(), step.estimate());
        println!("{:4} dofs: true {error:.2e}, estimate {:.2e} {:?}", step.dofs, estimate.relative, estimate.doubts);
        if estimate.doubts.is_empty() && error > 1e-5 {
            let effectivity = estimate.relative / error;
            let first = step.dofs == fine.progress.steps[0].dofs;
            let range = if first { 0.5..2.0 } else { 0.8..1.25 };
            assert!(range.contains(&effectivity), "{effectivity} at {} unknowns", step.dofs);
        }
    }
    assert!(fine.step().estimate().relative <= 1e-6);
}
