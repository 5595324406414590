//! Contact that begins between the points of a stochastic mesh and the ends of the germs, against closed forms: the mean is right
//! to what is told of it, or the result carries a doubt.

use crate::place::Place;
use serde_json::Value;

/// A column of length 1, E = 100 and Poisson's ratio 0 that hangs from its top. Its weight 20 stretches it by 0.1, so that a floor at
/// the distance g < 0.1 carries 100 (0.1 - g).
fn column(gap: &str, germs: usize, stochastic: &str) -> String {
    let germ = |name: char| format!("[random.{name}]\ndistribution = \"uniform\"\nlow = -1.0\nhigh = 1.0\n");
    let germs: String = "abc".chars().take(germs).map(germ).collect();
    format!(
        "title = \"A column\"\n[body]\ncorners = [[0, 0], [1, 0], [1, 1], [0, 1]]\n\
         sides = [\"floor\", \"right\", \"top\", \"left\"]\n[material]\nyoung = 100.0\npoisson = 0.0\n\
         [body_force]\nvalue = [\"0\", \"-20\"]\n[sides.top]\ndisplacement = [\"0\", \"0\"]\n\
         [sides.floor]\ncontact = {{ gap = \"{gap}\" }}\n{germs}[stochastic]\n\
         quantities = [\"contact.force.y\", \"energy\"]\n{stochastic}"
    )
}

/// The floor carries the sum of the germs less c, where that is positive: the gap, the probability and the mean, with the germs
/// within t of the corner where all are 1.
fn corner(germs: usize, t: f64) -> (String, [f64; 2]) {
    let sum = ["a", "a + b", "a + b + c"][germs - 1];
    let c = germs as f64 - t;
    let beyond = (t - 2.0).max(0.0);
    let (probability, mean) = match germs {
        1 => (t / 2.0, t * t / 4.0),
        2 => (t * t / 8.0, t * t * t / 24.0),
        _ => ((t.powi(3) - 3.0 * beyond.powi(3)) / 48.0, (t.powi(4) - 3.0 * beyond.powi(4)) / 192.0),
    };
    (format!("0.1 + 0.01*{c:?} - 0.01*({sum})"), [probability, mean])
}

/// What is told of a quantity: mean, error (with three standard errors) and whether the outcomes are in doubt.
fn told(o: &Value, path: &str) -> (f64, f64, bool) {
    let quantity = path.split('.').fold(&o["stochastic"], |v, key| &v[key]);
    let doubts = o["estimate_doubts"].as_array().unwrap();
    let truncation = quantity["truncation"].as_f64().unwrap_or(f64::INFINITY);
    let error = truncation + 3.0 * quantity["standard_error"].as_f64().unwrap_or(0.0);
    (quantity["mean"].as_f64().unwrap(), error, doubts.contains(&"outcomes".into()))
}

/// 1 to 3 germs, contact in 20, 4 or 1, and 0.1 % of the outcomes, each method with and without refinement.
#[test]
fn rare_contact_is_resolved_or_told() {
    let place = Place::new();
    let (mut worst, mut runs) = (0.0f64, 0);
    for (germs, corners) in [(1, &[0.4, 0.08, 0.002][..]), (2, &[1.26, 0.283, 0.0894]), (3, &[2.1345, 0.363])] {
        for &t in corners {
            let (gap, [probability, exact]) = corner(germs, t);
            // to the default tolerance where it is reached, and where it is not: 10,000 outcomes
            let corrected = match [0.4, 0.0894].contains(&t) {
                true => "method = \"corrected\"\n",
                false => "method = \"corrected\"\ntolerance = 0.05\n",
            };
            for (name, method) in [
                ("auto", ""),
                ("galerkin", "degree = 3\n"),
                ("corrected", corrected),
                ("collocation", "method = \"collocation\"\ndegree = 2\nelements = 2\n"),
                ("sparse", "method = \"sparse\"\n"),
                ("monte-carlo", "method = \"monte-carlo\"\nsamples = 1000\n"),
                ("adaptive", "refine = \"adaptive\"\ntolerance = 1e-3\n"),
            ] {
                place.write("column.toml", column(&gap, germs, method));
                // samples of the rarest contact do not reach their tolerance
                let ran = place.run(["solve", "--json", "--force", "--quiet", "column.toml"]);
                assert!(ran.status == 0 || ran.status == 3 && name == "corrected", "{gap} {name}: {}", ran.err);
                let o = ran.json();
                let (mean, error, doubt) = told(&o, "contact.force.y");
                let off = (mean - exact).abs();
                println!(
                    "{germs} germ(s), {probability:.4}, {name}: {mean:.3e}, exact {exact:.3e}, off {off:.1e} of {error:.1e}, doubt {doubt}"
                );
                assert!(off <= error + 1e-12, "{gap} {name}: {mean} is {off:.2e} off {exact}, told {error:.2e}");
                assert!(error < 0.5 || doubt, "{gap} {name}: {error}"); // told in the scale of the forces, not anything
                (worst, runs) = (worst.max(off / (error + 1e-12)), runs + 1);
                if name == "adaptive" {
                    let relative = o["stochastic"]["solution"]["truncation_relative"].as_f64().unwrap();
                    assert!(!doubt && relative <= 1e-3 && o["converged"] == true, "{gap}: {relative} {doubt}");
                }
            }
        }
    }
    println!("{runs} runs, error over what is told at most {worst:.2}");
}

