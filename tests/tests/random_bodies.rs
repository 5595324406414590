//! Random input among several bodies: springs in series, and outcomes against scenes of their own.

use steklov_model::solve;
use steklov_model::stochastic::{OutcomesWatch, StochasticResult, solve_stochastic};
use steklov_problem::{Random, Sampling, Scene};
use steklov_stochastic::{Nodes, StochasticMesh, Variable};
use steklov_tests::{adapt, quantity, read};

fn outcomes(scene: &Scene) -> StochasticResult {
    let run = adapt(scene).unwrap_or_else(|e| panic!("{e}"));
    let random = scene.random.as_ref().expect("random input");
    solve_stochastic(scene, random, run.matrices.as_ref().expect("matrices"), &OutcomesWatch::NONE, &mut |_| Ok(()))
        .unwrap_or_else(|e| panic!("{e}"))
}

/// Two bars of length 1 and 2 and height 0.5 with a random gap between them, without lateral contraction; the right end comes by
/// 0.01.
fn bars(rest: &str) -> Scene {
    read(&format!(
        "title = \"bars\"\n[[body]]\nname = \"left\"\ncorners = [[0, 0], [1, 0], [1, 0.5], [0, 0.5]]\n\
         sides = [\"bottom\", \"end\", \"top\", \"wall\"]\nmaterial = {{ young = \"100*a\", poisson = 0 }}\n\
         [[body]]\nname = \"right\"\ncorners = [[1, 0], [3, 0], [3, 0.5], [1, 0.5]]\n\
         sides = [\"bottom\", \"wall\", \"top\", \"end\"]\nmaterial = {{ young = \"50 + 20*b\", poisson = 0 }}\n\
         [random.a]\ndistribution = \"lognormal\"\nmean = 1\ndeviation = 0.3\n\
         [random.b]\ndistribution = \"uniform\"\nlow = -1\nhigh = 1\n\
         [random.g]\ndistribution = \"uniform\"\nlow = 0\nhigh = 0.004\n\
         [sides.left.wall]\ndisplacement = [\"0\", \"0\"]\n[sides.right.wall]\ndisplacement = [\"-0.01\", \"0\"]\n\
         [[interface]]\nbetween = [\"left.end\", \"right.end\"]\ncontact = {{ gap = \"g\" }}\n\
         [method]\nrefine = \"none\"\n[probe]\npoints = [[1, 0.25]]\n\
         [stochastic]\nquantities = [\"interfaces.0.force.x\", \"contact.force.x\", \"reactions.left.wall.x\", \
         \"energy\", \"probe.0.stress.0\", \"interfaces.0.max_pressure\"]\n{rest}"
    ))
}

/// The force of springs in series, (d - g) h / (L₁/E₁ + L₂/E₂).
fn force_in_series([a, b, g]: [f64; 3]) -> f64 {
    0.5 * (0.01 - g) / (1.0 / (100.0 * a) + 2.0 / (50.0 + 20.0 * b))
}

fn variables(random: &Random) -> Vec<Variable> {
    random.germs.iter().map(|germ| germ.variable.clone()).collect()
}

/// Every outcome of two bars is that of springs in series: forces, stresses, energies.
#[test]
fn bars_are_springs_in_series() {
    let scene = bars("method = \"monte-carlo\"\nsamples = 400\nseed = 3\n");
    let result = outcomes(&scene);
    let variables = variables(scene.random.as_ref().expect("random input"));
    assert_eq!(result.points.len(), 400);
    for (i, germs) in result.points.iter().enumerate() {
        let values: Vec<f64> = variables.iter().zip(germs).map(|(v, xi)| v.value(*xi)).collect();
        let g = values[2];
        let force = force_in_series([values[0], values[1], g]);
        for (name, exact) in [
            ("interfaces.0.force.x", -force),
            ("contact.force.x", -force),
            ("reactions.left.wall.x", force),
            ("energy", 0.5 * force * (0.01 - g)),
            ("probe.0.stress.0", -force / 0.5),
            ("interfaces.0.max_pressure", force / 0.5),
        ] {
            let value = quantity(&result, name).values[i];
            assert!((value - exact).abs() < 1e-10 * exact.abs(), "{name} for {values:?}: {value}, exact {exact}");
        }
        assert!((result.young[i] / (100.0 * values[0]) - 1.0).abs() < 1e-14);
    }
}

