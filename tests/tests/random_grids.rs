//! Random input on grids, against closed forms: bars of random cells, and a body that is pressed on a floor.

use steklov_model::stochastic::End;
use steklov_problem::{Sampling, Scene};
use steklov_tests::{outcomes, parse, quantity, read};

/// A bar of n cells in tension, E = exp(σ g).
fn bar(n: usize, correlation: f64, sigma: f64, modes: usize, model: &str, coarse: usize) -> Scene {
    let h = 1.0 / n as f64;
    let fine = n / coarse;
    read(&format!(
        "title = \"bar\"\n[body]\ncorners = [[0, 0], [1, 0], [1, {h}], [0, {h}]]\n\
         sides = [\"bottom\", \"end\", \"top\", \"clamp\"]\n[material]\npoisson = 0\n\
         [material.cells]\nsize = {h}\nyoung = \"exp({sigma}*g)\"\n\
         [random.g]\ncovariance = \"exponential\"\ncorrelation = [{correlation}, 1e9]\non = \"body\"\nmodes = {modes}\n\
         variables = \"normal\"\n[grid]\ncoarse = [{coarse}, 1]\nfine = [{fine}, 1]\nbasis = \"oscillatory\"\n\
         [sides.clamp]\ndisplacement = [0, \"free\"]\n[sides.bottom]\ndisplacement = [\"free\", 0]\n\
         [sides.end]\ntraction = [1, 0]\n[method]\nmodel = \"{model}\"\nrefine = \"none\"\n[probe]\npoints = [[1, 0]]\n\
         [stochastic]\nlevel = 5\nmax_nodes = 100000\nquantities = [\"probe.0.displacement.x\"]\n"
    ))
}

/// V_ij = Σ_m λ_m b_m,i b_m,j of the field of a scene.
fn covariance(scene: &Scene) -> Vec<Vec<f64>> {
    let random = scene.random.as_ref().expect("random input");
    let (field, _) = random.fields().next().expect("a field");
    let cells = field.expansion.cells().expect("a field of cells");
    let middle = |c: usize| [0, 1].map(|d| ([c / cells.cells[1], c % cells.cells[1]][d] as f64 + 0.5) * cells.size[d]);
    let modes: Vec<Vec<f64>> = cells.body().into_iter().map(|c| field.expansion.modes(middle(c))).collect();
    let entry = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum();
    modes.iter().map(|a| modes.iter().map(|b| entry(a, b)).collect()).collect()
}

