//! Tests that compare all solvers with each other and with oracles, and tests of what follows the contact sets.

mod oracle;
mod rows;
mod boundaries;
mod bubbles;
mod coulomb;
mod floating;
mod frozen;
mod interior_points;
mod laws;
mod lines;
mod moved_ends;
mod refusals;
mod solvers;
mod sparse;
mod tips;
mod transitions;
