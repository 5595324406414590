//! A solved scene as arrays of NumPy.

use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use steklov_document::Document;
use steklov_model::Answer;
use steklov_model::numbers::numbers;
use steklov_model::solve::contact_rows::ContactRow;
use steklov_model::solve::solution::TieRow;
use steklov_model::summary::{LinePoint, SidePoint};
use steklov_problem::ProbeLine;
use steklov_unstructured::Field;

use crate::start_threads;

/// A column of a table: its name, and its number in a row.
type Column<R> = (&'static str, fn(&R) -> f64);

/// A scene that is solved.
#[pyclass(frozen)]
pub struct Solved {
    pub document: Document,
    pub answer: Answer,
}

#[pymethods]
impl Solved {
    /// The JSON object of `steklov solve --json`.
    fn json(&self) -> PyResult<String> {
        serde_json::to_string(&self.answer.summary).map_err(|e| PyValueError::new_err(e.to_string()))
    }

    /// Paths and values of all numbers.
    fn numbers(&self) -> Vec<(String, f64)> {
        numbers(&serde_json::to_value(&self.answer.summary).unwrap_or_default())
    }

    /// The table of all contact nodes: a column for each of their numbers.
    fn contact<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.contact_table(py, &self.answer.contact.iter().collect::<Vec<_>>())
    }

    /// The table of each interface between bodies by its name: the contact nodes of one in contact, the tied nodes of a tie.
    fn interfaces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let tables = PyDict::new(py);
        for interface in &self.answer.summary.interfaces {
            let table = if interface.kind == "contact" {
                let own = |row: &&ContactRow| interface.sides[0].contains(&self.side_name(row.side).to_owned());
                self.contact_table(py, &self.answer.contact.iter().filter(own).collect::<Vec<_>>())?
            } else {
                let rows: Vec<&TieRow> =
                    self.answer.run.ties().iter().filter(|tie| tie.name == interface.name).collect();
                let table = PyDict::new(py);
                vectors(&table, "point", rows.iter().map(|row| row.point))?;
                vectors(&table, "traction", rows.iter().map(|row| row.traction))?;
                table.set_item("weight", PyArray1::from_iter(py, rows.iter().map(|row| row.weight)))?;
                table
            };
            tables.set_item(&interface.name, table)?;
        }
        Ok(tables)
    }

    /// Displacement and stress at points (N, 2), each with its distance from the first along them all; NaN where no body is.
    fn at<'py>(&self, py: Python<'py>, points: PyReadonlyArray2<'_, f64>) -> PyResult<Bound<'py, PyDict>> {
        let points: Vec<[f64; 2]> = points.as_array().rows().into_iter().map(|row| [row[0], row[1]]).collect();
        if let Some([x, y]) = points.iter().find(|x| !x.iter().all(|c| c.is_finite())) {
            return Err(PyValueError::new_err(format!(
                "the point ({x}, {y}) is nowhere: coordinates are finite numbers"
            )));
        }
        start_threads(py)?;
        self.point_table(py, &py.detach(|| self.answer.at(&self.document.scene, &points)))
    }

    /// The same at so many points, at least 2, of the line from one point to another.
    fn along_line<'py>(
        &self,
        py: Python<'py>,
        first: [f64; 2],
        last: [f64; 2],
        points: usize,
    ) -> PyResult<Bound<'py, PyDict>> {
        let line = ProbeLine { from: first, to: last, points };
        line.check(&self.document.scene.problem)
            .map_err(|(what, help)| PyValueError::new_err(format!("{what}: {help}")))?;
        start_threads(py)?;
        self.point_table(py, &py.detach(|| self.answer.along(&self.document.scene, &line)))
    }

    /// Displacement, traction and stress along a side; None if there is none of that name.
    fn along_side<'py>(&self, py: Python<'py>, side: &str) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(side) = self.document.scene.problem.side(side) else { return Ok(None) };
        start_threads(py)?;
        let rows = py.detach(|| self.answer.along_side(&self.document.scene, side)).points;
        let table = PyDict::new(py);
        table.set_item("piece", PyArray1::from_iter(py, rows.iter().map(|row| row.piece)))?;
        let numbers: [Column<SidePoint>; 7] = [
            ("s", |row| row.s),
            ("normal_displacement", |row| row.normal_displacement),
            ("tangential_displacement", |row| row.tangential_displacement),
            ("normal_traction", |row| row.normal_traction),
            ("tangential_traction", |row| row.tangential_traction),
            ("hoop_stress", |row| row.hoop_stress),
            ("von_mises", |row| row.von_mises),
        ];
        columns(&table, &rows, &numbers)?;
        vectors(&table, "point", rows.iter().map(|row| row.point))?;
        vectors(&table, "normal", rows.iter().map(|row| row.normal))?;
        vectors(&table, "displacement", rows.iter().map(|row| row.displacement))?;
        vectors(&table, "stress", rows.iter().map(|row| row.stress))?;
        let unbounded = rows.iter().map(|row| row.stress_unbounded);
        table.set_item("stress_unbounded", PyArray1::from_iter(py, unbounded))?;
        Ok(Some(table))
    }

    /// The fields on an unstructured grid, and the factor at which displacements are drawn.
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        start_threads(py)?;
        let (grid, enlargement) = py.detach(|| {
            let grid = steklov_fields::fields(&self.document.scene, &self.answer);
            let enlargement = steklov_fields::enlargement(&self.answer, &grid);
            (grid, enlargement)
        });
        let table = PyDict::new(py);
        table.set_item("enlargement", enlargement)?;
        vectors(&table, "points", grid.points.iter().copied())?;
        cells(&table, "lines", &grid.lines)?;
        cells(&table, "triangles", &grid.triangles)?;
        cells(&table, "quads", &grid.quads)?;
        for (name, fields) in [("point_data", grid.point_data), ("cell_data", grid.cell_data)] {
            let data = PyDict::new(py);
            for Field { name, components, values, .. } in fields {
                let shape = vec![values.len() / components.max(1), components];
                let values = PyArray1::from_vec(py, values);
                match components {
                    1 => data.set_item(name, values)?,
                    _ => data.set_item(name, values.call_method1("reshape", (shape,))?)?,
                }
            }
            table.set_item(name, data)?;
        }
        Ok(table)
    }

    /// Writes the result file.
    #[cfg(feature = "hdf5")]
    fn save(&self, py: Python<'_>, path: std::path::PathBuf, replace: bool) -> PyResult<()> {
        let Self { document, answer } = self;
        py.detach(|| steklov_result::save(&path, replace, document, answer)).map_err(|error| crate::file_error(&error))
    }

    /// Names of all sides.
    fn sides(&self) -> Vec<&str> {
        self.document.scene.problem.sides.iter().map(|side| side.name.as_str()).collect()
    }
}

