//! One scene at many values of its keys.
//!
//! ```text
//! Points ─► solve_points (several at once) ─► Outcome of each ─► Sweep ─► HDF5, CSV, charts
//!                                     └─► Journal, line by line: what was finished survives ─► resumed
//! ```
//!
//! ```
//! use std::sync::atomic::AtomicUsize;
//! use steklov_sweep::steklov_document::Document;
//! use steklov_sweep::{Observer, Points, Sweep, solve_points};
//!
//! let text = r#"
//! body = { corners = [[0, 0], [2, 0], [2, 1], [0, 1]], sides = ["floor", "right", "top", "left"] }
//! material = { young = 200, poisson = 0.3 }
//! parameters.p = 1
//! sides.floor.contact = { gap = "0" }
//! sides.top.pressure = "p"
//! "#;
//! let document = Document::parse(text, "block.toml", &[])?;
//! let mut sweep = Sweep::new(&document, Points::vary(&["parameters.p=1:3:3"], false)?);
//! let mut outcomes = Vec::new();
//! let mut keep = |point, outcome: &_| Ok(outcomes.push((point, Clone::clone(outcome))));
//! let observer = Observer { interrupts: &AtomicUsize::new(0), keep: &mut keep };
//! solve_points(&document, &sweep.points, &[0, 1, 2], 2, observer)?;
//! outcomes.into_iter().for_each(|(point, outcome)| sweep.outcomes[point] = Some(outcome));
//!
//! // pressed alike everywhere: J = -p² (1-ν²) A / 2E
//! let energies = sweep.quantities().column("energy").expect("all points are solved");
//! for (p, energy) in [1.0, 2.0, 3.0].iter().zip(energies) {
//!     let exact = -0.5 * p * p * (1.0 - 0.3 * 0.3) * 2.0 / 200.0;
//!     assert!((energy / exact - 1.0).abs() < 1e-10);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// the crates whose types appear in the interface
#[cfg(feature = "hdf5")]
pub use steklov_io;
pub use {steklov_document, steklov_picture};

mod error;
mod points;
mod solve;
mod journal;
mod quantities;
mod sweep;
#[cfg(feature = "hdf5")]
mod store;
mod charts;

pub use charts::charts;
pub use error::SweepError;
pub use journal::Journal;
pub use points::{MOST_POINTS, Points};
pub use quantities::Quantities;
pub use solve::{Observer, Outcome, solve_points};
#[cfg(feature = "hdf5")]
pub use store::{read, write};
pub use sweep::{Sweep, write_table};
