//! A stored result, or a study, as one page that loads nothing; a result also as the lines of a [`summary`] and as a table of a
//! document ([`format`](mod@format)).
//!
//! ```text
//! result file ─► Record, steps ─► numbers, doubts, steps, contact, pictures, body (triangles with their fields) ─► index.html
//! ```
//!
//! ```
//! use steklov_report::steklov_io::{create_atomically, open};
//! use steklov_report::steklov_result::steklov_document::Document;
//! use steklov_report::steklov_result::steklov_model::run::boundary_elements::unobserved;
//! use steklov_report::steklov_result::steklov_plan::plan;
//! use steklov_report::steklov_result::{record::Record, store};
//!
//! let text = r#"
//! body = { corners = [[0, 0], [2, 0], [2, 1], [0, 1]], sides = ["floor", "right", "top", "left"] }
//! material = { young = 200, poisson = 0.3 }
//! sides.floor.contact = { gap = "0" }
//! sides.top.pressure = 3
//! "#;
//! let document = Document::parse(text, "block.toml", &[])?;
//! let scene = &document.scene;
//! let path = std::env::temp_dir().join(format!("steklov-report-{}.vtkhdf", std::process::id()));
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
//!
//! // the floor bears 3 on a length of 2, and the page says so to the last digit
//! let page = steklov_report::page(&open(&path)?, "block.vtkhdf")?;
//! let told = format!("<data value=\"{:?}\">6</data>", record.summary.reactions["floor"][1]);
//! assert!(page.contains(&told) && page.len() < steklov_report::LARGEST);
//! # std::fs::remove_file(&path)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// the crates of whose types the interface is made
pub use {steklov_io, steklov_result};

mod body;
pub mod compare;
mod contact;
mod convergence;
pub mod format;
mod images;
mod numbers;
mod page;
mod study;
pub mod summary;
pub mod told;

use std::path::{Path, PathBuf};

use steklov_io::{File, IoError};
use steklov_picture::{PictureError, replace};

pub use page::page;
pub use study::{Drawn, is_study, pictures_beside, study_page};

/// Bytes that a page has at most.
pub const LARGEST: usize = 1_000_000;

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The result file cannot be read.
    #[error(transparent)]
    Io(#[from] IoError),
    /// A picture cannot be drawn, or the page not be written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The page cannot be made of its parts.
    #[error("the page cannot be made: {0}")]
    Page(String),
}

/// Writes `index.html` into a folder, which is made if it is missing; `path` is that of the file. Of a study it has the pictures
/// beside its file.
///
/// # Errors
/// A file that is no result, and a folder that cannot be written into.
pub fn write(file: &File, path: &Path, folder: &Path) -> Result<PathBuf, ReportError> {
    let name = path.file_name().map_or_else(|| "result".into(), |name| name.to_string_lossy());
    let page = match is_study(file) {
        true => study_page(file, &name, pictures_beside(path))?,
        false => page(file, &name)?,
    };
    let path = folder.join("index.html");
    let written = std::fs::create_dir_all(folder).and_then(|()| replace(folder, &path, page.as_bytes()));
    written.map_err(|source| PictureError::Write { path: path.clone(), source })?;
    Ok(path)
}
