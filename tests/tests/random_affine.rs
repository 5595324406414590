//! Grids whose moduli are affine in the germs, solved for all outcomes at once: against another code, against sparse grids, and
//! in closed form.

use steklov_model::stochastic::{End, StochasticResult, json};
use steklov_problem::{Sampling, Scene};
use steklov_stochastic::{Recurrence, Variable};
use steklov_tests::{outcomes, parse, quantity, read};

/// Frequency of the k-th mode of exp(-|d|/ℓ) on [0, L] by bisection, and its eigenvalue.
fn mode(length: f64, correlation: f64, k: usize) -> (f64, f64) {
    let (a, c, pi) = (length / 2.0, 1.0 / correlation, std::f64::consts::PI);
    let f = |w: f64| match k % 2 {
        0 => c * (w * a).cos() - w * (w * a).sin(),
        _ => w * (w * a).cos() + c * (w * a).sin(),
    };
    let (mut low, mut high) = (k as f64 * pi / length + 1e-14, (k + 1) as f64 * pi / length - 1e-14);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if (f(low) > 0.0) == (f(middle) > 0.0) { low = middle } else { high = middle }
    }
    (low, 2.0 * c / (low * low + c * c))
}

const TIP: &str = "probe.0.displacement.y";

/// Number of a mode in one direction, its wave number, the length of the side.
type Factor = (usize, f64, f64);
/// √λ b as a function and as an expression.
type Mode = (Box<dyn Fn(f64, f64) -> f64>, String);

/// √λ b of the six largest product modes on [0, 2] × [0, 1], correlation ½, as functions and as expressions of x and y.
fn modes() -> Vec<Mode> {
    let mut all: Vec<(f64, [Factor; 2])> = Vec::new();
    for i in 0..8 {
        for j in 0..8 {
            let ((wx, lx), (wy, ly)) = (mode(2.0, 0.5, i), mode(1.0, 0.5, j));
            all.push((lx * ly, [(i, wx, 2.0), (j, wy, 1.0)]));
        }
    }
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let factor = |(k, w, length): Factor| {
        let (a, s) = (length / 2.0, (w * length).sin() / (2.0 * w));
        (k % 2 == 0, w, a, if k % 2 == 0 { a + s } else { a - s }.sqrt())
    };
    let made = |(eigenvalue, [x, y]): (f64, [Factor; 2])| {
        let (fx, fy) = (factor(x), factor(y));
        let one = |(even, w, a, norm): (bool, f64, f64, f64), x: f64| {
            let at = w * (x - a);
            (if even { at.cos() } else { at.sin() }) / norm
        };
        let text = |(even, w, a, norm): (bool, f64, f64, f64), x: &str| {
            format!("{}({w}*({x}-{a}))/{norm}", if even { "cos" } else { "sin" })
        };
        let whole = format!("{}*{}*{}", eigenvalue.sqrt(), text(fx, "x"), text(fy, "y"));
        let value = move |x: f64, y: f64| eigenvalue.sqrt() * one(fx, x) * one(fy, y);
        (Box::new(value) as Box<dyn Fn(f64, f64) -> f64>, whole)
    };
    all.into_iter().take(6).map(made).collect()
}

/// The plate [0, 2] × [0, 1] of n × n/2 cells, clamped and sheared, E = 1 + s Z; `part` is s over the largest s.
fn plate(n: usize, part: f64, stochastic: &str) -> Scene {
    let (modes, h, root) = (modes(), 2.0 / n as f64, 3f64.sqrt());
    let reach = |c: usize| {
        let (x, y) = (h * ((c / (n / 2)) as f64 + 0.5), h * ((c % (n / 2)) as f64 + 0.5));
        modes.iter().map(|(b, _)| root * b(x, y).abs()).sum::<f64>()
    };
    let s = part / (0..n * n / 2).map(reach).fold(0.0, f64::max);
    let sum: Vec<String> = modes.iter().enumerate().map(|(m, (_, text))| format!("g{m}*{text}")).collect();
    let random: String = (0..6)
        .map(|m| format!("[random.g{m}]\ndistribution = \"uniform\"\nlow = {}\nhigh = {root}\n", -root))
        .collect();
    read(&format!(
        "title = \"plate\"\n[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\n\
         sides = [\"bottom\", \"right\", \"top\", \"left\"]\n[material]\npoisson = 0.3\n\
         [material.cells]\nsize = {h}\nyoung = \"1 + {s}*({})\"\n{random}[sides.left]\ndisplacement = [0, 0]\n\
         [sides.right]\ntraction = [0, -1]\n[grid]\ncoarse = [{n}, {}]\nfine = [1, 1]\n[method]\nrefine = \"none\"\n\
         [probe]\npoints = [[2, 0.5]]\n[stochastic]\nquantities = [\"probe.0.displacement.y\"]\nsamples = 100\n\
         max_nodes = 100000\n{stochastic}\n",
        sum.join(" + "),
        n / 2
    ))
}

