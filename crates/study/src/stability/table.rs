//! The study as text: CSV, the table on stdout, the JSON object.

use std::fmt::Write as _;

use serde_json::{Value, json as object};

use super::beside::{RESULTS, judged};
use super::incompressible::{POINTS, Point, TRUTHS};
use super::single_layer::SPECTRA;
use super::stabilisation::{CRITICAL, Critical, ERRORS, WithGamma};
use super::{Stability, columns};

/// Names and contents of the CSV tables; what is not known is left empty.
pub fn csv(study: &Stability<'_>) -> Vec<(&'static str, String)> {
    let mut tables = vec![
        ("incompressible.csv", columns::csv(&study.incompressible.points, &POINTS)),
        ("single-layer.csv", columns::csv(&study.single_layer.points, &SPECTRA)),
    ];
    if let Some(all) = study.stabilisation {
        tables.push(("stabilisation-critical.csv", columns::csv(&all.critical, &CRITICAL)));
        tables.push(("stabilisation-errors.csv", columns::csv(&all.errors, &ERRORS)));
    }
    tables
}

/// Name of a mesh in tables and charts.
pub(super) fn mesh_name((elements, degree): (usize, usize)) -> String {
    format!("{elements} elements, p = {degree}")
}

/// What is printed.
pub fn text(study: &Stability<'_>) -> String {
    let mut text = format!("{}\n", study.scene.title);
    let _ = writeln!(text, "settings    {} (--set changes them)", study.source.overrides.join(", "));
    if let Some(note) = study.note() {
        let _ = writeln!(text, "note        {note}");
    }
    incompressible(&mut text, study);
    single_layer(&mut text, study);
    stabilisation(&mut text, study);
    if study.interrupted {
        text += "interrupted: what was finished is here\n";
    }
    text
}

/// A line with a name and a number a ratio; a dash for what is not known.
fn line(text: &mut String, name: &str, values: impl Iterator<Item = f64>) {
    let cells = values.map(|v| if v.is_finite() { format!(" {v:>9.2e}") } else { format!(" {:>9}", "-") });
    let _ = writeln!(text, "{name:<26}{}", cells.collect::<String>());
}

/// What is printed of the meshes: a name and a value.
type Quantity<T> = (&'static str, fn(&T) -> f64);

fn incompressible(text: &mut String, study: &Stability<'_>) {
    let all = study.incompressible;
    let cells: String = all.truths.iter().map(|t| format!(" {:>9}", t.poisson)).collect();
    let _ = writeln!(text, "\n{:<26}{cells}", "Poisson's ratio");
    line(text, "reference, estimated", all.truths.iter().map(|t| t.estimate));
    let values: [Quantity<Point>; 2] =
        [("relative error, energy norm", |p| p.error), ("energy error", |p| p.energy_error)];
    for (what, value) in values {
        let _ = writeln!(text, "{what}:");
        for mesh in all.meshes() {
            line(text, &format!("  {}", mesh_name(mesh)), all.of_mesh(mesh).map(value));
        }
    }
    for (name, results) in judged(study.beside, &all.truths) {
        let at = |poisson| results.iter().find(|j| j.poisson == poisson).map_or(f64::NAN, |j| j.energy_error);
        line(text, &format!("  {name}"), all.truths.iter().map(|t| at(t.poisson)));
    }
    for (poisson, why) in all.failures() {
        let _ = writeln!(text, "FAILED at ν = {poisson}: {why}");
    }
}

fn single_layer(text: &mut String, study: &Stability<'_>) {
    let all = study.single_layer;
    let ([a, b], [low, high]) = (all.degenerate, all.own());
    let _ = writeln!(text, "\nsingle layer matrix V, {} elements, {} unknowns", all.elements, all.unknowns);
    let _ = writeln!(
        text,
        "L = 1       singular for bodies of this shape of diameter {a:.7} and {b:.7}, indefinite beyond"
    );
    let _ =
        writeln!(text, "L = d       smallest eigenvalue {low:.6e} to {high:.6e} at all sizes d (V over its diagonal)");
    let own = all.diameter;
    let verdict = if own < a { "be positive definite" } else { "not be positive definite" };
    let _ = writeln!(text, "this body   d = {own:.7} in its unit of length: with L = 1 V would {verdict}");
}

fn stabilisation(text: &mut String, study: &Stability<'_>) {
    let Some(all) = study.stabilisation else {
        *text += "\nstabilised multipliers: left out, no side is in contact\n";
        return;
    };
    let _ = writeln!(text, "\nstabilised multipliers, critical gamma_0 times Young's modulus");
    let mut degrees: Vec<usize> = all.critical.iter().map(|c| c.degree).collect();
    degrees.sort_unstable();
    degrees.dedup();
    for degree in degrees {
        let cell = |c: &Critical| format!(" {:.4} ({} elements)", c.gamma_young, c.elements);
        let cells: String = all.critical.iter().filter(|c| c.degree == degree).map(cell).collect();
        let _ = writeln!(text, "{:<26}{cells}", format!("  p = {degree}"));
    }
    if let Some(&first) = all.meshes().first() {
        let of = |mesh| all.errors.iter().filter(move |p| (p.elements, p.degree) == mesh);
        let cells: String = of(first).map(|p| format!(" {:>9}", p.ratio)).collect();
        let _ = writeln!(text, "{:<26}{cells}", "gamma_0 over critical");
        let values: [Quantity<WithGamma>; 2] =
            [("relative error, energy norm", |p| p.error), ("energy error", |p| p.energy_error)];
        for (what, value) in values {
            let _ = writeln!(text, "{what}:");
            for mesh in all.meshes() {
                line(text, &format!("  {}", mesh_name(mesh)), of(mesh).map(value));
            }
        }
    }
    for (at, why) in all.failures() {
        let _ = writeln!(text, "FAILED at {at}: {why}");
    }
}

/// The JSON object; numbers that are not known are null.
pub fn json(study: &Stability<'_>) -> Value {
    let all = study.incompressible;
    let failures = all.failures().map(|(poisson, why)| object!({ "poisson": poisson, "message": why }));
    let beside = judged(study.beside, &all.truths);
    let beside = beside.iter().map(|(name, rows)| object!({ "name": name, "points": columns::json(rows, &RESULTS) }));
    let layer = study.single_layer;
    let stabilisation = study.stabilisation.map(|all| {
        let failures = all.failures().map(|(at, why)| object!({ "at": at, "message": why }));
        object!({
            "critical": columns::json(&all.critical, &CRITICAL),
            "errors": columns::json(&all.errors, &ERRORS),
            "failures": failures.collect::<Value>(),
        })
    });
    object!({
        "title": study.scene.title,
        "settings": study.source.overrides,
        "complete": study.complete(),
        "interrupted": study.interrupted,
        "note": study.note(),
        "incompressible": {
            "references": columns::json(&all.truths, &TRUTHS),
            "points": columns::json(&all.points, &POINTS),
            "beside": beside.collect::<Value>(),
            "failures": failures.collect::<Value>(),
        },
        "single_layer": {
            "elements": layer.elements,
            "unknowns": layer.unknowns,
            "diameter": layer.diameter,
            "degenerate": layer.degenerate,
            "points": columns::json(&layer.points, &SPECTRA),
        },
        "stabilisation": stabilisation,
    })
}
