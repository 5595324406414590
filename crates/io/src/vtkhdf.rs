//! `/VTKHDF`: boundary lines and a triangulated body with fields, as ParaView, VTK and PyVista read them.
//!
//! An unstructured grid in VTKHDF version 1.0 (one piece; offsets from 0; cell types 3 = line, 5 = triangle). Points get
//! z = 0. Every file has the cell array `part`: 0 for a line of the boundary, 1 for a triangle of the body.

use hdf5::{File, Group};

use crate::attribute::{read_integer_attribute, read_text_attribute, write_ascii_attribute, write_integer_attribute};
use crate::dataset::{Label, load_label, read_numbers, write_numbers};
use crate::error::{IoError, damaged, invalid, mismatch, write_error};
use crate::persist::{create_group, open_group};

/// Values at points or in cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Name shown by the viewer.
    pub name: String,
    /// Unit, stored in an attribute.
    pub unit: String,
    /// Numbers a point or cell; 3 makes a vector that can be warped by.
    pub components: usize,
    /// Values, component fastest.
    pub values: Vec<f64>,
}

/// Points, cells and fields.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Grid {
    /// Points (length).
    pub points: Vec<[f64; 2]>,
    /// Lines of the boundary: part 0, the first cells.
    pub lines: Vec<[usize; 2]>,
    /// Triangles of the body: part 1, the last cells.
    pub triangles: Vec<[usize; 3]>,
    /// Fields on the points.
    pub point_data: Vec<Field>,
    /// Fields on the cells: lines first, then triangles.
    pub cell_data: Vec<Field>,
}

const LINE: u8 = 3;
const TRIANGLE: u8 = 5;
const PART: &str = "part";

/// Writes `/VTKHDF`.
///
/// # Errors
/// [`IoError::Write`], also for a cell that names no point and for a field of the wrong length or name.
pub fn write(file: &File, grid: &Grid) -> Result<(), IoError> {
    let group = create_group(file, "VTKHDF")?;
    write_integer_attribute(&group, "Version", &[1, 0])?;
    write_ascii_attribute(&group, "Type", "UnstructuredGrid")?;

    let cells = grid.lines.len() + grid.triangles.len();
    let mut connectivity = Vec::new();
    let mut offsets = vec![0];
    for cell in grid.lines.iter().map(|l| &l[..]).chain(grid.triangles.iter().map(|t| &t[..])) {
        if let Some(point) = cell.iter().find(|&&i| i >= grid.points.len()) {
            let why = format!("a cell names point {point} of {}", grid.points.len());
            return Err(write_error(&group, "Connectivity", why));
        }
        connectivity.extend(cell.iter().map(|&i| i as i64));
        offsets.push(connectivity.len() as i64);
    }
    let label = |unit, meaning, axes| Label { unit, meaning, axes };
    for (name, count) in [
        ("NumberOfPoints", grid.points.len()),
        ("NumberOfCells", cells),
        ("NumberOfConnectivityIds", connectivity.len()),
    ] {
        write_numbers(&group, name, &[1], &[count as i64], &label("1", "count", &["piece"]))?;
    }
    let points: Vec<f64> = grid.points.iter().flat_map(|&[x, y]| [x, y, 0.0]).collect();
    let types = [vec![LINE; grid.lines.len()], vec![TRIANGLE; grid.triangles.len()]].concat();
    write_numbers(&group, "Points", &[grid.points.len(), 3], &points, &label("length", "points", &["point", "xyz"]))?;
    write_numbers(&group, "Connectivity", &[connectivity.len()], &connectivity, &label("1", "points", &["entry"]))?;
    write_numbers(&group, "Offsets", &[offsets.len()], &offsets, &label("1", "start of each cell", &["cell"]))?;
    write_numbers(&group, "Types", &[cells], &types, &label("1", "cell type of VTK", &["cell"]))?;

    let data = create_group(&group, "PointData")?;
    for field in &grid.point_data {
        write_field(&data, field, grid.points.len(), "point")?;
    }
    let data = create_group(&group, "CellData")?;
    let part: Vec<i64> = types.iter().map(|&t| i64::from(t == TRIANGLE)).collect();
    write_numbers(&data, PART, &[cells], &part, &label("1", "0 boundary, 1 body", &["cell"]))?;
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
    write_numbers(at, name, &shape, values, &Label { unit, meaning: name, axes: &axes })
}

/// Reads `/VTKHDF` back.
///
/// # Errors
/// [`IoError::Mismatch`] and [`IoError::Invalid`] for a grid that this module does not write; else as all reading.
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
    for (cell, (ends, &kind)) in offsets.windows(2).zip(&types).enumerate() {
        let points = (usize::try_from(ends[0]).ok().zip(usize::try_from(ends[1]).ok()))
            .and_then(|(a, b)| connectivity.get(a..b))
            .map(|ids| ids.iter().filter_map(|&i| usize::try_from(i).ok().filter(|&i| i < grid.points.len())));
        let points: Vec<usize> = points.into_iter().flatten().collect();
        match (kind, &points[..]) {
            (LINE, &[a, b]) if grid.triangles.is_empty() => grid.lines.push([a, b]),
            (TRIANGLE, &[a, b, c]) => grid.triangles.push([a, b, c]),
            _ => return Err(invalid(&group, "Connectivity", format!("cell {cell} is no line or triangle of points"))),
        }
    }
    grid.point_data = read_fields(&open_group(&group, "PointData")?, grid.points.len())?;
    grid.cell_data = read_fields(&open_group(&group, "CellData")?, types.len())?;
    Ok(grid)
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
