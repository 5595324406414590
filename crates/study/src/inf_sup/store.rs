//! The study as one HDF5 file.
//!
//! ```text
//! /pairs/NNN      `name`, and columns with an entry a mesh
//! /pressure/NNN   `gamma`, `gamma_critical`, and columns with an entry a node of the multipliers
//! ```

use steklov_io::{
    File, IoError, create_group, save_number, save_text, save_texts, write_integer_attribute, write_text_attribute,
};

use super::pairs::{PAIRS, POINTS, Point};
use super::pressure::ROWS;
use super::{InfSup, columns, json};

/// Writes the study into a new file.
///
/// # Errors
/// When the file cannot be written.
pub fn write(file: &File, study: &InfSup<'_>) -> Result<(), IoError> {
    write_text_attribute(file, "program", concat!("steklov ", env!("CARGO_PKG_VERSION")))?;
    write_text_attribute(file, "content", "study: inf-sup constants")?;
    write_integer_attribute(file, "threads", &[rayon::current_num_threads() as i64])?;
    let source = study.source;
    save_text(file, "scene", &source.text, "text of the scene file")?;
    save_texts(file, "overrides", &source.overrides, "settings of the study and of the user, KEY=VALUE", "override")?;
    save_text(file, "summary", &json(study).to_string(), "the JSON object of study --json, without its list of files")?;
    let pairs = create_group(file, "pairs")?;
    for (k, pair) in PAIRS.iter().enumerate() {
        let at = create_group(&pairs, &format!("{k:03}"))?;
        save_text(&at, "name", pair.name, "the multipliers")?;
        let points: Vec<Point> = study.of_pair(k).cloned().collect();
        columns::save(&at, &points, &POINTS, "mesh")?;
    }
    let pressure = create_group(file, "pressure")?;
    for (k, solution) in study.pressures.solutions.iter().enumerate() {
        let at = create_group(&pressure, &format!("{k:03}"))?;
        save_number(&at, "gamma", solution.gamma, "1/stress", "gamma_0 of the stabilisation")?;
        save_number(&at, "gamma_critical", solution.critical, "1/stress", "its critical value on this mesh")?;
        columns::save(&at, &solution.rows, &ROWS, "node of the multipliers")?;
    }
    Ok(())
}
