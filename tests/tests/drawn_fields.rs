//! Fields of cells that are drawn without truncation, values that are independent from cell to cell, Matérn fields.

use steklov_problem::Sampling;
use steklov_tests::{outcomes, parse, quantity, read};

/// A bar of length 1 without lateral contraction, pulled by 1, of n × rows cells.
fn bar([n, rows]: [usize; 2], young: &str, field: &str, stochastic: &str) -> String {
    let h = 1.0 / n as f64;
    let height = h * rows as f64;
    format!(
        "title = \"bar\"\n[body]\ncorners = [[0, 0], [1, 0], [1, {height}], [0, {height}]]\n\
         sides = [\"bottom\", \"end\", \"top\", \"clamp\"]\n[material]\npoisson = 0\nplane = \"stress\"\n\
         [material.cells]\nsize = {h}\nyoung = \"{young}\"\n[random.g]\non = \"body\"\n{field}\n\
         [grid]\ncoarse = [{n}, {rows}]\nfine = [1, 1]\n[sides.clamp]\ndisplacement = [0, \"free\"]\n\
         [sides.bottom]\ndisplacement = [\"free\", 0]\n[sides.end]\ntraction = [1, 0]\n[method]\nmodel = \"fem\"\n\
         refine = \"none\"\n[probe]\npoints = [[1, 0]]\n[stochastic]\nseed = 3\n{stochastic}\n\
         quantities = [\"probe.0.displacement.x\"]\n"
    )
}

const TIP: &str = "probe.0.displacement.x";

/// Mean and variance of ∫ exp(-s g) over a length of 1 for the means g of a field with exp(-r/ℓ) over n cells.
fn exponential(n: usize, ell: f64, s: f64) -> [f64; 2] {
    let (h, q) = (1.0 / n as f64, 1.0 / (n as f64 * ell));
    let own = 2.0 * (q - 1.0 + (-q).exp()) / (q * q);
    let entry = |k: usize| {
        if k == 0 { own } else { ((1.0 - (-q).exp()) / q).powi(2) * (-q * (k as f64 - 1.0)).exp() }
    };
    let mean = (0.5 * s * s * own).exp();
    let pairs = (0..n * n).map(|k| (s * s * entry((k / n).abs_diff(k % n))).exp_m1()).sum::<f64>();
    [mean, mean * mean * h * h * pairs]
}

/// Untruncated means have the closed form of their cells, by samples, by corrected ones and by differences between grids.
#[test]
fn bars_of_drawn_cells_have_their_closed_forms() {
    let (n, ell, s) = (16, 0.5, 0.3);
    let [mean, variance] = exponential(n, ell, s);
    let field = "covariance = \"exponential\"\ncorrelation = [0.5, 1e9]\nmodes = \"all\"";
    for (method, expected) in [
        ("method = \"monte-carlo\"\nsamples = 4000", Sampling::MonteCarlo),
        ("method = \"corrected\"\ntolerance = 0.02", Sampling::Corrected),
        ("tolerance = 0.02", Sampling::Multilevel),
    ] {
        let scene = read(&bar([n, 4], "exp(0.3*g)", field, method));
        assert_eq!(scene.random.as_ref().unwrap().stochastic.method, expected);
        let result = outcomes(&scene);
        let tip = quantity(&result, TIP);
        let (error, variance_error) = (tip.standard_error.unwrap(), tip.variance_error.unwrap());
        let off = [(tip.mean - mean) / error, (tip.variance - variance) / variance_error];
        println!("{expected:?}: {off:?} standard errors, {} solved", result.solved);
        // the first samples of the seed, whose values are the logarithms over 0.3
        assert_eq!(result.moduli.iter().map(Vec::len).collect::<Vec<_>>(), [64; 5]);
        let logarithms = result.moduli.iter().flatten().map(|e| e.ln() / 0.3);
        assert!(logarithms.map(|g| g * g).sum::<f64>() / 320.0 < 3.0 && result.moduli[0] != result.moduli[1]);
        assert!(off.iter().all(|off| off.abs() < 3.5), "{expected:?}: {off:?}");
        assert!(error < 0.03 * variance.sqrt() && variance_error < 0.1 * variance);
        assert!(expected != Sampling::Multilevel || result.levels.len() > 1);
    }
}

/// Beside a field that is drawn polynomials have the other germs: the tip is ∫ exp(-s g)/a, a uniform on [½, 3/2].
#[test]
fn other_germs_keep_their_polynomials() {
    let [mean, variance] = exponential(16, 0.5, 0.3);
    let field = "covariance = \"exponential\"\ncorrelation = [0.5, 1e9]\nmodes = \"all\"\n\
                 [random.a]\ndistribution = \"uniform\"\nlow = 0.5\nhigh = 1.5";
    let result = outcomes(&read(&bar([16, 4], "a*exp(0.3*g)", field, "method = \"corrected\"\ntolerance = 0.02")));
    let (all, tip) = (3f64.ln() * mean, quantity(&result, TIP));
    let square = 4.0 / 3.0 * (variance + mean * mean) - all * all;
    let off = [(tip.mean - all) / tip.standard_error.unwrap(), (tip.variance - square) / tip.variance_error.unwrap()];
    println!("{off:?} standard errors");
    assert!(off.iter().all(|off| off.abs() < 3.5), "{off:?}");
    assert_eq!(result.kept, Some((vec![1], 0.0)));
}