/// Mean and variance of the tip of another code, numpy with banded factors, degrees 1 to 3 at .6 and .9 of the largest s; the told
/// truncation is more than the error of mean and deviation against its sparse grid of level 6.
#[test]
fn plates_are_those_of_another_code() {
    let gold = [
        (
            0.6,
            [
                (-35.000397407831414, 8.989527338412984),
                (-35.01624330214747, 9.5742200146904),
                (-35.01685376095025, 9.603574464779165),
            ],
        ),
        (
            0.9,
            [
                (-35.71666111014227, 21.06281690749081),
                (-35.80357662837367, 24.390503813765275),
                (-35.811869328339554, 24.812201264301212),
            ],
        ),
    ];
    let level_6 = [(-35.01688347940003, 9.605325036673028f64), (-35.81300716532132, 24.885509313039883)];
    for ((part, of_degrees), (exact, spread)) in gold.into_iter().zip(level_6) {
        for (degree, (mean, variance)) in (1..).zip(of_degrees) {
            let scene = plate(32, part, &format!("method = \"galerkin\"\ndegree = {degree}"));
            let result = outcomes(&scene);
            let tip = quantity(&result, "probe.0.displacement.y");
            println!(
                "{part} degree {degree}: {} iterations, mean {:e}, variance {:e}, truncation {:?}, measured {:?}, told {:?}",
                result.iterations,
                tip.mean / mean - 1.0,
                tip.variance / variance - 1.0,
                result.truncation,
                result.truncation_measured,
                tip.truncation.map(|t| t / tip.variance.sqrt())
            );
            let (off, off_deviation) = (tip.mean - exact, tip.variance.sqrt() - spread.sqrt());
            let told = tip.truncation.unwrap_or_default();
            assert!(told > off.abs() && told > off_deviation.abs(), "{told:e} told of {off:e} and {off_deviation:e}");
            assert!((tip.mean / mean - 1.0).abs() < 1e-8 && (tip.variance / variance - 1.0).abs() < 1e-8);
        }
    }
}

/// A bar of two halves in tension or pulled by a given displacement, each with a modulus 1 + s g of its own.
fn bar(young: &str, end: &str, stochastic: &str) -> Scene {
    read(&bar_text(young, end, stochastic))
}

fn bar_text(young: &str, end: &str, stochastic: &str) -> String {
    format!(
        "title = \"bar\"\n[body]\ncorners = [[0, 0], [1, 0], [1, 0.25], [0, 0.25]]\n\
         sides = [\"bottom\", \"end\", \"top\", \"clamp\"]\n[material]\npoisson = 0\n[material.cells]\nsize = 0.125\n\
         young = \"{young}\"\n[random.a]\ndistribution = \"uniform\"\nlow = 0\nhigh = 2\n\
         [random.b]\ndistribution = \"beta\"\nalpha = 2\nbeta = 3\nlow = -1\nhigh = 1\n\
         [grid]\ncoarse = [8, 2]\nfine = [1, 1]\n[sides.clamp]\ndisplacement = [0, \"free\"]\n\
         [sides.bottom]\ndisplacement = [\"free\", 0]\n[sides.end]\n{end}\n[method]\nrefine = \"none\"\n\
         [probe]\npoints = [[1, 0], [0.3, 0.1]]\n[stochastic]\nmethod = \"galerkin\"\nsamples = 1000\n\
         quantities = [\"energy\", \"strain_energy\", \"probe.0.displacement.x\", \"probe.1.stress.xx\", \
         \"reactions.clamp.x\"]\n{stochastic}\n"
    )
}

/// Mean and variance by the Gauss rule of n points: of 1/E those that polynomials of degree n - 1 have by Galerkin.
fn of_gauss(variable: &Variable, value: &dyn Fn(f64) -> f64, n: usize) -> [f64; 2] {
    let rule = Recurrence::new(variable, variable.germ_support(), n).unwrap().gauss(n).unwrap();
    let moment = |k: i32| rule.points.iter().zip(&rule.weights).map(|(&x, w)| w * value(x).powi(k)).sum::<f64>();
    [moment(1), moment(2) - moment(1).powi(2)]
}

