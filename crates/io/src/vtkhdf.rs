//! `/VTKHDF`: boundary lines and a body of triangles or quadrilaterals with fields, as ParaView, VTK and PyVista read them.
//!
//! An unstructured grid in VTKHDF version 1.0 (one piece; offsets from 0; cell types 3 = line, 5 = triangle, 9 =
//! quadrilateral). Points get z = 0. Every file has the cell array `part`: 0 for a line of the boundary, 1 for a cell of
//! the body.
//!
//! A point takes 24 bytes of the file and each value of a field 8. The integers of a cell (its points, offset, type,
//! part) are deflated if there are many; without that, a quadrilateral takes 49 bytes.

use hdf5::{File, Group};

use crate::attribute::{read_integer_attribute, read_text_attribute, write_ascii_attribute, write_integer_attribute};
use crate::dataset::{Label, label, load_label, read_numbers, write_numbers};
use crate::deflated::Storage::{Deflated, Plain};
use crate::error::{IoError, damaged, invalid, mismatch, write_error};
use crate::persist::{create_group, open_group};

pub use steklov_unstructured::{Field, Grid};

const LINE: u8 = 3;
const TRIANGLE: u8 = 5;
const QUAD: u8 = 9;
const PART: &str = "part";

/// Writes `/VTKHDF`.
///
/// # Errors
/// [`IoError::Write`], also for a cell with an unknown point and for a field of the wrong length or name.
pub fn write(file: &File, grid: &Grid) -> Result<(), IoError> {
    let group = create_group(file, "VTKHDF")?;
    write_integer_attribute(&group, "Version", &[1, 0])?;
    write_ascii_attribute(&group, "Type", "UnstructuredGrid")?;

    let counts = [grid.lines.len(), grid.triangles.len(), grid.quads.len()];
    let cells: usize = counts.iter().sum();
    let entries = 2 * counts[0] + 3 * counts[1] + 4 * counts[2];
    let ids = || grid.lines.as_flattened().iter().chain(grid.triangles.as_flattened()).chain(grid.quads.as_flattened());
    if let Some(point) = ids().find(|&&i| i >= grid.points.len()) {
        let why = format!("a cell names point {point} of {}", grid.points.len());
        return Err(write_error(&group, "Connectivity", why));
    }
    for (name, count) in
        [("NumberOfPoints", grid.points.len()), ("NumberOfCells", cells), ("NumberOfConnectivityIds", entries)]
    {
        write_numbers(&group, name, &[1], &[count as i64], &label("1", "count", &["piece"]), Plain)?;
    }
    // Only one array at a time is in memory beside the grid.
    let points: Vec<f64> = grid.points.iter().flat_map(|&[x, y]| [x, y, 0.0]).collect();
    write_numbers(
        &group,
        "Points",
        &[grid.points.len(), 3],
        &points,
        &label("length", "points", &["point", "xyz"]),
        Plain,
    )?;
    drop(points);
    let connectivity: Vec<i64> = ids().map(|&i| i as i64).collect();
    write_numbers(&group, "Connectivity", &[entries], &connectivity, &label("1", "points", &["entry"]), Deflated)?;
    drop(connectivity);
    let each = |of: [i64; 3]| of.into_iter().zip(counts).flat_map(|(value, count)| std::iter::repeat_n(value, count));
    let starts = each([2, 3, 4]).scan(0, |end, corners| {
        *end += corners;
        Some(*end)
    });
    let offsets: Vec<i64> = std::iter::once(0).chain(starts).collect();
    write_numbers(&group, "Offsets", &[cells + 1], &offsets, &label("1", "start of each cell", &["cell"]), Deflated)?;
    drop(offsets);
    let types = [vec![LINE; counts[0]], vec![TRIANGLE; counts[1]], vec![QUAD; counts[2]]].concat();
    write_numbers(&group, "Types", &[cells], &types, &label("1", "cell type of VTK", &["cell"]), Deflated)?;

    let data = create_group(&group, "PointData")?;
    for field in &grid.point_data {
        write_field(&data, field, grid.points.len(), "point")?;
    }
    let data = create_group(&group, "CellData")?;
    let part: Vec<i64> = each([0, 1, 1]).collect();
    write_numbers(&data, PART, &[cells], &part, &label("1", "0 boundary, 1 body", &["cell"]), Deflated)?;
    for field in &grid.cell_data {
        write_field(&data, field, cells, "cell")?;
    }
    Ok(())
}

