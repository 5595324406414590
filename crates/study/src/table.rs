//! Tables: columns declared once and read from rows of any type, for CSV, JSON and HDF5.

use serde_json::{Map, Value};
use steklov_io::{Group, IoError, Label, save_integers, save_texts, save_vector};

/// A column of numbers: name, unit, meaning, and the function that reads it from a row. Unknown numbers are NaN.
pub(crate) type Column<T> = (&'static str, &'static str, &'static str, fn(&T) -> f64);

/// The entries of a column.
#[derive(Clone)]
enum Entries {
    /// Names of the objects to which the rows belong, in CSV only: JSON and HDF5 have a group for each object instead.
    Keys(Vec<String>),
    /// Numbers; whole ones are shown without a decimal point.
    Numbers(Vec<f64>),
    /// Numbers that are always shown with all digits.
    Digits(Vec<f64>),
    /// Integers, also in HDF5.
    Counts(Vec<usize>),
    /// Lists of words; each list is one text in CSV and HDF5.
    Words(Vec<Vec<&'static str>>),
}

/// A table.
#[derive(Clone)]
pub(crate) struct Table {
    /// The meaning of a row.
    axis: &'static str,
    rows: usize,
    /// Name, unit, meaning, entries.
    columns: Vec<(&'static str, &'static str, &'static str, Entries)>,
}

impl Table {
    /// A table with these columns; `axis` is the meaning of a row.
    pub(crate) fn new<'r, T: 'r>(
        axis: &'static str,
        rows: impl IntoIterator<Item = &'r T>,
        columns: &[Column<T>],
    ) -> Self {
        Self::read(axis, rows.into_iter().collect(), columns, Entries::Numbers)
    }

    /// A table whose numbers are shown with all digits.
    pub(crate) fn digits<'r, T: 'r>(
        axis: &'static str,
        rows: impl IntoIterator<Item = &'r T>,
        columns: &[Column<T>],
    ) -> Self {
        Self::read(axis, rows.into_iter().collect(), columns, Entries::Digits)
    }

    fn read<T>(axis: &'static str, rows: Vec<&T>, columns: &[Column<T>], kind: fn(Vec<f64>) -> Entries) -> Self {
        let entries = |value: fn(&T) -> f64| kind(rows.iter().copied().map(value).collect());
        let columns = columns.iter().map(|&(name, unit, meaning, value)| (name, unit, meaning, entries(value)));
        Self { axis, rows: rows.len(), columns: columns.collect() }
    }

    /// Adds a column of counts in front.
    pub(crate) fn counts(mut self, name: &'static str, meaning: &'static str, counts: Vec<usize>) -> Self {
        self.columns.insert(0, (name, "1", meaning, Entries::Counts(counts)));
        self
    }

    /// Adds a column of words.
    pub(crate) fn words(mut self, name: &'static str, meaning: &'static str, words: Vec<Vec<&'static str>>) -> Self {
        self.columns.push((name, "text", meaning, Entries::Words(words)));
        self
    }

    /// Adds a column in front: the objects to which the rows belong.
    pub(crate) fn key(mut self, name: &'static str, keys: impl Iterator<Item = String>) -> Self {
        self.columns.insert(0, (name, "text", "", Entries::Keys(keys.collect())));
        self
    }

    /// A line of names, and a line for each row; unknown numbers are empty.
    pub(crate) fn csv(&self) -> String {
        let names: Vec<&str> = self.columns.iter().map(|c| c.0).collect();
        let lines = (0..self.rows).map(|row| {
            let cells: Vec<String> = self.columns.iter().map(|(.., entries)| cell(entries, row)).collect();
            cells.join(",") + "\n"
        });
        names.join(",") + "\n" + &lines.collect::<String>()
    }

    /// An object for each row; unknown numbers are null.
    pub(crate) fn json(&self) -> Value {
        let object = |row: usize| -> Map<String, Value> {
            let values = self.columns.iter().map(|(name, .., entries)| (*name, value(entries, row)));
            values.filter_map(|(name, value)| Some((name.to_owned(), value?))).collect()
        };
        (0..self.rows).map(object).collect()
    }

    /// A dataset for each column.
    pub(crate) fn save(&self, at: &Group) -> Result<(), IoError> {
        self.columns.iter().try_for_each(|(name, unit, meaning, entries)| {
            let label = Label { unit, meaning, axes: &[self.axis] };
            match entries {
                Entries::Keys(_) => Ok(()),
                Entries::Numbers(v) | Entries::Digits(v) => save_vector(at, name, v, &label),
                Entries::Counts(v) => save_integers(at, name, v, &label),
                Entries::Words(words) => {
                    let texts: Vec<String> = words.iter().map(|w| w.join(" ")).collect();
                    save_texts(at, name, &texts, meaning, self.axis)
                }
            }
        })
    }
}

fn is_whole(v: f64) -> bool {
    v.fract() == 0.0 && v.abs() < 1e15
}

fn cell(entries: &Entries, row: usize) -> String {
    match entries {
        Entries::Keys(keys) => keys[row].clone(),
        Entries::Numbers(v) if is_whole(v[row]) => format!("{}", v[row]),
        Entries::Numbers(v) | Entries::Digits(v) if v[row].is_finite() => format!("{:?}", v[row]),
        Entries::Numbers(_) | Entries::Digits(_) => String::new(),
        Entries::Counts(v) => v[row].to_string(),
        Entries::Words(words) => words[row].join(" "),
    }
}

fn value(entries: &Entries, row: usize) -> Option<Value> {
    Some(match entries {
        Entries::Keys(_) => return None,
        Entries::Numbers(v) if is_whole(v[row]) => Value::from(v[row] as i64),
        Entries::Numbers(v) | Entries::Digits(v) => Value::from(v[row]),
        Entries::Counts(v) => Value::from(v[row]),
        Entries::Words(words) => Value::from(words[row].clone()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_empty_and_null() {
        let columns: [Column<f64>; 2] = [("a", "1", "", |x| *x), ("b", "1", "", |x| 1.0 / x)];
        assert_eq!(Table::new("row", &[2.0, 0.1, 0.0], &columns).csv(), "a,b\n2,0.5\n0.1,10\n0,\n");
        let rows = Table::new("row", &[2.0, 0.0], &columns).json();
        assert_eq!(rows, serde_json::json!([{ "a": 2, "b": 0.5 }, { "a": 0, "b": null }]));
    }

    #[test]
    fn keys_are_of_csv_only_and_digits_are_all_shown() {
        let numbers: [Column<f64>; 1] = [("x", "1", "", |x| *x)];
        let words = vec![vec!["a", "b"], vec![]];
        let table =
            Table::digits("row", &[1.0, f64::NAN], &numbers).counts("n", "", vec![3, 4]).words("why", "", words);
        let rows = serde_json::json!([{ "n": 3, "x": 1.0, "why": ["a", "b"] }, { "n": 4, "x": null, "why": [] }]);
        assert_eq!(table.json(), rows);
        let table = table.key("of", ["p", "q"].map(String::from).into_iter());
        assert_eq!((table.csv(), table.json()), ("of,n,x,why\np,3,1.0,a b\nq,4,,\n".into(), rows));
    }
}