/// In tension the stress is 1 in all outcomes, and u = ∫ dx/E: the projections of both halves add up.
#[test]
fn bars_in_tension_have_the_moments_of_gauss_rules() {
    for degree in [1, 2, 5] {
        let scene =
            bar("if(x < 0.5, 1 + 0.6*(a - 1), 2 + b*(1.5 - x))", "traction = [1, 0]", &format!("degree = {degree}"));
        let result = outcomes(&scene);
        let variables: Vec<Variable> =
            scene.random.as_ref().unwrap().germs.iter().map(|g| g.variable.clone()).collect();
        // f(J) of the Jacobi matrix J in the germ of a half is the Gauss rule of f; the cells of the right half differ
        let left = |a: f64| 0.5 / (1.0 + 0.6 * (a - 1.0));
        let right = |b: f64| (0..4).map(|k| 0.125 / (2.0 + b * (0.9375 - 0.125 * f64::from(k)))).sum::<f64>();
        let [left, right] = [of_gauss(&variables[0], &left, degree + 1), of_gauss(&variables[1], &right, degree + 1)];
        let (mean, variance) = (left[0] + right[0], left[1] + right[1]);
        let tip = quantity(&result, "probe.0.displacement.x");
        assert!((tip.mean - mean).abs() < 1e-12, "degree {degree}: {} {mean}", tip.mean);
        assert!((tip.variance / variance - 1.0).abs() < 1e-10, "degree {degree}: {} {variance}", tip.variance);
        let effects = tip.effects.as_ref().unwrap();
        assert!((effects[0] - left[1] / variance).abs() < 1e-10 && (effects[1] + effects[0] - 1.0).abs() < 1e-10);
        for (name, exact, spread) in [
            ("energy", -0.125 * mean, 0.125 * variance.sqrt()),
            ("strain_energy", 0.125 * mean, 0.125 * variance.sqrt()),
            ("probe.1.stress.xx", 1.0, 0.0),
            ("reactions.clamp.x", -0.25, 0.0),
        ] {
            let q = quantity(&result, name);
            let deviation = q.variance.sqrt();
            assert!(
                (q.mean - exact).abs() < 1e-11 && (deviation - spread).abs() < 1e-10,
                "{name}: {} {deviation}",
                q.mean
            );
            assert!(spread > 0.0 || q.quantiles.is_none() && q.effects.is_none(), "{name}");
        }
        let body = result.in_body.as_ref().unwrap();
        assert!(body.stress.mean.chunks(3).all(|s| (s[0] - 1.0).abs() < 1e-11 && s[1].abs() + s[2].abs() < 1e-11));
        assert!(body.stress.variance.iter().all(|v| *v < 1e-20), "{:?}", body.stress.variance);
        assert_eq!(result.displacement.mean.len(), 2 * 20);
    }
}

/// Pulled by 1, with one modulus 1 + 0.6 (a - 1) everywhere: u = x, the stress is the modulus, the energy half of it on ¼.
#[test]
fn prescribed_displacements_make_affine_stresses() {
    let scene = bar("1 + 0.6*(a - 1) + 0*b", "displacement = [1, \"free\"]", "degree = 2");
    let result = outcomes(&scene);
    let spread = 0.6 / 3f64.sqrt();
    for (name, mean, deviation) in [
        ("energy", 0.125, 0.125 * spread),
        ("strain_energy", 0.125, 0.125 * spread),
        ("probe.0.displacement.x", 1.0, 0.0),
        ("probe.1.stress.xx", 1.0, spread),
        ("reactions.clamp.x", -0.25, 0.25 * spread),
    ] {
        let q = quantity(&result, name);
        assert!((q.mean - mean).abs() < 1e-12, "{name}: {}", q.mean);
        assert!((q.variance.sqrt() - deviation).abs() < 1e-11, "{name}: {}", q.variance.sqrt());
    }
    let median = quantity(&result, "probe.1.stress.xx").quantiles.as_ref().unwrap()[1];
    assert!((median - 1.0).abs() < 0.05, "{median}");
    let told = json(scene.random.as_ref().unwrap(), &result);
    assert_eq!((told["solution"]["method"].as_str(), told["solution"]["blocks"].as_u64()), (Some("galerkin"), Some(6)));
}

