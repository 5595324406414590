//! `[random]` and `[stochastic]`: read and checked, though no model of this version uses them.

use steklov_bem_operators::Polygon;

use super::body::check_name;
use super::error::{Problem, SceneErrorKind as Kind};
use super::fields::{Context, Field, Fields};
use super::tree::{Value, suggestion};

/// Adds the names of `[random]` to the constants of expressions, each with a typical value: the centre of a variable,
/// the zero mean of a field.
pub(super) fn random(field: &Field<'_>, polygon: &Polygon, context: &mut Context<'_>) -> Result<(), Problem> {
    for (name, place, table) in Fields::open(field)?.all() {
        check_name(name, place)?;
        if context.constants.contains_key(name) {
            let message = format!("{name} is a parameter as well as a random input");
            return Err(Problem::new(Kind::Conflict, place, message, "rename one of the two"));
        }
        let typical = if Fields::open(&table)?.get("covariance").is_some() {
            rough(&table, polygon)?;
            0.0
        } else {
            variable(&table)?
        };
        context.constants.insert(name.to_owned(), typical);
    }
    Ok(())
}

#[derive(Clone, Copy)]
enum Distribution {
    Uniform,
    Normal,
    Lognormal,
    Beta,
}

/// A random variable; returns a value in its middle.
fn variable(field: &Field<'_>) -> Result<f64, Problem> {
    let words = [
        ("uniform", Distribution::Uniform),
        ("normal", Distribution::Normal),
        ("lognormal", Distribution::Lognormal),
        ("beta", Distribution::Beta),
    ];
    const EXAMPLE: &str = "distribution = \"uniform\", or covariance = \"exponential\" for a field";
    let distribution = Fields::open(field)?.require("distribution", EXAMPLE)?.choice(&words)?;
    let keys: &[&str] = match distribution {
        Distribution::Uniform => &["distribution", "low", "high"],
        Distribution::Normal | Distribution::Lognormal => &["distribution", "mean", "deviation", "low", "high"],
        Distribution::Beta => &["distribution", "alpha", "beta", "low", "high"],
    };
    let fields = Fields::new(field, keys)?;
    let finite = |key: &str| fields.require(key, &format!("{key} = a number"))?.number_where(f64::is_finite, "finite");
    let positive = |key: &str| {
        let number = fields.require(key, &format!("{key} = a positive number"))?;
        number.number_where(|v| v > 0.0 && v.is_finite(), "positive and finite")
    };
    let bounds = |needed: bool| -> Result<[f64; 2], Problem> {
        let end = |key: &str, default: f64| {
            if needed || fields.get(key).is_some() { finite(key) } else { Ok(default) }
        };
        let (low, high) = (end("low", f64::NEG_INFINITY)?, end("high", f64::INFINITY)?);
        if low < high {
            return Ok([low, high]);
        }
        let high_field = fields.require("high", "high = a number")?;
        Err(high_field.problem(format!("{} is not above low = {low}", high_field.name), "make low smaller than high"))
    };
    match distribution {
        Distribution::Uniform => bounds(true).map(|[low, high]| f64::midpoint(low, high)),
        Distribution::Normal => {
            let (mean, _) = (finite("mean")?, positive("deviation")?);
            let [low, high] = bounds(false)?;
            Ok(mean.clamp(low, high))
        }
        Distribution::Lognormal => {
            let (mean, _) = (positive("mean")?, positive("deviation")?);
            let [low, high] = bounds(false)?;
            Ok(mean.clamp(low, high))
        }
        Distribution::Beta => {
            let (alpha, beta) = (positive("alpha")?, positive("beta")?);
            bounds(true).map(|[low, high]| low + (high - low) * alpha / (alpha + beta))
        }
    }
}

/// A random field.
fn rough(field: &Field<'_>, polygon: &Polygon) -> Result<(), Problem> {
    let fields = Fields::new(field, &["covariance", "correlation", "on", "captured", "modes", "variables"])?;
    if let Some(covariance) = fields.get("covariance") {
        covariance.choice(&[("exponential", ()), ("gaussian", ()), ("matern32", ())])?;
    }
    let correlation = fields.require("correlation", "correlation = a length")?;
    let lengths = match correlation.item.value {
        Value::Array(_) => correlation.pair()?.into(),
        _ => vec![correlation],
    };
    for length in lengths {
        length.number_where(|v| v > 0.0 && v.is_finite(), "a positive length, or one for each axis")?;
    }
    let on = fields.require("on", "on = the name of a side, or \"body\"")?;
    let names = polygon.side_names().iter().map(String::as_str).chain(["body"]);
    let word = on.text()?;
    if !names.clone().any(|name| name == word) {
        let message = format!("the body has no side {word:?}");
        return Err(Problem::new(Kind::UnknownKey, on.item.place, message, suggestion(word, names)));
    }
    if let Some(captured) = fields.get("captured") {
        captured.number_where(|v| v > 0.0 && v <= 1.0, "above 0 and at most 1")?;
    }
    if let Some(modes) = fields.get("modes") {
        modes.whole(1, 1_000_000)?;
        if fields.get("captured").is_some() {
            let message = format!("{} stands beside captured", modes.name);
            return Err(Problem::new(Kind::Conflict, modes.item.place, message, "keep captured or modes, not both"));
        }
    }
    if let Some(variables) = fields.get("variables") {
        variables.choice(&[("uniform", ()), ("normal", ())])?;
    }
    Ok(())
}

pub(super) fn stochastic(field: &Field<'_>) -> Result<(), Problem> {
    let known = ["method", "degree", "elements", "samples", "seed", "quantiles", "quantities"];
    for (key, _, field) in Fields::new(field, &known)?.all() {
        match key {
            "method" => field.choice(&[("galerkin", ()), ("collocation", ()), ("monte-carlo", ())])?,
            "degree" => drop(field.whole(0, 64)?),
            "elements" => drop(field.whole(1, 1_000_000)?),
            "samples" => drop(field.whole(1, 1_000_000_000)?),
            "seed" => drop(field.whole(0, i64::MAX as usize)?),
            "quantiles" => {
                for quantile in field.list()? {
                    quantile.number_where(|v| v > 0.0 && v < 1.0, "above 0 and below 1")?;
                }
            }
            _ => {
                for quantity in field.list()? {
                    quantity.text()?;
                }
            }
        }
    }
    Ok(())
}
