//! Where finite and multiscale finite elements fail: the result says so, by its estimate, a doubt or an error.

use steklov_model::run::adaptive_loop::{Reason, Run};
use steklov_model::summary::Summary;
use steklov_problem::Scene;
use steklov_tests::{adapt, attempt_grid, on_grid, parse, scene};

/// Inclusions of scene 36, moved by `shift`, of the contrast 10^k.
fn inclusions(shift: f64, k: i32, model: &str, basis: &str) -> Scene {
    let young = format!("material.cells.young=\"if(max(cos(8*pi*(x-shift)), cos(8*pi*(y-shift))) < 0, 1e{k}, 1)\"");
    let [shift, model, basis] =
        [format!("parameters.shift={shift}"), format!("method.model=\"{model}\""), format!("grid.basis=\"{basis}\"")];
    scene("stiff-inclusions", &[&young, &shift, &model, &basis])
}

fn doubts(s: &Summary) -> bool {
    s.estimate_doubts.iter().any(|d| d == "contrast")
}

/// Inclusions inside of coarse cells: the error stays at 27 % whatever the contrast, and the estimate at about 2.5 times it.
/// Across edges it goes to 100 %; from a contrast of 10² on the estimate is in doubt. Never is a wrong answer given as a good one:
/// either the estimate is more than two thirds of the error, or there is a doubt.
#[test]
fn inclusions_that_cross_coarse_edges() {
    for (shift, crossing) in [(0.0, false), (0.125, true)] {
        for k in [1, 2, 3, 4] {
            let fine = on_grid(&inclusions(shift, k, "fem", "coupled"));
            assert!(fine.converged, "1e{k}: {}", fine.reason);
            for basis in ["linear", "coupled", "oscillatory"] {
                let s = on_grid(&inclusions(shift, k, "msfem", basis));
                // strain energies are half of the works, and the multiscale space is part of the fine one
                let error = (2.0 * (s.energy - fine.energy)).sqrt();
                let relative = error / (2.0 * fine.strain_energy).sqrt();
                let estimate = s.grid.as_ref().and_then(|g| g.estimate_multiscale).expect("it conforms");
                println!(
                    "shift {shift} 1e{k} {basis}: error {relative:.3}, effectivity {:.2}, doubt {}",
                    estimate / error,
                    doubts(&s)
                );
                assert_eq!(doubts(&s), crossing && k >= 2, "1e{k} {basis}: {:?}", s.estimate_doubts);
                assert!(doubts(&s) || estimate > 0.67 * error, "1e{k} {basis}: {estimate} of {error}");
                assert!(crossing || (1.0..4.0).contains(&(estimate / error)), "1e{k} {basis}: {estimate} of {error}");
                match (crossing, basis) {
                    (false, "coupled") => assert!((0.2..0.3).contains(&relative), "1e{k}: {relative}"),
                    (true, "coupled") => assert!((k == 1 || relative > 0.9) && relative > 0.5, "1e{k}: {relative}"),
                    _ => {}
                }
                // a useless answer is known by its own energy: the estimate is as large as that
                assert!(
                    !crossing || relative < 0.9 || s.estimate_relative.expect("it conforms") > 1.0,
                    "1e{k} {basis}"
                );
            }
        }
    }
}

