//! The displacement on the outer boundary, as the elements of the grid know it.

use std::collections::HashMap;

use sprs::{CsMat, TriMat};
use steklov_bem_operators::{Mesh, Polygon};
use steklov_msfem::{Basis, CellBasis, Grid, Multiscale};

use crate::{CouplingError, Outline};

/// A displacement that is linear between points of the outer boundary, and depends on some unknowns of the body.
#[derive(Debug, Clone)]
pub struct Trace {
    /// The outer boundary.
    pub polygon: Polygon,
    /// The points, counter-clockwise from the first corner of the polygon; all corners are among them.
    pub points: Vec<[f64; 2]>,
    /// Unknowns of the body on which the displacement depends.
    pub unknowns: Vec<usize>,
    /// Displacement of the points, two rows a point, by these unknowns (dimensionless).
    pub values: CsMat<f64>,
}

impl Trace {
    /// Bilinear elements on all fine cells: the points are their nodes.
    pub fn fine(grid: &Grid, outline: &Outline) -> Self {
        let points = outline.nodes.iter().map(|&n| grid.point(n)).collect();
        Self::nodal(outline, points, outline.nodes.iter().map(|n| 2 * n))
    }

    /// Multiscale elements. The points are the coarse vertices where the basis is linear between them, and the fine nodes for
    /// [`Basis::Oscillatory`].
    ///
    /// # Errors
    /// [`CouplingError::Inconsistent`] for a basis that is not conforming, [`CouplingError::Msfem`].
    pub fn coarse(problem: &Multiscale<'_>, outline: &Outline) -> Result<Self, CouplingError> {
        if !problem.basis.is_conforming() {
            let what = format!(
                "the basis \"{}\" has no single displacement on the outer boundary: take \"coupled\" or \"oscillatory\"",
                problem.basis.word()
            );
            return Err(CouplingError::Inconsistent { what });
        }
        let grid = &problem.medium.grid;
        let vertex: HashMap<[usize; 2], usize> =
            problem.mesh.vertices.iter().enumerate().map(|(v, &point)| (point, v)).collect();
        let found = |node: usize| {
            let vertex = vertex.get(&grid.lattice(node))?;
            // an edge of the boundary has cells on one side only: no vertex hangs on it
            problem.unknown[*vertex]
        };
        let vertices: Vec<(usize, usize)> = outline.nodes.iter().filter_map(|&n| Some((n, found(n)?))).collect();
        let unknowns = vertices.iter().map(|(_, unknown)| *unknown);
        if problem.basis != Basis::Oscillatory {
            let points = vertices.iter().map(|(node, _)| grid.point(*node)).collect();
            return Ok(Self::nodal(outline, points, unknowns));
        }
        let mut this = Self::fine(grid, outline);
        this.values = oscillatory(problem, outline, &vertices)?;
        this.unknowns = unknowns.flat_map(|u| [u, u + 1]).collect();
        Ok(this)
    }

    /// Points with unknowns of their own, given by the first of two.
    fn nodal(outline: &Outline, points: Vec<[f64; 2]>, first: impl Iterator<Item = usize>) -> Self {
        let unknowns: Vec<usize> = first.flat_map(|u| [u, u + 1]).collect();
        let values = CsMat::eye(unknowns.len());
        Self { polygon: outline.polygon.clone(), points, unknowns, values }
    }

    /// Boundary elements of one degree: `parts` between each two neighbouring points.
    ///
    /// # Errors
    /// [`CouplingError::Bem`] for no part, degree 0, or elements without a length in floating point.
    pub fn mesh(&self, parts: usize, degree: usize) -> Result<Mesh, CouplingError> {
        let edges = self.polygon.edges();
        let n = self.points.len();
        let (mut breaks, mut degrees) = (vec![Vec::new(); edges.len()], vec![Vec::new(); edges.len()]);
        let mut edge = 0;
        for k in 0..n {
            if k > 0 && self.points[k] == edges[edge].end {
                edge += 1;
            }
            let [a, b] = [self.points[k], self.points[(k + 1) % n]];
            let length = edges[edge].length();
            let [from, to] = [a, b].map(|x| {
                let start = edges[edge].start;
                (x[0] - start[0]).hypot(x[1] - start[1]) / length
            });
            for part in 0..parts {
                if part > 0 || a != edges[edge].start {
                    breaks[edge].push(from + (to - from) * part as f64 / parts as f64);
                }
                degrees[edge].push(degree);
            }
        }
        Ok(Mesh::from_breaks(&self.polygon, &breaks, &degrees)?)
    }
}

/// Displacement of the fine nodes of the outline by the unknowns of its coarse vertices (node, first unknown).
fn oscillatory(
    problem: &Multiscale<'_>,
    outline: &Outline,
    vertices: &[(usize, usize)],
) -> Result<CsMat<f64>, CouplingError> {
    let grid = &problem.medium.grid;
    let column: HashMap<usize, usize> = vertices.iter().enumerate().map(|(k, (_, u))| (*u, 2 * k)).collect();
    let mut around = vec![0; grid.cells[0] * grid.cells[1]];
    for (coarse, cell) in problem.mesh.cells.iter().enumerate() {
        cell.fine_cells(grid).for_each(|fine| around[fine] = coarse);
    }
    let mut values = TriMat::new((2 * outline.nodes.len(), 2 * vertices.len()));
    let mut last: Option<(usize, CellBasis)> = None;
    for (k, (&node, &(fine, _))) in outline.nodes.iter().zip(&outline.sides).enumerate() {
        let coarse = around[fine];
        let basis = match last.take() {
            Some((cell, basis)) if cell == coarse => basis,
            _ => problem.cell_basis(coarse)?,
        };
        let cell = problem.mesh.cells[coarse];
        let [i, j] = grid.lattice(node);
        let local = (j - cell.first[1]) * (cell.size[0] + 1) + i - cell.first[0];
        for component in 0..2 {
            for (c, &value) in basis.values[2 * local + component].iter().enumerate() {
                let unknown = problem.unknown[problem.mesh.corners[coarse][c / 2]];
                // the functions of corners off the boundary vanish on it
                if let Some(first) = unknown.and_then(|u| column.get(&u)).filter(|_| value != 0.0) {
                    values.add_triplet(2 * k + component, first + c % 2, value);
                }
            }
        }
        last = Some((coarse, basis));
    }
    Ok(values.to_csr())
}
