//! Typed reading of tables, lists and values.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use steklov_expression::{Expression, FieldValue, Place, Profile};
use steklov_problem::DataErrorKind;

use super::error::{ReadError, SceneErrorKind as Kind};
use super::form::{Range, Table, Whole};
use super::help;
use super::source::Source;
use super::tree::{Entry, Item, Value, suggestion, type_name};

/// The constants, fields and names for reading expressions.
pub(super) struct Context<'a> {
    pub(super) source: &'a Source,
    pub(super) constants: BTreeMap<String, f64>,
    pub(super) fields: BTreeMap<String, Arc<FieldValue>>,
    pub(super) profiles: BTreeMap<String, Arc<Profile>>,
    /// The names that expressions have used so far.
    pub(super) used: RefCell<BTreeSet<String>>,
}

impl<'a> Context<'a> {
    pub(super) fn new(source: &'a Source, constants: BTreeMap<String, f64>) -> Self {
        let (fields, profiles) = (BTreeMap::new(), BTreeMap::new());
        Self { source, constants, fields, profiles, used: RefCell::default() }
    }
}

/// A table whose keys are all known.
pub(super) struct Fields<'a> {
    pub(super) path: String,
    pub(super) place: Place,
    entries: &'a [Entry],
}

/// A value and its full name.
pub(super) struct Field<'a> {
    pub(super) name: String,
    pub(super) item: &'a Item,
}

impl<'a> Fields<'a> {
    /// # Errors
    /// The field is no table, or has a key that is not in `table`.
    pub(super) fn new(field: &Field<'a>, table: &'static Table) -> Result<Self, ReadError> {
        let fields = Self::open(field)?;
        match fields.entries.iter().find(|e| !table.has(&e.key)) {
            Some(entry) => {
                let message = format!("unknown key {}", fields.name(&entry.key));
                let help = help::help(&entry.key, table, fields.entries);
                Err(ReadError::new(Kind::UnknownKey, entry.key_place, message, help))
            }
            None => Ok(fields),
        }
    }

    /// A table whose keys are names that the user chooses.
    pub(super) fn open(field: &Field<'a>) -> Result<Self, ReadError> {
        match &field.item.value {
            Value::Table(entries) => Ok(Self { path: field.name.clone(), place: field.item.place, entries }),
            _ => Err(field.wrong_type("a table")),
        }
    }

    fn name(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    pub(super) fn get(&self, key: &str) -> Option<Field<'a>> {
        self.entries.iter().find(|e| e.key == key).map(|e| Field { name: self.name(key), item: &e.item })
    }

    /// # Errors
    /// The key is missing; `example` shows how to write it.
    pub(super) fn require(&self, key: &str, example: &str) -> Result<Field<'a>, ReadError> {
        self.get(key).ok_or_else(|| {
            let message = format!("{} is missing", self.name(key));
            ReadError::new(Kind::MissingKey, self.place, message, format!("add {example}"))
        })
    }

    /// All entries: key, its place, its value.
    pub(super) fn all(&self) -> impl Iterator<Item = (&'a str, Place, Field<'a>)> + '_ {
        self.entries.iter().map(|e| (e.key.as_str(), e.key_place, Field { name: self.name(&e.key), item: &e.item }))
    }
}

impl<'a> Field<'a> {
    pub(super) fn wrong_type(&self, wanted: &str) -> ReadError {
        let message = format!("{} is {}", self.name, type_name(&self.item.value));
        ReadError::new(Kind::WrongType, self.item.place, message, format!("{} takes {wanted}", self.name))
    }

    pub(super) fn problem(&self, message: impl Into<String>, help: impl Into<String>) -> ReadError {
        ReadError::new(DataErrorKind::Value, self.item.place, message, help)
    }

