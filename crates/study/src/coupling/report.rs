//! The stored and printed results of the study.
//!
//! ```text
//! /pairs          columns with an entry per pair of materials
//! /forms/NNN      `name`; columns with an entry per grid of a pair
//! /effectivity    columns with an entry per form on a grid of a pair
//! /contrast       the same for the scene's pair with other moduli of the body
//! /cost           columns with an entry per grid
//! /conditioning   columns with an entry per grid of a pair
//! /wrong_signs    columns with an entry per system on a grid
//! /own_loads      `norm`; columns with an entry per kind of elements on a grid
//! ```

use std::fmt::Write as _;

use serde_json::{Value, json};
use steklov_elastic::Material;

use super::conditioning::CONDITIONS;
use super::convergence::{FORMS, POINTS, Point};
use super::cost::{COSTS, Cost, WAYS};
use super::effectivity::{INDICATED, INDICATORS, Indicated, TERMS};
use super::own_loads::{ELEMENTS, NORM, OWN, Own};
use super::wrong::{SYSTEMS, WRONG};
use super::{CouplingStudy, Pair};
use crate::report::{Report, columns, failures, named, number as told_number, part, rows, told};
use crate::show::{self, Shown, cells, heads, line, number};
use crate::table::{Column, Table};

/// Columns of the pairs.
const PAIRS: [Column<Pair>; 4] = [
    ("body_young", "stress", "Young's modulus of the body", |p| p.body.young),
    ("body_poisson", "1", "Poisson's ratio of the body", |p| p.body.poisson),
    ("medium_young", "stress", "Young's modulus of the medium", |p| p.medium.young),
    ("medium_poisson", "1", "Poisson's ratio of the medium", |p| p.medium.poisson),
];

/// The results of the study.
pub fn report<'a>(study: &'a CouplingStudy<'_>) -> Report<'a> {
    let of_form = |form: usize| study.convergence.points.iter().filter(move |p| p.form == form);
    let form = |k| Table::new("grid of a pair", of_form(k), &POINTS);
    let points = || (0..FORMS.len()).flat_map(of_form);
    let forms = Table::new("grid of a pair", points(), &POINTS);
    let forms = forms.key("form", points().map(|p| FORMS[p.form].0.to_owned()));
    let material = |m: &Material| json!({ "young": m.young, "poisson": m.poisson });
    let pair = |p: &Pair| json!({ "name": p.name, "body": material(&p.body), "medium": material(&p.medium) });
    let all = [
        ("effectivity", Table::new("form on a grid of a pair", &study.effectivity.grids, &INDICATORS)),
        ("contrast", Table::new("form at a contrast", &study.effectivity.contrasts, &INDICATORS)),
        ("cost", Table::new("grid", &study.costs.points, &COSTS)),
        ("conditioning", Table::new("grid of a pair", &study.conditioning.points, &CONDITIONS)),
        ("wrong_signs", Table::new("system on a grid", &study.wrongs.points, &WRONG)),
    ];
    let files = ["effectivity.csv", "contrast.csv", "cost.csv", "conditioning.csv", "wrong-signs.csv"];
    let mut tables = vec![("convergence.csv", forms.csv())];
    tables.extend(files.into_iter().zip(&all).map(|(file, (_, table))| (file, table.csv())));
    let own = Table::new("elements on a grid", &study.own_loads.points, &OWN);
    tables.push(("own-loads.csv", own.csv()));
    let mut parts = vec![
        told("repeat", study.repeat),
        failures(study.failures()),
        told("pairs", study.pairs.iter().map(pair).collect::<Value>()),
        rows("pairs", Table::new("pair", &study.pairs, &PAIRS)).only_kept(),
        named("forms", FORMS.iter().map(|f| f.0), "the form of the equations", form),
    ];
    parts.extend(all.into_iter().map(|(name, table)| rows(name, table)));
    let norm = told_number("norm", study.own_loads.norm, NORM.0, NORM.1);
    parts.push(part("own_loads", vec![norm, columns("points", own)]));
    Report {
        content: "study: coupling",
        overrides: "settings of the study and the user, KEY=VALUE",
        scene: study.scene,
        source: study.source,
        complete: study.complete(),
        interrupted: study.interrupted,
        parts,
        tables,
        body: body(study),
    }
}

