//! The figures of a thesis on contact, random input, multiscale and coupled methods, made again and judged, as one page.
//!
//! ```text
//! Entry (what a figure is, its runs) ─► runs, each once ─► Figure (pictures, numbers) ─► Gallery ─► page, JSON, files
//! ```
//!
//! ```
//! // without its run a figure says what is missing
//! let stopped = std::sync::atomic::AtomicUsize::new(1);
//! let mut tell = |_: &str, _: &str| {};
//! let mut watch = steklov_gallery::steklov_study::Watch::new(&stopped, &mut tell);
//! let gallery = steklov_gallery::make(&["fig-2-3".to_owned()], &mut watch)?;
//! assert!(!gallery.holds() && gallery.page()?.contains("Multiplier"));
//! assert!(steklov_gallery::make(&["fig-9".to_owned()], &mut watch).is_err());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// the crates whose types are in the interface
pub use steklov_study;

mod runs;
mod figure;
mod charts;
mod chapter_2;
mod chapter_3;
mod chapter_4;
mod chapter_5;
mod own;
mod page;

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use steklov_figures::View;
use steklov_picture::{PictureError, replace, write};
use steklov_study::Watch;

use figure::{Entry, Expected, Figure, Row, Runs};
use runs::{Made, RUNS, Run};

/// The title of the page.
const TITLE: &str = "The figures of the source";

/// Why a gallery cannot be made.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GalleryError {
    /// A name that is neither the name of a figure nor its beginning.
    #[error("there is no figure {name:?}; did you mean {nearest:?}? The figures are {all}")]
    Unknown {
        /// The name.
        name: String,
        /// The nearest one.
        nearest: String,
        /// All names.
        all: String,
    },
    /// The page could not be made of its parts.
    #[error("the page cannot be made: {0}")]
    Page(String),
}

/// Figures with their pictures and numbers.
pub struct Gallery {
    shown: Vec<Drawn>,
    /// Wall seconds of all runs.
    seconds: f64,
}

/// A figure, its pictures and numbers, and the reason why a part of it is missing.
struct Drawn {
    entry: &'static Entry,
    figure: Figure,
    /// Wall seconds of its runs.
    seconds: f64,
    missing: Option<String>,
}

/// All figures in their order.
fn entries() -> impl Iterator<Item = &'static Entry> {
    let of_source =
        chapter_2::FIGURES.iter().chain(&chapter_3::FIGURES).chain(&chapter_4::FIGURES).chain(&chapter_5::FIGURES);
    of_source.chain(&own::FIGURES)
}

/// The names of all figures.
pub fn names() -> Vec<&'static str> {
    entries().map(|entry| entry.name).collect()
}

/// Whether all of these are names or beginnings of names.
///
/// # Errors
/// [`GalleryError::Unknown`] for the first name that is not.
pub fn check(only: &[String]) -> Result<(), GalleryError> {
    let is_known = |name: &String| names().iter().any(|known| known.starts_with(name.as_str()));
    match only.iter().find(|name| !is_known(name)) {
        None => Ok(()),
        Some(name) => {
            let nearest = steklov_expression::nearest(name, names()).unwrap_or("fig-2-1").to_owned();
            Err(GalleryError::Unknown { name: name.clone(), nearest, all: names().join(", ") })
        }
    }
}

/// Number of runs that figures of these names need.
pub fn number_of_runs(only: &[String]) -> usize {
    needed(&chosen(only)).len()
}

/// The figures of these names or beginnings of names, all if there are none.
fn chosen(only: &[String]) -> Vec<&'static Entry> {
    let wanted = |entry: &&Entry| only.is_empty() || only.iter().any(|name| entry.name.starts_with(name.as_str()));
    entries().filter(wanted).collect()
}

fn needed(entries: &[&Entry]) -> Vec<&'static Run> {
    RUNS.iter().filter(|run| entries.iter().any(|entry| entry.runs.contains(&run.name))).collect()
}

