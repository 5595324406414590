//! The fields of solved bodies on an unstructured grid, for pictures and viewers.
//!
//! ```text
//! Answer ─► bodies (triangulate ─► follow), or the cells of a grid ─► Grid ◄─ window of the medium around them
//! ```
//!
//! ```
//! use steklov_fields::fields;
//! use steklov_fields::steklov_model::prelude::*;
//! use steklov_fields::steklov_unstructured::Grid;
//!
//! // a block on a smooth floor under pressure: σ_yy = -3 everywhere
//! let corners = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
//! let sides = ["floor", "right", "top", "left"].map(str::to_owned).to_vec();
//! let mut scene = Scene::new(Polygon::new(Loop::straight(corners, sides), vec![])?, Material::new(200.0, 0.3, Plane::Strain)?);
//! scene.problem.touch(0, Contact { gap: Expression::number(0.0), friction: Friction::None });
//! scene.problem.sides[2].condition = Condition::Pressure(Expression::number(3.0));
//! let grid = fields(&scene, &solve(&scene)?);
//! let stress = Grid::field(&grid.point_data, "stress", 3).expect("bodies of boundary elements have it at points");
//! for of_point in stress.values.chunks_exact(3) {
//!     assert!(of_point[0].abs() < 1e-9 && (of_point[1] + 3.0).abs() < 1e-9 && of_point[2].abs() < 1e-9);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// the crates whose types are in the interface
pub use {steklov_model, steklov_picture, steklov_problem, steklov_unstructured};

mod bodies;
mod cells;
mod factor;
mod follow;
mod medium;
pub mod triangulate;
mod window;

pub use bodies::bodies;
pub use cells::cells;
pub use factor::{Deformed, largest_factor};
pub use medium::{add_medium, body_part};
pub use window::{Window, window};

use steklov_elastic::plane::norm;
use steklov_model::solve::medium::Around;
use steklov_model::{Answer, AnyRun};
use steklov_picture::exaggeration;
use steklov_problem::Scene;
use steklov_unstructured::Grid;

/// The fields of the last solution of a scene, and those of the mean of its random input: of boundary elements displacement, stress and
/// von Mises stress at points, of finite elements on a grid displacement at points and stress, von Mises stress and moduli in cells. With
/// a medium around the body also in a window of it.
///
/// *Cost*: thousands of evaluations, each an integral over the boundary: some tenths of a second.
pub fn fields(scene: &Scene, answer: &Answer) -> Grid {
    let outcomes = answer.outcomes.as_ref();
    let (mut grid, around): (Grid, Option<&Around>) = match &answer.run {
        AnyRun::BoundaryElements(run) => (bodies(scene, run, outcomes), run.last.around.as_ref()),
        AnyRun::OnGrid(run) => (cells(&run.last, outcomes), run.last.around.as_ref()),
    };
    if let Some(around) = around {
        add_medium(&mut grid, around, &window(&scene.problem.outline, around));
    }
    grid
}

/// The factor at which the displacements of an answer with these fields are drawn: so large that they are seen, and no larger than
/// [`largest_factor`].
pub fn enlargement(answer: &Answer, grid: &Grid) -> f64 {
    let trace = answer.run.trace();
    let displacement: Vec<[f64; 2]> = trace.displacement.chunks_exact(2).map(|u| [u[0], u[1]]).collect();
    let most = largest_factor(&Deformed {
        points: &trace.space.points,
        displacement: &displacement,
        side_names: &trace.mesh.side_names,
        interfaces: &answer.summary.interfaces,
        contact: &answer.contact,
        ties: answer.run.ties(),
        grid,
    });
    let extent = |i: usize| {
        let along = || grid.points.iter().map(|x| x[i]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    let largest = displacement.iter().map(|u| norm(*u)).fold(0.0, f64::max);
    exaggeration(largest / extent(0).max(extent(1)), most.factor)
}
