//! Tests that compare all solvers with each other and with oracles.

mod floating;
mod laws;
mod oracle;
mod boundaries;
mod refusals;
mod solvers;
