//! Pictures of a solution, each as SVG text and as PNG bytes drawn from one list of shapes.
//!
//! Frame 900 units wide, PNG at two pixels per unit, letters from the font that kuva bundles: no display, no installed
//! font and no browser is needed. Every curve that has a meaning of its own differs by line style or marker too, and
//! the colour map rises in lightness, so all pictures can be read in grey.
//!
//! ```
//! use steklov_picture::{Axis, Chart, Curve, Guide, Scale, Series, chart};
//!
//! let points: Vec<[f64; 2]> = (1..6).map(|k| [10.0 * 2f64.powi(k), 0.3 * 0.5f64.powi(k)]).collect();
//! let curves = [Curve { points: &points, flagged: &[] }];
//! let picture = chart(&Chart {
//!     title: "Halved with every doubling",
//!     x: Axis { label: "unknowns", scale: Scale::Log },
//!     y: Axis { label: "relative error", scale: Scale::Log },
//!     quantities: &["error"],
//!     series: &[Series { name: "uniform", curves: &curves }],
//!     flag: "not reliable",
//!     guides: &[Guide { label: "N^-1", slope: -1.0 }],
//!     band: None,
//! })?;
//! let [wide, high] = [16, 20].map(|at| u32::from_be_bytes(std::array::from_fn(|byte| picture.png[at + byte])));
//! assert_eq!(wide, 2 * 900); // two pixels a unit
//! assert!(picture.svg.contains(&format!("height=\"{}\"", high / 2)) && picture.svg.contains("unknowns"));
//! # Ok::<(), steklov_picture::PictureError>(())
//! ```

mod axes;
mod bands;
mod bars;
mod basis;
mod body;
mod canvas;
mod cells;
mod chart;
mod colours;
mod deformed;
mod contact;
mod fields;
mod graph;
mod guides;
mod lattice;
mod markers;
mod mesh;
mod page;
mod panels;
mod raster;
mod scale;
mod spread;
mod strips;
mod tiles;
mod upright;
mod window;

pub use bands::{BANDS, colour_interval, limited};
pub use bars::{BarGroup, bars};
pub use basis::{BasisFunction, basis};
pub use body::{Body, Largest, Obstacle, body};
pub use cells::{CellField, cell_fields};
pub use chart::{Axis, Band, Chart, Curve, Guide, Series, chart};
pub use colours::Colours;
pub use contact::{ContactSide, contact};
pub use deformed::deformed_cells;
pub use graph::Scale;
pub use lattice::{LatticeTriangles, lattice_triangles};
pub use mesh::{MeshFigure, MeshPanel, meshes};
pub use page::{STYLE, data_uri};
pub use panels::{Ends, Layer, Panel, Shape, panels};
pub use scale::{exaggeration, plain, short};
pub use spread::{Spread, SpreadLoop, spread};
pub use tiles::{DegreeBox, Tile, boxes, tiles};

use std::io::Write as _;
use std::path::{Path, PathBuf};

/// A name with the name of its unit, if there is one.
pub fn in_unit(name: &str, unit: Option<&str>) -> String {
    unit.map_or_else(|| name.to_owned(), |unit| format!("{name} in {unit}"))
}

/// One drawing in both formats.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Text of the SVG file.
    pub svg: String,
    /// Bytes of the PNG file.
    pub png: Vec<u8>,
}

/// Why a picture could not be drawn or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The drawing could not be turned into pixels.
    #[error("the picture could not be drawn as PNG: {0}")]
    Raster(String),
    /// A file could not be written.
    #[error("{} could not be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
}

/// Writes `name.svg` and `name.png` into the folder `dir` (made if missing) and returns their paths in that order.
///
/// Each file appears whole or not at all: it is written beside its place under another name, synced and renamed; an
/// older file of that name is replaced.
///
/// # Errors
/// [`PictureError::Write`] with the path and the error of the operating system.
pub fn write(dir: &Path, name: &str, picture: &Picture) -> Result<[PathBuf; 2], PictureError> {
    std::fs::create_dir_all(dir).map_err(|source| PictureError::Write { path: dir.to_owned(), source })?;
    let save = |extension: &str, bytes: &[u8]| {
        let path = dir.join(format!("{name}.{extension}"));
        match replace(dir, &path, bytes) {
            Ok(()) => Ok(path),
            Err(source) => Err(PictureError::Write { path, source }),
        }
    };
    Ok([save("svg", picture.svg.as_bytes())?, save("png", &picture.png)?])
}

/// Writes a file of the folder `dir` that appears whole or not at all.
pub fn replace(dir: &Path, path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    // tempfile makes private files; this one gets the permissions of any other new file.
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(dir)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(path)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_files_appear_and_nothing_else_and_old_ones_are_replaced() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("pictures");
        for round in 0..2u8 {
            let picture = Picture { svg: format!("<svg>{round}</svg>"), png: vec![round; 9] };
            let [svg, png] = write(&folder, "body", &picture).unwrap();
            assert_eq!(std::fs::read_to_string(&svg).unwrap(), picture.svg);
            assert_eq!(std::fs::read(&png).unwrap(), picture.png);
            assert_eq!((svg, png), (folder.join("body.svg"), folder.join("body.png")));
            assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 2);
        }
    }

    #[test]
    fn a_folder_that_is_a_file_is_named_in_the_error() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let error = write(file.path(), "body", &Picture { svg: String::new(), png: Vec::new() }).unwrap_err();
        assert!(error.to_string().contains(file.path().to_str().unwrap()), "{error}");
    }
}
