//! How much memory a run takes, and what it does where that is not there.

use std::sync::atomic::AtomicUsize;

use crate::place::{Place, Ran};
use steklov_model::run::adaptive_loop::{Progress, Reason, run};
use steklov_plan::NEXT_MESH;
use steklov_problem::Scene;

/// Unknowns and peak memory of two steps of degrees 3 and 4, with estimates.
fn two_steps(place: &Place, scene: &str, elements: usize) -> [f64; 2] {
    let elements = format!("method.elements={elements}");
    let uniform = ["method.refine=\"uniform-p\"", "method.degree=3", "method.max_steps=2", "method.tolerance=1e-14"];
    let sets = uniform.into_iter().chain([elements.as_str()]).flat_map(|s| ["--set", s]);
    let mut command = place.command();
    command.args(["solve", scene, "--json", "--force", "--threads", "2"]).args(sets);
    // memory that is freed goes back at once: else a peak depends on the time that passes before it does
    command.env("MIMALLOC_PURGE_DELAY", "0");
    let o = Ran::new(command.output().unwrap()).demand(3).json();
    assert_eq!((o["reason"].as_str(), o["steps"].as_u64()), (Some("max_steps"), Some(2)), "{o}");
    [&o["dofs"], &o["peak_memory_bytes"]].map(|v| v.as_f64().unwrap())
}

/// Of elements of degree 4 with an estimate: 24 n² bytes for the operators, 7.5 n² for the enriched spaces, and what contact
/// takes; the matrices of the step before are gone. A run of 800 unknowns tells what the program and its buffers of fixed size
/// take.
#[test]
fn an_adaptive_run_takes_35_bytes_for_each_pair_of_unknowns() {
    let place = Place::new();
    place.write("contact.toml", crate::place::BLOCK);
    let held = crate::place::BLOCK
        .replace("contact = { gap = \"0\", friction = { tresca = \"F\" } }", "displacement = [\"0\", \"0\"]");
    assert_ne!(held, crate::place::BLOCK);
    place.write("held.toml", held);
    for scene in ["contact.toml", "held.toml"] {
        let ([few, allowance], [n, peak]) = (two_steps(&place, scene, 100), two_steps(&place, scene, 300));
        assert_eq!([few, n], [800.0, 2400.0]);
        println!("{scene}: {n} dofs, {} bytes n² beyond those of a small run", (peak - allowance) / (n * n));
        assert!(peak < 35.0 * n * n + allowance, "{scene}: {} n² bytes", (peak - allowance) / (n * n));
        // the operators alone take as much: else nothing is measured
        assert!(peak > 24.0 * n * n, "{scene}: {} n² bytes", peak / (n * n));
    }
}

/// Matrices of 3n² + 5nx + 3x² numbers for a scene with points, x of the bubbles: of degree 1 n = x.
#[test]
fn where_memory_ends_a_run_it_says_so() {
    let text = crate::place::BLOCK.replace("refine = \"none\"", "refine = \"uniform-h\"\ntolerance = 1e-9");
    let mut scene = steklov_document::parse(&text, "scene", &[]).unwrap_or_else(|e| panic!("{}", e.render()));
    let ended = |scene: &Scene| {
        let run = run(scene, Progress::first(scene), &AtomicUsize::new(0), &mut |_, _| Ok(())).unwrap();
        (run.reason, run.step().dofs, run.progress.lack(scene).map(steklov_plan::without_memory))
    };
    for (memory, dofs) in [(11 * 8 * 64 * 64, 64), (11 * 8 * 64 * 64 - 1, 32)] {
        scene.method.memory = Some(memory);
        let (reason, last, told) = ended(&scene);
        assert_eq!((reason, last), (Reason::MaxDofs, dofs));
        let told = told.unwrap();
        assert!(told.what == NEXT_MESH && told.why.contains(&format!("memory is the limit: its {} dofs", 2 * dofs)));
    }
    // a given number of dofs ends it first
    scene.method.max_dofs = Some(40);
    let (reason, last, told) = ended(&scene);
    assert!((reason, last) == (Reason::MaxDofs, 32) && told.is_some());
    scene.method.memory = None;
    assert!(ended(&scene) == (Reason::MaxDofs, 32, None));
}

#[test]
fn the_plan_tells_how_large_meshes_may_be() {
    let place = Place::new();
    place.write("block.toml", crate::place::BLOCK.replace("refine = \"none\"\n", ""));
    let plan = place.run(["plan", "block.toml"]).demand(0).out;
    assert!(plan.contains("20000 dofs") && plan.contains("of memory that are left now"), "{plan}");
    let plan = place.run(["plan", "block.toml", "--set", "method.max_dofs=700"]).demand(0).out;
    assert!(plan.contains("700 dofs") && plan.contains("whatever the memory"), "{plan}");
}
