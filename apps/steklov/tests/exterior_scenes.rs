//! Holes in an unbounded medium, as a user asks for them: plan, what is told, stored and drawn, resumed, and refused.

use crate::place::Place;
use serde_json::Value;
use steklov_document::SceneErrorKind as Kind;
use steklov_io::{open, vtkhdf};
use steklov_problem::DataErrorKind;

/// A square and a triangle in the plane, under remote stress; the square is loaded too.
const HOLES: &str = r#"title = "Two holes"
[body]
corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
sides = ["floor", "wall", "roof", "wall"]
[[body.holes]]
corners = [[3.0, 0.0], [4.0, 0.5], [3.0, 1.5]]
sides = ["small", "small", "small"]
[exterior]
young = 8.0
poisson = 0.3
remote_stress = [-1.0, -2.0, 0.5]
[sides.floor]
traction = ["0", "-1"]
[sides.roof]
traction = ["0", "1"]
[probe]
points = [[2.0, 0.5], [0.0, 1.0], [50.0, 0.0]]
[method]
tolerance = 1e-3
"#;

fn place() -> Place {
    let place = Place::new();
    place.write("holes.toml", HOLES);
    place
}

#[test]
fn the_plan_says_what_is_unbounded() {
    let place = place();
    let plan = |set: &[&str]| place.run([&["plan", "holes.toml"], set].concat()).demand(0).out;
    let whole = plan(&[]);
    for part in [
        "boundary elements of the unbounded medium",
        "the displacement decays",
        "xx -1, yy -2, xy 0.5",
        "none is needed",
    ] {
        assert!(whole.contains(part), "{part}: {whole}");
    }
    let bounded = plan(&["--set", "exterior.at_infinity=\"bounded\"", "--set", "exterior.remote_stress=[0, 0, 0]"]);
    for part in ["tends to a constant", "translation along (1, 0) and translation along (0, 1) free", "remote stress"] {
        assert!(bounded.contains(part), "{part}: {bounded}");
    }
    assert!(!bounded.contains("rotation about") && bounded.contains("none (the scene has none)"), "{bounded}");
}

#[test]
fn what_happens_far_away_is_told() {
    let place = place();
    let told = place.run(["solve", "holes.toml", "--quiet"]).demand(0).out;
    assert!(told.contains("at infinity decaying: the forces on the medium are balanced"), "{told}");
    let pushed = ["solve", "holes.toml", "--quiet", "--force", "--set", "sides.roof.traction=[\"0\", \"5\"]"];
    let told = place.run(pushed).demand(0).out;
    for part in ["net force (", ", 8) on the medium", "grows as log(L/r)", "length L = 5.220153"] {
        assert!(told.contains(part), "{part}: {told}");
    }
    let o = place.json(0, &["holes.toml", "--set", "exterior.at_infinity=\"bounded\""]);
    assert_eq!((&o["exterior"]["radiation"], &o["exterior"]["balanced"]), (&"bounded".into(), &true.into()));
    assert!(o["exterior"]["constant"][1].as_f64().unwrap().abs() > 1e-3, "{}", o["exterior"]);
    let error = place.run([&pushed[..], &["--set", "exterior.at_infinity=\"bounded\""]].concat()).demand(1).err;
    assert!(error.contains("nothing holds the body against translation along"), "{error}");
}

/// The stored result is shown with the same bits, is continued to the same bits, and does not know the number of threads.
#[test]
fn results_are_the_same_bits_stored_resumed_and_with_more_threads() {
    let place = place();
    let without_times = |mut o: Value| {
        let object = o.as_object_mut().unwrap();
        ["seconds", "peak_memory_bytes", "file"].iter().for_each(|key| drop(object.remove(*key)));
        o
    };
    let whole = place.json(0, &["holes.toml", "--threads", "1"]);
    let shown = place.run(["show", "holes.vtkhdf", "--json"]).demand(0).json();
    let whole = without_times(whole);
    assert_eq!(whole, without_times(shown));
    assert!(whole["steps"].as_u64().unwrap() > 3);
    place.json(3, &["holes.toml", "--threads", "2", "--set", "method.max_steps=2"]);
    let resumed = place.json(0, &["holes.toml", "--resume"]);
    assert_eq!(whole, without_times(resumed));
}

/// The medium is drawn in a window whose edges are no boundary.
#[test]
fn a_window_of_the_medium_is_stored_and_drawn() {
    let place = place();
    place.run(["solve", "holes.toml", "--quiet", "--plots", "pictures"]).demand(0);
    assert!(crate::place::names(&place.path("pictures")).contains(&"holes-body.svg".to_owned()));
    let grid = vtkhdf::read(&open(place.path("holes.vtkhdf")).unwrap()).unwrap();
    let length = |[a, b]: [usize; 2]| {
        let (a, b) = (grid.points[a], grid.points[b]);
        (b[0] - a[0]).hypot(b[1] - a[1])
    };
    let outline: f64 = grid.lines.iter().map(|&line| length(line)).sum();
    let exact = 8.0 + 1.25f64.sqrt() + 2.0f64.sqrt() + 1.5;
    assert!((outline - exact).abs() < 1e-12 * exact, "{outline} {exact}");
    let area: f64 = grid
        .triangles
        .iter()
        .map(|&[a, b, c]| {
            let [a, b, c] = [a, b, c].map(|i| grid.points[i]);
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
        })
        .sum();
    // the box of the holes is 5 by 2.5, their largest distance √(5² + 2.5²)
    let margin = 3.0 * (25.0f64 + 2.25).sqrt();
    let window = (5.0 + margin) * (2.5 + margin) - 4.0 - 0.75;
    assert!((area - window).abs() < 1e-9 * window, "{area} {window}");
    let stress = grid.point_data.iter().find(|f| f.name == "stress").unwrap();
    assert!(stress.values.iter().all(|s| s.is_finite()));
    // at the corners of the window it is nearly the remote one
    let far = (0..grid.points.len()).filter(|&i| grid.points[i].iter().all(|c| c.abs() > 8.0));
    for i in far {
        let s = &stress.values[3 * i..][..3];
        assert!((s[0] + 1.0).abs() < 0.1 && (s[1] + 2.0).abs() < 0.1 && (s[2] - 0.5).abs() < 0.1, "{s:?}");
    }
}

