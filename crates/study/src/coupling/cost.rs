//! Elimination down to the interface, compared with one sparse matrix that contains the dense block of the medium.

use std::time::Instant;

use faer::{Mat, MatMut};
use sprs::CsMat;
use steklov_algebra::{Pattern, Structure};
use steklov_bem_operators::{Domain, Polygon, Steklov};
use steklov_coupling::{CouplingError, Form, Interior, Radiation, Transmission};
use steklov_msfem::MsfemError;

use super::grids::Level;
use super::manufactured::{Manufactured, Pair};
use crate::median;
use crate::table::Column;
use crate::watch::{Found, Watch};

/// The ways and their names.
pub const WAYS: [&str; 3] = ["elimination to the interface", "S inserted, boundary last", "S inserted, AMD ordering"];

/// Largest difference of two solutions, over the largest displacement, that counts as rounding.
const SAME: f64 = 1e-10;

/// One grid, solved in three ways.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Cells along x and y, over the bounding box.
    pub cells: [usize; 2],
    /// Displacement unknowns of the body.
    pub dofs: usize,
    /// Displacement unknowns on its outer boundary.
    pub trace: usize,
    /// Wall seconds by way, from the matrices of body and boundary elements to the displacements; each way computes S.
    pub seconds: [f64; 3],
    /// Wall seconds of S alone.
    pub steklov: f64,
    /// Entries by way: of the sparse factor, for the elimination with three dense matrices of the interface.
    pub entries: [f64; 3],
    /// Largest difference of the displacements over the largest one.
    pub difference: f64,
}

/// Columns of the costs.
pub(super) const COSTS: [Column<Cost>; 12] = [
    ("cells_x", "1", "cells along x", |c| c.cells[0] as f64),
    ("cells_y", "1", "cells along y", |c| c.cells[1] as f64),
    ("dofs", "1", "displacement unknowns of the body", |c| c.dofs as f64),
    ("trace", "1", "those on its outer boundary", |c| c.trace as f64),
    ("elimination", "seconds", "elimination to the interface, S included", |c| c.seconds[0]),
    ("inserted", "seconds", "S inserted, nested dissection with the boundary last, S included", |c| c.seconds[1]),
    ("inserted_amd", "seconds", "S inserted, approximate minimum degree, S included", |c| c.seconds[2]),
    ("steklov", "seconds", "S alone, part of all three", |c| c.steklov),
    ("elimination_entries", "1", "sparse factor, and three dense matrices of the interface", |c| c.entries[0]),
    ("inserted_entries", "1", "sparse factor, nested dissection with the boundary last", |c| c.entries[1]),
    ("inserted_amd_entries", "1", "sparse factor, approximate minimum degree", |c| c.entries[2]),
    ("difference", "1", "largest difference of the displacements over the largest one", |c| c.difference),
];

/// Costs by grid.
pub type Costs = Found<Cost>;

/// Solves one pair on all grids, each way `repeat` times. After a request to stop nothing more is solved. Solutions
/// that differ by more than 1e-10 are a failure.
pub fn costs(polygon: &Polygon, pair: &Pair, levels: &[Level], repeat: usize, watch: &mut Watch<'_>) -> Costs {
    let mut all = Costs::default();
    let exact = Manufactured::new(polygon, pair);
    for level in levels {
        if watch.stopped() {
            return all;
        }
        let at = format!("cost, {} by {} cells", level.grid.cells[0], level.grid.cells[1]);
        watch.tell("cost", &at);
        let found = cost(&exact, level, repeat.max(1));
        // a NaN counts as a difference
        if let Some(apart) = found.as_ref().ok().map(|c| c.difference).filter(|d| d.is_nan() || *d > SAME) {
            all.failures.push((at.clone(), format!("the solutions differ by {apart:.1e} of the largest")));
        }
        all.take(at, found.map(Some));
    }
    all
}

