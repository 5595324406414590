//! The boundary of a body on a grid, as elements of degree 1 between grid points.

use steklov_bem_operators::{BemError, Mesh, Space};
use steklov_msfem::Grid;
use steklov_problem::Scene;

/// Boundary elements between grid points, on which loads, supports and contact of a grid are set up.
#[derive(Clone)]
pub(crate) struct GridTrace {
    /// The elements, all of degree 1.
    pub mesh: Mesh,
    /// Their nodes: node e is the first point of element e.
    pub space: Space,
    /// Lattice point of each node.
    pub lattice: Vec<[usize; 2]>,
}

impl GridTrace {
    /// The boundary with a node at each of its lattice points for which `is_node` holds, and at all corners.
    ///
    /// # Errors
    /// Elements without a length in floating point.
    pub fn new(scene: &Scene, grid: &Grid, is_node: impl Fn([usize; 2]) -> bool) -> Result<Self, BemError> {
        let near = |x: [f64; 2]| [0, 1].map(|k| ((x[k] - grid.origin[k]) / grid.spacing[k]).round() as usize);
        let edges = scene.problem.outline.edges();
        let breaks: Vec<Vec<f64>> = edges
            .iter()
            .map(|edge| {
                let [a, b] = edge.listed().map(near);
                let along = usize::from(a[0] == b[0]);
                let count = a[along].abs_diff(b[along]);
                let point = |step: usize| {
                    let mut point = a;
                    point[along] = if b[along] > a[along] { a[along] + step } else { a[along] - step };
                    point
                };
                let inner = (1..count).filter(|&step| is_node(point(step)));
                inner.map(|step| step as f64 / count as f64).collect()
            })
            .collect();
        let degree: Vec<Vec<usize>> = breaks.iter().map(|b| vec![1; b.len() + 1]).collect();
        let mesh = Mesh::from_breaks(&scene.problem.outline, &breaks, &degree)?;
        let lattice = mesh.vertices.iter().map(|&x| near(x)).collect();
        Ok(Self { space: Space::new(&mesh), mesh, lattice })
    }

    /// Lattice points from the start to the end of element e.
    pub fn points(&self, e: usize) -> Vec<[usize; 2]> {
        let (a, b) = (self.lattice[e], self.lattice[self.mesh.next[e]]);
        let along = usize::from(a[0] == b[0]);
        let point = |step: usize| {
            let mut point = a;
            point[along] = if b[along] > a[along] { a[along] + step } else { a[along] - step };
            point
        };
        (0..=a[along].abs_diff(b[along])).map(point).collect()
    }

    /// The fine cell inside of the boundary between two neighbouring points, and its side (0 lower, 1 right, 2 upper, 3 left).
    pub fn side(&self, grid: &Grid, [[i, j], [k, l]]: [[usize; 2]; 2]) -> (usize, usize) {
        // the body is to the left
        let (cell, side) = match (k > i, l > j, k < i) {
            (true, ..) => ([i, j], 0),
            (_, true, _) => ([i - 1, j], 1),
            (.., true) => ([i - 1, j - 1], 2),
            _ => ([i, j - 1], 3),
        };
        (cell[0] * grid.cells[1] + cell[1], side)
    }

    /// The fine cell at the start of element e, and its side.
    pub fn cell(&self, grid: &Grid, e: usize) -> (usize, usize) {
        let points = self.points(e);
        self.side(grid, [points[0], points[1]])
    }
}

/// The node at a lattice point of the boundary.
pub(super) fn node_at(grid: &Grid, [i, j]: [usize; 2]) -> usize {
    grid.node(i, j).unwrap_or_else(|| unreachable!("points of the boundary are nodes"))
}