/// One germ: the mesh is split where contact begins, and both sides are polynomials.
#[test]
fn the_place_where_contact_begins_is_found() {
    let place = Place::new();
    for t in [0.4, 0.08, 0.02] {
        let (gap, [_, exact]) = corner(1, t);
        place.write("column.toml", column(&gap, 1, "refine = \"adaptive\"\ntolerance = 1e-5\n"));
        let o = place.json(0, &["column.toml"]);
        let (mean, error, doubt) = told(&o, "contact.force.y");
        assert!((mean / exact - 1.0).abs() < 1e-9 && error < 1e-9 && !doubt, "{mean} {exact} {error} {doubt}");
        assert!(o["stochastic"]["solution"]["points"].as_u64().unwrap() <= 8);
    }
    // by default settings too
    let (gap, [_, exact]) = corner(1, 0.08);
    place.write("column.toml", column(&gap, 1, ""));
    let (mean, _, doubt) = told(&place.json(0, &["column.toml"]), "contact.force.y");
    assert!((mean / exact - 1.0).abs() < 1e-9 && !doubt, "{mean} {exact} {doubt}");
    // not looked for beyond the points: told
    place.write("column.toml", column(&gap, 1, "degree = 3\n"));
    let (mean, error, doubt) = told(&place.json(0, &["column.toml"]), "contact.force.y");
    assert!(mean == 0.0 && error > exact && doubt, "{mean} {error} {doubt}");
    let out = place.run(["solve", "--force", "column.toml"]).demand(0).out;
    assert!(
        out.contains("outcomes NOT RESOLVED") && out.contains("not reliable: ") && out.contains("outcomes)"),
        "{out}"
    );
}

/// A traction 10 on top in some outcomes of a column of modulus 100, half of 10²/100 each, where no point of degree 3 is: of one germ
/// the mesh is split where it begins, of two germs it is told how far the mean may be off.
#[test]
fn loads_that_act_in_few_outcomes_are_resolved_or_told() {
    let place = Place::new();
    let text = |germs: usize, load: &str| {
        column("1", germs, "")
            .replace("[body_force]\nvalue = [\"0\", \"-20\"]\n[sides.top]\ndisplacement = [\"0\", \"0\"]\n", "")
            .replace("contact = { gap = \"1\" }", "displacement = [\"0\", \"0\"]")
            .replace("[random.a]", &format!("[sides.top]\ntraction = [\"0\", \"{load}\"]\n[random.a]"))
            .replace("\"contact.force.y\", ", "")
    };
    for share in [0.05f64, 0.02, 1e-4] {
        let corner = 2.0 - (8.0 * share).sqrt();
        for (germs, load) in
            [(1, format!("if(a > {:?}, -10, 0)", 1.0 - 2.0 * share)), (2, format!("if(a + b > {corner:?}, -10, 0)"))]
        {
            for refine in ["none", "adaptive"] {
                place.write("load.toml", text(germs, &load));
                let key = format!("stochastic.refine=\"{refine}\"");
                let arguments =
                    ["solve", "--json", "--force", "load.toml", "--set", &key, "--set", "stochastic.tolerance=0.3"];
                // cells follow an oblique line slowly: no more nodes than allowed
                let ran = place.run(arguments);
                assert!(ran.status == 0 || ran.status == 3 && germs == 2 && refine == "adaptive", "{}", ran.err);
                let o = ran.json();
                assert_eq!(o["converged"], ran.status == 0);
                let (mean, error, doubt) = told(&o, "energy");
                let exact = -0.5 * share;
                println!("{share} {germs} {refine}: {mean:.4e}, exact {exact:.4e}, told {error:.1e}, doubt {doubt}");
                assert!((mean - exact).abs() <= error + 1e-12, "{load} {refine}: {mean} {exact} {error}");
                if germs == 1 {
                    assert!(
                        (mean / exact - 1.0).abs() < 1e-6 && !doubt && error < 1e-9,
                        "{load}: {mean} {error} {doubt}"
                    );
                } else {
                    assert!(doubt || error < 1.0, "{load}: {error}");
                    assert!(!doubt || refine == "none" || ran.status == 3, "{load}");
                }
            }
        }
    }
}

