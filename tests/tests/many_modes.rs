//! Fields of many modes on grids: derivatives by adjoint solutions, the modes that polynomials keep, moduli at the ends of fields.

use steklov_model::grid::{GridLayout, modulus_derivatives, solve_grid};
use steklov_tests::{on_grid, outcomes, parse, quantity, read};

/// A plate of 2 by 1 that is clamped on the left and pulled down on the right.
fn plate(young: &str, field: &str, stochastic: &str) -> String {
    format!(
        "title = \"plate\"\n[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\n\
         sides = [\"bottom\", \"right\", \"top\", \"left\"]\n[material]\npoisson = 0.3\n[material.cells]\nsize = 0.125\n\
         young = \"{young}\"\n{field}[sides.left]\ndisplacement = [0, 0]\n[sides.right]\ntraction = [0, -1]\n\
         [grid]\ncoarse = [16, 8]\nfine = [1, 1]\n[probe]\npoints = [[2, 0.5], [0.7, 0.3]]\n[method]\nmodel = \"fem\"\n\
         refine = \"none\"\n{stochastic}"
    )
}

fn field(modes: &str, variables: &str) -> String {
    format!(
        "[random.g]\ncovariance = \"exponential\"\ncorrelation = 0.5\non = \"body\"\nmodes = {modes}\n\
         variables = \"{variables}\"\n"
    )
}

/// The derivatives of all numbers that have one by the modulus of a cell are those of differences of two solutions; with
/// prescribed displacements, weight and a pressure too.
#[test]
fn derivatives_by_moduli_are_those_of_differences() {
    let paths = [
        "energy",
        "strain_energy",
        "load_work",
        "probe.0.displacement.y",
        "probe.1.displacement.x",
        "probe.1.stress.xx",
        "probe.1.stress.xy",
        "reactions.left.x",
        "reactions.left.y",
        "reactions.right.y",
    ];
    // a bump in one cell
    let text = |bump: f64, cell: [usize; 2]| {
        let [x, y] = cell.map(|i| 0.125 * (i as f64 + 0.5));
        let young = format!("1 + 0.3*sin(3*x)*cos(5*y) + if(abs(x - {x}) + abs(y - {y}) < 0.01, {bump:?}, 0)");
        let scene = plate(&young, "", "").replace("[0, 0]\n[sides.right]", "[\"0.1*y\", 0]\n[sides.right]");
        scene.replace("traction = [0, -1]", "displacement = [\"free\", 0.05]\n[body_force]\nvalue = [\"x\", \"-1\"]")
    };
    let scene = read(&text(0.0, [0, 0]));
    let layout = GridLayout::first(&scene).unwrap();
    let solved = solve_grid(&scene, &layout, &mut |_| Ok(())).unwrap();
    let derivatives = modulus_derivatives(&scene, &solved, &paths).unwrap().expect("all have one");
    let number = |bump: f64, cell: [usize; 2]| -> Vec<f64> {
        let summary = on_grid(&read(&text(bump, cell)));
        paths.iter().map(|path| summary.at(path).unwrap_or_else(|| panic!("no {path}"))).collect()
    };
    const H: f64 = 1e-4;
    for cell in [[0, 0], [0, 7], [5, 2], [15, 4], [8, 0]] {
        let (above, below) = (number(H, cell), number(-H, cell));
        for (k, path) in paths.iter().enumerate() {
            let (difference, derivative) = ((above[k] - below[k]) / (2.0 * H), derivatives[k][cell[0] * 8 + cell[1]]);
            let scale = derivatives[k].iter().fold(0.0f64, |m, d| m.max(d.abs()));
            assert!(
                (difference - derivative).abs() < 1e-6 * scale + 1e-9,
                "{path} {cell:?}: {difference} {derivative} {scale}"
            );
        }
    }
    assert!(modulus_derivatives(&scene, &solved, &["contact.length"]).unwrap().is_none());
    // where two supports meet, the stress there parts their forces
    let meeting = read(&(text(0.0, [0, 0]) + "[sides.bottom]\ndisplacement = [\"free\", \"0.025*x\"]\n"));
    let solved = solve_grid(&meeting, &layout, &mut |_| Ok(())).unwrap();
    assert!(modulus_derivatives(&meeting, &solved, &["reactions.bottom.y"]).unwrap().is_none());
    assert!(modulus_derivatives(&meeting, &solved, &["reactions.left.x"]).unwrap().is_some());
}

