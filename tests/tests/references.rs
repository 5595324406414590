//! Two contact problems with known answers: values on given meshes, rates, limits.
//!
//! The energies on uniform meshes are those of two independent codes that discretise alike. The limits are the table of
//! thirteen digits that several adaptive meshes of two codes agree on.

use steklov_bem_operators::{Mesh, PairCache};
use steklov_contact::ContactError;
use steklov_model::error::SolveError;
use steklov_model::mesh::first_mesh::first_mesh;
use steklov_model::solve::one_mesh::solve;
use steklov_model::solve::solution::Solved;
use steklov_problem::Scene;
use steklov_tests::{Answer, answer, answer_on, attempt, scene};

/// J of `block-on-floor`.
const BLOCK: f64 = -2.993_329_193_070_8;
/// J of `wedge-gap`.
const WEDGE: f64 = 0.647_194_015_986_9;

/// (elements a side, degree, J).
const BLOCK_ON_MESHES: [(usize, usize, f64); 9] = [
    (4, 1, -3.0101614762536997),
    (8, 1, -2.9934500602814818),
    (16, 1, -2.993698198835455),
    (32, 1, -2.9933693071231473),
    (64, 1, -2.993327331362367),
    (4, 2, -2.992638144057374),
    (4, 4, -2.9929903902477117),
    (4, 8, -2.993388386401436),
    (4, 12, -2.993329889447299),
];
const WEDGE_ON_MESHES: [(usize, usize, f64); 5] = [
    (4, 1, 0.6303528720277931),
    (8, 1, 0.6441338119767891),
    (16, 1, 0.6464422836523254),
    (32, 1, 0.647012322017627),
    (64, 1, 0.6471486265957863),
];

fn uniform(name: &str, n: usize, p: usize, solver: &str) -> Answer {
    let (elements, degree) = (format!("method.elements={}", 4 * n), format!("method.degree={p}"));
    answer(&scene(name, &[&elements, &degree, &format!("method.solver=\"{solver}\"")]))
}

/// Energies to 1e-9, at most 12 iterations from a cold start, the judge's measures at most 1e-10.
fn on_meshes(name: &str, table: &[(usize, usize, f64)]) {
    for &(n, p, energy) in table {
        for solver in ["newton", "active-set"] {
            let a = uniform(name, n, p, solver);
            let (iterations, worst) = a.judged();
            let off = (a.solved.energies.total - energy).abs();
            println!(
                "{name} n {n:2} p {p:2} {solver:10}: off by {off:.1e}, {iterations} iterations, judge {worst:.1e}"
            );
            assert!(
                a.converged() && off <= 1e-9 && iterations <= 12 && worst <= 1e-10,
                "n {n} p {p} {solver}: {off:e}"
            );
        }
    }
}

#[test]
fn the_block_has_the_known_energies_on_uniform_meshes() {
    on_meshes("block-on-floor", &BLOCK_ON_MESHES);
}

#[test]
fn the_wedge_has_the_known_energies_on_uniform_meshes() {
    on_meshes("wedge-gap", &WEDGE_ON_MESHES);
}

#[test]
fn uzawa_solves_the_wedge_and_refuses_the_floating_block() {
    for &(n, p, energy) in &WEDGE_ON_MESHES[..3] {
        let a = uniform("wedge-gap", n, p, "uzawa");
        let (iterations, worst) = a.judged();
        let off = (a.solved.energies.total - energy).abs();
        println!("uzawa n {n:2}: off by {off:.1e}, {iterations} iterations, judge {worst:.1e}");
        assert!(a.converged() && off <= 1e-6, "n {n}: {off:e} after {iterations}");
    }
    let block = scene("block-on-floor", &["method.elements=16", "method.degree=1", "method.solver=\"uzawa\""]);
    let refused = attempt(&block, first_mesh(&block)).err();
    let Some(SolveError::Contact(ContactError::NotCoercive { smallest, largest })) = refused else {
        panic!("a floating body is not for Uzawa: {refused:?}");
    };
    assert!(smallest.abs() < 1e-10 * largest, "{smallest:e} of {largest:e}");
}

/// Numbers with two digits.
fn short(numbers: &[f64]) -> String {
    numbers.iter().map(|x| format!("{x:.1e}")).collect::<Vec<_>>().join(" ")
}

/// Slope of log error on log h by least squares, h halved from one entry to the next.
fn rate(errors: &[f64]) -> f64 {
    let n = errors.len() as f64;
    let middle = (n - 1.0) / 2.0;
    let logs: Vec<f64> = errors.iter().map(|e| e.ln() / 2f64.ln()).collect();
    let (num, den) = logs.iter().enumerate().fold((0.0, 0.0), |(a, b), (i, l)| {
        let d = i as f64 - middle;
        (a - d * l, b + d * d)
    });
    num / den
}

/// A quantity's name, its limit, the least rate, and how it is read off.
type Measure<'a> = (&'a str, f64, f64, &'a dyn Fn(&Answer) -> f64);

