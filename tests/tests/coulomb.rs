//! Coulomb friction from the scene to the numbers: closed forms, published values, limits, refusals, the estimate.

use std::path::Path;

use proptest::prelude::*;
use steklov::plan::plan;
use steklov::record::Record;
use steklov::reference::true_error;
use steklov::run::Run;
use steklov::scene::Scene;
use steklov::summary::Summary;
use steklov_bem_operators::{Mark, Subdivision};
use steklov_contact::{Problem, Solution, TipKind, fixed_point, interior_point, kkt, newton};
use steklov_tests::adapt;

fn scene(name: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenes/{name}.toml"));
    Scene::read(&path, &overrides).unwrap_or_else(|e| panic!("{name}: {}", e.render()))
}

fn run(scene: &Scene) -> Run {
    adapt(scene).unwrap_or_else(|e| panic!("{}: {e}", scene.title))
}

fn summary(scene: &Scene) -> Summary {
    Record::new(scene, plan(scene), run(scene), Path::new("none.vtkhdf"), 0.0).summary
}
