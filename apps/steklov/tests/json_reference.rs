//! `docs/reference/json.md` describes every path of the JSON objects: each has one row with its type and unit, and each row, with all
//! that it says of null and of keys that are left out, is seen.

use crate::place::Place;

use std::collections::BTreeSet;

use serde_json::{Map, Value, json};

const PAGE: &str = include_str!("../../../docs/reference/json.md");

/// What the column of units may say.
const UNITS: [&str; 13] = [
    "1",
    "length",
    "stress",
    "1/stress",
    "stress × length",
    "stress × length²",
    "(stress × length²)^½",
    "radian",
    "second",
    "byte",
    "of the quantity",
    "square of the quantity",
    "that of the path",
];

/// A row of a table.
pub struct Row {
    pub keys: Vec<&'static str>,
    pub kind: &'static str,
    pub unit: &'static str,
    there: &'static str,
}

/// What was seen of a row: a value, null, an object without the key.
#[derive(Default)]
struct Seen {
    value: bool,
    null: bool,
    missing: bool,
}

/// The rows of one object against objects.
pub struct Table {
    pub rows: Vec<Row>,
    seen: Vec<Seen>,
    wrong: BTreeSet<String>,
}

/// The tables of the object of `solve`, and of that of `plan`.
pub fn parts_of_page() -> [&'static str; 2] {
    PAGE.split_once("\n## The plan\n").unwrap().into()
}

fn rows(part: &'static str) -> Vec<Row> {
    let of_line = |line: &'static str| {
        let cells: Vec<&str> = line.trim_matches('|').split(" |").map(str::trim).collect();
        let [path, kind, unit, there, meaning] = cells[..] else { panic!("{line}") };
        assert!(meaning.ends_with('.'), "{line}");
        assert!(["always", "null ", "left out "].iter().any(|word| there.starts_with(word)), "{line}");
        let measured = ["number", "count", "vector", "tensor"].iter().any(|kind_| kind.contains(kind_));
        assert!(if measured { UNITS.contains(&unit) } else { unit.is_empty() }, "{line}");
        Row { keys: path.trim_matches('`').split('.').collect(), kind, unit, there }
    };
    part.lines().filter(|line| line.starts_with("| `")).map(of_line).collect()
}

/// Whether a path, N for the items of lists, is one that keys stand for.
fn matches(keys: &[&str], path: &[&str]) -> bool {
    let Some((key, rest)) = keys.split_first() else { return path.is_empty() };
    match *key {
        "QUANTITY" => (1..=path.len()).any(|n| matches(rest, &path[n..])),
        key => path.split_first().is_some_and(|(own, more)| (key == "NAME" || key == *own) && matches(rest, more)),
    }
}

fn is_word(key: &&str) -> bool {
    !["NAME", "QUANTITY"].contains(key)
}

/// Whether a value is of a type; null may stand for any number in it.
fn fits(kind: &str, value: &Value) -> bool {
    let numbers =
        |n: usize| value.as_array().is_some_and(|all| all.len() == n && all.iter().all(|v| fits("number", v)));
    match kind {
        "text" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number() || value.is_null(),
        "count" => value.is_u64(),
        "vector" => numbers(2),
        "tensor" => numbers(3),
        "object" => value.is_object(),
        list => {
            let items = list.strip_prefix("list of ").unwrap_or_else(|| panic!("{list} is no type"));
            // "texts", "lists of texts"
            let item = items.replacen("s of ", " of ", 1);
            let item = if items == item { items.trim_end_matches('s') } else { &item };
            value.as_array().is_some_and(|all| all.iter().all(|value| fits(item, value)))
        }
    }
}

impl Table {
    pub fn new(part: &'static str) -> Self {
        let rows = rows(part);
        let seen = rows.iter().map(|_| Seen::default()).collect();
        Self { rows, seen, wrong: BTreeSet::new() }
    }

    /// The row of a path: of those that match the one with the most words.
    pub fn row(&self, path: &[&str]) -> Option<usize> {
        let words = |k: usize| self.rows[k].keys.iter().filter(|key| is_word(key)).count();
        let own: Vec<usize> = (0..self.rows.len()).filter(|&k| matches(&self.rows[k].keys, path)).collect();
        let most = own.iter().map(|&k| words(k)).max()?;
        let best: Vec<usize> = own.into_iter().filter(|&k| words(k) == most).collect();
        assert_eq!(best.len(), 1, "{} has several rows", path.join("."));
        Some(best[0])
    }

