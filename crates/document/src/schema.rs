//! The keys of scenes as a JSON schema, by which editors complete and check them.

use serde_json::{Map, Value, json};

use super::form::{Fallback, Form, Key, Range, Table};
use super::keys;

/// The JSON schema (draft 2020-12) of a scene: its keys, their types, words, ranges, defaults and meanings.
///
/// The reader refuses everything that the schema refuses. The schema knows neither names that the scene chooses, nor
/// expressions, nor which keys exclude or need each other. A scene may not write a whole number as 16.0, but JSON does
/// not distinguish it from 16.
///
/// ```
/// let schema = steklov_document::schema();
/// assert_eq!(schema["$defs"]["method"]["properties"]["degree"]["maximum"], 64);
/// ```
pub fn schema() -> Value {
    let tables = keys::SCENE.all();
    let definitions: Map<String, Value> = tables.iter().skip(1).map(|of| (id(of), table(of))).collect();
    let sides = |of: &'static Table| json!({ "properties": { "sides": reference(of) } });
    let mut root = table(&keys::SCENE);
    root["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    root["title"] = json!("Scene of steklov");
    root["$defs"] = Value::Object(definitions);
    // with several bodies, a side is in the table of its body
    root["if"] = json!({ "properties": { "body": { "type": "array" } } });
    root["then"] = sides(&keys::SIDES_OF_BODIES);
    root["else"] = sides(&keys::SIDES);
    root
}

/// The name of the definition of a table.
fn id(table: &Table) -> String {
    let kept = table.name.chars().filter(|c| c.is_ascii_alphanumeric() || "._ ".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

fn reference(table: &Table) -> Value {
    json!({ "$ref": format!("#/$defs/{}", id(table)) })
}

fn table(table: &Table) -> Value {
    let taken = || table.keys.iter().filter(|key| !matches!(key.form, Form::Refused));
    let properties: Map<String, Value> = taken().map(|key| (key.name.to_owned(), property(key))).collect();
    let required: Vec<&str> =
        taken().filter(|key| matches!(key.default, Fallback::Required)).map(|key| key.name).collect();
    let mut of = json!({ "type": "object", "description": table.what });
    of["additionalProperties"] = match &table.names {
        None => json!(false),
        Some((of, what)) => described(form(of), what),
    };
    if !properties.is_empty() {
        of["properties"] = Value::Object(properties);
    }
    if !required.is_empty() {
        of["required"] = json!(required);
    }
    of
}

fn described(mut schema: Value, what: &str) -> Value {
    schema["description"] = json!(what);
    schema
}

fn property(key: &Key) -> Value {
    let unit = if key.unit.is_empty() { String::new() } else { format!(" Unit: {}.", key.unit) };
    let mut of = described(form(&key.form), &format!("{}{unit}", key.what));
    match key.default {
        Fallback::Value(value) => of["default"] = json_of(&value()),
        Fallback::Said("none") | Fallback::Required => {}
        Fallback::Said(said) => of["description"] = json!(format!("{}{unit} Default: {said}.", key.what)),
    }
    of
}

/// A value in TOML as JSON: defaults are numbers, texts, flags and lists of these, which TOML and JSON write alike.
fn json_of(toml: &str) -> Value {
    serde_json::from_str(toml).expect("a default is a value of JSON too")
}

fn form(form: &Form) -> Value {
    alternative(form, Form::take_expressions(form.alternatives()))
}

/// One of several forms; `expressions`: numbers may be texts of expressions, which have no bounds.
fn alternative(form: &Form, expressions: bool) -> Value {
    let number = |word: &str| if expressions { json!([word, "string"]) } else { json!(word) };
    match form {
        Form::Number(range) => bounded(json!({ "type": number("number") }), range),
        Form::Whole(range) => json!({ "type": number("integer"), "minimum": range.0, "maximum": range.1 }),
        Form::Text => json!({ "type": "string" }),
        Form::Flag => json!({ "type": "boolean" }),
        Form::True => json!({ "const": true }),
        Form::Expression(range) => bounded(json!({ "type": ["number", "string"] }), range),
        Form::Words(words) => json!({ "enum": words }),
        Form::Point => list(&Form::Number(keys::FINITE), Some(2)),
        Form::List(of, count) => list(of, *count),
        Form::Table(table) => reference(table),
        Form::OneOf(forms) => {
            json!({ "anyOf": forms.iter().map(|form| alternative(form, expressions)).collect::<Vec<_>>() })
        }
        Form::Refused => json!(false),
    }
}

fn list(of: &Form, count: Option<usize>) -> Value {
    let mut list = json!({ "type": "array", "items": form(of) });
    if let Some(count) = count {
        (list["minItems"], list["maxItems"]) = (json!(count), json!(count));
    }
    list
}

fn bounded(mut schema: Value, range: &Range) -> Value {
    let words = [("exclusiveMinimum", "minimum"), ("exclusiveMaximum", "maximum")];
    for ((value, closed), (open_word, closed_word)) in [range.low, range.high].into_iter().zip(range.closed).zip(words)
    {
        if value.is_finite() {
            schema[if closed { closed_word } else { open_word }] = json!(value);
        }
    }
    schema
}
