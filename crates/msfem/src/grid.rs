//! Grids of equal rectangles over an axis-aligned body.

use crate::MsfemError;

/// The entry of a lattice point that no cell of the body touches.
pub(crate) const NONE: u32 = u32::MAX;

/// nx × ny equal rectangles over the bounding box of a body; those outside of the body are dropped.
///
/// Cell (ix, iy) has the number ix·ny + iy, dropped cells included, and the local nodes (0,0), (1,0), (1,1), (0,1). Lattice
/// point (i, j) has the number j·(nx+1) + i; those that touch a cell of the body are nodes, numbered in the same order.
/// Unknown 2·node + component is a displacement.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Lower left corner of the bounding box (length).
    pub origin: [f64; 2],
    /// Sides hx, hy of a cell (length).
    pub spacing: [f64; 2],
    /// Cells along x and y.
    pub cells: [usize; 2],
    /// Whether each cell belongs to the body.
    inside: Vec<bool>,
    /// Lattice point to node.
    node: Vec<u32>,
    /// Node to lattice point.
    lattice: Vec<[u32; 2]>,
}

impl Grid {
    /// The grid of those cells for which `inside(ix, iy)` holds.
    ///
    /// # Errors
    /// [`MsfemError::Grid`] for a side that is not positive, no cell at all, or more cells than 2³⁰.
    pub fn new(
        origin: [f64; 2],
        spacing: [f64; 2],
        cells: [usize; 2],
        inside: impl Fn(usize, usize) -> bool,
    ) -> Result<Self, MsfemError> {
        let refuse = |what: String| Err(MsfemError::Grid { what });
        if let Some(h) = spacing.iter().find(|h| !(h.is_finite() && **h > 0.0)) {
            return refuse(format!("a cell has a side of length {h}; it must be positive"));
        }
        if let Some(x) = origin.iter().find(|x| !x.is_finite()) {
            return refuse(format!("the lower left corner has the coordinate {x}"));
        }
        let [nx, ny] = cells;
        if nx.saturating_mul(ny) > 1 << 30 {
            return refuse(format!("{nx} by {ny} cells are too many: 2^30 at most"));
        }
        let inside: Vec<bool> = (0..nx * ny).map(|c| inside(c / ny, c % ny)).collect();
        if !inside.contains(&true) {
            return refuse(format!("none of {nx} by {ny} cells lies in the body"));
        }
        let mut node = vec![NONE; (nx + 1) * (ny + 1)];
        for c in (0..nx * ny).filter(|&c| inside[c]) {
            let first = (c % ny) * (nx + 1) + c / ny;
            for point in [first, first + 1, first + nx + 1, first + nx + 2] {
                node[point] = 0;
            }
        }
        let mut lattice = Vec::new();
        for (point, node) in node.iter_mut().enumerate().filter(|(_, n)| **n != NONE) {
            *node = lattice.len() as u32;
            lattice.push([(point % (nx + 1)) as u32, (point / (nx + 1)) as u32]);
        }
        Ok(Self { origin, spacing, cells, inside, node, lattice })
    }

    /// A whole rectangle with the lower left corner at the origin.
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn rectangle(size: [f64; 2], cells: [usize; 2]) -> Result<Self, MsfemError> {
        Self::new([0.0; 2], [size[0] / cells[0] as f64, size[1] / cells[1] as f64], cells, |_, _| true)
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.lattice.len()
    }

    /// Number of displacement unknowns, held ones included.
    pub fn dofs(&self) -> usize {
        2 * self.nodes()
    }

    /// Whether a cell belongs to the body.
    pub fn inside(&self, ix: usize, iy: usize) -> bool {
        self.inside[ix * self.cells[1] + iy]
    }