/// Independent values: Σ h exp(-s g_i) has the mean exp(s²/2) and the variance h exp(s²) (exp(s²) - 1); a germ a cell, or drawn.
#[test]
fn bars_of_independent_cells_have_their_closed_forms() {
    let square = 0.3f64 * 0.3;
    let (mean, variance) = ((0.5 * square).exp(), square.exp() * square.exp_m1() / 12.0);
    let normal = "covariance = \"independent\"\nvariables = \"normal\"";
    let each = read(&bar([12, 1], "exp(0.3*g)", normal, ""));
    assert_eq!(each.random.as_ref().unwrap().germs.len(), 12);
    let drawn = read(&bar([12, 1], "exp(0.3*g)", &format!("{normal}\nmodes = \"all\""), "tolerance = 0.02"));
    assert_eq!(drawn.random.as_ref().unwrap().germs.len(), 1);
    for scene in [each, drawn] {
        let tip = outcomes(&scene);
        let tip = quantity(&tip, TIP);
        let off =
            [(tip.mean - mean) / tip.standard_error.unwrap(), (tip.variance - variance) / tip.variance_error.unwrap()];
        println!("{off:?}");
        assert!(off.iter().all(|off| off.abs() < 3.5), "{off:?}");
    }
    // 1/E is uniform between 1 and 2
    let uniform =
        bar([12, 1], "1/(1.5 + g/sqrt(12))", "covariance = \"independent\"", "method = \"galerkin\"\ndegree = 1");
    let refused = parse(&uniform, &[]).unwrap_err().render();
    assert!(refused.contains("needs a modulus that is affine"), "{refused}");
    let sparse = outcomes(&read(&uniform.replace("galerkin", "sparse").replace("degree", "level")));
    let tip = quantity(&sparse, TIP);
    assert!((tip.mean - 1.5).abs() < 1e-12 && (tip.variance - 1.0 / 144.0).abs() < 1e-12, "{}", tip.variance);
}

/// matern32 is matern with the smoothness 3/2; on cells any smoothness has modes.
#[test]
fn matern_fields_of_cells() {
    let tip = |field: &str| {
        let text = bar(
            [8, 8],
            "exp(0.3*g)",
            &format!("{field}\ncorrelation = 0.5\nmodes = 12"),
            "method = \"sparse\"\nlevel = 1",
        );
        let result = outcomes(&read(&text));
        (quantity(&result, TIP).mean, quantity(&result, TIP).variance)
    };
    let short = tip("covariance = \"matern32\"");
    assert_eq!(short, tip("covariance = \"matern\"\nsmoothness = 1.5"));
    let near = tip("covariance = \"matern\"\nsmoothness = 1.500001");
    assert!((short.1 / near.1 - 1.0).abs() < 1e-5 && short != near);
    let [rough, smooth] = [0.5, 3.0].map(|nu| tip(&format!("covariance = \"matern\"\nsmoothness = {nu}")).1);
    assert!(rough < short.1 && short.1 < smooth, "{rough} {} {smooth}", short.1);
}

#[test]
fn fields_that_make_no_sense_are_refused() {
    let cells = |field: &str, stochastic: &str| bar([4, 4], "exp(0.3*g)", field, stochastic);
    let exponential = "covariance = \"exponential\"\ncorrelation = 0.5\n";
    let all = format!("{exponential}modes = \"all\"");
    for (text, words) in [
        (cells(&all, "method = \"sparse\""), ["drawn without truncation", "method"]),
        (cells(&all, "method = \"galerkin\""), ["drawn without truncation", "method"]),
        (cells(&format!("{all}\nvariables = \"uniform\""), ""), ["uniform", "without truncation is normal"]),
        (cells(&format!("{exponential}smoothness = 1"), ""), ["smoothness", "another covariance than \"matern\""]),
        (cells("covariance = \"matern\"\ncorrelation = 0.5", ""), ["smoothness", "missing"]),
        (cells("covariance = \"matern\"\ncorrelation = 0.5\nsmoothness = 0.3", ""), ["smoothness", "from 0.5 to 10"]),
        (cells("covariance = \"independent\"\ncorrelation = 0.5", ""), ["correlation", "independent"]),
        (cells("covariance = \"independent\"\nmodes = 3", ""), ["modes", "independent"]),
        (cells("covariance = \"gaussian\"\ncorrelation = 60\nmodes = \"all\"", ""), ["torus", "number of modes"]),
        (
            cells(&all, "")
                .replace("young = \"exp(0.3*g)\"", "young = 1")
                .replace("[1, 0]\n[method", "[\"exp(g)\", 0]\n[method"),
            ["modes = \"all\"", "does not make the moduli of cells"],
        ),
        (
            cells("covariance = \"independent\"", "")
                .replace("young = \"exp(0.3*g)\"", "young = 1")
                .replace("[1, 0]\n[method", "[\"exp(g)\", 0]\n[method"),
            ["independent from cell to cell", "does not make the moduli of cells"],
        ),
    ] {
        let refused = parse(&text, &[]).expect_err(&text).render();
        assert!(words.iter().all(|word| refused.contains(word)), "{words:?}: {refused}");
    }
    // as many cells as have no germ each are drawn, and a library's user is told as well
    let mut scene = read(&cells(&all, ""));
    scene.random.as_mut().unwrap().stochastic.method = Sampling::Collocation;
    assert!(scene.check().unwrap_err().to_string().contains("drawn without truncation"));
}
