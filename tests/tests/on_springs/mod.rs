//! A block with springs on its sides, solved.

use steklov_model::run::adaptive_loop::Run;
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_problem::Scene;
use steklov_tests::{adapt, parse};

pub fn scene(text: &str) -> Scene {
    parse(text, &[]).unwrap_or_else(|e| panic!("{}", e.render()))
}

pub fn solved(text: &str) -> Run<BoundaryElements> {
    adapt(&scene(text)).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

pub fn force(run: &Run<BoundaryElements>, side: &str) -> [f64; 2] {
    run.last.reactions.iter().find(|(name, _)| name == side).unwrap_or_else(|| panic!("a reaction of {side}")).1
}

/// A block 0 ≤ x ≤ 2, 0 ≤ y ≤ 1 of E = 100, ν = 0.3 in plane stress, with conditions on its sides.
pub fn block(conditions: &str) -> String {
    format!(
        "body.corners = [[0,0],[2,0],[2,1],[0,1]]\nbody.sides = [\"floor\",\"right\",\"top\",\"left\"]\n\
         material = {{ young = 100.0, poisson = 0.3, plane = \"stress\" }}\n{conditions}"
    )
}

pub fn close(found: f64, exact: f64, part: f64, what: &str) {
    let off = (found / exact - 1.0).abs();
    println!("{what}: {found:.12e}, off by {off:.1e}");
    assert!(off <= part, "{what}: {found:e}, not {exact:e}");
}
