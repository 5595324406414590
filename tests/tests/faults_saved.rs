//! A step that is done once more, after a fault of the linear algebra, while its matrices are stored.

use std::sync::atomic::AtomicUsize;

use steklov_algebra::{Spoiler, disarm};
use steklov_io::File;
use steklov_model::run::adaptive_loop::{Event, Progress, Run, run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_problem::Scene;
use steklov_result::stages::{Saved, save_stage};
use steklov_result::store::observed;
use steklov_tests::scene;

/// Runs a scene and stores the matrices of its steps; all entries of those that are there.
fn stored(scene: &Scene) -> (Run<BoundaryElements>, Vec<Vec<f64>>) {
    let folder = tempfile::tempdir().unwrap();
    let file = File::create(folder.path().join("steps.h5")).unwrap();
    let run = run(scene, Progress::first(scene), &AtomicUsize::new(0), &mut |number, event| match event {
        Event::Stage(stage) => save_stage(&file, number, &stage, &[Saved::Matrices]).map_err(observed),
        Event::Done { .. } => Ok(()),
    });
    let run = run.unwrap_or_else(|e| panic!("{e}"));
    let names = |k: usize| ["V", "K", "W", "S"].map(|name| format!("steps/{k:03}/matrices/{name}"));
    let read = |path: String| file.dataset(&path).unwrap_or_else(|e| panic!("{path}: {e}")).read_raw::<f64>().unwrap();
    let all = (0..run.progress.steps.len()).flat_map(names).map(read).collect();
    (run, all)
}

#[test]
fn a_step_that_is_done_once_more_has_its_matrices_stored_once() {
    let scene = scene("15-block-on-floor", &["method.tolerance=5e-2"]);
    Spoiler { after: usize::MAX, kind: 63, seed: 0, lasting: false }.arm();
    let (wanted, matrices) = stored(&scene);
    let (results, _) = disarm();
    assert!(results > 4 && matrices.len() > 4);
    // the first result is spoilt before anything is stored, the others behind V, K, W of their step
    for after in [0, 1, results / 2, results - 1] {
        Spoiler { after, kind: 63, seed: 1, lasting: false }.arm();
        let (run, found) = stored(&scene);
        assert_eq!(disarm().1, 1, "result {after}");
        assert!(run.error.is_none(), "result {after}: {:?}", run.error);
        assert_eq!(run.last.energies.total.to_bits(), wanted.last.energies.total.to_bits(), "result {after}");
        assert_eq!(found, matrices, "result {after}");
    }
}
