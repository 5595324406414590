//! Cross-crate tests, and what they share: solving a scene in process, and scenes that can be rotated and rescaled.

mod answer;
mod case;

pub use answer::{Answer, answer, answer_on, attempt, parse, scene};
pub use case::{Case, On, View, point_of, rotated};
