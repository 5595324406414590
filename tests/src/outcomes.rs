//! Outcomes of random input on grids.

use steklov_model::grid::GridLayout;
use steklov_model::stochastic::{OutcomesWatch, Quantity, StochasticResult, solve_stochastic_on_grid};
use steklov_problem::Scene;

use crate::parse;

/// The scene of a text that is right.
pub fn read(text: &str) -> Scene {
    parse(text, &[]).unwrap_or_else(|e| panic!("{}", e.render()))
}

/// All outcomes of a scene on a grid.
pub fn outcomes(scene: &Scene) -> StochasticResult {
    let random = scene.random.as_ref().expect("random input");
    let layout = GridLayout::first(scene).unwrap_or_else(|e| panic!("{e}"));
    solve_stochastic_on_grid(scene, random, &layout, &OutcomesWatch::NONE, &mut |_| Ok(()))
        .unwrap_or_else(|e| panic!("{e}"))
}

/// The statistics of the quantity at a path.
pub fn quantity<'a>(result: &'a StochasticResult, name: &str) -> &'a Quantity {
    result.quantities.iter().find(|q| q.name == name).unwrap_or_else(|| panic!("no {name}"))
}