/// Layers that coarse cells do not know the place of: the estimate falls against the error as their contrast rises, and is in doubt
/// before it is much less.
#[test]
fn layers_across_coarse_edges() {
    let base = "body.corners = [[0, 0], [1, 0], [1, 1], [0, 1]]\nbody.sides = [\"floor\", \"right\", \"top\", \"left\"]\n\
                material = { poisson = 0.3, cells = { size = 0.03125, young = \"YOUNG\" } }\n\
                sides.floor.displacement = [\"0\", \"0\"]\nsides.top.traction = [\"1\", \"-2 + sin(5*x)\"]\n\
                grid = { coarse = [8, 8], fine = [4, 4], basis = \"BASIS\" }\n[method]\nrefine = \"none\"\n";
    for layers in ["sin(50*y)", "sin(30*(x + y))", "sin(40*x)*sin(40*y) - 0.3"] {
        for basis in ["q1", "linear", "coupled", "oscillatory"] {
            let effectivity = [3, 20, 50, 100, 300].map(|contrast| {
                let text = base.replace("YOUNG", &format!("if({layers} > 0, 1, {contrast})")).replace("BASIS", basis);
                let [s, fine] = ["auto", "fem"].map(|model| {
                    let set = [format!("method.model=\"{model}\""), "method.max_dofs=100000".into()];
                    on_grid(
                        &parse(&text, &set.each_ref().map(String::as_str)).unwrap_or_else(|e| panic!("{}", e.render())),
                    )
                });
                let estimate = s.grid.as_ref().and_then(|g| g.estimate_multiscale).expect("it conforms");
                assert_eq!(doubts(&s), contrast >= 100, "{layers} {basis} {contrast}");
                estimate / (2.0 * (s.energy - fine.energy)).sqrt()
            });
            println!("{layers} {basis}: {effectivity:.2?}");
            assert!(
                effectivity[0] > 1.7 && effectivity[..3].iter().all(|e| *e > 0.75),
                "{layers} {basis}: {effectivity:?}"
            );
            assert!(effectivity.iter().all(|e| *e < 3.0), "{layers} {basis}: {effectivity:?}");
        }
    }
}

/// Rounding: a contrast of 10^k costs k digits. The loss is seen in the balance of forces, and the run is not called converged.
#[test]
fn contrasts_that_rounding_cannot_bear() {
    for model in ["fem", "msfem"] {
        for k in [2, 4, 8, 12, 16] {
            match attempt_grid(&inclusions(0.125, k, model, "oversampled")) {
                Ok(Run { last, .. }) => {
                    let lost = (last.reactions[0].1[1] - 1.0).abs();
                    println!("{model} 1e{k}: force of the support wrong by {lost:.1e}, converged {}", last.converged());
                    assert!(!last.converged() || lost < 1e-3, "{model} 1e{k}: {lost}");
                    assert!(k > 4 || last.converged() && lost < 1e-6, "{model} 1e{k}: {lost}");
                }
                Err(error) => {
                    assert!(k > 4 && error.to_string().contains("positive definite"), "{model} 1e{k}: {error}");
                }
            }
        }
    }
}

/// Layers of 1:10 of the thickness H: no basis resolves what is as long as its cell. The estimate sees it.
#[test]
fn layers_as_thick_as_coarse_cells() {
    let at = |layers: usize, basis: &str, model: &str| {
        let text = format!(
            "title = \"layers\"\n[body]\ncorners = [[0, 0], [1, 0], [1, 1], [0, 1]]\nsides = [\"a\", \"b\", \"c\", \"d\"]\n[material]\npoisson = 0.3\n\
             cells = {{ size = {}, young = \"if(sin({layers}*2*pi*x) > 0, 1, 10)\" }}\n[sides.d]\ndisplacement = [0, 0]\n[sides.b]\n\
             traction = [0, -1]\n[grid]\ncoarse = [8, 8]\nfine = [16, 16]\nbasis = \"{basis}\"\n[method]\nmodel = \"{model}\"\nrefine = \"none\"\n",
            0.5 / layers as f64
        );
        on_grid(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render())))
    };
    // periods of 1/4, 1/8 and 1/16 of the body: two cells, one cell, half a cell
    let errors = [4, 8, 16].map(|layers| {
        let (fine, s) = (at(layers, "coupled", "fem"), at(layers, "coupled", "msfem"));
        let error = (2.0 * (s.energy - fine.energy)).sqrt();
        let estimate = s.grid.as_ref().and_then(|g| g.estimate_multiscale).expect("it conforms");
        println!(
            "{layers} periods: error {:.3}, effectivity {:.2}",
            error / (2.0 * fine.strain_energy).sqrt(),
            estimate / error
        );
        assert!((1.0..4.0).contains(&(estimate / error)), "{layers} periods: {estimate} of {error}");
        error / (2.0 * fine.strain_energy).sqrt()
    });
    assert!(errors[1] > 2.0 * errors[0] && errors[1] > errors[2] && errors[1] > 0.5, "{errors:?}");
}