/// Mean and variance of the force by tensor Gauss rules of the closed form: sparse grids, stochastic elements and samples agree,
/// these within three standard errors.
#[test]
fn moments_of_bars_are_those_of_their_closed_form() {
    let scene = bars("level = 4\nmethod = \"sparse\"\n");
    let random = scene.random.as_ref().expect("random input");
    let variables = variables(random);
    let mesh = StochasticMesh::uniform(variables.clone(), &[1; 3], &[14; 3]).unwrap_or_else(|e| panic!("{e}"));
    let rule = mesh.basis(0, Nodes::Gauss).unwrap_or_else(|e| panic!("{e}"));
    let (mut mean, mut square) = (0.0, 0.0);
    for (point, weight) in rule.points.iter().zip(&rule.weights) {
        let force = force_in_series([0, 1, 2].map(|k| variables[k].value(point[k])));
        mean += weight * force;
        square += weight * force * force;
    }
    let variance = square - mean * mean;
    for (method, error) in [(Sampling::Sparse, 1e-7), (Sampling::Collocation, 1e-6), (Sampling::Galerkin, 1e-6)] {
        let mut scene = scene.clone();
        let settings = &mut scene.random.as_mut().expect("random input").stochastic;
        (settings.method, settings.degree) = (method, 4);
        let result = outcomes(&scene);
        let force = quantity(&result, "interfaces.0.force.x");
        assert!((force.mean + mean).abs() < error * mean, "{method:?}: {} {mean}", force.mean);
        assert!((force.variance / variance - 1.0).abs() < 1e3 * error, "{method:?}: {} {variance}", force.variance);
        assert!(!result.coupled && !result.is_doubtful());
    }
    let result = outcomes(&bars("method = \"monte-carlo\"\nsamples = 1000\nseed = 7\n"));
    let force = quantity(&result, "interfaces.0.force.x");
    let errors = [force.standard_error, force.variance_error].map(|error| error.expect("an error"));
    assert!((force.mean + mean).abs() < 3.0 * errors[0], "{} {mean} {}", force.mean, errors[0]);
    assert!((force.variance - variance).abs() < 3.0 * errors[1], "{} {variance} {}", force.variance, errors[1]);
}

const BLOCKS: &str = "title = \"blocks\"\n[[body]]\nname = \"low\"\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\n\
    sides = [\"bottom\", \"right\", \"top\", \"left\"]\nmaterial = { young = \"200*E\", poisson = 0.3 }\n\
    [[body]]\nname = \"high\"\ncorners = [[0.5, 1], [1.5, 1], [1.4, 1.8], [0.6, 1.8]]\n\
    sides = [\"bottom\", \"right\", \"top\", \"left\"]\nmaterial = { young = \"50*F\", poisson = 0.2 }\n\
    body_force = [\"0.1*E\", \"-1\"]\n[sides.low.bottom]\ndisplacement = [\"0\", \"0\"]\n\
    [sides.high.top]\ntraction = [\"0.3*q\", \"-2 - q\"]\n\
    [random.E]\ndistribution = \"uniform\"\nlow = 0.6\nhigh = 1.5\n\
    [random.F]\ndistribution = \"lognormal\"\nmean = 1\ndeviation = 0.4\n\
    [random.q]\ndistribution = \"normal\"\nmean = 0\ndeviation = 0.3\n[probe]\npoints = [[1, 0.6], [1.1, 1.5]]\n\
    [method]\nrefine = \"none\"\n";