/// Gaps that are smaller by 0.02 in an interval of a germ, or where the sum of two is above a number, at random: the floor carries 1
/// there and nothing elsewhere.
#[test]
fn gaps_that_jump_at_random_are_resolved_or_told() {
    let place = Place::new();
    let (seed, mut runs, mut worst) = (20_261, 0, 0.0f64);
    let number = |k: u64| steklov_quadrature::unit_uniform(seed, k);
    for k in 0..4 {
        let start = 1.9 * number(2 * k) - 1.0;
        let width = [1e-3, 0.01, 0.1, 0.6][k as usize] * (0.5 + number(2 * k + 1));
        let end = (start + width).min(1.0);
        let (middle, half) = (0.5 * (start + end), 0.5 * (end - start));
        let oblique = if start > 0.0 { (2.0 - start).powi(2) / 8.0 } else { 1.0 - (2.0 + start).powi(2) / 8.0 };
        for (germs, gap, exact) in [
            (1, format!("if(abs(a - ({middle:?})) < {half:?}, 0.09, 0.11)"), half),
            (2, format!("0.11 - 0.02*(a > {start:?})"), 0.5 * (1.0 - start)),
            (2, format!("if(a + b > {start:?}, 0.09, 0.11)"), oblique),
        ] {
            for method in ["galerkin", "collocation", "sparse", "monte-carlo"] {
                place.write("gap.toml", column(&gap, germs, &format!("method = \"{method}\"\nsamples = 300\n")));
                let o = place.json(0, &["gap.toml"]);
                let (mean, error, doubt) = told(&o, "contact.force.y");
                let off = (mean - exact).abs();
                println!("{gap} {method}: {mean:.4e}, exact {exact:.4e}, off {off:.1e} of {error:.1e}, doubt {doubt}");
                assert!(off <= error + 1e-9 || doubt, "seed {seed}, {gap} {method}: off {off} of {error}");
                if ["galerkin", "collocation"].contains(&method) && !gap.contains('b') | gap.contains("(a >") {
                    assert!(off < 1e-9 && error < 1e-9 && !doubt, "seed {seed}, {gap} {method}: {off} {error} {doubt}");
                }
                (runs, worst) = (runs + 1, worst.max(if doubt { 0.0 } else { off / (error + 1e-9) }));
            }
        }
    }
    println!("{runs} runs, error over what is told at most {worst:.2}");
}

/// The nodes that the cuts make are counted before anything is solved; cuts that are ends of elements make none.
#[test]
fn the_plan_counts_the_elements_that_jumps_make() {
    let place = Place::new();
    for (gap, elements, nodes) in [
        ("0.09 + 0.02*(a > 0.3)", 1, 8),
        ("0.09 + 0.02*(a > 0)", 2, 8),
        ("0.09 + 0.02*(a > 0.3)", 2, 12),
        ("0.09 + 0.02*max(0, abs(a) - 0.5)", 1, 16),
        ("0.09 + 0.02*(a > 1.5)", 1, 4),
        ("0.09 + 0.02*(x > 0.5)*a", 1, 4),
    ] {
        place.write("gap.toml", column(gap, 1, &format!("elements = {elements}\n")));
        let scene = steklov_document::read(&place.path("gap.toml"), &[]).unwrap();
        assert_eq!(steklov_plan::points(&scene, scene.random.as_ref().unwrap()), f64::from(nodes), "{gap}");
        assert_eq!(place.json(0, &["gap.toml"])["stochastic"]["solution"]["solves"], nodes, "{gap}");
    }
}

