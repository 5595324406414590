//! The study as text: CSV, the table on stdout, the JSON object.

use std::fmt::Write as _;

use serde_json::{Value, json as object};

use super::pairs::{PAIRS, POINTS, Point};
use super::pressure::{Pressure, ROWS};
use super::{InfSup, columns};

/// Names and contents of the CSV tables; what is not known is left empty.
pub fn csv(study: &InfSup<'_>) -> [(&'static str, String); 2] {
    let table = columns::csv(study.points, &POINTS);
    let names = study.points.iter().map(|p| format!("\"{}\"", PAIRS[p.pair].name));
    let pairs = prefixed("pair", names, &table);
    let solutions = &study.pressures.solutions;
    let rows: Vec<_> = solutions.iter().flat_map(|s| s.rows.iter().copied()).collect();
    let gammas = solutions.iter().flat_map(|s| s.rows.iter().map(|_| format!("{:?}", s.gamma)));
    [("inf-sup.csv", pairs), ("pressure.csv", prefixed("gamma", gammas, &columns::csv(&rows, &ROWS)))]
}

/// The table with a column more, the first.
fn prefixed(name: &str, cells: impl Iterator<Item = String>, table: &str) -> String {
    let cells = std::iter::once(name.to_owned()).chain(cells);
    table.lines().zip(cells).fold(String::new(), |text, (line, cell)| text + &cell + "," + line + "\n")
}

/// What is printed.
pub fn text(study: &InfSup<'_>) -> String {
    let mut text = format!("{}\n", study.scene.title);
    let _ = writeln!(text, "settings    {} (--set changes them)", study.source.overrides.join(", "));
    if let Some(note) = study.note() {
        let _ = writeln!(text, "note        {note}");
    }
    for (what, value) in [("without", (|p| p.plain) as fn(&Point) -> f64), ("with", |p| p.stabilised)] {
        for degree in study.degrees() {
            let row = |pair: usize| study.of_pair(pair).filter(move |p| p.degree == degree);
            let heads: String = row(0).map(|p| format!(" {:>9}", p.elements)).collect();
            if row(0).count() > 1 {
                let title = format!("beta {what} stabilisation, p = {degree}");
                let _ = writeln!(text, "\n{title:<36}{heads}  elements");
                for (k, pair) in PAIRS.iter().enumerate() {
                    line(&mut text, pair.name, row(k).map(value));
                }
            }
        }
        let coarsest = study.coarsest();
        let row = |pair: usize| study.of_pair(pair).filter(move |p| p.elements == coarsest);
        let heads: String = row(0).map(|p| format!(" {:>9}", format!("p = {}", p.degree))).collect();
        let title = format!("beta {what} stabilisation");
        let _ = writeln!(text, "\n{title:<36}{heads}  ({coarsest} elements)");
        for (k, pair) in PAIRS.iter().enumerate() {
            line(&mut text, pair.name, row(k).map(value));
        }
    }
    for p in study.points {
        if let Some(why) = &p.failure {
            let name = PAIRS[p.pair].name;
            let _ = writeln!(text, "FAILED: {name} on {} elements of degree {}: {why}", p.elements, p.degree);
        }
    }
    pressures(&mut text, study);
    if study.interrupted {
        text += "interrupted: what was finished is here\n";
    }
    text
}

/// A line with a name and a number a mesh; a dash for what is not known.
fn line(text: &mut String, name: &str, values: impl Iterator<Item = f64>) {
    let cells = values.map(|v| if v.is_finite() { format!(" {v:>9.4}") } else { format!(" {:>9}", "-") });
    let _ = writeln!(text, "  {name:<34}{}", cells.collect::<String>());
}

fn pressures(text: &mut String, study: &InfSup<'_>) {
    let all = study.pressures;
    let _ = writeln!(text, "\npressure on {} elements, p = {}, multipliers on halved ones", all.elements, all.degree);
    for s in &all.solutions {
        if s.gamma.is_finite() {
            let _ = write!(text, "  gamma = {:.3e} ({:.0e} of the critical one): ", s.gamma, s.gamma / s.critical);
        }
        let _ = match &s.failure {
            Some(why) => writeln!(text, "no solution: {why}"),
            None => writeln!(
                text,
                "largest {:.4e}, rises and falls {:.4e}{}",
                s.largest(),
                s.variation(),
                if s.converged { "" } else { " (the solver did not converge)" }
            ),
        };
    }
}

/// The JSON object; numbers that are not known are null.
pub fn json(study: &InfSup<'_>) -> Value {
    let pairs = PAIRS.iter().enumerate().map(|(k, pair)| {
        let points: Vec<Point> = study.of_pair(k).cloned().collect();
        object!({ "name": pair.name, "points": columns::json(&points, &POINTS) })
    });
    let failures = study.points.iter().filter_map(|p| {
        let why = p.failure.as_ref()?;
        Some(object!({ "pair": PAIRS[p.pair].name, "elements": p.elements, "degree": p.degree, "message": why }))
    });
    let solution = |s: &Pressure| {
        object!({
            "gamma": s.gamma,
            "gamma_critical": s.critical,
            "converged": s.converged,
            "largest": s.largest(),
            "variation": s.variation(),
            "message": s.failure,
            "points": columns::json(&s.rows, &ROWS),
        })
    };
    object!({
        "title": study.scene.title,
        "settings": study.source.overrides,
        "complete": study.complete(),
        "interrupted": study.interrupted,
        "note": study.note(),
        "pairs": pairs.collect::<Value>(),
        "failures": failures.collect::<Value>(),
        "pressure": {
            "elements": study.pressures.elements,
            "degree": study.pressures.degree,
            "solutions": study.pressures.solutions.iter().map(solution).collect::<Value>(),
        },
    })
}