/// Whether J is as near to the extrapolated one as it is told.
fn told(s: &Summary, exact: f64) -> bool {
    let bounds = s.energy_extrapolated.zip(s.energy_uncertainty);
    bounds.is_some_and(|(j, uncertainty)| (j - exact).abs() <= uncertainty && uncertainty <= 4.0 * (s.energy - exact))
}

/// Displacements that are prescribed and not linear along the sides of cells: elements that interpolate them are not part of the
/// space of the exact solution, and J - J_h is not half of the squared error.
#[test]
fn prescribed_displacements_that_elements_do_not_have() {
    for [x, y] in [["x^2", "0"], ["sin(3*x)", "cos(2*y)"], ["x*y", "-x^2/2"]] {
        let at = |n: usize, method: &str| {
            let sides: String =
                ["a", "b", "c", "d"].map(|s| format!("[sides.{s}]\ndisplacement = [\"{x}\", \"{y}\"]\n")).concat();
            let text = format!(
                "title = \"plate\"\n[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"a\", \"b\", \"c\", \"d\"]\n[material]\n\
                 young = 7.0\npoisson = 0.3\n{sides}[grid]\ncoarse = [{}, {n}]\nfine = [1, 1]\n[method]\n{method}\n",
                2 * n
            );
            parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render()))
        };
        let exact = adapt(&at(8, "model = \"bem\"\ntolerance = 1e-5")).expect("boundary elements").step().energy;
        let mut last = f64::INFINITY;
        for n in [8, 16, 32] {
            let s = on_grid(&at(n, "model = \"fem\"\nrefine = \"none\""));
            let wrong = (s.energy - exact).abs();
            println!("({x}, {y}) {n}: J wrong by {wrong:.1e}");
            // reactions do work on what interpolation leaves of the data: the estimate does not know J's error
            assert_eq!((s.energy_extrapolated, s.energy_uncertainty), (None, None));
            assert!(wrong < last / 3.0, "({x}, {y}) {n}: {wrong:e} after {last:e}");
            last = wrong;
        }
    }
}

/// ν → ½: bilinear elements lock, boundary elements do not; the estimate never is less than the error.
#[test]
fn bilinear_elements_lock_and_say_so() {
    let plate = |nu: f64, method: &str| {
        let text = format!(
            "title = \"plate\"\n[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"a\", \"b\", \"c\", \"d\"]\n[material]\nyoung = 7.0\n\
             poisson = {nu}\n[sides.d]\ndisplacement = [0, 0]\n[sides.b]\ntraction = [0, -1]\n[grid]\ncoarse = [32, 16]\nfine = [1, 1]\n\
             [method]\n{method}\n"
        );
        parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render()))
    };
    let mut last = 0.0;
    for nu in [0.3, 0.49, 0.499, 0.4999, 0.4999999] {
        let exact = adapt(&plate(nu, "model = \"bem\"\ntolerance = 1e-4")).expect("boundary elements").step().energy;
        let s = on_grid(&plate(nu, "model = \"fem\"\nrefine = \"none\""));
        let error = (2.0 * (s.energy - exact)).sqrt();
        let (relative, effectivity) = (error / (-2.0 * exact).sqrt(), s.estimate.expect("an estimate") / error);
        println!("nu {nu}: error {relative:.3}, effectivity {effectivity:.2}");
        assert!(told(&s, exact), "nu {nu}: {:?} of {exact}", s.energy_extrapolated);
        assert!(relative > last && (0.95..3.0).contains(&effectivity), "nu {nu}: {relative}, {effectivity}");
        last = relative;
    }
    assert!(last > 0.8, "bilinear elements do not lock: {last}");
}

