//! The statistics as tables and as lines of a summary.

use std::fmt::Write as _;

use steklov_model::quantities::Quantity as Bar;
use steklov_model::stochastic::{End, Quantity, StochasticResult};
use steklov_picture::plain;
use steklov_result::record::Record;

/// Percent of a field's variance that cells may lose without a word.
const LOST: f64 = 10.0;

/// Text of a CSV field.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// The tables of a stored result with random input: name and text of each. None without random input.
///
/// `quantities`: a row for each quantity; `points`: a row for each point with its germs, its weight, Young's modulus
/// and the quantities; `contact-statistics`: a row for each contact node. A value that a method does not give is empty.
pub fn tables(stored: &Record) -> Vec<(&'static str, String)> {
    let Some(result) = &stored.stochastic else { return Vec::new() };
    let mut tables = vec![("quantities", quantities(stored, result)), ("points", points(result))];
    if !stored.contact.is_empty() && result.levels.is_empty() {
        tables.push(("contact-statistics", contact(stored, result)));
    }
    tables
}

/// The error bar of the mean of a quantity, where it is known.
fn bar<'a>(stored: &'a Record, quantity: &Quantity) -> Option<&'a Bar> {
    stored.summary.quantities.get(&format!("stochastic.{}.mean", quantity.name))
}

/// The part of it that the mesh has, or a grid with its coarse cells.
fn of_mesh(bar: &Bar) -> f64 {
    bar.parts
        .iter()
        .filter(|(name, _)| !["sampling", "truncation"].contains(&name.as_str()))
        .map(|(_, part)| part)
        .sum()
}

fn quantities(stored: &Record, result: &StochasticResult) -> String {
    let mut text = String::from("name,mean,variance,standard_error");
    result.probabilities.iter().for_each(|p| text += &format!(",quantile_{p}"));
    text += ",truncation,mesh,uncertainty";
    let optional = |error: Option<f64>| error.map_or(String::new(), |e| format!("{e:?}"));
    for q in &result.quantities {
        let error = optional(q.standard_error);
        let _ = write!(text, "\n{},{:?},{:?},{error}", quoted(&q.name), q.mean, q.variance);
        for k in 0..result.probabilities.len() {
            text += &q.quantiles.as_ref().map_or(",".to_owned(), |values| format!(",{:?}", values[k]));
        }
        let bar = bar(stored, q);
        let all = [q.truncation, bar.map(of_mesh), bar.map(|bar| bar.uncertainty)];
        all.into_iter().for_each(|part| text += &format!(",{}", optional(part)));
    }
    text + "\n"
}

fn points(result: &StochasticResult) -> String {
    let mut head: Vec<String> = result.labels.iter().map(|l| quoted(l)).collect();
    head.extend(["weight".to_owned(), "young".to_owned()]);
    head.extend(result.quantities.iter().map(|q| quoted(&q.name)));
    let mut text = head.join(",") + "\n";
    for (i, germs) in result.points.iter().enumerate() {
        let values = result.quantities.iter().map(|q| q.values[i]);
        let row = germs.iter().copied().chain([result.weights[i], result.young[i]]).chain(values);
        text += &(row.map(|v| format!("{v:?}")).collect::<Vec<_>>().join(",") + "\n");
    }
    text
}

fn contact(stored: &Record, result: &StochasticResult) -> String {
    let mut text =
        String::from("side,x,y,pressure_mean,pressure_variance,shear_mean,shear_variance,probability_of_contact\n");
    for (i, row) in stored.contact.iter().enumerate() {
        let _ = write!(text, "{}", quoted(&stored.mesh.side_names[row.side]));
        let (pressure, shear) = (&result.pressure, &result.shear);
        let moments = [pressure.mean[i], pressure.variance[i], shear.mean[i], shear.variance[i]];
        for v in row.point.into_iter().chain(moments).chain([result.probability[i]]) {
            let _ = write!(text, ",{v:?}");
        }
        text.push('\n');
    }
    text
}

/// The word of the method in the JSON object, or an empty text.
pub(crate) fn method(stored: &Record) -> &str {
    let solution = stored.summary.stochastic.as_ref().and_then(|s| s.get("solution"));
    solution.and_then(|s| s.get("method")).and_then(|m| m.as_str()).unwrap_or_default()
}