    pub(super) fn text(&self) -> Result<&'a str, ReadError> {
        match &self.item.value {
            Value::Text(text) => Ok(text),
            _ => Err(self.wrong_type("a string in quotes")),
        }
    }

    pub(super) fn number(&self) -> Result<f64, ReadError> {
        match self.item.value {
            Value::Integer(n) => Ok(n as f64),
            Value::Float(v) => Ok(v),
            _ => Err(self.wrong_type("a number, or an expression of parameters in quotes")),
        }
    }

    pub(super) fn flag(&self) -> Result<bool, ReadError> {
        match self.item.value {
            Value::Boolean(value) => Ok(value),
            _ => Err(self.wrong_type("true or false")),
        }
    }

    /// A number for which `test` holds; `wanted` describes it in words.
    pub(super) fn number_where(&self, test: impl Fn(f64) -> bool, wanted: &str) -> Result<f64, ReadError> {
        let value = self.number()?;
        if test(value) {
            Ok(value)
        } else {
            Err(self.problem(format!("{} is {value}", self.name), format!("it must be {wanted}")))
        }
    }

    /// A number in a range.
    pub(super) fn number_in(&self, range: &Range) -> Result<f64, ReadError> {
        self.number_where(|v| range.contains(v), range.wanted)
    }

    /// A whole number between two bounds.
    pub(super) fn whole(&self, Whole(least, most): Whole) -> Result<usize, ReadError> {
        let Value::Integer(value) = self.item.value else { return Err(self.wrong_type("a whole number")) };
        match usize::try_from(value) {
            Ok(n) if (least..=most).contains(&n) => Ok(n),
            _ => Err(self.problem(
                format!("{} is {value}", self.name),
                format!("it must be a whole number from {least} to {most}"),
            )),
        }
    }

    /// One of the given words.
    pub(super) fn choice<T: Copy>(&self, words: &[(&str, T)]) -> Result<T, ReadError> {
        let text = self.text()?;
        words.iter().find(|w| w.0 == text).map(|w| w.1).ok_or_else(|| {
            let known = words.iter().map(|w| w.0);
            let list = known.clone().collect::<Vec<_>>().join(", ");
            let help = match suggestion(text, known) {
                near if near.starts_with("did") => format!("{near} The choices are {list}"),
                _ => format!("the choices are {list}"),
            };
            self.problem(format!("{} is {text:?}, which is not a choice", self.name), help)
        })
    }

    pub(super) fn list(&self) -> Result<Vec<Field<'a>>, ReadError> {
        let Value::Array(list) = &self.item.value else {
            let key = self.name.rsplit('.').next().unwrap_or_default();
            let wanted = match self.item.value {
                Value::Table(_) if help::is_list_of_tables(key) => {
                    let header: String =
                        self.name.split('.').map(|k| k.split('[').next().unwrap_or(k)).collect::<Vec<_>>().join(".");
                    format!("a list of tables: write [[{header}]] with two pairs of brackets, one such table for each")
                }
                _ => "a list in brackets".to_owned(),
            };
            return Err(self.wrong_type(&wanted));
        };
        Ok(list.iter().enumerate().map(|(k, item)| Field { name: format!("{}[{k}]", self.name), item }).collect())
    }

    /// The two entries of a list; `of` describes them.
    pub(super) fn pair(&self, of: &str) -> Result<[Field<'a>; 2], ReadError> {
        let list = self.list()?;
        let count = list.len();
        let entries = if count == 1 { "entry" } else { "entries" };
        list.try_into()
            .map_err(|_| self.problem(format!("{} has {count} {entries}", self.name), format!("it takes two, {of}")))
    }

    /// The two entries of a list, of x and y.
    pub(super) fn components(&self) -> Result<[Field<'a>; 2], ReadError> {
        self.pair("one for x and one for y")
    }

    /// A point or vector of two plain, finite numbers.
    pub(super) fn point(&self) -> Result<[f64; 2], ReadError> {
        let [x, y] = self.components()?;
        Ok([x.number()?, y.number()?])
    }

    /// A number, or the text of an expression.
    pub(super) fn expression(&self, context: &Context<'_>) -> Result<Expression, ReadError> {
        let mut expression = match &self.item.value {
            Value::Integer(n) => Expression::number(*n as f64),
            Value::Float(v) => Expression::number(*v),
            Value::Text(text) => {
                Expression::with_profiles(text, &context.constants, &context.fields, &context.profiles).map_err(
                    |e| {
                        let Place { source, start, end } = self.item.place;
                        let raw = &context.source.part(source)[start..end];
                        let place = match raw.find(text.as_str()) {
                            Some(offset) if e.span.start < e.span.end => {
                                Place { source, start: start + offset + e.span.start, end: start + offset + e.span.end }
                            }
                            _ => self.item.place,
                        };
                        let message = format!("in the expression of {}: {}", self.name, e.message);
                        ReadError::new(Kind::Expression, place, message, e.help)
                    },
                )?
            }
            _ => return Err(self.wrong_type("a number or an expression in quotes")),
        };
        expression.place = self.item.place;
        context.used.borrow_mut().extend(expression.names().iter().cloned());
        Ok(expression)
    }

    /// The values of two expressions.
    pub(super) fn expressions(&self, context: &Context<'_>) -> Result<[Expression; 2], ReadError> {
        let [x, y] = self.components()?;
        Ok([x.expression(context)?, y.expression(context)?])
    }

    /// A number, or an expression of a point of the body: s has no meaning there.
    pub(super) fn expression_inside(&self, context: &Context<'_>) -> Result<Expression, ReadError> {
        let expression = self.expression(context)?;
        if expression.uses_edge() {
            let message = format!("{} uses s: {:?}", self.name, expression.text());
            return Err(self.problem(message, "s runs along an edge; inside of the body use x and y"));
        }
        Ok(expression)
    }

    /// A number, or an expression that does not depend on the place.
    pub(super) fn constant(&self, context: &Context<'_>) -> Result<f64, ReadError> {
        let expression = self.expression(context)?;
        expression.constant().ok_or_else(|| {
            let help = match context.fields.keys().any(|name| expression.uses(name)) && self.name == "material.young" {
                true => {
                    "a field is constant in cells only: write it as young of [material.cells], with size = the edge of a \
                     cell, and add a [grid]"
                }
                false => "it must be one value: use numbers, pi, the names in [parameters] and random variables only",
            };
            self.problem(format!("{} depends on the place: {:?}", self.name, expression.text()), help)
        })
    }
}
