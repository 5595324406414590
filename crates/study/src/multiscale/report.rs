//! The stored and printed results of the study.
//!
//! ```text
//! /fine_grid      `source`, `limit`, `rate` (if known); columns with an entry per grid
//! /bases/NNN      `name`; columns with an entry per coarse grid
//! /rates          columns with an entry per basis on the scene or on a laminate
//! /laminates      `text` of the scene; columns with an entry per basis on a coarse grid
//! /contrast       `text` of the scene; columns with an entry per basis at a contrast
//! ```

use std::fmt::Write as _;

use serde_json::Value;

use super::contrast::{PARTS, STIFF, Stiff};
use super::convergence::{POINTS, Point};
use super::fine_grid::{LEVELS, Level};
use super::laminates::{LAMINATES, LAYERS, Layers};
use super::measure::{BASES, FITTED};
use super::plate::{PLATE, SQUARE};
use super::rates::{RATES, Rate};
use super::{FineGrid, MultiscaleStudy};
use crate::report::{Part, Report, columns, failures, named, number, part, rows, text, told};
use crate::show::{self, Shown, cells, heads, line};
use crate::table::Table;

/// The results of the study.
pub fn report<'a>(study: &'a MultiscaleStudy<'_>) -> Report<'a> {
    let basis = |k| Table::new("coarse grid", study.convergence.of(k), &POINTS);
    let points = &study.convergence.points;
    let bases = Table::new("coarse grid", points, &POINTS).key("basis", points.iter().map(|p| BASES[p.basis].0.into()));
    let levels = Table::new("grid", &study.fine_grid.levels, &LEVELS);
    let rates = Table::new("basis over a size", &study.rates(), &RATES);
    let laminates = Table::new("basis on a coarse grid", &study.laminates.points, &LAYERS);
    let contrast = Table::new("basis at a contrast", &study.contrast.points, &STIFF);
    let tables = vec![
        ("fine-grid.csv", levels.csv()),
        ("convergence.csv", bases.csv()),
        ("rates.csv", rates.csv()),
        ("laminates.csv", laminates.csv()),
        ("contrast.csv", contrast.csv()),
    ];
    let stands = "text of the scene; LAYERS stands for an expression that is positive in stiff layers";
    let layers = text("text", SQUARE, stands).only_kept();
    let stands = "text of the scene; STIFF stands for an expression that is positive in stiff parts";
    let stiff = text("text", PLATE, stands).only_kept();
    let parts = vec![
        told("repeat", study.repeat),
        failures(study.failures()),
        part("fine_grid", fine_grid_parts(&study.fine_grid, levels)),
        named("bases", BASES.iter().map(|b| b.0), "the basis, as scenes name it", basis),
        rows("rates", rates),
        told("laminates", laminates.json()),
        part("laminates", vec![layers, columns("", laminates)]).only_kept(),
        told("contrast", contrast.json()),
        part("contrast", vec![stiff, columns("", contrast)]).only_kept(),
    ];
    Report {
        content: "study: multiscale elements",
        overrides: "settings of the user, KEY=VALUE",
        scene: study.scene,
        source: study.source,
        complete: study.complete(),
        interrupted: study.interrupted,
        parts,
        tables,
        body: body(study),
    }
}

fn fine_grid_parts(fine: &FineGrid, levels: Table) -> Vec<Part> {
    let mut parts = vec![
        told("cells", fine.truth.body.grid.cells.to_vec()),
        told("error", levels.json()[0]["error"].take()),
        text("source", fine.source(), "where the error of the fine grid comes from"),
        columns("levels", levels),
    ];
    parts.extend(match fine.limit {
        Some([limit, rate]) => [
            number("limit", limit, "force*length/thickness", "J as the cells become small"),
            number("rate", rate, "1", "r in J_h - J = C h^r"),
        ],
        None => ["limit", "rate"].map(|name| told(name, Value::Null)),
    });
    parts
}

/// A number with these decimals.
fn cell(value: f64, decimals: usize) -> String {
    // small errors differ from 0
    show::number(value, |v| if v != 0.0 && v.abs() < 1e-3 { format!("{v:.1e}") } else { format!("{v:.decimals$}") })
}

fn body(study: &MultiscaleStudy<'_>) -> String {
    let mut text = String::new();
    fine_grid(&mut text, study);
    convergence(&mut text, study);
    laminates(&mut text, study);
    contrast(&mut text, study);
    show::failures(&mut text, study.failures());
    text
}

fn fine_grid(text: &mut String, study: &MultiscaleStudy<'_>) {
    let shown: [Shown<Level>; 5] = [
        ("dofs", 9, |l| l.dofs.to_string()),
        ("J", 20, |l| format!("{:.12e}", l.energy)),
        ("error", 9, |l| cell(l.error, 4)),
        ("estimate", 9, |l| cell(l.estimate, 4)),
        ("seconds", 9, |l| cell(l.seconds, 4)),
    ];
    let fine = &study.fine_grid;
    let _ = writeln!(text, "\nbilinear elements; error of the fine grid: {}", fine.source());
    if let Some([limit, rate]) = fine.limit {
        let _ = writeln!(text, "limit       J = {limit:.9e}, J_h - J ~ h^{rate:.2}");
    }
    heads(text, (&format!("{:>25}", "cells"), 25), &shown);
    for level in &fine.levels {
        let name = if level.parts == 1 { "the fine grid" } else { "" };
        let name = format!("{name:<13} {:>11}", cells(fine.truth.body.grid.cells.map(|n| n * level.parts)));
        show::rows(text, (&name, 25), &shown, std::iter::once(level));
    }
}

