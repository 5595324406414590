//! The scene as a tree of values, each with its place in the text, with overrides applied.

use steklov_expression::{Place, nearest};
use steklov_problem::DataErrorKind;

use super::error::{ReadError, SceneErrorKind as Kind};
use super::source::Source;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A TOML value.
#[derive(Debug, Clone)]
pub(super) enum Value {
    Text(String),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    Date,
    Array(Vec<Item>),
    Table(Vec<Entry>),
}

/// A value and its place.
#[derive(Debug, Clone)]
pub(super) struct Item {
    pub(super) value: Value,
    pub(super) place: Place,
}

impl Item {
    /// The value at a path of keys and positions in lists.
    pub(super) fn at(&self, path: &[&str]) -> Option<&Item> {
        let Some((key, rest)) = path.split_first() else { return Some(self) };
        let next = match &self.value {
            Value::Table(entries) => entries.iter().find(|e| e.key == *key).map(|e| &e.item),
            Value::Array(list) => key.parse::<usize>().ok().and_then(|k| list.get(k)),
            _ => None,
        };
        next?.at(rest)
    }
}

impl Item {
    /// Whether the values are equal, regardless of their places, the order of keys and the notation of numbers.
    pub(super) fn same(&self, other: &Item) -> bool {
        match (&self.value, &other.value) {
            (Value::Table(a), Value::Table(b)) => {
                let there = |e: &Entry| b.iter().any(|f| f.key == e.key && f.item.same(&e.item));
                a.len() == b.len() && a.iter().all(there)
            }
            (Value::Array(a), Value::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.same(b)),
            (Value::Text(a), Value::Text(b)) => a == b,
            (Value::Integer(a), Value::Integer(b)) => a == b,
            (Value::Float(a), Value::Float(b)) => a == b,
            (Value::Integer(a), Value::Float(b)) | (Value::Float(b), Value::Integer(a)) => *a as f64 == *b,
            (Value::Boolean(a), Value::Boolean(b)) => a == b,
            (a, b) => matches!((a, b), (Value::Date, Value::Date)), // no key takes one
        }
    }

    /// Path of the first key whose values differ, or that only one of the two has.
    pub(super) fn difference(&self, other: &Item) -> Option<String> {
        let (Value::Table(a), Value::Table(b)) = (&self.value, &other.value) else {
            return (!self.same(other)).then(String::new);
        };
        let join = |key: &str, rest: String| if rest.is_empty() { key.to_owned() } else { format!("{key}.{rest}") };
        let changed = a.iter().find_map(|e| match b.iter().find(|f| f.key == e.key) {
            Some(f) => e.item.difference(&f.item).map(|rest| join(&e.key, rest)),
            None => Some(e.key.clone()),
        });
        changed.or_else(|| b.iter().find(|f| a.iter().all(|e| e.key != f.key)).map(|f| f.key.clone()))
    }

    /// Removes these keys of a table of the root, and the table if nothing is left.
    pub(super) fn remove(&mut self, table: &str, keys: &[&str]) {
        let Value::Table(tables) = &mut self.value else { return };
        if let Some(Value::Table(entries)) = tables.iter_mut().find(|t| t.key == table).map(|t| &mut t.item.value) {
            entries.retain(|e| !keys.contains(&e.key.as_str()));
        }
        tables.retain(|t| t.key != table || !matches!(&t.item.value, Value::Table(entries) if entries.is_empty()));
    }
}

/// A key of a table and its value.
#[derive(Debug, Clone)]
pub(super) struct Entry {
    pub(super) key: String,
    pub(super) key_place: Place,
    pub(super) item: Item,
}

/// The tree of the file with overrides and settings applied in order.
pub(super) fn build(source: &Source) -> Result<Item, ReadError> {
    let mut root = document(&source.text, 0)?;
    // A message about a missing table points at the first line that is not blank.
    let first = source.text.lines().find(|l| !l.trim().is_empty()).unwrap_or("");
    let start = source.text.find(first).unwrap_or(0);
    root.place = Place { source: 0, start, end: start + first.len() };
    for (k, text) in source.changes().enumerate() {
        set(&mut root, text, k + 1)?;
    }
    Ok(root)
}

