//! Random input of scenes: exact scalings, outcomes against scenes of their own, methods against each other.

use steklov_bem_operators::{Mark, PairCache, Subdivision};
use steklov_model::run::adaptive_loop::Run;
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::stochastic::{OutcomesWatch, Quantity, StochasticResult, solve_stochastic};
use steklov_problem::Scene;
use steklov_stochastic::{Nodes, StochasticMesh, Variable};
use steklov_tests::{adapt, document};

/// A square held at its top, on a floor: modulus, gap, friction, traction of the vertical sides, the rest.
fn block(young: &str, gap: &str, friction: &str, traction: [&str; 2], rest: &str) -> Scene {
    parse(&block_text(young, gap, friction, traction, rest))
}

fn block_text(young: &str, gap: &str, friction: &str, traction: [&str; 2], rest: &str) -> String {
    let [x, y] = traction;
    format!(
        "title = \"block\"\n[body]\ncorners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]\n\
         sides = [\"floor\", \"right\", \"top\", \"left\"]\n[material]\nyoung = {young}\npoisson = 0.3\n\
         [sides.floor]\ncontact = {{ gap = \"{gap}\", friction = {{ tresca = \"{friction}\" }} }}\n\
         [sides.top]\ndisplacement = [\"0\", \"0\"]\n[sides.left]\ntraction = [\"{x}\", \"{y}\"]\n\
         [sides.right]\ntraction = [\"{x}\", \"{y}\"]\n[method]\ntolerance = 1e-2\n{rest}"
    )
}

const UNIFORM: &str = "[random.E]\ndistribution = \"uniform\"\nlow = 1800\nhigh = 2200\n";

fn parse(text: &str) -> Scene {
    steklov_tests::parse(text, &[]).unwrap_or_else(|e| panic!("{}", e.render()))
}

fn solved(scene: &Scene) -> (Run<BoundaryElements>, StochasticResult) {
    let run = adapt(scene).unwrap_or_else(|e| panic!("{e}"));
    let result = on(scene, &run);
    (run, result)
}

/// All outcomes on the last mesh of a run.
fn on(scene: &Scene, run: &Run<BoundaryElements>) -> StochasticResult {
    let random = scene.random.as_ref().expect("random input");
    solve_stochastic(scene, random, run.matrices.as_ref().expect("matrices"), &OutcomesWatch::NONE, &mut |_| Ok(()))
        .unwrap_or_else(|e| panic!("{e}"))
}

fn quantity<'a>(result: &'a StochasticResult, name: &str) -> &'a Quantity {
    result.quantities.iter().find(|q| q.name == name).unwrap_or_else(|| panic!("no {name}"))
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

#[test]
fn under_dead_loads_at_no_gap_pressures_do_not_depend_on_the_modulus() {
    let scene = block("\"E\"", "0", "0.35", ["0.3", "-1"], UNIFORM);
    let (run, result) = solved(&scene);
    let nominal = run.last.contact.as_ref().expect("contact");
    let pressures: Vec<f64> = nominal.solution.multipliers.iter().map(|l| l[0]).collect();
    let shears: Vec<f64> = nominal.solution.multipliers.iter().map(|l| l[1]).collect();
    assert!(largest(&pressures) > 1.0 && largest(&shears) > 0.3499);
    for (moments, nominal) in [(&result.pressure, &pressures), (&result.shear, &shears)] {
        let size = largest(nominal);
        for ((mean, variance), nominal) in moments.mean.iter().zip(&moments.variance).zip(nominal) {
            assert!((mean - nominal).abs() <= 1e-12 * size && variance.sqrt() <= 1e-12 * size, "{mean} {nominal}");
        }
    }
    // u E is constant: u = u₀ E₀/E, of which the mean is ln(2200/1800)/400 and the variance 1/(1800 2200) - mean², to the rule's
    // error 5.9e-11 and 1.2e-7 of degree 3
    let mean = (2200.0f64 / 1800.0).ln() / 400.0;
    let variance = 1.0 / (1800.0 * 2200.0) - mean * mean;
    let size = largest(&run.last.displacement);
    for (k, u) in run.last.displacement.iter().enumerate() {
        assert!((result.displacement.mean[k] - u * 2000.0 * mean).abs() < 7e-11 * size);
        assert!(
            (result.displacement.variance[k] - u * u * 2000.0f64.powi(2) * variance).abs()
                < 2e-7 * variance * 4e6 * size * size
        );
        assert!((result.stress_displacement[k] - u).abs() < 1e-12 * size);
    }
    let energy = quantity(&result, "energy");
    assert!((energy.mean / (run.last.energies.total * 2000.0 * mean) - 1.0).abs() < 7e-11);
}

