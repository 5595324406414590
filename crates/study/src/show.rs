//! Parts of printed text.

use std::fmt::Write as _;

use steklov_document::Source;

/// A number, or a dash if it is unknown.
pub(crate) fn number(value: f64, show: impl FnOnce(f64) -> String) -> String {
    if value.is_finite() { show(value) } else { "-".into() }
}

/// A name of this width, followed by cells of nine characters.
pub(crate) fn line(text: &mut String, (name, width): (&str, usize), cells: impl Iterator<Item = String>) {
    let cells: String = cells.map(|cell| format!(" {cell:>9}")).collect();
    let _ = writeln!(text, "{name:<width$}{cells}");
}

/// The settings of the study and of the user, `KEY=VALUE`.
pub(crate) fn settings(source: &Source) -> Vec<String> {
    [&source.settings[..], &source.overrides].concat()
}

/// The settings of a study, and a note for the reader of the results.
pub(crate) fn head(source: &Source, note: Option<&str>) -> String {
    let note = note.map_or(String::new(), |note| format!("note        {note}\n"));
    let all = settings(source).join(", ");
    let all = if all.is_empty() { "those of the scene" } else { &all };
    format!("settings    {all} (--set changes them)\n{note}")
}

/// The failures, each with its reason.
pub(crate) fn failures<'f>(text: &mut String, all: impl Iterator<Item = &'f (String, String)>) {
    for (at, why) in all {
        let _ = writeln!(text, "FAILED at {at}: {why}");
    }
}

/// Numbers of cells along x and y.
pub(crate) fn cells([x, y]: [usize; 2]) -> String {
    format!("{x}x{y}")
}

/// The number of runs in words.
pub(crate) fn runs(repeat: usize) -> String {
    if repeat > 1 { format!("median of {repeat} runs") } else { "one run".into() }
}

/// A column of a printed table: its head, its width, the text of a row.
pub(crate) type Shown<T> = (&'static str, usize, fn(&T) -> String);

/// The heads of a table; the first is left-aligned.
pub(crate) fn heads<T>(text: &mut String, (first, width): (&str, usize), columns: &[Shown<T>]) {
    let cells: String = columns.iter().map(|(head, width, _)| format!(" {head:>width$}")).collect();
    let _ = writeln!(text, "{first:<width$}{cells}");
}

/// Rows of a table, with their common name in front of the first.
pub(crate) fn rows<'r, T: 'r>(
    text: &mut String,
    (mut name, width): (&str, usize),
    columns: &[Shown<T>],
    rows: impl Iterator<Item = &'r T>,
) {
    for row in rows {
        let cells: String = columns.iter().map(|(_, width, show)| format!(" {:>width$}", show(row))).collect();
        let _ = writeln!(text, "{name:<width$}{cells}");
        name = "";
    }
}
