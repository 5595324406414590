//! Results of problems: the record of a run, and its HDF5 file, which h5py and ParaView read.
//!
//! ```text
//! Run ─► Record (fields, contact table, steps, summary, plan) ─► store::write ─► file
//! file ─► store::read ─► Record          file ─► Keep::read_steps ─► steps from which a run goes on
//! ```
//!
//! ```
//! use steklov_result::steklov_document::Document;
//! use steklov_result::steklov_io::{create_atomically, open};
//! use steklov_result::steklov_model::run::boundary_elements::unobserved;
//! use steklov_result::steklov_plan::plan;
//! use steklov_result::{record::Record, store};
//!
//! let text = r#"
//! body = { corners = [[0, 0], [2, 0], [2, 1], [0, 1]], sides = ["floor", "right", "top", "left"] }
//! material = { young = 200, poisson = 0.3 }
//! sides.floor.contact = { gap = "0" }
//! sides.top.pressure = 3
//! "#;
//! let document = Document::parse(text, "block.toml", &[])?;
//! let scene = &document.scene;
//! let path = std::env::temp_dir().join(format!("steklov-result-{}.vtkhdf", std::process::id()));
//! let run = unobserved(scene)?;
//! let record = Record::new(scene, plan(scene), &run, None, &path, 0.0);
//! create_atomically(&path, true, |file| {
//!     let queue = store::StepQueue::new(file);
//!     for step in &run.progress.steps {
//!         queue.push(step.clone());
//!         queue.write_next();
//!     }
//!     queue.finish()?;
//!     store::write(file, &record, &document.source)
//! })?;
//! let again = store::read(&open(&path)?)?;
//! assert_eq!((&again.displacement, &again.traction), (&record.displacement, &record.traction));
//! # std::fs::remove_file(&path)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// the crates whose types are in the interface
pub use {steklov_document, steklov_fields, steklov_io, steklov_model, steklov_plan, steklov_problem};

mod answer;
pub mod grid;
pub mod history;
pub mod keep;
mod medium;
pub mod outcomes;
mod probes;
pub mod record;
pub mod stages;
pub mod steps;
pub mod store;

pub use answer::save;