#[test]
fn without_loads_displacements_do_not_depend_on_the_modulus() {
    let scene = block("\"E\"", "-0.01", "0", ["0", "0"], UNIFORM);
    let (run, result) = solved(&scene);
    assert!(result.solved < 20, "rounding is not refined: {}", result.solved);
    let size = largest(&run.last.displacement);
    let nominal: Vec<f64> =
        run.last.contact.as_ref().expect("contact").solution.multipliers.iter().map(|l| l[0]).collect();
    for (k, u) in run.last.displacement.iter().enumerate() {
        assert!((result.displacement.mean[k] - u).abs() <= 1e-12 * size);
        assert!(result.displacement.variance[k].sqrt() <= 1e-12 * size);
    }
    // λ = λ₀ E/E₀: deviation 200/√3 over 2000
    let part = 200.0 / 3.0f64.sqrt() / 2000.0;
    for (k, l) in nominal.iter().enumerate() {
        assert!((result.pressure.mean[k] - l).abs() <= 1e-12 * largest(&nominal));
        assert!((result.pressure.variance[k].sqrt() - part * l.abs()).abs() <= 1e-12 * largest(&nominal));
    }
    assert!(result.probability.iter().all(|p| *p == 1.0));
}

/// Everything is random: each point's answers are those of a scene of its own on the same mesh, solved from scratch.
#[test]
fn outcomes_are_those_of_scenes_of_their_own() {
    let rest = "[body_force]\nvalue = [\"0\", \"B\"]\n[random.E]\ndistribution = \"lognormal\"\nmean = 2000\ndeviation = 300\n\
                [random.b]\ndistribution = \"normal\"\nmean = -1\ndeviation = 0.3\n\
                [random.t]\ndistribution = \"beta\"\nalpha = 2\nbeta = 3\nlow = -1\nhigh = 0.5\n\
                [random.g]\ndistribution = \"uniform\"\nlow = 0.0001\nhigh = 0.0004\n\
                [random.F]\ndistribution = \"uniform\"\nlow = 0.1\nhigh = 0.6\n\
                [random.d]\ndistribution = \"uniform\"\nlow = -0.0002\nhigh = 0\n\
                [stochastic]\nmethod = \"monte-carlo\"\nsamples = 6\nseed = 7\n\
                quantities = [\"energy\", \"strain_energy\", \"friction_work\", \"contact.force.x\", \"contact.force.y\", \
                \"contact.max_pressure\", \"contact.length\", \"contact.stick\", \"reactions.top.y\", \"probe.0.displacement.y\", \
                \"probe.0.stress.yy\"]\n[probe]\npoints = [[0.1, -0.2]]\n";
    let text = |e: &str, [b, t, g, f, d]: [&str; 5], rest: &str| {
        let rest = rest.replace("\"B\"", &format!("\"{b}\""));
        let held = format!("displacement = [\"0\", \"{d}\"]");
        parse(
            &block_text(e, &format!("{g}+0.001*x^2"), f, [t, "-1"], &rest)
                .replace("displacement = [\"0\", \"0\"]", &held),
        )
    };
    let scene = text("\"E\"", ["b", "t", "g", "F", "d"], rest);
    let (run, result) = solved(&scene);
    let labels: Vec<&str> = result.labels.iter().map(String::as_str).collect();
    assert_eq!(labels, ["E", "b", "t", "g", "F", "d"]);
    let fixed = rest.split("[random.E]").next().expect("a body force").to_owned() + "[probe]\npoints = [[0.1, -0.2]]\n";
    for (k, germs) in result.points.iter().enumerate() {
        let [e, b, t, g, f, d] = germs[..] else { panic!("six germs") };
        let number = |x: f64| format!("({x:?})");
        let numbers = [b, t, g, f, d].map(number);
        let own = text(&format!("{:?}", e.exp()), numbers.each_ref().map(String::as_str), &fixed);
        let mesh = run.last.mesh.clone();
        let (solved, ..) = steklov_model::solve::one_mesh::solve(
            &own,
            (mesh, None),
            false,
            &mut PairCache::default(),
            &mut |_| Ok(()),
        )
        .unwrap_or_else(|e| panic!("{e}"));
        let contact = solved.contact.as_ref().expect("contact");
        let rows = steklov_model::solve::contact_rows::contact_rows(solved.trace(), contact);
        let told = steklov_model::answer::report::contact_summary(&own, solved.trace(), contact, &rows, None);
        let (inside, stress) = solved.inside(0, [0.1, -0.2]);
        let top = solved.reactions.iter().find(|r| r.0 == "top").expect("held").1[1];
        let energies = solved.energies;
        let wanted = [
            energies.total,
            energies.strain,
            energies.friction_work,
            told.force[0],
            told.force[1],
            told.max_pressure,
            told.length,
            told.stick,
            top,
            inside[1],
            stress[1],
        ];
        for (quantity, wanted) in result.quantities.iter().zip(wanted) {
            let value = quantity.values[k];
            let scale = wanted.abs().max(1e-6);
            assert!((value - wanted).abs() < 1e-8 * scale, "{} of {germs:?}: {value}, alone {wanted}", quantity.name);
        }
    }
    println!("{} outcomes agree", result.points.len());
}

