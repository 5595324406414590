//! The numbers of JSON objects as a table: a column for each path.

use std::collections::BTreeSet;

use serde_json::Value;
use steklov_model::numbers::numbers;

/// Numbers of all points, by their paths in the JSON object.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantities {
    /// The paths, in alphabetical order.
    pub paths: Vec<String>,
    /// A row for each point, a column for each path; NaN where a point has no such number.
    pub rows: Vec<Vec<f64>>,
}

impl Quantities {
    /// The numbers of these objects; None stands for a point without one.
    pub(crate) fn of(objects: &[Option<Value>]) -> Self {
        let all: Vec<Vec<(String, f64)>> =
            objects.iter().map(|object| object.as_ref().map_or(Vec::new(), numbers)).collect();
        let paths: BTreeSet<&String> = all.iter().flatten().map(|(path, _)| path).collect();
        let paths: Vec<String> = paths.into_iter().cloned().collect();
        let row = |numbers: &Vec<(String, f64)>| {
            let mut row = vec![f64::NAN; paths.len()];
            for (path, number) in numbers {
                if let Ok(column) = paths.binary_search(path) {
                    row[column] = *number;
                }
            }
            row
        };
        let rows = all.iter().map(row).collect();
        Self { paths, rows }
    }

    /// The numbers of a path at all points; None if no point has one.
    pub fn column(&self, path: &str) -> Option<Vec<f64>> {
        let column = self.paths.iter().position(|own| own == path)?;
        Some(self.rows.iter().map(|row| row[column]).collect())
    }
}
