//! The multiscale basis of a step, and the matrix that maps coarse unknowns to fine ones.

use faer::Mat;
use steklov_io::{
    Group, IoError, create_group, invalid, label, save_dense, save_integers, save_pairs, save_points, save_rows,
    save_sparse, save_text, save_vector,
};
use steklov_msfem::{MsfemError, Multiscale};

use super::BASIS;

const LOCAL: &str = "local unknown: 2 corner + component";
const CELL: &str = "coarse cell";
const FINE: &str = "fine unknown: 2 fine node + component";
const COARSE: &str = "coarse unknown: 2 coarse vertex that does not hang + component";

/// Bases, cells, C, P and K; the attribute `meaning` of `P` has the formula of the coarse stiffness.
pub(super) fn save_basis(step: &Group, problem: &Multiscale<'_>) -> Result<(), IoError> {
    let at = create_group(step, BASIS)?;
    let failed = |name: &str, e: MsfemError| invalid(&at, name, e.to_string());
    save_text(&at, "kind", problem.basis.word(), "kind of the basis, as in the scene")?;
    save_patterns(&at, problem)?;
    save_cells(&at, problem)?;

    let meaning = "C: displacement of all coarse vertices of the coarse unknowns, those that hang included";
    let axes = ["2 vertex + component", COARSE];
    save_sparse(&at, "C", &problem.vertex_matrix(), &label("1", meaning, &axes))?;
    let meaning = match problem.basis.is_conforming() {
        true => "P: rows of R_T C_T, C_T the rows of C at the corners of T, with K_H = P^T K P",
        false => {
            "P: mean over the cells T at a fine node of the rows of R_T C_T, C_T the rows of C at the corners of T; the \
             functions do not conform, and K_H = sum over the cells of factor C_T^T K_T C_T, not P^T K P"
        }
    };
    let prolongation = problem.prolongation().map_err(|e| failed("P", e))?;
    save_sparse(&at, "P", &prolongation, &label("1", meaning, &[FINE, COARSE]))?;
    drop(prolongation);
    let meaning = "stiffness of the fine grid: sum over its cells of young K_0";
    save_sparse(&at, "K", &problem.body.stiffness(), &label("stress", meaning, &[FINE, FINE]))
}

/// R and K_T of all patterns.
fn save_patterns(at: &Group, problem: &Multiscale<'_>) -> Result<(), IoError> {
    let mesh = &problem.mesh;
    let count = problem.patterns();
    let size = |pattern: usize| mesh.cells[problem.cells_of(pattern)[0]].size;
    let mut offset = vec![0];
    for pattern in 0..count {
        let [m, n] = size(pattern);
        offset.push(offset[pattern] + 2 * (m + 1) * (n + 1));
    }
    let mut stiffness = Mat::zeros(8 * count, 8);
    let rows = "2 local fine node + component of the patterns, one behind the other; local node (i, j) is j (m+1) + i";
    let meaning = "R: displacement of the fine nodes of a coarse cell of the displacement of its corners \
                   (0,0), (1,0), (1,1), (0,1); of pattern p in rows offset[p] to offset[p+1]";
    let mut table = save_rows(at, "R", [offset[count], 8], &label("1", meaning, &[rows, LOCAL]))?;
    for pattern in 0..count {
        let basis = problem.pattern_basis(pattern).map_err(|e| invalid(at, "R", e.to_string()))?;
        table.push(basis.values.as_flattened())?;
        (0..8).for_each(|i| (0..8).for_each(|j| stiffness[(8 * pattern + i, j)] = basis.stiffness[i][j]));
    }
    table.finish()?;
    save_integers(at, "offset", &offset, &label("1", "first row of each pattern in R, and the end", &["pattern"]))?;
    let sizes: Vec<[usize; 2]> = (0..count).map(size).collect();
    save_pairs(at, "pattern_size", &sizes, &label("1", "fine cells m, n of its coarse cells", &["pattern", "xy"]))?;
    let first: Vec<usize> = (0..count).map(|pattern| problem.cells_of(pattern)[0]).collect();
    save_integers(at, "pattern_cell", &first, &label("1", "the first coarse cell of each pattern", &["pattern"]))?;
    let meaning = "K_T = R^T K R of the first coarse cell of each pattern, K = sum over its fine cells of young K_0";
    let axes = &["8 pattern + local unknown", LOCAL];
    save_dense(at, "K_T", stiffness.as_ref(), &label("stress", meaning, axes))?;
    let unit = problem.body.elasticity.unit_stiffness(problem.body.grid.spacing);
    let unit = Mat::from_fn(8, 8, |i, j| unit[i][j]);
    let meaning = "K_0: stiffness of a fine cell with Young's modulus 1, its corners as those of coarse cells";
    save_dense(at, "K_0", unit.as_ref(), &label("1", meaning, &[LOCAL, LOCAL]))
}

/// Coarse and fine cells, their vertices and nodes.
fn save_cells(at: &Group, problem: &Multiscale<'_>) -> Result<(), IoError> {
    let (mesh, grid) = (&problem.mesh, &problem.body.grid);
    let (first, size): (Vec<_>, Vec<_>) = mesh.cells.iter().map(|cell| (cell.first, cell.size)).unzip();
    let xy = &[CELL, "xy"];
    save_pairs(at, "first", &first, &label("1", "lower left fine cell of each coarse cell", xy))?;
    save_pairs(at, "size", &size, &label("1", "its fine cells along x and y", xy))?;
    let pattern = problem.pattern_of_cells();
    save_integers(at, "pattern", &pattern, &label("1", "its pattern: which basis it has", &[CELL]))?;
    let factor: Vec<f64> = pattern.iter().enumerate().map(|(c, &p)| problem.modulus_factor(c, p)).collect();
    let meaning = "its moduli over those of the first cell of its pattern: its stiffness is factor K_T";
    save_vector(at, "factor", &factor, &label("1", meaning, &[CELL]))?;
    let corners: Vec<usize> = mesh.corners.iter().flatten().copied().collect();
    let meaning = "the vertices at its corners (0,0), (1,0), (1,1), (0,1), as rows of vertices and of C";
    save_integers(at, "corners", &corners, &label("1", meaning, &["4 coarse cell + corner"]))?;
    let meaning = "lattice points of the coarse vertices";
    save_pairs(at, "vertices", &mesh.vertices, &label("1", meaning, &["vertex", "xy"]))?;

    let lattice: Vec<[usize; 2]> = (0..grid.nodes()).map(|node| grid.lattice(node)).collect();
    save_pairs(at, "nodes", &lattice, &label("1", "lattice points of the fine nodes", &["fine node", "xy"]))?;
    let cells: Vec<usize> = grid.body_cells().collect();
    let places: Vec<[usize; 2]> = cells.iter().map(|&cell| grid.cell(cell)).collect();
    let axis = "fine cell of the body";
    save_pairs(at, "fine_cells", &places, &label("1", "lattice point at the lower left corner", &[axis, "xy"]))?;
    let young: Vec<f64> = cells.iter().map(|&cell| problem.body.young[cell]).collect();
    save_vector(at, "young", &young, &label("stress", "Young's modulus", &[axis]))?;
    let points = [grid.origin, grid.spacing];
    save_points(at, "place", &points, &label("length", "origin of the lattice, and its spacing", &["value", "xy"]))
}