/// Without an estimate all coarse cells are split until they are the fine ones, and no tolerance is said to be reached.
#[test]
fn refinement_without_an_estimate_ends_at_the_fine_grid() {
    let refined = |basis: &str, model: &str| {
        let changes = [format!("grid.basis=\"{basis}\""), format!("method.model=\"{model}\"")];
        let mut scene = scene("checkerboard", &changes.each_ref().map(String::as_str));
        scene.method.refine = if model == "fem" { steklov_problem::Refine::None } else { steklov_problem::Refine::H };
        attempt_grid(&scene).unwrap_or_else(|e| panic!("{e}"))
    };
    let fine = refined("coupled", "fem").last.energies.total;
    for basis in ["oversampled", "periodic"] {
        let run = refined(basis, "msfem");
        assert_eq!((run.reason, run.progress.steps.len()), (Reason::FineGrid, 4), "{basis}");
        assert!(!run.converged() && run.progress.steps.iter().all(|s| s.estimate.is_none()), "{basis}");
        assert!(
            (run.last.energies.total / fine - 1.0).abs() < 1e-10,
            "{basis}: {} and {fine}",
            run.last.energies.total
        );
    }
    let told = refined("coupled", "msfem");
    assert!(told.progress.steps.iter().all(|s| s.estimate.is_some()));
}

/// A plate of 2 × 1 held on the left, with more of a scene.
fn held_plate(more: &str) -> String {
    format!(
        "title = \"plate\"\n[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"a\", \"b\", \"c\", \"d\"]\n\
         [sides.d]\ndisplacement = [0, 0]\n{more}"
    )
}

/// Body forces are integrated as they are, on any grid: jumps and oscillations inside of cells too.
#[test]
fn body_forces_that_cells_do_not_resolve_keep_their_resultant() {
    let sine = (1.0 - 80f64.cos()) / 40.0 * (3f64.exp() - 1.0) / 3.0;
    for (force, exact, tolerance) in [
        ("sin(40*x)*exp(3*y)", sine, 1e-10),
        ("if(x > 1.03, 1, 0)", 0.97, 1e-3),
        ("if(x + y > 1.37, 1, 0)", 1.13, 1e-3),
    ] {
        for model in ["fem", "msfem"] {
            let more = format!(
                "[material]\nyoung = 7.0\npoisson = 0.3\n[body_force]\nvalue = [\"0\", \"{force}\"]\n\
                 [grid]\ncoarse = [4, 2]\nfine = [2, 2]\n[method]\nmodel = \"{model}\"\nrefine = \"none\"\n"
            );
            let s = on_grid(&parse(&held_plate(&more), &[]).unwrap_or_else(|e| panic!("{}", e.render())));
            let carried = -s.reactions["d"][1];
            assert!((carried - exact).abs() < tolerance, "{model} {force}: {carried} instead of {exact}");
        }
    }
    let more = "[material]\nyoung = 7.0\npoisson = 0.3\n[body_force]\nvalue = [\"0\", \"1/(x - 0.55)^2\"]\n\
                [grid]\ncoarse = [4, 2]\nfine = [2, 2]\n[method]\nmodel = \"fem\"\nrefine = \"none\"\n";
    let error = attempt_grid(&parse(&held_plate(more), &[]).expect("a scene")).err().expect("no integral").to_string();
    assert!(error.contains("body force"), "{error}");
}

