//! The numbers of a result by their paths in the JSON object.

use serde_json::Value;

/// Parts of the object that are no quantities of an answer.
const LEFT_OUT: [&str; 13] = [
    "probe_lines",
    "probe_sides",
    "expect",
    "infinite_stress",
    "max_von_mises_at",
    "ends",
    "point",
    "converged",
    "solution",
    "sides",
    "seconds",
    "peak_memory_bytes",
    // of a quantity: it is told at its own path
    "value",
];

/// Objects whose keys are names of a scene.
const OF_NAMES: [&str; 6] = ["reactions", "pressure", "mean_displacement", "moment", "weighted_force", "opening"];

/// Paths and values of the numbers of the JSON object of a result, a flag being 0 or 1; without what was asked for, long lists, seconds
/// and memory. Of vectors the components are x and y, of stresses xx, yy and xy.
///
/// ```
/// let object = serde_json::json!({ "energy": -1.5, "contact": { "force": [0.0, 2.0], "ends": [[0, 1]] }, "reactions": { "ends": [0.0, 2.0] } });
/// let numbers = steklov_model::numbers::numbers(&object);
/// let paths: Vec<&str> = numbers.iter().map(|(path, _)| path.as_str()).collect();
/// assert_eq!(paths, ["contact.force.x", "contact.force.y", "energy", "reactions.ends.x", "reactions.ends.y"]);
/// assert_eq!(numbers[4].1, 2.0);
/// ```
pub fn numbers(object: &Value) -> Vec<(String, f64)> {
    fn add(value: &Value, path: &str, key: &str, list: &mut Vec<(String, f64)>) {
        let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        match value {
            Value::Bool(flag) => list.push((path.to_owned(), f64::from(u8::from(*flag)))),
            Value::Number(number) => list.extend(number.as_f64().map(|number| (path.to_owned(), number))),
            Value::Object(entries) => entries
                .iter()
                // what is below these are names
                .filter(|(name, _)| OF_NAMES.contains(&key) || !LEFT_OUT.contains(&name.as_str()))
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
