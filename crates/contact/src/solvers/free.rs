//! The displacements that given pieces leave free: v = fixed + E x, with orthonormal directions node by node.

use faer::Mat;

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
        let mut v = vec![0.0; self.fixed.len()];
        for (&(first, k, e), x) in self.directions.iter().zip(x) {
            (0..k).for_each(|i| v[first + i] += e[i] * x);
        }
        v
    }

    /// Eᵀ S E.
    pub fn stiffness(&self, s: &Mat<f64>) -> Mat<f64> {
        form(s, &self.directions, &self.directions)
    }
}

/// Eᵀ y of the columns E.
pub(crate) fn project(columns: &[Direction], y: &[f64]) -> Vec<f64> {
    let along = |&(first, k, e): &Direction| (0..k).map(|i| e[i] * y[first + i]).sum();
    columns.iter().map(along).collect()
}

/// Eᵀ S D of the columns E (tests) and D (trials).
pub(crate) fn form(s: &Mat<f64>, tests: &[Direction], trials: &[Direction]) -> Mat<f64> {
    let mut matrix = Mat::zeros(tests.len(), trials.len());
    for (b, &(j, kj, d)) in trials.iter().enumerate() {
        for (q, &d) in d[..kj].iter().enumerate().filter(|(_, d)| **d != 0.0) {
            let column = s.col_as_slice(j + q);
            let entries = matrix.col_as_slice_mut(b).iter_mut().zip(tests);
            entries.for_each(|(entry, &(i, ki, e))| *entry += (0..ki).map(|p| e[p] * column[i + p]).sum::<f64>() * d);
        }
    }
    matrix
}

/// The forces of all kinks that are off their lines, m entries.
pub(crate) fn off_forces(problem: &Problem, laws: &[Law], pieces: &[Piece]) -> Vec<f64> {
    let mut known = vec![0.0; problem.load.len()];
    for ((node, law), piece) in problem.nodes.iter().zip(laws).zip(pieces) {
        known[node.first..node.first + node.unknowns].copy_from_slice(&law.off_force(piece)[..node.unknowns]);
    }
    known
}
