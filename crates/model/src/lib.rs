//! Problems solved: from a [`steklov_problem::Scene`] to its displacements, tractions, contact, energies and their errors.
//!
//! ```text
//! Scene ─► Layout ─► solve (mesh by mesh) ─► estimate ─► next Layout ... ─► Run ─► answer: Summary
//!                                                                          └─► all outcomes of random input
//! run::adaptive_loop::run of BoundaryElements, of OnGrid: one loop, two models
//! ```
//!
//! [`solve()`] goes all of that way:
//!
//! ```
//! use steklov_model::prelude::*;
//!
//! let corners = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
//! let sides = ["floor", "right", "top", "left"].map(str::to_owned).to_vec();
//! let block = Polygon::new(Loop::straight(corners, sides), vec![])?;
//! let mut scene = Scene::new(block, Material::new(200.0, 0.3, Plane::Strain)?);
//! let friction = Friction::Coulomb(Expression::number(0.3));
//! scene.problem.touch(0, Contact { gap: Expression::number(0.0), friction });
//! scene.problem.sides[2].condition = Condition::Pressure(Expression::number(1.0));
//! let answer = solve(&scene)?;
//! let contact = answer.summary.contact.expect("the block stands on its floor");
//! assert!(answer.summary.converged && (contact.force[1] - 2.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod answer;
pub mod bars;
mod contact_length;
pub mod data;
pub mod doubt;
pub mod energies;
pub mod error;
pub mod estimate;
pub mod estimators;
pub mod grid;
pub mod mesh;
mod named;
pub mod numbers;
pub mod quantities;
mod reacting;
pub mod refine;
pub mod run;
pub mod solve;
mod solve_scene;
pub mod stage;
pub mod stochastic;
pub mod summary;
mod zone_bars;

pub use solve_scene::{Answer, AnyRun, OnLastMesh, Told, Watch, solve, solve_watched};

/// The items that a program needs to make a scene and solve it.
pub mod prelude {
    pub use steklov_bem_operators::{Loop, Polygon};
    pub use steklov_elastic::{Material, Plane};
    pub use steklov_expression::Expression;
    pub use steklov_problem::{
        Body, Condition, Contact, Friction, Germ, Law, Place, Problem, Random, RandomConstants, RandomName, Scene,
        Springs, Stochastic, Substance, Tie,
    };
    pub use steklov_stochastic::Distribution;

    pub use crate::solve_scene::{Answer, solve};
}

// the crates whose types appear in the input of a run
pub use {
    steklov_bem_operators, steklov_coupling, steklov_elastic, steklov_expression, steklov_problem, steklov_stochastic,
};