/// Without a degree one is taken with which the means have the tolerance, at most one above the lowest such one; tight
/// tolerances of a modulus that is affine, positive and of few germs have it by default.
#[test]
fn a_degree_is_found_for_a_tolerance() {
    let of_degree =
        |part: f64, degree: usize| outcomes(&plate(8, part, &format!("method = \"galerkin\"\ndegree = {degree}")));
    // with errors of less than a twentieth of the tolerances
    let references = [(0.3, 4), (0.9, 6)].map(|(part, degree)| (part, of_degree(part, degree)));
    for (part, tolerance, method) in
        [(0.3, 3e-4, ""), (0.9, 4e-3, ""), (0.9, 2e-4, ""), (0.9, 0.02, "method = \"galerkin\"")]
    {
        let scene = plate(8, part, &format!("tolerance = {tolerance}\n{method}"));
        assert_eq!(scene.random.as_ref().unwrap().stochastic.method, Sampling::Galerkin);
        let (_, exact) = references.iter().find(|(of, _)| *of == part).unwrap();
        let reference = quantity(exact, TIP);
        let off = |result: &StochasticResult| {
            let tip = quantity(result, TIP);
            [
                (tip.mean - reference.mean).abs() / reference.variance.sqrt(),
                ((tip.variance / reference.variance).sqrt() - 1.0).abs(),
            ]
        };
        let own = outcomes(&scene);
        let (degree, error) = (own.cells.as_ref().unwrap().degree[0][0], off(&own));
        println!("{part} {tolerance}: degree {degree}, mean and deviation off by {error:?}");
        assert!(own.end == End::Tolerance && error[0] < tolerance && error[1] < 3.0 * tolerance, "{error:?}");
        if degree > 2 {
            let lower = off(&of_degree(part, degree - 2));
            assert!(lower[0] > tolerance, "{part} {tolerance}: {degree} is too high, two less have {lower:?}");
        }
    }
    // a modulus that nearly vanishes: means of 1/(1 + c a) within the tolerance, or it is told that they are not
    for (c, tolerance, end) in [(0.9, 0.01, End::Tolerance), (0.99, 1e-4, End::Tolerance), (0.999, 1e-8, End::Rounds)] {
        let young = format!("1 + {c}*(a - 1)");
        let result = outcomes(&bar(&young, "traction = [1, 0]", &format!("tolerance = {tolerance}")));
        let tip = quantity(&result, "probe.0.displacement.x");
        let mean = f64::atanh(c) / c;
        let off = (tip.mean - mean).abs() / (1.0 / (1.0 - c * c) - mean * mean).sqrt();
        println!("{c} {tolerance}: off by {off:e}, {:?}", result.end);
        assert!(
            result.end == end && (off < tolerance || end == End::Rounds),
            "{c} {tolerance}: {off:e} {:?}",
            result.end
        );
    }
    let mut scene = plate(8, 0.9, "tolerance = 1e-6");
    scene.random.as_mut().unwrap().stochastic.max_nodes = 100;
    let cut = outcomes(&scene);
    assert!(cut.end == End::MaxNodes && cut.solved == 84, "{:?} {}", cut.end, cut.solved);
    let method = |young: &str, end: &str, more: &str| {
        let text = bar_text(young, end, more).replace("method = \"galerkin\"\n", "");
        let text = text.replace("[0, \"free\"]\n[sides.bottom]\ndisplacement = [\"free\", 0]", "[0, 0]");
        parse(&text, &[]).unwrap().random.unwrap().stochastic.method
    };
    let (affine, tension) = ("1 + 0.1*a + 0.1*b", "traction = [1, 0]");
    assert_eq!(method(affine, tension, "tolerance = 0.001"), Sampling::Galerkin);
    for (young, end, more) in [
        (affine, tension, "tolerance = 0.01"),
        (affine, tension, ""),
        ("exp(0.1*a + 0.1*b)", tension, "tolerance = 0.001"),
        (affine, "contact = { gap = \"0.1\" }", "tolerance = 0.001"),
        (affine, "traction = [\"a\", 0]", "tolerance = 0.001"),
    ] {
        assert_eq!(method(young, end, more), Sampling::Corrected, "{young} {end} {more}");
    }
}

