//! Multiscale bases of one coarse cell.

use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use steklov_msfem::{Basis, CoarseMesh, Elasticity, Grid, HeterogeneousBody, MsfemError, Multiscale};

use crate::blocks::{array, failed, plane, unknown, work, wrong};

/// Most fine cells.
const MOST: usize = 1 << 20;

/// Values at the nodes, the coarse stiffness and the homogenised tensor.
type Arrays<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);

/// The basis of a cell with these sides and the moduli of its fine cells, indices along x and y: an array of the nodes along y, those
/// along x, component, corner and direction; its coarse stiffness; its tensor.
#[pyfunction]
pub fn cell_basis<'py>(
    py: Python<'py>,
    kind: &str,
    young: PyReadonlyArray2<'_, f64>,
    poisson: PyReadonlyArray2<'_, f64>,
    sides: [f64; 2],
    plane_word: &str,
) -> PyResult<Arrays<'py>> {
    let kind = match kind {
        "q1" => Basis::Q1,
        "linear" => Basis::Linear,
        "coupled" => Basis::Coupled,
        "oscillatory" => Basis::Oscillatory,
        "periodic" => Basis::Periodic,
        _ => return Err(unknown(py, "kind of basis", kind)),
    };
    let (young, poisson) = (young.as_array(), poisson.as_array());
    let (m, n) = young.dim();
    if m == 0 || n == 0 || m.saturating_mul(n) > MOST {
        return Err(wrong(py, format!("young has {m} by {n} fine cells: there are 1 to {MOST}")));
    }
    if poisson.dim() != (1, 1) && poisson.dim() != (m, n) {
        return Err(wrong(
            py,
            format!("poisson has {:?} cells and young {m} by {n}: one ratio, or one a cell", poisson.dim()),
        ));
    }
    let plane = plane(py, plane_word)?;
    let spacing = [sides[0] / m as f64, sides[1] / n as f64];
    let (young, poisson): (Vec<f64>, Vec<f64>) = (young.iter().copied().collect(), poisson.iter().copied().collect());
    let made = work(py, || -> Result<_, MsfemError> {
        let grid = Grid::new([0.0; 2], spacing, [m, n], |_, _| true)?;
        let mut body = HeterogeneousBody::new(grid, young, Elasticity::new(poisson[0], plane)?)?;
        if poisson.len() > 1 {
            body = body.with_poisson(poisson)?;
        }
        Multiscale::new(&body, CoarseMesh::uniform(&body.grid, [m, n])?, kind)?.cell_basis(0)
    });
    let basis = made.map_err(|error| failed(py, error))?;
    let tensor = basis.tensor(spacing);
    Ok((
        array(py, basis.values.as_flattened().to_vec(), &[n + 1, m + 1, 2, 4, 2])?,
        array(py, basis.stiffness.as_flattened().to_vec(), &[8, 8])?,
        array(py, tensor.as_flattened().to_vec(), &[3, 3])?,
    ))
}
