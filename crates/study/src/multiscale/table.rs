//! The study as text: CSV, the table on stdout, the JSON object.

use std::fmt::Write as _;

use serde_json::{Value, json as object};

use super::contrast::{CONTRASTED, PARTS, STIFF, Stiff};
use super::convergence::{POINTS, Point};
use super::fine_grid::LEVELS;
use super::laminates::{LAMINATES, LAYERS, Layers, RESONATING};
use super::measure::BASES;
use super::{MultiscaleStudy, columns};

/// Names and contents of the CSV tables; what is not known is left empty.
pub fn csv(study: &MultiscaleStudy<'_>) -> Vec<(&'static str, String)> {
    let bases: Vec<Vec<Point>> = (0..BASES.len()).map(|b| study.convergence.of(b).copied().collect()).collect();
    vec![
        ("fine-grid.csv", columns::csv(&study.fine_grid.levels, &LEVELS)),
        ("convergence.csv", named("basis", BASES.iter().map(|b| b.0).zip(&bases), &POINTS)),
        ("laminates.csv", columns::csv(&study.laminates.points, &LAYERS)),
        ("contrast.csv", columns::csv(&study.contrast.points, &STIFF)),
    ]
}

/// One table of several lists, the name of each in the first column.
fn named<'a, T: 'a>(
    column: &str,
    lists: impl Iterator<Item = (&'a str, &'a Vec<T>)>,
    columns: &[columns::Column<T>],
) -> String {
    let mut text = format!("{column},{}", columns::csv::<T>(&[], columns));
    for (name, rows) in lists {
        for line in columns::csv(rows, columns).lines().skip(1) {
            let _ = writeln!(text, "{name},{line}");
        }
    }
    text
}

/// A number in a column; a dash for what is not known.
fn cell(value: f64, width: usize, decimals: usize) -> String {
    // so that small errors are told from none
    if value != 0.0 && value.abs() < 1e-3 {
        format!(" {value:>width$.1e}")
    } else if value.is_finite() {
        format!(" {value:>width$.decimals$}")
    } else {
        format!(" {:>width$}", "-")
    }
}

/// What is printed.
pub fn text(study: &MultiscaleStudy<'_>) -> String {
    let mut text = format!("{}\n", study.scene.title);
    fine_grid(&mut text, study);
    convergence(&mut text, study);
    laminates(&mut text, study);
    contrast(&mut text, study);
    for (at, why) in study.failures() {
        let _ = writeln!(text, "FAILED at {at}: {why}");
    }
    if study.interrupted {
        text += "interrupted: what was finished is here\n";
    }
    text
}

fn fine_grid(text: &mut String, study: &MultiscaleStudy<'_>) {
    let fine = study.fine_grid;
    let [nx, ny] = fine.truth.body.grid.cells;
    let _ = writeln!(text, "\nbilinear elements; error of the fine grid: {}", fine.source());
    if let Some([limit, rate]) = fine.limit {
        let _ = writeln!(text, "limit       J = {limit:.9e}, J_h - J ~ h^{rate:.2}");
    }
    let _ = writeln!(
        text,
        "{:<13} {:>11} {:>9} {:>20} {:>9} {:>9} {:>9}",
        "", "cells", "dofs", "J", "error", "estimate", "seconds"
    );
    for level in &fine.levels {
        let name = if level.parts == 1 { "the fine grid" } else { "" };
        let cells = format!("{}x{}", nx * level.parts, ny * level.parts);
        let _ = writeln!(
            text,
            "{name:<13} {cells:>11} {:>9} {:>20.12e}{}{}{}",
            level.dofs,
            level.energy,
            cell(level.error, 9, 4),
            cell(level.estimate, 9, 4),
            cell(level.seconds, 9, 4)
        );
    }
}

fn convergence(text: &mut String, study: &MultiscaleStudy<'_>) {
    *text += "\nmultiscale elements, relative errors in the energy norm against the fine grid, their estimates, and errors against the limit\n";
    let _ = writeln!(
        text,
        "{:<12} {:>10} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "basis", "cells", "fine", "dofs", "error", "estimate", "est./err.", "to limit", "patterns", "seconds"
    );
    for (basis, (name, _)) in BASES.iter().enumerate() {
        let mut name = *name;
        for p in study.convergence.of(basis) {
            let _ = writeln!(
                text,
                "{name:<12} {:>10} {:>8} {:>9}{}{}{}{} {:>9}{}",
                format!("{}x{}", p.coarse[0], p.coarse[1]),
                format!("{}x{}", p.fine[0], p.fine[1]),
                p.dofs,
                cell(p.error, 9, 4),
                cell(p.estimate, 9, 4),
                cell(p.effectivity(), 9, 2),
                cell(p.total, 9, 4),
                p.patterns,
                cell(p.seconds, 9, 4)
            );
            name = "";
        }
    }
}