/// Modes that are odd about the axis of the plate do not move its tip: polynomials do without them and all others of little effect,
/// with the mean of all modes.
#[test]
fn polynomials_keep_the_modes_of_effect() {
    let of = |stochastic: &str| {
        let stochastic = format!(
            "[stochastic]\nquantities = [\"probe.0.displacement.y\", \"reactions.left.y\"]\nmax_nodes = 100000\n{stochastic}"
        );
        outcomes(&read(&plate("exp(0.3*g)", &field("30", "normal"), &stochastic)))
    };
    let reference = of("method = \"sparse\"\nlevel = 2\n");
    let exact = quantity(&reference, "probe.0.displacement.y");
    let (mut off, mut solved) = (0.0, 0);
    for seed in 1..=4 {
        let result = of(&format!("method = \"corrected\"\ntolerance = 0.01\nseed = {seed}\n"));
        let (kept, left_out) = result.kept.as_ref().expect("a part of the modes");
        // modes 3, 5 and 9 have no effect, and the force of the support is given but for rounding
        assert!(kept.len() < 20 && [2, 4, 8].iter().all(|germ| !kept.contains(germ)), "{kept:?}");
        assert!(kept.contains(&0) && (1e-5..0.02).contains(left_out), "{kept:?} {left_out}");
        solved += result.solved;
        let tip = quantity(&result, "probe.0.displacement.y");
        let error = tip.standard_error.expect("an error");
        assert!(error < 0.011 * exact.variance.sqrt() && (tip.mean - exact.mean).abs() < 4.0 * error, "seed {seed}");
        assert!((tip.variance / exact.variance - 1.0).abs() < 0.2, "{} {}", tip.variance, exact.variance);
        // fields vary by all modes
        let [of_all, own] = [&reference, &result].map(|r| r.in_body.as_ref().expect("fields").young.variance.clone());
        let ratio = own.iter().sum::<f64>() / of_all.iter().sum::<f64>();
        assert!((0.75..1.3).contains(&ratio), "seed {seed}: {ratio}");
        off += ((tip.mean - exact.mean) / error).powi(2) / 4.0;
    }
    // with all modes 61 points and about 200 outcomes
    assert!((0.1..3.0).contains(&off) && solved < 4 * 230, "{off} {solved}");
    // as many modes as there are: more than 100 are sampled on a family of grids, and these polynomials keep few of them
    let many = read(&plate(
        "exp(0.3*g)",
        &field("\"auto\"", "normal"),
        "[stochastic]\nmethod = \"corrected\"\nquantities = [\"probe.0.displacement.y\"]\n",
    ));
    assert_eq!(many.random.as_ref().expect("random input").germs.len(), 400);
    let result = outcomes(&many);
    assert!(result.kept.as_ref().expect("a part").0.len() < 60 && result.solved < 500, "{}", result.solved);
    let tip = quantity(&result, "probe.0.displacement.y");
    let error = (tip.mean - exact.mean).abs();
    // 30 modes have 78 % of the variance, 400 have 95 %: the mean is that of a rougher field
    assert!(error < 0.05 * exact.variance.sqrt() && tip.variance > exact.variance * 0.9, "{error}");
}

/// A modulus that an outcome of any number of modes makes negative is refused: of 1 + s g, |g| <= √3 Σ √λ |b|, from s = .3028 on at
/// 32 by 16 cells.
#[test]
fn moduli_are_positive_at_the_ends_of_fields_of_many_modes() {
    let of = |young: &str, modes: &str, variables: &str| {
        let text = plate(young, &field(modes, variables), "[stochastic]\nmethod = \"sparse\"\nlevel = 1\n");
        let text = text.replace("size = 0.125", "size = 0.0625").replace("coarse = [16, 8]", "coarse = [32, 16]");
        parse(&text, &[]).err().map(|e| e.render())
    };
    // cell means at 32 by 16 cells have the bound .3035, midpoints .30278
    assert_eq!(of("1 + 0.30*g", "6", "uniform"), None);
    for (young, modes, variables) in [
        ("1 + 0.305*g", "6", "uniform"),
        ("1 - 0.305*g", "6", "uniform"),
        ("1 + 0.2*g", "30", "normal"),
        ("2 - exp(0.2*g)", "40", "normal"),
    ] {
        let error = of(young, modes, variables).unwrap_or_default();
        assert!(
            error.contains("Young's modulus is -") && error.contains("0.0625") || error.contains("where g is"),
            "{young}: {error}"
        );
    }
    assert_eq!(of("exp(0.8*g)", "100", "normal"), None);
    assert_eq!(of("1 + 0.1*g", "100", "uniform"), None);
}
