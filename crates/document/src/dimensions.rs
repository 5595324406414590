//! Numbers that are written as expressions of parameters: `radius = "R/2"`.

use steklov_problem::{About, DataErrorKind};

use super::error::{ReadError, SceneErrorKind as Kind};
use super::fields::{Context, Field};
use super::form::{Form, Key};
use super::keys;
use super::tree::{Entry, Item, Value};

/// Largest whole number up to which all whole numbers are of double precision.
const WHOLE: f64 = 9007199254740992.0;

/// Replaces expressions by their values wherever a key takes numbers and no words. The context knows the parameters,
/// and learns which of them are used.
///
/// # Errors
/// The expression cannot be read, depends on the place or on random input, or is not finite.
pub(super) fn evaluate(root: &mut Item, context: &Context<'_>) -> Result<(), ReadError> {
    let names = |table: &str| match root.at(&[table]).map(|item| &item.value) {
        Some(Value::Table(entries)) => entries.iter().map(|entry| entry.key.clone()).collect(),
        _ => Vec::new(),
    };
    let (random, profiles) = (names("random"), names("profiles"));
    let scene = Form::Table(&keys::SCENE);
    Dimensions { context, random, profiles }.item(root, &[&scene], "")
}

struct Dimensions<'a> {
    context: &'a Context<'a>,
    /// The names of random input.
    random: Vec<String>,
    /// The names of profiles.
    profiles: Vec<String>,
}

impl Dimensions<'_> {
    /// Evaluates what is in a value that has one of these forms.
    fn item(&self, item: &mut Item, forms: &[&Form], name: &str) -> Result<(), ReadError> {
        if let Value::Text(_) = item.value
            && Form::take_expressions(forms.iter().copied())
        {
            let field = Field { name: name.to_owned(), item };
            let value = self.value(&field)?;
            if let Value::Float(number) = value
                && forms.iter().all(|form| matches!(form, Form::Whole(_)))
            {
                return Err(
                    field.problem(format!("{name} is {number}"), "it must be a whole number: change the parameters")
                );
            }
            item.value = value;
        }
        match &mut item.value {
            Value::Array(list) => {
                let of: Vec<&Form> =
                    forms.iter().filter_map(|form| form.of_entries()).flat_map(Form::alternatives).collect();
                list.iter_mut().enumerate().try_for_each(|(k, item)| self.item(item, &of, &format!("{name}[{k}]")))
            }
            Value::Table(entries) => entries.iter_mut().try_for_each(|entry| self.entry(entry, forms, name)),
            _ => Ok(()),
        }
    }

    /// Evaluates what is in an entry of a table that has one of these forms.
    fn entry(&self, entry: &mut Entry, forms: &[&Form], table: &str) -> Result<(), ReadError> {
        let tables = || forms.iter().filter_map(|form| if let Form::Table(table) = form { Some(table) } else { None });
        let keys =
            tables().flat_map(|table| table.keys).filter(|key: &&Key| key.name == entry.key).map(|key| &key.form);
        let names = tables().filter_map(|table| table.names.as_ref()).map(|(form, _)| form);
        let of: Vec<&Form> = keys.chain(names).flat_map(Form::alternatives).collect();
        let name = if table.is_empty() { entry.key.clone() } else { format!("{table}.{}", entry.key) };
        self.item(&mut entry.item, &of, &name)
    }

    /// The value of an expression of parameters: a whole number where it is one.
    fn value(&self, field: &Field<'_>) -> Result<Value, ReadError> {
        let expression = field.expression(self.context).map_err(|error| self.of_names(error, field))?;
        let told = || format!("{} depends on the place: {:?}", field.name, expression.text());
        let value = expression.constant().ok_or_else(|| {
            field.problem(told(), "it must be one value: use numbers, pi and the names in [parameters]")
        })?;
        if !value.is_finite() {
            let message = format!("{} is {value}: {:?}", field.name, expression.text());
            return Err(field.problem(message, "it must be finite: change the expression or the parameters in it"));
        }
        let is_whole = value.trunc() == value && value.abs() <= WHOLE;
        Ok(if is_whole { Value::Integer(value as i64) } else { Value::Float(value) })
    }

    /// The error of an expression, with its remedy if it uses random input or a profile.
    fn of_names(&self, error: ReadError, field: &Field<'_>) -> ReadError {
        let About::Text(place) = error.about else { return error };
        let name = &self.context.source.part(place.source)[place.start..place.end];
        let what = [(&self.random, "is random"), (&self.profiles, "is a profile")];
        let what = what.into_iter().find(|(names, _)| names.iter().any(|other| other == name));
        let (Kind::Expression, Some((_, what))) = (error.kind, what) else { return error };
        let message = format!("{} uses {name}, which {what}", field.name);
        let help = "here one number is needed, the same at all places and in all outcomes: use names of [parameters]";
        ReadError::new(DataErrorKind::Unsupported, place, message, help)
    }
}
