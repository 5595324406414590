//! Error bars of means over outcomes of random input, in three parts:
//!
//! ```text
//! uncertainty = mesh + truncation + sampling,      sampling = 2 (standard error)
//! ```
//! `mesh` is the bar of the quantity in the mean over a few outcomes, see [`crate::bars`]: of boundary elements J₊ - J_h with its sign and
//! the dual weighted residuals are averaged; on a grid the bars themselves, with `fine_grid` and `multiscale` for `mesh`. `truncation` is what
//! polynomials of the germs, or the samples taken, do not see. What the modes of a random field leave out of it is in none of them.

use std::collections::BTreeMap;

use super::result::{Quantity as OfOutcomes, StochasticResult};
use crate::quantities::{Quantities, Quantity};

/// Standard errors within which a mean of samples is told.
const STANDARD_ERRORS: f64 = 2.0;

/// Rounding errors of a mean.
const ROUNDED: f64 = 1e-11;

/// The means of the quantities whose bars for the mesh alone are known, by their paths in the JSON object.
pub(crate) fn with_bars(result: &StochasticResult, of_mesh: &Quantities) -> Quantities {
    let told = |quantity: &OfOutcomes| {
        let known = of_mesh.get(&source(&quantity.name)?).filter(|_| quantity.mean.is_finite())?;
        Some((format!("stochastic.{}.mean", quantity.name), of_mean(quantity, known)))
    };
    result.quantities.iter().filter_map(told).collect()
}

fn of_mean(quantity: &OfOutcomes, of_mesh: &Quantity) -> Quantity {
    let mut parts = BTreeMap::from([
        ("sampling".to_owned(), STANDARD_ERRORS * quantity.standard_error.unwrap_or(0.0)),
        ("truncation".to_owned(), quantity.truncation.unwrap_or(0.0)),
    ]);
    match of_mesh.parts.is_empty() {
        true => drop(parts.insert("mesh".to_owned(), of_mesh.uncertainty)),
        false => parts.extend(of_mesh.parts.clone()),
    }
    // sums of outcomes are rounded
    for name in ["mesh", "fine_grid"] {
        parts.entry(name.to_owned()).and_modify(|part| *part = part.max(ROUNDED * quantity.mean.abs()));
    }
    Quantity { value: quantity.mean, uncertainty: parts.values().sum(), doubts: of_mesh.doubts.clone(), parts }
}

/// The path of the number with an error bar that a number of outcomes is.
fn source(path: &str) -> Option<String> {
    let parts: Vec<&str> = path.split('.').collect();
    let of_vector = |k: &str| if matches!(k, "0" | "x") { "x" } else { "y" };
    Some(match parts[..] {
        ["contact", "force", k] => format!("contact.force.{}", of_vector(k)),
        // of outcomes these are numbers of nodes
        ["interfaces", _, "max_pressure" | "length" | "stick" | "slip"] => return None,
        ["reactions", ref side @ .., k] => format!("reactions.{}.{}", side.join("."), of_vector(k)),
        ["probe", point, "displacement", k] => format!("probe.{point}.displacement.{}", of_vector(k)),
        ["probe", point, "stress", k] => {
            let k = match k {
                "0" | "xx" => "xx",
                "1" | "yy" => "yy",
                _ => "xy",
            };
            format!("probe.{point}.stress.{k}")
        }
        _ => path.to_owned(),
    })
}
