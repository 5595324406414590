//! Error bars of means over outcomes of random input, in their parts: judged by closed forms, fine meshes and many points.

use steklov_model::quantities::Quantity;
use steklov_model::summary::Summary;
use steklov_tests::parse;

const SQUARE: &str =
    "body = { corners = [[0, 0], [1, 0], [1, 1], [0, 1]], sides = [\"lower\", \"right\", \"upper\", \"left\"] }\n";

/// A cantilever under a load q = 1 + 0.3 g, of the modulus 1/(1 + 0.5 h): g and h uniform from -1 to 1.
const CANTILEVER: &str = "material = { young = \"1/(1 + 0.5*h)\", poisson = 0.3 }
random.h = { distribution = \"uniform\", low = -1, high = 1 }
random.g = { distribution = \"uniform\", low = -1, high = 1 }
sides.left.displacement = [0, 0]
sides.right.traction = [0, \"0.01*(1 + 0.3*g)\"]
probe.points = [[0.3, 0.6], [1, 0.5]]
stochastic.quantities = [\"energy\", \"probe.0.stress.xx\", \"probe.1.displacement.y\", \"reactions.left.y\"]
";

fn solved(text: &str, settings: &[&str]) -> Summary {
    let scene = parse(text, settings).unwrap_or_else(|e| panic!("{}\n{text}", e.render()));
    steklov_model::solve(&scene).unwrap_or_else(|e| panic!("{e}\n{text}")).summary
}

fn bar<'a>(summary: &'a Summary, path: &str) -> &'a Quantity {
    let path = format!("stochastic.{path}.mean");
    summary.quantities.get(&path).unwrap_or_else(|| panic!("no bar of {path}: {:?}", summary.quantities.keys()))
}

/// The difference from an exact mean is within the bar, and the bar is the sum of its parts.
fn check(summary: &Summary, path: &str, exact: f64) -> f64 {
    let Quantity { value, uncertainty, parts, .. } = bar(summary, path);
    let error = (value - exact).abs();
    println!("{path}: {value} for {exact}, off by {error:.2e}, {uncertainty:.2e} = {parts:?}");
    assert_eq!(summary.at(&format!("stochastic.{path}.mean")), Some(*value));
    let sum: f64 = parts.values().sum();
    assert!((sum - uncertainty).abs() <= 1e-12 * uncertainty, "{path}: {sum} and {uncertainty}");
    assert!(error <= *uncertainty, "{path}: {value} for {exact}, off by {error:e}, bar {uncertainty:e}");
    *uncertainty
}

/// The means of the numbers of a cantilever that are known from the same one without random input: J goes like q²/E, displacements like
/// q/E, stresses like q.
fn exact_means() -> [(&'static str, f64); 4] {
    let text = format!("{SQUARE}{}", CANTILEVER.split("stochastic").next().expect("a part"))
        .replace("\"1/(1 + 0.5*h)\"", "1")
        .replace("\"0.01*(1 + 0.3*g)\"", "0.01");
    let text: String =
        text.lines().filter(|line| !line.starts_with("random")).map(|line| format!("{line}\n")).collect();
    let fine = solved(&text, &["method.tolerance=1e-7", "method.max_dofs=3000"]);
    let of = |path: &str| fine.at(path).expect("a number");
    [
        ("energy", of("energy") * (1.0 + 0.09 / 3.0)),
        ("probe.0.stress.xx", of("probe.0.stress.xx")),
        ("probe.1.displacement.y", of("probe.1.displacement.y")),
        ("reactions.left.y", of("reactions.left.y")),
    ]
}

#[test]
fn means_of_a_cantilever_are_within_their_bars_by_every_method() {
    let exact = exact_means();
    let mut bars: [Vec<f64>; 4] = Default::default();
    for tolerance in ["1e-1", "1e-2", "1e-3"] {
        let text = format!("{SQUARE}{CANTILEVER}method.tolerance = {tolerance}\n");
        let by = |settings: &str| solved(&format!("{text}{settings}"), &[]);
        let collocation = by("stochastic.degree = 3\n");
        let samples = by("stochastic.method = \"monte-carlo\"\nstochastic.samples = 400\n");
        let sparse = by("stochastic.method = \"sparse\"\nstochastic.level = 2\n");
        for ((path, mean), of_tolerance) in exact.into_iter().zip(&mut bars) {
            check(&samples, path, mean);
            check(&sparse, path, mean);
            check(&collocation, path, mean);
            let of_mesh = |summary| bar(summary, path).parts["mesh"];
            of_tolerance.push(of_mesh(&collocation));
            // the mesh is the same
            assert_eq!(of_mesh(&samples), of_mesh(&collocation));
            assert!(path.starts_with("reactions") || bar(&samples, path).parts["sampling"] > 0.0);
            assert_eq!(bar(&collocation, path).parts["sampling"], 0.0);
        }
    }
    // J has an error of the square of 1e-3
    assert!(bars[0][2] < 5e-6 * exact[0].1.abs(), "{bars:?}");
    // balance gives the force on every mesh
    assert!(bars[..3].iter().all(|of| of[2] < 0.05 * of[0]) && bars[3].iter().all(|bar| *bar < 1e-12), "{bars:?}");
}

/// The force of a contact with a random gap, and J: judged by a mesh and polynomials that are much finer.
#[test]
fn means_with_contact_are_within_their_bars() {
    let text = format!(
        "{SQUARE}material = {{ young = 1, poisson = 0.3 }}
random.c = {{ distribution = \"uniform\", low = 0.35, high = 0.65 }}
sides.lower.contact = {{ gap = \"0.1*(x - c)^2\" }}
sides.upper.displacement = [0, -0.01]
stochastic.quantities = [\"energy\", \"strain_energy\", \"contact.force.y\", \"contact.length\", \"contact.max_pressure\"]
"
    );
    // off by a tenth of the smallest bar
    let fine = solved(&text, &["method.tolerance=3e-4", "stochastic.degree=9"]);
    for tolerance in ["1e-1", "3e-2", "1e-2", "3e-3"] {
        let own = solved(&text, &[&format!("method.tolerance={tolerance}"), "stochastic.degree=4"]);
        for path in ["energy", "strain_energy", "contact.force.y", "contact.length", "contact.max_pressure"] {
            check(&own, path, bar(&fine, path).value);
            // elements as long as the contact tell little of its pressure
            let few = ["1e-1", "3e-2"].contains(&tolerance) && path == "contact.max_pressure";
            assert!(few || bar(&own, path).uncertainty < 0.4 * bar(&own, path).value.abs(), "{path} at {tolerance}");
        }
    }
}

/// The same samples on a grid and on one of a quarter of its cells: the bars have the difference without that of the sampling.
#[test]
fn means_on_grids_have_the_error_of_the_grid() {
    let text = format!(
        "{SQUARE}material = {{ poisson = 0.3, cells = {{ size = 0.25, young = \"1 + 0.5*a*x + 0.4*b*y\" }} }}
random.a = {{ distribution = \"uniform\", low = -1, high = 1 }}
random.b = {{ distribution = \"uniform\", low = -1, high = 1 }}
sides.left.displacement = [0, 0]
sides.right.traction = [0, 0.01]
probe.points = [[0.3, 0.6], [1, 0.5]]
stochastic = {{ method = \"monte-carlo\", samples = 60, quantities = [\"energy\", \"probe.0.stress.xx\", \"probe.1.displacement.y\"] }}
method = {{ refine = \"none\", model = \"fem\" }}
"
    );
    let on = |n: usize| solved(&format!("{text}grid = {{ coarse = [{n}, {n}], fine = [1, 1] }}\n"), &[]);
    let (coarse, fine) = (on(8), on(64));
    for path in ["energy", "probe.0.stress.xx", "probe.1.displacement.y"] {
        let (own, exact) = (bar(&coarse, path), bar(&fine, path).value);
        let (error, of_grid) = ((own.value - exact).abs(), own.parts["fine_grid"]);
        println!("{path}: {} for {exact}, off by {error:.2e}, {:?}", own.value, own.parts);
        assert!(error <= of_grid, "{path}: off by {error:e} and {of_grid:e}");
        assert!(of_grid < 10.0 * error && own.parts["multiscale"] == 0.0);
    }
}