/// Linear prescribed displacements along sides of cells with different moduli hold for bases that follow the moduli.
#[test]
fn prescribed_displacements_hold_on_oscillatory_traces() {
    let of = |method: &str| {
        let more = format!(
            "[sides.b]\ndisplacement = [\"0\", \"0.1*y\"]\n[material]\npoisson = 0.3\n[material.cells]\nsize = 0.125\n\
             young = {{ uniform = [1, 10], seed = 3 }}\n[grid]\ncoarse = [4, 2]\nfine = [4, 4]\n\
             [probe]\npoints = [[2, 0.125], [2, 0.25], [2, 0.875]]\n[method]\nrefine = \"none\"\n{method}\n"
        );
        let more = more.replace(
            "[grid]\n",
            if method.contains("fem\"") { "[grid]\n" } else { "[grid]\nbasis = \"oscillatory\"\n" },
        );
        on_grid(&parse(&held_plate(&more), &[]).unwrap_or_else(|e| panic!("{}", e.render())))
    };
    let (fine, oscillatory) = (of("model = \"fem\""), of(""));
    for p in &oscillatory.probe {
        assert!((p.displacement[1] - 0.1 * p.point[1]).abs() < 1e-12 && p.displacement[0].abs() < 1e-12, "{p:?}");
    }
    assert!(oscillatory.energy > fine.energy, "{} below {}", oscillatory.energy, fine.energy);
}

/// Nothing is free: no unknown is left, and no panic.
#[test]
fn all_nodes_held_leave_nothing_to_solve() {
    for (model, coarse) in [("fem", "[4, 1]"), ("msfem", "[2, 1]")] {
        let more = format!(
            "[sides.a]\ndisplacement = [0, 0]\n[sides.c]\ndisplacement = [0, 0]\n[sides.b]\ntraction = [1, 0]\n[material]\n\
             young = 7.0\npoisson = 0.3\n[grid]\ncoarse = {coarse}\nfine = [1, 1]\n[method]\nmodel = \"{model}\"\nmax_steps = 1\n"
        );
        let s = on_grid(&parse(&held_plate(&more), &[]).unwrap_or_else(|e| panic!("{}", e.render())));
        assert_eq!((s.energy, s.estimate_relative), (0.0, Some(1.0)), "{model}: {s:?}");
        assert!(!s.converged && s.estimate.is_some_and(|e| e > 0.0), "{model}: {s:?}");
    }
}

/// A gap that jumps between two points of the grid is refused; at a point of it, it is not.
#[test]
fn gaps_jump_at_grid_points_only() {
    let punch = |n: usize| {
        let more = format!(
            "[sides.a]\ncontact = {{ gap = \"if(x < 0.5, 1, 0)\" }}\n[sides.c]\npressure = \"1\"\n[material]\nyoung = 7.0\n\
             poisson = 0.3\n[grid]\ncoarse = [{n}, 4]\nfine = [2, 2]\n[method]\nmodel = \"fem\"\nrefine = \"none\"\n"
        );
        attempt_grid(&parse(&held_plate(&more), &[]).unwrap_or_else(|e| panic!("{}", e.render())))
    };
    assert!(punch(4).is_ok());
    let error = punch(5).err().expect("a jump between points").to_string();
    assert!(error.contains("jumps from 1 to 0 at (0.5, 0)"), "{error}");
}

/// A body pressed into a corner of two walls: uniform stress, which any elements have without error.
#[test]
fn two_walls_at_a_corner_have_no_error() {
    for model in ["fem", "msfem"] {
        let text = format!(
            "title = \"corner\"\n[body]\ncorners = [[0, 0], [1, 0], [1, 1], [0, 1]]\nsides = [\"a\", \"b\", \"c\", \"d\"]\n\
             [material]\nyoung = 7.0\npoisson = 0.3\n[sides.a]\ncontact = {{ gap = \"0\" }}\n[sides.d]\ncontact = {{ gap = \"0\" }}\n\
             [sides.b]\ntraction = [-2, 0]\n[sides.c]\ntraction = [0, -1]\n[grid]\ncoarse = [3, 3]\nfine = [3, 3]\n[method]\n\
             model = \"{model}\"\nrefine = \"none\"\n"
        );
        let s = on_grid(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render())));
        assert!(s.estimate_relative.expect("an estimate") < 1e-10, "{model}: {:?}", s.estimate_relative);
    }
}
