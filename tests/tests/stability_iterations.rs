//! The contact solvers do not cycle: few iterations on every scene of the gallery, cold on uniform meshes, warm from step
//! to step of an adaptive run; all of them end on one answer.

use std::sync::atomic::AtomicUsize;

use steklov_bem_operators::{Mesh, PairCache};
use steklov_contact::{
    ContactBoundary, ContactError, Problem, Solution, Start, active_set, interior_point, kkt, newton,
};
use steklov_model::run::adaptive_loop::{Event, Progress, run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::solve::one_mesh::solve;
use steklov_model::stage::Stage;
use steklov_problem::{Cutting, Scene};
use steklov_tests::gallery;

type Solver = fn(&Problem, Option<Start<'_>>) -> Result<Solution, ContactError>;
const SOLVERS: [(&str, Solver); 2] = [("newton", newton), ("active-set", active_set)];

/// The scenes with contact.
fn scenes() -> impl Iterator<Item = (String, Scene)> {
    gallery().into_iter().filter(|(_, scene)| scene.contacts().next().is_some())
}

/// The condensed contact problem on a mesh; none without contact.
fn condensed(scene: &Scene, mesh: Mesh) -> Option<(ContactBoundary, Problem)> {
    let (solved, _, factors) =
        solve(scene, (mesh, None), false, &mut PairCache::default(), &mut |_| Ok(())).expect("a solution");
    Some((solved.contact?.boundary, factors.contact?.problem))
}

/// The condensed contact problems of the steps of a run without cuts.
fn condensed_in_steps(scene: &Scene) -> Vec<(ContactBoundary, Problem)> {
    let mut scene = scene.clone();
    scene.method.cuts = Cutting::None;
    let (mut boundaries, mut problems) = (Vec::new(), Vec::new());
    let first: Progress<BoundaryElements> = Progress::first(&scene);
    run(&scene, first, &AtomicUsize::new(0), &mut |_, event| {
        match event {
            Event::Stage(Stage::Contact(problem, _)) => problems.push(problem.clone()),
            Event::Done { solved, .. } => {
                boundaries.push(solved.contact.as_ref().expect("contact").boundary.clone());
            }
            Event::Stage(_) => {}
        }
        Ok(())
    })
    .unwrap_or_else(|e| panic!("{}: {e}", scene.title));
    assert_eq!(boundaries.len(), problems.len());
    boundaries.into_iter().zip(problems).collect()
}

/// A solution that says that it is one must be one.
fn judged(what: &str, problem: &Problem, solution: Result<Solution, ContactError>) -> Solution {
    let solution = solution.unwrap_or_else(|e| panic!("{what}: {e}"));
    let worst = kkt(problem, &solution).worst();
    assert!(!solution.converged() || worst <= 1e-10, "{what}: a wrong answer, {worst:e}");
    solution
}

/// Iterations of a solution.
fn iterations(what: &str, solution: &Solution) -> usize {
    assert!(solution.converged(), "{what}: {:?}", solution.outcome);
    solution.iterations
}

/// At most 12 by the active set; by Newton's method on the two references and their kin, and up to 24 where few nodes of
/// high degree are in contact.
#[test]
fn uniform_meshes_take_at_most_twelve_iterations_from_a_cold_start() {
    // sides of several bodies face each other with whole elements, of which a uniform mesh knows nothing
    for (name, scene) in scenes().filter(|(_, scene)| !scene.problem.has_several_bodies()) {
        let reference = ["15", "16", "17", "18"].iter().any(|number| name.starts_with(number));
        let allowed = [if reference { 12 } else { 24 }, 12];
        for (elements, degree) in [(16, 1), (64, 1), (32, 3), (16, 8)] {
            let mesh = Mesh::uniform(&scene.problem.outline, elements, degree);
            let (_, problem) = condensed(&scene, mesh).expect("contact");
            let counts = [0, 1].map(|k| {
                let (solver, by) = SOLVERS[k];
                let what = format!("{name}, {elements} elements of degree {degree}, by {solver}");
                iterations(&what, &judged(&what, &problem, by(&problem, None)))
            });
            println!("{name}, {elements} elements of degree {degree}: {counts:?}");
            assert!((0..2).all(|k| counts[k] <= allowed[k]), "{name}: {counts:?} of {allowed:?}");
        }
    }
}

/// The values of the nearest node of another mesh.
fn carried(
    (from, solution): &(ContactBoundary, Solution),
    (to, problem): &(ContactBoundary, Problem),
) -> (Vec<f64>, Vec<[f64; 2]>) {
    // the first multiplier of each node
    let first: Vec<usize> =
        (0..from.contact.len()).map(|k| from.contact[..k].iter().map(|c| c.conditions.len()).sum()).collect();
    let (mut displacement, mut multipliers) = (vec![0.0; problem.load.len()], Vec::new());
    for (node, contact) in to.nodes.iter().zip(&to.contact) {
        let distance = |k: &usize| {
            let other = from.nodes[*k].point;
            (other[0] - node.point[0]).hypot(other[1] - node.point[1])
        };
        let alike = |k: &usize| {
            let other = &from.contact[*k];
            (other.unknowns, other.conditions.len()) == (contact.unknowns, contact.conditions.len())
        };
        let nearest = (0..from.nodes.len()).filter(alike).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        match nearest {
            Some(k) => {
                let old = from.contact[k].first;
                displacement[contact.first..][..contact.unknowns]
                    .copy_from_slice(&solution.displacement[old..][..contact.unknowns]);
                multipliers.extend_from_slice(&solution.multipliers[first[k]..][..contact.conditions.len()]);
            }
            None => multipliers.extend(vec![[0.0; 2]; contact.conditions.len()]),
        }
    }
    (displacement, multipliers)
}

/// At most 15 by the active set from the last step's answer. The interior point method, which a scene gets by default and
/// which starts cold, takes at most 25, but for Coulomb's law. Cold starts of the others are told; one that does not end must say so.
#[test]
fn steps_of_adaptive_runs_take_at_most_fifteen_iterations_from_the_last_answer() {
    let (mut interior, mut newtons, mut cold, mut warm) = (0, 0, 0, 0);
    // the wedge turned and the wedge by points have the steps of the wedge
    for (name, scene) in scenes().filter(|(name, _)| !name.starts_with("18") && !name.starts_with("75")) {
        // of random input the mean
        let mut scene = Scene { random: None, ..scene };
        scene.method.tolerance = Some(1e-5);
        scene.method.max_dofs = Some(400);
        let mut last: Option<(ContactBoundary, Solution)> = None;
        for (step, here) in condensed_in_steps(&scene).into_iter().enumerate() {
            let what = format!("{name} step {step}");
            let auto = judged(&what, &here.1, interior_point(&here.1));
            let count = |solver: &str, solution: Result<Solution, ContactError>| {
                let what = format!("{what} by {solver}");
                let solution = judged(&what, &here.1, solution);
                let off = off(&auto.displacement, &solution.displacement);
                // under Coulomb's law a coarse mesh on which the body hangs by a node or two may have several
                let one = off <= 1e-8 || here.1.is_coulomb();
                assert!(!solution.converged() || one, "{what}: two answers, {off:e} apart");
                iterations(&what, &solution)
            };
            let by_newton = judged(&what, &here.1, newton(&here.1, None));
            let [a, b] = [iterations(&what, &auto), count("active set, cold", active_set(&here.1, None))];
            let c = last.map(|last| {
                let (displacement, multipliers) = carried(&last, &here);
                let start = Start { displacement: &displacement, multipliers: &multipliers };
                count("active set, warm", active_set(&here.1, Some(start)))
            });
            println!(
                "{what}: interior point {a}, active set {b} cold, {c:?} warm, newton {} cold ({:?})",
                by_newton.iterations, by_newton.outcome
            );
            // under Coulomb's law these are the iterations of several Tresca problems
            interior = interior.max(if here.1.is_coulomb() { 0 } else { a });
            (cold, warm) = (cold.max(b), warm.max(c.unwrap_or(0)));
            newtons = newtons.max(by_newton.iterations);
            last = Some((here.0, auto));
        }
    }
    println!("most: interior point {interior}, active set {cold} cold, {warm} warm, newton {newtons} cold");
    assert!(interior <= 25 && warm <= 15, "{interior} {warm}");
}

/// max |a - b| / max |a|.
fn off(a: &[f64], b: &[f64]) -> f64 {
    let largest = a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    a.iter().zip(b).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / largest.max(f64::MIN_POSITIVE)
}
