//! The study as text: CSV, the table on stdout, the JSON object.

use std::fmt::Write as _;

use serde_json::{Value, json as object};

use super::chance::{Measured, QUANTITIES, RULES};
use super::rules::{FAMILIES, MONTE_CARLO};
use super::solvers::{METHODS, Method, SOLVERS};
use super::space::{CURVES, POINTS, Point};
use super::{Chance, Solvers, Stochastic, columns};

/// Names and contents of the CSV tables; what is not known is left empty.
pub fn csv(study: &Stochastic<'_>) -> Vec<(&'static str, String)> {
    let chance = study.chance;
    let quoted = |name: &str| format!("\"{name}\"");
    let rules = chance
        .points
        .iter()
        .map(|m| format!("{},{}", quoted(FAMILIES[m.family].0), quoted(&chance.quantities[m.quantity].name)));
    let rules = prefixed("rule,quantity", rules, &columns::csv(&chance.points, &RULES));
    let curves = study.space.points.iter().map(|p| quoted(CURVES[p.curve].0));
    let space = prefixed("curve", curves, &columns::csv(&study.space.points, &POINTS));
    let mut tables = vec![("stochastic.csv", rules), ("space.csv", space)];
    if let Some(solvers) = study.solvers {
        let names = solvers.methods.iter().map(|m| quoted(SOLVERS[m.solver].0));
        tables.push(("solvers.csv", prefixed("solver", names, &columns::csv(&solvers.methods, &METHODS))));
    }
    tables
}

/// The table with columns more, the first.
fn prefixed(name: &str, cells: impl Iterator<Item = String>, table: &str) -> String {
    let cells = std::iter::once(name.to_owned()).chain(cells);
    table.lines().zip(cells).fold(String::new(), |text, (line, cell)| text + &cell + "," + line + "\n")
}

/// What is printed.
pub fn text(study: &Stochastic<'_>) -> String {
    let source = study.source;
    let mut text = format!("{}\n", study.scene.title);
    let _ = writeln!(text, "settings    {} (--set changes them)", source.overrides.join(", "));
    chance(&mut text, study.chance);
    space(&mut text, study);
    match study.solvers {
        Some(all) => solvers(&mut text, all),
        None => text += "\ncontact solvers: left out, no side is in contact\n",
    }
    for (what, why) in study.failures() {
        let _ = writeln!(text, "FAILED: {what}: {why}");
    }
    if study.interrupted {
        text += "interrupted: what was finished is here\n";
    }
    text
}

/// A number in a cell, or a dash for what is not known.
fn cell(value: f64, width: usize) -> String {
    if value.is_finite() { format!(" {value:>width$.1e}") } else { format!(" {:>width$}", "-") }
}

