//! `[method]` and `[expect]`.

use steklov_contact::MultiplierDegree;
use steklov_problem::{
    CUTTINGS, DataErrorKind, Expectation, INDICATORS, MODELS, MULTIPLIER_MESHES, MULTIPLIERS, Method, Multiplier,
    REFINES, SOLVERS,
};

use super::error::ReadError;
use super::fields::{Field, Fields};
use super::form::Range;
use super::keys;
use super::tree::Value;

/// The word for a value that the program chooses.
pub(super) const AUTO: &str = "auto";

/// The degrees of stabilised multipliers that have a word.
pub(super) const MULTIPLIER_DEGREES: [(&str, MultiplierDegree); 2] =
    [(AUTO, MultiplierDegree::Relative(0)), ("continuous", MultiplierDegree::ContinuousLinear)];

pub(super) fn method(field: Option<Field<'_>>) -> Result<Method, ReadError> {
    let mut method = Method::default();
    let Some(field) = field else { return Ok(method) };
    let fields = Fields::new(&field, &keys::METHOD)?;
    for (key, _, field) in fields.all() {
        match key {
            "model" => method.model = field.choice(&MODELS)?,
            "tolerance" => {
                method.tolerance = Some(field.number_in(&keys::FRACTION)?);
            }
            "refine" => method.refine = field.choice(&REFINES)?,
            "elements" => method.elements = Some(field.whole(keys::ELEMENTS)?),
            "degree" => method.degree = field.whole(keys::DEGREE)?,
            "max_dofs" => method.max_dofs = Some(field.whole(keys::DOFS)?),
            "max_steps" => method.max_steps = field.whole(keys::STEPS)?,
            "cuts" => method.cuts = field.choice(&CUTTINGS)?,
            "indicator" => method.indicator = field.choice(&INDICATORS)?,
            "estimators" => method.estimators = field.flag()?,
            "marking" => method.marking = auto(&field, &keys::SHARE)?,
            "smoothness" => method.smoothness = field.number_in(&keys::SHARE)?,
            "multiplier" => method.multiplier = field.choice(&MULTIPLIERS)?,
            "gamma" => method.gamma = auto(&field, &keys::ABOVE_ZERO)?,
            "multiplier_mesh" => method.multiplier_mesh = field.choice(&MULTIPLIER_MESHES)?,
            "multiplier_degree" => {
                method.multiplier_degree = match &field.item.value {
                    Value::Text(_) => field.choice(&MULTIPLIER_DEGREES)?,
                    _ => MultiplierDegree::Fixed(field.whole(keys::DEGREE_FROM_0)?),
                };
            }
            _ => method.solver = field.choice(&SOLVERS)?,
        }
    }
    // a default may be written out
    let default = Method::default();
    let changed = [
        ("gamma", method.gamma != default.gamma),
        ("multiplier_mesh", method.multiplier_mesh != default.multiplier_mesh),
        ("multiplier_degree", method.multiplier_degree != default.multiplier_degree),
    ];
    match fields.all().find(|(key, ..)| changed.contains(&(key, true))) {
        Some((_, place, field)) if method.multiplier == Multiplier::Biorthogonal => Err(ReadError::new(
            DataErrorKind::Value,
            place,
            format!("{} has no effect with biorthogonal multipliers", field.name),
            "set method.multiplier = \"stabilised\", or remove it",
        )),
        _ => Ok(method),
    }
}

/// A number, or `None` for the word "auto".
fn auto(field: &Field<'_>, range: &Range) -> Result<Option<f64>, ReadError> {
    let wanted = format!("{AUTO:?}, or a number {}", range.wanted);
    match &field.item.value {
        Value::Text(text) if text == AUTO => Ok(None),
        Value::Text(text) => Err(field.problem(format!("{} is {text:?}", field.name), format!("it must be {wanted}"))),
        _ => field.number_where(|v| range.contains(v), &wanted).map(Some),
    }
}

/// The entries of `[expect]`, as quoted or as nested keys.
pub(super) fn expect(field: &Field<'_>, path: &str, list: &mut Vec<Expectation>) -> Result<(), ReadError> {
    for (key, _, entry) in Fields::open(field)?.all() {
        let path = if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        let leaf = match &entry.item.value {
            Value::Table(entries) => {
                entries.is_empty() || entries.iter().any(|e| !matches!(e.item.value, Value::Table(_)))
            }
            _ => true,
        };
        if !leaf {
            expect(&entry, &path, list)?;
            continue;
        }
        let fields = Fields::new(&entry, &keys::EXPECTATION)?;
        let value = fields.require("value", "value = the number to expect")?.number_in(&keys::FINITE)?;
        let tol = fields.require("tol", "tol = how far the result may be off, such as 1e-6")?;
        let tol = tol.number_in(&keys::NOT_NEGATIVE)?;
        let source = fields.get("source").map_or(Ok(""), |s| s.text())?.to_owned();
        list.push(Expectation { path, value, tol, source });
    }
    Ok(())
}