fn document(text: &str, source: usize) -> Result<Item, ReadError> {
    let table = DeTable::parse(text).map_err(|e| {
        let span = e.span().unwrap_or(0..0);
        let place = Place { source, start: span.start, end: span.end };
        let message = e.message();
        let help = match message {
            m if m.contains("duplicate") => "keep one of the two entries of this name".to_owned(),
            _ => at_comma(text, span.start, source > 0).unwrap_or_else(|| {
                let form = match source {
                    0 => "scenes are TOML: key = value, text in quotes, lists in brackets, each table header once",
                    _ => "the value is typed as TOML; text needs quotes: --set 'method.refine=\"none\"'",
                };
                form.to_owned()
            }),
        };
        ReadError::new(Kind::Syntax, place, format!("this is not TOML: {message}"), help)
    })?;
    let span = table.span();
    entries(table.get_ref(), source)
        .map(|e| Item { value: Value::Table(e), place: Place { source, start: span.start, end: span.end } })
}

/// Help for a text that stops being TOML at a comma: in a number, or before the next override.
fn at_comma(text: &str, at: usize, is_override: bool) -> Option<String> {
    let (before, after) = (text.get(..at)?, text.get(at..)?.strip_prefix(',')?);
    let is_number = |c: char| c.is_ascii_digit() || "+-.eE_".contains(c);
    let (start, end) = (before.trim_end_matches(is_number).len(), after.find(|c| !is_number(c)).unwrap_or(after.len()));
    if start < at && end > 0 && !after[end..].trim_start().starts_with(['=', '.']) {
        return Some(format!("numbers are written with a decimal point: {}.{}", &before[start..], &after[..end]));
    }
    (is_override && after.contains('='))
        .then(|| format!("write one --set for each key: --set '{before}' --set '{}'", after.trim()))
}

fn entries(table: &DeTable<'_>, source: usize) -> Result<Vec<Entry>, ReadError> {
    let mut entries = Vec::new();
    for (key, value) in table {
        let span = key.span();
        let key_place = Place { source, start: span.start, end: span.end };
        entries.push(Entry { key: key.get_ref().to_string(), key_place, item: item(value, source)? });
    }
    entries.sort_by_key(|e| e.key_place.start);
    Ok(entries)
}

