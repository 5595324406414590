//! Two contact problems with known answers: values on given meshes, rates, limits.
//!
//! The energies on uniform meshes are those of two independent codes that discretise alike. The limits are the table of
//! thirteen digits that several adaptive meshes of two codes agree on.

use steklov::plan::first_mesh;
use steklov::solve::SolveError;
use steklov_bem_operators::Mesh;
use steklov_contact::ContactError;
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
            println!("{name} n {n:2} p {p:2} {solver:10}: off by {off:.1e}, {iterations} iterations, judge {worst:.1e}");
            assert!(a.converged() && off <= 1e-9 && iterations <= 12 && worst <= 1e-10, "n {n} p {p} {solver}: {off:e}");
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

#[test]
fn the_wedge_converges_with_second_order() {
    let answers: Vec<Answer> = [8, 16, 32, 64].map(|n| uniform("wedge-gap", n, 1, "newton")).into();
    let corner = |a: &Answer| {
        let at = a.solved.space.points.iter().position(|x| *x == [-0.5, -0.5]).expect("a corner is a node");
        [a.solved.displacement[2 * at], a.solved.displacement[2 * at + 1]]
    };
    let measures: [(&str, f64, &dyn Fn(&Answer) -> f64); 4] = [
        ("J", WEDGE, &|a| a.solved.energies.total),
        ("resultant", 31.150295, &|a| a.contact().force[1]),
        ("u_x at a corner", 0.00190323, &|a| corner(a)[0]),
        ("u_y at a corner", 0.01239241, &|a| corner(a)[1]),
    ];
    for (name, exact, measure) in measures {
        let errors: Vec<f64> = answers.iter().map(|a| (measure(a) - exact).abs()).collect();
        let rate = rate(&errors);
        println!("{name}: errors {}, rate {rate:.2}", short(&errors));
        assert!(rate > 1.75, "{name}: rate {rate}, errors {errors:?}");
    }
    // the contact length is a sum of whole nodal weights: off by at most one element, h = 1/n
    for (a, n) in answers.iter().zip([8.0, 16.0, 32.0, 64.0]) {
        let off = (a.contact().length - 2.0 * 0.25999231).abs();
        println!("n {n}: contact length off by {:.3} h", off * n);
        assert!(off <= 1.0 / n, "n {n}: {off}");
    }
}

/// Degree P on meshes geometric, ratio 0.17, towards the corners, the ends of contact and its middle.
fn geometric(name: &str, half_length: f64, degree: usize, solver: &str) -> Answer {
    let scene = scene(name, &[&format!("method.solver=\"{solver}\"")]);
    let corners = (0..4).map(|k| (k, 0.0));
    let inner = [0.5 - half_length, 0.5, 0.5 + half_length].map(|s| (0, s));
    let towards: Vec<(usize, f64)> = corners.chain(inner).collect();
    let mesh = Mesh::graded(&scene.polygon, &towards, degree, 0.17, |_| degree).expect("a valid mesh");
    answer_on(&scene, mesh)
}

#[test]
fn geometric_meshes_reach_the_limits() {
    for (name, half_length, energy) in [("block-on-floor", 0.42901463, BLOCK), ("wedge-gap", 0.25999231, WEDGE)] {
        let errors: Vec<f64> = [2, 4, 6].into_iter().map(|p| {
            let a = geometric(name, half_length, p, "newton");
            let off = (a.solved.energies.total - energy).abs();
            let (iterations, worst) = a.judged();
            let dofs = a.solved.space.dofs();
            println!("{name} P {p} dofs {dofs}: J off by {off:.1e}, {iterations} iterations, judge {worst:.1e}");
            let c = a.contact();
            println!("   length {} friction {:e} force {:?} max {}", c.length, a.solved.energies.friction_work, c.force, c.max_pressure);
            off
        }).collect();
        println!("{}", short(&errors));
    }
}
