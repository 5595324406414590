//! Numbers that scenes ask for by names, judged by closed forms, equilibrium and other ways to them.

use std::f64::consts::PI;

use steklov_model::quantities::Quantity;
use steklov_model::run::expect::check_expect;
use steklov_problem::Scene;
use steklov_quadrature::gauss_legendre;
use steklov_tests::{parse, scene, summary as solved};

fn made(text: &str) -> Scene {
    parse(text, &[]).unwrap_or_else(|e| panic!("{}", e.render()))
}

/// Source: Westergaard (1939), bearing pressures and cracks; the integrals of his pressure by 200 Gauss points.
#[test]
fn numbers_of_westergaards_wave_are_inside_their_bars() {
    let known = [
        ("pressure.middle", 0.048822889424),
        ("contact.max_pressure", 0.048822889424),
        ("pressure.beside", 0.041764628826),
        ("mean_displacement.sinks.y", -0.04693421737431516),
        ("moment.turns", 0.0008564278933307158),
        ("opening.opens", 0.02 - 0.014671600245840428),
    ];
    let mut last = Vec::new();
    for tolerance in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
        let summary = solved(&scene("76-numbers-by-names", &[&format!("method.tolerance={tolerance}")]));
        last.clear();
        for (path, exact) in known {
            let Quantity { value, uncertainty, doubts, .. } = &summary.quantities[path];
            let error = (value - exact).abs();
            println!("{tolerance:e} {path}: {value} ± {uncertainty:.1e}, off by {error:.1e} {doubts:?}");
            assert!(
                error <= 2.0 * uncertainty && doubts.is_empty(),
                "{path} at {tolerance:e}: {error:e}, {uncertainty:e}"
            );
            last.push(uncertainty / exact.abs());
        }
    }
    assert!(last.iter().zip([1e-4, 1e-4, 1e-5, 1e-8, 1e-7, 1e-6]).all(|(bar, most)| *bar < most), "{last:?}");
}

/// With sin πx = sin πa sin θ Westergaard's pressure is (2p̄/π) cos²θ dθ: its work on sin 20x is a smooth integral.
#[test]
fn the_work_of_westergaards_pressure_on_a_wave_is_inside_its_bar() {
    let (mean, rule) = (0.017_261_498_096_647_21, gauss_legendre(60).mapped(0.0, PI / 2.0));
    let of = |(theta, weight): (&f64, &f64)| {
        let x = ((PI / 4.0).sin() * theta.sin()).asin() / PI;
        weight * 2.0 * mean / PI * theta.cos().powi(2) * (20.0 * x).sin()
    };
    let exact: f64 = rule.points.iter().zip(&rule.weights).map(of).sum();
    let wave = "quantities.wave={ weighted_force = \"floor\", weight = [0, \"sin(20*x)\"] }";
    for (tolerance, most) in [(1e-3, 1e-4), (1e-5, 1e-6)] {
        let summary = solved(&scene("76-numbers-by-names", &[&format!("method.tolerance={tolerance}"), wave]));
        let Quantity { value, uncertainty, .. } = summary.quantities["weighted_force.wave"];
        let error = (value - exact).abs();
        println!("{tolerance:e}: {value} ± {uncertainty:.1e}, off by {error:.1e}");
        assert!(error <= 2.0 * uncertainty && uncertainty < most * exact.abs(), "{error:e} and {uncertainty:e}");
    }
}

/// The moments of all reactions and of the loads about a point add up to zero: about the corner of a plate, and with a curved support.
#[test]
fn moments_balance_those_of_the_loads() {
    let plate = "body = { corners = [[0, 0], [2, 0], [2, 1], [0, 1]], sides = [\"floor\", \"right\", \"top\", \"left\"] }\n\
                 material = { young = 100, poisson = 0.3 }\nsides.right.traction = [0.3, -1]\n";
    // a force (0.3, -1) on x = 2, 0 < y < 1, about (0.5, 0.25)
    let load = -1.5 - 0.25 * 0.3;
    let ways = [
        ("sides.left.displacement = [0, 0]\n", vec!["left"], "1e-3"),
        ("sides.left.springs = { normal = 500, tangential = 200 }\n", vec!["left"], "1e-3"),
        (
            "sides.left.displacement = [0, \"free\"]\nsides.floor.springs = { normal = 30 }\nsides.top.contact.gap = 0\n",
            vec!["left", "floor", "top"],
            "1e-3",
        ),
    ];
    for (held, sides, tolerance) in ways {
        let asked: String = sides
            .iter()
            .map(|side| format!("quantities.{side} = {{ moment = \"{side}\", about = [0.5, 0.25] }}\n"))
            .collect();
        let summary = solved(&made(&format!("{plate}{held}{asked}method.tolerance = {tolerance}\n")));
        let sum: f64 = summary.named.moment.values().sum();
        assert!((sum + load).abs() < 1e-10, "{held}: {sum} and {load}, {:?}", summary.named.moment);
    }
    let disk = "body = { circle = { centre = [0, 0], radius = 1 }, side = \"rim\", holes = [{ circle = { centre = [0.2, 0], radius = 0.3 }, side = \"hub\" }] }\n\
                material = { young = 100, poisson = 0.3 }\nsides.hub.displacement = [0, 0]\nsides.rim.traction = [\"-y\", \"x\"]\n\
                quantities.hub = { moment = \"hub\", about = [0, 0] }\n";
    // the traction turns the rim: its moment is its length
    let exact = -2.0 * std::f64::consts::PI;
    for tolerance in [1e-2, 1e-4] {
        let summary = solved(&made(&format!("{disk}method.tolerance = {tolerance}\n")));
        let Quantity { value, uncertainty, .. } = &summary.quantities["moment.hub"];
        let error = (value - exact).abs();
        assert!(error <= *uncertainty && *uncertainty < 3.0 * tolerance, "{value} ± {uncertainty:e}, off by {error:e}");
    }
}

