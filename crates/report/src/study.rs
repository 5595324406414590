//! The page of a stored study: its tables, and the pictures that were drawn beside it.
//!
//! ```text
//! study file ─► content, scene, settings, summary (JSON) ─► a table for each list of objects ┐
//! SVG and PNG files of its folder ────────────────────────────────────────────────────────────┴─► index.html
//! ```

use std::path::Path;

use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment, context};
use serde::Serialize;
use serde_json::{Map, Value};
use steklov_io::{File, load_text, load_texts, read_text_attribute};
use steklov_picture::{STYLE, data_uri, short};

use crate::images::Image;
use crate::{LARGEST, ReportError};

const TEMPLATE: &str = include_str!("study.html");
/// How the attribute `content` of a study begins.
const STUDY: &str = "study: ";
/// Vectors with more bytes than this are left for the pixels beside them.
const LARGE: usize = 150_000;
/// Digits of a number of a table.
const DIGITS: usize = 5;

#[derive(Serialize)]
struct Page {
    title: String,
    style: &'static str,
    program: String,
    file: String,
    what: String,
    incomplete: bool,
    facts: Vec<[String; 2]>,
    tables: Vec<Table>,
    pictures: Vec<Image>,
    without: Vec<String>,
    scene: String,
    settings: Vec<String>,
}

/// Objects of one kind below each other.
#[derive(Serialize)]
struct Table {
    name: String,
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
}

/// A picture of the folder of a study: the name of its file without ending, and its bytes as SVG and as PNG, empty where there is none.
pub struct Drawn {
    /// Name.
    pub name: String,
    /// The vectors.
    pub svg: Vec<u8>,
    /// The pixels.
    pub png: Vec<u8>,
}

/// Whether a file holds a study.
pub fn is_study(file: &File) -> bool {
    read_text_attribute(file, "content").is_ok_and(|content| content.starts_with(STUDY))
}

/// The pictures beside the file of a study, by their names; none where the folder cannot be read.
pub fn pictures_beside(file: &Path) -> Vec<Drawn> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_picture = |path: &std::path::PathBuf| path.extension().is_some_and(|e| e == "svg" || e == "png");
    let mut names: Vec<_> = files.filter(is_picture).map(|path| path.with_extension("")).collect();
    names.sort();
    names.dedup();
    let read = |path: &Path, ending: &str| {
        std::fs::read(path.with_file_name(format!("{}.{ending}", stem(path)))).unwrap_or_default()
    };
    names.iter().map(|path| Drawn { name: stem(path), svg: read(path, "svg"), png: read(path, "png") }).collect()
}

fn stem(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// The page of a study in a file of some name.
///
/// # Errors
/// A file that is no study.
pub fn study_page(file: &File, name: &str, pictures: Vec<Drawn>) -> Result<String, ReportError> {
    let text = load_text(file, "summary")?;
    let summary: Map<String, Value> =
        serde_json::from_str(&text).map_err(|e| ReportError::Page(format!("the summary is no JSON object: {e}")))?;
    let content = read_text_attribute(file, "content").unwrap_or_default();
    let mut tables = Vec::new();
    for (key, value) in &summary {
        add_tables(&[words(key)], value, &mut tables);
    }
    let facts = summary.iter().filter_map(|(key, value)| Some([words(key), scalar(value)?]));
    let mut page = Page {
        title: summary.get("title").and_then(Value::as_str).unwrap_or(name).to_owned(),
        style: STYLE,
        program: read_text_attribute(file, "program").unwrap_or_default(),
        file: name.to_owned(),
        what: content.strip_prefix(STUDY).unwrap_or(&content).to_owned(),
        incomplete: summary.get("complete") == Some(&Value::Bool(false)),
        facts: facts.filter(|[key, _]| key != "title").collect(),
        tables,
        pictures: Vec::new(),
        without: Vec::new(),
        scene: load_text(file, "scene")?,
        settings: load_texts(file, "overrides")?,
    };
    let mut left = LARGEST.saturating_sub(rendered(&page)?.len());
    for Drawn { name, svg, png } in pictures {
        let source = match svg.is_empty() || svg.len() > LARGE && !png.is_empty() {
            true => data_uri("png", &png),
            false => data_uri("svg+xml", &svg),
        };
        let image = Image { alternative: words(&name), source };
        // beside the picture stand its text and the tags around it
        match left.checked_sub(image.source.len() + 2 * image.alternative.len() + 200) {
            Some(rest) => {
                left = rest;
                page.pictures.push(image);
            }
            None => page.without.push(image.alternative),
        }
    }
    rendered(&page)
}

fn rendered(page: &Page) -> Result<String, ReportError> {
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    let text = environment.render_named_str("study.html", TEMPLATE, context! { page => Serde(page) });
    text.map_err(|e| ReportError::Page(format!("{e:#}")))
}

/// Adds a table for each list of objects in a value, the scalars of each object in a row; its path is what it is called.
fn add_tables(path: &[String], value: &Value, tables: &mut Vec<Table>) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                add_tables(&[path, &[words(key)]].concat(), value, tables);
            }
        }
        Value::Array(items) => {
            let objects: Vec<&Map<String, Value>> = items.iter().filter_map(Value::as_object).collect();
            tables.extend(table(path, &objects));
            for (k, object) in objects.iter().enumerate() {
                let number = (k + 1).to_string();
                let name = object.get("name").and_then(Value::as_str).unwrap_or(&number);
                for (key, value) in *object {
                    add_tables(&[path, &[name.to_owned(), words(key)]].concat(), value, tables);
                }
            }
        }
        _ => {}
    }
}

