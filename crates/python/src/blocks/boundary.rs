//! Bodies and their boundary meshes.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use steklov_bem_operators::{Loop, Path, Space};

use crate::blocks::{array, failed, whole, work, wrong};

/// Most nodes of a mesh, and most corners of a polygon, whose edges are compared in pairs.
const MOST: usize = 1_000_000;
const MOST_CORNERS: usize = 50_000;
/// Squares of smaller lengths leave the range of numbers.
const SMALLEST: f64 = 1e-100;

/// A loop as it is listed: corners, sides, and the angle by which each edge turns; no angles if all are straight.
type Listed = (Vec<[f64; 2]>, Vec<String>, Vec<f64>);

/// A body with holes, or the plane around holes.
#[pyclass(frozen)]
pub struct Polygon(pub steklov_bem_operators::Polygon);

#[pymethods]
impl Polygon {
    #[new]
    fn new(py: Python<'_>, outer: Option<Listed>, holes: Vec<Listed>) -> PyResult<Self> {
        let listed = |(corners, sides, turns): Listed| {
            let path = |opening| if opening == 0.0 { Path::Line } else { Path::Arc { opening } };
            Loop { corners, sides, paths: turns.into_iter().map(path).collect() }
        };
        let (outer, holes): (_, Vec<Loop>) = (outer.map(listed), holes.into_iter().map(listed).collect());
        let corners: usize = outer.iter().chain(&holes).map(|one| one.corners.len()).sum();
        if corners > MOST_CORNERS {
            return Err(wrong(py, format!("{corners} corners are too many: at most {MOST_CORNERS}, arcs need fewer")));
        }
        let made = work(py, || match outer {
            Some(outer) => steklov_bem_operators::Polygon::new(outer, holes),
            None => steklov_bem_operators::Polygon::outside(holes),
        })?;
        let polygon = made.map_err(|error| wrong(py, error))?;
        if polygon.diameter() < SMALLEST {
            let what =
                format!("the diameter is {:e}: choose a unit in which it is above {SMALLEST:e}", polygon.diameter());
            return Err(wrong(py, what));
        }
        Ok(Self(polygon))
    }

    fn area(&self) -> f64 {
        self.0.area()
    }

    fn diameter(&self) -> f64 {
        self.0.diameter()
    }

    fn centroid(&self) -> [f64; 2] {
        self.0.centroid()
    }

    fn sides(&self) -> Vec<String> {
        self.0.side_names().to_vec()
    }

    fn edges(&self) -> usize {
        self.0.edges().len()
    }

    fn is_bounded(&self) -> bool {
        self.0.is_bounded()
    }
}

/// A boundary mesh with its space.
#[pyclass(frozen)]
pub struct Mesh {
    pub mesh: steklov_bem_operators::Mesh,
    pub space: Space,
}

#[pymethods]
impl Mesh {
    #[staticmethod]
    fn uniform(py: Python<'_>, polygon: &Bound<'_, Polygon>, elements: usize, degree: usize) -> PyResult<Self> {
        check_degree(py, degree)?;
        let polygon = &polygon.get().0;
        if elements == 0 || elements.saturating_mul(degree) > MOST {
            let what =
                format!("elements is {elements}: there is at least 1, and elements times degree is at most {MOST}");
            return Err(wrong(py, what));
        }
        Self::checked(py, || steklov_bem_operators::Mesh::uniform(polygon, elements, degree))
    }

    /// `degree[j]` is that of layer j from the points, at least one more than layers.
    #[staticmethod]
    fn graded(
        py: Python<'_>,
        polygon: &Bound<'_, Polygon>,
        towards: Vec<(usize, f64)>,
        layers: usize,
        ratio: f64,
        degree: Vec<usize>,
    ) -> PyResult<Self> {
        let polygon = &polygon.get().0;
        if degree.len() <= layers {
            return Err(wrong(py, format!("degree has {} entries: {layers} layers take one more", degree.len())));
        }
        degree.iter().try_for_each(|&p| check_degree(py, p))?;
        let made =
            work(py, || steklov_bem_operators::Mesh::graded(polygon, &towards, layers, ratio, |layer| degree[layer]))?;
        let mesh = made.map_err(|error| failed(py, error))?;
        Self::checked(py, || mesh)
    }

    /// The mesh with the marked elements halved, and the parent of each element.
    fn halved<'py>(&self, py: Python<'py>, marked: Vec<bool>) -> PyResult<(Self, Bound<'py, PyArray1<i64>>)> {
        self.check_marks(py, &marked)?;
        let (mesh, parents) = work(py, || self.mesh.bisected(&marked))?;
        Ok((Self::checked(py, || mesh)?, whole(py, parents)))
    }

    /// The mesh with the degree of the marked elements raised by one.
    fn raised(&self, py: Python<'_>, marked: Vec<bool>) -> PyResult<Self> {
        self.check_marks(py, &marked)?;
        Self::checked(py, || self.mesh.raised(&marked))
    }

    /// Its elements and nodes as arrays.
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (mesh, space, n) = (&self.mesh, &self.space, self.mesh.len());
        let table = PyDict::new(py);
        let ends = (0..n).flat_map(|e| mesh.ends(e)).flatten().collect();
        table.set_item("ends", array(py, ends, &[n, 2, 2])?)?;
        table.set_item("nodes", array(py, space.points.as_flattened().to_vec(), &[space.nodes(), 2])?)?;
        let normals = (0..n).flat_map(|e| mesh.normal(e, 0.0)).collect();
        table.set_item("normal", array(py, normals, &[n, 2])?)?;
        table.set_item("length", array(py, (0..n).map(|e| mesh.length(e)).collect(), &[n])?)?;
        let numbers = [
            ("degree", &mesh.degree),
            ("next", &mesh.next),
            ("edge", &mesh.edge),
            ("side", &mesh.side),
            ("offset", &space.offset),
        ];
        for (name, numbers) in numbers {
            table.set_item(name, whole(py, numbers.iter().copied()))?;
        }
        Ok(table)
    }

    fn sides(&self) -> Vec<String> {
        self.mesh.side_names.clone()
    }
}

impl Mesh {
    fn checked(py: Python<'_>, make: impl FnOnce() -> steklov_bem_operators::Mesh + Send) -> PyResult<Self> {
        let made = work(py, || -> Result<_, steklov_bem_operators::BemError> {
            let mesh = make();
            mesh.check()?;
            let nodes: usize = mesh.degree.iter().sum();
            Ok((nodes <= MOST).then(|| Self { space: Space::new(&mesh), mesh }))
        })?;
        let made = made.map_err(|error| failed(py, error))?;
        made.ok_or_else(|| {
            wrong(py, format!("the mesh has more than {MOST} nodes: take fewer elements or lower degrees"))
        })
    }

    fn check_marks(&self, py: Python<'_>, marked: &[bool]) -> PyResult<()> {
        match marked.len() == self.mesh.len() {
            true => Ok(()),
            false => Err(wrong(py, format!("{} marks for {} elements: one for each", marked.len(), self.mesh.len()))),
        }
    }
}

fn check_degree(py: Python<'_>, degree: usize) -> PyResult<()> {
    let most = steklov_bem_operators::Mesh::MAX_DEGREE;
    match (1..=most).contains(&degree) {
        true => Ok(()),
        false => Err(wrong(py, format!("degree is {degree}: elements have degrees from 1 to {most}"))),
    }
}
