//! Values checked by the keywords of JSON schema that the schema of scenes uses.

use std::collections::BTreeSet;

use serde_json::Value;

/// The keys `DEFINITION.KEY` of a value with their places, or the place and the keyword that refuse it.
pub fn validate(root: &Value, value: &Value) -> Result<BTreeSet<(String, String)>, String> {
    of(root, ("scene", root), value, "")
}

type Seen = Result<BTreeSet<(String, String)>, String>;

fn of(root: &Value, (name, schema): (&str, &Value), value: &Value, at: &str) -> Seen {
    let mut seen = BTreeSet::new();
    let keywords = match schema {
        Value::Bool(true) => return Ok(seen),
        Value::Object(keywords) => keywords,
        _ => return Err(format!("{at}: false")),
    };
    for (keyword, wanted) in keywords {
        let fine = match keyword.as_str() {
            "$schema" | "$defs" | "title" | "description" | "default" | "then" | "else" => true,
            "type" => match wanted {
                Value::Array(types) => types.iter().any(|wanted| is_type(value, wanted)),
                one => is_type(value, one),
            },
            "enum" => wanted.as_array().unwrap().contains(value),
            "const" => wanted == value,
            "minimum" => value.as_f64().is_none_or(|v| v >= wanted.as_f64().unwrap()),
            "maximum" => value.as_f64().is_none_or(|v| v <= wanted.as_f64().unwrap()),
            "exclusiveMinimum" => value.as_f64().is_none_or(|v| v > wanted.as_f64().unwrap()),
            "exclusiveMaximum" => value.as_f64().is_none_or(|v| v < wanted.as_f64().unwrap()),
            "minItems" => value.as_array().is_none_or(|list| list.len() as u64 >= wanted.as_u64().unwrap()),
            "maxItems" => value.as_array().is_none_or(|list| list.len() as u64 <= wanted.as_u64().unwrap()),
            "required" => wanted
                .as_array()
                .unwrap()
                .iter()
                .all(|key| value.as_object().is_none_or(|table| table.contains_key(key.as_str().unwrap()))),
            "items" => {
                for (k, item) in value.as_array().into_iter().flatten().enumerate() {
                    seen.extend(of(root, (name, wanted), item, &format!("{at}.{k}"))?);
                }
                true
            }
            "properties" | "additionalProperties" => {
                seen.extend(entries(root, (name, schema), value, at, keyword)?);
                true
            }
            "$ref" => {
                let name = wanted.as_str().unwrap().strip_prefix("#/$defs/").unwrap();
                seen.extend(of(root, (name, &root["$defs"][name]), value, at)?);
                true
            }
            "anyOf" => {
                let found: Vec<Seen> =
                    wanted.as_array().unwrap().iter().map(|branch| of(root, (name, branch), value, at)).collect();
                match found.iter().position(Result::is_ok) {
                    Some(_) => found.into_iter().flatten().for_each(|keys| seen.extend(keys)),
                    None => return Err(found.into_iter().filter_map(Result::err).collect::<Vec<_>>().join("; or ")),
                }
                true
            }
            "if" => {
                let holds = of(root, (name, wanted), value, at).is_ok();
                seen.extend(of(root, (name, &schema[if holds { "then" } else { "else" }]), value, at)?);
                true
            }
            other => panic!("the validator does not know the keyword {other}"),
        };
        if !fine {
            return Err(format!("{at}: {keyword} {wanted}"));
        }
    }
    Ok(seen)
}

fn is_type(value: &Value, wanted: &Value) -> bool {
    match wanted.as_str().unwrap() {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|v| v.fract() == 0.0),
        other => panic!("the validator does not know the type {other}"),
    }
}

fn entries(root: &Value, (name, schema): (&str, &Value), value: &Value, at: &str, keyword: &str) -> Seen {
    let mut seen = BTreeSet::new();
    for (key, item) in value.as_object().into_iter().flatten() {
        let known = schema.get("properties").and_then(|known| known.get(key));
        let at = format!("{at}.{key}");
        match (keyword, known) {
            ("properties", Some(known)) => {
                seen.insert((format!("{name}.{key}"), at.clone()));
                seen.extend(of(root, (name, known), item, &at)?);
            }
            ("additionalProperties", None) => seen.extend(of(root, (name, &schema[keyword]), item, &at)?),
            _ => {}
        }
    }
    Ok(seen)
}
