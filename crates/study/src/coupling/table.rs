//! The study as text: CSV, the table on stdout, the JSON object.

use std::fmt::Write as _;

use serde_json::{Value, json as object};

use super::conditioning::{CONDITIONS, Condition};
use super::convergence::{FORMS, POINTS, Point};
use super::cost::{COSTS, Cost, WAYS};
use super::effectivity::{INDICATED, INDICATORS, Indicated, TERMS};
use super::wrong::{SYSTEMS, WRONG};
use super::{CouplingStudy, columns};

/// Names and contents of the CSV tables; what is not known is left empty.
pub fn csv(study: &CouplingStudy<'_>) -> Vec<(&'static str, String)> {
    let mut convergence = format!("form,{}", columns::csv::<Point>(&[], &POINTS));
    for (form, (name, _)) in FORMS.iter().enumerate() {
        for line in columns::csv(&of_form(study, form), &POINTS).lines().skip(1) {
            let _ = writeln!(convergence, "{name},{line}");
        }
    }
    vec![
        ("convergence.csv", convergence),
        ("effectivity.csv", columns::csv(&study.effectivity.grids, &INDICATORS)),
        ("contrast.csv", columns::csv(&study.effectivity.contrasts, &INDICATORS)),
        ("cost.csv", columns::csv(&study.costs.points, &COSTS)),
        ("conditioning.csv", columns::csv(&study.conditioning.points, &CONDITIONS)),
        ("wrong-signs.csv", columns::csv(&study.wrongs.points, &WRONG)),
    ]
}

/// The points of a form, by pair and grid.
pub(super) fn of_form(study: &CouplingStudy<'_>, form: usize) -> Vec<Point> {
    (0..study.pairs.len()).flat_map(|pair| study.convergence.of(pair, form).copied()).collect()
}

/// A number in a column; a dash for what is not known.
fn cell(value: f64, width: usize, decimals: usize) -> String {
    if !value.is_finite() {
        return format!(" {:>width$}", "-");
    }
    let plain = format!(" {value:>width$.decimals$}");
    // so that small errors are told from none, and columns keep their width
    if value != 0.0 && value.abs() < 1e-3 || plain.len() > width + 1 {
        return format!(" {value:>width$.2e}");
    }
    plain
}

/// Numbers of cells.
fn grid([x, y]: [usize; 2]) -> String {
    format!("{x}x{y}")
}

/// What is printed.
pub fn text(study: &CouplingStudy<'_>) -> String {
    let mut text = format!("{}\n", study.scene.title);
    convergence(&mut text, study);
    effectivity(&mut text, study);
    costs(&mut text, study);
    conditioning(&mut text, study);
    wrongs(&mut text, study);
    for (at, why) in study.failures() {
        let _ = writeln!(text, "FAILED at {at}: {why}");
    }
    if study.interrupted {
        text += "interrupted: what was finished is here\n";
    }
    text
}

fn convergence(text: &mut String, study: &CouplingStudy<'_>) {
    *text += "\nerrors with a known solution, by E and nu of body | medium: body in the energy norm, traction in that of V\n";
    for (pair, materials) in study.pairs.iter().enumerate() {
        let _ = writeln!(text, "{}", materials.name);
        let _ = writeln!(
            text,
            "  {:<12} {:>9} {:>8} {:>7} {:>10} {:>6} {:>10} {:>6} {:>9}",
            "form", "cells", "dofs", "trace", "error", "rate", "traction", "rate", "seconds"
        );
        for (form, (name, _)) in FORMS.iter().enumerate() {
            let mut name = *name;
            for p in study.convergence.of(pair, form) {
                let _ = writeln!(
                    text,
                    "  {name:<12} {:>9} {:>8} {:>7}{}{}{}{}{}",
                    grid(p.cells),
                    p.dofs,
                    p.trace,
                    cell(p.error, 10, 5),
                    cell(p.rate, 6, 2),
                    cell(p.traction, 10, 5),
                    cell(p.traction_rate, 6, 2),
                    cell(p.seconds, 9, 4)
                );
                name = "";
            }
        }
    }
}

