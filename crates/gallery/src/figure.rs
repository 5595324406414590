//! A figure of the page: its pictures, its numbers, and their expected values.

use steklov_figures::{View, drawn};
use steklov_picture::Picture;

use crate::runs::{Made, Run};

/// How a figure compares with the source's description.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// The figure shows all that the source says.
    Same,
    /// As [`Self::Same`], with choices where the source leaves something open.
    Chosen,
    /// The source is wrong, or differs: the figure says how.
    Differs,
    /// A chart of the project, which the source does not have.
    Own,
}

impl Verdict {
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Same => "same",
            Self::Chosen => "chosen",
            Self::Differs => "differs",
            Self::Own => "own",
        }
    }
}

/// The description of a figure, before anything is run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entry {
    /// Its name, in its files and for `--only`.
    pub name: &'static str,
    /// Number and section in the source; for a figure of the project, the statement that it is about.
    pub number: &'static str,
    pub title: &'static str,
    pub verdict: Verdict,
    /// Body, supports, load, material, friction, meshes.
    pub set_up: &'static str,
    /// What the figure shows.
    pub seen: &'static str,
    /// What the source leaves open, and the choice; empty if nothing.
    pub left_open: &'static str,
    /// Where the source is wrong; empty if nowhere.
    pub differs: &'static [&'static str],
    /// The runs that it needs.
    pub runs: &'static [&'static str],
    /// Ends of the colours of its fields; None: each field has its own.
    pub range: Option<[f64; 2]>,
    /// Adds pictures and numbers; the error says in words why that is not possible.
    pub draw: fn(&Runs<'_>, &mut Figure) -> Result<(), String>,
}

/// The expected value of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Expected {
    /// The first number, up to a relative difference of the second.
    About(f64, f64),
    /// The first number, up to a difference of the second.
    Near(f64, f64),
    /// From the first number to the second.
    Between(f64, f64),
}

/// A number of a figure.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    pub what: String,
    pub computed: f64,
    pub expected: Expected,
    /// The value in the source; empty if there is none.
    pub source: &'static str,
}

impl Row {
    /// Whether it is as expected.
    pub(crate) fn holds(&self) -> bool {
        let off = |value: f64| (self.computed - value).abs();
        match self.expected {
            Expected::About(value, part) => off(value) <= part * value.abs(),
            Expected::Near(value, distance) => off(value) <= distance,
            Expected::Between(low, high) => (low..=high).contains(&self.computed),
        }
    }
}

/// A picture on the page.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shown {
    pub picture: Picture,
    /// A description for readers who do not see the picture.
    pub alternative: String,
    /// Whether it is a field, whose vector graphics takes megabytes.
    pub is_field: bool,
}

/// The pictures and numbers of a figure.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Figure {
    pub pictures: Vec<Shown>,
    pub rows: Vec<Row>,
}

impl Figure {
    /// Adds a chart.
    pub(crate) fn chart(&mut self, picture: Picture, alternative: &str) {
        self.pictures.push(Shown { picture, alternative: alternative.to_owned(), is_field: false });
    }

    /// Adds a picture of a field.
    pub(crate) fn field(&mut self, picture: Picture, alternative: &str) {
        self.pictures.push(Shown { picture, alternative: alternative.to_owned(), is_field: true });
    }

    /// Adds a number.
    pub(crate) fn row(&mut self, what: impl Into<String>, computed: f64, expected: Expected) {
        self.rows.push(Row { what: what.into(), computed, expected, source: "" });
    }

    /// Adds a number that the source has as well.
    pub(crate) fn row_of_source(&mut self, what: &str, computed: f64, expected: Expected, source: &'static str) {
        self.rows.push(Row { what: what.to_owned(), computed, expected, source });
    }
}

/// The runs of a page by name, each with its results or the reason of its failure.
pub(crate) struct Runs<'a> {
    pub made: &'a [(&'static Run, Result<Made, String>)],
    /// The view of solves in the current figure.
    pub view: View,
}

impl Runs<'_> {
    /// The results of a run.
    pub(crate) fn get(&self, name: &str) -> Result<&Made, String> {
        match self.made.iter().find(|(run, _)| run.name == name) {
            Some((_, Ok(made))) => Ok(made),
            Some((run, Err(why))) => Err(format!("the run \"{}\" failed: {why}", run.what)),
            None => Err(format!("the run \"{name}\" was not made: the gallery was stopped before")),
        }
    }

    /// A picture of a solve by its part of the name of the file.
    pub(crate) fn drawn(&self, name: &str, picture: &str) -> Result<Picture, String> {
        let record = self.get(name)?.record.as_ref().ok_or("the run has no record")?;
        let all = drawn(record, &self.view).map_err(|e| e.to_string())?;
        let found = all.into_iter().find(|(part, _)| part == picture);
        found.map(|(_, picture)| picture).ok_or_else(|| format!("the run has no picture {picture}"))
    }
}

impl Made {
    /// A number of the JSON object by its path.
    pub(crate) fn number(&self, pointer: &str) -> Result<f64, String> {
        let value = self.json.pointer(pointer).and_then(serde_json::Value::as_f64);
        value.ok_or_else(|| format!("the result has no number at {pointer}"))
    }

    /// A picture of a study by the name of its file.
    pub(crate) fn picture(&self, name: &str) -> Result<Picture, String> {
        self.pictures.get(name).cloned().ok_or_else(|| format!("the run has drawn no {name}"))
    }

    /// The objects of a list.
    pub(crate) fn list(&self, pointer: &str) -> Result<&[serde_json::Value], String> {
        let list = self.json.pointer(pointer).and_then(serde_json::Value::as_array);
        list.map(Vec::as_slice).ok_or_else(|| format!("the result has no list at {pointer}"))
    }

    /// The object of a list whose entry `key` is `name`.
    pub(crate) fn named(&self, pointer: &str, key: &str, name: &str) -> Result<&serde_json::Value, String> {
        let found = self.list(pointer)?.iter().find(|item| item[key] == name);
        found.ok_or_else(|| format!("{pointer} has no {name}"))
    }
}

/// Number of an object; NaN if it is not known.
pub(crate) fn number(object: &serde_json::Value, key: &str) -> f64 {
    object[key].as_f64().unwrap_or(f64::NAN)
}
