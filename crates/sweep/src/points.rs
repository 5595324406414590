//! The points of a sweep: the values of each varied key.

use serde::{Deserialize, Serialize};

use crate::SweepError;

/// Most points of a sweep.
pub const MOST_POINTS: usize = 100_000;

/// The varied keys and their values at each point, as texts of TOML.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Points {
    keys: Vec<String>,
    values: Values,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Values {
    /// All combinations of the values of each key, the last key running first.
    Product(Vec<Vec<String>>),
    /// The values of all keys, point by point.
    Rows(Vec<Vec<String>>),
}

impl Points {
    /// The points of texts `KEY=FROM:TO:N`, N values from FROM to TO at equal distances, and `KEY=a,b,c`: all combinations, the last key
    /// running first; with `zip` the first values of all keys, the second ones, and so on.
    ///
    /// ```
    /// use steklov_sweep::Points;
    ///
    /// let points = Points::vary(&["parameters.F=0:1:3", "method.refine=h,hp"], false)?;
    /// assert_eq!(points.len(), 6);
    /// assert_eq!(points.settings(3), ["parameters.F=0.5", "method.refine=\"hp\""]);
    /// # Ok::<(), steklov_sweep::SweepError>(())
    /// ```
    ///
    /// # Errors
    /// [`SweepError::Vary`] of a text that is not of this form, an empty range, a key that is there twice, and with `zip` lists of
    /// different lengths.
    pub fn vary<S: AsRef<str>>(texts: &[S], zip: bool) -> Result<Self, SweepError> {
        let read: Vec<(String, Vec<String>)> =
            texts.iter().map(|text| axis(text.as_ref())).collect::<Result<_, _>>()?;
        let (keys, lists): (Vec<String>, Vec<Vec<String>>) = read.into_iter().unzip();
        check_keys(&keys)?;
        if !zip {
            return Ok(Self { keys, values: Values::Product(lists) });
        }
        let count = lists[0].len();
        if let Some(other) = lists.iter().position(|list| list.len() != count) {
            let why =
                format!("{} values of {} and {count} of {} are no pairs", lists[other].len(), keys[other], keys[0]);
            return Err(refused(texts[other].as_ref(), why, "with zip all keys need as many values"));
        }
        let row = |k: usize| lists.iter().map(|list| list[k].clone()).collect();
        Ok(Self { keys, values: Values::Rows((0..count).map(row).collect()) })
    }

    /// The points of a CSV table, a column for each key with its name in the first line, a row for each point.
    ///
    /// # Errors
    /// [`SweepError::Vary`] of a table that is none, or without points.
    pub fn from_csv(table: &str, name: &str) -> Result<Self, SweepError> {
        let failed =
            |e: csv::Error| refused(name, e.to_string(), "write a line of keys, then a line of values for each point");
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(table.as_bytes());
        let keys: Vec<String> = reader.headers().map_err(failed)?.iter().map(str::to_owned).collect();
        check_keys(&keys)?;
        let row = |record: Result<csv::StringRecord, csv::Error>| {
            record.map_err(failed)?.iter().zip(&keys).map(|(value, key)| typed(key, value)).collect()
        };
        let rows: Vec<Vec<String>> = reader.records().map(row).collect::<Result<_, _>>()?;
        match rows.is_empty() {
            true => Err(refused(
                name,
                "it has no points".to_owned(),
                "write a line of values for each point below that of the keys",
            )),
            false => Ok(Self { keys, values: Values::Rows(rows) }),
        }
    }

    /// Points by a row of values for each, texts of TOML in the order of the keys.
    ///
    /// # Errors
    /// [`SweepError::Vary`] of a key that is missing or there twice, a row without a value for each key, and no row at all.
    pub fn of_rows(keys: Vec<String>, rows: Vec<Vec<String>>) -> Result<Self, SweepError> {
        check_keys(&keys)?;
        if rows.is_empty() {
            return Err(refused(&keys.join(","), "it has no points".to_owned(), "give one value of each key at least"));
        }
        if let Some(k) = rows.iter().position(|row| row.len() != keys.len()) {
            let why = format!("point {k} has {} values for {} keys", rows[k].len(), keys.len());
            return Err(refused(&keys.join(","), why, "give each point a value of each key"));
        }
        for row in &rows {
            row.iter().zip(&keys).try_for_each(|(value, key)| typed(key, value).map(drop))?;
        }
        Ok(Self { keys, values: Values::Rows(rows) })
    }

