//! The stored and printed results of the study.
//!
//! ```text
//! /solvers/NNN   `name`; columns with an entry per mesh; `history`: the measure by iteration on the finest mesh
//! /newton        columns with an entry per iterate of the semi-smooth Newton method
//! ```

use std::fmt::Write as _;

use serde_json::{Value, json};
use steklov_io::Label;

use super::compare::{METHODS, Method, SOLVERS};
use super::newton::{ITERATES, Iterate};
use super::{ContactSolvers, Newton, Solvers};
use crate::report::{Part, Report, columns, list, rows, text, told, vector};
use crate::show;
use crate::table::Table;

/// The results of the study.
pub fn report<'a>(study: &'a ContactSolvers<'_>) -> Report<'a> {
    let iterates = || Table::new("iterate", study.newton.iter().flat_map(|n| &n.iterates), &ITERATES);
    let names = study.solvers.methods.iter().map(|m| format!("\"{}\"", SOLVERS[m.solver].0));
    let methods = Table::new("mesh", &study.solvers.methods, &METHODS).key("solver", names);
    Report {
        content: "study: contact solvers",
        overrides: "settings of the study and of the user, KEY=VALUE",
        scene: study.scene,
        source: study.source,
        complete: study.complete(),
        interrupted: study.interrupted,
        parts: vec![
            list("solvers", (0..SOLVERS.len()).map(|k| parts(&study.solvers, k)).collect()),
            rows("newton", iterates()),
            told("newton_failures", study.newton.iter().filter_map(failure).collect::<Value>()),
        ],
        tables: vec![("solvers.csv", methods.csv()), ("newton.csv", iterates().csv())],
        body: body(study),
    }
}

fn failure(newton: &Newton) -> Option<Value> {
    Some(json!({ "elements": newton.elements, "message": newton.failure.as_ref()? }))
}

/// A solver: its numbers mesh by mesh, its failures, its measure by iteration.
pub(crate) fn parts(solvers: &Solvers, k: usize) -> Vec<Part> {
    let failures =
        solvers.of(k).filter_map(|m| Some(json!({ "elements": m.elements, "message": m.failure.as_ref()? })));
    let history = solvers.finest().find(|m| m.solver == k).map_or(&[][..], |m| &m.history);
    let meaning = "the solver's own relative measure on the finest mesh";
    vec![
        text("name", SOLVERS[k].0, "the solver"),
        columns("points", Table::new("mesh", solvers.of(k), &METHODS)),
        told("failures", failures.collect::<Value>()),
        vector("history", history, Label { unit: "1", meaning, axes: &["iteration"] }).only_kept(),
    ]
}

fn body(study: &ContactSolvers<'_>) -> String {
    let mut text = show::head(study.source, None);
    table(&mut text, "", &study.solvers);
    let _ = writeln!(
        text,
        "\nsemi-smooth Newton: error of each iterate (energy norm, relative), and below it over the one before"
    );
    for Newton { elements, iterates, failure } in &study.newton {
        let cells = |value: fn(&Iterate) -> f64| -> String {
            iterates.iter().map(|i| format!(" {:>8}", cell(value(i)))).collect()
        };
        let _ = writeln!(text, "{elements:>8} {}", cells(|i| i.error));
        let _ = writeln!(text, "{:>8} {:>8}{}", "", "", cells(|i| i.ratio).trim_end());
        if let Some(why) = failure {
            let _ = writeln!(text, "{:>8}  not to the end: {why}", "");
        }
    }
    text
}

/// A small number.
fn cell(value: f64) -> String {
    show::number(value, |v| format!("{v:.1e}"))
}

/// Iterations, seconds and measures of all solvers, mesh by mesh; `of` names the solution.
pub(crate) fn table(text: &mut String, of: &str, all: &Solvers) {
    let _ = writeln!(text, "\ncontact solvers{of}, uniform meshes: iterations to 1e-10, seconds, worst measure");
    let heads: String = SOLVERS.iter().map(|s| format!(" {:>28}", s.0)).collect();
    let _ = writeln!(text, "{:>8} {:>6} {:>11}{heads}", "elements", "dofs", "multipliers");
    for first in all.of(0) {
        let on_mesh = (0..SOLVERS.len()).filter_map(|k| all.of(k).find(|m| m.elements == first.elements));
        let cell = |m: &Method| match &m.failure {
            Some(_) => format!(" {:>28}", "failed"),
            None => {
                let count = show::number(m.iterations, |v| v.to_string());
                format!(" {count:>8} {:>9.4} {:>9}", m.seconds, cell(m.kkt))
            }
        };
        let cells: String = on_mesh.map(cell).collect();
        let _ = writeln!(text, "{:>8} {:>6} {:>11}{cells}", first.elements, first.dofs, first.multipliers);
    }
    for (k, (name, _)) in SOLVERS.iter().enumerate() {
        let mut failed = all.of(k).filter_map(|m| m.failure.as_ref());
        if let Some(why) = failed.next() {
            let _ = writeln!(text, "{name}, no answer on {} meshes: {why}", 1 + failed.count());
        }
    }
}
