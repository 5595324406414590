//! Problems and methods of the gallery are stored, read back, and solved to the same bits.

use steklov_bem_operators::PairCache;
use steklov_io::{IoError, create_atomically, load, open, save};
use steklov_model::error::SolveError;
use steklov_model::mesh::layout::Layout;
use steklov_model::solve::one_mesh::solve;
use steklov_problem::{Method, Problem, Scene};
use steklov_tests::{attempt_grid, scenes};

/// J of the first mesh or grid.
fn energy(scene: &Scene) -> Result<f64, SolveError> {
    if scene.body().grid.is_some() {
        return Ok(attempt_grid(scene)?.step().energy);
    }
    let Layout { subdivision, cuts, .. } = Layout::first(scene);
    let mesh = subdivision.mesh(&scene.problem.outline)?;
    let (solved, ..) = solve(scene, (mesh, cuts.as_ref()), false, &mut PairCache::default(), &mut |_| Ok(()))?;
    Ok(solved.energies.total)
}

/// The first mesh alone: the numbers are compared, not judged.
const FEW: [&str; 3] = ["method.max_steps=1", "method.max_dofs=1200", "method.tolerance=0.01"];

fn stored(scene: &Scene) -> Result<(Problem, Method), IoError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("problem.h5");
    create_atomically(&path, false, |file| {
        save(file, "problem", &scene.problem)?;
        save(file, "method", &scene.method)
    })?;
    let file = open(&path)?;
    Ok((load(&file, "problem")?, load(&file, "method")?))
}

#[test]
fn scenes_are_solved_from_stored_problems_to_the_same_bits() {
    let (mut solved, mut refused) = (0, Vec::new());
    for (name, scene) in scenes(&FEW) {
        let (problem, method) = match stored(&scene) {
            Ok(parts) => parts,
            Err(why) => {
                refused.push((name, why.to_string()));
                continue;
            }
        };
        assert_eq!(method, scene.method, "{name}");
        if scene.random.is_some() {
            continue;
        }
        let back = Scene { problem, method, ..scene.clone() };
        let energies = [&scene, &back].map(|scene| energy(scene).map(f64::to_bits));
        match energies {
            [Ok(first), Ok(second)] => assert_eq!(first, second, "{name}"),
            [first, second] => panic!("{name}: {first:?} {second:?}"),
        }
        solved += 1;
    }
    println!("{solved} scenes; refused: {refused:?}");
    assert!(solved >= 55, "{solved}");
    for (name, why) in refused {
        assert!(why.contains("store the body and its cracks") || why.contains("is a random field"), "{name}: {why}");
    }
}