#[test]
fn coupled_nodes_and_nodes_one_by_one_agree_the_better_the_higher_the_degree() {
    let lognormal = "[random.E]\ndistribution = \"lognormal\"\nmean = 2000\ndeviation = 400\n";
    // never touching, which is smooth in E; touching in a part that changes with E
    for (gap, fall, end) in [("1", 0.2, 1e-5), ("0.0002 + 0.001*x^2", f64::INFINITY, 1e-3)] {
        let at = |method: &str, degree: usize| {
            let rest = format!("{lognormal}[stochastic]\nmethod = \"{method}\"\ndegree = {degree}\n");
            block("\"E\"", gap, "0.3", ["0.3", "-1"], &rest)
        };
        let run = adapt(&at("galerkin", 1)).unwrap_or_else(|e| panic!("{e}"));
        let mut last = f64::INFINITY;
        for degree in 1..=4 {
            let [a, b] = ["galerkin", "collocation"].map(|method| on(&at(method, degree), &run));
            assert!(a.coupled && !b.coupled && a.unconverged == 0);
            let (a, b) = (&a.displacement.mean, &b.displacement.mean);
            let apart: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
            let apart = largest(&apart) / largest(b);
            println!("gap {gap}, degree {degree}: coupled and not {apart:.2e} apart");
            assert!(apart > 0.0 && apart < fall * last, "{apart} after {last}");
            last = apart;
        }
        assert!(last < end, "{last}");
    }
}

