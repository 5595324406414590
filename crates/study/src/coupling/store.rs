//! The study as one HDF5 file.
//!
//! ```text
//! /pairs          columns with an entry a pair of materials
//! /forms/NNN      `name`; columns with an entry a grid of a pair
//! /effectivity    columns with an entry a form on a grid of a pair
//! /contrast       the same for the scene's pair with other moduli of the body
//! /cost           columns with an entry a grid
//! /conditioning   columns with an entry a grid of a pair
//! /wrong_signs    columns with an entry a system on a grid
//! ```

use steklov_io::{File, IoError, create_group, save_text, save_texts, write_integer_attribute, write_text_attribute};

use super::conditioning::CONDITIONS;
use super::convergence::{FORMS, POINTS};
use super::cost::COSTS;
use super::effectivity::INDICATORS;
use super::table::of_form;
use super::wrong::WRONG;
use super::{CouplingStudy, Pair, columns, json};
use crate::columns::Column;

/// Columns of the pairs.
const PAIRS: [Column<Pair>; 4] = [
    ("body_young", "stress", "Young's modulus of the body", |p| p.body.young),
    ("body_poisson", "1", "Poisson's ratio of the body", |p| p.body.poisson),
    ("medium_young", "stress", "Young's modulus of the medium", |p| p.medium.young),
    ("medium_poisson", "1", "Poisson's ratio of the medium", |p| p.medium.poisson),
];

/// Writes the study into a new file.
///
/// # Errors
/// When the file cannot be written.
pub fn write(file: &File, study: &CouplingStudy<'_>) -> Result<(), IoError> {
    write_text_attribute(file, "program", concat!("steklov ", env!("CARGO_PKG_VERSION")))?;
    write_text_attribute(file, "content", "study: coupling")?;
    write_integer_attribute(file, "threads", &[rayon::current_num_threads() as i64])?;
    let source = study.source;
    save_text(file, "scene", &source.text, "text of the scene file")?;
    save_texts(file, "overrides", &source.overrides, "settings of the study and the user, KEY=VALUE", "override")?;
    save_text(file, "summary", &json(study).to_string(), "the JSON object of study --json, without its list of files")?;
    columns::save(&create_group(file, "pairs")?, study.pairs, &PAIRS, "pair")?;
    let at = create_group(file, "forms")?;
    for (k, (name, _)) in FORMS.iter().enumerate() {
        let at = create_group(&at, &format!("{k:03}"))?;
        save_text(&at, "name", name, "the form of the equations")?;
        columns::save(&at, &of_form(study, k), &POINTS, "grid of a pair")?;
    }
    let (grids, contrasts) = (&study.effectivity.grids, &study.effectivity.contrasts);
    columns::save(&create_group(file, "effectivity")?, grids, &INDICATORS, "form on a grid of a pair")?;
    columns::save(&create_group(file, "contrast")?, contrasts, &INDICATORS, "form at a contrast")?;
    columns::save(&create_group(file, "cost")?, &study.costs.points, &COSTS, "grid")?;
    columns::save(&create_group(file, "conditioning")?, &study.conditioning.points, &CONDITIONS, "grid of a pair")?;
    columns::save(&create_group(file, "wrong_signs")?, &study.wrongs.points, &WRONG, "system on a grid")
}