/// The statistics for a reader: the method with its size and its truncation, then a line for each quantity.
pub fn lines(stored: &Record) -> Vec<String> {
    let Some(result) = &stored.stochastic else { return Vec::new() };
    let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    let mut head = format!(
        "outcomes    {}{}: {}, {}, {}",
        method(stored),
        if result.coupled { ", coupled nodes" } else { "" },
        count(result.labels.len(), "germ"),
        count(result.points.len(), "point"),
        count(result.solved, "solve"),
    );
    if let Some(cells) = &result.cells {
        let _ = write!(head, ", {}", count(cells.degree.len(), "cell"));
    }
    if let Some(truncation) = result.truncation {
        let _ = write!(head, ", truncation {} estimated, relative", plain(truncation, 2));
    }
    if let Some(measured) = result.truncation_measured {
        let _ = write!(head, ", {} measured by {}", plain(measured, 2), count(result.checks, "outcome"));
    }
    let mut lines = vec![head];
    lines.extend(shortfall(result).map(|text| format!("            {text}")));
    lines.extend(overlooked(result).map(|text| format!("            {text}")));
    if result.unconverged > 0 {
        lines.push(format!("            {} NOT CONVERGED", count(result.unconverged, "point")));
    }
    for (l, level) in result.levels.iter().enumerate() {
        let [nx, ny] = level.cells;
        let what = if l == 0 { "values" } else { "differences from the coarser grid" };
        lines.push(format!("            {nx} by {ny} cells: {} of {what}", count(level.outcomes, "outcome")));
    }
    if let Some((kept, left_out)) = &result.kept {
        let (own, all) = (kept.len(), count(result.labels.len(), "germ"));
        let share = plain(100.0 * left_out, 2);
        lines.push(format!(
            "            polynomials in {own} of {all}; the others make {share} % of the linear variance"
        ));
    }
    for field in &result.fields {
        let (modes, share) = (count(field.eigenvalues.len(), "mode"), 100.0 * field.captured);
        let lost = match 100.0 * field.unresolved {
            lost if lost > LOST => format!("; means over its cells lose {lost:.0} %: take smaller cells"),
            _ => String::new(),
        };
        lines.push(format!("            field {}: {modes} with {share:.4} % of its variance{lost}", field.name));
    }
    for q in &result.quantities {
        let mut line = format!("            {}: {}", q.name, plain(q.mean, 7));
        if let Some([low, high]) = q.bounds_left {
            let _ = write!(line, " NOT RESOLVED: out of {low} to {high}, which it cannot leave, by this rule");
        }
        line += &match q.variance {
            _ if is_constant(stored, q) => ", constant but for rounding".to_owned(),
            v if v.is_nan() => ", variance NOT RESOLVED: negative by this rule".to_owned(),
            v => format!(" ± {}", plain(v.max(0.0).sqrt(), 3)),
        };
        if let Some(error) = q.standard_error {
            let _ = write!(line, ", standard error of the mean {}", plain(error, 2));
        }
        if let Some(truncation) = q.truncation {
            let _ = write!(line, ", truncation {}", plain(truncation, 2));
        }
        if let Some(bar) = bar(stored, q) {
            let _ = write!(line, ", mesh {}, mean within {}", plain(of_mesh(bar), 2), plain(bar.uncertainty, 2));
        }
        for (k, (p, value)) in result.probabilities.iter().zip(q.quantiles.iter().flatten()).enumerate() {
            let _ = write!(line, "{} {} % {}", if k == 0 { "; quantiles" } else { "," }, percent(*p), plain(*value, 7));
        }
        lines.push(line);
    }
    let unknown = result.probability.iter().filter(|p| p.is_nan()).count();
    if unknown > 0 {
        let nodes = count(unknown, "contact node");
        lines.push(format!("            probability of contact NOT RESOLVED at {nodes}: out of [0, 1] by this rule"));
    }
    lines
}

/// Whether the spread of a quantity is only rounding: then its quantiles are removed. Sparse grids and families of grids have
/// none at all.
pub(crate) fn is_constant(stored: &Record, quantity: &Quantity) -> bool {
    quantity.quantiles.is_none() && !["sparse", "corrected", "multilevel"].contains(&method(stored))
}

/// The warning if the truncation has not reached the tolerance.
pub fn shortfall(result: &StochasticResult) -> Option<String> {
    let help = match result.end {
        End::MaxNodes => "raise stochastic.max_nodes or stochastic.tolerance",
        End::Rounds => "raise stochastic.tolerance",
        End::Solved | End::Tolerance => return None,
    };
    let told = match (result.truncation, result.end) {
        (Some(truncation), end) => format!("truncation {truncation:.1e} after {}: {help}", end.word()),
        (None, End::Rounds) => {
            "outcomes that no sample has seen may move means by more than their standard errors: lower it".to_owned()
        }
        (None, _) => format!("standard errors are above stochastic.tolerance times the deviations: {help}"),
    };
    Some(format!("stochastic tolerance NOT REACHED: {told}"))
}

/// The warning if outcomes show, or may show, changes that the points miss.
pub fn overlooked(result: &StochasticResult) -> Option<String> {
    const HELP: &str = "refine = \"adaptive\", a higher degree, more elements or samples";
    match result.unseen {
        _ if result.overlooked => {
            Some(format!("outcomes NOT RESOLVED: contact, slip or data change where no point is: {HELP}"))
        }
        Some(unseen) => Some(format!(
            "outcomes NOT RESOLVED: other contact or data in less than {:.1e} % of them cannot be excluded: {HELP}",
            100.0 * unseen
        )),
        None => None,
    }
}

/// A probability in per cent, rounded so that rounding errors vanish.
pub(crate) fn percent(p: f64) -> f64 {
    (1e10 * p).round() / 1e8
}
