//! Error bars of numbers in media whose displacement is bounded at infinity.

use steklov_model::quantities::Quantity;
use steklov_tests::{parse, summary as solved};

const HOLE: &str = "[body]\ncorners = [[-1, -0.8], [1, -0.8], [1, 0.8], [-1, 0.8]]\n\
                    sides = [\"floor\", \"right\", \"roof\", \"left\"]\n\
                    [probe]\npoints = [[1.7, 0.2], [-0.4, 2.3], [1, -0.3]]\n";

/// A hole that is held, one that touches what it is pressed on, one that nothing holds, and a body with jumps in the medium; points in it, at
/// the hole and in the body.
#[test]
fn numbers_of_bounded_media_are_inside_their_bars() {
    let scenes = [
        "[exterior]\nyoung = 30\npoisson = 0.3\nremote_stress = [0.5, -1, 0.3]\n[sides]\nroof.traction = [0.5, \"x\"]\n\
         floor.displacement = [\"0.02*x\", -0.01]\n[quantities]\nmean = { mean_displacement = \"roof\" }\n\
         m = { moment = \"floor\", about = [0, 0] }\n",
        "[exterior]\nyoung = 30\npoisson = 0.2\nremote_stress = [-0.5, -1.5, 0]\n\
         [sides]\nfloor.contact.gap = \"0.03*x^2 - 0.02\"\nroof.displacement = [0, 0]\n",
        "[exterior]\nyoung = 8\npoisson = 0.1\nat_infinity = \"bounded\"\n[sides]\nfloor.traction = [0, \"-x\"]\n\
         roof.traction = [0, \"x\"]\n[quantities]\nmean = { mean_displacement = \"roof\" }\n",
        "[material]\nyoung = 4\npoisson = 0.4\n[exterior]\nyoung = 8\npoisson = 0.1\nat_infinity = \"bounded\"\n\
         displacement_jump = [\"0.05*x^2\", \"0.05*sin(x + y)\"]\n",
    ];
    let (mut of_points, mut half, mut count) = (0, 0, 0);
    for scene in scenes {
        let at = |tolerance: &str| {
            let text = format!("{HOLE}{scene}[method]\ntolerance = {tolerance}\n");
            solved(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}\n{text}", e.render())))
        };
        let known = at("2e-4");
        for tolerance in ["1e-1", "1e-2", "1e-3"] {
            let own = at(tolerance);
            for (path, Quantity { value, uncertainty, doubts, .. }) in &own.quantities {
                let Some(exact) = known.quantities.get(path) else { continue };
                let error = (value - exact.value).abs();
                if error < 20.0 * exact.uncertainty {
                    continue;
                }
                println!("{tolerance} {path}: {value} ± {uncertainty:.1e}, off by {error:.1e} {doubts:?}");
                assert!(error <= 5.0 * uncertainty, "{path} at {tolerance}: {error:e} and {uncertainty:e}\n{scene}");
                of_points += usize::from(path.contains("displacement"));
                (count, half) = (count + 1, half + usize::from(error <= 2.0 * uncertainty));
            }
        }
    }
    println!("{half} of {count}, {of_points} displacements");
    assert!(of_points >= 50 && 100 * half >= 95 * count, "{half} of {count}, {of_points} displacements");
}

/// A jump of x² on linear elements moves the medium by the mean of what these miss of it, as ∮u = 0 of the body. u₊ has that: its bubbles have a mean.
#[test]
fn a_body_that_nothing_holds_keeps_its_mean_with_bubbles() {
    let at = |method: &str| {
        let text = format!(
            "{HOLE}[material]\nyoung = 1\npoisson = 0.2\n[exterior]\nyoung = 60\npoisson = 0.4\nat_infinity = \"bounded\"\n\
             displacement_jump = [\"0.05*x^2\", \"0.03*x*y\"]\n[quantities]\nmean = {{ mean_displacement = \"right\" }}\n\
             [method]\n{method}"
        );
        solved(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}\n{text}", e.render()))).quantities
    };
    let (own, known) = (at("refine = \"none\"\n"), at("tolerance = 1e-4\n"));
    for path in ["probe.0.displacement.x", "probe.1.displacement.x", "mean_displacement.mean.x"] {
        let Quantity { value, uncertainty, .. } = &own[path];
        let error = (value - known[path].value).abs();
        println!("{path}: {value} ± {uncertainty:.1e}, off by {error:.1e}");
        assert!(error <= 1.5 * uncertainty && *uncertainty <= 4.0 * error, "{path}: {error:e} and {uncertainty:e}");
    }
}

/// ∮u = 0 of a body that nothing holds, on linear elements along a curve as well.
#[test]
fn the_mean_over_the_boundary_of_a_body_that_nothing_holds_is_zero() {
    for method in ["refine = \"none\"\n", "tolerance = 1e-2\n"] {
        let text = format!(
            "body = {{ ellipse = {{ centre = [0.2, -0.1], radii = [1, 0.6], angle = 20 }}, side = \"w\" }}\n\
             material = {{ young = 1, poisson = 0.2 }}\nexterior = {{ young = 3, poisson = 0.4, at_infinity = \"bounded\", \
             displacement_jump = [\"0.05*x^3\", \"0.03*exp(x)\"] }}\nquantities.m = {{ mean_displacement = \"w\" }}\n\
             [method]\n{method}"
        );
        let quantities = solved(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}\n{text}", e.render()))).quantities;
        for path in ["mean_displacement.m.x", "mean_displacement.m.y"] {
            let Quantity { value, uncertainty, .. } = quantities[path];
            println!("{method}{path}: {value:e} ± {uncertainty:.1e}");
            assert!(value.abs() <= 1e-12 && uncertainty <= 1e-10, "{path}: {value:e} ± {uncertainty:e}");
        }
    }
}