/// Without lateral contraction u = ∫ dx/E: mean Σ h exp(σ² V_ii/2) and variance Σ_ij h² exp(σ² (V_ii + V_jj)/2)
/// (exp(σ² V_ij) - 1) over the cells before a node, by bilinear and by multiscale elements; E itself is lognormal.
#[test]
fn bars_of_random_cells_have_their_closed_forms() {
    for (n, correlation, sigma, modes, model, coarse) in [
        (16, 0.5, 0.2, 3, "fem", 16),
        (8, 0.1, 0.3, 2, "fem", 8),
        (5, 3.0, 0.1, 4, "fem", 5),
        (12, 0.25, 0.2, 2, "msfem", 3),
    ] {
        let scene = bar(n, correlation, sigma, modes, model, coarse);
        let (result, v) = (outcomes(&scene), covariance(&scene));
        let h = 1.0 / n as f64;
        let square = sigma * sigma;
        let rise = |i: usize| (0.5 * square * v[i][i]).exp();
        let mean = |k: usize| (0..k).map(|i| h * rise(i)).sum::<f64>();
        let variance = |k: usize| -> f64 {
            let pairs = (0..k).flat_map(|i| (0..k).map(move |j| (i, j)));
            pairs.map(|(i, j)| h * h * rise(i) * rise(j) * (square * v[i][j]).exp_m1()).sum()
        };
        let tip = quantity(&result, "probe.0.displacement.x");
        let (off, off_variance) = (tip.mean - mean(n), tip.variance / variance(n) - 1.0);
        println!("{n} cells, {modes} modes, {model}: mean off by {off:.1e}, variance by {off_variance:.1e}");
        // level 5 leaves less than that of exp(σ Σ c ξ)
        assert!(off.abs() < 1e-11 && off_variance.abs() < 1e-8, "{n} {modes} {model}: {off:e} {off_variance:e}");
        assert!(variance(n) > 1e-3 * mean(n).powi(2));

        let body = result.in_body.as_ref().expect("moments in the body");
        for i in 0..n {
            let stress = [0, 1, 2].map(|k| (body.stress.mean[3 * i + k], body.stress.variance[3 * i + k].sqrt()));
            for ((mean, deviation), exact) in stress.into_iter().zip([1.0, 0.0, 0.0]) {
                assert!((mean - exact).abs() < 1e-11 && deviation < 1e-6, "{n} {i}: {stress:?}");
            }
            let (young, spread) = (rise(i), rise(i) * rise(i) * (square * v[i][i]).exp_m1());
            assert!((body.young.mean[i] - young).abs() < 1e-11, "{n} {i}: {} {young}", body.young.mean[i]);
            assert!((body.young.variance[i] / spread - 1.0).abs() < 1e-8, "{n} {i}: {spread}");
        }
        let points = body.displacement.mean.len() / 2;
        assert_eq!(points, 2 * (n + 1));
        let mut seen = 0;
        for node in 0..points {
            let (u, spread) = (body.displacement.mean[2 * node], body.displacement.variance[2 * node]);
            let k = (0..=n).find(|&k| (u - mean(k)).abs() < 1e-11).unwrap_or_else(|| panic!("{n}: node {node}: {u}"));
            assert!((spread - variance(k)).abs() < 1e-8 * variance(n), "{n} {node}: {spread}");
            seen += k;
        }
        assert_eq!(seen, n * (n + 1), "both rows of nodes have each position once");
    }
}

/// A square of n × n cells in tension whose modulus varies along it: u = ∫ dx/E at its end, on all grids of a family.
fn square(n: usize, sigma: f64, young: &str, seed: u64) -> Scene {
    let h = 1.0 / n as f64;
    read(&format!(
        "title = \"square\"\n[body]\ncorners = [[0, 0], [1, 0], [1, 1], [0, 1]]\n\
         sides = [\"bottom\", \"end\", \"top\", \"clamp\"]\n[parameters]\nsigma = {sigma}\n[material]\npoisson = 0\n\
         {young}\n[random.g]\ncovariance = \"exponential\"\ncorrelation = [0.5, 1e9]\non = \"body\"\nmodes = 5\n\
         variables = \"normal\"\n[grid]\ncoarse = [{n}, {n}]\nfine = [1, 1]\n[sides.clamp]\ndisplacement = [0, \"free\"]\n\
         [sides.bottom]\ndisplacement = [\"free\", 0]\n[sides.end]\ntraction = [1, 0]\n[method]\nmodel = \"fem\"\n\
         refine = \"none\"\n[probe]\npoints = [[1, 0]]\n[stochastic]\nmethod = \"multilevel\"\ntolerance = 0.03\n\
         seed = {seed}\nquantities = [\"probe.0.displacement.x\"]\n"
    )
    .replace("SIZE", &h.to_string()))
}