fn item(value: &Spanned<DeValue<'_>>, source: usize) -> Result<Item, ReadError> {
    let span = value.span();
    let place = Place { source, start: span.start, end: span.end };
    let value = match value.get_ref() {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Integer(digits) => {
            Value::Integer(i64::from_str_radix(digits.as_str(), digits.radix()).map_err(|_| {
                ReadError::new(
                    DataErrorKind::Value,
                    place,
                    "this integer does not fit in 64 bits",
                    "write large numbers as 1e20",
                )
            })?)
        }
        // The parser has checked the form; a number that is too large becomes infinite, and its key refuses it.
        DeValue::Float(digits) => Value::Float(digits.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(value) => Value::Boolean(*value),
        DeValue::Datetime(_) => Value::Date,
        DeValue::Array(list) => Value::Array(list.iter().map(|v| item(v, source)).collect::<Result<_, _>>()?),
        DeValue::Table(table) => Value::Table(entries(table, source)?),
    };
    Ok(Item { value, place })
}

/// Applies the override `KEY=VALUE`.
fn set(root: &mut Item, text: &str, source: usize) -> Result<(), ReadError> {
    let (path, value) = read_override(text, source)?;
    let mut target = root;
    for k in 0..path.len() {
        target = step(target, &path, k)?;
    }
    *target = value;
    Ok(())
}

/// Whether an override takes precedence over a setting: its key is the same, or contains the key of the setting.
pub(super) fn decides(text: &str, setting: &str) -> bool {
    match (read_override(text, 0), read_override(setting, 0)) {
        (Ok((path, _)), Ok((own, _))) => path.iter().zip(own).all(|(key, own)| key.0 == own.0),
        _ => false,
    }
}

/// The keys of an override `KEY=VALUE`, and the value.
fn read_override(text: &str, source: usize) -> Result<(Vec<(String, Place)>, Item), ReadError> {
    let whole = Place { source, start: 0, end: text.len() };
    let form = || {
        ReadError::new(
            Kind::Syntax,
            whole,
            format!("the override {text:?} is not of the form KEY=VALUE"),
            "write --set method.tolerance=1e-6; the value is TOML, text in quotes: --set 'method.refine=\"none\"'",
        )
    };
    let equals = equals(text).ok_or_else(form)?;
    if let Some((list, rest)) = text[..equals].split_once('[')
        && let Some((index, after)) = rest.split_once(']')
    {
        let message = format!("the override {text:?} has brackets in its key");
        let help = format!("write entries of lists with a point: --set '{list}.{index}{after}{}'", &text[equals..]);
        return Err(ReadError::new(Kind::Syntax, whole, message, help));
    }
    let depth = depth(&document(&format!("{}=0", &text[..equals]), source).map_err(|_| form())?).ok_or_else(form)?;
    let mut rest = document(text, source)?;
    let mut path = Vec::new();
    for _ in 0..depth {
        match rest.value {
            Value::Table(mut list) if list.len() == 1 => {
                let Entry { key, key_place, item } = list.remove(0);
                path.push((key, key_place));
                rest = item;
            }
            _ => return Err(form()),
        }
    }
    Ok((path, rest))
}

/// Position of the first equals sign outside of quotes.
fn equals(text: &str) -> Option<usize> {
    let mut quote = None;
    for (k, c) in text.char_indices() {
        match (quote, c) {
            (None, '=') => return Some(k),
            (None, '"' | '\'') => quote = Some(c),
            (Some(q), c) if c == q => quote = None,
            _ => {}
        }
    }
    None
}

/// Number of keys on the path to the only value of nested tables.
fn depth(item: &Item) -> Option<usize> {
    match &item.value {
        Value::Table(entries) if entries.len() == 1 => depth(&entries[0].item).map(|d| d + 1),
        Value::Table(_) => None,
        _ => Some(0),
    }
}

/// The value of the k-th key of the path in `target`; a missing key is created, and its table judges it later.
fn step<'a>(target: &'a mut Item, path: &[(String, Place)], k: usize) -> Result<&'a mut Item, ReadError> {
    let (key, place) = (&path[k].0, path[k].1);
    let parent = path[..k].iter().map(|p| p.0.as_str()).collect::<Vec<_>>().join(".");
    match &mut target.value {
        Value::Table(entries) => {
            let at = entries.iter().position(|e| e.key == *key).unwrap_or_else(|| {
                let item = Item { value: Value::Table(Vec::new()), place };
                entries.push(Entry { key: key.clone(), key_place: place, item });
                entries.len() - 1
            });
            entries[at].key_place = place;
            Ok(&mut entries[at].item)
        }
        Value::Array(list) => {
            let (count, name) = (list.len(), Value::Text(key.clone()));
            let named =
                |item: &Item| item.at(&["name"]).is_some_and(|own| own.same(&Item { value: name.clone(), place }));
            let by_name = list.iter().position(named);
            key.parse::<usize>().ok().and_then(|index| list.get_mut(index)).ok_or_else(|| {
                let message = format!("{parent} is a list of {count} entries and has no entry {key}");
                let help = match by_name {
                    Some(index) => format!("did you mean {parent}.{index}?"),
                    None if count == 0 => format!("set the whole list: --set '{parent}=[...]'"),
                    None => format!("count from 0 to {}", count - 1),
                };
                ReadError::new(Kind::UnknownKey, place, message, help)
            })
        }
        other => {
            let message = format!("{parent} is {} and has no key {key}", type_name(other));
            Err(ReadError::new(Kind::WrongType, place, message, format!("set {parent} itself")))
        }
    }
}

/// Name of the type of a value, with its article.
pub(super) fn type_name(value: &Value) -> &'static str {
    match value {
        Value::Text(_) => "a string",
        Value::Integer(_) => "an integer",
        Value::Float(_) => "a number",
        Value::Boolean(_) => "a boolean",
        Value::Date => "a date",
        Value::Array(_) => "a list",
        Value::Table(_) => "a table",
    }
}

/// Help for a name that is not among the known ones.
pub(super) fn suggestion<'a>(word: &str, known: impl Iterator<Item = &'a str> + Clone) -> String {
    match nearest(word, known.clone()) {
        Some(near) => format!("did you mean {near}?"),
        None => format!("known here: {}", known.collect::<Vec<_>>().join(", ")),
    }
}
