//! `[units]`: the names of the units of the scene.

use steklov_problem::Units;

use super::error::ReadError;
use super::fields::{Field, Fields};
use super::keys;

/// Reads `[units]`.
pub(super) fn units(field: &Field<'_>) -> Result<Units, ReadError> {
    let fields = Fields::new(field, &keys::UNITS)?;
    let name = |key: &str| -> Result<Option<String>, ReadError> {
        let Some(field) = fields.get(key) else { return Ok(None) };
        let name = field.text()?.trim();
        match name.is_empty() {
            true => Err(field.problem(format!("{} is empty", field.name), "name the unit, or remove the key")),
            false => Ok(Some(name.to_owned())),
        }
    };
    Ok(Units { length: name("length")?, stress: name("stress")? })
}
