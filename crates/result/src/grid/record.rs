//! The stored and shown data of a body on a grid.

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
