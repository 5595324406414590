//! Multiscale bases of one coarse cell.

use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use steklov_msfem::{Basis, CoarseCell, CoarseMesh, Elasticity, Grid, HeterogeneousBody, MsfemError, Multiscale};

use crate::blocks::{array, failed, plane, unknown, work, wrong};

/// Most fine cells.
const MOST: usize = 1 << 20;

/// Values at the nodes, the coarse stiffness and the homogenised tensor.
type Arrays<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);

/// The basis of a cell with these sides and the moduli of its fine cells, indices along x and y, and of `layers` around it if it is
/// oversampled: an array of the nodes along y, those
/// along x, component, corner and direction; its coarse stiffness; its tensor.
#[pyfunction]
pub fn cell_basis<'py>(
    py: Python<'py>,
    kind: &str,
    young: PyReadonlyArray2<'_, f64>,
    poisson: PyReadonlyArray2<'_, f64>,
    sides: [f64; 2],
    plane_word: &str,
    layers: usize,
) -> PyResult<Arrays<'py>> {
    let kind = match kind {
        "q1" => Basis::Q1,
        "linear" => Basis::Linear,
        "coupled" => Basis::Coupled,
        "oscillatory" => Basis::Oscillatory,
        "periodic" => Basis::Periodic,
        "oversampled" => Basis::Oversampled(layers),
        _ => return Err(unknown(py, "kind of basis", kind)),
    };
    let (young, poisson) = (young.as_array(), poisson.as_array());
    let dim = young.dim();
    let around = if kind == Basis::Oversampled(layers) { layers } else { 0 };
    let inside = |count: usize| count.saturating_sub(around.saturating_mul(2));
    let (m, n) = (inside(dim.0), inside(dim.1));
    if m == 0 || n == 0 || dim.0.saturating_mul(dim.1) > MOST {
        return Err(wrong(
            py,
            format!(
                "young has {} by {} fine cells, {around} of them around: inside there is at least one, and at most {MOST} are taken",
                dim.0, dim.1
            ),
        ));
    }
    if poisson.dim() != (1, 1) && poisson.dim() != dim {
        return Err(wrong(
            py,
            format!("poisson has {:?} cells and young {dim:?}: one ratio, or one a cell", poisson.dim()),
        ));
    }
    let plane = plane(py, plane_word)?;
    let spacing = [sides[0] / m as f64, sides[1] / n as f64];
    let (young, poisson): (Vec<f64>, Vec<f64>) = (young.iter().copied().collect(), poisson.iter().copied().collect());
    let made = work(py, || -> Result<_, MsfemError> {
        let grid = Grid::new([0.0; 2], spacing, [dim.0, dim.1], |_, _| true)?;
        let mut body = HeterogeneousBody::new(grid, young, Elasticity::new(poisson[0], plane)?)?;
        if poisson.len() > 1 {
            body = body.with_poisson(poisson)?;
        }
        // the cell itself, and eight around it that make its layers
        let parts = |count: usize| [[0, around], [around, count], [around + count, around]];
        let cell = |[i, m]: [usize; 2], [j, n]: [usize; 2]| CoarseCell { first: [i, j], size: [m, n] };
        let mut cells: Vec<CoarseCell> = parts(m).iter().flat_map(|&x| parts(n).map(|y| cell(x, y))).collect();
        cells.retain(|cell| !cell.size.contains(&0));
        let middle = cells.len() / 2;
        Multiscale::new(&body, CoarseMesh::new(&body.grid, cells)?, kind)?.cell_basis(middle)
    })?;
    let basis = made.map_err(|error| failed(py, error))?;
    let tensor = basis.tensor(spacing);
    Ok((
        array(py, basis.values.as_flattened().to_vec(), &[n + 1, m + 1, 2, 4, 2])?,
        array(py, basis.stiffness.as_flattened().to_vec(), &[8, 8])?,
        array(py, tensor.as_flattened().to_vec(), &[3, 3])?,
    ))
}