#[test]
fn what_is_none_of_the_scene_is_refused() {
    let plate = "body = { corners = [[0, 0], [2, 0], [2, 1], [0, 1]], sides = [\"floor\", \"right\", \"top\", \"left\"] }\n\
                 material = { young = 100, poisson = 0.3 }\nsides.right.traction = [0, -1]\nsides.left.displacement = [0, 0]\n";
    let cases = [
        (
            "quantities.p = { pressure_on = [0, 0.5] }",
            "unknown key quantities.p.pressure_on",
            "did you mean pressure_at?",
        ),
        ("quantities.p = {}", "quantities.p does not say what it is", "pressure_at = [x, y]"),
        ("quantities.p = { pressure_at = [0, 0.5], opening_at = [0, 0.5] }", "stands beside", "a quantity has one of"),
        ("quantities.p = { pressure_at = [1, 0.5] }", "(1, 0.5) is not on the boundary", "move the point onto it"),
        ("quantities.p = { pressure_at = [2, 1] }", "two sides meet", "along the side that is meant"),
        ("quantities.p = { pressure_at = [nan, 1] }", "its point is (NaN, 1)", "write finite coordinates"),
        ("quantities.u = { mean_displacement = \"tip\" }", "there is no side \"tip\"", "did you mean"),
        ("quantities.m = { moment = \"left\" }", "quantities.m.about is missing", "add about = [x, y]"),
        (
            "quantities.m = { moment = \"top\", about = [0, 0] }",
            "nothing but given loads acts on the side \"top\"",
            "support",
        ),
        (
            "quantities.m = { mean_displacement = \"top\", about = [0, 0] }",
            "quantities.m.about stands without moment",
            "remove it",
        ),
        ("quantities.o = { opening_at = [1, 0] }", "no second surface", "crack"),
        ("quantities.\"1 2\" = { opening_at = [1, 0] }", "the name \"1 2\"", "letters"),
        (
            "quantities.u = { pressure_at = [0, 0.5] }\ngrid = { coarse = [2, 1], fine = [4, 4] }\nmethod.model = \"msfem\"",
            "the body is on a grid",
            "[probe]",
        ),
        ("quantities.w = { weighted_force = \"left\" }", "quantities.w.weight is missing", "weight = [\"1\", \"0\"]"),
        (
            "quantities.w = { moment = \"left\", about = [0, 0], weight = [1, 0] }",
            "stands without weighted_force",
            "remove",
        ),
        (
            "random.g = { distribution = \"uniform\", low = 1, high = 2 }\nsides.top.pressure = \"g\"\n\
             quantities.w = { weighted_force = \"left\", weight = [\"g\", 0] }",
            "uses the random g",
            "of x and y alone",
        ),
        ("quantities.w = { weighted_force = \"left\", weight = [\"s\", 0] }", "uses s", "use x and y"),
        (
            "quantities.w = { weighted_force = \"left\", weight = [\"1/(y - 0.5)\", 0] }",
            "not finite at (0, 0.5)",
            "finite",
        ),
        (
            "quantities.w = { weighted_force = \"left\", weight = [\"if(y > 0.47, 1, 0)\", 0] }",
            "has a kink or a jump at (0, 0.47",
            "cut the side there",
        ),
        ("quantities.w = { weighted_force = \"top\", weight = [1, 0] }", "nothing but given loads", "support"),
        (
            "sides.floor.contact.gap = 0\nquantities.w = { weighted_force = \"floor\", weight = [1, 0] }\n\
             grid = { coarse = [2, 1], fine = [4, 4] }\nmethod.model = \"msfem\"",
            "on a grid a weighted force is that of a support",
            "whose displacement is given",
        ),
        (
            "quantities.u = { mean_displacement = \"top\" }\nexpect.\"mean_displacement.v.x\" = { value = 0, tol = 1 }",
            "no number at",
            "mean_displacement.u.x",
        ),
    ];
    for (text, message, help) in cases {
        let told = match parse(&format!("{plate}{text}\n"), &[]) {
            Err(error) => error.render(),
            Ok(scene) => {
                let error = check_expect(&scene).expect_err(text);
                format!("{error}: {}", error.help)
            }
        };
        assert!(told.contains(message) && told.contains(help), "{text}: {told}");
    }
    let cracked = plate
        .replace("body = {", "body = { cracks = [{ side = \"crack\", points = [[0.5, 0.4], [1, 0.5], [1.5, 0.4]] }],");
    let kink =
        parse(&format!("{cracked}quantities.o = {{ opening_at = [1, 0.5] }}\n"), &[]).expect_err("a kink").render();
    assert!(kink.contains("the surface turns") && kink.contains("along the part that is meant"), "{kink}");
}
