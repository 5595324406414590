//! The stored and printed results of the study.
//!
//! ```text
//! /reference         dofs, estimate
//! /shares            columns with an entry each for those without doubts, and those in doubt
//! /quantities/NNN    `name`; columns with an entry per step
//! ```

use std::fmt::Write as _;

use super::{Judged, QuantityStudy, Series, Shares};
use crate::report::{Report, named, number, part, rows, told};
use crate::show::{self, Shown, heads};
use crate::table::{Column, Table};

/// The numbers of a quantity at a step.
const NUMBERS: [Column<Judged>; 5] = [
    ("value", "that of the quantity", "its value", |j| j.value),
    ("uncertainty", "that of the quantity", "its uncertainty", |j| j.uncertainty),
    ("error", "that of the quantity", "its distance from the reference", |j| j.error),
    ("effectivity", "1", "uncertainty over error; NaN where the reference does not tell the error", |j| j.effectivity),
    ("smoothed", "1", "the same over an error that is smoothed over its zeros", |j| j.smoothed),
];

/// The numbers of shares.
const SHARES: [Column<Shares>; 8] = [
    ("count", "1", "quantities times steps whose errors are known", |s| s.count as f64),
    ("median", "1", "median of uncertainty over error", |s| s.median),
    ("least", "1", "the smallest one", |s| s.least),
    ("above_0.5", "1", "the part of which it is at least 0.5", |s| s.above[0]),
    ("above_0.3", "1", "at least 0.3", |s| s.above[1]),
    ("above_0.1", "1", "at least 0.1", |s| s.above[2]),
    ("below_4", "1", "at most 4, errors smoothed over their zeros", |s| s.below[0]),
    ("below_10", "1", "at most 10, errors smoothed over their zeros", |s| s.below[1]),
];

/// The results of the study.
pub fn report<'a>(study: &'a QuantityStudy<'_>) -> Report<'a> {
    let reference = &study.reference;
    let estimate = reference.estimate_relative.unwrap_or(f64::NAN);
    let all = || study.series.iter().flat_map(|series| series.points.iter().map(move |point| (series, point)));
    let steps = table(all().map(|(_, point)| point)).key("quantity", all().map(|(series, _)| series.path.clone()));
    let shares: Vec<Shares> = groups(study).into_iter().map(|(_, shares)| shares).collect();
    let of = |k: usize| table(&study.series[k].points);
    Report {
        content: "study: error bars of quantities",
        overrides: "settings of the study and of the user, KEY=VALUE",
        scene: study.scene,
        source: study.source,
        complete: study.complete(),
        interrupted: study.interrupted,
        parts: vec![
            part(
                "reference",
                vec![
                    number("dofs", reference.dofs as f64, "1", "displacement unknowns"),
                    number("estimate", estimate, "1", "estimated relative error, energy norm"),
                ],
            ),
            rows("shares", Table::new("without doubts, in doubt", &shares[..2], &SHARES)),
            named("quantities", study.series.iter().map(|series| series.path.as_str()), "path of the quantity", of),
            told("failure", study.failure.as_ref().map(ToString::to_string)),
        ],
        tables: vec![("quantities.csv", steps.csv())],
        body: body(study),
    }
}

fn table<'p>(points: impl IntoIterator<Item = &'p Judged>) -> Table {
    let points: Vec<&Judged> = points.into_iter().collect();
    let words = |point: &&Judged| point.doubts.iter().map(|doubt| doubt.word()).collect();
    let doubts = points.iter().map(words).collect();
    let [steps, dofs] = [|p: &Judged| p.step, |p: &Judged| p.dofs].map(|of| points.iter().map(|p| of(p)).collect());
    Table::digits("step", points, &NUMBERS)
        .words("doubts", "why the uncertainty is not to be trusted; empty if it is", doubts)
        .counts("dofs", "displacement unknowns", dofs)
        .counts("step", "the step, from 0", steps)
}

