//! The boundary operators of a material, and the Steklov-Poincaré matrix.

use pyo3::prelude::*;
use steklov_algebra::faer::Mat;
use steklov_bem_operators::Domain;
use steklov_elastic::Material;
use steklov_model::summary::available_memory_bytes;

use crate::blocks::{Mesh, array, failed, matrix, plane, unknown, work, wrong};

/// V, K, W and M of a mesh.
#[pyclass(frozen)]
pub struct Operators(steklov_bem_operators::Operators);

#[pymethods]
impl Operators {
    #[new]
    fn new(
        py: Python<'_>,
        mesh: &Bound<'_, Mesh>,
        young: f64,
        poisson: f64,
        plane_word: &str,
        length: Option<f64>,
    ) -> PyResult<Self> {
        let material = Material::new(young, poisson, plane(py, plane_word)?).map_err(|error| wrong(py, error))?;
        if let Some(length) = length.filter(|l| !(*l > 0.0 && l.is_finite())) {
            return Err(wrong(py, format!("length is {length}: L in log(L/r) is positive and finite")));
        }
        let Mesh { mesh, space } = mesh.get();
        // V, K and W, and as much again for a copy
        check_memory(py, space.dofs(), 6)?;
        let made = work(py, || steklov_bem_operators::Operators::assemble(mesh, space, &material, length))?;
        let operators = made.map_err(|error| failed(py, error))?;
        let usual = |x: f64| x.is_normal();
        if !(usual(operators.v[(0, 0)]) && usual(operators.w[(0, 0)])) {
            return Err(wrong(
                py,
                format!("young is {young:e}: the matrices leave the range of numbers, change the unit"),
            ));
        }
        Ok(Self(operators))
    }

    fn v<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrix(py, self.0.v.as_ref())
    }

    fn k<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrix(py, self.0.k.as_ref())
    }

    fn w<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrix(py, self.0.w.as_ref())
    }

    fn m<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mass = &self.0.mass;
        let mut full = Mat::<f64>::zeros(mass.rows(), mass.cols());
        mass.iter().for_each(|(&value, (i, j))| full[(i, j)] = value);
        matrix(py, full.as_ref())
    }

    fn length(&self) -> f64 {
        self.0.length
    }

    /// The Steklov-Poincaré matrix of a domain.
    fn steklov(&self, py: Python<'_>, domain: &str, bounded_at_infinity: bool) -> PyResult<Steklov> {
        let domain = match (domain, bounded_at_infinity) {
            ("interior", false) => Domain::Interior,
            ("interior", true) => Domain::BoundedAtInfinity,
            ("exterior", false) => Domain::Exterior,
            ("exterior", true) => Domain::ExteriorBoundedAtInfinity,
            _ => return Err(unknown(py, "domain", domain)),
        };
        check_memory(py, self.0.v.nrows(), 4)?;
        work(py, || steklov_bem_operators::Steklov::new(self.0.clone(), domain))?
            .map(Steklov)
            .map_err(|error| failed(py, error))
    }
}

/// S with its map from displacement to traction.
#[pyclass(frozen)]
pub struct Steklov(steklov_bem_operators::Steklov);

#[pymethods]
impl Steklov {
    fn matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrix(py, self.0.matrix.as_ref())
    }

    /// Legendre coefficients of the traction of a nodal displacement.
    fn traction<'py>(&self, py: Python<'py>, displacement: Vec<f64>) -> PyResult<Bound<'py, PyAny>> {
        self.check(py, &displacement)?;
        let traction = work(py, || self.0.traction.apply(&displacement))?;
        let count = traction.len();
        array(py, traction, &[count])
    }

    /// The constant to which the displacement tends at infinity.
    fn at_infinity(&self, py: Python<'_>, displacement: Vec<f64>) -> PyResult<[f64; 2]> {
        self.check(py, &displacement)?;
        Ok(self.0.traction.at_infinity(&displacement))
    }
}

impl Steklov {
    fn check(&self, py: Python<'_>, displacement: &[f64]) -> PyResult<()> {
        let (given, unknowns) = (displacement.len(), self.0.matrix.ncols());
        match given == unknowns {
            true => Ok(()),
            false => Err(wrong(py, format!("{given} displacements for {unknowns} unknowns: two for each node"))),
        }
    }
}

/// Refuses so many matrices of n unknowns where they do not fit into memory.
fn check_memory(py: Python<'_>, n: usize, matrices: u64) -> PyResult<()> {
    let bytes = (n as u64).saturating_mul(n as u64).saturating_mul(8 * matrices);
    match available_memory_bytes() {
        Some(available) if bytes > available => {
            let gib = |bytes: u64| bytes as f64 / (1u64 << 30) as f64;
            let what = format!(
                "the matrices of {n} unknowns take {:.1} GiB and {:.1} GiB are free: take fewer elements or a lower degree",
                gib(bytes),
                gib(available)
            );
            Err(wrong(py, what))
        }
        _ => Ok(()),
    }
}
