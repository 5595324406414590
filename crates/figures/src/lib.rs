//! Pictures and tables of results.
//!
//! ```text
//! Record ─► pictures (SVG, PNG)          Record ─► tables (CSV)
//! ```
//!
//! ```
//! use steklov_figures::steklov_result::record::Record;
//! use steklov_figures::steklov_result::steklov_document::Document;
//! use steklov_figures::steklov_result::steklov_model::run::boundary_elements::unobserved;
//! use steklov_figures::steklov_result::steklov_plan::plan;
//!
//! let text = r#"
//! body = { corners = [[0, 0], [2, 0], [2, 1], [0, 1]], sides = ["floor", "right", "top", "left"] }
//! material = { young = 200, poisson = 0.3 }
//! sides.floor.contact = { gap = "0" }
//! sides.top.pressure = 3
//! "#;
//! let document = Document::parse(text, "block.toml", &[])?;
//! let scene = &document.scene;
//! let folder = std::env::temp_dir().join(format!("steklov-figures-{}", std::process::id()));
//! let record = Record::new(scene, plan(scene), &unobserved(scene)?, None, &folder, 0.0);
//! let files = steklov_figures::tables(&record, &folder, "block")?;
//!
//! // the floor bears what presses on the top, everywhere
//! let table = std::fs::read_to_string(files.last().expect("the contact table"))?;
//! let column = table.lines().next().and_then(|head| head.split(',').position(|name| name == "pressure"));
//! for row in table.lines().skip(1) {
//!     let pressure: f64 = row.split(',').nth(column.expect("a column")).expect("a number").parse()?;
//!     assert!((pressure - 3.0).abs() < 1e-9);
//! }
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// the crates whose types are in the interface
pub use {steklov_picture, steklov_result};

mod beside;
mod draw;
mod meshes;
mod grid;
mod probe;
pub mod stochastic;
mod view;

pub use beside::beside;
pub use draw::{contact_pictures, drawn, obstacles, pictures, positions, side_file, tables};
pub use grid::{Difference, difference, difference_picture};
pub use meshes::{StepMesh, mesh_picture, mesh_pictures};
pub use view::{Scalar, Unit, View};
