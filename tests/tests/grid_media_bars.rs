//! Error bars of numbers on grids in a medium: judged by boundary elements of body and medium, by a known solution and by the fine grid.

use steklov_model::quantities::Quantity;
use steklov_model::summary::Summary;
use steklov_tests::{Random, full, on_grid, parse, summary};

use crate::grid_bars::{assert_near_errors, effectivities, shares};

fn solved(text: &str) -> Summary {
    on_grid(&parse(text, &["method.refine=\"none\""]).unwrap_or_else(|e| panic!("{}\n{text}", e.render())))
}

/// A square or an L in a medium up to eight times softer or stiffer, under a remote stress or torn by jumps.
fn random_inclusion(random: &mut Random, scene: usize) -> String {
    let number: [f64; 12] = std::array::from_fn(|_| random.between(0.0, 1.0));
    let [ratio, a, b, c, d, e, x, y, r, s, own, around] = number;
    let (corners, sides) = match scene % 3 {
        2 => (
            "[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [0, 0.5], [0, 0], [-0.5, 0]",
            "\"lower\", \"right\", \"upper\", \"notch\", \"ledge\", \"left\"",
        ),
        _ => ("[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]", "\"lower\", \"right\", \"upper\", \"left\""),
    };
    let loads = match scene % 2 {
        0 => format!("remote_stress = [{}, {}, {}]", a - 0.5, b - 0.5, c - 0.5),
        // a stress without a divergence has no resultant
        _ => format!(
            "stress_jump = [\"{a} + {b}*x\", \"{c} - {d}*y\", \"-{b}*y + {d}*x\"]\n\
             displacement_jump = [\"0.05*x^2\", \"0.05*sin({e} + x + y)\"]\n{}",
            if scene % 4 == 1 { "at_infinity = \"bounded\"" } else { "" }
        ),
    };
    format!(
        "[body]\ncorners = [{corners}]\nsides = [{sides}]\n[exterior]\nyoung = 10\npoisson = {}\n{loads}\n\
         [material]\npoisson = {}\nyoung = {}\n\
         [probe]\npoints = [[{}, {}], [{}, {}], [0.5, {}], [{}, {}], [{}, {}]]\n\
         [quantities]\nmean = {{ mean_displacement = \"right\" }}\n",
        0.4 * around,
        0.4 * own,
        10.0 * 8f64.powf(2.0 * ratio - 1.0),
        0.05 + 0.3 * x,
        -0.4 + 0.3 * y,
        0.4 - 0.3 * y,
        -0.05 - 0.3 * x,
        0.35 * (2.0 * r - 1.0),
        0.8 + r,
        1.4 * s - 0.7,
        -1.5 + 3.0 * r,
        -0.8 - s,
    )
}

#[test]
fn bars_in_a_medium_hold_against_boundary_elements() {
    let (mut random, mut found) = (Random::new(17), Vec::new());
    for scene in 0..if full() { 9 } else { 7 } {
        let text = random_inclusion(&mut random, scene);
        let around = on_reference(&text);
        for (n, fine, model) in [(8, 1, "fem-bem"), (16, 1, "fem-bem"), (32, 1, "fem-bem"), (8, 4, "msfem-bem")] {
            let cells = format!("coarse = [{n}, {n}]\nfine = [{fine}, {fine}]\n");
            let own = solved(&format!("{text}[grid]\n{cells}[method]\nmodel = \"{model}\"\n"));
            for path in ["energy", "probe.0.stress.xx", "probe.4.displacement.y", "mean_displacement.mean.x"] {
                assert!(own.quantities.contains_key(path), "{path}\n{text}");
                assert!(own.quantities[path].parts["medium"] > 0.0, "{path}: {:?}", own.quantities[path]);
            }
            let energies = [("strain_energy", around.strain_energy), ("load_work", around.load_work)];
            let of_energies = energies.map(|(path, exact)| {
                let Quantity { value, uncertainty, .. } = own.quantities[path];
                uncertainty / (value - exact).abs()
            });
            let mut own = effectivities(&own, &around, |quantity| quantity.uncertainty);
            own.extend(of_energies);
            if own.iter().any(|e| *e < 0.5) {
                println!("{own:?} on {n} cells of {fine}\n{text}");
            }
            found.extend(own);
        }
    }
    assert_near_errors(&found, 1000, [0.65, 0.85]);
}

/// By boundary elements where their numbers have bars, else by a grid of small cells.
fn on_reference(text: &str) -> Summary {
    if !text.contains("bounded") {
        return summary(&parse(&format!("{text}[method]\nmodel = \"bem\"\ntolerance = 1e-5\n"), &[]).expect("a scene"));
    }
    solved(&format!("{text}[grid]\ncoarse = [96, 96]\nfine = [1, 1]\n[method]\nmodel = \"fem-bem\"\n"))
}