/// Displacement at (-½, -½).
fn corner(a: &Answer) -> [f64; 2] {
    let at = a.solved.space.points.iter().position(|x| *x == [-0.5, -0.5]).expect("a corner is a node");
    [a.solved.displacement[2 * at], a.solved.displacement[2 * at + 1]]
}

/// J and the resultant of the pressure converge like h²; the corner's displacement less evenly, as the ends of contact
/// jump from node to node.
#[test]
fn the_wedge_converges_with_second_order() {
    let answers: Vec<Answer> = [8, 16, 32, 64].map(|n| uniform("wedge-gap", n, 1, "newton")).into();
    let measures: [Measure<'_>; 4] = [
        ("J", WEDGE, 1.9, &|a| a.solved.energies.total),
        ("resultant", 31.150295, 1.9, &|a| a.contact().force[1]),
        ("u_x at a corner", 0.00190323, 1.0, &|a| corner(a)[0]),
        ("u_y at a corner", 0.01239241, 1.0, &|a| corner(a)[1]),
    ];
    for (name, exact, least, measure) in measures {
        let errors: Vec<f64> = answers.iter().map(|a| (measure(a) - exact).abs()).collect();
        let rate = rate(&errors);
        println!("{name}: errors {}, rate {rate:.2}", short(&errors));
        assert!(rate > least && errors[3] < 3e-3 * exact, "{name}: rate {rate}, errors {errors:?}");
    }
    // the contact length is a sum of whole nodal weights: off by at most one element, h = 1/n, at either end
    for (a, n) in answers.iter().zip([8.0, 16.0, 32.0, 64.0]) {
        let off = (a.contact().length - 2.0 * 0.25999231).abs();
        println!("n {n}: contact length off by {:.3} h", off * n);
        assert!(off <= 2.0 / n, "n {n}: {off}");
    }
}

/// Degree P on a mesh with P layers of ratio 0.17 towards the corners, the ends of contact and its middle.
fn geometric(name: &str, half_length: f64, degree: usize) -> (Scene, Mesh) {
    let scene = scene(name, &["method.solver=\"active-set\""]);
    let corners = (0..4).map(|k| (k, 0.0));
    let inner = [0.5 - half_length, 0.5, 0.5 + half_length].map(|s| (0, s));
    let towards: Vec<(usize, f64)> = corners.chain(inner).collect();
    let mesh = Mesh::graded(&scene.problem.outline, &towards, degree, 0.17, |_| degree).expect("a valid mesh");
    (scene, mesh)
}

/// The same solved, without an estimate.
fn solved(name: &str, half_length: f64, degree: usize) -> Solved {
    let (scene, mesh) = geometric(name, half_length, degree);
    let solved = solve(&scene, (mesh, None), false, &mut PairCache::default(), &mut |_| Ok(()));
    solved.unwrap_or_else(|e| panic!("{e}")).0
}

/// All rows of the table: scene, [contact half-length, J, friction work, resultant], displacement at (-½, -½).
const LIMITS: [(&str, [f64; 4], [f64; 2]); 2] = [
    ("block-on-floor", [0.42901463, BLOCK, 0.0102792785, 40.0 / 3.0], [0.05067434, 0.01137091]),
    ("wedge-gap", [0.25999231, WEDGE, 0.00080937561, 31.150295], [0.00190323, 0.01239241]),
];

/// The whole table is met to one unit of its last digit, and the energy gains at least a digit for each two degrees.
#[test]
fn geometric_meshes_reach_the_limits() {
    for (name, [half, energy, friction, resultant], [x, y]) in LIMITS {
        let (scene, mesh) = geometric(name, half, 8);
        let (coarser, a) = ([4, 6].map(|p| solved(name, half, p)), answer_on(&scene, mesh));
        let all: Vec<&Solved> = coarser.iter().chain([&a.solved]).collect();
        let errors: Vec<f64> = all.iter().map(|solved| (solved.energies.total - energy).abs()).collect();
        for solved in all {
            let contact = solved.contact.as_ref().expect("contact");
            let (iterations, worst) = (contact.solution.iterations, contact.audit.worst());
            println!("{name}: {} dofs, {iterations} iterations, judge {worst:.1e}", solved.space.dofs());
            assert!(contact.solution.converged() && worst <= 1e-10);
        }
        let off = [
            ("contact length", a.contact().length, 2.0 * half, 2e-8),
            ("friction work", a.solved.energies.friction_work, friction, 1e-10),
            ("resultant", a.contact().force[1], resultant, 1e-6),
            ("u_x", corner(&a)[0], x, 1e-8),
            ("u_y", corner(&a)[1], y, 1e-8),
        ]
        .map(|(what, value, exact, digit)| (what, (value - exact).abs(), digit));
        println!("{name}: J off by {}", short(&errors));
        off.iter().for_each(|(what, off, digit)| println!("    {what} off by {off:.1e}, last digit {digit:.0e}"));
        assert!(errors[2] <= 1e-8 && errors.windows(2).all(|e| e[1] < 0.1 * e[0]), "{}", short(&errors));
        assert!(off.iter().all(|(_, off, digit)| off <= digit), "{off:?}");
    }
}