fn cost(exact: &Manufactured<'_>, level: &Level, repeat: usize) -> Result<Cost, CouplingError> {
    let problem = exact.problem(&level.grid)?;
    let interior = Interior::fine(&problem.body, &problem.loads)?;
    let exterior = exact.exterior(&interior)?;
    let jump = exterior.space.interpolate(|x| exact.jump(x));
    let order = boundary_last(&interior);
    let n = level.trace as f64;
    let eliminated = structure(&interior.stiffness, Some(&order))?.0.factor_entries() as f64 + 3.0 * n * n;
    let (mut seconds, mut entries) = ([const { Vec::new() }; 3], [eliminated, 0.0, 0.0]);
    let (mut steklov, mut solutions) = (Vec::new(), [const { Vec::new() }; 3]);
    for _ in 0..repeat {
        let given = interior.clone();
        let start = Instant::now();
        let solved = Transmission::new(given, &exterior)?.solve(&jump, Form::Schur, Radiation::Decaying)?;
        seconds[0].push(start.elapsed().as_secs_f64());
        solutions[0] = solved.displacement;
        for (way, order) in [(1, Some(&order[..])), (2, None)] {
            let start = Instant::now();
            let s = Steklov::new(exterior.operators.clone(), Domain::Exterior)?.matrix;
            steklov.push(start.elapsed().as_secs_f64());
            let (solution, count) = inserted(&interior, &s, &jump, order)?;
            seconds[way].push(start.elapsed().as_secs_f64());
            (solutions[way], entries[way]) = (solution, count as f64);
        }
    }
    let largest = solutions[0].iter().fold(0.0f64, |m, u| m.max(u.abs()));
    let apart = |other: &[f64]| solutions[0].iter().zip(other).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
    Ok(Cost {
        cells: level.grid.cells,
        dofs: level.grid.dofs(),
        trace: level.trace,
        seconds: seconds.map(|mut s| median(&mut s)),
        steklov: median(&mut steklov),
        entries,
        difference: apart(&solutions[1]).max(apart(&solutions[2])) / largest,
    })
}

/// The unknowns in the order of elimination of the body, with the boundary unknowns last.
fn boundary_last(interior: &Interior) -> Vec<usize> {
    let mut on_boundary = vec![false; interior.load.len()];
    interior.trace.unknowns.iter().for_each(|&u| on_boundary[u] = true);
    let inside = interior.order.iter().flat_map(|n| [2 * n, 2 * n + 1]).filter(|&u| !on_boundary[u]);
    inside.chain(interior.trace.unknowns.iter().copied()).collect()
}

/// (A + Pᵀ S P) u = F + Pᵀ S u0 as one sparse system; returns the displacements and the number of entries of its
/// factor.
fn inserted(
    interior: &Interior,
    s: &Mat<f64>,
    jump: &[f64],
    order: Option<&[usize]>,
) -> Result<(Vec<f64>, usize), MsfemError> {
    let size = interior.load.len();
    let unknowns = &interior.trace.unknowns;
    let mut sorted: Vec<(usize, usize)> = unknowns.iter().enumerate().map(|(k, &u)| (u, k)).collect();
    sorted.sort_unstable();
    let (mut start, mut columns, mut values) = (vec![0; size + 1], Vec::new(), Vec::new());
    for &(row, i) in &sorted {
        start[row + 1] = sorted.len();
        for &(column, j) in &sorted {
            columns.push(column);
            values.push(s[(i, j)]);
        }
    }
    (0..size).for_each(|row| start[row + 1] += start[row]);
    let block = CsMat::new((size, size), start, columns, values);
    let mut u = interior.load.clone();
    for (i, &row) in unknowns.iter().enumerate() {
        u[row] += jump.iter().enumerate().map(|(j, u0)| s[(i, j)] * u0).sum::<f64>();
    }
    let (structure, entries) = structure(&(&interior.stiffness + &block), order)?;
    let par = faer::get_global_parallelism();
    let factor = structure.factorise(&entries, par).map_err(|none| MsfemError::of_factor(none, size))?;
    factor.solve(MatMut::from_column_major_slice_mut(&mut u, size, 1), par);
    Ok((u, structure.factor_entries()))
}

/// The structure of the factor of a symmetric matrix that is stored with both triangles, in an order or by approximately minimum
/// degree, and the entries of the matrix in its lower triangle, column by column.
fn structure(full: &CsMat<f64>, order: Option<&[usize]>) -> Result<(Structure, Vec<f64>), MsfemError> {
    let (mut pattern, mut entries) = (Pattern { start: vec![0], rows: Vec::new() }, Vec::new());
    for (j, line) in full.outer_iterator().enumerate() {
        for (i, &value) in line.iter().filter(|(i, _)| *i >= j) {
            pattern.rows.push(i);
            entries.push(value);
        }
        pattern.start.push(entries.len());
    }
    let structure = match order {
        Some(order) => Structure::new(pattern, order),
        None => Structure::by_minimum_degree(pattern),
    };
    Ok((structure.map_err(|none| MsfemError::of_factor(none, full.rows()))?, entries))
}
