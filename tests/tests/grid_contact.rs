//! Contact and friction on grids: against boundary elements, against the fine grid, and bodies that contact alone holds.

use steklov_model::summary::{Audit, Summary};
use steklov_problem::{BasisInput, Model, Scene};
use steklov_tests::{attempt_grid, on_grid, parse, scene};

/// A unit square that a scene of the gallery has, on n × n coarse cells of m × m fine ones.
fn on(name: &str, overrides: &[&str], model: Model, n: usize, m: usize) -> Scene {
    let cells = format!("grid={{ coarse = [{n}, {n}], fine = [{m}, {m}] }}");
    let once = ["method.refine=\"none\"", "method.max_dofs=1000000", &cells];
    let mut scene = scene(name, &[overrides, &once].concat());
    scene.method.model = model;
    scene
}

fn worst(audit: &Option<Audit>) -> f64 {
    let Audit { equilibrium, penetration, tension, complementarity, friction } = *audit.as_ref().expect("contact");
    [equilibrium, penetration, tension, complementarity, friction].into_iter().fold(0.0, f64::max)
}

fn solved(scene: &Scene) -> Summary {
    let summary = on_grid(scene);
    assert!(summary.converged && worst(&summary.audit) <= 1e-10, "{}: {:?}", scene.title, summary.audit);
    summary
}

/// J of bilinear elements converges to that of boundary elements: algebraically, so that it is extrapolated at its rate. What
/// is extrapolated from the estimate of one grid is right within its uncertainty.
#[test]
fn bilinear_elements_converge_to_boundary_elements() {
    for (name, energy, first, tolerance) in [
        ("block-on-floor", -2.993_329_193_070_8, 64, 1e-6),
        ("wedge-gap", 0.647_194_015_986_9, 64, 2e-6),
        ("coulomb-wedge", 0.657_052_961_6, 32, 1e-5),
    ] {
        let j = [first, 2 * first, 4 * first].map(|n| {
            let s = solved(&on(name, &[], Model::Fem, n, 1));
            let told = s.energy_extrapolated.zip(s.energy_uncertainty);
            let (extrapolated, uncertainty) = told.expect("bilinear elements have an estimate");
            let error = (extrapolated - energy).abs();
            println!(
                "{name} {n}: J wrong by {:.1e}, extrapolated by {error:.1e} of {uncertainty:.1e}",
                s.energy - energy
            );
            assert!(error <= uncertainty, "{name} {n}: {error:e} of {uncertainty:e}");
            // and that is no more than J itself is wrong by, nearly
            assert!(uncertainty <= 4.0 * (s.energy - energy), "{name} {n}: {uncertainty:e}");
            s.energy
        });
        let ratio = (j[0] - j[1]) / (j[1] - j[2]);
        let limit = j[2] + (j[2] - j[1]) / (ratio - 1.0);
        let error = (limit / energy - 1.0).abs();
        println!("{name}: {j:?}, ratio {ratio:.2}, {limit} is wrong by {error:.1e}");
        // from above: the contact conditions of the fine grid's nodes are met by the exact solution but for the kink of the gap
        assert!(j.windows(2).all(|j| j[0] > j[1]) && j[2] > energy, "{name}: {j:?}");
        assert!((2.8..4.3).contains(&ratio) && error <= tolerance, "{name}: ratio {ratio}, {error:e}");
    }
}

const RANDOM: &str =
    "material={ poisson = 0.3, cells = { size = 0.03125, young = { uniform = [100, 300], seed = 1 } } }";

