//! The stored and printed results of the study.
//!
//! ```text
//! /pairs/NNN      `name`, and columns with an entry per mesh
//! /pressure/NNN   `gamma`, `gamma_critical`, and columns with an entry per node of the multipliers
//! ```

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::pairs::{PAIRS, POINTS, Point};
use super::pressure::{Pressure, ROWS};
use super::{InfSup, Pressures};
use crate::report::{Part, Report, columns, list, named, number, part, told};
use crate::show;
use crate::table::Table;

/// The results of the study.
pub fn report<'a>(study: &'a InfSup<'_>) -> Report<'a> {
    let pair = |k| Table::new("mesh", study.of_pair(k), &POINTS);
    let failures = study.points.iter().filter_map(|p| {
        let why = p.failure.as_ref()?;
        Some(json!({ "pair": PAIRS[p.pair].name, "elements": p.elements, "degree": p.degree, "message": why }))
    });
    let names = study.points.iter().map(|p| format!("\"{}\"", PAIRS[p.pair].name));
    let pairs = Table::new("mesh", &study.points, &POINTS).key("pair", names);
    let all = &study.pressures;
    let gammas = all.solutions.iter().flat_map(|s| s.rows.iter().map(|_| format!("{:?}", s.gamma)));
    let nodes = all.solutions.iter().flat_map(|s| &s.rows);
    let pressures = Table::new("node of the multipliers", nodes, &ROWS).key("gamma", gammas);
    let solutions = || all.solutions.iter().map(solution).collect();
    let pressure = vec![told("elements", all.elements), told("degree", all.degree), list("solutions", solutions())];
    Report {
        content: "study: inf-sup constants",
        overrides: "settings of the study and of the user, KEY=VALUE",
        scene: study.scene,
        source: study.source,
        complete: study.complete(),
        interrupted: study.interrupted,
        parts: vec![
            told("note", study.note()),
            told("failures", failures.collect::<Value>()),
            named("pairs", PAIRS.iter().map(|p| p.name), "the multipliers", pair),
            part("pressure", pressure).only_told(),
            list("pressure", solutions()).only_kept(),
        ],
        tables: vec![("inf-sup.csv", pairs.csv()), ("pressure.csv", pressures.csv())],
        body: body(study),
    }
}

fn solution(s: &Pressure) -> Vec<Part> {
    vec![
        number("gamma", s.gamma, "1/stress", "gamma_0 of the stabilisation"),
        number("gamma_critical", s.critical, "1/stress", "its critical value on this mesh"),
        told("converged", s.converged),
        told("largest", s.largest()),
        told("variation", s.variation()),
        told("message", s.failure.clone()),
        columns("points", Table::new("node of the multipliers", &s.rows, &ROWS)),
    ]
}

fn body(study: &InfSup<'_>) -> String {
    let mut text = show::head(study.source, study.note());
    for (what, value) in [("without", (|p| p.plain) as fn(&Point) -> f64), ("with", |p| p.stabilised)] {
        let title = format!("beta {what} stabilisation");
        for degree in study.degrees() {
            let some = |p: &Point| p.degree == degree;
            if study.of_pair(0).filter(|p| some(p)).count() > 1 {
                let title = format!("{title}, p = {degree}");
                constants(&mut text, study, [&title, "elements"], &some, |p| p.elements.to_string(), value);
            }
        }
        let coarsest = study.coarsest();
        let end = format!("({coarsest} elements)");
        let some = |p: &Point| p.elements == coarsest;
        constants(&mut text, study, [&title, &end], &some, |p| format!("p = {}", p.degree), value);
    }
    for p in &study.points {
        if let Some(why) = &p.failure {
            let name = PAIRS[p.pair].name;
            let _ = writeln!(text, "FAILED: {name} on {} elements of degree {}: {why}", p.elements, p.degree);
        }
    }
    pressures(&mut text, &study.pressures);
    text
}

/// A line for each pair and a column for each mesh, for some of the points.
fn constants(
    text: &mut String,
    study: &InfSup<'_>,
    [title, end]: [&str; 2],
    some: &dyn Fn(&Point) -> bool,
    head: fn(&Point) -> String,
    value: fn(&Point) -> f64,
) {
    let row = |pair: usize| study.of_pair(pair).filter(|p| some(p));
    let heads: String = row(0).map(|p| format!(" {:>9}", head(p))).collect();
    let _ = writeln!(text, "\n{title:<36}{heads}  {end}");
    for (k, pair) in PAIRS.iter().enumerate() {
        let cells = row(k).map(|p| show::number(value(p), |v| format!("{v:.4}")));
        show::line(text, (&format!("  {}", pair.name), 36), cells);
    }
}

fn pressures(text: &mut String, all: &Pressures) {
    let _ = writeln!(text, "\npressure on {} elements, p = {}, multipliers on halved ones", all.elements, all.degree);
    for s in &all.solutions {
        if s.gamma.is_finite() {
            let _ = write!(text, "  gamma = {:.3e} ({:.0e} of the critical one): ", s.gamma, s.gamma / s.critical);
        }
        let lost = if s.converged { "" } else { " (the solver did not converge)" };
        let _ = match &s.failure {
            Some(why) => writeln!(text, "no solution: {why}"),
            None => writeln!(text, "largest {:.4e}, rises and falls {:.4e}{lost}", s.largest(), s.variation()),
        };
    }
}