/// Shares of those without doubts, of those in doubt, and of the first by kinds.
fn groups(study: &QuantityStudy<'_>) -> Vec<(String, Shares)> {
    let points = |is: &dyn Fn(&Series) -> bool, in_doubt: bool| {
        let chosen = study.series.iter().filter(|series| is(series)).flat_map(|series| &series.points);
        Shares::new(chosen.filter(|point| point.doubts.is_empty() != in_doubt))
    };
    let mut kinds: Vec<String> = study.series.iter().map(Series::kind).collect();
    kinds.dedup();
    let mut groups =
        vec![("without doubts".to_owned(), points(&|_| true, false)), ("in doubt".to_owned(), points(&|_| true, true))];
    groups.extend(kinds.into_iter().map(|kind| {
        let shares = points(&|series| series.kind() == kind, false);
        (kind, shares)
    }));
    groups
}

/// The printed numbers of shares.
const SHOWN: [Shown<(String, Shares)>; 8] = [
    ("count", 6, |(_, s)| s.count.to_string()),
    ("median", 7, |(_, s)| show::number(s.median, |v| format!("{v:.2}"))),
    ("least", 6, |(_, s)| show::number(s.least, |v| format!("{v:.2}"))),
    (">= .5", 6, |(_, s)| per_cent(s.above[0])),
    (">= .3", 6, |(_, s)| per_cent(s.above[1])),
    (">= .1", 6, |(_, s)| per_cent(s.above[2])),
    ("<= 4", 6, |(_, s)| per_cent(s.below[0])),
    ("<= 10", 6, |(_, s)| per_cent(s.below[1])),
];

fn per_cent(part: f64) -> String {
    show::number(part, |part| format!("{:.1} %", 100.0 * part))
}

/// The printed numbers of a quantity at its last step.
const LAST: [Shown<Judged>; 5] = [
    ("dofs", 6, |j| j.dofs.to_string()),
    ("value", 16, |j| format!("{:.9e}", j.value)),
    ("uncertainty", 11, |j| format!("{:.1e}", j.uncertainty)),
    ("error", 9, |j| format!("{:.1e}", j.error)),
    ("ratio", 7, |j| show::number(j.effectivity, |v| format!("{v:.2}"))),
];

/// Shares by kinds, and each quantity at the last step at which its error is known.
fn body(study: &QuantityStudy<'_>) -> String {
    let mut text = show::head(study.source, None);
    let Some(estimate) = study.reference.estimate_relative else { return text };
    let _ = writeln!(text, "reference   {} dofs, estimated error {estimate:.1e}\n", study.reference.dofs);
    let groups = groups(study);
    if groups[..2].iter().all(|(_, shares)| shares.count == 0) {
        text += "no error is above 20 bars of the reference and 1e-9 of its value: there is nothing to judge\n\n";
    }
    let widest = |names: &mut dyn Iterator<Item = usize>| names.fold(26, usize::max);
    let width = widest(&mut groups.iter().map(|(name, _)| name.chars().count()));
    heads(&mut text, ("uncertainty over true error", width), &SHOWN);
    for group in &groups {
        show::rows(&mut text, (&group.0, width), &SHOWN, std::iter::once(group));
    }
    let width = widest(&mut study.series.iter().map(|series| series.path.chars().count()));
    text += "\n";
    heads(&mut text, ("last step of a known error", width), &LAST);
    for Series { path, points } in &study.series {
        let known = points.iter().rev().find(|point| point.effectivity.is_finite());
        let Some(last) = known.or(points.last()) else { continue };
        let mut row = String::new();
        show::rows(&mut row, (path, width), &LAST, std::iter::once(last));
        let doubts: String = last.doubts.iter().map(|doubt| format!(" {}", doubt.word())).collect();
        let _ = writeln!(text, "{}{doubts}", row.trim_end());
    }
    if let Some(failure) = &study.failure {
        let _ = writeln!(text, "FAILED: {failure}");
    }
    text
}