fn chance(text: &mut String, all: &Chance) {
    let _ = write!(text, "\nin chance   on a mesh of {} dofs", all.dofs);
    let _ = writeln!(text, ", estimated relative error {:.1e} in space", all.estimate);
    if all.quantities.is_empty() {
        return;
    }
    let _ = writeln!(text, "reference   {}, {} solves", all.reference, all.solves);
    let width = all.quantities.iter().map(|q| q.name.len()).fold(10, usize::max);
    for q in &all.quantities {
        let known = if q.varies() {
            format!(
                "variance {:.9e}, may be off by {:.0e} and {:.0e} of that",
                q.variance, q.uncertainty[0], q.uncertainty[1]
            )
        } else {
            "not random".into()
        };
        let _ = writeln!(text, "  {:<width$} mean {:.12e} {known}", q.name, q.mean);
    }
    if let Some(c) = &all.cost {
        let _ = writeln!(
            text,
            "costs       one deterministic solve {:.3} s; {} outcomes on its matrices {:.3} s, {} iterations{}",
            c.deterministic,
            c.solves,
            c.seconds,
            c.iterations,
            if c.unconverged > 0 { format!(", {} not converged", c.unconverged) } else { String::new() }
        );
    }
    let shown = all.shown();
    let heads: String = shown.iter().map(|&k| format!(" {:>19}", tail(&all.quantities[k].name, 19))).collect();
    let _ = writeln!(text, "\n{:<25} {:>16} {:>6}{heads} {:>10} {:>8}", "errors", "", "", "contact", "");
    let heads = format!(" {:>9} {:>9}", "mean", "variance").repeat(shown.len());
    let _ = writeln!(text, "{:<25} {:>16} {:>6}{heads} {:>10} {:>8}", "rule", "", "solves", "iterations", "seconds");
    for (family, (name, parameter)) in FAMILIES.iter().enumerate() {
        let mut name = *name;
        let Some(&first) = shown.first() else { continue };
        for (k, m) in all.of(family, first).enumerate() {
            let both = |q: usize| all.of(family, q).nth(k).map_or([f64::NAN; 2], |m| m.errors);
            let errors: String = shown.iter().flat_map(|&q| both(q)).map(|e| cell(e, 9)).collect();
            let counted = |v: f64, s: String| if v.is_finite() { s } else { "-".into() };
            let number = if m.parameter < 0.5 && m.parameter > 0.0 {
                format!("{:e}", m.parameter)
            } else {
                m.parameter.to_string()
            };
            let at = format!("{parameter} {number}");
            let iterations = counted(m.iterations, format!("{}", m.iterations));
            let seconds = counted(m.seconds, format!("{:.3}", m.seconds));
            let _ = writeln!(text, "{name:<25} {at:>16} {:>6}{errors} {iterations:>10} {seconds:>8}", m.solves);
            name = "";
        }
    }
    let last = |q: usize| all.of(MONTE_CARLO, q).last();
    for &q in &shown {
        if let Some(m) = last(q) {
            let times = m.errors[0] / m.standard_errors[0];
            let name = &all.quantities[q].name;
            let _ = writeln!(
                text,
                "Monte Carlo, {} samples: mean of {name} off by {times:.1} standard errors of {:.1e}",
                m.solves, m.standard_errors[0]
            );
        }
    }
}

/// The end of a text that is too long.
fn tail(text: &str, most: usize) -> String {
    let skipped = text.chars().count().saturating_sub(most);
    text.chars().skip(skipped).collect()
}

fn space(text: &mut String, study: &Stochastic<'_>) {
    let all = study.space;
    let Some(reference) = &all.reference else { return };
    let _ = writeln!(
        text,
        "\nin space    {} in chance; reference hp, {} dofs, estimated relative error {:.1e}",
        all.rule, reference.dofs, reference.estimate
    );
    let [energy, norm] = reference.means;
    let _ = writeln!(
        text,
        "            E[J] = {energy:.9e}, E[<u, Su>] = {norm:.9e}; they may be off by {:.0e} and {:.0e} of these",
        all.uncertainty[0], all.uncertainty[1]
    );
    let _ = writeln!(
        text,
        "\n{:<25} {:>6} {:>6} {:>7} {:>10} {:>12} {:>10} {:>9} {:>9}",
        "relative errors", "degree", "dofs", "E[J]", "E[<u,Su>]", "iterations", "solves", "one s", "all s"
    );
    for (curve, (name, ..)) in CURVES.iter().enumerate() {
        let mut name = *name;
        for p in all.of(curve) {
            let [j, norm] = p.errors;
            let _ = writeln!(
                text,
                "{name:<25} {:>6} {:>6}{}{} {:>12} {:>10} {:>9.3} {:>9.3}",
                p.degree,
                p.dofs,
                cell(j, 7),
                cell(norm, 10),
                p.iterations,
                p.solves,
                p.deterministic,
                p.seconds
            );
            name = "";
        }
        for (what, which) in [("E[J]", 0), ("E[<u,Su>]", 1)] {
            if let Some(fit) = all.law(curve, which) {
                let law = fit.law.with_rate(fit.rate);
                let _ = writeln!(text, "{:<25} error of {what} ~ {law} (R² = {:.4})", "", fit.r_squared);
            }
        }
    }
}