#[test]
fn what_galerkin_cannot_treat_is_refused_by_name() {
    let tension = "traction = [1, 0]";
    let uniform = "1 + 0.1*a + 0.1*b";
    let message = |text: Result<(), String>| text.err().unwrap_or_default();
    let check = |young: &str, end: &str, more: &str, change: &dyn Fn(String) -> String| {
        let text = change(bar_text(young, end, more));
        message(parse(&text, &[]).map(drop).map_err(|e| e.render()))
    };
    let same = |text: String| text;
    for (young, end, more, change, said) in [
        ("exp(a) + b", tension, "", &same as &dyn Fn(String) -> String, "affine in the germs"),
        ("1 + a*b", tension, "", &same, "affine in the germs"),
        (uniform, "traction = [\"a\", 0]", "", &same, "loads are random"),
        (uniform, "displacement = [\"a\", \"free\"]", "", &same, "prescribed displacements are random"),
        (uniform, "contact = { gap = \"0.1\" }", "", &same, "in contact outcomes differ"),
        (uniform, tension, "elements = 2", &same, "one polynomial over all germs"),
        ("1.5 + b - 0.4*(a - 1)*2", tension, "", &same, "where all germs are at their ends"),
        (
            uniform,
            tension,
            "",
            &|t| {
                t.replace(
                    "distribution = \"uniform\"\nlow = 0\nhigh = 2",
                    "distribution = \"normal\"\nmean = 0\ndeviation = 0.1",
                )
            },
            "needs bounded germs",
        ),
        (uniform, tension, "", &|t| t.replace("[method]", "[method]\nmodel = \"msfem\""), "bilinear elements"),
        (
            uniform,
            tension,
            "",
            &|t| t.replace("poisson = 0\n", "").replace("young =", "poisson = \"0.1*a\"\nyoung ="),
            "Poisson's ratio is random",
        ),
    ] {
        let error = check(young, end, more, change);
        assert!(error.contains(said), "{said}: {error}");
    }
    assert_eq!(check(uniform, tension, "", &same), "");
}

/// A modulus that nearly vanishes inside of a pulled body, and the means of its displacements by 300 Gauss points of another code.
const INSIDE: &str = "1 + 0.995*a*if(x < 1.75, if(y < 0.75, if(y > 0.25, 1, 0), 0), 0)";
const PULLED: &str = "[sides.left]\ndisplacement = [0, 0]\n[sides.right]\ntraction = [1, 0.01]\n";
const KNOWN: [f64; 3] = [0.1314424, 0.1433016, 0.0043643];

fn weak(young: &str, sides: &str, stochastic: &str) -> String {
    format!(
        "title = \"weak\"\n[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"bottom\", \"right\", \"top\", \"left\"]\n\
         [material]\npoisson = 0.3\n[material.cells]\nsize = 0.25\nyoung = \"{young}\"\n[grid]\ncoarse = [8, 4]\nfine = [1, 1]\n\
         {sides}[probe]\npoints = [[1, 0.5], [0.5, 0.25], [1.5, 1]]\n[method]\nrefine = \"none\"\n\
         [random.a]\ndistribution = \"uniform\"\nlow = -1\nhigh = 1\n[stochastic]\nquantities = [\"probe.0.displacement.y\", \
         \"probe.1.displacement.y\", \"probe.2.displacement.y\"]\n{stochastic}\n"
    )
}

/// Fresh outcomes that correct polynomials seldom lie where the modulus nearly vanishes; standard errors have what the ends of
/// the germ show of that.
#[test]
fn standard_errors_have_the_tails_that_outcomes_miss() {
    let off: Vec<[f64; 3]> = (1..=30)
        .map(|seed| {
            let method = format!("method = \"corrected\"\ntolerance = 0.05\nseed = {seed}");
            let result = outcomes(&read(&weak(INSIDE, PULLED, &method)));
            [0, 1, 2].map(|k| (result.quantities[k].mean - KNOWN[k]) / result.quantities[k].standard_error.unwrap())
        })
        .collect();
    for k in 0..3 {
        let rms = (off.iter().map(|off| off[k].powi(2)).sum::<f64>() / off.len() as f64).sqrt();
        let most = off.iter().fold(0.0f64, |most, off| most.max(off[k].abs()));
        println!("{k}: {rms} standard errors in the mean square, {most} at most");
        assert!((0.4..1.6).contains(&rms) && most < 5.0, "{k}: {rms} {most}");
    }
}

