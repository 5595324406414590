//! Points where stresses are infinite: uniform meshes converge algebraically, as fast as the strongest of them lets them,
//! hp meshes exponentially. Re-entrant corners, held corners and ends of contact are in `adaptive_rates.rs` and
//! `adaptive_references.rs`; here are points where conditions change on a straight side, and crack tips.

use steklov_bem_operators::PairCache;
use steklov_model::mesh::layout::Layout;
use steklov_model::run::adaptive_loop::Reason;
use steklov_model::solve::one_mesh::solve;
use steklov_problem::{Refine, Scene};
use steklov_tests::{adapt, line, parse};

/// A plate with a notch whose faces are 2e-3 apart at the mouth, torn open: λ = ½ but for the cube of that angle
/// (sin λω = -λ sin ω, Williams 1952).
fn crack() -> Scene {
    let text = "title = \"Crack\"\n[body]\n\
                corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [1e-3, 0.5], [0, 0], [-1e-3, 0.5], [-0.5, 0.5]]\n\
                sides = [\"bottom\", \"right\", \"rest\", \"face\", \"face\", \"rest\", \"left\"]\n\
                [material]\nyoung = 1.0\npoisson = 0.3\n\
                [sides.left]\ntraction = [\"-1 - y\", \"0\"]\n[sides.right]\ntraction = [\"1 + y\", \"0\"]\n";
    parse(text, &[]).unwrap_or_else(|e| panic!("{}", e.render()))
}

/// A square whose lower side is held on its left half and free on its right half: in the middle u ~ r^(½ ± iε),
/// ε = ln κ/(2π) (Williams 1952, plane strain). The roller on the left is an axis of symmetry: no other point is singular.
fn mixed(poisson: f64) -> Scene {
    let text = format!(
        "title = \"Mixed\"\n[body]\ncorners = [[-0.5, 0], [0, 0], [0.5, 0], [0.5, 1], [-0.5, 1]]\n\
         sides = [\"held\", \"free\", \"right\", \"top\", \"left\"]\n[material]\nyoung = 1.0\npoisson = {poisson:?}\n\
         [sides.held]\ndisplacement = [\"0\", \"0\"]\n[sides.left]\ndisplacement = [\"0\", \"free\"]\n[sides.top]\ntraction = [\"0.3\", \"1\"]\n"
    );
    parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render()))
}

/// Slope of log error over log h on uniform meshes, J measured against an hp solution.
fn uniform_slope(scene: &Scene, energy: f64, degree: usize, elements: &[usize]) -> f64 {
    let errors: Vec<f64> = elements
        .iter()
        .map(|&n| {
            let mut scene = scene.clone();
            (scene.method.refine, scene.method.elements, scene.method.degree) = (Refine::None, Some(n), degree);
            let Layout { subdivision, cuts, .. } = Layout::first(&scene);
            let mesh = subdivision.mesh(&scene.problem.outline).expect("a mesh");
            // without an estimate
            let solved = solve(&scene, (mesh, cuts.as_ref()), false, &mut PairCache::default(), &mut |_| Ok(()));
            let (solved, ..) = solved.unwrap_or_else(|e| panic!("{}: {e}", scene.title));
            ((solved.energies.total - energy) / energy).abs().sqrt()
        })
        .collect();
    let logs = |v: &[f64]| v.iter().map(|x| x.ln()).collect::<Vec<f64>>();
    let h: Vec<f64> = elements.iter().map(|&n| 1.0 / n as f64).collect();
    println!("{}, p = {degree}: {errors:.4?}", scene.title);
    line(&logs(&h), &logs(&errors)).0
}

/// J of an hp run down to 1e-6, the log of whose estimate must be straight over dofs^½ and steeper than an algebraic law.
fn hp_energy(scene: &Scene) -> f64 {
    let mut scene = scene.clone();
    scene.method.tolerance = Some(1e-6);
    let run = adapt(&scene).unwrap_or_else(|e| panic!("{}: {e}", scene.title));
    assert_eq!(run.reason, Reason::Tolerance, "{}", scene.title);
    let steps = &run.progress.steps;
    let logs: Vec<f64> = steps.iter().map(|s| s.estimate().relative.ln()).collect();
    let over = |power: fn(f64) -> f64| line(&steps.iter().map(|s| power(s.dofs as f64)).collect::<Vec<_>>(), &logs);
    let ((slope, straight), (_, algebraic)) = (over(f64::sqrt), over(f64::ln));
    println!(
        "{}: {} dofs, slope {slope:.3} over dofs^½, R² {straight:.4}, as a power {algebraic:.4}",
        scene.title,
        run.step().dofs
    );
    assert!(slope < -0.3 && straight > 0.98 && straight > algebraic, "{}: {straight} {algebraic}", scene.title);
    let estimate = run.step().estimate();
    assert!((estimate.energy - run.last.energies.total).abs() < 1e-10 * estimate.energy.abs());
    estimate.energy
}

#[test]
fn crack_tips_are_algebraic_for_uniform_meshes_and_exponential_for_hp() {
    let scene = crack();
    let energy = hp_energy(&scene);
    for (degree, elements) in [(1, &[128, 256, 512][..]), (2, &[64, 128, 256])] {
        let slope = uniform_slope(&scene, energy, degree, elements);
        println!("crack, p = {degree}: {slope:.3}, theory 0.5");
        assert!((slope / 0.5 - 1.0).abs() < 0.1, "p = {degree}: {slope}, not 0.5");
    }
}

#[test]
fn points_between_held_and_free_are_algebraic_for_uniform_meshes_and_exponential_for_hp() {
    // ε > 0 modulates the error over log h; it vanishes as ν → ½
    for poisson in [0.3, 0.4999999] {
        let scene = mixed(poisson);
        let energy = hp_energy(&scene);
        for (degree, elements) in [(1, &[128, 256, 512][..]), (3, &[64, 128, 256])] {
            let slope = uniform_slope(&scene, energy, degree, elements);
            println!("held and free, ν = {poisson}, p = {degree}: {slope:.3}, theory 0.5");
            assert!((slope / 0.5 - 1.0).abs() < 0.1, "ν = {poisson}, p = {degree}: {slope}, not 0.5");
        }
    }
}
