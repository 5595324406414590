//! The page: one file that loads nothing.

use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment, context};
use serde::Serialize;
use steklov_picture::{STYLE, data_uri, short};

use crate::figure::{Expected, Row, Shown, Verdict};
use crate::{Drawn, TITLE};

const TEMPLATE: &str = include_str!("page.html");

#[derive(Serialize)]
struct Card<'a> {
    name: &'a str,
    number: &'a str,
    title: &'a str,
    verdict: &'a str,
    meaning: &'a str,
    failing: bool,
    missing: Option<&'a str>,
    set_up: &'a str,
    seen: &'a str,
    left_open: &'a str,
    differs: &'a [&'a str],
    pictures: Vec<Image<'a>>,
    rows: Vec<Line<'a>>,
    has_source: bool,
    commands: Vec<String>,
    seconds: String,
}

#[derive(Serialize)]
struct Image<'a> {
    source: String,
    alternative: &'a str,
}

#[derive(Serialize)]
struct Line<'a> {
    what: &'a str,
    computed: String,
    expected: String,
    source: &'a str,
    verdict: &'a str,
}

/// The page of these figures; all their runs took `total` seconds.
pub(crate) fn page(all: &[Drawn], total: f64) -> Result<String, minijinja::Error> {
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    let cards: Vec<Card<'_>> = all.iter().map(card).collect();
    let failing = cards.iter().any(|card| card.failing);
    environment.render_named_str(
        "page.html",
        TEMPLATE,
        context! {
            title => TITLE, style => STYLE, cards => Serde(&cards), failing, seconds => seconds(total),
            program => concat!("steklov ", env!("CARGO_PKG_VERSION")),
        },
    )
}

fn card(drawn: &Drawn) -> Card<'_> {
    let entry = drawn.entry;
    let rows = &drawn.figure.rows;
    Card {
        name: entry.name,
        number: entry.number,
        title: entry.title,
        verdict: entry.verdict.word(),
        meaning: meaning(entry.verdict),
        failing: !drawn.holds(),
        missing: drawn.missing.as_deref(),
        set_up: entry.set_up,
        seen: entry.seen,
        left_open: entry.left_open,
        differs: entry.differs,
        pictures: drawn.figure.pictures.iter().map(image).collect(),
        rows: rows.iter().map(line).collect(),
        has_source: rows.iter().any(|row| !row.source.is_empty()),
        commands: drawn.commands(),
        seconds: seconds(drawn.seconds),
    }
}

fn meaning(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Same => "all that the source says is seen",
        Verdict::Chosen => "the same, with choices where the source leaves something open",
        Verdict::Differs => "the source is wrong here, or differs",
        Verdict::Own => "a chart that the source does not have",
    }
}

/// A picture inside the page: a chart as vectors, a field as pixels.
fn image(shown: &Shown) -> Image<'_> {
    let source = match shown.is_field {
        true => data_uri("png", &shown.picture.png),
        false => data_uri("svg+xml", &shown.picture.svg),
    };
    Image { source, alternative: &shown.alternative }
}

fn line(row: &Row) -> Line<'_> {
    let expected = match row.expected {
        Expected::About(value, part) => format!("{} ± {} %", shown(value), shown(100.0 * part)),
        Expected::Near(value, 0.0) => shown(value),
        Expected::Near(value, distance) => format!("{} ± {}", shown(value), shown(distance)),
        Expected::Between(low, high) => format!("{} to {}", shown(low), shown(high)),
    };
    let verdict = if row.holds() { "holds" } else { "is off" };
    Line { what: &row.what, computed: shown(row.computed), expected, source: row.source, verdict }
}

/// A number with at most eight digits.
pub(crate) fn shown(value: f64) -> String {
    if value.is_finite() { short(value, 8) } else { "unknown".into() }
}

/// Seconds to a tenth.
fn seconds(value: f64) -> String {
    format!("{value:.1}")
}
