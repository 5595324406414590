//! Cross-crate tests, and what they share: solving a scene in process, and scenes that can be rotated and rescaled.

mod answer;
mod balance;
mod case;
mod random;
mod outcomes;
mod adaptive;

pub use adaptive::{
    InSteps, Judged, Levels, finer, judged, judged_in_steps, line, solved_beyond, solved_in_steps, step_below,
};
pub use answer::{
    Answer, adapt, answer, answer_on, attempt, attempt_grid, document, gallery, on_grid, parse, scene, scenes, summary,
};
pub use balance::{unbalanced_forces, unbalanced_nodes};
pub use case::{Case, On, View, point_of, rotated};
pub use outcomes::{outcomes, quantity, read};
pub use random::{Random, random_case};

/// Whether `STEKLOV_TESTS=full` asks for all cases of a test that has many of a kind.
pub fn full() -> bool {
    std::env::var("STEKLOV_TESTS").is_ok_and(|value| value == "full")
}

#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;

#[cfg(doctest)]
#[doc = include_str!("../../docs/crates.md")]
struct Crates;
