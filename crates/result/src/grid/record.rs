//! The stored and shown data of a body on a grid.

use steklov_io::vtkhdf::{Field, Grid as VtkGrid};
use steklov_model::grid::{GridSolved, OnGrid};
use steklov_model::run::adaptive_loop::Step;
use steklov_msfem::{CoarseMesh, HeterogeneousBody};

/// The grid of a result. The cells of the body are the quadrilaterals of the result and its nodes are the points, in
/// the same order.
#[derive(Debug, Clone)]
pub struct GridRecord {
    /// Fine cells, moduli, Poisson's ratio.
    pub body: HeterogeneousBody,
    /// Coarse cells; None for bilinear elements on the fine grid.
    pub coarse: Option<CoarseMesh>,
    /// Displacement of the coarse vertices (length), hanging ones included.
    pub vertex_displacement: Vec<[f64; 2]>,
    /// The steps.
    pub steps: Vec<Step<OnGrid>>,
}

/// The record of a solved grid.
pub(crate) fn grid_record(solved: &GridSolved, steps: Vec<Step<OnGrid>>) -> GridRecord {
    let coarse = solved.coarse.as_ref();
    GridRecord {
        body: solved.body.clone(),
        coarse: coarse.map(|c| c.mesh.clone()),
        vertex_displacement: coarse.map_or(Vec::new(), |c| c.displacement.clone()),
        steps,
    }
}

/// The fine cells with displacement, stress and moduli; the boundary as lines.
pub(crate) fn vtk(solved: &GridSolved) -> VtkGrid {
    let body = &solved.body;
    let grid = &body.grid;
    let stresses = body.stresses(&solved.displacement);
    let boundary = grid.boundary();
    let lines = boundary.iter().map(|&(cell, side)| {
        let nodes = grid.cell_nodes(cell);
        [nodes[side], nodes[(side + 1) % 4]]
    });
    // lines have the values of the cells beside them
    let cells: Vec<usize> = boundary.iter().map(|(cell, _)| *cell).chain(grid.body_cells()).collect();
    let field = |name: &str, unit: &str, components: usize, values: Vec<f64>| Field {
        name: name.into(),
        unit: unit.into(),
        components,
        values,
    };
    VtkGrid {
        points: (0..grid.nodes()).map(|n| grid.point(n)).collect(),
        lines: lines.collect(),
        quads: grid.body_cells().map(|c| grid.cell_nodes(c)).collect(),
        triangles: Vec::new(),
        point_data: vec![field(
            "displacement",
            "length",
            3,
            solved.displacement.chunks_exact(2).flat_map(|u| [u[0], u[1], 0.0]).collect(),
        )],
        cell_data: vec![
            field("stress", "stress", 3, cells.iter().flat_map(|&c| stresses[c]).collect()),
            field("von_mises", "stress", 1, cells.iter().map(|&c| body.elasticity.von_mises(stresses[c])).collect()),
            field("young", "stress", 1, cells.iter().map(|&c| body.young[c]).collect()),
        ],
    }
}
