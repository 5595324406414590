//! The page: one file that loads nothing.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment, context};
use serde::Serialize;

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

/// The page of these figures, whose runs took so many seconds in all.
pub(crate) fn page(all: &[Drawn], total: f64) -> Result<String, minijinja::Error> {
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    let cards: Vec<Card<'_>> = all.iter().map(card).collect();
    let failing = cards.iter().any(|card| card.failing);
    environment.render_named_str(
        "page.html",
        TEMPLATE,
        context! {
            title => TITLE, cards => Serde(&cards), failing, seconds => seconds(total),
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

/// A picture inside of the page: vectors of charts, pixels of fields.
fn image(shown: &Shown) -> Image<'_> {
    let (kind, bytes) = match shown.is_field {
        true => ("png", shown.picture.png.as_slice()),
        false => ("svg+xml", shown.picture.svg.as_bytes()),
    };
    Image { source: format!("data:image/{kind};base64,{}", STANDARD.encode(bytes)), alternative: &shown.alternative }
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

/// A number with eight digits at most.
pub(crate) fn shown(value: f64) -> String {
    if !value.is_finite() {
        return "unknown".into();
    }
    if value != 0.0 && !(1e-4..1e7).contains(&value.abs()) {
        let text = format!("{value:.3e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}·10{}", trimmed(mantissa), exponent.chars().map(raised).collect::<String>());
    }
    let digits = (7 - value.abs().max(1e-4).log10().floor() as i32).clamp(0, 9) as usize;
    trimmed(&format!("{value:.digits$}")).to_owned()
}

/// Without zeros at the end of its decimals.
fn trimmed(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// A digit or sign of an exponent.
fn raised(sign: char) -> char {
    let digit = sign.to_digit(10).and_then(|digit| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(digit as usize));
    digit.unwrap_or('⁻')
}

/// Seconds to a tenth.
fn seconds(value: f64) -> String {
    format!("{value:.1}")
}

#[cfg(test)]
mod tests {
    use super::shown;

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (-2.993_329_193_070_8, "-2.9933292"),
            (40.0 / 3.0, "13.333333"),
            (100.0, "100"),
            (0.05, "0.05"),
            (2e-5, "2·10⁻⁵"),
            (-1.25e12, "-1.25·10¹²"),
            (f64::NAN, "unknown"),
        ] {
            assert_eq!(shown(value), text);
        }
    }
}
