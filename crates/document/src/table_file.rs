//! Moduli and ratios of cells from HDF5 files.

use std::path::Path;

use steklov_io::{IoError, load_foreign_axes, load_foreign_table};
use steklov_problem::{CellModuli, DataErrorKind, TableOrder};

use super::error::{ReadError, SceneErrorKind as Kind};
use super::fields::Field;
use super::foreign::{HDF5, foreign};
use super::grid::ORDERS;
use super::source::Source;

/// The moduli of a file. Cells that do not fit the body are refused later, by their size.
pub(super) fn from_file(
    (file, dataset, given): (&Field<'_>, &Field<'_>, Option<Field<'_>>),
    (cells, size): (Option<[usize; 2]>, f64),
    source: &Source,
) -> Result<CellModuli, ReadError> {
    let (name, at) = (dataset.text()?, file.text()?);
    let path = Path::new(&source.name).parent().unwrap_or(Path::new("")).join(at);
    let refuse = |e: IoError| {
        let other = || std::fs::read(&path).ok().and_then(|bytes| foreign(&bytes)).filter(|(what, _)| *what != HDF5);
        let (field, why, help) = match &e {
            IoError::Missing { .. } => {
                (dataset, e.to_string(), "name a dataset of the file; `h5ls -r` lists them".to_owned())
            }
            IoError::Mismatch { expected, found, .. } => {
                let fitting = fitting_size(expected, found, size).map(|size| format!("take size = {size}; or "));
                let help = "store one number for each modulus cell, indexed [ix, iy], or [row, column] of an image with \
                            order = \"rows\"";
                (dataset, e.to_string(), fitting.unwrap_or_default() + help)
            }
            _ => match other() {
                Some((what, _)) => (
                    file,
                    format!("{at} is {what}"),
                    format!(
                        "they are read from an HDF5 file: h5py.File(\"young.h5\", \"w\")[{name:?}] = the array of numbers"
                    ),
                ),
                None => (file, e.to_string(), "the path is relative to the folder of the scene".to_owned()),
            },
        };
        ReadError::new(Kind::Read, field.item.place, format!("cannot read the numbers of the cells: {why}"), help)
    };
    let given = given.map(|field| field.choice(&ORDERS).map(|order| (order, field))).transpose()?;
    let axes = load_foreign_axes(&path, name).map_err(refuse)?;
    let named = axes.as_ref().and_then(|axes| order_of(axes));
    let order = match (given, named) {
        (Some((order, field)), Some(other)) if order != other => {
            let message =
                format!("{} is another one than that of the attribute axes of {name} of {at}: {axes:?}", field.name);
            return Err(ReadError::new(
                DataErrorKind::Conflict,
                field.item.place,
                message,
                "remove it, or correct the attribute",
            ));
        }
        (given, named) => given.map(|(order, _)| order).or(named).unwrap_or(TableOrder::Xy),
    };
    let values = match cells {
        None => Vec::new(),
        Some(cells) => {
            let [nx, ny] = cells;
            let stored = load_foreign_table(&path, name, order.shape(cells)).map_err(refuse)?;
            let [_, columns] = order.shape(cells);
            let entry = |cell: usize| {
                let [i, j] = order.entry([cell / ny, cell % ny], cells);
                stored[i * columns + j]
            };
            (0..nx * ny).map(entry).collect()
        }
    };
    Ok(CellModuli::Table { values: values.into(), order, source: format!("{name} of {at}") })
}

/// The cell size at which a table of the shape `found` covers the body; `expected` is the shape for cells of size
/// `size`.
fn fitting_size(expected: &str, found: &str, size: f64) -> Option<f64> {
    let counts = |text: &str| -> Option<[f64; 2]> {
        let (x, y) = text.split_once(" by ")?;
        let leading = |text: &str| text.split(|c: char| !c.is_ascii_digit()).next().and_then(|n| n.parse().ok());
        Some([leading(x)?, leading(y)?])
    };
    let ([nx, ny], [mx, my]) = (counts(expected)?, counts(found)?);
    (nx * my == ny * mx && mx > 0.0).then(|| size * nx / mx)
}

/// The order that the names of the axes of a table mean, or one word for both axes; None if they mean no order.
fn order_of(axes: &[String]) -> Option<TableOrder> {
    let lower: Vec<String> = axes.iter().map(|name| name.trim().to_lowercase()).collect();
    match lower.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["xy" | "x, y" | "x,y" | "x y"] | ["x" | "ix" | "i_x", "y" | "iy" | "i_y"] => Some(TableOrder::Xy),
        ["yx" | "y, x" | "y,x" | "y x"] | ["y" | "iy" | "i_y", "x" | "ix" | "i_x"] => Some(TableOrder::Yx),
        ["rows" | "row, column" | "row,column" | "row column"] | ["row" | "rows", "column" | "columns" | "col"] => {
            Some(TableOrder::Rows)
        }
        _ => None,
    }
}