/// Each outcome is the scene with its data: of moduli, loads and laws, among bodies in contact, tied bodies, cracks, in media.
#[test]
fn outcomes_are_scenes_of_their_own() {
    let contact = "[[interface]]\nbetween = [\"low.top\", \"high.bottom\"]\n\
                   contact = { gap = \"0.001*abs(q)\", friction = { coulomb = \"0.2 + 0.1*E\" } }\n";
    let tied = "[[interface]]\nbetween = [\"low.top\", \"high.bottom\"]\n\
                tied = { displacement_jump = [\"0\", \"0.01*q\"], traction_jump = [\"0.1*q\", \"0\"] }\n";
    let medium = "title = \"lined hole\"\n[[body]]\nname = \"ring\"\ncircle = { centre = [0, 0], radius = 1 }\nside = \"rim\"\n\
         material = { young = \"100*E\", poisson = 0.25 }\n[[body.holes]]\n\
         circle = { centre = [0, 0], radius = 0.8 }\nside = \"bore\"\n[[body]]\nname = \"rock\"\n\
         medium = { remote_stress = [\"-1 - q\", -2, \"0.1*q\"] }\nmaterial = { young = \"60*F\", poisson = 0.3 }\n\
         [[body.holes]]\ncircle = { centre = [0, 0], radius = 1 }\nside = \"wall\"\n\
         [sides.ring.bore]\npressure = \"0.5*E\"\n[[interface]]\nbetween = [\"ring.rim\", \"rock.wall\"]\ntied = true\n\
         [random.E]\ndistribution = \"uniform\"\nlow = 0.6\nhigh = 1.5\n\
         [random.F]\ndistribution = \"lognormal\"\nmean = 1\ndeviation = 0.4\n\
         [random.q]\ndistribution = \"uniform\"\nlow = -0.3\nhigh = 0.3\n[probe]\npoints = [[0, 0.9], [1.5, 1]]\n\
         [method]\nrefine = \"none\"\n";
    let crack = "title = \"crack\"\n[body]\ncorners = [[-1, -1], [1, -1], [1, 1], [-1, 1]]\n\
         sides = [\"bottom\", \"right\", \"top\", \"left\"]\n[[body.cracks]]\npoints = [[-0.4, 0], [0.4, 0]]\n\
         [material]\nyoung = \"100*E\"\npoisson = 0.3\n[sides.bottom]\ndisplacement = [\"0\", \"0\"]\n\
         [sides.top]\ntraction = [\"0.3 + q\", \"-1 + x + F*x\"]\n[[interface]]\non = \"crack\"\n\
         contact = { friction = { coulomb = \"0.3*F\" } }\n\
         [random.E]\ndistribution = \"uniform\"\nlow = 0.6\nhigh = 1.5\n\
         [random.F]\ndistribution = \"uniform\"\nlow = 0.5\nhigh = 1.5\n\
         [random.q]\ndistribution = \"uniform\"\nlow = -0.3\nhigh = 0.3\n[probe]\npoints = [[0, 0.5], [0.2, -0.3]]\n\
         [method]\nrefine = \"none\"\n";
    // sides whose normals differ are paired by the moduli of the mean input in all outcomes
    let cylinders = "title = \"cylinders\"\n[[body]]\nname = \"upper\"\ncorners = [[0, 0], [10, 10], [0, 10]]\n\
         sides = [\"rim\", \"top\", \"axis\"]\narcs = { rim = { centre = [0, 10] } }\n\
         material = { young = \"300*E\", poisson = 0.25 }\n[[body]]\nname = \"lower\"\n\
         corners = [[0, -13], [13, -13], [0, 0]]\nsides = [\"bottom\", \"rim\", \"axis\"]\n\
         arcs = { rim = { centre = [0, -13] } }\nmaterial = { young = \"290*F\", poisson = 0.3 }\n\
         [sides.upper]\naxis = { displacement = [\"0\", \"free\"] }\ntop = { traction = [\"0\", \"-1.6\"] }\n\
         [sides.lower]\naxis = { displacement = [\"0\", \"free\"] }\nbottom = { displacement = [\"free\", \"0\"] }\n\
         [[interface]]\nbetween = [\"upper.rim\", \"lower.rim\"]\n\
         contact = { gap = \"0.01*q\", friction = { coulomb = \"0.1*F\" } }\n\
         [random.E]\ndistribution = \"uniform\"\nlow = 0.6\nhigh = 1.5\n\
         [random.F]\ndistribution = \"lognormal\"\nmean = 1\ndeviation = 0.4\n\
         [random.q]\ndistribution = \"uniform\"\nlow = -1\nhigh = 1\n[probe]\npoints = [[1, 5], [1, -5]]\n\
         [method]\nrefine = \"none\"\nelements = 40\n";
    for (name, text) in [
        ("contact", format!("{BLOCKS}{contact}")),
        ("cylinders", cylinders.to_owned()),
        ("tied", format!("{BLOCKS}{tied}")),
        ("medium", medium.to_owned()),
        ("crack", crack.to_owned()),
    ] {
        let paths = ["energy", "strain_energy", "load_work", "interfaces.0.force.x", "interfaces.0.force.y"];
        let probes = (0..2).flat_map(|p| {
            let of = move |what: &str, count: usize| (0..count).map(move |k| format!("probe.{p}.{what}.{k}")).collect();
            let both: [Vec<String>; 2] = [of("displacement", 2), of("stress", 3)];
            both.concat()
        });
        let paths: Vec<String> = paths.into_iter().map(str::to_owned).chain(probes).collect();
        let quoted = paths.iter().map(|path| format!("{path:?}")).collect::<Vec<_>>().join(", ");
        let settings = "[stochastic]\nmethod = \"monte-carlo\"\nsamples = 6\nseed = 11\n";
        let scene = read(&format!("{text}{settings}quantities = [{quoted}]\n"));
        let result = outcomes(&scene);
        for (i, germs) in result.points.iter().enumerate() {
            let one = scene.outcome(germs).unwrap_or_else(|e| panic!("{e}"));
            let answer = solve(&one).unwrap_or_else(|e| panic!("{name}: {e}")).summary;
            let scale = |path: &str| {
                let vector = path.rsplit_once('.').map_or(path, |(vector, _)| vector);
                let all = paths.iter().filter(|other| other.starts_with(vector));
                // forces around a hole have no resultant; loads are about 1
                let least = if path.starts_with("interfaces") { 1.0 } else { 0.0 };
                all.filter_map(|path| answer.at(path)).fold(least, |m: f64, v| m.max(v.abs()))
            };
            for path in &paths {
                let value = quantity(&result, path).values[i];
                let exact = answer.at(path).unwrap_or_else(|| panic!("no {path}"));
                let error = (value - exact).abs() / scale(path);
                assert!(error < 1e-8, "{name}, {path}, {i}: {value}, own scene {exact}");
            }
        }
    }
}