/// The mean over a family of grids is that of the finest one, and its standard error is the scatter of repetitions; moduli of
/// coarse grids are those of one law whichever member of a difference they are.
#[test]
fn levels_add_up_to_the_finest_grid() {
    let cells = "[material.cells]\nsize = SIZE\nyoung = \"exp(sigma*g)\"";
    let (n, sigma) = (16, 0.3);
    let v = covariance(&square(n, sigma, cells, 0));
    // a cell of each column: all rows have the same field
    let column = |i: usize| n * i;
    let square_of = sigma * sigma;
    let rise = |i: usize| (0.5 * square_of * v[column(i)][column(i)]).exp() / n as f64;
    let exact: f64 = (0..n).map(rise).sum();
    let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let product = |(i, j): (usize, usize)| rise(i) * rise(j) * (square_of * v[column(i)][column(j)]).exp_m1();
    let variance: f64 = pairs.map(product).sum();
    let repetitions = 12;
    let (mut scatter, mut of_variance) = (0.0, 0.0);
    for seed in 0..repetitions {
        let result = outcomes(&square(n, sigma, cells, seed));
        let tip = quantity(&result, "probe.0.displacement.x");
        let error = tip.standard_error.expect("of samples");
        assert!(error <= 0.0301 * tip.variance.sqrt(), "{seed}: {error} of {}", tip.variance);
        assert!((tip.variance / variance - 1.0).abs() < 0.25, "{seed}: {} {variance}", tip.variance);
        assert_eq!(result.levels.last().map(|l| l.cells), Some([n; 2]));
        assert!(result.levels.len() > 1 && (result.weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        scatter += ((tip.mean - exact) / error).powi(2) / repetitions as f64;
        let error = tip.variance_error.expect("of samples");
        of_variance += ((tip.variance - variance) / error).powi(2) / repetitions as f64;
    }
    println!("scatter {:.2} standard errors, of the variance {:.2}", scatter.sqrt(), of_variance.sqrt());
    assert!((0.35..1.8).contains(&of_variance.sqrt()), "{of_variance}");
    // chi-square with 12 degrees of freedom: 1e-4 on either side
    assert!((0.35..1.8).contains(&scatter.sqrt()), "{scatter}");
}

/// Moduli by number are replaced by their geometric means; grids that cannot be halved are the coarsest.
#[test]
fn grids_are_halved_as_far_as_they_go() {
    let uniform = "young = { uniform = [1, 4], seed = 3 }";
    let random = "[random.q]\ndistribution = \"uniform\"\nlow = 1\nhigh = 2\n";
    let text = |n: usize, size: f64| {
        read(&format!(
            "title = \"t\"\n[body]\ncorners = [[0, 0], [1, 0], [1, 1], [0, 1]]\n\
             sides = [\"floor\", \"right\", \"top\", \"left\"]\n[material]\npoisson = 0.3\n[material.cells]\nsize = {size}\n\
             {uniform}\n{random}[sides.floor]\ndisplacement = [0, 0]\n[sides.top]\ntraction = [0, \"-q\"]\n\
             [grid]\ncoarse = [{n}, {n}]\nfine = [1, 1]\n[method]\nmodel = \"fem\"\nrefine = \"none\"\n\
             [stochastic]\nmethod = \"multilevel\"\nquantities = [\"strain_energy\"]\n"
        ))
    };
    // cells of the grid first, down to those of the modulus
    let scene = text(12, 0.25);
    let same = |a: &Scene, b: &Scene| {
        let of = |s: &Scene| s.body().cells().expect("cells").size;
        assert_eq!(of(a), of(b));
    };
    let six = scene.coarsened().expect("6 cells, which 4 modulus cells do not divide and 2 do");
    assert_eq!(six.body().cells().map(|cells| cells.size), Some(0.5));
    let scene = text(16, 0.25);
    let eight = scene.coarsened().expect("8 cells");
    let four = eight.coarsened().expect("4 cells");
    same(&scene, &four);
    let two = four.coarsened().expect("2 cells");
    let grid = steklov_problem::grid_of(&four).expect("a grid");
    let fine = steklov_problem::moduli(&four, &grid).expect("moduli");
    let coarse = steklov_problem::moduli(&two, &steklov_problem::grid_of(&two).expect("a grid")).expect("moduli");
    let total = |all: &[f64]| all.iter().map(|e| e.ln()).sum::<f64>() / all.len() as f64;
    assert_eq!((fine.len(), coarse.len()), (16, 4));
    assert!((total(&fine) - total(&coarse)).abs() < 1e-14);
    assert!(two.coarsened().is_none_or(|one| one.coarsened().is_none()));
    // loads alone are random: the energy is q² times a number on each grid
    let result = outcomes(&scene);
    let energy = quantity(&result, "strain_energy");
    assert_eq!(result.levels.len(), 4);
    assert!((energy.variance.sqrt() / energy.mean - 0.373).abs() < 0.01, "{} {}", energy.mean, energy.variance);
}

/// Reactions that the supports cannot have are rounding, whose spread is no reason for a doubt nor for more outcomes.
#[test]
fn quantities_of_rounding_change_nothing() {
    let text = "title = \"plate\"\n[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\n\
                sides = [\"bottom\", \"right\", \"top\", \"left\"]\n[material]\npoisson = 0.3\n[material.cells]\nsize = 0.125\n\
                young = \"1000*exp(0.3*g)\"\n[random.g]\ncovariance = \"exponential\"\ncorrelation = 0.5\non = \"body\"\n\
                modes = 6\nvariables = \"normal\"\n[sides.left]\ndisplacement = [0, 0]\n[sides.right]\ntraction = [0, -1]\n\
                [grid]\ncoarse = [16, 8]\nfine = [1, 1]\n[probe]\npoints = [[2, 0.5]]\n[method]\nmodel = \"fem\"\n\
                refine = \"none\"\n[stochastic]\ntolerance = 0.05\nmax_nodes = 100000\n";
    for method in [Sampling::Sparse, Sampling::Multilevel] {
        let with = |quantities: &[&str]| {
            let mut scene = read(text);
            let stochastic = &mut scene.random.as_mut().expect("random input").stochastic;
            stochastic.method = method;
            stochastic.quantities = Some(quantities.iter().map(|&path| path.to_owned()).collect());
            outcomes(&scene)
        };
        let tip = "probe.0.displacement.y";
        let (alone, both) = (with(&[tip]), with(&["reactions.left.x", "reactions.left.y", tip]));
        let zero = quantity(&both, "reactions.left.x");
        assert!(zero.mean.abs() < 1e-10 && zero.values.iter().any(|v| *v != 0.0), "{}", zero.mean);
        assert!(!both.is_doubtful() && zero.variance.sqrt() < 1e-10, "{method:?}: {}", zero.variance);
        assert_eq!(both.points.len(), alone.points.len(), "{method:?}");
        assert_eq!(quantity(&both, tip).mean, quantity(&alone, tip).mean);
    }
}

/// On a body that is no rectangle the moduli are lognormal with the variance of the modes in each cell.
#[test]
fn moduli_of_an_l_shape_are_lognormal() {
    let scene = read(
        "title = \"L\"\n[body]\ncorners = [[0, 0], [1, 0], [1, 0.5], [0.5, 0.5], [0.5, 1], [0, 1]]\n\
         sides = [\"bottom\", \"right\", \"a\", \"b\", \"top\", \"left\"]\n[material]\npoisson = 0.3\n\
         [material.cells]\nsize = 0.125\nyoung = \"2*exp(0.2*g)\"\n[random.g]\ncovariance = \"gaussian\"\n\
         correlation = 0.5\non = \"body\"\nmodes = 3\nvariables = \"normal\"\n[grid]\ncoarse = [8, 8]\nfine = [1, 1]\n\
         [sides.bottom]\ndisplacement = [0, 0]\n[sides.top]\ntraction = [0, -1]\n[method]\nrefine = \"none\"\n\
         [stochastic]\nlevel = 4\nquantities = [\"strain_energy\"]\n",
    );
    let (result, v) = (outcomes(&scene), covariance(&scene));
    let body = result.in_body.as_ref().expect("moments in the body");
    assert_eq!(body.young.mean.len(), 48);
    assert!(v.iter().enumerate().all(|(i, row)| row[i] > 0.1 && row[i] < 1.0));
    // the grid numbers its cells along x first, the field along y: each variance is somewhere
    let mut exact: Vec<f64> = (0..48).map(|i| 2.0 * (0.02 * v[i][i]).exp()).collect();
    let mut means = body.young.mean.clone();
    exact.sort_by(f64::total_cmp);
    means.sort_by(f64::total_cmp);
    for (mean, exact) in means.iter().zip(&exact) {
        assert!((mean - exact).abs() < 1e-10, "{mean} {exact}");
    }
    let energy = quantity(&result, "strain_energy");
    assert!(energy.variance > 0.0 && energy.truncation.is_some_and(|t| t < 0.01 * energy.variance.sqrt()));
}

/// A square without lateral contraction, its top pressed down by d, its floor a gap g below: F = E (d - g) in each outcome.
fn pressed(method: &str) -> Scene {
    read(&format!(
        "title = \"pressed\"\n[body]\ncorners = [[0, 0], [1, 0], [1, 1], [0, 1]]\n\
         sides = [\"floor\", \"right\", \"top\", \"left\"]\n[material]\nyoung = \"E\"\npoisson = 0\n\
         [random.E]\ndistribution = \"lognormal\"\nmean = 2000\ndeviation = 300\n\
         [random.gap]\ndistribution = \"uniform\"\nlow = 0.001\nhigh = 0.003\n\
         [random.d]\ndistribution = \"beta\"\nalpha = 2\nbeta = 3\nlow = 0.01\nhigh = 0.02\n\
         [sides.floor]\ncontact = {{ gap = \"gap\" }}\n[sides.top]\ndisplacement = [0, \"-d\"]\n\
         [grid]\ncoarse = [4, 4]\nfine = [1, 1]\n[method]\nmodel = \"fem\"\nrefine = \"none\"\n\
         [stochastic]\n{method}\nquantities = [\"contact.force.y\", \"contact.max_pressure\", \"contact.length\"]\n"
    ))
}

#[test]
fn the_force_of_a_pressed_square_has_its_closed_form() {
    // second moments of independent factors multiply
    let (young, young_variance): (f64, f64) = (2000.0, 300.0f64.powi(2));
    let (gap, gap_variance) = (0.002, 0.002f64.powi(2) / 12.0);
    let (d, d_variance) = (0.01 + 0.01 * 0.4, 0.01f64.powi(2) * 6.0 / (25.0 * 6.0));
    let path = d - gap;
    let mean = young * path;
    let variance = (young * young + young_variance) * (path * path + gap_variance + d_variance) - mean * mean;
    let result = outcomes(&pressed("level = 2"));
    for name in ["contact.force.y", "contact.max_pressure"] {
        let force = quantity(&result, name);
        let (off, off_variance) = (force.mean / mean - 1.0, force.variance / variance - 1.0);
        println!("{name}: mean off by {off:.1e}, variance by {off_variance:.1e}");
        // the square of a lognormal variable is a polynomial of no degree
        assert!(off.abs() < 1e-8 && off_variance.abs() < 1e-4, "{name}: {off:e} {off_variance:e}");
    }
    assert!((quantity(&result, "contact.length").mean - 1.0).abs() < 1e-12);
    assert!(result.probability.iter().all(|p| (p - 1.0).abs() < 1e-12));

    let scene = pressed("method = \"monte-carlo\"\nsamples = 200\nseed = 5");
    let (result, random) = (outcomes(&scene), scene.random.as_ref().expect("random input"));
    let force = quantity(&result, "contact.force.y");
    for (germs, value) in result.points.iter().zip(&force.values) {
        let [young, gap, d] = [0, 1, 2].map(|k| random.germs[k].variable.value(germs[k]));
        assert!((value / (young * (d - gap)) - 1.0).abs() < 1e-10, "{germs:?}: {value}");
    }
    let error = force.standard_error.expect("of samples");
    assert!((force.mean - mean).abs() < 4.0 * error && error < 0.03 * mean, "{} ± {error}: {mean}", force.mean);
}

/// A square between smooth walls under a unit pressure: u_y = -(1 + ν)(1 - 2ν)/(1 - ν) at its top in each outcome of ν.
fn oedometer(poisson: &str, material: &str, method: &str) -> String {
    format!(
        "title = \"oedometer\"\n[body]\ncorners = [[0, 0], [1, 0], [1, 1], [0, 1]]\n\
         sides = [\"floor\", \"right\", \"top\", \"left\"]\n[material]\n{material}\n[material.cells]\nsize = 0.5\n\
         young = \"1\"\npoisson = {poisson}\n[random.nu]\ndistribution = \"uniform\"\nlow = 0.05\nhigh = 0.45\n\
         [sides.floor]\ndisplacement = [\"free\", 0]\n[sides.left]\ndisplacement = [0, \"free\"]\n\
         [sides.right]\ndisplacement = [0, \"free\"]\n[sides.top]\ntraction = [0, -1]\n[grid]\ncoarse = [2, 2]\nfine = [2, 2]\n\
         [method]\nrefine = \"none\"\n{method}\n[probe]\npoints = [[0.3, 1]]\n[stochastic]\nmethod = \"monte-carlo\"\n\
         samples = 50\nquantities = [\"probe.0.displacement.y\"]\n"
    )
}

#[test]
fn poissons_ratio_may_be_random() {
    for model in ["fem", "msfem"] {
        let scene = read(&oedometer("\"nu\"", "", &format!("model = \"{model}\"")));
        let (result, random) = (outcomes(&scene), scene.random.as_ref().expect("random input"));
        let top = quantity(&result, "probe.0.displacement.y");
        for (germs, value) in result.points.iter().zip(&top.values) {
            let nu = random.germs[0].variable.value(germs[0]);
            let exact = -(1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu);
            assert!((value - exact).abs() < 1e-12, "{model} {nu}: {value} {exact}");
        }
        assert!(top.variance > 0.01);
    }
    for (text, said) in [
        (oedometer("\"nu\"", "poisson = 0.3", ""), "stands beside material.cells.poisson"),
        (oedometer("\"nu + 0.2\"", "", ""), "Poisson's ratio is 0.6"),
        (oedometer("{ uniform = [0.1, 0.6] }", "", ""), "below 0.5"),
        (oedometer("0.5", "", ""), "Poisson's ratio is 0.5 in the cell"),
    ] {
        let error = parse(&text, &[]).err().map(|e| e.render()).unwrap_or_default();
        assert!(error.contains(said), "{said}: {error}");
    }
}

/// What cannot be solved is refused by its place, for readers of scenes and for programs.
#[test]
fn random_grids_that_cannot_be_solved_are_refused() {
    let whole = "title = \"t\"\n[body]\ncorners = [[0, 0], [1, 0], [1, 1], [0, 1]]\n\
                 sides = [\"floor\", \"right\", \"top\", \"left\"]\n[material]\npoisson = 0.3\n\
                 [material.cells]\nsize = 0.25\nyoung = \"YOUNG\"\n[random.g]\ncovariance = \"exponential\"\n\
                 correlation = 0.5\non = \"ON\"\nmodes = 2\n[sides.floor]\ndisplacement = [0, 0]\n\
                 [sides.top]\ntraction = [\"LOAD\", -1]\n[grid]\ncoarse = [4, 4]\nfine = [1, 1]\n\
                 [stochastic]\nmethod = \"METHOD\"\n";
    let text = |young: &str, on: &str, load: &str, method: &str| {
        whole.replace("YOUNG", young).replace("ON", on).replace("LOAD", load).replace("METHOD", method)
    };
    assert!(parse(&text("exp(g)", "body", "0", "sparse"), &[]).is_ok());
    let loads = "[sides.floor]\ndisplacement = [0, 0]\n[sides.top]\ntraction = [\"0\", -1]\n";
    let medium = "[exterior]\nyoung = 1\npoisson = 0.3\nremote_stress = [1, 0, 0]\n";
    for (text, said) in [
        (text("exp(g)", "body", "0", "sparse").replace(loads, medium), "needs boundary elements: one material"),
        (text("exp(g)", "body", "0", "collocation"), "a body of its own"),
        (text("exp(g)", "body", "0", "collocation"), "method = \"sparse\""),
        (text("exp(g)", "body", "g", "sparse"), "means over the modulus cells"),
        (text("exp(g)", "top", "0", "sparse"), "of side \"top\""),
        (text("1 + g", "body", "0", "sparse"), "Young's modulus is -"),
        (text("1 + x", "body", "g", "galerkin"), "loads are random"),
        (text("exp(g)", "body", "0", "multilevel") + "[method]\nmodel = \"msfem\"\n", "a family of grids"),
    ] {
        let error = parse(&text, &[]).err().map(|e| e.render()).unwrap_or_default();
        assert!(error.contains(said), "{said}: {error}");
    }
    let mut scene = read(&text("exp(g)", "body", "0", "sparse"));
    scene.random.as_mut().expect("random input").stochastic.method = Sampling::Galerkin;
    assert!(scene.check().is_err());
}

/// A bar of random cells by a sparse grid and fresh outcomes: over many seeds the root mean square error of the mean is the
/// tolerance at most, the told standard error is that of the means, and the cost far below that of samples.
#[test]
fn corrected_means_scatter_by_their_standard_errors() {
    const SEEDS: u64 = 40;
    for (sigma, tolerance, most) in [(0.3, 0.01, 200), (0.8, 0.02, 1250)] {
        let mut scene = bar(8, 0.5, sigma, 4, "fem", 8);
        let v = covariance(&scene);
        let exact: f64 = v.iter().enumerate().map(|(i, row)| (0.5 * sigma * sigma * row[i]).exp() / 8.0).sum();
        let entry = |i: usize, j: usize| ((v[i][i] + v[j][j]) * 0.5 * sigma * sigma).exp() / 64.0;
        let of = |i: usize| (0..8).map(|j| entry(i, j) * ((sigma * sigma * v[i][j]).exp() - 1.0)).sum::<f64>();
        let deviation = (0..8).map(of).sum::<f64>().sqrt();
        let (mut squares, mut told, mut variances, mut of_variances) = (0.0, 0.0, 0.0, 0.0);
        for seed in 1..=SEEDS {
            let settings = &mut scene.random.as_mut().expect("random input").stochastic;
            (settings.method, settings.tolerance, settings.seed) = (Sampling::Corrected, tolerance, seed);
            let result = outcomes(&scene);
            let tip = quantity(&result, "probe.0.displacement.x");
            let error = tip.standard_error.expect("an error");
            squares += (tip.mean - exact).powi(2);
            told += error.powi(2);
            variances += tip.variance;
            of_variances += tip.variance_error.expect("an error").powi(2);
            // the tolerance is a part of the deviation that is told
            let within = error <= tolerance * tip.variance.sqrt();
            assert!(within && !result.is_doubtful(), "σ {sigma}, seed {seed}: {error}");
            assert!(result.solved < most, "σ {sigma}, seed {seed}: {} outcomes", result.solved);
        }
        let [rms, told] = [squares, told].map(|sum| (sum / SEEDS as f64).sqrt());
        println!("σ {sigma}: rms {} ε, told {} ε", rms / (tolerance * deviation), told / (tolerance * deviation));
        assert!(rms < 1.2 * tolerance * deviation, "σ {sigma}: {rms} {deviation}");
        assert!((0.7..1.4).contains(&(rms / told)), "σ {sigma}: {rms}, told {told}");
        // runs end where residuals are small by chance: heavy tails are rather missed, by less than each run tells
        let (variance, error) = (variances / SEEDS as f64, (of_variances / SEEDS as f64).sqrt());
        let exact = deviation * deviation;
        println!("σ {sigma}: variance {variance}, exact {exact}, told {error}");
        assert!((variance - exact).abs() < error && error < 0.25 * exact, "σ {sigma}: {variance} {exact} {error}");
    }
}

/// `max_nodes` bounds grid and outcomes together, and a tolerance that they do not reach is told.
#[test]
fn corrected_means_have_no_more_outcomes_than_allowed() {
    let mut scene = bar(8, 0.5, 0.8, 4, "fem", 8);
    for most in [1, 2, 5, 20, 40, 150] {
        let settings = &mut scene.random.as_mut().expect("random input").stochastic;
        (settings.method, settings.tolerance, settings.max_nodes) = (Sampling::Corrected, 0.01, most);
        let result = outcomes(&scene);
        assert!(result.solved <= most && result.points.len() == result.solved, "{most}: {}", result.solved);
        assert_eq!(result.end, End::MaxNodes, "{most}");
    }
}