    fn object(&mut self, name: &str, path: &[&str], object: &Map<String, Value>) {
        self.missing(name, path, object);
        for (key, value) in object {
            let path = [path, &[key]].concat();
            self.entry(name, &path, value);
            match value {
                Value::Object(inner) => self.object(name, &path, inner),
                Value::Array(items) => {
                    let path = [&path[..], &["N"]].concat();
                    items.iter().filter_map(Value::as_object).for_each(|inner| self.object(name, &path, inner));
                }
                _ => {}
            }
        }
    }

    fn entry(&mut self, name: &str, path: &[&str], value: &Value) {
        let Some(k) = self.row(path) else {
            self.wrong.insert(format!("{} of {name} has no row", path.join(".")));
            return;
        };
        let Row { kind, there, .. } = self.rows[k];
        let null = value.is_null() || value.as_array().is_some_and(|all| all.iter().any(Value::is_null));
        if null && !there.contains("null") || !value.is_null() && !fits(kind, value) {
            self.wrong.insert(format!("{} of {name} is {value}, its row says {kind}, {there}", path.join(".")));
        }
        self.seen[k].null |= null;
        self.seen[k].value |= !null;
    }

    /// The keys that an object has not, and might have.
    fn missing(&mut self, name: &str, path: &[&str], object: &Map<String, Value>) {
        // contact and contact.force of the statistics of contact.force.y hold no statistics themselves
        let own = self.row(path);
        let holds = object.values().all(Value::is_object);
        for k in 0..self.rows.len() {
            let Row { keys, there, .. } = &self.rows[k];
            let (last, before) = keys.split_last().unwrap();
            let is_own = match before.contains(&"QUANTITY") {
                true => {
                    own.is_some_and(|own| self.rows[own].keys == before) && !(holds && before.ends_with(&["QUANTITY"]))
                }
                false => matches(before, path),
            };
            let is_missing = match *last {
                "QUANTITY" => false,
                "NAME" => object.is_empty(),
                key => !object.contains_key(key),
            };
            if !is_own || !is_missing {
                continue;
            }
            if is_word(last) && !there.contains("left out") {
                self.wrong.insert(format!("{} of {name} is left out, its row says {there}", keys.join(".")));
            }
            self.seen[k].missing = true;
        }
    }

    /// What is wrong, rows that were not seen included.
    fn judge(self) -> BTreeSet<String> {
        let mut wrong = self.wrong;
        for (Row { keys, there, .. }, Seen { value, null, missing }) in self.rows.iter().zip(&self.seen) {
            let demands = [
                ("a value", true, value),
                ("null", says(there, "null"), null),
                ("no key", says(there, "left out"), missing),
            ];
            for (what, is_said, is_seen) in demands {
                if is_said && !is_seen {
                    wrong.insert(format!("{} is never seen with {what}, its row says {there}", keys.join(".")));
                }
            }
        }
        wrong
    }
}

/// Whether a row says a word without the mark of what the scenes do not show.
fn says(there: &str, word: &str) -> bool {
    there.contains(word) && !there.contains(&format!("{word}†"))
}

/// Two blocks that are pressed through each other, with no interface between them.
const PASSING: &str = r#"title = "Two blocks that pass"
[material]
young = 1.0
poisson = 0.3
[[body]]
name = "lower"
corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[[body]]
name = "upper"
corners = [[0, 1.1], [1, 1.1], [1, 2.1], [0, 2.1]]
sides = ["bottom", "right", "top", "left"]
[sides.lower.bottom]
displacement = ["0", "0.1"]
[sides.upper.top]
displacement = ["0", "-0.1"]
[method]
refine = "none"
elements = 8
"#;

/// Small scenes with what no other kind has: name, file, settings.
const MORE: [(&str, &str, &[&str]); 6] = [
    (
        "springs",
        "block.toml",
        &[
            "units.length=\"mm\"",
            "sides.left.springs=\"1\"",
            "sides.right.displacement=[\"0\", \"0\"]",
            "probe={ points = [[2, 1]], lines = [{ from = [0, 1], to = [3, 1], points = 4 }], sides = [\"top\"] }",
        ],
    ),
    ("unsolved", "block.toml", &["units.stress=\"MPa\"", "sides.floor.contact.gap=1e9"]),
    (
        "out-of-bounds",
        "block.toml",
        &[
            "random.rise={ distribution = \"uniform\", low = -1, high = 1 }",
            "random.more={ distribution = \"uniform\", low = -1, high = 1 }",
            "stochastic={ method = \"sparse\", level = 1, quantities = [\"contact.length\", \"strain_energy\"] }",
            "body.corners=[[0, 0], [10, 0], [10, 2], [0, 2]]",
            "material.young=1000",
            "sides.floor.contact={ gap = \"0.001 - 0.02*(rise^2 + more^2)\" }",
            "sides.top={ displacement = [\"0\", \"-0.0001\"] }",
            "method.elements=24",
        ],
    ),
    ("passing", "passing.toml", &[]),
    (
        "oversampled",
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/37-block-of-random-cells.toml"),
        &["grid.basis=\"oversampled\"", "method.estimators=true"],
    ),
    (
        "floating",
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/35-checkerboard.toml"),
        &[
            "grid.basis=\"coupled\"",
            "grid.fine=[2, 2]",
            "sides.left={ traction=[\"-1\", \"0\"] }",
            "sides.right={ traction=[\"1\", \"0\"] }",
        ],
    ),
];

