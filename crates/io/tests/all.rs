//! The tests of the crate, one program.

mod arrays;
mod atomic;
mod common;
#[cfg(all(feature = "msfem", feature = "coupling"))]
mod coupling;
mod damage;
mod foreign;
#[cfg(feature = "msfem")]
mod msfem;
#[cfg(feature = "contact")]
mod multipliers;
#[cfg(feature = "problem")]
mod problem;
mod python;
#[cfg(feature = "contact")]
mod steklov;
#[cfg(feature = "stochastic")]
mod stochastic;
#[cfg(feature = "contact")]
mod types;