/// Width of the names in front of lines.
const NAME: usize = 32;

/// A number in a column of this width.
fn cell(value: f64, width: usize, decimals: usize) -> String {
    number(value, |v| {
        let plain = format!("{v:.decimals$}");
        // small errors differ from 0, and columns keep their width
        if v != 0.0 && v.abs() < 1e-3 || plain.len() > width { format!("{v:.2e}") } else { plain }
    })
}

fn body(study: &CouplingStudy<'_>) -> String {
    let mut text = String::new();
    convergence(&mut text, study);
    effectivity(&mut text, study);
    costs(&mut text, study);
    conditioning(&mut text, study);
    wrongs(&mut text, study);
    own_loads(&mut text, study);
    show::failures(&mut text, study.failures());
    text
}

fn convergence(text: &mut String, study: &CouplingStudy<'_>) {
    let shown: [Shown<Point>; 8] = [
        ("cells", 9, |p| cells(p.cells)),
        ("dofs", 8, |p| p.dofs.to_string()),
        ("trace", 7, |p| p.trace.to_string()),
        ("error", 10, |p| cell(p.error, 10, 5)),
        ("rate", 6, |p| cell(p.rate, 6, 2)),
        ("traction", 10, |p| cell(p.traction, 10, 5)),
        ("rate", 6, |p| cell(p.traction_rate, 6, 2)),
        ("seconds", 9, |p| cell(p.seconds, 9, 4)),
    ];
    *text += "\nerrors with a known solution, by E and nu of body | medium: body in the energy norm, traction in that of V\n";
    for (pair, materials) in study.pairs.iter().enumerate() {
        let _ = writeln!(text, "{}", materials.name);
        heads(text, ("  form", 14), &shown);
        for (form, (name, _)) in FORMS.iter().enumerate() {
            show::rows(text, (&format!("  {name}"), 14), &shown, study.convergence.of(pair, form));
        }
    }
}

fn effectivity(text: &mut String, study: &CouplingStudy<'_>) {
    *text += "\nresidual indicators over the error of body and traction, whole and by term\n";
    let mut block = |name: &str, head: fn(&Indicated) -> String, of: &dyn Fn(usize) -> Vec<Indicated>| {
        for (form, (word, _)) in INDICATED.iter().enumerate() {
            let points = of(form);
            if form == 0 {
                line(text, (name, NAME), points.iter().map(head));
            }
            line(text, (&format!("  {word}"), NAME), points.iter().map(|i| format!("{:.2}", i.whole)));
            for (k, term) in TERMS.iter().enumerate() {
                if points.iter().any(|i| i.terms[k].is_finite()) {
                    line(text, (&format!("    {term}"), NAME), points.iter().map(|i| cell(i.terms[k], 9, 3)));
                }
            }
        }
    };
    for (pair, materials) in study.pairs.iter().enumerate() {
        block(&materials.name, |i| cells(i.cells), &|form| study.effectivity.of(pair, form).copied().collect());
    }
    if let Some(first) = study.effectivity.contrasts.first() {
        let over = |form| study.effectivity.over_contrast(form).copied().collect();
        block(&format!("{} cells, contrast", cells(first.cells)), |i| format!("{:.0e}", i.contrast), &over);
    }
}