/// E u of coupled nodes is a polynomial, so that forces in equilibrium with a load that is not random are not random either.
#[test]
fn forces_of_coupled_nodes_balance_loads_that_are_not_random() {
    let rest = "[random.E]\ndistribution = \"lognormal\"\nmean = 2000\ndeviation = 1000\n[stochastic]\ndegree = 1\n\
                quantities = [\"strain_energy\", \"load_work\", \"reactions.top.y\", \"reactions.floor.y\", \
                \"contact.force.y\", \"probe.0.stress.yy\"]\n[probe]\npoints = [[0, 0]]\n";
    // apart: the tractions of two sides of length 1 hang on the top
    let (run, result) = solved(&block("\"E\"", "1", "0", ["0", "-25"], rest));
    assert!(result.coupled);
    let of = |result: &StochasticResult, name: &str| quantity(result, name).clone();
    let (top, stress) = (of(&result, "reactions.top.y"), of(&result, "probe.0.stress.yy"));
    assert!((top.mean - 50.0).abs() < 1e-9 && top.variance.sqrt() < 1e-9, "{} {}", top.mean, top.variance);
    let nominal = run.last.inside(0, [0.0, 0.0]).1[1];
    assert!((stress.mean - nominal).abs() < 1e-9 && stress.variance.sqrt() < 1e-9, "{} {nominal}", stress.mean);
    let [strain, work] = ["strain_energy", "load_work"].map(|name| of(&result, name).mean);
    assert!((strain / (0.5 * work) - 1.0).abs() < 1e-12, "{strain} {work}");
    for (stressed, u) in result.stress_displacement.iter().zip(&run.last.displacement) {
        assert!((stressed - u).abs() < 1e-11 * largest(&run.last.displacement));
    }
    // in contact: the floor's reaction is the force of its pressure, and balances top and load in every outcome
    let (_, result) = solved(&block("\"E\"", "-0.01", "0.3", ["0", "-1"], rest));
    let [top, floor, force] = ["reactions.top.y", "reactions.floor.y", "contact.force.y"].map(|n| of(&result, n));
    assert!(result.coupled && force.variance > 1e-3);
    for ((top, floor), force) in top.values.iter().zip(&floor.values).zip(&force.values) {
        assert_eq!(floor, force);
        assert!((top + floor - 2.0).abs() < 1e-8 * floor.abs(), "{top} {floor}");
    }
    // Coulomb friction and body forces are left to the nodes one by one
    let coulomb = block_text("\"E\"", "-0.01", "0.3", ["0", "-1"], rest).replace("tresca", "coulomb");
    assert!(!solved(&parse(&coulomb)).1.coupled);
    let heavy = format!("[body_force]\nvalue = [\"0\", \"-1\"]\n{rest}");
    assert!(!solved(&block("\"E\"", "-0.01", "0.3", ["0", "-1"], &heavy)).1.coupled);
}

/// A block at an angle is closed up to rounding, which must not be taken for an opening.
#[test]
fn closed_contact_is_certain_in_any_direction() {
    let (sin, cos) = 0.4f64.sin_cos();
    let turned = |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y];
    let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(turned);
    let down = turned([0.0, -0.01]);
    for method in ["galerkin", "collocation"] {
        let text = format!(
            "title = \"turned\"\n[body]\ncorners = {corners:?}\nsides = [\"floor\", \"right\", \"top\", \"left\"]\n\
             [material]\nyoung = \"E\"\npoisson = 0.3\n[random.E]\ndistribution = \"lognormal\"\nmean = 2000\n\
             deviation = 300\n[sides.floor]\ncontact = {{ gap = \"0\" }}\n[sides.top]\n\
             displacement = [\"{}\", \"{}\"]\n[method]\ntolerance = 1e-2\n[stochastic]\nmethod = \"{method}\"\n",
            down[0], down[1]
        );
        let (_, result) = solved(&parse(&text));
        assert!(result.probability.iter().all(|p| *p == 1.0), "{method}: {:?}", result.probability);
    }
}

