//! The statistics as the `stochastic` of the JSON object.

use serde_json::{Map, Value, json as object};
use steklov_problem::{Random, Sampling};

use super::{Level, Quantity, StochasticResult};

/// `{ "energy": { "mean", "variance", "quantiles", .. }, "contact": { "force": { "y": { .. } } }, "solution": { .. } }`: every
/// quantity at its own path.
pub fn json(random: &Random, result: &StochasticResult) -> Value {
    let mut root = Value::Object(Map::new());
    for q in &result.quantities {
        let mut one = object!({ "mean": q.mean, "variance": q.variance, "quantiles": q.quantiles });
        if let Some(error) = q.standard_error {
            one["standard_error"] = error.into();
        }
        if let Some(error) = q.variance_error {
            one["variance_error"] = error.into();
        }
        if let Some(truncation) = q.truncation {
            one["truncation"] = truncation.into();
        }
        if let Some(bounds) = q.bounds_left {
            one["bounds_left"] = object!(bounds);
        }
        one["effects"] = q.effects.as_ref().map_or(Value::Null, |effects| {
            let named = result.labels.iter().zip(effects).map(|(l, e)| (l.clone(), Value::from(*e)));
            Value::Object(named.collect())
        });
        let mut place = &mut root;
        for key in q.name.split('.') {
            place = &mut place[key];
        }
        *place = one;
    }
    let fields = random.fields().map(|(f, _)| {
        let (modes, captured, unresolved) = (f.expansion.len(), f.expansion.captured(), f.expansion.unresolved());
        (f.name.clone(), object!({ "modes": (!f.expansion.is_drawn()).then_some(modes), "captured": captured, "unresolved": unresolved }))
    });
    let lost = random.germs.iter().filter(|g| g.variable.lost() > 0.0);
    root["solution"] = object!({
        "method": method(random.stochastic.method),
        "germs": result.labels,
        "points": result.points.len(),
        "solves": result.solved,
        "checks": result.checks,
        "kept": result.kept.as_ref().map(|(kept, left_out)| {
            object!({ "germs": kept.iter().map(|&germ| &result.labels[germ]).collect::<Vec<_>>(), "left_out": left_out })
        }),
        "levels": levels(result),
        "cells": result.cells.as_ref().map(|c| c.degree.len()),
        "blocks": (random.stochastic.method == Sampling::Galerkin && result.in_body.is_some()).then_some(result.solved),
        "coupled": result.coupled,
        "reason": result.end.word(),
        "truncation_relative": result.truncation,
        "unseen": result.unseen,
        "truncation_measured": result.truncation_measured,
        "iterations": result.iterations,
        "unconverged": result.unconverged,
        "fields": Value::Object(fields.collect()),
        "cut_off": Value::Object(lost.map(|g| (g.label.clone(), g.variable.lost().into())).collect()),
        "seconds": result.seconds,
    });
    root
}

/// The levels of multilevel Monte Carlo; null of other methods.
fn levels(result: &StochasticResult) -> Value {
    if result.levels.is_empty() {
        return Value::Null;
    }
    let of = |value: &dyn Fn(&Level) -> Value| -> Value { result.levels.iter().map(value).collect() };
    let varying = result.quantities.iter().enumerate().filter(|(_, q)| q.variance > 0.0);
    let parts = |(k, q): (usize, &Quantity)| (q.name.clone(), of(&|level| (level.variances[k] / q.variance).into()));
    let variances: Map<String, Value> = varying.map(parts).collect();
    object!({
        "cells": of(&|level| object!(level.cells)),
        "outcomes": of(&|level| level.outcomes.into()),
        "cost": of(&|level| level.cost.into()),
        "variances": variances,
    })
}

/// The word of a scene.
pub fn method(method: Sampling) -> &'static str {
    match method {
        Sampling::Galerkin => "galerkin",
        Sampling::Collocation => "collocation",
        Sampling::Sparse => "sparse",
        Sampling::Corrected => "corrected",
        Sampling::MonteCarlo => "monte-carlo",
        Sampling::Multilevel => "multilevel",
    }
}
