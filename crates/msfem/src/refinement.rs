//! Splitting coarse cells where the indicators are large.

use crate::{CoarseCell, CoarseMesh, Grid, MsfemError};

/// Indicators that differ by less than this part are equal, so that rounding breaks no symmetry.
const TIE: f64 = 1e-6;

/// The smallest set of coarse cells with Σ η² ≥ θ times the whole, and those whose η² equals that of the last of them.
/// Indicators that are 0 or NaN are not marked.
///
/// Source: Dörfler, *A convergent adaptive algorithm for Poisson's equation*, SIAM J. Numer. Anal. 33 (1996), with η² for
/// η.
pub fn mark(squared: &[f64], theta: f64) -> Vec<bool> {
    let mut order: Vec<f64> = squared.iter().copied().filter(|e| *e > 0.0).collect();
    order.sort_unstable_by(|a, b| b.total_cmp(a));
    let whole: f64 = order.iter().sum();
    let mut sum = 0.0;
    let last = order.iter().find(|&&e| {
        sum += e;
        sum >= theta * whole
    });
    // the sum of all may miss the whole by rounding
    let last = last.or(order.last()).copied().unwrap_or(f64::INFINITY);
    squared.iter().map(|&e| e > 0.0 && e >= last * (1.0 - TIE)).collect()
}

/// Splits the marked cells, and others until at most one vertex hangs on each edge.
///
/// A side of m ≥ 2 fine cells is split into ⌊m/2⌋ and the rest, a side of one is not: a cell becomes 2 × 2, 1 × 2 or 2 × 1,
/// and one of a single fine cell stays. All cells that come from equal ones are split at the same lines, so that no other
/// vertices hang than those of neighbours that were split once more. Cells are ordered by their lower left fine cell. If
/// nothing can be split, the mesh keeps its cells.
///
/// The spaces of coarse bilinear functions are nested. Multiscale bases are not: a function of the large cell is not linear on
/// the new edges, and errors may grow where the new cells are of the size of the heterogeneities.
///
/// # Errors
/// [`MsfemError::Inconsistent`] for another number of marks than cells.
pub fn refine(grid: &Grid, mesh: &CoarseMesh, marked: &[bool]) -> Result<CoarseMesh, MsfemError> {
    if marked.len() != mesh.cells.len() {
        let what = format!("{} marks for {} coarse cells", marked.len(), mesh.cells.len());
        return Err(MsfemError::Inconsistent { what });
    }
    let mut next = split(grid, mesh, marked)?;
    loop {
        let mut on_edge = vec![[0; 4]; next.cells.len()];
        next.hanging.iter().for_each(|h| on_edge[h.cell][h.side] += 1);
        let crowded: Vec<bool> = on_edge.iter().map(|count| count.iter().any(|c| *c > 1)).collect();
        if !crowded.contains(&true) {
            return Ok(next);
        }
        // a crowded side has at least three fine cells: this comes to an end
        next = split(grid, &next, &crowded)?;
    }
}

fn split(grid: &Grid, mesh: &CoarseMesh, marked: &[bool]) -> Result<CoarseMesh, MsfemError> {
    let mut cells = Vec::new();
    for (cell, marked) in mesh.cells.iter().zip(marked) {
        let parts = |k: usize| -> Vec<[usize; 2]> {
            let (first, size) = (cell.first[k], cell.size[k]);
            if *marked && size > 1 {
                vec![[first, size / 2], [first + size / 2, size - size / 2]]
            } else {
                vec![[first, size]]
            }
        };
        for [i, m] in parts(0) {
            cells.extend(parts(1).into_iter().map(|[j, n]| CoarseCell { first: [i, j], size: [m, n] }));
        }
    }
    cells.sort_unstable();
    CoarseMesh::new(grid, cells)
}