fn convergence(text: &mut String, study: &MultiscaleStudy<'_>) {
    let shown: [Shown<Point>; 10] = [
        ("cells", 10, |p| cells(p.coarse)),
        ("fine", 8, |p| cells(p.fine)),
        ("dofs", 9, |p| p.dofs.to_string()),
        ("error", 9, |p| cell(p.error, 4)),
        ("L2 error", 9, |p| cell(p.displacement, 4)),
        ("estimate", 9, |p| cell(p.estimate, 4)),
        ("est./err.", 9, |p| cell(p.effectivity(), 2)),
        ("to limit", 9, |p| cell(p.total, 4)),
        ("patterns", 9, |p| p.patterns.to_string()),
        ("seconds", 9, |p| cell(p.seconds, 4)),
    ];
    *text += "\nmultiscale elements against the fine grid: relative errors in the energy norm and of the displacement (L2), estimates of the first, and errors against the limit\n";
    heads(text, ("basis", 12), &shown);
    for (basis, (name, _)) in BASES.iter().enumerate() {
        show::rows(text, (name, 12), &shown, study.convergence.of(basis));
    }
    for rate in study.rates().iter().filter(|r| r.over == 0) {
        let _ = writeln!(text, "{:<12} {}", BASES[rate.basis].0, powers(rate, "H"));
    }
}

/// The fitted powers of a width.
fn powers(rate: &Rate, width: &str) -> String {
    let power = |k: usize| show::number(rate.rates[k], |r| format!("{width}^{r:.2}"));
    let fit = |k: usize| show::number(rate.r_squared[k], |r| format!("{r:.3}"));
    format!("error ~ {} (R² = {}), L2 error ~ {} (R² = {})", power(0), fit(0), power(1), fit(1))
}

/// Width of the names in front of lines.
const NAME: usize = 28;

/// A line with a value of each point; nothing if no value is known.
fn values<T>(text: &mut String, name: &str, points: &[&T], value: fn(&T) -> f64, decimals: usize) {
    if points.iter().any(|p| value(p).is_finite()) {
        line(text, (name, NAME), points.iter().map(|p| cell(value(p), decimals)));
    }
}

fn laminates(text: &mut String, study: &MultiscaleStudy<'_>) {
    let all = &study.laminates;
    *text += "\nlayers 1:10 on the unit square of 256x256 cells: relative errors (L2: of the displacement), and the estimate over the error (est.)\n";
    let mut block = |head: String, points: Vec<Vec<&Layers>>, varied: fn(&Layers) -> f64| {
        values(text, &head, &points[0], varied, 0);
        for (points, (name, _)) in points.iter().zip(&FITTED) {
            values(text, &format!("  {name}"), points, |l| l.error, 4);
            values(text, &format!("  {name}, L2"), points, |l| l.displacement, 4);
            values(text, &format!("  {name}, est."), points, |l| l.estimate / l.error, 2);
        }
    };
    for (laminate, (name, _)) in LAMINATES.iter().enumerate() {
        let bases = || 0..FITTED.len();
        let periods: Vec<Vec<&Layers>> = bases().map(|b| all.over_periods(laminate, b).collect()).collect();
        let cells: Vec<Vec<&Layers>> = bases().map(|b| all.over_cells(laminate, b).collect()).collect();
        if let Some(first) = periods[0].first() {
            block(format!("{name}, H = 1/{}: 1/eps", first.coarse), periods, |l| l.periods as f64);
        }
        if let Some(first) = cells[0].first() {
            block(format!("{name}, eps = 1/{}: 1/H", first.periods), cells, |l| l.coarse as f64);
        }
    }
    for rate in study.rates().iter().filter(|r| r.over > 0) {
        let name = format!("{}, {}", LAMINATES[rate.over - 1].0, BASES[rate.basis].0);
        let _ = writeln!(text, "{name:<NAME$} {}", powers(rate, "eps"));
    }
}

fn contrast(text: &mut String, study: &MultiscaleStudy<'_>) {
    let all = &study.contrast;
    *text +=
        "\nplate of 2x1, 8x4 coarse cells of 16x16, with stiff parts: relative errors, and estimates over the error\n";
    for (part, (name, _)) in PARTS.iter().enumerate() {
        let coupled: Vec<&Stiff> = all.of(part, 0).collect();
        if !coupled.is_empty() {
            line(text, (&format!("{name}: contrast"), NAME), coupled.iter().map(|s| format!("{:e}", s.contrast)));
        }
        for (basis, (word, _)) in FITTED.iter().enumerate() {
            let rows: Vec<&Stiff> = all.of(part, basis).collect();
            values(text, &format!("  {word}"), &rows, |s| s.error, 4);
            values(text, &format!("  {word}, nodal est."), &rows, |s| s.nodal, 2);
            values(text, &format!("  {word}, jump est."), &rows, |s| s.jump, 2);
        }
        if coupled.iter().any(|s| s.warned()) {
            let warned = |s: &&Stiff| format!(" {:>9}", if s.warned() { "warned" } else { "" });
            let warned: String = coupled.iter().map(warned).collect();
            let _ = writeln!(text, "{:<NAME$}{}", "  solve", warned.trim_end());
        }
    }
}
