//! A sweep: its scene, its points and what is known of each.

use std::path::{Path, PathBuf};

use serde_json::Value;
use steklov_document::Document;

use crate::solve::Outcome;
use crate::{Points, Quantities, SweepError};

/// A sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Title of the scene.
    pub title: String,
    /// Text of the scene.
    pub scene: String,
    /// Overrides `KEY=VALUE` of all points.
    pub overrides: Vec<String>,
    /// The points.
    pub points: Points,
    /// What is known of each point; None if it is not solved yet.
    pub outcomes: Vec<Option<Outcome>>,
}

impl Sweep {
    /// A sweep of which nothing is solved yet.
    pub fn new(document: &Document, points: Points) -> Self {
        let Document { scene, source } = document;
        let outcomes = vec![None; points.len().min(crate::MOST_POINTS)];
        let (title, overrides) = (scene.title.clone(), source.overrides.clone());
        Self { title, scene: source.text.clone(), overrides, points, outcomes }
    }

    /// The points of a part, `part` of `parts` counted from 1, that are not solved: every `parts`-th one, so that parts take as long as
    /// each other.
    pub fn missing(&self, [part, parts]: [usize; 2]) -> Vec<usize> {
        (part - 1..self.outcomes.len()).step_by(parts).filter(|point| self.outcomes[*point].is_none()).collect()
    }

    /// The JSON objects of the points; None where there is none.
    pub fn objects(&self) -> Vec<Option<Value>> {
        let object = |outcome: &Option<Outcome>| match outcome {
            Some(Outcome::Solved(text)) => serde_json::from_str(text).ok(),
            _ => None,
        };
        self.outcomes.iter().map(object).collect()
    }

    /// The numbers of all points.
    pub fn quantities(&self) -> Quantities {
        Quantities::of(&self.objects())
    }

    /// How many points are solved and reached their aim, how many are solved and did not, how many failed, and how many are missing.
    pub fn counts(&self) -> [usize; 4] {
        let mut counts = [0; 4];
        for (outcome, object) in self.outcomes.iter().zip(self.objects()) {
            let kind = match (outcome, object) {
                (Some(Outcome::Solved(_)), Some(object)) if object["converged"] == true => 0,
                (Some(Outcome::Solved(_)), _) => 1,
                (Some(Outcome::Failed(_)), _) => 2,
                (None, _) => 3,
            };
            counts[kind] += 1;
        }
        counts
    }

    /// The table: a line for each point with its number from 0, the values of the varied keys, what became of it, and its numbers.
    pub fn csv(&self) -> String {
        let (objects, quantities) = (self.objects(), self.quantities());
        let mut writer = csv::Writer::from_writer(Vec::new());
        let head = ["point"].into_iter().chain(self.points.keys().iter().map(String::as_str));
        let told = ["state", "reason", "converged", "doubts", "message"];
        let head = head.chain(told).chain(quantities.paths.iter().map(String::as_str));
        let mut lines = vec![head.map(str::to_owned).collect::<Vec<String>>()];
        for (point, row) in quantities.rows.iter().enumerate() {
            let text = |key: &str| match objects[point].as_ref().map(|object| &object[key]) {
                Some(Value::String(text)) => text.clone(),
                Some(Value::Array(words)) => words.iter().filter_map(Value::as_str).collect::<Vec<_>>().join(" "),
                Some(Value::Bool(flag)) => flag.to_string(),
                _ => String::new(),
            };
            let (state, message) = match &self.outcomes[point] {
                Some(Outcome::Solved(_)) => ("solved", text("failure")),
                Some(Outcome::Failed(message)) => ("failed", message.clone()),
                None => ("missing", String::new()),
            };
            let values = (0..self.points.keys().len()).map(|key| plain(self.points.value(point, key)));
            let told = [state.to_owned(), text("reason"), text("converged"), text("estimate_doubts"), message];
            let numbers = row.iter().map(|v| if v.is_nan() { String::new() } else { format!("{v:?}") });
            lines.push(std::iter::once(point.to_string()).chain(values).chain(told).chain(numbers).collect());
        }
        // a vector does not fail
        lines.iter().for_each(|line| writer.write_record(line).unwrap_or_default());
        String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
    }

    /// Refuses another sweep's scene, overrides or points, which `file` holds.
    pub(crate) fn check_same(
        &self,
        scene: &str,
        overrides: &[String],
        points: &Points,
        file: &str,
    ) -> Result<(), SweepError> {
        let what = match (self.scene == scene, self.overrides == overrides, self.points.same(points)) {
            (false, ..) => "scene",
            (_, false, _) => "settings",
            (.., false) => "points",
            _ => return Ok(()),
        };
        Err(SweepError::Other { file: file.to_owned(), what })
    }

    /// Takes the points of another part of the same sweep; `[own, file]` are the names of both, for messages.
    ///
    /// # Errors
    /// [`SweepError::Other`] of another sweep; [`SweepError::Conflict`] if both have different answers for a point.
    pub fn take(&mut self, other: Self, [own, file]: [&str; 2]) -> Result<(), SweepError> {
        self.check_same(&other.scene, &other.overrides, &other.points, file)?;
        for (point, (mine, theirs)) in self.outcomes.iter_mut().zip(other.outcomes).enumerate() {
            match (&*mine, theirs) {
                (Some(a), Some(b)) if *a != b => {
                    let settings = self.points.settings(point).join(", ");
                    let (first, second) = (own.to_owned(), file.to_owned());
                    return Err(SweepError::Conflict { first, second, point, settings });
                }
                (None, Some(theirs)) => *mine = Some(theirs),
                _ => {}
            }
        }
        Ok(())
    }
}

/// Writes the table of a sweep beside its file, with the ending .csv; returns its path.
///
/// # Errors
/// [`SweepError::Table`].
pub fn write_table(sweep: &Sweep, path: &Path) -> Result<PathBuf, SweepError> {
    let path = path.with_extension("csv");
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    steklov_picture::replace(folder, &path, sweep.csv().as_bytes())
        .map_err(|source| SweepError::Table { path: path.clone(), source })?;
    Ok(path)
}

/// A value of TOML as it stands in a table: a text without its quotes.
pub(crate) fn plain(value: &str) -> String {
    match toml::from_str::<toml::Table>(&format!("v={value}")).ok().and_then(|mut table| table.remove("v")) {
        Some(toml::Value::String(text)) => text,
        _ => value.to_owned(),
    }
}
