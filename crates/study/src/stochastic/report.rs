//! The stored and printed results of the study.
//!
//! ```text
//! /chance              `quantities` (names), `reference`; columns with an entry per quantity
//!   /QQQ/RRR           `rule`; columns of quantity QQQ with an entry per rule of family RRR
//! /space/NNN           `name`; columns with an entry per mesh
//! /solvers/NNN         `name`; columns with an entry per mesh; `history`: the measure by iteration on the finest mesh
//! ```

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::chance::{Measured, QUANTITIES, RULES};
use super::rules::{FAMILIES, Family, MONTE_CARLO};
use super::space::{CURVES, POINTS, Point};
use super::{Chance, Quantity, Space, Stochastic};
use crate::report::{Part, Report, columns, failures, list, named, part, text, texts, told};
use crate::show::{self, Shown, heads};
use crate::solvers::{self, METHODS, SOLVERS};
use crate::table::Table;

/// The results of the study.
pub fn report<'a>(study: &'a Stochastic<'_>) -> Report<'a> {
    let quoted = |name: &str| format!("\"{name}\"");
    let (chance, space) = (&study.chance, &study.space);
    let of =
        |m: &Measured| format!("{},{}", quoted(FAMILIES[m.family].name), quoted(&chance.quantities[m.quantity].name));
    let rules = Table::new("rule", &chance.points, &RULES).key("rule,quantity", chance.points.iter().map(of));
    let curves = space.points.iter().map(|p| quoted(CURVES[p.curve].0));
    let meshes = Table::new("mesh", &space.points, &POINTS).key("curve", curves);
    let mut tables = vec![("stochastic.csv", rules.csv())];
    if !study.scene.is_on_grid() {
        tables.push(("space.csv", meshes.csv()));
    }
    let solvers = study.solvers.as_ref().map(|all| {
        let names = all.methods.iter().map(|m| quoted(SOLVERS[m.solver].0));
        tables.push(("solvers.csv", Table::new("mesh", &all.methods, &METHODS).key("solver", names).csv()));
        list("solvers", (0..SOLVERS.len()).map(|k| solvers::parts(all, k)).collect())
    });
    let [told_chance, kept_chance] = chance_parts(chance);
    let curve = |k| Table::new("mesh", space.of(k), &POINTS);
    let curves = |at| named(at, CURVES.iter().map(|c| c.0), "strategy in space and rule in chance", curve);
    let told_space = vec![
        told("rule", space.rule.clone()),
        told("uncertainty", space.uncertainty.to_vec()),
        told("reference", Table::new("mesh", &space.reference, &POINTS).json().get(0).cloned()),
        curves("curves"),
    ];
    Report {
        content: "study: random input",
        overrides: "settings of the study and of the user, KEY=VALUE",
        scene: study.scene,
        source: study.source,
        complete: study.complete(),
        interrupted: study.interrupted,
        parts: vec![
            failures(study.failures()),
            part("chance", told_chance).only_told(),
            part("chance", kept_chance).only_kept(),
            part("space", told_space).only_told(),
            curves("space").only_kept(),
            solvers.unwrap_or_else(|| told("solvers", Value::Null)),
        ],
        tables,
        body: body(study),
    }
}

/// The errors in chance in the JSON object and the file.
fn chance_parts(chance: &Chance) -> [Vec<Part>; 2] {
    let rules = |family: usize, quantity: usize| Table::new("rule", chance.of(family, quantity), &RULES);
    let quantity = |(k, q): (usize, &Quantity)| {
        let family = |(f, Family { name, parameter, .. }): (usize, &Family)| {
            let points = rules(f, k).json();
            json!({ "name": name, "parameter": parameter, "points": points })
        };
        let mut one = Table::new("quantity", [q], &QUANTITIES).json()[0].take();
        one["name"] = q.name.clone().into();
        one["random"] = q.varies().into();
        one["rules"] = FAMILIES.iter().enumerate().map(family).collect();
        one
    };
    let cost = chance.cost.map(|c| {
        json!({
            "solves": c.solves, "iterations": c.iterations, "unconverged": c.unconverged,
            "seconds": c.seconds, "seconds_deterministic": c.deterministic,
        })
    });
    let told = vec![
        told("dofs", chance.dofs),
        told("estimate", chance.estimate),
        told("reference", chance.reference.clone()),
        told("reference_solves", chance.solves),
        told("quantities", chance.quantities.iter().enumerate().map(quantity).collect::<Value>()),
        told("cost", cost),
    ];
    let names = chance.quantities.iter().map(|q| q.name.clone()).collect();
    let mut kept = vec![
        texts("quantities", names, "paths of the JSON object", "quantity"),
        text("reference", &chance.reference, "the rule that errors are measured against"),
        columns("", Table::new("quantity", &chance.quantities, &QUANTITIES)),
    ];
    kept.extend((0..chance.quantities.len()).map(|k| {
        let family = |(f, Family { name, .. }): (usize, &Family)| {
            vec![text("rule", name, "the family of rules"), columns("points", rules(f, k))]
        };
        list(&format!("{k:03}"), FAMILIES.iter().enumerate().map(family).collect())
    }));
    [told, kept]
}

fn body(study: &Stochastic<'_>) -> String {
    let mut text = show::head(study.source, None);
    chance(&mut text, &study.chance);
    if let Some(reference) = &study.space.reference {
        space(&mut text, &study.space, reference);
    }
    match &study.solvers {
        Some(all) => solvers::table(&mut text, ", nominal outcome", all),
        None if study.scene.is_on_grid() => {
            text += "\nerrors in space and contact solvers: of boundary elements alone\n"
        }
        None => text += "\ncontact solvers: left out, no side is in contact\n",
    }
    for (what, why) in study.failures() {
        let _ = writeln!(text, "FAILED: {what}: {why}");
    }
    text
}

