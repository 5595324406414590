//! The study as one HDF5 file.
//!
//! ```text
//! /incompressible/references, points   columns with an entry a ratio, or a mesh at a ratio
//! /incompressible/beside/NNN           `name`, and columns with an entry a ratio
//! /single_layer                        `degenerate`, `diameter`; points: columns with an entry a size
//! /stabilisation/critical, errors      columns with an entry a mesh, or a γ₀ on a mesh; not without contact
//! ```

use steklov_io::{
    File, IoError, Label, create_group, save_number, save_text, save_texts, save_vector, write_integer_attribute,
    write_text_attribute,
};

use super::beside::{RESULTS, judged};
use super::incompressible::{POINTS, TRUTHS};
use super::single_layer::SPECTRA;
use super::stabilisation::{CRITICAL, ERRORS};
use super::{Stability, columns, json};

/// Writes the study into a new file.
///
/// # Errors
/// When the file cannot be written.
pub fn write(file: &File, study: &Stability<'_>) -> Result<(), IoError> {
    write_text_attribute(file, "program", concat!("steklov ", env!("CARGO_PKG_VERSION")))?;
    write_text_attribute(file, "content", "study: stability")?;
    write_integer_attribute(file, "threads", &[rayon::current_num_threads() as i64])?;
    let source = study.source;
    save_text(file, "scene", &source.text, "text of the scene file")?;
    save_texts(file, "overrides", &source.overrides, "settings of the study and of the user, KEY=VALUE", "override")?;
    save_text(file, "summary", &json(study).to_string(), "the JSON object of study --json, without its list of files")?;

    let at = create_group(file, "incompressible")?;
    let all = study.incompressible;
    columns::save(&create_group(&at, "references")?, &all.truths, &TRUTHS, "ratio")?;
    columns::save(&create_group(&at, "points")?, &all.points, &POINTS, "mesh at a ratio")?;
    let beside = create_group(&at, "beside")?;
    for (k, (name, rows)) in judged(study.beside, &all.truths).iter().enumerate() {
        let at = create_group(&beside, &format!("{k:03}"))?;
        save_text(&at, "name", name, "the other method and its mesh")?;
        columns::save(&at, rows, &RESULTS, "ratio")?;
    }

    let at = create_group(file, "single_layer")?;
    let layer = study.single_layer;
    let meaning = "diameters of bodies of this shape at which V is singular for L = 1";
    save_vector(&at, "degenerate", &layer.degenerate, &Label { unit: "length", meaning, axes: &["eigenvalue"] })?;
    save_number(&at, "diameter", layer.diameter, "length", "diameter of the scene's body")?;
    columns::save(&create_group(&at, "points")?, &layer.points, &SPECTRA, "size")?;

    if let Some(all) = study.stabilisation {
        let at = create_group(file, "stabilisation")?;
        columns::save(&create_group(&at, "critical")?, &all.critical, &CRITICAL, "mesh")?;
        columns::save(&create_group(&at, "errors")?, &all.errors, &ERRORS, "gamma on a mesh")?;
    }
    Ok(())
}
