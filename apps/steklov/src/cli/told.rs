//! What is told on stdout: the summary of a result, or its numbers as JSON or as a table of a document; and what is legal in a
//! scene, and hardly meant.

use clap::ValueEnum;
use steklov_document::STOCHASTIC;
use steklov_problem::{Law, Scene};
use steklov_report::format::{Format, numbers_table};
use steklov_report::summary;
use steklov_result::record::Record;

use super::failure::{Failure, say};

/// Coefficient of friction beyond those of all known materials.
const ROUGHEST: f64 = 5.0;

/// The format of tables on stdout.
#[derive(Clone, Copy, ValueEnum)]
pub(super) enum TableFormat {
    /// A table of Markdown
    Markdown,
    /// A tabular of LaTeX
    Latex,
}

impl TableFormat {
    /// That of the library.
    pub(super) fn format(self) -> Format {
        match self {
            Self::Markdown => Format::Markdown,
            Self::Latex => Format::Latex,
        }
    }
}

/// Prints the numbers of a result: as JSON, as a table, or as a summary, after which `more` is told.
pub(super) fn say_result(
    stored: &Record,
    json: bool,
    format: Option<TableFormat>,
    more: impl Iterator<Item = String>,
) -> Result<(), Failure> {
    match (json, format) {
        (true, _) => say(&serde_json::to_string_pretty(&stored.summary)?),
        (false, Some(format)) => say(numbers_table(stored, format.format()).trim_end()),
        (false, None) => summary::lines(stored).into_iter().chain(more).for_each(|line| say(&line)),
    }
    Ok(())
}

/// What is legal in a scene, and hardly meant.
pub(super) fn cautions(scene: &Scene) -> Vec<String> {
    let is_random = |name: &&String| !scene.parameters.contains_key(*name);
    let (tables, names): (Vec<_>, Vec<_>) = scene.unused.iter().filter(is_random).partition(|name| *name == STOCHASTIC);
    let mut told = Vec::new();
    if !names.is_empty() {
        let names = names.into_iter().map(String::as_str).collect::<Vec<_>>().join(", ");
        told.push(format!(
            "no datum uses the random {names}, which has no effect: write the name where it belongs, as in young = \"NAME\""
        ));
    }
    if !tables.is_empty() {
        told.push(format!(
            "nothing is random, so that {STOCHASTIC} has no effect: declare names in [random] and use them"
        ));
    }
    let laws = scene.problem.interfaces().iter().filter_map(|interface| match &interface.law {
        Law::Contact(contact) => contact.friction.coefficient()?.constant(),
        Law::Tied(_) => None,
    });
    if let Some(coefficient) = laws.filter(|c| *c > ROUGHEST).max_by(f64::total_cmp) {
        told.push(format!(
            "a friction coefficient of {coefficient} is larger than any known one: it is the tangent of the angle of friction, \
             for degrees coulomb = \"tan({coefficient}*pi/180)\""
        ));
    }
    told
}
