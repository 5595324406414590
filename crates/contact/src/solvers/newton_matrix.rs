//! The matrix S + Σ (D/θ) d dᵀ of the steps of an interior point method, and its Cholesky factor.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::cholesky::llt::solve::solve_in_place;
use faer::{ColMut, Mat, Par};
use steklov_algebra::{SparseCholesky, Structure, Symmetric};

/// The lower triangle of the matrix in the storage of S, and its factor; each step writes both anew.
pub(crate) enum NewtonMatrix {
    /// The factor takes the place of the matrix.
    Full { matrix: Mat<f64>, memory: MemBuffer },
    /// The factors of all steps have one structure; none where it does not fit into memory.
    Sparse { structure: Option<Structure>, of_stiffness: Vec<f64>, entries: Vec<f64>, factor: Option<SparseCholesky> },
}

impl NewtonMatrix {
    pub fn new(stiffness: &Symmetric) -> Self {
        match stiffness {
            Symmetric::Full(full) => {
                let size = full.nrows();
                let memory = MemBuffer::new(cholesky_in_place_scratch::<f64>(size, Par::Seq, Default::default()));
                Self::Full { matrix: Mat::zeros(size, size), memory }
            }
            Symmetric::Sparse(sparse) => {
                let (pattern, of_stiffness) = sparse.lower();
                let structure = Structure::new(pattern, &sparse.order).ok();
                Self::Sparse { structure, of_stiffness, entries: Vec::new(), factor: None }
            }
        }
    }

    /// The matrix is S.
    pub fn reset(&mut self, stiffness: &Symmetric) {
        match (self, stiffness) {
            (Self::Full { matrix, .. }, Symmetric::Full(full)) => matrix.copy_from(full),
            (Self::Sparse { of_stiffness, entries, .. }, _) => entries.clone_from(of_stiffness),
            _ => unreachable!("the storage is that of S"),
        }
    }

    /// Adds to an entry of the lower triangle.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        match self {
            Self::Full { matrix, .. } => matrix[(i, j)] += value,
            Self::Sparse { structure: Some(structure), entries, .. } => {
                let place = structure.pattern.place(i, j).expect("the unknowns of a node are in one block");
                entries[place] += value;
            }
            Self::Sparse { .. } => {}
        }
    }

    /// Whether there is a factor now.
    pub fn factorise(&mut self) -> bool {
        match self {
            Self::Full { matrix, memory } => {
                let plain = LltRegularization::default();
                cholesky_in_place(matrix.as_mut(), plain, Par::Seq, MemStack::new(memory), Default::default()).is_ok()
            }
            Self::Sparse { structure, entries, factor, .. } => {
                *factor = structure.as_ref().and_then(|structure| structure.factorise(entries, Par::Seq).ok());
                factor.is_some()
            }
        }
    }

    /// A⁻¹ x in place of x.
    pub fn solve(&self, x: &mut [f64]) {
        let x = ColMut::from_slice_mut(x).as_mat_mut();
        match self {
            Self::Full { matrix, .. } => {
                let stack = &mut MemBuffer::new(StackReq::EMPTY);
                solve_in_place(matrix.as_ref(), x, Par::Seq, MemStack::new(stack));
            }
            Self::Sparse { factor, .. } => factor.as_ref().expect("it was factorised").solve(x, Par::Seq),
        }
    }
}
