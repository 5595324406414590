//! Cross-crate tests, and what they share: solving a scene in process, and scenes that can be rotated and rescaled.

mod answer;
mod balance;
mod case;
mod random;
mod outcomes;
mod adaptive;

pub use adaptive::{Judged, finer, judged, line, solved_in_steps, step_below};
pub use answer::{
    Answer, adapt, answer, answer_on, attempt, attempt_grid, document, gallery, on_grid, parse, scene, scenes, summary,
};
pub use balance::{unbalanced_forces, unbalanced_nodes};
pub use case::{Case, On, View, point_of, rotated};
pub use outcomes::{outcomes, quantity, read};
pub use random::{Random, random_case};

#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;

#[cfg(doctest)]
#[doc = include_str!("../../docs/crates.md")]
struct Crates;