impl Solved {
    fn side_name(&self, side: usize) -> &str {
        &self.document.scene.problem.sides[side].name
    }

    fn point_table<'py>(&self, py: Python<'py>, rows: &[LinePoint]) -> PyResult<Bound<'py, PyDict>> {
        let table = PyDict::new(py);
        columns(&table, rows, &[("s", |row: &LinePoint| row.s), ("von_mises", |row| row.von_mises)])?;
        vectors(&table, "point", rows.iter().map(|row| row.point))?;
        vectors(&table, "displacement", rows.iter().map(|row| row.displacement))?;
        vectors(&table, "stress", rows.iter().map(|row| row.stress))?;
        let several = self.document.scene.problem.bodies.len() > 1;
        if several {
            table.set_item("body", rows.iter().map(|row| row.body.as_deref()).collect::<Vec<_>>())?;
        }
        let unbounded = rows.iter().map(|row| row.stress_unbounded);
        table.set_item("stress_unbounded", PyArray1::from_iter(py, unbounded))?;
        Ok(table)
    }

    fn contact_table<'py>(&self, py: Python<'py>, rows: &[&ContactRow]) -> PyResult<Bound<'py, PyDict>> {
        let table = PyDict::new(py);
        table.set_item("side", rows.iter().map(|row| self.side_name(row.side)).collect::<Vec<_>>())?;
        vectors(&table, "point", rows.iter().map(|row| row.point))?;
        vectors(&table, "normal", rows.iter().map(|row| row.normal))?;
        let numbers: [Column<&ContactRow>; 7] = [
            ("gap", |row| row.gap),
            ("normal_displacement", |row| row.normal_displacement),
            ("tangential_displacement", |row| row.tangential_displacement),
            ("pressure", |row| row.pressure),
            ("shear", |row| row.shear),
            ("bound", |row| row.bound),
            ("weight", |row| row.weight),
        ];
        columns(&table, rows, &numbers)?;
        table.set_item("status", PyArray1::from_iter(py, rows.iter().map(|row| row.status)))?;
        Ok(table)
    }
}

/// Adds the columns of numbers of the rows of a table.
fn columns<R>(table: &Bound<'_, PyDict>, rows: &[R], columns: &[Column<R>]) -> PyResult<()> {
    columns
        .iter()
        .try_for_each(|(name, value)| table.set_item(name, PyArray1::from_iter(table.py(), rows.iter().map(value))))
}

/// Adds the numbers of the points of cells, an array with a row for each cell.
fn cells<const N: usize>(table: &Bound<'_, PyDict>, name: &str, cells: &[[usize; N]]) -> PyResult<()> {
    let flat = cells.iter().flatten().map(|&point| point as i64);
    table.set_item(name, PyArray1::from_iter(table.py(), flat).call_method1("reshape", ([cells.len(), N],))?)
}

/// Adds a column of vectors, an array with a row for each.
fn vectors<const N: usize>(
    table: &Bound<'_, PyDict>,
    name: &str,
    rows: impl ExactSizeIterator<Item = [f64; N]>,
) -> PyResult<()> {
    let count = rows.len();
    let flat: Vec<f64> = rows.flatten().collect();
    table.set_item(name, PyArray1::from_vec(table.py(), flat).call_method1("reshape", ([count, N],))?)
}
