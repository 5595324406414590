//! Tests that compare all solvers with each other and with oracles.

mod floating;
mod laws;
mod oracle;
mod boundaries;
mod interior_points;
mod refusals;
mod solvers;