/// A name and a value of each point; nothing if none is known.
fn line<T>(text: &mut String, name: &str, points: &[&T], value: fn(&T) -> f64, decimals: usize) {
    if points.iter().any(|p| value(p).is_finite()) {
        let cells: String = points.iter().map(|p| cell(value(p), 9, decimals)).collect();
        let _ = writeln!(text, "{name:<28}{cells}");
    }
}

fn laminates(text: &mut String, study: &MultiscaleStudy<'_>) {
    let all = study.laminates;
    *text +=
        "\nlayers 1:10 on the unit square of 256x256 cells: relative errors, and the estimate over the error (est.)\n";
    for (laminate, (name, _)) in LAMINATES.iter().enumerate() {
        let periods: Vec<Vec<&Layers>> =
            (0..RESONATING.len()).map(|b| all.over_periods(laminate, b).collect()).collect();
        let cells: Vec<Vec<&Layers>> = (0..RESONATING.len()).map(|b| all.over_cells(laminate, b).collect()).collect();
        if let Some(first) = periods[0].first() {
            let head = format!("{name}, H = 1/{}: 1/eps", first.coarse);
            line(text, &head, &periods[0], |l| l.periods as f64, 0);
            of_bases(text, &periods);
        }
        if let Some(first) = cells[0].first() {
            line(text, &format!("{name}, eps = 1/{}: 1/H", first.periods), &cells[0], |l| l.coarse as f64, 0);
            of_bases(text, &cells);
        }
    }
}

/// Errors and effectivities of the bases.
fn of_bases(text: &mut String, rows: &[Vec<&Layers>]) {
    for (rows, (name, _)) in rows.iter().zip(&RESONATING) {
        line(text, &format!("  {name}"), rows, |l| l.error, 4);
        line(text, &format!("  {name}, est."), rows, |l| l.estimate / l.error, 2);
    }
}

fn contrast(text: &mut String, study: &MultiscaleStudy<'_>) {
    let all = study.contrast;
    *text +=
        "\nplate of 2x1, 8x4 coarse cells of 16x16, with stiff parts: relative errors, and estimates over the error\n";
    for (part, (name, _)) in PARTS.iter().enumerate() {
        for (basis, (word, _)) in CONTRASTED.iter().enumerate() {
            let rows: Vec<&Stiff> = all.of(part, basis).collect();
            if basis == 0 && !rows.is_empty() {
                let cells: String = rows.iter().map(|s| format!(" {:>9}", format!("{:e}", s.contrast))).collect();
                let _ = writeln!(text, "{:<28}{cells}", format!("{name}: contrast"));
            }
            line(text, &format!("  {word}"), &rows, |s| s.error, 4);
            line(text, &format!("  {word}, nodal est."), &rows, |s| s.nodal, 2);
            line(text, &format!("  {word}, jump est."), &rows, |s| s.jump, 2);
        }
        let warned: Vec<&Stiff> = all.of(part, 0).collect();
        if warned.iter().any(|s| s.warned()) {
            let cells: String =
                warned.iter().map(|s| format!(" {:>9}", if s.warned() { "warned" } else { "" })).collect();
            let _ = writeln!(text, "{:<28}{}", "  solve", cells.trim_end());
        }
    }
}

/// The JSON object; numbers that are not known are null.
pub fn json(study: &MultiscaleStudy<'_>) -> Value {
    let fine = study.fine_grid;
    let basis = |(k, (name, _)): (usize, &(&str, steklov_problem::BasisInput))| {
        let rows: Vec<Point> = study.convergence.of(k).copied().collect();
        object!({ "name": name, "points": columns::json(&rows, &POINTS) })
    };
    object!({
        "title": study.scene.title,
        "settings": study.source.overrides,
        "complete": study.complete(),
        "interrupted": study.interrupted,
        "repeat": study.repeat,
        "failures": study.failures().map(|(at, why)| object!({ "at": at, "message": why })).collect::<Value>(),
        "fine_grid": {
            "cells": fine.truth.body.grid.cells,
            "error": columns::json(&fine.levels, &LEVELS)[0]["error"],
            "source": fine.source(),
            "limit": fine.limit.map(|l| l[0]),
            "rate": fine.limit.map(|l| l[1]),
            "levels": columns::json(&fine.levels, &LEVELS),
        },
        "laminates": columns::json(&study.laminates.points, &LAYERS),
        "contrast": columns::json(&study.contrast.points, &STIFF),
        "bases": BASES.iter().enumerate().map(basis).collect::<Value>(),
    })
}
