//! Quantities of random input: what is no number of an outcome is refused before anything is solved.

use std::sync::atomic::AtomicUsize;

use steklov_model::error::SolveError;
use steklov_model::run::adaptive_loop::{Event, Progress, run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_tests::scene;

#[test]
fn what_no_outcome_has_costs_no_solution() {
    for (path, is_number) in [
        ("energy", true),
        ("contact.force.y", true),
        ("reactions.top.x", true),
        ("reactions.left.x", false),
        ("probe.0.stress.0", false),
        ("contact.force.z", false),
        ("spring_energy", false),
        ("reactions.nowhere.x", false),
    ] {
        let scene = scene("29-random-modulus", &[&format!("stochastic.quantities=[{path:?}]")]);
        // the first thing that is done stops the run
        let stop = &mut |_, _: Event<'_, BoundaryElements>| Err(SolveError::Interrupted);
        let ran = run(&scene, Progress::first(&scene), &AtomicUsize::new(0), stop);
        match ran.err() {
            Some(SolveError::Interrupted) => assert!(is_number, "{path} is solved for"),
            Some(SolveError::Data(error)) => {
                let told = error.to_string();
                assert!(!is_number && told.contains("is not a number of the result"), "{path}: {told}");
            }
            other => panic!("{path}: {other:?}"),
        }
    }
}