/// A small number.
fn cell(value: f64) -> String {
    show::number(value, |v| format!("{v:.1e}"))
}

fn chance(text: &mut String, all: &Chance) {
    let _ = write!(text, "\nin chance   on a mesh of {} dofs", all.dofs);
    if all.estimate.is_finite() {
        let _ = write!(text, ", estimated relative error {:.1e} in space", all.estimate);
    }
    text.push('\n');
    if all.quantities.is_empty() {
        return;
    }
    let _ = writeln!(text, "reference   {}, {} solves", all.reference, all.solves);
    let width = all.quantities.iter().map(|q| q.name.len()).fold(10, usize::max);
    for q in &all.quantities {
        let [mean, variance] = [0, 1].map(|k| q.uncertainty[k] * q.scale[k]);
        let known = if q.varies() {
            format!("± {mean:.0e}, variance {:.9e} ± {variance:.0e}", q.variance)
        } else {
            "not random".into()
        };
        let _ = writeln!(text, "  {:<width$} mean {:.12e} {known}", q.name, q.mean);
    }
    if let Some(c) = &all.cost {
        let lost = if c.unconverged > 0 { format!(", {} not converged", c.unconverged) } else { String::new() };
        let _ = writeln!(
            text,
            "costs       one deterministic solve {:.3} s; {} outcomes on its matrices {:.3} s, {} iterations{lost}",
            c.deterministic, c.solves, c.seconds, c.iterations,
        );
    }
    rules(text, all);
    let shown = all.shown();
    for (q, m) in shown.iter().filter_map(|&q| Some((q, all.of(MONTE_CARLO, q).last()?))) {
        let times = m.errors[0] / m.standard_errors[0];
        let name = &all.quantities[q].name;
        let _ = writeln!(
            text,
            "Monte Carlo, {} samples: mean of {name} off by {times:.1} standard errors of {:.1e}",
            m.solves, m.standard_errors[0]
        );
    }
}

/// Errors of the shown quantities, rule by rule.
fn rules(text: &mut String, all: &Chance) {
    let shown = all.shown();
    let heads: String = shown.iter().map(|&k| format!(" {:>19}", tail(&all.quantities[k].name, 19))).collect();
    let _ = writeln!(
        text,
        "\nerrors of means over the root mean square, of variances over the variance; of a component over those of its vector"
    );
    let _ = writeln!(text, "{:<25} {:>16} {:>6}{heads} {:>10} {:>8}", "", "", "", "contact", "");
    let heads = format!(" {:>9} {:>9}", "mean", "variance").repeat(shown.len());
    let _ = writeln!(text, "{:<25} {:>16} {:>6}{heads} {:>10} {:>8}", "rule", "", "solves", "iterations", "seconds");
    let Some(&first) = shown.first() else { return };
    for (family, Family { name, parameter, .. }) in FAMILIES.iter().enumerate() {
        let mut name = *name;
        for (k, m) in all.of(family, first).enumerate() {
            let both = |q: usize| all.of(family, q).nth(k).map_or([f64::NAN; 2], |m| m.errors);
            let errors: String = shown.iter().flat_map(|&q| both(q)).map(|e| format!(" {:>9}", cell(e))).collect();
            let tolerance = m.parameter < 0.5 && m.parameter > 0.0;
            let number = if tolerance { format!("{:e}", m.parameter) } else { m.parameter.to_string() };
            let at = format!("{parameter} {number}");
            let iterations = show::number(m.iterations, |v| v.to_string());
            let seconds = show::number(m.seconds, |v| format!("{v:.3}"));
            let _ = writeln!(text, "{name:<25} {at:>16} {:>6}{errors} {iterations:>10} {seconds:>8}", m.solves);
            name = "";
        }
    }
}

/// The last `most` characters of a text.
fn tail(text: &str, most: usize) -> String {
    let skipped = text.chars().count().saturating_sub(most);
    text.chars().skip(skipped).collect()
}

fn space(text: &mut String, all: &Space, reference: &Point) {
    let shown: [Shown<Point>; 8] = [
        ("degree", 6, |p| p.degree.to_string()),
        ("dofs", 6, |p| p.dofs.to_string()),
        ("E[J]", 7, |p| cell(p.errors[0])),
        ("E[<u,Su>]", 10, |p| cell(p.errors[1])),
        ("iterations", 12, |p| p.iterations.to_string()),
        ("solves", 10, |p| p.solves.to_string()),
        ("one s", 9, |p| format!("{:.3}", p.deterministic)),
        ("all s", 9, |p| format!("{:.3}", p.seconds)),
    ];
    let _ = writeln!(
        text,
        "\nin space    {} in chance; reference hp, {} dofs, estimated relative error {:.1e}",
        all.rule, reference.dofs, reference.estimate
    );
    let [energy, norm] = reference.means;
    let _ = writeln!(
        text,
        "            E[J] = {energy:.9e}, E[<u, Su>] = {norm:.9e}; they may be off by {:.0e} and {:.0e} of these\n",
        all.uncertainty[0], all.uncertainty[1]
    );
    heads(text, ("relative errors", 25), &shown);
    for (curve, (name, ..)) in CURVES.iter().enumerate() {
        show::rows(text, (name, 25), &shown, all.of(curve));
        for (what, which) in [("E[J]", 0), ("E[<u,Su>]", 1)] {
            if let Some(fit) = all.law(curve, which) {
                let law = fit.law.with_rate(fit.rate);
                let _ = writeln!(text, "{:<25} error of {what} ~ {law} (R² = {:.4})", "", fit.r_squared);
            }
        }
    }
}
