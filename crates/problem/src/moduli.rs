//! Young's modulus of every cell of a grid.

use steklov_bem_operators::Polygon;
use steklov_msfem::Grid;
use steklov_quadrature::unit_uniform;
use steklov_stochastic::FieldCells;

use super::cells::bounding_box;
use super::grid_fit::grid_over;
use super::{CellModuli, Cells, DataError, DataErrorKind as Kind, GridInput, MOST_CELLS, Scene, Substance};

/// Relative distance of a quotient from a whole number that counts as rounding.
const WHOLE: f64 = 1e-9;

/// The whole number that a quotient is, from 1 to [`MOST_CELLS`].
pub(super) fn whole(quotient: f64) -> Option<usize> {
    let near = quotient.round();
    let is_whole = (1.0..=MOST_CELLS as f64).contains(&near) && (quotient - near).abs() <= WHOLE * near;
    is_whole.then_some(near as usize)
}

/// The least number of fine cells in a coarse one, `least` or more, with which `coarse` times it is a multiple of `moduli`.
pub(super) fn fitting_fine(moduli: usize, coarse: usize, least: usize) -> usize {
    let (mut divisor, mut rest) = (moduli, coarse);
    while rest != 0 {
        (divisor, rest) = (rest, divisor % rest);
    }
    (moduli / divisor) * least.div_ceil(moduli / divisor)
}

/// How many modulus cells of a size lie along the sides of the bounding box, if whole ones do.
pub fn modulus_cells(polygon: &Polygon, size: f64) -> Option<[usize; 2]> {
    let [nx, ny] = bounding_box(polygon).1.map(|side| whole(side / size));
    Some([nx?, ny?])
}

/// The modulus cells of a size as the places of a random field: those with a fine cell of the body. `None` where they do not
/// fit the grid, which is refused later.
pub fn field_cells(outline: &Polygon, grid: &GridInput, size: f64) -> Option<FieldCells> {
    let cells = modulus_cells(outline, size)?;
    let fine = grid.cells();
    if (0..2).any(|k| !fine[k].is_multiple_of(cells[k])) {
        return None;
    }
    let grid = grid_over(outline, grid).ok()?;
    let mut inside = vec![false; cells[0] * cells[1]];
    for cell in grid.body_cells() {
        inside[parent(grid.cell(cell), fine, cells)] = true;
    }
    Some(FieldCells { cells, size: [size; 2], inside: Some(inside) })
}

/// The number of the modulus cell of `counts` around the fine cell [ix, iy] of `fine`.
fn parent([ix, iy]: [usize; 2], fine: [usize; 2], counts: [usize; 2]) -> usize {
    ix / (fine[0] / counts[0]) * counts[1] + iy / (fine[1] / counts[1])
}

/// Numbers of modulus cells NX, NY along the sides of the bounding box: whole ones, each cell a whole number of the `fine`
/// cells along both axes.
///
/// # Errors
/// A size that does not divide the sides of the bounding box, or that the fine cells do not divide; a table that does not have
/// NX × NY numbers.
pub fn check_modulus_cells(scene: &Scene, cells: &Cells, fine: [usize; 2]) -> Result<[usize; 2], DataError> {
    let (_, box_size) = bounding_box(&scene.problem.outline);
    let refuse = |message, help: &str| Err(DataError::at(Kind::Value, &[SIZE.to_vec()], message, help));
    let quotients = box_size.map(|side| side / cells.size);
    let [Some(nx), Some(ny)] = quotients.map(whole) else {
        let message = format!(
            "cells of the size {} do not divide the bounding box of {} by {}: it has {} by {} of them",
            cells.size, box_size[0], box_size[1], quotients[0], quotients[1]
        );
        let shorter = box_size[0].min(box_size[1]);
        let first = (shorter / cells.size).clamp(1.0, 1024.0) as usize;
        let size = (first..first + 1024).map(|n| shorter / n as f64);
        let size = size.into_iter().find(|size| box_size.iter().all(|side| whole(side / size).is_some()));
        let help = match size {
            Some(size) => format!("both sides must be whole multiples: take size = {size}"),
            None => "both sides must be whole multiples of the size".to_owned(),
        };
        return refuse(message, &help);
    };
    for (of_cells, key) in [(Some(&cells.young), YOUNG), (cells.poisson.as_ref(), POISSON)] {
        if let Some(CellModuli::Table { values, source, .. }) = of_cells
            && values.len() != nx * ny
        {
            let message = format!("{source} has {} moduli of {nx} by {ny} cells", values.len());
            return Err(DataError::at(Kind::Value, &[key.to_vec()], message, "give one modulus for each cell"));
        }
    }
    if fine[0].is_multiple_of(nx) && fine[1].is_multiple_of(ny) {
        return Ok([nx, ny]);
    }
    let h = [0, 1].map(|k| box_size[k] / fine[k] as f64);
    let message = format!("fine cells of {} by {} do not divide modulus cells of the size {}", h[0], h[1], cells.size);
    let help = scene.body().grid.as_ref().map_or_else(String::new, |grid| {
        let [x, y] = [0, 1].map(|k| fitting_fine([nx, ny][k], grid.coarse[k], grid.fine[k]));
        format!("a modulus cell is made of whole fine cells: take grid.fine = [{x}, {y}]")
    });
    refuse(message, &help)
}