    /// Numbers of the cells of the body, rising.
    pub fn body_cells(&self) -> impl Iterator<Item = usize> + '_ {
        self.inside.iter().enumerate().filter(|(_, inside)| **inside).map(|(c, _)| c)
    }

    /// Node at the lattice point (i, j).
    pub fn node(&self, i: usize, j: usize) -> Option<usize> {
        let node = self.node[j * (self.cells[0] + 1) + i];
        (node != NONE).then_some(node as usize)
    }

    /// The number of nodes in the rows below one, rows along x: nodes are numbered row by row.
    pub(crate) fn nodes_below(&self, row: usize) -> usize {
        self.lattice.partition_point(|[_, j]| (*j as usize) < row)
    }

    /// Lattice point of a node.
    pub fn lattice(&self, node: usize) -> [usize; 2] {
        self.lattice[node].map(|i| i as usize)
    }

    /// Position of a node.
    pub fn point(&self, node: usize) -> [f64; 2] {
        self.lattice_point(self.lattice(node))
    }

    /// Position of a lattice point.
    pub fn lattice_point(&self, [i, j]: [usize; 2]) -> [f64; 2] {
        [self.origin[0] + self.spacing[0] * i as f64, self.origin[1] + self.spacing[1] * j as f64]
    }

    /// Centre of a cell.
    pub fn centre(&self, cell: usize) -> [f64; 2] {
        let [ix, iy] = self.cell(cell);
        let [x, y] = self.lattice_point([ix, iy]);
        [x + self.spacing[0] / 2.0, y + self.spacing[1] / 2.0]
    }

    /// Column ix and row iy of a cell.
    pub fn cell(&self, cell: usize) -> [usize; 2] {
        [cell / self.cells[1], cell % self.cells[1]]
    }

    /// The four nodes of a cell of the body.
    ///
    /// # Panics
    /// For a cell that is not in the body.
    pub fn cell_nodes(&self, cell: usize) -> [usize; 4] {
        let [ix, iy] = self.cell(cell);
        let first = iy * (self.cells[0] + 1) + ix;
        [first, first + 1, first + self.cells[0] + 2, first + self.cells[0] + 1].map(|point| {
            assert!(self.node[point] != NONE, "cell {cell} is not in the body");
            self.node[point] as usize
        })
    }

    /// The cell that contains a point of the body or its boundary, and the local coordinates (ξ, η) in [0, 1]² there; on the
    /// line between cells, that of the lowest number.
    pub fn locate(&self, x: [f64; 2]) -> Option<(usize, [f64; 2])> {
        let at = [0, 1].map(|k| (x[k] - self.origin[k]) / self.spacing[k]);
        let candidates = [0, 1].map(|k| {
            let low = (at[k] - 1e-9).floor().max(0.0) as usize;
            [low, (at[k] + 1e-9).floor().max(0.0) as usize]
        });
        for ix in candidates[0] {
            for iy in candidates[1] {
                if ix < self.cells[0] && iy < self.cells[1] && self.inside(ix, iy) {
                    let local = [at[0] - ix as f64, at[1] - iy as f64];
                    if local.iter().all(|t| (-1e-9..=1.0 + 1e-9).contains(t)) {
                        return Some((ix * self.cells[1] + iy, local.map(|t| t.clamp(0.0, 1.0))));
                    }
                }
            }
        }
        None
    }

    /// The sides of cells that bound the body: cell and side (0 lower, 1 right, 2 upper, 3 left), in the order of cells.
    pub fn boundary(&self) -> Vec<(usize, usize)> {
        let [nx, ny] = self.cells;
        let mut sides = Vec::new();
        for cell in self.body_cells() {
            let [ix, iy] = self.cell(cell);
            let open = [
                iy == 0 || !self.inside(ix, iy - 1),
                ix + 1 == nx || !self.inside(ix + 1, iy),
                iy + 1 == ny || !self.inside(ix, iy + 1),
                ix == 0 || !self.inside(ix - 1, iy),
            ];
            sides.extend((0..4).filter(|&k| open[k]).map(|k| (cell, k)));
        }
        sides
    }
}
