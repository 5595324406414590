//! A body on a grid: its fine cells with their fields.

use steklov_model::grid::GridSolved;
use steklov_model::stochastic::{BodyMoments, StochasticResult};
use steklov_stochastic::Moments;
use steklov_unstructured::{Field, Grid};

/// The fine cells with displacement, stress and moduli, and the moments of all three over the outcomes of random input; the
/// boundary as lines.
pub fn cells(solved: &GridSolved, outcomes: Option<&StochasticResult>) -> Grid {
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
    let in_space = |u: &[f64]| u.chunks_exact(2).flat_map(|u| [u[0], u[1], 0.0]).collect();
    let mut point_data = vec![field("displacement", "length", 3, in_space(&solved.displacement))];
    let mut cell_data = vec![
        field("stress", "stress", 3, cells.iter().flat_map(|&c| stresses[c]).collect()),
        field("von_mises", "stress", 1, cells.iter().map(|&c| body.elasticity_of(c).von_mises(stresses[c])).collect()),
        field("young", "stress", 1, cells.iter().map(|&c| body.young[c]).collect()),
    ];
    if let Some(poisson) = body.poisson() {
        cell_data.push(field("poisson", "1", 1, cells.iter().map(|&c| poisson[c]).collect()));
    }
    if let Some(BodyMoments { displacement, stress, young }) = outcomes.and_then(|result| result.in_body.as_ref()) {
        let roots = |moments: &Moments| -> Vec<f64> { moments.variance.iter().map(|v| v.sqrt()).collect() };
        point_data.push(field("mean_displacement", "length", 3, in_space(&displacement.mean)));
        point_data.push(field("deviation_displacement", "length", 3, in_space(&roots(displacement))));
        let mut place = vec![0; grid.cells[0] * grid.cells[1]];
        grid.body_cells().enumerate().for_each(|(k, cell)| place[cell] = k);
        let of_cells = |values: &[f64], width: usize| -> Vec<f64> {
            cells.iter().flat_map(|&c| values[width * place[c]..width * (place[c] + 1)].to_vec()).collect()
        };
        cell_data.push(field("mean_stress", "stress", 3, of_cells(&stress.mean, 3)));
        cell_data.push(field("deviation_stress", "stress", 3, of_cells(&roots(stress), 3)));
        cell_data.push(field("mean_young", "stress", 1, of_cells(&young.mean, 1)));
        cell_data.push(field("deviation_young", "stress", 1, of_cells(&roots(young), 1)));
    }
    Grid {
        points: (0..grid.nodes()).map(|n| grid.point(n)).collect(),
        lines: lines.collect(),
        quads: grid.body_cells().map(|c| grid.cell_nodes(c)).collect(),
        triangles: Vec::new(),
        point_data,
        cell_data,
    }
}