/// Makes the figures of these names or beginnings of names, all if there are none: each run once. After a request to
/// stop, no further run begins, and the figures that need one say so.
///
/// # Errors
/// As [`check`].
pub fn make(only: &[String], watch: &mut Watch<'_>) -> Result<Gallery, GalleryError> {
    check(only)?;
    let chosen = chosen(only);
    let needed = needed(&chosen);
    let mut made: Vec<(&'static Run, Result<Made, String>)> = Vec::new();
    for (k, run) in needed.iter().enumerate() {
        if watch.stopped() {
            break;
        }
        let what = format!("{} of {}: {}", k + 1, needed.len(), run.what);
        watch.tell(&what, "");
        let interrupts = watch.interrupts();
        let tell = &mut |part: &str, _: &str| watch.tell(&what, part);
        let found = run.make(&mut Watch::new(interrupts, tell));
        made.push((run, found));
    }
    let drawn = |entry: &'static Entry| {
        let runs = Runs { made: &made, view: View { range: entry.range, hides_cells: true, ..View::default() } };
        let mut figure = Figure::default();
        let missing = (entry.draw)(&runs, &mut figure).err();
        let seconds = entry.runs.iter().filter_map(|run| runs.get(run).ok()).map(|made| made.seconds).sum();
        Drawn { entry, figure, seconds, missing }
    };
    let seconds = made.iter().filter_map(|(_, found)| found.as_ref().ok()).map(|made| made.seconds).sum();
    Ok(Gallery { shown: chosen.into_iter().map(drawn).collect(), seconds })
}

impl Drawn {
    /// Whether nothing is missing and every number is as expected.
    fn holds(&self) -> bool {
        self.missing.is_none() && self.figure.rows.iter().all(Row::holds)
    }

    fn commands(&self) -> Vec<String> {
        self.entry.runs.iter().filter_map(|name| Run::named(name)).map(|run| run.command(self.entry.range)).collect()
    }

    fn json(&self) -> Value {
        let Entry { name, number, title, verdict, .. } = self.entry;
        json!({
            "name": name, "number": number, "title": title, "verdict": verdict.word(), "holds": self.holds(),
            "missing": self.missing, "seconds": self.seconds, "commands": self.commands(),
            "numbers": self.figure.rows.iter().map(of_row).collect::<Value>(),
        })
    }
}

fn of_row(row: &Row) -> Value {
    let expected = match row.expected {
        Expected::About(value, part) => json!({ "value": value, "tol": part * value.abs() }),
        Expected::Near(value, tol) => json!({ "value": value, "tol": tol }),
        Expected::Between(low, high) => json!({ "low": low, "high": high }),
    };
    json!({ "what": row.what, "computed": row.computed, "expected": expected, "source": row.source, "holds": row.holds() })
}

impl Gallery {
    /// Whether nothing is missing and every number is as expected.
    pub fn holds(&self) -> bool {
        self.shown.iter().all(Drawn::holds)
    }

    /// The figures that do not hold: name and reason of each.
    pub fn failures(&self) -> Vec<(&'static str, String)> {
        let why = |drawn: &Drawn| match &drawn.missing {
            Some(missing) => missing.clone(),
            None => {
                let off = drawn.figure.rows.iter().filter(|row| !row.holds());
                off.map(|row| format!("{} is {}", row.what, page::shown(row.computed))).collect::<Vec<_>>().join("; ")
            }
        };
        self.shown.iter().filter(|drawn| !drawn.holds()).map(|drawn| (drawn.entry.name, why(drawn))).collect()
    }

    /// Every number of the page with its expected value.
    pub fn json(&self) -> Value {
        json!({ "title": TITLE, "holds": self.holds(), "figures": self.shown.iter().map(Drawn::json).collect::<Value>() })
    }

    /// The page, which loads nothing.
    ///
    /// # Errors
    /// [`GalleryError::Page`].
    pub fn page(&self) -> Result<String, GalleryError> {
        page::page(&self.shown, self.seconds).map_err(|e| GalleryError::Page(format!("{e:#}")))
    }

    /// Writes `index.html`, `gallery.json` and the pictures, `NAME.svg` and `NAME.png` or `NAME-K`, into a folder; returns the files.
    ///
    /// # Errors
    /// When a file cannot be written, or the page not be made.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, Box<dyn std::error::Error + Send + Sync>> {
        std::fs::create_dir_all(folder)?;
        let mut files = vec![folder.join("index.html"), folder.join("gallery.json")];
        let contents = [self.page()?, serde_json::to_string_pretty(&self.json())?];
        for (path, content) in files.iter().zip(&contents) {
            replace(folder, path, content.as_bytes())
                .map_err(|source| PictureError::Write { path: path.clone(), source })?;
        }
        for drawn in &self.shown {
            for (k, shown) in drawn.figure.pictures.iter().enumerate() {
                let name = match drawn.figure.pictures.len() {
                    1 => drawn.entry.name.to_owned(),
                    _ => format!("{}-{}", drawn.entry.name, k + 1),
                };
                files.extend(write(folder, &name, &shown.picture)?);
            }
        }
        Ok(files)
    }
}