    /// The points whose settings `KEY=VALUE` are given, point by point.
    pub(crate) fn of_settings(keys: Vec<String>, settings: &[Vec<String>]) -> Option<Self> {
        let value =
            |(text, key): (&String, &String)| Some(text.strip_prefix(key.as_str())?.strip_prefix('=')?.to_owned());
        let row = |row: &Vec<String>| {
            row.iter().zip(&keys).map(value).collect::<Option<Vec<_>>>().filter(|r| r.len() == keys.len())
        };
        let rows = settings.iter().map(row).collect::<Option<Vec<_>>>()?;
        Some(Self { keys, values: Values::Rows(rows) })
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        match &self.values {
            Values::Product(lists) => lists.iter().fold(1, |n, list| n.saturating_mul(list.len())),
            Values::Rows(rows) => rows.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The varied keys.
    pub fn keys(&self) -> &[String] {
        &self.keys
    }

    /// The value of a key at a point.
    ///
    /// # Panics
    /// If there is no such key or point.
    pub fn value(&self, point: usize, key: usize) -> &str {
        match &self.values {
            Values::Rows(rows) => &rows[point][key],
            Values::Product(lists) => {
                let inner = lists[key + 1..].iter().fold(1, |n: usize, list| n.saturating_mul(list.len()));
                &lists[key][point / inner % lists[key].len()]
            }
        }
    }

    /// The value of a key at a point as a number; NaN if it is none.
    pub fn number(&self, point: usize, key: usize) -> f64 {
        self.value(point, key).parse().unwrap_or(f64::NAN)
    }

    /// The settings `KEY=VALUE` of a point, for `--set`.
    pub fn settings(&self, point: usize) -> Vec<String> {
        self.keys.iter().enumerate().map(|(key, name)| format!("{name}={}", self.value(point, key))).collect()
    }

    /// Whether the points are the same, one by one.
    pub fn same(&self, other: &Self) -> bool {
        self == other
            || self.keys == other.keys
                && self.len() == other.len()
                && (0..self.len()).all(|point| self.settings(point) == other.settings(point))
    }
}

fn refused(text: &str, why: String, help: &str) -> SweepError {
    SweepError::Vary { text: text.to_owned(), why, help: help.to_owned() }
}

fn check_keys(keys: &[String]) -> Result<(), SweepError> {
    if keys.is_empty() || keys.iter().any(String::is_empty) {
        let help = "name a key of the scene, as parameters.F or method.tolerance";
        return Err(refused(&keys.join(","), "a key is missing".to_owned(), help));
    }
    let paths: Vec<Vec<String>> = keys.iter().map(|key| path(key)).collect();
    for (k, own) in paths.iter().enumerate() {
        // a table and one of its keys are varied together
        if let Some(other) = paths[..k].iter().position(|other| own.starts_with(other) || other.starts_with(own)) {
            let what = match *own == paths[other] {
                true => "this key is varied twice".to_owned(),
                false => format!("one of this key and {} is a part of the other", keys[other]),
            };
            return Err(refused(&keys[k], what, "vary it once, with all its values"));
        }
    }
    Ok(())
}

/// The names of a dotted key; the key itself if it is none, which the scene will refuse.
fn path(key: &str) -> Vec<String> {
    let Ok(mut table) = toml::from_str::<toml::Table>(&format!("{key}=0")) else { return vec![key.to_owned()] };
    let mut names = Vec::new();
    while let Some((name, value)) = std::mem::take(&mut table).into_iter().next() {
        names.push(name);
        if let toml::Value::Table(inner) = value {
            table = inner;
        }
    }
    names
}

/// A key and its values, of `KEY=FROM:TO:N` or `KEY=a,b,c`.
fn axis(text: &str) -> Result<(String, Vec<String>), SweepError> {
    const HELP: &str = "write KEY=FROM:TO:N for N values at equal distances, or KEY=a,b,c";
    let Some((key, values)) = text.split_once('=') else {
        return Err(refused(text, "there is no =".to_owned(), HELP));
    };
    let (key, values) = (key.trim(), values.trim());
    if let Some(range) = range(values) {
        return Ok((key.to_owned(), range.map_err(|why| refused(text, why, HELP))?));
    }
    let list = entries(values).into_iter().map(|value| typed(key, value)).collect::<Result<Vec<_>, _>>()?;
    Ok((key.to_owned(), list))
}

/// The values of `FROM:TO:N`; None if the text has not three parts, or why it is wrong.
fn range(text: &str) -> Option<Result<Vec<String>, String>> {
    let parts: Vec<&str> = text.split(':').map(str::trim).collect();
    let [from, to, count] = parts[..] else { return None };
    let (Ok(a), Ok(b)) = (from.parse::<f64>(), to.parse::<f64>()) else { return None };
    let Ok(n) = count.parse::<usize>() else { return Some(Err(format!("{count:?} is no number of values"))) };
    if !(a.is_finite() && b.is_finite()) {
        return Some(Err("both ends must be finite".to_owned()));
    }
    if n == 0 || n == 1 && a != b || n > 1 && a == b {
        return Some(Err(format!("from {from} to {to} there are no {n} values at equal distances")));
    }
    if n > MOST_POINTS * 1000 {
        return Some(Err(format!("{n} values are too many")));
    }
    // whole numbers stay whole: counts must be
    let whole = |text: &str| text.parse::<i64>().is_ok();
    let keeps_whole = whole(from) && whole(to) && (n == 1 || (b - a) % (n as f64 - 1.0) == 0.0);
    let value = |k: usize| {
        let share = k as f64 / (n.max(2) - 1) as f64;
        let v = if k + 1 == n { b } else { a + (b - a) * share };
        if keeps_whole { format!("{}", v.round() as i64) } else { format!("{v:?}") }
    };
    Some(Ok((0..n).map(value).collect()))
}

/// The entries of a list, whose commas are those outside of brackets and quotes.
fn entries(text: &str) -> Vec<&str> {
    let (mut depth, mut quote, mut start, mut list) = (0, None, 0, Vec::new());
    for (at, c) in text.char_indices() {
        match (quote, c) {
            (Some(open), c) if c == open => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{') => depth += 1,
            (None, ']' | '}') => depth -= 1,
            (None, ',') if depth == 0 => {
                list.push(text[start..at].trim());
                start = at + 1;
            }
            _ => {}
        }
    }
    list.push(text[start..].trim());
    list
}

/// A value as TOML: as it is, or in quotes if it is a word or an expression.
fn typed(key: &str, value: &str) -> Result<String, SweepError> {
    if value.is_empty() || value.contains('\n') {
        let why = if value.is_empty() { "a value is missing" } else { "a value has several lines" };
        return Err(refused(&format!("{key}={value}"), why.to_owned(), "write one value of TOML for each point"));
    }
    Ok(match toml::from_str::<toml::Table>(&format!("v={value}")) {
        Ok(table) if table.len() == 1 => value.to_owned(),
        _ => toml::Value::String(value.to_owned()).to_string(),
    })
}
