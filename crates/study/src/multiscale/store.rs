//! The study as one HDF5 file.
//!
//! ```text
//! /fine_grid      `source`, `limit`, `rate` (if known); columns with an entry a grid
//! /bases/NNN      `name`; columns with an entry a coarse grid
//! /laminates      `text` of the scene; columns with an entry a basis on a coarse grid
//! /contrast       `text` of the scene; columns with an entry a basis at a contrast
//! ```

use steklov_io::{
    File, IoError, create_group, save_number, save_text, save_texts, write_integer_attribute, write_text_attribute,
};

use super::contrast::STIFF;
use super::convergence::{POINTS, Point};
use super::fine_grid::LEVELS;
use super::laminates::LAYERS;
use super::measure::BASES;
use super::plate::{PLATE, SQUARE};
use super::{MultiscaleStudy, columns, json};

/// Writes the study into a new file.
///
/// # Errors
/// When the file cannot be written.
pub fn write(file: &File, study: &MultiscaleStudy<'_>) -> Result<(), IoError> {
    write_text_attribute(file, "program", concat!("steklov ", env!("CARGO_PKG_VERSION")))?;
    write_text_attribute(file, "content", "study: multiscale elements")?;
    write_integer_attribute(file, "threads", &[rayon::current_num_threads() as i64])?;
    let source = study.source;
    save_text(file, "scene", &source.text, "text of the scene file")?;
    save_texts(file, "overrides", &source.overrides, "settings of the user, KEY=VALUE", "override")?;
    save_text(file, "summary", &json(study).to_string(), "the JSON object of study --json, without its list of files")?;

    let (at, fine) = (create_group(file, "fine_grid")?, study.fine_grid);
    save_text(&at, "source", fine.source(), "where the error of the fine grid comes from")?;
    if let Some([limit, rate]) = fine.limit {
        save_number(&at, "limit", limit, "force*length/thickness", "J as the cells become small")?;
        save_number(&at, "rate", rate, "1", "r in J_h - J = C h^r")?;
    }
    columns::save(&at, &fine.levels, &LEVELS, "grid")?;
    let at = create_group(file, "bases")?;
    for (k, (name, _)) in BASES.iter().enumerate() {
        let at = create_group(&at, &format!("{k:03}"))?;
        save_text(&at, "name", name, "the basis, as scenes name it")?;
        let rows: Vec<Point> = study.convergence.of(k).copied().collect();
        columns::save(&at, &rows, &POINTS, "coarse grid")?;
    }
    let at = create_group(file, "laminates")?;
    save_text(
        &at,
        "text",
        SQUARE,
        "text of the scene; LAYERS stands for an expression that is positive in stiff layers",
    )?;
    columns::save(&at, &study.laminates.points, &LAYERS, "basis on a coarse grid")?;
    let at = create_group(file, "contrast")?;
    save_text(&at, "text", PLATE, "text of the scene; STIFF stands for an expression that is positive in stiff parts")?;
    columns::save(&at, &study.contrast.points, &STIFF, "basis at a contrast")?;
    Ok(())
}