fn costs(text: &mut String, study: &CouplingStudy<'_>) {
    let size: [Shown<Cost>; 2] = [("dofs", 8, |c| c.dofs.to_string()), ("trace", 7, |c| c.trace.to_string())];
    let seconds: [Shown<Cost>; 4] = [
        ("(1)", 9, |c| cell(c.seconds[0], 9, 4)),
        ("(2)", 9, |c| cell(c.seconds[1], 9, 4)),
        ("(3)", 9, |c| cell(c.seconds[2], 9, 4)),
        ("S", 9, |c| cell(c.steklov, 9, 4)),
    ];
    let entries: [Shown<Cost>; 3] = [
        ("(1)", 9, |c| cell(c.entries[0], 9, 0)),
        ("(2)", 9, |c| cell(c.entries[1], 9, 0)),
        ("(3)", 9, |c| cell(c.entries[2], 9, 0)),
    ];
    let rows = |text: &mut String, columns: &[Shown<Cost>]| {
        for c in &study.costs.points {
            show::rows(text, (&format!("{:>9}", cells(c.cells)), 9), columns, std::iter::once(c));
        }
    };
    *text += "\nseconds from the matrices to the displacements (those of S alone in the last column), and entries\n";
    let columns = [&size[..], &seconds].concat();
    heads(text, ("    cells", 9), &columns);
    rows(text, &columns);
    *text += "entries\n";
    rows(text, &[&size[..], &entries].concat());
    for (k, way) in WAYS.iter().enumerate() {
        let _ = writeln!(text, "({}) {way}", k + 1);
    }
    let apart = study.costs.points.iter().fold(0.0f64, |m, c| m.max(c.difference));
    let _ = writeln!(text, "the solutions differ by {apart:.1e} of the largest displacement at most");
}

fn conditioning(text: &mut String, study: &CouplingStudy<'_>) {
    *text += "\nreciprocal condition of the three-field matrix, two translations or all three rigid motions removed\n";
    for (pair, materials) in study.pairs.iter().enumerate() {
        let points = || study.conditioning.of(pair);
        line(text, (&materials.name, NAME), points().map(|c| cells(c.cells)));
        line(text, ("  two", NAME), points().map(|c| format!("{:.1e}", c.two)));
        line(text, ("  three", NAME), points().map(|c| format!("{:.1e}", c.three)));
    }
}

fn wrongs(text: &mut String, study: &CouplingStudy<'_>) {
    let Some(first) = study.pairs.first() else { return };
    let _ = writeln!(text, "\nwhat must not be done: errors in the energy norm, {}", first.name);
    line(text, ("", NAME), study.wrongs.of(0).map(|w| cells(w.cells)));
    for (system, name) in SYSTEMS.iter().enumerate() {
        line(text, (&format!("  {name}"), NAME), study.wrongs.of(system).map(|w| cell(w.error, 9, 4)));
    }
}

fn own_loads(text: &mut String, study: &CouplingStudy<'_>) {
    let shown: [Shown<Own>; 12] = [
        ("coarse", 9, |p| cells(p.coarse)),
        ("fine", 9, |p| cells(p.cells)),
        ("dofs", 8, |p| p.dofs.to_string()),
        ("body", 8, |p| cell(p.errors[0], 8, 4)),
        ("displ.", 8, |p| cell(p.errors[1], 8, 4)),
        ("traction", 8, |p| cell(p.errors[2], 8, 4)),
        ("error", 8, |p| cell(p.error(), 8, 4)),
        ("rate", 6, |p| cell(p.rate, 6, 2)),
        ("to limit", 8, |p| cell(p.total, 8, 4)),
        ("residual", 8, |p| cell(p.residual, 8, 4)),
        ("res./err.", 9, |p| cell(p.effectivity(), 9, 2)),
        ("seconds", 9, |p| cell(p.seconds, 9, 4)),
    ];
    let own = &study.own_loads;
    if own.points.is_empty() {
        return;
    }
    *text += "\nthe scene's own moduli and loads, relative errors: body in the energy norm, displacement and traction of the medium in those of W and V, all three, and residual estimators\n";
    let parts = [
        (0, "over H, against bilinear elements on the same fine cells"),
        (1, "over h; bilinear elements against the limit of fine grids"),
    ];
    for (over, what) in parts {
        let _ = writeln!(text, "{what}");
        heads(text, ("  elements", 14), &shown);
        for (elements, (name, _)) in ELEMENTS.iter().enumerate() {
            show::rows(text, (&format!("  {name}"), 14), &shown, own.of(over, elements));
        }
    }
}
