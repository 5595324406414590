//! Tables whose columns are numbers: as CSV, as JSON objects, as HDF5 vectors.

use std::fmt::Write as _;

use serde_json::{Map, Value};
use steklov_io::{Group, IoError, Label, save_vector};

/// A column: name, unit, meaning, value. What is not known is NaN.
pub(super) type Column<T> = (&'static str, &'static str, &'static str, fn(&T) -> f64);

/// The table with a line of names; what is not known is left empty.
pub(super) fn csv<T>(rows: &[T], columns: &[Column<T>]) -> String {
    let mut text = columns.iter().map(|c| c.0).collect::<Vec<_>>().join(",") + "\n";
    for row in rows {
        let cells: Vec<String> = columns.iter().map(|c| cell((c.3)(row))).collect();
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}

/// Counts without a decimal point, all digits of other numbers.
fn cell(value: f64) -> String {
    match value {
        v if !v.is_finite() => String::new(),
        v if v.fract() == 0.0 && v.abs() < 1e15 => format!("{v}"),
        v => format!("{v:?}"),
    }
}

/// An object a row; what is not known is null.
pub(super) fn json<T>(rows: &[T], columns: &[Column<T>]) -> Value {
    let value = |v: f64| if v.fract() == 0.0 && v.abs() < 1e15 { Value::from(v as i64) } else { Value::from(v) };
    let object = |row: &T| columns.iter().map(|c| (c.0.to_owned(), value((c.3)(row)))).collect::<Map<_, _>>();
    rows.iter().map(object).collect()
}

/// A vector a column.
pub(super) fn save<T>(at: &Group, rows: &[T], columns: &[Column<T>], axis: &str) -> Result<(), IoError> {
    columns.iter().try_for_each(|(name, unit, meaning, value)| {
        let values: Vec<f64> = rows.iter().map(value).collect();
        save_vector(at, name, &values, &Label { unit, meaning, axes: &[axis] })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_empty_and_null() {
        let columns: [Column<f64>; 2] = [("a", "1", "", |x| *x), ("b", "1", "", |x| 1.0 / x)];
        assert_eq!(csv(&[2.0, 0.1, 0.0], &columns), "a,b\n2,0.5\n0.1,10\n0,\n");
        let rows = json(&[2.0, 0.0], &columns);
        assert_eq!(rows, serde_json::json!([{ "a": 2, "b": 0.5 }, { "a": 0, "b": null }]));
    }
}