fn effectivity(text: &mut String, study: &CouplingStudy<'_>) {
    *text += "\nresidual indicators over the error of body and traction, whole and by term\n";
    let mut block = |name: &str, head: fn(&Indicated) -> String, points: &dyn Fn(usize) -> Vec<Indicated>| {
        for (form, (word, _)) in INDICATED.iter().enumerate() {
            let points = points(form);
            let points: Vec<&Indicated> = points.iter().collect();
            if form == 0 {
                line(text, name, &points, head);
            }
            line(text, &format!("  {word}"), &points, |i| format!("{:.2}", i.whole));
            for (k, term) in TERMS.iter().enumerate() {
                if points.iter().any(|i| i.terms[k].is_finite()) {
                    line(text, &format!("    {term}"), &points, |i| cell(i.terms[k], 9, 3).trim().to_owned());
                }
            }
        }
    };
    for (pair, materials) in study.pairs.iter().enumerate() {
        block(&materials.name, |i| grid(i.cells), &|form| study.effectivity.of(pair, form).copied().collect());
    }
    if let Some(first) = study.effectivity.contrasts.first() {
        let name = format!("{} cells, contrast", grid(first.cells));
        block(&name, |i| format!("{:.0e}", i.contrast), &|form| {
            study.effectivity.over_contrast(form).copied().collect()
        });
    }
}

fn costs(text: &mut String, study: &CouplingStudy<'_>) {
    *text += "\nseconds from the matrices to the displacements (those of S alone in the last column), and entries\n";
    let _ =
        writeln!(text, "{:>9} {:>8} {:>7} {:>9} {:>9} {:>9} {:>9}", "cells", "dofs", "trace", "(1)", "(2)", "(3)", "S");
    let line = |text: &mut String, c: &Cost, values: &[f64], decimals: usize| {
        let cells: String = values.iter().map(|v| cell(*v, 9, decimals)).collect();
        let _ = writeln!(text, "{:>9} {:>8} {:>7}{cells}", grid(c.cells), c.dofs, c.trace);
    };
    for c in &study.costs.points {
        line(text, c, &[c.seconds[0], c.seconds[1], c.seconds[2], c.steklov], 4);
    }
    *text += "entries\n";
    for c in &study.costs.points {
        line(text, c, &c.entries, 0);
    }
    for (k, way) in WAYS.iter().enumerate() {
        let _ = writeln!(text, "({}) {way}", k + 1);
    }
    let apart = study.costs.points.iter().fold(0.0f64, |m, c| m.max(c.difference));
    let _ = writeln!(text, "the solutions differ by {apart:.1e} of the largest displacement at most");
}

/// A name, and a value of each point.
fn line<T>(text: &mut String, name: &str, points: &[&T], value: impl Fn(&T) -> String) {
    let cells: String = points.iter().map(|p| format!(" {:>9}", value(p))).collect();
    let _ = writeln!(text, "{name:<32}{cells}");
}

fn conditioning(text: &mut String, study: &CouplingStudy<'_>) {
    *text += "\nreciprocal condition of the three-field matrix, two translations or all three rigid motions removed\n";
    for (pair, materials) in study.pairs.iter().enumerate() {
        let points: Vec<&Condition> = study.conditioning.of(pair).collect();
        line(text, &materials.name, &points, |c| grid(c.cells));
        line(text, "  two", &points, |c| format!("{:.1e}", c.two));
        line(text, "  three", &points, |c| format!("{:.1e}", c.three));
    }
}

fn wrongs(text: &mut String, study: &CouplingStudy<'_>) {
    let Some(first) = study.pairs.first() else { return };
    let _ = writeln!(text, "\nwhat must not be done: errors in the energy norm, {}", first.name);
    for (system, name) in SYSTEMS.iter().enumerate() {
        let points: Vec<_> = study.wrongs.of(system).collect();
        if system == 0 {
            line(text, "", &points, |w| grid(w.cells));
        }
        line(text, &format!("  {name}"), &points, |w| cell(w.error, 9, 4).trim().to_owned());
    }
}

/// The JSON object; numbers that are not known are null.
pub fn json(study: &CouplingStudy<'_>) -> Value {
    let material = |m: &steklov_elastic::Material| object!({ "young": m.young, "poisson": m.poisson });
    let pair = |p: &super::Pair| object!({ "name": p.name, "body": material(&p.body), "medium": material(&p.medium) });
    let form = |(k, (name, _)): (usize, &(&str, steklov_coupling::Form))| object!({ "name": name, "points": columns::json(&of_form(study, k), &POINTS) });
    object!({
        "title": study.scene.title,
        "settings": study.source.overrides,
        "complete": study.complete(),
        "interrupted": study.interrupted,
        "repeat": study.repeat,
        "failures": study.failures().map(|(at, why)| object!({ "at": at, "message": why })).collect::<Value>(),
        "pairs": study.pairs.iter().map(pair).collect::<Value>(),
        "forms": FORMS.iter().enumerate().map(form).collect::<Value>(),
        "effectivity": columns::json(&study.effectivity.grids, &INDICATORS),
        "contrast": columns::json(&study.effectivity.contrasts, &INDICATORS),
        "cost": columns::json(&study.costs.points, &COSTS),
        "conditioning": columns::json(&study.conditioning.points, &CONDITIONS),
        "wrong_signs": columns::json(&study.wrongs.points, &WRONG),
    })
}
