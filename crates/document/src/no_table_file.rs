//! Moduli and ratios of cells from HDF5 files, in a build that reads none.

use steklov_problem::{CellModuli, DataErrorKind};

use super::error::ReadError;
use super::fields::Field;
use super::source::Source;

/// Refuses the file.
pub(super) fn from_file(
    (file, ..): (&Field<'_>, &Field<'_>, Option<Field<'_>>),
    _: (Option<[usize; 2]>, f64),
    _: &Source,
) -> Result<CellModuli, ReadError> {
    let message = format!("{} names an HDF5 file, and this build reads none", file.name);
    let help =
        "write an expression or { uniform = [low, high], seed = 1 }, or solve the scene by the command `steklov`";
    Err(ReadError::new(DataErrorKind::Unsupported, file.item.place, message, help))
}