/// Random cells: the difference to the solution on all fine cells.
#[test]
fn the_multiscale_part_in_a_medium_is_that_of_the_fine_grid() {
    let mut found = Vec::new();
    for (scene, basis) in ["coupled", "oscillatory", "linear", "q1", "coupled", "oscillatory"].into_iter().enumerate() {
        let [low, high] = [[2, 20], [20, 100], [1, 5]][scene % 3];
        let text = format!(
            "[body]\ncorners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]\n\
             sides = [\"lower\", \"right\", \"upper\", \"left\"]\n[exterior]\nyoung = 10\npoisson = 0.3\n\
             remote_stress = [1, 0.2, 0.3]\n[material]\npoisson = 0.3\n\
             cells = {{ size = 0.125, young = {{ uniform = [{low}, {high}], seed = {scene} }} }}\n\
             [probe]\npoints = [[0.1, 0.05], [0.3, -0.21], [0.5, 0.1], [0.8, 0.3], [-3, 2]]\n"
        );
        let with = |n: usize, fine: usize, basis: &str, model: &str| {
            let grid =
                format!("[grid]\ncoarse = [{n}, {n}]\nfine = [{fine}, {fine}]\n{basis}[method]\nmodel = \"{model}\"\n");
            solved(&format!("{text}{grid}"))
        };
        let whole = with(64, 1, "", "fem-bem");
        let own = with(8, 8, &format!("basis = \"{basis}\"\n"), "msfem-bem");
        let mut exact = whole.clone();
        exact.quantities.values_mut().for_each(|quantity| quantity.uncertainty = 0.0);
        // the boundary elements between coarse vertices are longer
        let of_coarse = |quantity: &Quantity| quantity.parts["multiscale"] + quantity.parts["medium"];
        found.extend(effectivities(&own, &exact, of_coarse));
    }
    let least = found.iter().fold(f64::INFINITY, |m: f64, e| m.min(*e));
    let ([half, narrow], [_, ten]) = (shares(&found, 0.5, 4.0), shares(&found, 0.3, 10.0));
    println!("{} numbers: half {half}, least {least}, at most 4 {narrow}, 10 {ten}", found.len());
    assert!(found.len() > 200 && half >= 0.95 && least >= 0.1, "{half} {least}");
    assert!(narrow >= 0.6 && ten >= 0.8, "{narrow} {ten}");
}

/// The square of the other tests under a remote stress, with these lines of `[exterior]` and `[method]`.
fn inclusion(loads: &str, points: &str, cells: usize, method: &str) -> Summary {
    solved(&format!(
        "[body]\ncorners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]\n\
         sides = [\"lower\", \"right\", \"upper\", \"left\"]\n[material]\nyoung = 5\npoisson = 0.3\n\
         [exterior]\nyoung = 100\npoisson = 0.3\n{loads}\n[probe]\npoints = {points}\n\
         [grid]\ncoarse = [{cells}, {cells}]\nfine = [1, 1]\n[method]\nmodel = \"fem-bem\"\n{method}"
    ))
}

/// The body moves by the jump, and nothing is strained.
#[test]
fn a_jump_that_is_a_rigid_motion_leaves_all_at_rest() {
    for jump in ["[1, 2]", "[\"-0.1*y\", \"0.1*x\"]"] {
        let summary = inclusion(&format!("displacement_jump = {jump}"), "[[0.25, 0.2]]", 8, "");
        assert!(summary.converged, "{jump}");
        let wanted = if jump.contains('y') { [-0.02, 0.025] } else { [1.0, 2.0] };
        let Quantity { value, uncertainty, .. } = summary.quantities["probe.0.displacement.x"];
        assert!((value - wanted[0]).abs() < 1e-12 && uncertainty < 1e-8, "{jump}: {value} ± {uncertainty}");
    }
}

/// Stresses beside long boundary elements have the error of their tractions, and elements longer than cells leave displacements apart.
#[test]
fn what_few_boundary_elements_tell_is_in_doubt() {
    let doubts = |summary: &Summary, path: &str| summary.quantities[path].doubts.clone();
    let points = "[[0.1, 0.51], [0.1, 0.7]]";
    let own = inclusion("remote_stress = [1, 0.2, 0.3]", points, 16, "");
    for (path, wanted) in [
        ("probe.0.stress.yy", &["coarse"][..]),
        ("probe.0.displacement.y", &[]),
        ("probe.1.stress.yy", &[]),
        ("energy", &[]),
    ] {
        assert_eq!(doubts(&own, path), wanted, "{path}");
    }
    for (cells, method) in [(16, "elements = 8"), (1, "")] {
        let own = inclusion("remote_stress = [1, 0.2, 0.3]", points, cells, method);
        let undoubted: Vec<&String> =
            own.quantities.iter().filter(|(_, of)| of.doubts.is_empty()).map(|own| own.0).collect();
        assert!(undoubted.is_empty(), "{method}: {undoubted:?}");
    }
}
