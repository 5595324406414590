//! The displacement on the outer boundary, as the elements of the grid know it.

use std::collections::HashMap;

use sprs::{CsMat, TriMat};
use steklov_bem_operators::{Edge, Mesh, Polygon, SAME_PLACE};
use steklov_elastic::plane::{cross, distance, dot};
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
        let grid = &problem.body.grid;
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
        let inner = |knots: Vec<f64>| -> Vec<f64> {
            let part = |k: usize| k as f64 / parts as f64;
            let between = knots.windows(2).flat_map(|k| (0..parts).map(move |i| k[0] + (k[1] - k[0]) * part(i)));
            between.skip(1).collect()
        };
        let breaks: Vec<Vec<f64>> = self.edge_parameters().into_iter().map(inner).collect();
        let degrees: Vec<Vec<usize>> =
            self.edge_parameters().iter().map(|k| vec![degree; parts * (k.len() - 1)]).collect();
        Ok(Mesh::from_breaks(&self.polygon, &breaks, &degrees)?)
    }

    /// Boundary elements whose vertices are the points of this trace and the vertices of a mesh of the same curve; their
    /// degrees are those of the mesh there.
    ///
    /// So a refined mesh stays refined, and nested in the trace, if the trace gets more or other points.
    ///
    /// # Errors
    /// [`CouplingError::Boundary`] unless mesh and trace are the same curve in the same direction, and as [`Trace::mesh`].
    pub fn mesh_with(&self, older: &Mesh) -> Result<Mesh, CouplingError> {
        let (mut breaks, mut degrees) = (Vec::new(), Vec::new());
        for (mut knots, edge) in self.edge_parameters().into_iter().zip(self.polygon.edges()) {
            let mut pieces = Vec::new();
            for e in 0..older.len() {
                pieces.extend(on_edge(edge, older.ends(e)).map(|ends| (ends, older.degree[e])));
            }
            let covered: f64 = pieces.iter().map(|([from, to], _)| to - from).sum();
            if (covered - 1.0).abs() > 1e-6 {
                let [[a, b], [c, d]] = [edge.start, edge.end];
                let what = format!("of the edge from ({a}, {b}) to ({c}, {d}) they cover {covered:.3} only");
                return Err(CouplingError::Boundary { what });
            }
            for ([from, _], _) in &pieces {
                if knots.iter().all(|k| (k - from).abs() > SAME_PLACE) {
                    knots.push(*from);
                }
            }
            knots.sort_by(f64::total_cmp);
            let degree = |middle: f64| {
                let at = |(ends, _): &&([f64; 2], usize)| ends[0] <= middle && middle <= ends[1];
                pieces.iter().find(at).map_or(1, |(_, degree)| *degree)
            };
            degrees.push(knots.windows(2).map(|k| degree((k[0] + k[1]) / 2.0)).collect());
            breaks.push(knots[1..knots.len() - 1].to_vec());
        }
        Ok(Mesh::from_breaks(&self.polygon, &breaks, &degrees)?)
    }

    /// Edge parameters of the points on each edge of the polygon, from 0 to 1.
    fn edge_parameters(&self) -> Vec<Vec<f64>> {
        let mut points = self.points.iter().peekable();
        let on = |edge: &Edge| {
            let (start, length) = (edge.start, edge.length());
            let mut knots = vec![0.0];
            points.next();
            while let Some(x) = points.next_if(|x| **x != edge.end) {
                knots.push(distance(*x, start) / length);
            }
            knots.push(1.0);
            knots
        };
        self.polygon.edges().iter().map(on).collect()
    }
}

/// Edge parameters of a piece of the curve that lies on an edge.
fn on_edge(edge: &Edge, ends: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let length = edge.length();
    let d = [0, 1].map(|i| (edge.end[i] - edge.start[i]) / length);
    let place = |x: [f64; 2]| {
        let r = [0, 1].map(|i| (x[i] - edge.start[i]) / length);
        (dot(r, d), cross(d, r))
    };
    let [(from, a), (to, b)] = ends.map(place);
    let inside = |s: f64| (-SAME_PLACE..=1.0 + SAME_PLACE).contains(&s);
    let near = a.abs().max(b.abs()) < SAME_PLACE.max(1e-9 * (to - from));
    (near && from < to && inside(from) && inside(to)).then_some([from, to])
}

/// Displacement of the fine nodes of the outline by the unknowns of its coarse vertices (node, first unknown).
fn oscillatory(
    problem: &Multiscale<'_>,
    outline: &Outline,
    vertices: &[(usize, usize)],
) -> Result<CsMat<f64>, CouplingError> {
    let grid = &problem.body.grid;
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