fn write_field(at: &Group, field: &Field, entities: usize, axis: &str) -> Result<(), IoError> {
    let Field { name, unit, components, values } = field;
    if name.is_empty() || name.contains('/') {
        return Err(write_error(at, name, format!("{name:?} is no name for a field")));
    }
    if *components == 0 || components.checked_mul(entities) != Some(values.len()) {
        let why = format!("{} values for {entities} of kind {axis} with {components} components", values.len());
        return Err(write_error(at, name, why));
    }
    let (shape, axes) = match components {
        1 => (vec![entities], vec![axis]),
        _ => (vec![entities, *components], vec![axis, "component"]),
    };
    write_numbers(at, name, &shape, values, &Label { unit, meaning: name, axes: &axes }, Plain)
}

/// Reads `/VTKHDF` back.
///
/// # Errors
/// [`IoError::Mismatch`] and [`IoError::Invalid`] for a grid that this module does not write; else any error of
/// reading.
pub fn read(file: &File) -> Result<Grid, IoError> {
    let group = open_group(file, "VTKHDF")?;
    let kind = read_text_attribute(&group, "Type")?;
    if kind != "UnstructuredGrid" {
        return Err(mismatch(&group, "Type", "UnstructuredGrid", kind));
    }
    let version = read_integer_attribute(&group, "Version")?;
    if version != [1, 0] {
        return Err(mismatch(&group, "Version", "[1, 0]", format!("{version:?}")));
    }
    let (shape, points) = read_numbers::<f64>(&group, "Points", 2)?;
    if shape[1] != 3 {
        return Err(mismatch(&group, "Points", "3 columns", shape[1]));
    }
    let mut grid = Grid { points: points.chunks_exact(3).map(|p| [p[0], p[1]]).collect(), ..Grid::default() };
    let (_, connectivity) = read_numbers::<i64>(&group, "Connectivity", 1)?;
    let (_, offsets) = read_numbers::<i64>(&group, "Offsets", 1)?;
    let (_, types) = read_numbers::<u8>(&group, "Types", 1)?;
    if offsets.len() != types.len() + 1 || offsets[0] != 0 || offsets[types.len()] != connectivity.len() as i64 {
        return Err(invalid(&group, "Offsets", "it does not fit Types and Connectivity"));
    }
    let points = grid.points.len();
    for (cell, (ends, &kind)) in offsets.windows(2).zip(&types).enumerate() {
        let ids = (usize::try_from(ends[0]).ok().zip(usize::try_from(ends[1]).ok()))
            .and_then(|(a, b)| connectivity.get(a..b))
            .unwrap_or_default();
        let body = (grid.triangles.is_empty(), grid.quads.is_empty());
        let known = match (kind, body) {
            (LINE, (true, true)) => corners(ids, points).map(|c| grid.lines.push(c)),
            (TRIANGLE, (_, true)) => corners(ids, points).map(|c| grid.triangles.push(c)),
            (QUAD, _) => corners(ids, points).map(|c| grid.quads.push(c)),
            _ => None,
        };
        if known.is_none() {
            let why = format!("cell {cell} is no line, triangle or quadrilateral of points, in this order");
            return Err(invalid(&group, "Connectivity", why));
        }
    }
    grid.point_data = read_fields(&open_group(&group, "PointData")?, grid.points.len())?;
    grid.cell_data = read_fields(&open_group(&group, "CellData")?, types.len())?;
    Ok(grid)
}

/// The corners of a cell, if it has N and all are points of the grid.
fn corners<const N: usize>(ids: &[i64], points: usize) -> Option<[usize; N]> {
    let ids = <[i64; N]>::try_from(ids).ok()?;
    let known = ids.iter().all(|&i| usize::try_from(i).is_ok_and(|i| i < points));
    known.then(|| ids.map(|i| i as usize))
}

fn read_fields(at: &Group, entities: usize) -> Result<Vec<Field>, IoError> {
    let mut fields = Vec::new();
    for name in at.member_names().map_err(|e| damaged(at, "", e))? {
        if name == PART {
            continue;
        }
        let stored = load_label(at, &name)?;
        let (shape, values) = read_numbers::<f64>(at, &name, stored.axes.len())?;
        if shape.first() != Some(&entities) {
            return Err(mismatch(at, &name, format!("{entities} rows"), format!("shape {shape:?}")));
        }
        let components = shape.get(1).copied().unwrap_or(1);
        fields.push(Field { name, unit: stored.unit, components, values });
    }
    Ok(fields)
}
