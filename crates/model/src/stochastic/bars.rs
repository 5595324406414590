//! Error bars of means over outcomes of random input, in three parts:
//!
//! ```text
//! uncertainty = mesh + truncation + sampling,      sampling = 2 (standard error)
//! ```
//! `mesh` is the bar of the quantity in the mean over a few outcomes, see [`crate::bars`]: of boundary elements J₊ - J_h with its sign and
//! the dual weighted residuals are averaged; on a grid the bars themselves, with `fine_grid` and `multiscale` for `mesh`. `truncation` is what
//! polynomials of the germs, or the samples taken, do not see. What the modes of a random field leave out of it is in none of them.

use std::collections::BTreeMap;

use steklov_problem::Scene;

use super::result::{Quantity as OfOutcomes, StochasticResult};
use crate::quantities::{Quantities, Quantity};

/// Standard errors within which a mean of samples is told.
const STANDARD_ERRORS: f64 = 2.0;

/// Rounding errors of a mean.
const ROUNDED: f64 = 1e-11;

/// The means of the quantities whose bars for the mesh alone are known, by their paths in the JSON object.
pub(crate) fn with_bars(scene: &Scene, result: &StochasticResult, of_mesh: &Quantities) -> Quantities {
    let told = |quantity: &OfOutcomes| {
        let parts: Option<Vec<&Quantity>> =
            sources(scene, &quantity.name).iter().map(|path| of_mesh.get(path)).collect();
        let known = parts.filter(|parts| !parts.is_empty() && quantity.mean.is_finite())?;
        Some((format!("stochastic.{}.mean", quantity.name), of_mean(quantity, &known)))
    };
    result.quantities.iter().filter_map(told).collect()
}

fn of_mean(quantity: &OfOutcomes, of_mesh: &[&Quantity]) -> Quantity {
    let mut doubts: Vec<String> = of_mesh.iter().flat_map(|quantity| quantity.doubts.clone()).collect();
    doubts.sort();
    doubts.dedup();
    let mut parts = BTreeMap::from([
        ("sampling".to_owned(), STANDARD_ERRORS * quantity.standard_error.unwrap_or(0.0)),
        ("truncation".to_owned(), quantity.truncation.unwrap_or(0.0)),
    ]);
    for own in of_mesh {
        let whole = BTreeMap::from([("mesh".to_owned(), own.uncertainty)]);
        let of_mesh = if own.parts.is_empty() { &whole } else { &own.parts };
        of_mesh.iter().for_each(|(name, part)| *parts.entry(name.clone()).or_default() += part);
    }
    // sums of outcomes are rounded
    for name in ["mesh", "fine_grid"] {
        parts.entry(name.to_owned()).and_modify(|part| *part = part.max(ROUNDED * quantity.mean.abs()));
    }
    Quantity { value: quantity.mean, uncertainty: parts.values().sum(), doubts, parts }
}

/// The paths of the numbers with error bars whose sum a number of outcomes is.
fn sources(scene: &Scene, path: &str) -> Vec<String> {
    let parts: Vec<&str> = path.split('.').collect();
    let of_vector = |k: &str| if matches!(k, "0" | "x") { "x" } else { "y" };
    match parts[..] {
        ["contact", "force", k] => {
            let sides = scene.contacts().map(|(side, _)| &scene.problem.sides[side].name);
            sides.map(|name| format!("reactions.{name}.{}", of_vector(k))).collect()
        }
        // of outcomes these are numbers of nodes
        ["contact", "max_pressure" | "length"] => Vec::new(),
        ["reactions", ref side @ .., k] => vec![format!("reactions.{}.{}", side.join("."), of_vector(k))],
        ["probe", point, "displacement", k] => vec![format!("probe.{point}.displacement.{}", of_vector(k))],
        ["probe", point, "stress", k] => {
            let k = match k {
                "0" | "xx" => "xx",
                "1" | "yy" => "yy",
                _ => "xy",
            };
            vec![format!("probe.{point}.stress.{k}")]
        }
        _ => vec![path.to_owned()],
    }
}
