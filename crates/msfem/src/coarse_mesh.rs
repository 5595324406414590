//! Coarse cells: rectangles of fine cells, of several sizes if some are split.

use crate::grid::NONE;
use crate::{Grid, MsfemError};

/// A coarse cell: fine cells first ≤ (ix, iy) < first + size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CoarseCell {
    /// Its lower left fine cell.
    pub first: [usize; 2],
    /// Fine cells along x and y.
    pub size: [usize; 2],
}

impl CoarseCell {
    /// Lattice points of the corners (0,0), (1,0), (1,1), (0,1).
    pub fn corners(&self) -> [[usize; 2]; 4] {
        let ([i, j], [m, n]) = (self.first, self.size);
        [[i, j], [i + m, j], [i + m, j + n], [i, j + n]]
    }

    /// Numbers of its fine cells in a grid, (i, j) at i·n + j.
    pub fn fine_cells(&self, grid: &Grid) -> impl Iterator<Item = usize> + '_ {
        let ny = grid.cells[1];
        let [m, n] = self.size;
        (0..m * n).map(move |c| (self.first[0] + c / n) * ny + self.first[1] + c % n)
    }

    /// Fine nodes, (i, j) at j·(m+1) + i.
    pub fn fine_nodes<'a>(&self, grid: &'a Grid) -> impl Iterator<Item = usize> + 'a {
        let ([i, j], [m, n]) = (self.first, self.size);
        (0..(m + 1) * (n + 1)).map(move |k| {
            grid.node(i + k % (m + 1), j + k / (m + 1))
                .unwrap_or_else(|| unreachable!("all fine cells of a coarse cell are in the body"))
        })
    }
}

/// A vertex inside an edge of a larger cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hanging {
    /// The vertex.
    pub vertex: usize,
    /// The vertices at the ends of the edge, the lower or left one first.
    pub ends: [usize; 2],
    /// The larger cell.
    pub cell: usize,
    /// Its side: 0 lower, 1 right, 2 upper, 3 left.
    pub side: usize,
}

/// The coarse cells of a body and their vertices.
#[derive(Debug, Clone, PartialEq)]
pub struct CoarseMesh {
    /// The cells.
    pub cells: Vec<CoarseCell>,
    /// Lattice points of the vertices, row by row.
    pub vertices: Vec<[usize; 2]>,
    /// The vertices of each cell.
    pub corners: Vec<[usize; 4]>,
    /// Vertices without unknowns of their own.
    pub hanging: Vec<Hanging>,
}

impl CoarseMesh {
    /// Equal cells of `fine` fine cells.
    ///
    /// # Errors
    /// [`MsfemError::Grid`] when the body is not made of such cells.
    pub fn uniform(grid: &Grid, fine: [usize; 2]) -> Result<Self, MsfemError> {
        let [nx, ny] = grid.cells;
        if fine.contains(&0) || nx % fine[0] != 0 || ny % fine[1] != 0 {
            let what = format!("{nx} by {ny} cells are not made of coarse cells of {} by {}", fine[0], fine[1]);
            return Err(MsfemError::Grid { what });
        }
        let mut cells = Vec::new();
        for i in (0..nx).step_by(fine[0]) {
            for j in (0..ny).step_by(fine[1]) {
                if grid.inside(i, j) {
                    cells.push(CoarseCell { first: [i, j], size: fine });
                }
            }
        }
        Self::new(grid, cells)
    }