const SIZE: [&str; 3] = ["material", "cells", "size"];
const YOUNG: [&str; 3] = ["material", "cells", "young"];
const POISSON: [&str; 3] = ["material", "cells", "poisson"];

/// Young's modulus (stress) of every cell of a grid over the bounding box of the scene's body, in the order of the cells'
/// numbers: that of `[material.cells]`, or `material.young` everywhere. In cells outside of the body it is not checked.
///
/// The modulus cells are NX × NY squares, i = ix·NY + iy counted from the lower left corner of the bounding box: number i is
/// low + (high - low) u_i with u_i of [`unit_uniform`], or an entry of the dataset by its order, or the value of the expression
/// at the cell's centre, which holds in the whole cell.
///
/// # Errors
/// Modulus cells that do not fit the grid; a table that does not have NX × NY numbers; a modulus in the body that
/// is not positive and finite, with its place.
pub fn moduli(scene: &Scene, grid: &Grid) -> Result<Vec<f64>, DataError> {
    let [nx, ny] = grid.cells;
    let body = scene.body();
    let Substance::Cells(cells) = &body.substance else { return Ok(vec![body.material().young; nx * ny]) };
    let counts = check_modulus_cells(scene, cells, grid.cells)?;
    let values = cell_values(scene, cells.size, &cells.young, counts);
    let parent = |cell: usize| parent(grid.cell(cell), grid.cells, counts);
    match grid.body_cells().map(parent).find(|&i| !(values[i] > 0.0 && values[i].is_finite())) {
        None => Ok((0..nx * ny).map(|cell| values[parent(cell)]).collect()),
        Some(i) => {
            let centre = centre(scene, cells.size, counts, i);
            Err(impossible(&cells.young, values[i], ([i / counts[1], i % counts[1]], counts), centre))
        }
    }
}

/// Poisson's ratio of every cell of a grid, in the order of the cells' numbers, where modulus cells have ratios of their own:
/// given like Young's modulus.
///
/// # Errors
/// Modulus cells that do not fit the grid; a table that does not have NX × NY numbers; a ratio in the body that is not above -1
/// and below ½, with its place.
pub fn poisson_ratios(scene: &Scene, grid: &Grid) -> Result<Option<Vec<f64>>, DataError> {
    let Some(cells) = scene.body().cells() else { return Ok(None) };
    let Some(poisson) = &cells.poisson else { return Ok(None) };
    let counts = check_modulus_cells(scene, cells, grid.cells)?;
    let values = cell_values(scene, cells.size, poisson, counts);
    let parent = |cell: usize| parent(grid.cell(cell), grid.cells, counts);
    if let Some(i) = grid.body_cells().map(parent).find(|&i| !(values[i] > -1.0 && values[i] < 0.5)) {
        let [x, y] = centre(scene, cells.size, counts, i);
        let message = format!("Poisson's ratio is {} in the cell with the centre ({x}, {y})", values[i]);
        let help = "a ratio is above -1 and below 0.5 in every cell of the body";
        return Err(DataError::at(Kind::Data, &[POISSON.to_vec()], message, help));
    }
    Ok(Some((0..grid.cells[0] * grid.cells[1]).map(|cell| values[parent(cell)]).collect()))
}

/// The middle of a modulus cell.
fn centre(scene: &Scene, size: f64, counts: [usize; 2], i: usize) -> [f64; 2] {
    let (low, _) = bounding_box(&scene.problem.outline);
    [0, 1].map(|k| low[k] + size * ([i / counts[1], i % counts[1]][k] as f64 + 0.5))
}

/// The number of every modulus cell of the bounding box.
pub(super) fn cell_values(scene: &Scene, size: f64, of_cells: &CellModuli, counts: [usize; 2]) -> Vec<f64> {
    let all = 0..counts[0] * counts[1];
    match of_cells {
        CellModuli::Uniform { low, high, seed } => {
            all.map(|i| low + (high - low) * unit_uniform(*seed, i as u64)).collect()
        }
        CellModuli::Expression(value) => {
            all.map(|i| centre(scene, size, counts, i)).map(|[x, y]| value.eval(x, y, 0.0)).collect()
        }
        CellModuli::Table { values, .. } => values.to_vec(),
    }
}

/// The error of a modulus that is not positive and finite.
fn impossible(young: &CellModuli, value: f64, (cell, counts): ([usize; 2], [usize; 2]), [x, y]: [f64; 2]) -> DataError {
    let source = match young {
        CellModuli::Expression(expression) => format!(": expression {:?}", expression.text()),
        CellModuli::Table { source, order, .. } => {
            let [i, j] = order.entry(cell, counts);
            format!(": entry [{i}, {j}] of {source}")
        }
        CellModuli::Uniform { .. } => String::new(),
    };
    let message = format!("Young's modulus is {value} in the cell with the centre ({x}, {y}){source}");
    let help = "a modulus is positive and finite in every cell of the body";
    DataError::at(Kind::Data, &[YOUNG.to_vec()], message, help)
}