fn solvers(text: &mut String, all: &Solvers) {
    let _ = writeln!(
        text,
        "\ncontact solvers, nominal outcome, uniform meshes: iterations to 1e-10, seconds, worst measure"
    );
    let heads: String = SOLVERS.iter().map(|s| format!(" {:>28}", s.0)).collect();
    let _ = writeln!(text, "{:>8} {:>6} {:>11}{heads}", "elements", "dofs", "multipliers");
    for first in all.of(0) {
        let cells: String = (0..SOLVERS.len())
            .filter_map(|k| all.of(k).find(|m| m.elements == first.elements))
            .map(|m| match &m.failure {
                Some(_) => format!(" {:>28}", "failed"),
                None => {
                    let count = if m.iterations.is_finite() { m.iterations.to_string() } else { "-".into() };
                    format!(" {count:>8} {:>9.4}{}", m.seconds, cell(m.kkt, 9))
                }
            })
            .collect();
        let _ = writeln!(text, "{:>8} {:>6} {:>11}{cells}", first.elements, first.dofs, first.multipliers);
    }
    for (k, (name, _)) in SOLVERS.iter().enumerate() {
        let mut failed = all.of(k).filter_map(|m| m.failure.as_ref());
        if let Some(why) = failed.next() {
            let _ = writeln!(text, "{name}, no answer on {} meshes: {why}", 1 + failed.count());
        }
    }
}

/// The JSON object; numbers that are not known are null.
pub fn json(study: &Stochastic<'_>) -> Value {
    let chance = study.chance;
    let quantity = |(k, q): (usize, &super::Quantity)| {
        let family = |(f, (name, parameter)): (usize, &(&str, &str))| {
            let rows: Vec<Measured> = chance.of(f, k).copied().collect();
            object!({ "name": name, "parameter": parameter, "points": columns::json(&rows, &RULES) })
        };
        let mut one = columns::json(std::slice::from_ref(q), &QUANTITIES)[0].take();
        one["name"] = q.name.clone().into();
        one["random"] = q.varies().into();
        one["rules"] = FAMILIES.iter().enumerate().map(family).collect();
        one
    };
    let curve = |(k, (name, ..)): (usize, &(&str, steklov_problem::Refine, bool, crate::Law))| {
        let rows: Vec<Point> = study.space.of(k).copied().collect();
        object!({ "name": name, "points": columns::json(&rows, &POINTS) })
    };
    let solver = |solvers: &Solvers, k: usize| {
        let rows: Vec<Method> = solvers.of(k).cloned().collect();
        let failures =
            rows.iter().filter_map(|m| Some(object!({ "elements": m.elements, "message": m.failure.as_ref()? })));
        object!({
            "name": SOLVERS[k].0,
            "points": columns::json(&rows, &METHODS),
            "failures": failures.collect::<Value>(),
        })
    };
    let reference: Vec<Point> = study.space.reference.into_iter().collect();
    object!({
        "title": study.scene.title,
        "settings": study.source.overrides,
        "complete": study.complete(),
        "interrupted": study.interrupted,
        "failures": study.failures().map(|(at, why)| object!({ "at": at, "message": why })).collect::<Value>(),
        "chance": {
            "dofs": chance.dofs,
            "estimate": chance.estimate,
            "reference": chance.reference,
            "reference_solves": chance.solves,
            "quantities": chance.quantities.iter().enumerate().map(quantity).collect::<Value>(),
            "cost": chance.cost.map(|c| object!({
                "solves": c.solves, "iterations": c.iterations, "unconverged": c.unconverged,
                "seconds": c.seconds, "seconds_deterministic": c.deterministic,
            })),
        },
        "space": {
            "rule": study.space.rule,
            "uncertainty": study.space.uncertainty,
            "reference": columns::json(&reference, &POINTS).get(0),
            "curves": CURVES.iter().enumerate().map(curve).collect::<Value>(),
        },
        "solvers": study.solvers.map(|s| (0..SOLVERS.len()).map(|k| solver(s, k)).collect::<Value>()),
    })
}
