//! The stored and printed results of the study.
//!
//! ```text
//! /incompressible/references, points   columns with an entry per ratio, or per mesh at a ratio
//! /incompressible/beside/NNN           `name`, and columns with an entry per ratio
//! /single_layer                        `degenerate`, `diameter`; points: columns with an entry per size
//! /stabilisation/critical, errors      columns with an entry per mesh, or per γ₀ on a mesh; not without contact
//! ```

use std::fmt::Write as _;

use serde_json::{Value, json};
use steklov_io::Label;

use super::beside::{Judged, RESULTS, judged};
use super::incompressible::{POINTS, Point, TRUTHS};
use super::single_layer::SPECTRA;
use super::stabilisation::{CRITICAL, Critical, ERRORS, WithGamma};
use super::{Stabilisation, Stability};
use crate::report::{Part, Report, columns, list, number, part, rows, text, told, vector};
use crate::show::{self, line};
use crate::table::Table;

/// The results of the study.
pub fn report<'a>(study: &'a Stability<'_>) -> Report<'a> {
    let points = Table::new("mesh at a ratio", &study.incompressible.points, &POINTS);
    let spectra = Table::new("size", &study.single_layer.points, &SPECTRA);
    let mut tables = vec![("incompressible.csv", points.csv()), ("single-layer.csv", spectra.csv())];
    let stabilisation = match &study.stabilisation {
        None => told("stabilisation", Value::Null),
        Some(all) => {
            let critical = Table::new("mesh", &all.critical, &CRITICAL);
            let errors = Table::new("gamma on a mesh", &all.errors, &ERRORS);
            tables.push(("stabilisation-critical.csv", critical.csv()));
            tables.push(("stabilisation-errors.csv", errors.csv()));
            let failures = all.failures().map(|(at, why)| json!({ "at": at, "message": why }));
            let failures = told("failures", failures.collect::<Value>());
            part("stabilisation", vec![rows("critical", critical), rows("errors", errors), failures])
        }
    };
    let layer = &study.single_layer;
    let meaning = "diameters of bodies of this shape at which V is singular for L = 1";
    let degenerate = Label { unit: "length", meaning, axes: &["eigenvalue"] };
    let single_layer = vec![
        told("elements", layer.elements),
        told("unknowns", layer.unknowns),
        number("diameter", layer.diameter, "length", "diameter of the scene's body"),
        vector("degenerate", &layer.degenerate, degenerate),
        rows("points", spectra),
    ];
    Report {
        content: "study: stability",
        overrides: "settings of the study and of the user, KEY=VALUE",
        scene: study.scene,
        source: study.source,
        complete: study.complete(),
        interrupted: study.interrupted,
        parts: vec![
            told("note", study.note()),
            part("incompressible", incompressible_parts(study, points)),
            part("single_layer", single_layer),
            stabilisation,
        ],
        tables,
        body: body(study),
    }
}

fn incompressible_parts(study: &Stability<'_>, points: Table) -> Vec<Part> {
    let all = &study.incompressible;
    let other = |(name, results): (&str, Vec<Judged>)| {
        let results = Table::new("ratio", &results, &RESULTS);
        vec![text("name", name, "the other method and its mesh"), columns("points", results)]
    };
    let failures = all.failures().map(|(poisson, why)| json!({ "poisson": poisson, "message": why }));
    vec![
        rows("references", Table::new("ratio", &all.truths, &TRUTHS)),
        rows("points", points),
        list("beside", judged(&study.beside, &all.truths).into_iter().map(other).collect()),
        told("failures", failures.collect::<Value>()),
    ]
}

/// Name of a mesh in tables and charts.
pub(super) fn mesh_name((elements, degree): (usize, usize)) -> String {
    format!("{elements} elements, p = {degree}")
}

fn body(study: &Stability<'_>) -> String {
    let mut text = show::head(study.source, study.note());
    incompressible(&mut text, study);
    single_layer(&mut text, study);
    match &study.stabilisation {
        Some(all) => stabilisation(&mut text, all),
        None => text += "\nstabilised multipliers: left out, no side is in contact\n",
    }
    text
}

/// Width of the names in front of lines.
const NAME: usize = 26;

/// One number for each ratio.
fn numbers(text: &mut String, name: &str, values: impl Iterator<Item = f64>) {
    line(text, (name, NAME), values.map(|v| show::number(v, |v| format!("{v:.2e}"))));
}

/// The printed quantities of the meshes: a name and a value.
type Quantity<T> = (&'static str, fn(&T) -> f64);

/// Two quantities of some meshes, one line each.
fn by_mesh<'p, T: 'p, I: Iterator<Item = &'p T>>(
    text: &mut String,
    quantities: [Quantity<T>; 2],
    meshes: &[(usize, usize)],
    of: impl Fn((usize, usize)) -> I,
) {
    for (what, value) in quantities {
        let _ = writeln!(text, "{what}:");
        for &mesh in meshes {
            numbers(text, &format!("  {}", mesh_name(mesh)), of(mesh).map(value));
        }
    }
}

fn incompressible(text: &mut String, study: &Stability<'_>) {
    let all = &study.incompressible;
    *text += "\n";
    line(text, ("Poisson's ratio", NAME), all.truths.iter().map(|t| t.poisson.to_string()));
    numbers(text, "reference, estimated", all.truths.iter().map(|t| t.estimate));
    let quantities: [Quantity<Point>; 2] =
        [("relative error, energy norm", |p| p.error), ("energy error", |p| p.energy_error)];
    by_mesh(text, quantities, &all.meshes(), |mesh| all.of_mesh(mesh));
    for (name, results) in judged(&study.beside, &all.truths) {
        let at = |poisson| results.iter().find(|j| j.poisson == poisson).map_or(f64::NAN, |j| j.energy_error);
        numbers(text, &format!("  {name}"), all.truths.iter().map(|t| at(t.poisson)));
    }
    for (poisson, why) in all.failures() {
        let _ = writeln!(text, "FAILED at ν = {poisson}: {why}");
    }
}

fn single_layer(text: &mut String, study: &Stability<'_>) {
    let all = &study.single_layer;
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

fn stabilisation(text: &mut String, all: &Stabilisation) {
    let _ = writeln!(text, "\nstabilised multipliers, critical gamma_0 times Young's modulus");
    for degree in all.degrees() {
        let cell = |c: &Critical| format!(" {:.4} ({} elements)", c.gamma_young, c.elements);
        let cells: String = all.critical.iter().filter(|c| c.degree == degree).map(cell).collect();
        let _ = writeln!(text, "{:<NAME$}{cells}", format!("  p = {degree}"));
    }
    if let Some(&first) = all.meshes().first() {
        line(text, ("gamma_0 over critical", NAME), all.of_mesh(first).map(|p| p.ratio.to_string()));
        let quantities: [Quantity<WithGamma>; 2] =
            [("relative error, energy norm", |p| p.error), ("energy error", |p| p.energy_error)];
        by_mesh(text, quantities, &all.meshes(), |mesh| all.of_mesh(mesh));
    }
    for (at, why) in all.failures() {
        let _ = writeln!(text, "FAILED at {at}: {why}");
    }
}