#[test]
fn what_a_hole_cannot_have_is_refused_at_its_place() {
    for (from, to, kind, line, message) in [
        (
            "[probe]",
            "[body_force]\nvalue = [\"0\", \"-1\"]\n[probe]",
            Kind::Data(DataErrorKind::Unsupported),
            16,
            "cannot carry a body force",
        ),
        (
            "[-1.0, -2.0, 0.5]",
            "[-1.0, -2.0, 0.5]\ntraction_jump = [0, 1]",
            Kind::Data(DataErrorKind::Conflict),
            12,
            "needs a body",
        ),
        ("[3.0, 1.5]", "[0.0, 0.5]", Kind::Data(DataErrorKind::Geometry), 6, "cross"),
        (
            "[[3.0, 0.0], [4.0, 0.5], [3.0, 1.5]]",
            "[[0.0, 0.0], [0.5, 0.0], [0.0, 0.5]]",
            Kind::Data(DataErrorKind::Geometry),
            6,
            "in hole 1",
        ),
        (
            "[[3.0, 0.0], [4.0, 0.5], [3.0, 1.5]]",
            "[[3.0, 0.0], [4.0, 0.0], [5.0, 0.0]]",
            Kind::Data(DataErrorKind::Geometry),
            6,
            "of hole 2 lie on",
        ),
        ("[0.0, 1.0], [50", "[0.0, 0.9], [50", Kind::Data(DataErrorKind::Value), 17, "(0, 0.9) is not in the body"),
        (
            "[method]",
            "[method]\nmodel = \"fem-bem\"",
            Kind::Data(DataErrorKind::Conflict),
            19,
            "no [material] of a body",
        ),
    ] {
        assert!(HOLES.contains(from), "{from}");
        let error = steklov_document::parse(&HOLES.replace(from, to), "holes.toml", &[]).expect_err(message);
        assert_eq!((error.kind, error.line()), (kind, Some(line)), "{error}");
        assert!(error.render().contains(message), "{message}: {}", error.render());
    }
}

/// Every energy and displacement that the holes add is a multiple of 1/E.
#[test]
fn a_random_modulus_of_the_medium_has_the_mean_of_its_inverse() {
    let place = place();
    let random = HOLES
        .replace("young = 8.0", "young = \"E\"")
        .replace("tolerance = 1e-3", "refine = \"none\"\ndegree = 2")
        + "[random.E]\ndistribution = \"uniform\"\nlow = 6.0\nhigh = 10.0\n[stochastic]\nmethod = \"collocation\"\ndegree = 8\n\
           quantities = [\"energy\", \"probe.0.displacement.x\", \"probe.0.stress.0\"]\n";
    place.write("random.toml", &random);
    place.write("mean.toml", random.replace("young = \"E\"", "young = 8.0").split("[random.E]").next().unwrap());
    let found = place.json(0, &["random.toml"]);
    let mean = place.json(0, &["mean.toml"]);
    let inverse = (10.0f64 / 6.0).ln() / 4.0;
    let statistic = |path: &str| found.pointer(&format!("/stochastic/{path}")).and_then(Value::as_f64).unwrap();
    let energy = mean["energy"].as_f64().unwrap();
    assert!((statistic("energy/mean") / (8.0 * inverse * energy) - 1.0).abs() < 1e-9);
    let u = mean["probe"][0]["displacement"][0].as_f64().unwrap();
    assert!((statistic("probe/0/displacement/x/mean") / (8.0 * inverse * u) - 1.0).abs() < 1e-9);
    assert!(statistic("probe/0/stress/0/variance").abs() < 1e-20);
}

/// What a hole adds is quadratic in a random remote stress, and the stresses are linear.
#[test]
fn a_random_remote_stress_has_the_mean_of_its_square() {
    let place = place();
    let random = {
        let stress = HOLES.replace("[-1.0, -2.0, 0.5]", "[\"S\", \"2*S\", \"0.1*S\"]");
        let unloaded = stress.replace("traction = [\"0\", \"-1\"]", "traction = [0, 0]");
        let unloaded = unloaded.replace("traction = [\"0\", \"1\"]", "traction = [0, 0]");
        unloaded.replace("tolerance = 1e-3", "refine = \"none\"\ndegree = 2")
            + "[random.S]\ndistribution = \"uniform\"\nlow = -2.0\nhigh = -1.0\n[stochastic]\n\
               quantities = [\"energy\", \"probe.0.stress.0\"]\n"
    };
    place.write("random.toml", random);
    let found = place.json(0, &["random.toml"]);
    // the nominal outcome is that of the mean, -3/2
    let at = |path: &str| found.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path}: {found}"));
    let mean_square = (8.0 - 1.0) / 3.0;
    assert!((at("/stochastic/energy/mean") / at("/energy") - mean_square / 2.25).abs() < 1e-10);
    assert!((at("/stochastic/probe/0/stress/0/mean") / at("/probe/0/stress/0") - 1.0).abs() < 1e-10);
}