/// A switch that no interval decides: what fresh outcomes cannot see is told, and only that.
#[test]
fn what_cannot_be_excluded_is_told() {
    let place = Place::new();
    for (method, samples) in [("galerkin", 8.0), ("sparse", 8.0), ("monte-carlo", 500.0)] {
        for (data, open) in [("max(a - a + 1e-9, 0)", true), ("max(a + 1.5, 0)", false)] {
            let gap = format!("0.05 + 0.01*{data}");
            let settings = format!("method = \"{method}\"\nsamples = 500\ntolerance = 0.1\n");
            place.write("gap.toml", column(&gap, 1, &settings));
            let o = place.json(0, &["gap.toml"]);
            let unseen = o["stochastic"]["solution"]["unseen"].as_f64();
            assert_eq!((unseen.is_some(), told(&o, "energy").2), (open, open), "{method} {data}");
            let least = 2.9 / (samples + 2.0);
            assert!(unseen.is_none_or(|p| p >= least && p <= 3.0 / samples), "{method}: {unseen:?}");
            let out = place.run(["solve", "--force", "gap.toml"]).demand(0).out;
            assert_eq!(out.contains("% of them cannot be excluded"), open, "{out}");
        }
    }
}

/// Nothing happens between the points: no doubt, and what is told is small; not 0 where degrees are left out.
#[test]
fn smooth_answers_have_no_doubt() {
    let place = Place::new();
    for (gap, method, most) in [
        ("0.05 + 0.01*a", "", 1e-12),
        ("0.05 + 0.01*a*b", "degree = 2\n", 1e-3),
        ("0.05 + 0.01*exp(a)", "", 5e-3),
        ("0.2 + 0.01*a - 0.02*b + 0.01*c", "degree = 1\n", 1e-12),
        ("0.2", "method = \"collocation\"\n", 1e-12),
        ("0.05 + 0.01*exp(a)", "method = \"sparse\"\n", 5e-3),
        ("0.05 + 0.01*a - 0.002*a*b", "method = \"monte-carlo\"\nsamples = 200\n", 1.0),
    ] {
        let germs = if gap.contains('c') { 3 } else { 2 };
        place.write("column.toml", column(gap, germs, method).replace("gap = \"0.2\"", "gap = \"0.2 + 0*a\""));
        let o = place.json(0, &["column.toml"]);
        let (_, error, doubt) = told(&o, "energy");
        let relative = o["stochastic"]["solution"]["truncation_relative"].as_f64().unwrap_or(error);
        println!("{gap}: told {error:.1e}, relative {relative:.1e}");
        if method != "degree = 1\n" {
            assert!(relative < most, "{gap}: {relative}");
        }
        assert!(!doubt, "{gap}");
    }
}

/// Beside quantiles stands what the polynomials leave out, in all that is printed and stored.
#[test]
fn quantiles_carry_their_truncation() {
    let place = Place::new();
    let (gap, _) = corner(1, 0.4);
    place.write("column.toml", column(&gap, 1, "degree = 3\n"));
    let solved = place.json(0, &["column.toml"]);
    let (_, error, _) = told(&solved, "contact.force.y");
    assert!(error > 1e-3);
    let shown = place.run(["show", "--json", "column.vtkhdf"]).demand(0).json();
    assert_eq!(shown["stochastic"], solved["stochastic"]);
    let out = place.run(["show", "column.vtkhdf"]).demand(0).out;
    let line = out.lines().find(|l| l.contains("contact.force.y: ")).unwrap();
    let truncation = line.split("truncation ").nth(1).and_then(|rest| rest.split([';', ',']).next()).unwrap();
    assert!((truncation.parse::<f64>().unwrap() - error).abs() <= 0.05 * error, "{error}: {line}");
}
