//! The displacements that given pieces leave free: v = fixed + E x, with orthonormal directions node by node.

use faer::Mat;
use steklov_algebra::{Pattern, SparseSymmetric, Symmetric};

use crate::Problem;
use crate::solvers::law::{Law, Piece};

/// The displacements on all lines of given pieces that are on.
pub(crate) struct Free {
    /// A displacement on all of the lines, m entries.
    pub fixed: Vec<f64>,
    /// The columns of E.
    pub directions: Vec<Direction>,
}

/// First unknown and number of unknowns of a node, unit direction.
pub(crate) type Direction = (usize, usize, [f64; 2]);

impl Free {
    pub fn new(problem: &Problem, laws: &[Law], pieces: &[Piece]) -> Self {
        let (mut fixed, mut directions) = (vec![0.0; problem.load.len()], Vec::new());
        for ((node, law), piece) in problem.nodes.iter().zip(laws).zip(pieces) {
            let (point, free) = law.free(piece);
            fixed[node.first..node.first + node.unknowns].copy_from_slice(&point[..node.unknowns]);
            directions.extend(free.into_iter().map(|e| (node.first, node.unknowns, e)));
        }
        Self { fixed, directions }
    }

    /// Eᵀ y.
    pub fn project(&self, y: &[f64]) -> Vec<f64> {
        project(&self.directions, y)
    }

    /// E x.
    pub fn expand(&self, x: &[f64]) -> Vec<f64> {
        expand(&self.directions, x, self.fixed.len())
    }

    /// Eᵀ S E.
    pub fn stiffness(&self, s: &Symmetric) -> Symmetric {
        match s {
            Symmetric::Full(_) => form(s, &self.directions, &self.directions).into(),
            Symmetric::Sparse(sparse) => Symmetric::Sparse(restricted(sparse, &self.directions)),
        }
    }
}

/// Eᵀ y of the columns E.
pub(crate) fn project(columns: &[Direction], y: &[f64]) -> Vec<f64> {
    let along = |&(first, k, e): &Direction| (0..k).map(|i| e[i] * y[first + i]).sum();
    columns.iter().map(along).collect()
}

/// E x of the columns E, with m entries.
pub(crate) fn expand(columns: &[Direction], x: &[f64], m: usize) -> Vec<f64> {
    let mut v = vec![0.0; m];
    for (&(first, k, e), x) in columns.iter().zip(x) {
        (0..k).for_each(|i| v[first + i] += e[i] * x);
    }
    v
}

/// Eᵀ S D of the columns E (tests) and D (trials), full storage.
pub(crate) fn form(s: &Symmetric, tests: &[Direction], trials: &[Direction]) -> Mat<f64> {
    let mut matrix = Mat::zeros(tests.len(), trials.len());
    let mut scattered = vec![0.0; s.size()];
    for (b, &(j, kj, d)) in trials.iter().enumerate() {
        for (q, &d) in d[..kj].iter().enumerate().filter(|(_, d)| **d != 0.0) {
            let column = s.full_column(j + q, &mut scattered);
            let entries = matrix.col_as_slice_mut(b).iter_mut().zip(tests);
            entries.for_each(|(entry, &(i, ki, e))| *entry += (0..ki).map(|p| e[p] * column[i + p]).sum::<f64>() * d);
        }
    }
    matrix
}

/// Eᵀ S E of the columns E; its entries are those of S between nodes that E leaves free.
fn restricted(s: &SparseSymmetric, directions: &[Direction]) -> SparseSymmetric {
    let mut along: Vec<Vec<(usize, f64)>> = vec![Vec::new(); s.pattern.size()];
    for (a, &(first, k, e)) in directions.iter().enumerate() {
        (0..k).for_each(|i| along[first + i].push((a, e[i])));
    }
    let (mut start, mut rows, mut entries) = (vec![0], Vec::new(), Vec::new());
    let (mut sum, mut is_there) = (vec![0.0; directions.len()], vec![false; directions.len()]);
    for (b, &(first, k, d)) in directions.iter().enumerate() {
        let begin = rows.len();
        for (j, d) in (first..first + k).zip(d) {
            let (of_column, values) = s.column(j);
            for (&i, value) in of_column.iter().zip(values) {
                for &(a, e) in &along[i] {
                    sum[a] += e * value * d;
                    if !std::mem::replace(&mut is_there[a], true) {
                        rows.push(a);
                    }
                }
            }
        }
        debug_assert!(is_there[b], "a block has its diagonal");
        rows[begin..].sort_unstable();
        for &a in &rows[begin..] {
            entries.push(std::mem::take(&mut sum[a]));
            is_there[a] = false;
        }
        start.push(rows.len());
    }
    let order = s.order.iter().flat_map(|&i| along[i].iter().map(|&(a, _)| a));
    let order = order.filter(|&a| !std::mem::replace(&mut is_there[a], true)).collect();
    SparseSymmetric { pattern: Pattern { start, rows }, entries, order }
}

/// The forces of all kinks that are off their lines, m entries.
pub(crate) fn off_forces(problem: &Problem, laws: &[Law], pieces: &[Piece]) -> Vec<f64> {
    let mut known = vec![0.0; problem.load.len()];
    for ((node, law), piece) in problem.nodes.iter().zip(laws).zip(pieces) {
        known[node.first..node.first + node.unknowns].copy_from_slice(&law.off_force(piece)[..node.unknowns]);
    }
    known
}