/// A load along the floor under which it sticks, and slips from one germ to the next, closed all the time: the truncation of degree
/// 3 to 6 against the distance to much finer cells, in the energy norm.
#[test]
fn the_truncation_sees_where_sticking_turns_into_slip() {
    let at = |rule: &str| {
        let rest = format!("[random.t]\ndistribution = \"uniform\"\nlow = 0\nhigh = 1\n[stochastic]\n{rule}\n");
        block("2000", "-0.001", "0.2", ["t", "0"], &rest)
    };
    let run = adapt(&at("degree = 3")).unwrap_or_else(|e| panic!("{e}"));
    let fine = on(&at("degree = 3\nelements = 64"), &run);
    assert!(fine.probability.iter().all(|p| *p == 1.0));
    let energy = |u: &[f64]| {
        run.matrices.as_ref().expect("matrices").condensation.multiply(u).iter().zip(u).map(|(s, u)| s * u).sum::<f64>()
    };
    for degree in 3..=6 {
        let coarse = on(&at(&format!("degree = {degree}")), &run);
        let variables = vec![Variable::uniform(0.0, 1.0).expect("a variable")];
        let mesh = StochasticMesh::uniform(variables, &[1], &[degree]).expect("a mesh");
        let basis = mesh.basis(0, Nodes::Gauss).expect("a basis");
        let (mut error, mut norm, mut theta) = (0.0, 0.0, vec![0.0; degree + 1]);
        for ((germ, weight), u) in fine.points.iter().zip(&fine.weights).zip(&fine.displacements) {
            basis.evaluate(germ, &mut theta);
            let interpolated = |i: usize| theta.iter().zip(&coarse.displacements).map(|(t, u)| t * u[i]).sum::<f64>();
            let apart: Vec<f64> = (0..u.len()).map(|i| u[i] - interpolated(i)).collect();
            error += weight * energy(&apart);
            norm += weight * energy(u);
        }
        let (truth, told) = ((error / norm).sqrt(), coarse.truncation.expect("a truncation"));
        println!("degree {degree}: truncation {told:.2e}, truth {truth:.2e}");
        assert!(told > 0.5 * truth && told < 10.0 * truth, "degree {degree}: {told} {truth}");
    }
}

#[test]
fn methods_agree_and_samples_stay_within_their_interval() {
    // four modes, on one mesh of few unknowns for all
    let text = document("30-rough-obstacle", &[]).source.text;
    let text = text.replace("tolerance = 5e-3", "tolerance = 2e-2").replace("modes = 6", "modes = 4");
    let run = adapt(&parse(&text)).unwrap_or_else(|e| panic!("{e}"));
    let with = |change: &str| {
        let text = text.replace("degree = 1\n", &format!("{change}\n"));
        on(&parse(&text), &run)
    };
    let tensor = with("degree = 2");
    let sparse = with("method = \"sparse\"\nlevel = 2");
    let samples = with("method = \"monte-carlo\"\nsamples = 400\nseed = 3");
    for name in ["energy", "contact.force.y"] {
        let (a, b, c) = (quantity(&tensor, name), quantity(&sparse, name), quantity(&samples, name));
        let error = c.standard_error.expect("of samples");
        println!("{name}: {} {} {} ± {error}", a.mean, b.mean, c.mean);
        assert!((a.mean - c.mean).abs() < 4.0 * error && (b.mean - c.mean).abs() < 4.0 * error, "{name}");
        assert!((error / (a.variance / 400.0).sqrt() - 1.0).abs() < 0.1, "{name}: {error}");
    }
    // the first mode moves the whole floor: it makes most of the force's variance, and the shares of all sum to at least 1
    let effects = quantity(&tensor, "contact.force.y").effects.clone().expect("effects");
    assert!(effects[0] > 0.8 && effects[1..].iter().all(|e| *e < 0.2), "{effects:?}");
    // of samples and of polynomials of degree 2, whose kinks cost some percent
    let apart: Vec<f64> = tensor.probability.iter().zip(&samples.probability).map(|(p, q)| (p - q).abs()).collect();
    let mean = apart.iter().sum::<f64>() / apart.len() as f64;
    println!("probabilities of contact: {:.3} apart at most, {mean:.3} in the mean", largest(&apart));
    assert!(tensor.probability.iter().all(|p| (0.0..=1.0).contains(p)));
    assert!(largest(&apart) < 0.1 && mean < 0.04, "{apart:?}");
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let text = document("31-random-load-and-modulus", &[]).source.text.replace("degree = 3", "degree = 1");
    let bits = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let (_, result) = solved(&parse(&text));
            let numbers = result.quantities.iter().flat_map(|q| [q.mean, q.variance]);
            let fields = [&result.displacement.mean, &result.pressure.variance, &result.probability];
            numbers.chain(fields.into_iter().flatten().copied()).map(f64::to_bits).collect::<Vec<u64>>()
        })
    };
    assert_eq!(bits(1), bits(2));
}