/// The scalars of objects, each a row; none without any.
fn table(path: &[String], objects: &[&Map<String, Value>]) -> Option<Table> {
    let mut keys: Vec<&String> = Vec::new();
    for (key, value) in objects.iter().flat_map(|object| object.iter()) {
        if cell(value).is_some_and(|text| !text.is_empty()) && !keys.contains(&key) {
            keys.push(key);
        }
    }
    // names stand first
    keys.sort_by_key(|key| *key != "name");
    let row = |object: &&Map<String, Value>| -> Vec<String> {
        keys.iter().map(|key| object.get(*key).and_then(cell).unwrap_or_default()).collect()
    };
    let columns = keys.iter().map(|key| words(key)).collect();
    (!keys.is_empty()).then(|| Table { name: path.join(", "), columns, rows: objects.iter().map(row).collect() })
}

/// A scalar, or a list of scalars, as a cell shows it; none of what has parts.
fn cell(value: &Value) -> Option<String> {
    match value {
        Value::Array(items) => Some(items.iter().map(scalar).collect::<Option<Vec<_>>>()?.join(", ")),
        other => scalar(other),
    }
}

fn scalar(value: &Value) -> Option<String> {
    match value {
        Value::Null => Some(String::new()),
        Value::Bool(is_so) => Some(if *is_so { "yes" } else { "no" }.to_owned()),
        Value::Number(number) => Some(match number.as_f64().filter(|_| !number.is_i64() && !number.is_u64()) {
            Some(value) => short(value, DIGITS),
            None => number.to_string(),
        }),
        Value::String(text) => Some(text.clone()),
        Value::Array(_) | Value::Object(_) => None,
    }
}

/// A key as words.
fn words(key: &str) -> String {
    key.replace(['_', '-'], " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn lists_of_objects_are_tables_by_their_paths() {
        let summary = json!({
            "complete": true,
            "strategies": [
                { "name": "h", "fits": [{ "law": "algebraic", "rate": -1.5 }], "steps": [
                    { "dofs": 32, "error": 0.123456789, "doubts": ["sets", "transition"] },
                    { "dofs": 64, "error": null, "doubts": [] },
                ] },
                { "name": "hp", "fits": [], "steps": [] },
            ],
        });
        let mut tables = Vec::new();
        add_tables(&["strategies".into()], &summary["strategies"], &mut tables);
        let names: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
        assert_eq!(names, ["strategies", "strategies, h, fits", "strategies, h, steps"]);
        assert_eq!(
            (&tables[0].columns, &tables[0].rows),
            (&vec!["name".into()], &vec![vec!["h".into()], vec!["hp".into()]])
        );
        let steps = &tables[2];
        let place = |name: &str| steps.columns.iter().position(|column| column == name).unwrap();
        assert_eq!(steps.rows[0][place("error")], "0.12346");
        assert_eq!([&steps.rows[0][place("doubts")], &steps.rows[1][place("doubts")]], ["sets, transition", ""]);
        assert_eq!([&steps.rows[1][place("dofs")], &steps.rows[1][place("error")]], ["64", ""]);
    }
}