/// J of coarse cells is above that of the fine grid, and falls with H; where a coarse cell is a fine one they are the same. The
/// estimate does not miss what is between. The force of the floor balances the loads at each H.
#[test]
fn coarse_cells_converge_to_the_fine_grid() {
    for (name, change) in
        [("block-on-floor", None), ("block-on-floor", Some(RANDOM)), ("wedge-gap", None), ("coulomb-wedge", None)]
    {
        let changes = change.as_slice();
        let fine = solved(&on(name, changes, Model::Fem, 32, 1));
        for basis in [BasisInput::Linear, BasisInput::Coupled, BasisInput::Oscillatory, BasisInput::Q1] {
            let solve = |n: usize| {
                let mut scene = on(name, changes, Model::Msfem, n, 32 / n);
                scene.body_mut().grid.as_mut().expect("a grid").basis = basis;
                solved(&scene)
            };
            let steps = [4, 8, 16, 32].map(solve);
            let above = [0, 1, 2, 3].map(|k| steps[k].energy - fine.energy);
            println!("{name} {basis:?}: {above:?}");
            assert!(above.windows(2).all(|a| a[0] > a[1]), "{name} {basis:?}: {above:?}");
            // random cells as small as the fine ones: their resonance with H slows it down
            assert!(above[2] < if change.is_none() { 0.2 } else { 0.5 } * above[0], "{name} {basis:?}: {above:?}");
            assert!(above[3].abs() <= 1e-10 * fine.energy.abs(), "{name} {basis:?}: {above:?}");
            for (step, above) in steps.iter().zip(above).take(3) {
                let estimate = step.grid.as_ref().and_then(|g| g.estimate_multiscale).expect("it conforms");
                // J - J_fine is at least half of the squared error
                let effectivity = estimate / (2.0 * above).sqrt();
                assert!((0.8..4.5).contains(&effectivity), "{name} {basis:?}: {effectivity}");
                let total: f64 = step.reactions.values().map(|r| r[1]).sum();
                let load = if name == "block-on-floor" { 40.0 / 3.0 } else { 0.0 };
                assert!((total - load).abs() <= 1e-9 * fine.reactions["floor"][1], "{name} {basis:?}: {total}");
            }
        }
    }
}

/// Bases that do not conform may be below the fine grid's J, and have no estimate; contact holds as it does for the others.
#[test]
fn contact_of_bases_that_do_not_conform() {
    let fine = solved(&on("block-on-floor", &[RANDOM], Model::Fem, 32, 1)).energy;
    for basis in [BasisInput::Oversampled, BasisInput::Periodic] {
        let mut scene = on("block-on-floor", &[RANDOM], Model::Msfem, 8, 4);
        scene.body_mut().grid.as_mut().expect("a grid").basis = basis;
        let summary = solved(&scene);
        println!("{basis:?}: {} and {fine}", summary.energy);
        assert!(
            summary.estimate.is_none() && (summary.energy / fine - 1.0).abs() < 0.03,
            "{basis:?}: {}",
            summary.energy
        );
        assert!((summary.reactions["floor"][1] - 40.0 / 3.0).abs() < 1e-9, "{basis:?}");
    }
}

/// A block on a floor: pressed down and pushed aside.
fn pushed(friction: &str, push: f64, model: &str) -> Scene {
    let text = format!(
        "title = \"pushed\"\n[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"floor\", \"right\", \"top\", \"left\"]\n\
         [material]\npoisson = 0.3\ncells = {{ size = 0.125, young = {{ uniform = [10, 30], seed = 4 }} }}\n\
         [sides.floor]\ncontact = {{ gap = \"0\"{friction} }}\n[sides.top]\ntraction = [\"{push}\", \"-1\"]\n\
         [grid]\ncoarse = [8, 4]\nfine = [4, 4]\n[method]\nmodel = \"{model}\"\nrefine = \"none\"\n"
    );
    parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render()))
}

/// Friction holds a block up to its bound: F times the floor, or μ times the weight; without friction nothing does.
#[test]
fn friction_alone_holds_a_block() {
    for model in ["fem", "msfem"] {
        for (friction, push) in
            [("", 0.0), (", friction = { tresca = \"0.3\" }", 0.29), (", friction = { coulomb = \"0.3\" }", 0.28)]
        {
            let s = solved(&pushed(friction, push, model));
            let [x, y] = s.reactions["floor"];
            assert!((x + 2.0 * push).abs() <= 1e-9 && (y - 2.0).abs() <= 1e-9, "{model} {friction}: ({x}, {y})");
        }
        for (friction, push) in [("", 0.01), (", friction = { tresca = \"0.3\" }", 0.31)] {
            let error = attempt_grid(&pushed(friction, push, model)).err();
            let error = error.unwrap_or_else(|| panic!("{model} {friction}: {push} is held")).to_string();
            assert!(error.contains("translation along (1, 0)"), "{model} {friction}: {error}");
        }
    }
}