/// A modulus that nearly vanishes in a part of the body shows in no coefficient of a low degree: the ends of the germ do. Against
/// Galerkin of degree 48, and by Gauss rules of 300 points of another code.
#[test]
fn a_weak_part_is_seen_at_the_ends_of_the_germs() {
    let held = "[sides.left]\ndisplacement = [\"0.01*y\", \"free\"]\n[sides.bottom]\ndisplacement = [\"free\", \"0.02*x\"]\n\
                [sides.right]\ndisplacement = [0.1, \"free\"]\n";
    let corner = "1 + 0.99*a*if(x < 1, if(y < 0.5, 1, 0), 0)";
    for (young, sides, tolerance, known) in [
        (INSIDE, PULLED, 0.05, Some(KNOWN)),
        (INSIDE, PULLED, 0.01, None),
        (corner, held, 0.01, None),
        (corner, held, 0.001, None),
        (corner, held, 0.0003, None),
    ] {
        let scene = read(&weak(young, sides, &format!("method = \"galerkin\"\ntolerance = {tolerance}")));
        let mut fixed = scene.clone();
        let settings = &mut fixed.random.as_mut().unwrap().stochastic;
        (settings.of_deviation, settings.degree) = (false, 48);
        let (own, exact) = (outcomes(&scene), outcomes(&fixed));
        for (k, (own, exact)) in own.quantities.iter().zip(&exact.quantities).enumerate() {
            let off = (own.mean - exact.mean).abs() / exact.variance.sqrt();
            // the root mean square of what is left out is at least this
            let left_out = (exact.variance.sqrt() - own.variance.sqrt()).abs();
            let truncation = own.truncation.unwrap();
            println!("{tolerance}, {k}: mean off by {off:e}, deviation by {left_out:e}, truncation {truncation:e}");
            assert!(off < tolerance && left_out < truncation, "{k}: {off:e} {left_out:e} {truncation:e}");
            if let Some(known) = known {
                assert!((exact.mean - known[k]).abs() < 1e-6, "{k}: {} {}", exact.mean, known[k]);
            }
        }
        println!("degree {}, {:?}", own.cells.as_ref().unwrap().degree[0][0], own.end);
        assert_eq!(own.end, End::Tolerance);
    }
}

/// 1/(1 + c a) by a sparse grid of level 2: the deviation is off by less than the truncation, and where that is more than the
/// deviation the outcomes are in doubt.
#[test]
fn sparse_grids_know_the_tails_that_outcomes_miss() {
    for c in [0.5, 0.9, 0.99, 0.999, 0.9999] {
        let text = bar_text(&format!("1 + {c}*(a - 1)"), "traction = [1, 0]", "level = 2");
        let result = outcomes(&read(&text.replace("\"galerkin\"", "\"sparse\"")));
        let tip = quantity(&result, "probe.0.displacement.x");
        let mean = f64::atanh(c) / c;
        let deviation = (1.0 / (1.0 - c * c) - mean * mean).sqrt();
        let (own, truncation) = (tip.variance.sqrt(), tip.truncation.unwrap());
        println!("{c}: mean {} of {mean}, deviation {own} of {deviation}, truncation {truncation}", tip.mean);
        assert!((own - deviation).abs() < truncation && (tip.mean - mean).abs() < truncation, "{c}: {truncation}");
        assert_eq!(result.is_doubtful(), truncation > own, "{c}: {truncation} {own}");
    }
}

/// A component that symmetry makes zero does not raise the degree: rounding is relative to the vector.
#[test]
fn quantities_that_are_zero_do_not_raise_the_degree() {
    let text = "title = \"symmetric\"\n[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"bottom\", \"right\", \"top\", \"left\"]\n\
                [material]\npoisson = 0.3\n[material.cells]\nsize = 0.125\nyoung = \"1 + 0.5*a*if(x < 1, 1, 0) + 0.5*b*if(x < 1, 0, 1)\"\n\
                [grid]\ncoarse = [16, 8]\nfine = [1, 1]\n[sides.left]\ndisplacement = [0, 0]\n[sides.right]\ntraction = [1, 0]\n\
                [probe]\npoints = [[2, 0.5]]\n[method]\nrefine = \"none\"\n[random]\na = { distribution = \"uniform\", low = -1, high = 1 }\n\
                b = { distribution = \"uniform\", low = -1, high = 1 }\n[stochastic]\nmethod = \"galerkin\"\n\
                quantities = [\"probe.0.displacement.x\", \"probe.0.displacement.y\"]\n";
    let result = outcomes(&read(text));
    assert!(result.end == End::Tolerance && result.solved < 20, "{:?} {}", result.end, result.solved);
}
