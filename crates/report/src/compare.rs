//! Two results beside each other.

use steklov_model::numbers::numbers;
use steklov_model::summary::Summary;

/// A number of two results.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Compared {
    /// Its path in the JSON object.
    pub path: String,
    /// In the first result; None if it has no such number.
    pub first: Option<f64>,
    /// In the second result.
    pub second: Option<f64>,
    /// The second less the first.
    pub difference: Option<f64>,
    /// The larger of both numbers by its absolute value; of components the largest of their vectors.
    pub size: f64,
    /// The absolute difference over that size, 0 where both are equal.
    pub relative: Option<f64>,
}

/// The components of vectors and tensors.
const COMPONENTS: [&str; 5] = ["x", "y", "xx", "yy", "xy"];

/// All numbers of two results, in alphabetical order of their paths.
pub fn compared(first: &Summary, second: &Summary) -> Vec<Compared> {
    let [a, b] = [first, second].map(|summary| numbers(&serde_json::to_value(summary).unwrap_or_default()));
    let of = |list: &[(String, f64)], path: &str| list.iter().find(|(own, _)| own == path).map(|(_, value)| *value);
    let size = |path: &str| {
        let vector = path.rsplit_once('.').filter(|(_, last)| COMPONENTS.contains(last)).map(|(vector, _)| vector);
        let paths: Vec<String> = match vector {
            Some(vector) => COMPONENTS.iter().map(|last| format!("{vector}.{last}")).collect(),
            None => vec![path.to_owned()],
        };
        let values = paths.iter().flat_map(|path| [of(&a, path), of(&b, path)]).flatten();
        values.fold(0.0, |size: f64, value| size.max(value.abs()))
    };
    let paths: std::collections::BTreeSet<&String> = a.iter().chain(&b).map(|(path, _)| path).collect();
    let row = |path: &String| {
        let (first, second) = (of(&a, path), of(&b, path));
        let difference = first.zip(second).map(|(first, second)| second - first);
        let size = size(path);
        let relative = difference.map(|difference| if difference == 0.0 { 0.0 } else { difference.abs() / size });
        Compared { path: path.clone(), first, second, difference, size, relative }
    };
    paths.into_iter().map(row).collect()
}

/// The table as CSV, with the names of both results in its head.
pub fn table(rows: &[Compared], [first, second]: [&str; 2]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:?}"));
    let head = ["number", first, second, "difference", "relative"].map(str::to_owned);
    let lines = rows.iter().map(|row| {
        let [first, second, difference, relative] = [row.first, row.second, row.difference, row.relative].map(number);
        [row.path.clone(), first, second, difference, relative]
    });
    // a vector does not fail
    std::iter::once(head).chain(lines).for_each(|line| writer.write_record(line).unwrap_or_default());
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// How far apart the exact energies of both results may be, and are: the distance of J extrapolated, and the sum of its uncertainties.
/// None where a result has no estimate.
pub fn energies(first: &Summary, second: &Summary) -> Option<[f64; 2]> {
    let distance = (first.energy_extrapolated? - second.energy_extrapolated?).abs();
    Some([distance, first.energy_uncertainty? + second.energy_uncertainty?])
}
