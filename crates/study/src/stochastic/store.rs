//! The study as one HDF5 file.
//!
//! ```text
//! /chance              `quantities` (names), `reference`; columns with an entry a quantity
//!   /QQQ/RRR           `rule`; columns of quantity QQQ with an entry a rule of family RRR
//! /space/NNN           `name`; columns with an entry a mesh
//! /solvers/NNN         `name`; columns with an entry a mesh; `history`: the measure by iteration on the finest mesh
//! ```

use steklov_io::{
    File, IoError, Label, create_group, save_text, save_texts, save_vector, write_integer_attribute,
    write_text_attribute,
};

use super::chance::{Measured, QUANTITIES, RULES};
use super::rules::FAMILIES;
use super::solvers::{METHODS, Method, SOLVERS};
use super::space::{CURVES, POINTS, Point};
use super::{Stochastic, columns, json};

/// Writes the study into a new file.
///
/// # Errors
/// When the file cannot be written.
pub fn write(file: &File, study: &Stochastic<'_>) -> Result<(), IoError> {
    write_text_attribute(file, "program", concat!("steklov ", env!("CARGO_PKG_VERSION")))?;
    write_text_attribute(file, "content", "study: random input")?;
    write_integer_attribute(file, "threads", &[rayon::current_num_threads() as i64])?;
    let source = study.source;
    save_text(file, "scene", &source.text, "text of the scene file")?;
    save_texts(file, "overrides", &source.overrides, "settings of the study and of the user, KEY=VALUE", "override")?;
    save_text(file, "summary", &json(study).to_string(), "the JSON object of study --json, without its list of files")?;

    let (at, chance) = (create_group(file, "chance")?, study.chance);
    let names: Vec<String> = chance.quantities.iter().map(|q| q.name.clone()).collect();
    save_texts(&at, "quantities", &names, "paths of the JSON object", "quantity")?;
    save_text(&at, "reference", &chance.reference, "the rule that errors are measured against")?;
    columns::save(&at, &chance.quantities, &QUANTITIES, "quantity")?;
    for k in 0..names.len() {
        let at = create_group(&at, &format!("{k:03}"))?;
        for (f, (name, _)) in FAMILIES.iter().enumerate() {
            let at = create_group(&at, &format!("{f:03}"))?;
            save_text(&at, "rule", name, "the family of rules")?;
            let rows: Vec<Measured> = chance.of(f, k).copied().collect();
            columns::save(&at, &rows, &RULES, "rule")?;
        }
    }
    let at = create_group(file, "space")?;
    for (k, (name, ..)) in CURVES.iter().enumerate() {
        let at = create_group(&at, &format!("{k:03}"))?;
        save_text(&at, "name", name, "strategy in space and rule in chance")?;
        let rows: Vec<Point> = study.space.of(k).copied().collect();
        columns::save(&at, &rows, &POINTS, "mesh")?;
    }
    let Some(solvers) = study.solvers else { return Ok(()) };
    let at = create_group(file, "solvers")?;
    for (k, (name, _)) in SOLVERS.iter().enumerate() {
        let at = create_group(&at, &format!("{k:03}"))?;
        save_text(&at, "name", name, "the solver")?;
        let rows: Vec<Method> = solvers.of(k).cloned().collect();
        columns::save(&at, &rows, &METHODS, "mesh")?;
        let history = solvers.finest().find(|m| m.solver == k).map_or(&[][..], |m| &m.history);
        let meaning = "the solver's own relative measure on the finest mesh";
        save_vector(&at, "history", history, &Label { unit: "1", meaning, axes: &["iteration"] })?;
    }
    Ok(())
}