/// The estimate of the mesh is that of the mean over outcomes: true errors of single outcomes, in mean square, are about it.
#[test]
fn the_spatial_estimate_is_the_mean_over_outcomes() {
    let text = document("30-rough-obstacle", &[]).source.text;
    let scene = parse(&text.replace("tolerance = 5e-3", "tolerance = 2e-2"));
    let (run, result) = solved(&scene);
    let estimate = run.step().estimate();
    let finer = Subdivision::new(&run.last.mesh, &vec![Mark::refine(true, 1.0); run.last.mesh.len()])
        .refined_by_mark(&steklov_bem_operators::Grading { max_degree: 20, ..Default::default() });
    let (mut squared, mut norm) = (0.0, 0.0);
    let picked = [0usize, 7, 21, 42, 63];
    for &k in &picked {
        let outcome = scene.outcome(&result.points[k]).unwrap_or_else(|e| panic!("{e}"));
        let found = steklov_study::reference::true_error(&outcome, &run.last.mesh, &result.displacements[k], &finer);
        let found = found.unwrap_or_else(|e| panic!("{e}"));
        squared += found.error.powi(2) / picked.len() as f64;
        norm += found.norm.powi(2) / picked.len() as f64;
    }
    let (relative, told) = ((squared / norm).sqrt(), estimate.relative);
    println!("true error of five outcomes {relative:.2e}, estimate of the mean {told:.2e}");
    assert!(told > 0.5 * relative && told < 2.0 * relative, "{told} {relative}");
}

/// E max(0, q - z) of a standard normal q: φ(z) - z (1 - Φ(z)).
fn excess(z: f64) -> f64 {
    let normal = Variable::normal(0.0, 1.0).unwrap_or_else(|e| panic!("{e}"));
    let density = (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
    density - z * normal.probability([z, f64::INFINITY])
}

/// A floor that is touched in few of the outcomes, or in hardly any, by default settings: the force is k max(0, q - z), and the mesh
/// is as good as for an outcome that touches, though the mean input does not.
#[test]
fn rare_contact_is_found_by_default_settings() {
    let text = |height: &str, random: &str| {
        format!(
            "title = \"rare\"\n[body]\ncorners = [[0, 0], [1, 0], [1, 1], [0, 1]]\n\
             sides = [\"floor\", \"right\", \"top\", \"left\"]\n[material]\nyoung = 1000\npoisson = 0.3\n\
             [sides.floor]\ncontact = {{ gap = \"0.001\" }}\n[sides.top]\ndisplacement = [\"0\", \"{height}\"]\n\
             [method]\ntolerance = 1e-3\n{random}"
        )
    };
    let random = "[random.q]\ndistribution = \"normal\"\nmean = 0\ndeviation = 1\n\
                  [stochastic]\nquantities = [\"contact.force.y\"]\n";
    let one = adapt(&parse(&text("-0.0015", ""))).unwrap_or_else(|e| panic!("{e}"));
    let force = one.last.contact.as_ref().expect("contact").force(0)[1];
    for z in [0.8416, 1.7507, 2.3263, 3.0902] {
        let height = format!("-0.001*(1 + 0.5*(q - {z}))");
        let (run, result) = solved(&parse(&text(&height, random)));
        let mean = quantity(&result, "contact.force.y").mean;
        assert!((mean / (force * excess(z)) - 1.0).abs() < 2e-3, "{z}: {mean}, {}", force * excess(z));
        let relative = run.step().estimate().relative;
        assert!(relative < 1e-3 && relative > 1e-5, "{z}: {relative}");
        assert!(!result.is_doubtful() && result.solved < 100, "{z}: {} solves", result.solved);
    }
}
