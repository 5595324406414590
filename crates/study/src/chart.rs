//! Charts of lines that own their points.

use std::path::{Path, PathBuf};

use steklov_picture::{Axis, Band, Chart, Curve, Guide, PictureError, Scale, Series, chart, write};

/// Points of a curve, and whether each is in doubt (none if the list is empty).
#[derive(Default)]
pub(crate) struct Dots {
    pub(crate) points: Vec<[f64; 2]>,
    pub(crate) flagged: Vec<bool>,
}

impl Dots {
    fn curve(&self) -> Curve<'_> {
        Curve { points: &self.points, flagged: &self.flagged }
    }
}

/// A line of a chart: its name in the key, and a curve for each quantity.
pub(crate) struct Line {
    pub(crate) name: String,
    pub(crate) curves: Vec<Dots>,
}

impl Line {
    /// A line without a point in doubt.
    pub(crate) fn new(name: impl Into<String>, curves: impl IntoIterator<Item = Vec<[f64; 2]>>) -> Self {
        let curves = curves.into_iter().map(|points| Dots { points, flagged: Vec::new() });
        Self { name: name.into(), curves: curves.collect() }
    }

    /// Whether it has points.
    pub(crate) fn is_drawn(&self) -> bool {
        self.curves.iter().any(|c| !c.points.is_empty())
    }
}

/// Points whose values are known.
pub(crate) fn known(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    points.filter(|p| p.iter().all(|v| v.is_finite())).collect()
}

/// A logarithmic axis.
pub(crate) const fn log(label: &str) -> Axis<'_> {
    Axis { label, scale: Scale::Log }
}

/// A linear axis.
pub(crate) const fn linear(label: &str) -> Axis<'_> {
    Axis { label, scale: Scale::Linear }
}

/// The content of a chart.
pub(crate) struct Drawing<'a> {
    pub(crate) title: &'a str,
    pub(crate) axes: [Axis<'a>; 2],
    pub(crate) quantities: &'a [&'a str],
    pub(crate) lines: Vec<Line>,
    /// Meaning of the mark of a point in doubt.
    pub(crate) flag: &'a str,
    pub(crate) guides: &'a [Guide<'a>],
    pub(crate) band: Option<Band<'a>>,
}

impl Default for Drawing<'_> {
    fn default() -> Self {
        let axes = [log(""); 2];
        Self { title: "", axes, quantities: &["error"], lines: Vec::new(), flag: "", guides: &[], band: None }
    }
}

/// The pictures of a study in a folder.
pub(crate) struct Pictures<'a> {
    pub(crate) folder: &'a Path,
    pub(crate) files: Vec<PathBuf>,
}

impl<'a> Pictures<'a> {
    /// No picture yet.
    pub(crate) fn new(folder: &'a Path) -> Self {
        Self { folder, files: Vec::new() }
    }

    /// Draws a picture and saves it under a name.
    pub(crate) fn draw(&mut self, name: &str, d: &Drawing<'_>) -> Result<(), PictureError> {
        let curves: Vec<Vec<Curve<'_>>> = d.lines.iter().map(|l| l.curves.iter().map(Dots::curve).collect()).collect();
        let series: Vec<Series<'_>> =
            d.lines.iter().zip(&curves).map(|(l, curves)| Series { name: &l.name, curves }).collect();
        let Drawing { title, axes: [x, y], quantities, flag, guides, band, .. } = *d;
        let picture = chart(&Chart { title, x, y, quantities, series: &series, flag, guides, band })?;
        self.files.extend(write(self.folder, name, &picture)?);
        Ok(())
    }
}
