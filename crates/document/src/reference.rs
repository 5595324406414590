//! The keys of scenes as a page.

use super::form::{Fallback, Form, Key, Range, Table, Whole};
use super::keys;

/// Every key of a scene as Markdown: a section for each table, with the values, default, unit and meaning of each key.
///
/// ```
/// let reference = steklov_document::reference();
/// assert!(reference.contains("\n## method\n") && reference.contains("| `tolerance` |"));
/// ```
pub fn reference() -> String {
    let mut page = "# Keys of scenes\n\nA scene is TOML. An *expression* is a text of x, y, s, pi, parameters and random names; where one may \
                    stand, a number may stand too. A *number*, also a coordinate, may be the text of an expression of parameters, as \"R/2\", \
                    where no words may stand. Units are any consistent ones; everything is per unit thickness. Other keys than these \
                    are errors. `steklov_document::reference` makes this page from the keys that are read.\n"
        .to_owned();
    for table in keys::SCENE.all() {
        page += &section(table);
    }
    page
}

fn section(table: &Table) -> String {
    let mut text = format!("\n## {}\n\n{}\n\n", table.name, table.what);
    text += "| key | values | default | unit | meaning |\n|---|---|---|---|---|\n";
    for key in table.keys.iter().filter(|key| !matches!(key.form, Form::Refused)) {
        let Key { name, what, unit, .. } = key;
        text += &format!("| `{name}` | {} | {} | {unit} | {what} |\n", values(&key.form), default(&key.default));
    }
    if let Some((form, what)) = &table.names {
        text += &format!("| a name | {} |  |  | {what} |\n", values(form));
    }
    text
}

fn default(default: &Fallback) -> String {
    match default {
        Fallback::Required => "required".to_owned(),
        Fallback::Value(value) => format!("`{}`", value()),
        Fallback::Said(said) => (*said).to_owned(),
    }
}

fn values(form: &Form) -> String {
    match form {
        Form::Number(range) => number(range),
        Form::Whole(Whole(least, most)) if *most == keys::NATURAL.1 => format!("whole number ≥ {least}"),
        Form::Whole(Whole(least, most)) => format!("whole number from {least} to {most}"),
        Form::Text => "text".to_owned(),
        Form::Flag => "`true` or `false`".to_owned(),
        Form::True => "`true`".to_owned(),
        Form::Expression(range) => match number(range) {
            plain if plain == "number" => "expression".to_owned(),
            number => format!("expression; a {number}"),
        },
        Form::Words(words) => words.iter().map(|word| format!("`{word:?}`")).collect::<Vec<_>>().join(", "),
        Form::Point => "`[x, y]`".to_owned(),
        Form::List(Form::Table(of), _) => format!("list of tables {}", link(of)),
        Form::List(of, Some(count)) => format!("list of {count}: {}", values(of)),
        Form::List(of, None) => format!("list of: {}", values(of)),
        Form::Table(of) => format!("table {}", link(of)),
        Form::OneOf(forms) => forms.iter().map(values).collect::<Vec<_>>().join("; or "),
        Form::Refused => String::new(),
    }
}

/// A link to the section of a table.
fn link(table: &Table) -> String {
    let kept = table.name.to_lowercase();
    let kept = kept.chars().filter(|c| c.is_ascii_alphanumeric() || "_- ".contains(*c));
    let anchor: String = kept.map(|c| if c == ' ' { '-' } else { c }).collect();
    format!("[{}](#{anchor})", table.name)
}

fn number(range: &Range) -> String {
    let [low, high] = range.closed;
    let bounds = [(range.low, if low { "≥" } else { ">" }), (range.high, if high { "≤" } else { "<" })];
    let bounds: Vec<String> =
        bounds.iter().filter(|(v, _)| v.is_finite()).map(|(v, sign)| format!("{sign} {v}")).collect();
    ["number".to_owned(), bounds.join(" and ")].join(" ").trim_end().to_owned()
}