fn more(place: &Place) -> Vec<(String, Value)> {
    place.write("passing.toml", PASSING);
    let solve = |&(name, scene, settings): &(&str, &str, &[&str])| {
        let out = format!("{name}.vtkhdf");
        let set = settings.iter().flat_map(|setting| ["--set", setting]);
        let ran = place.run(["solve", scene, "--quiet", "--json", "--out", &out].into_iter().chain(set));
        assert!(ran.status == 0 || ran.status == 3, "{name}: {}", ran.err);
        (name.to_owned(), ran.json())
    };
    MORE.iter().map(solve).collect()
}

/// The page against the objects of solved scenes, and of a few more, and of their plans, each with its name.
pub fn all_paths_are_described(place: &Place, mut results: Vec<(String, Value)>, plans: Vec<(String, Value)>) {
    results.extend(more(place));
    let [of_results, of_plans] = parts_of_page();
    let mut wrong = BTreeSet::new();
    for (part, objects) in [(of_results, results), (of_plans, plans)] {
        let mut table = Table::new(part);
        for (name, object) in &objects {
            table.object(name, &[], object.as_object().unwrap());
        }
        println!("{} rows describe {} objects", table.rows.len(), objects.len());
        wrong.extend(table.judge());
    }
    assert!(wrong.is_empty(), "{}", Vec::from_iter(wrong).join("\n"));
}

/// A table.
const TABLE: &str = "
| `size` | count | 1 | always | A size. |
| `force` | vector | stress × length | always | A force. |
| `failure` | text | | null if all is well | A message. |
| `bodies` | list of objects | | left out without bodies | Some. |
| `bodies.N.NAME` | list of numbers | 1 | always | Numbers. |
| `bodies.N.NAME.never` | number | 1 | always | A number. |
";

/// What the table says of objects.
fn judged(objects: &[Value]) -> Vec<String> {
    let mut table = Table::new(TABLE);
    objects.iter().for_each(|object| table.object("it", &[], object.as_object().unwrap()));
    Vec::from_iter(table.judge())
}

#[test]
fn objects_that_differ_from_a_table_are_noticed() {
    let whole = json!({ "size": 3, "force": [1.0, 0.5], "failure": "no", "bodies": [{ "sizes": [1, 2] }] });
    let sound = [whole, json!({ "size": 0, "force": [0, 0], "failure": null })];
    let never = "bodies.N.NAME.never is never seen with a value, its row says always";
    assert_eq!(judged(&sound), [never]);
    let unseen = judged(&sound[..1]);
    assert!(unseen.contains(&"failure is never seen with null, its row says null if all is well".into()), "{unseen:?}");
    assert!(unseen.contains(&"bodies is never seen with no key, its row says left out without bodies".into()));
    for (key, value, told) in [
        ("size", json!(-1), "size of it is -1, its row says count, always"),
        ("size", json!(null), "size of it is null, its row says count, always"),
        ("force", json!([1.0]), "force of it is [1.0], its row says vector, always"),
        ("force", json!([1.0, null]), "force of it is [1.0,null], its row says vector, always"),
        (
            "bodies",
            json!([{ "sizes": ["1"] }]),
            "bodies.N.sizes of it is [\"1\"], its row says list of numbers, always",
        ),
        ("more", json!(1), "more of it has no row"),
    ] {
        let mut objects = sound.to_vec();
        objects[0][key] = value;
        assert!(judged(&objects).iter().any(|line| line == told), "{told}: {:?}", judged(&objects));
    }
    let mut objects = sound.to_vec();
    objects[0].as_object_mut().unwrap().remove("size");
    assert!(judged(&objects).contains(&"size is left out, its row says always".replace("size", "size of it")));
}
