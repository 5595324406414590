//! Tables in the formats of documents.

use std::fmt::Write as _;

use steklov_picture::plain;
use steklov_result::record::Record;

use crate::numbers::{self, DIGITS, beside, number};

/// The format of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// A table of Markdown, with pipes.
    Markdown,
    /// A `tabular` of LaTeX, which needs no package.
    Latex,
}

/// A part of a cell: words, or a number with its digits.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Piece {
    Words(String),
    Number(f64, usize),
    /// A component of a vector, and the largest one of it.
    Component(f64, f64),
}

/// Letters that LaTeX does not take as they are, and those that need mathematics.
const LATEX: [(char, &str); 26] = [
    ('\\', r"\textbackslash{}"),
    ('&', r"\&"),
    ('%', r"\%"),
    ('$', r"\$"),
    ('#', r"\#"),
    ('_', r"\_"),
    ('{', r"\{"),
    ('}', r"\}"),
    ('~', r"\textasciitilde{}"),
    ('^', r"\textasciicircum{}"),
    ('<', "$<$"),
    ('>', "$>$"),
    ('|', "$|$"),
    ('±', r"$\pm$"),
    ('×', r"$\times$"),
    ('·', r"$\cdot$"),
    ('−', "$-$"),
    ('°', r"$^\circ$"),
    ('½', r"$\frac12$"),
    ('²', "$^2$"),
    ('₀', "$_0$"),
    ('γ', r"$\gamma$"),
    ('μ', r"$\mu$"),
    ('σ', r"$\sigma$"),
    ('λ', r"$\lambda$"),
    ('ν', r"$\nu$"),
];

impl Format {
    fn words(self, text: &str) -> String {
        match self {
            Self::Markdown => text.replace('\\', r"\\").replace('|', r"\|"),
            Self::Latex => {
                let text = text.replace("^½", "^(1/2)");
                let replaced = |letter: char| LATEX.iter().find(|(of, _)| *of == letter).map(|(_, by)| *by);
                text.chars().fold(String::new(), |mut all, letter| {
                    match replaced(letter) {
                        Some(by) => all.push_str(by),
                        None => all.push(letter),
                    }
                    all
                })
            }
        }
    }

    fn number(self, value: f64, digits: usize) -> String {
        let text = plain(value, digits);
        match (self, text.split_once('e')) {
            (Self::Markdown, _) => text,
            (Self::Latex, _) if !value.is_finite() => self.words(&text),
            (Self::Latex, None) => format!("${text}$"),
            (Self::Latex, Some((mantissa, exponent))) => format!(r"${mantissa}\cdot10^{{{exponent}}}$"),
        }
    }

    fn cell(self, pieces: &[Piece]) -> String {
        let written = |piece: &Piece| match piece {
            Piece::Words(text) => self.words(text),
            Piece::Number(value, digits) => self.number(*value, *digits),
            Piece::Component(value, largest) => self.number(beside(*value, *largest), DIGITS),
        };
        pieces.iter().map(written).collect()
    }

    /// A table of cells that are written already.
    fn table(self, head: &[String], rows: &[Vec<String>]) -> String {
        let mut text = String::new();
        match self {
            Self::Markdown => {
                let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
                text += &line(head);
                text += &line(&vec!["---".to_owned(); head.len()]);
                rows.iter().for_each(|row| text += &line(row));
            }
            Self::Latex => {
                let _ = writeln!(text, r"\begin{{tabular}}{{{}}}", "l".repeat(head.len()));
                text += "\\hline\n";
                let _ = writeln!(text, r"{} \\ \hline", head.join(" & "));
                rows.iter().for_each(|row| text += &format!("{} \\\\\n", row.join(" & ")));
                text += "\\hline\n\\end{tabular}\n";
            }
        }
        text
    }
}

/// A cell in HTML, its numbers with all their digits for programs.
pub(crate) fn html(pieces: &[Piece]) -> String {
    let written = |piece: &Piece| match piece {
        Piece::Words(text) => text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;"),
        Piece::Number(value, digits) => number(*value, *digits),
        Piece::Component(value, _) => number(*value, DIGITS),
    };
    pieces.iter().map(written).collect()
}

/// The numbers of a result as a table: what it is, value, unit if units have names, what is known of the error.
pub fn numbers_table(stored: &Record, format: Format) -> String {
    let units = &stored.summary.units;
    let mut head = vec!["number", "value", "unit", "what is known of its error"];
    if units.are_unknown() {
        head.remove(2);
    }
    let rows = numbers::all(stored).into_iter().map(|row| {
        let mut cells = vec![format.words(&row.what), format.cell(&row.value)];
        if !units.are_unknown() {
            cells.push(row.unit.name(units).map_or(String::new(), |unit| format.words(&unit)));
        }
        cells.push(format.cell(&row.error));
        cells
    });
    let head: Vec<String> = head.into_iter().map(|word| format.words(word)).collect();
    format.table(&head, &rows.collect::<Vec<_>>())
}

/// A table of a study, given as CSV: numbers with seven digits, words as they are.
///
/// # Errors
/// What is no CSV.
pub fn csv_table(csv: &str, format: Format) -> Result<String, csv::Error> {
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let head: Vec<String> = reader.headers()?.iter().map(|word| format.words(&word.replace('_', " "))).collect();
    let cell = |text: &str| match text.parse::<f64>() {
        Ok(value) => format.number(value, DIGITS),
        Err(_) => format.words(text),
    };
    let rows = reader.records().map(|record| record.map(|record| record.iter().map(cell).collect()));
    Ok(format.table(&head, &rows.collect::<Result<Vec<_>, _>>()?))
}
