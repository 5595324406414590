//! The numbers of JSON objects as a table: a column for each path.

use std::collections::BTreeSet;

use serde_json::Value;

/// Parts of a JSON object that are no quantities of a point: long lists, what was asked for, and words.
const NO_QUANTITIES: [&str; 9] =
    ["probe_lines", "probe_sides", "expect", "infinite_stress", "ends", "point", "converged", "solution", "sides"];

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

/// Paths and values of the numbers of a JSON object, a flag being 0 or 1.
fn numbers(object: &Value) -> Vec<(String, f64)> {
    fn add(value: &Value, path: &str, key: &str, list: &mut Vec<(String, f64)>) {
        let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        match value {
            Value::Bool(flag) => list.push((path.to_owned(), f64::from(u8::from(*flag)))),
            Value::Number(number) => list.extend(number.as_f64().map(|number| (path.to_owned(), number))),
            Value::Object(entries) => entries
                .iter()
                .filter(|(key, _)| !NO_QUANTITIES.contains(&key.as_str()))
                .for_each(|(key, value)| add(value, &below(key), key, list)),
            Value::Array(items) => {
                let is_vector = items.iter().all(Value::is_number) && key != "quantiles";
                let components: &[&str] = match items.len() {
                    2 if is_vector => &["x", "y"],
                    3 if is_vector => &["xx", "yy", "xy"],
                    _ => &[],
                };
                let name = |k: usize| components.get(k).map_or_else(|| k.to_string(), |name| (*name).to_owned());
                items.iter().enumerate().for_each(|(k, item)| add(item, &below(&name(k)), "", list));
            }
            Value::Null | Value::String(_) => {}
        }
    }
    let mut list = Vec::new();
    add(object, "", "", &mut list);
    list
}