/// A disc of the radius 1 in a medium under a pull p from all sides, both moduli and p random: the stress in it is uniform,
/// p (κ₂ + 1) μ₁/((κ₁ - 1) μ₂ + 2 μ₁), its displacement (κ₁ - 1) σ r/(4 μ₁) (Goodier, 1933; plane strain, κ = 3 - 4 ν).
#[test]
fn a_disc_and_the_medium_around_it_have_random_moduli() {
    let text = "title = \"disc\"\n[body]\ncircle = { centre = [0, 0], radius = 1 }\nside = \"rim\"\n\
                [material]\nyoung = \"4*a\"\npoisson = 0.2\n[exterior]\nyoung = \"b\"\npoisson = 0.3\n\
                remote_stress = [\"p\", \"p\", 0]\n[probe]\npoints = [[0.5, 0], [2, 0]]\n[method]\ntolerance = 1e-8\n\
                [random.a]\ndistribution = \"uniform\"\nlow = 0.5\nhigh = 1.5\n\
                [random.b]\ndistribution = \"lognormal\"\nmean = 2\ndeviation = 0.3\n\
                [random.p]\ndistribution = \"uniform\"\nlow = -1\nhigh = 3\n[stochastic]\nmethod = \"sparse\"\nlevel = 2\n\
                quantities = [\"probe.0.displacement.x\", \"probe.0.stress.yy\", \"probe.1.stress.xx\"]\n";
    let scene = read(text);
    let result = outcomes(&scene);
    let variables = variables(scene.random.as_ref().expect("random input"));
    let mu = |young: f64, poisson: f64| young / (2.0 * (1.0 + poisson));
    let [of_body, of_medium] = [0.2, 0.3].map(|poisson| 3.0 - 4.0 * poisson);
    for (i, germs) in result.points.iter().enumerate() {
        let values: Vec<f64> = variables.iter().zip(germs).map(|(v, xi)| v.value(*xi)).collect();
        let (inner, outer, p) = (mu(4.0 * values[0], 0.2), mu(values[1], 0.3), values[2]);
        let stress = p * (of_medium + 1.0) * inner / ((of_body - 1.0) * outer + 2.0 * inner);
        for (name, exact) in [
            ("probe.0.displacement.x", (of_body - 1.0) * stress * 0.5 / (4.0 * inner)),
            ("probe.0.stress.yy", stress),
            ("probe.1.stress.xx", p + (stress - p) / 4.0),
        ] {
            let value = quantity(&result, name).values[i];
            assert!((value - exact).abs() < 1e-8 * (p.abs() + 1.0), "{name} for {values:?}: {value}, exact {exact}");
        }
    }
    // a name that nothing uses changes nothing
    let unused = text.replace("4*a", "4").replace("young = \"b\"", "young = 2").replace("\"p\"", "1");
    let scene = read(&unused[..unused.find("[stochastic]").unwrap()]);
    assert!(scene.random.is_none() && scene.problem.tie().is_some());
    let corners = "corners = [[0, 0], [1, 0], [1, 1], [0, 1]]\nsides = [\"a\", \"b\", \"c\", \"d\"]";
    let own_grid = format!("{text}[grid]\ncoarse = [8, 8]\nfine = [1, 1]\n")
        .replace("circle = { centre = [0, 0], radius = 1 }\nside = \"rim\"", corners)
        .replace("tolerance = 1e-8", "model = \"fem-bem\"");
    let refused = steklov_tests::parse(&own_grid, &[]).unwrap_err().render();
    assert!(refused.contains("random input of a body in a medium needs boundary elements"), "{refused}");
}