    /// The mesh of these cells.
    ///
    /// # Errors
    /// [`MsfemError::Grid`] when they do not fill the body once, or when vertices hang on each other in a circle, as in a wall of
    /// bricks.
    pub fn new(grid: &Grid, cells: Vec<CoarseCell>) -> Result<Self, MsfemError> {
        let [nx, ny] = grid.cells;
        let mut taken = vec![false; nx * ny];
        for cell in &cells {
            let ([i, j], [m, n]) = (cell.first, cell.size);
            let fits = m > 0 && n > 0 && i + m <= nx && j + n <= ny;
            let fresh = |c: usize| grid.inside(c / ny, c % ny) && !std::mem::replace(&mut taken[c], true);
            if !fits || !cell.fine_cells(grid).all(fresh) {
                let what = format!(
                    "the coarse cell of {m} by {n} fine cells at ({i}, {j}) leaves the body or overlaps another"
                );
                return Err(MsfemError::Grid { what });
            }
        }
        if let Some(cell) = grid.body_cells().find(|&c| !taken[c]) {
            let what = format!("the fine cell ({}, {}) lies in no coarse cell", cell / ny, cell % ny);
            return Err(MsfemError::Grid { what });
        }
        let mut vertex = vec![NONE; (nx + 1) * (ny + 1)];
        let at = |[i, j]: [usize; 2]| j * (nx + 1) + i;
        for corner in cells.iter().flat_map(CoarseCell::corners) {
            vertex[at(corner)] = 0;
        }
        let mut vertices = Vec::new();
        for (point, vertex) in vertex.iter_mut().enumerate().filter(|(_, v)| **v != NONE) {
            *vertex = vertices.len() as u32;
            vertices.push([point % (nx + 1), point / (nx + 1)]);
        }
        let number = |point: [usize; 2]| vertex[at(point)] as usize;
        let corners: Vec<[usize; 4]> = cells.iter().map(|c| c.corners().map(number)).collect();
        let mut hanging = Vec::new();
        for (index, cell) in cells.iter().enumerate() {
            let c = cell.corners();
            for (side, [a, b]) in [[c[0], c[1]], [c[1], c[2]], [c[3], c[2]], [c[0], c[3]]].into_iter().enumerate() {
                let along = usize::from(a[0] == b[0]);
                for step in a[along] + 1..b[along] {
                    let mut point = a;
                    point[along] = step;
                    if vertex[at(point)] != NONE {
                        hanging.push(Hanging {
                            vertex: number(point),
                            ends: [number(a), number(b)],
                            cell: index,
                            side,
                        });
                    }
                }
            }
        }
        if let Some(vertex) = circular(vertices.len(), &hanging) {
            let [i, j] = vertices[vertex];
            let what =
                format!("the vertex ({i}, {j}) hangs between vertices that hang on it: split a coarse cell beside it");
            return Err(MsfemError::Grid { what });
        }
        Ok(Self { cells, vertices, corners, hanging })
    }

    /// Largest extent of a cell (length).
    pub fn extent(&self, grid: &Grid, cell: usize) -> f64 {
        let [m, n] = self.cells[cell].size;
        (m as f64 * grid.spacing[0]).max(n as f64 * grid.spacing[1])
    }
}

/// A hanging vertex whose ends hang, by way of any others, on itself.
fn circular(vertices: usize, hanging: &[Hanging]) -> Option<usize> {
    #[derive(Clone, Copy, PartialEq)]
    enum State {
        New,
        Begun,
        Done,
    }
    let mut ends = vec![None; vertices];
    hanging.iter().for_each(|h| ends[h.vertex] = Some(h.ends));
    let mut state = vec![State::New; vertices];
    for h in hanging {
        let mut open = vec![h.vertex];
        while let Some(&vertex) = open.last() {
            match (state[vertex], ends[vertex]) {
                (State::New, Some(ends)) => {
                    state[vertex] = State::Begun;
                    if let Some(end) = ends.into_iter().find(|end| state[*end] == State::Begun) {
                        return Some(end);
                    }
                    open.extend(ends);
                }
                _ => {
                    state[vertex] = State::Done;
                    open.pop();
                }
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(size: [usize; 2], cells: &[([usize; 2], [usize; 2])]) -> Result<CoarseMesh, MsfemError> {
        let grid = Grid::rectangle([1.0, 1.0], size).unwrap();
        CoarseMesh::new(&grid, cells.iter().map(|&(first, size)| CoarseCell { first, size }).collect())
    }

    #[test]
    fn vertices_that_hang_on_each_other_are_refused() {
        let bricks = [([0, 0], [4, 2]), ([4, 0], [4, 2]), ([0, 2], [2, 2]), ([2, 2], [4, 2]), ([6, 2], [2, 2])];
        let windmill = [([0, 0], [2, 1]), ([2, 0], [1, 2]), ([1, 2], [2, 1]), ([0, 1], [1, 2]), ([1, 1], [1, 1])];
        for (size, cells) in [([8, 4], bricks), ([3, 3], windmill)] {
            let error = mesh(size, &cells).unwrap_err();
            assert!(matches!(&error, MsfemError::Grid { what } if what.contains("that hang on it")), "{error}");
        }
    }

    #[test]
    fn vertices_that_hang_on_hanging_ones_are_not() {
        // (1, 2) hangs between (0, 2) and (2, 2), and this one between (2, 0) and (2, 4)
        let cells = [([2, 0], [4, 4]), ([0, 2], [2, 2]), ([0, 0], [1, 2]), ([1, 0], [1, 2])];
        let mesh = mesh([6, 4], &cells).unwrap();
        let mut hanging: Vec<[usize; 2]> = mesh.hanging.iter().map(|h| mesh.vertices[h.vertex]).collect();
        hanging.sort_unstable();
        assert_eq!(hanging, [[1, 2], [2, 2]]);
    }
}
