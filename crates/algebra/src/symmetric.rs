//! Symmetric matrices in full storage, or without the zeros of a sum of blocks.

use std::ops::Index;

use faer::{Mat, MatRef};

use crate::sparse::{NoSparseFactor, Pattern, Structure};

/// A symmetric matrix.
#[derive(Debug, Clone)]
pub enum Symmetric {
    /// All entries.
    Full(Mat<f64>),
    /// Those that some block has.
    Sparse(SparseSymmetric),
}

/// The entries of a sum of blocks, in both triangles, column by column; rows rise in each column.
#[derive(Debug, Clone)]
pub struct SparseSymmetric {
    /// Their places.
    pub pattern: Pattern,
    /// The entries.
    pub entries: Vec<f64>,
    /// The unknowns in an order in which few entries of a Cholesky factor are not zero.
    pub order: Vec<usize>,
}

impl From<Mat<f64>> for Symmetric {
    fn from(matrix: Mat<f64>) -> Self {
        Self::Full(matrix)
    }
}

impl Index<(usize, usize)> for Symmetric {
    type Output = f64;

    fn index(&self, (i, j): (usize, usize)) -> &f64 {
        match self {
            Self::Full(matrix) => &matrix[(i, j)],
            Self::Sparse(sparse) => sparse.place(i, j).map_or(&0.0, |k| &sparse.entries[k]),
        }
    }
}

impl Symmetric {
    /// Number of rows and columns; of a matrix that is not square the number of rows.
    pub fn size(&self) -> usize {
        match self {
            Self::Full(matrix) => matrix.nrows(),
            Self::Sparse(sparse) => sparse.pattern.size(),
        }
    }

    /// The matrix in full storage.
    pub fn to_full(&self) -> Mat<f64> {
        match self {
            Self::Full(matrix) => matrix.clone(),
            Self::Sparse(sparse) => {
                let mut full = Mat::zeros(sparse.pattern.size(), sparse.pattern.size());
                sparse.each(|i, j, a| full[(i, j)] = a);
                full
            }
        }
    }

    /// The entries of a column that are stored, with their rows.
    pub fn each_of_column(&self, j: usize, mut of: impl FnMut(usize, f64)) {
        match self {
            Self::Full(matrix) => matrix.col_as_slice(j).iter().enumerate().for_each(|(i, &a)| of(i, a)),
            Self::Sparse(sparse) => {
                let (rows, entries) = sparse.column(j);
                rows.iter().zip(entries).for_each(|(&i, &a)| of(i, a));
            }
        }
    }

    /// A x, with the sums in the order of the columns.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.size()];
        for (j, &x) in x.iter().enumerate() {
            match self {
                Self::Full(matrix) => sum.iter_mut().zip(matrix.col_as_slice(j)).for_each(|(sum, a)| *sum += a * x),
                Self::Sparse(_) => self.each_of_column(j, |i, a| sum[i] += a * x),
            }
        }
        sum
    }

    /// Adds to an entry of the diagonal.
    ///
    /// # Panics
    /// If no block has it.
    pub fn add_to_diagonal(&mut self, i: usize, value: f64) {
        match self {
            Self::Full(matrix) => matrix[(i, i)] += value,
            Self::Sparse(sparse) => {
                let k = sparse.place(i, i).expect("a block with this unknown");
                sparse.entries[k] += value;
            }
        }
    }

    /// The largest absolute value of an entry.
    pub fn norm_max(&self) -> f64 {
        match self {
            Self::Full(matrix) => matrix.norm_max(),
            Self::Sparse(sparse) => sparse.entries.iter().fold(0.0, |m, a| m.max(a.abs())),
        }
    }
}

impl SparseSymmetric {
    /// The sum of blocks, each given by its unknowns and its matrix, symmetric in full storage.
    ///
    /// # Errors
    /// [`NoSparseFactor::Memory`].
    ///
    /// # Panics
    /// If an unknown is beyond `size`, or a matrix has another size than its unknowns.
    pub fn sum<'a>(
        size: usize,
        blocks: impl Iterator<Item = (&'a [usize], MatRef<'a, f64>)> + Clone,
    ) -> Result<Self, NoSparseFactor> {
        let mut columns: Vec<Vec<usize>> = vec![Vec::new(); size];
        for (unknowns, matrix) in blocks.clone() {
            assert_eq!([matrix.nrows(), matrix.ncols()], [unknowns.len(); 2], "a block has one row for each unknown");
            unknowns.iter().for_each(|&j| columns[j].extend(unknowns));
        }
        let mut pattern = Pattern { start: vec![0], rows: Vec::new() };
        for column in &mut columns {
            column.sort_unstable();
            column.dedup();
            pattern.rows.append(column);
            pattern.start.push(pattern.rows.len());
        }
        let order = Structure::by_minimum_degree(lower_triangle(&pattern))?.order();
        let mut sum = Self { entries: vec![0.0; pattern.rows.len()], pattern, order };
        for (unknowns, matrix) in blocks {
            for (b, &j) in unknowns.iter().enumerate() {
                for (a, &i) in unknowns.iter().enumerate() {
                    let k = sum.place(i, j).expect("a place of the block");
                    sum.entries[k] += matrix[(a, b)];
                }
            }
        }
        Ok(sum)
    }

    /// The rows of a column and its entries.
    pub fn column(&self, j: usize) -> (&[usize], &[f64]) {
        let range = self.pattern.start[j]..self.pattern.start[j + 1];
        (&self.pattern.rows[range.clone()], &self.entries[range])
    }

    /// The lower triangle, whose first entry in each column is that of the diagonal.
    pub fn lower(&self) -> (Pattern, Vec<f64>) {
        let mut entries = Vec::with_capacity(self.entries.len() / 2 + self.pattern.size());
        self.each(|i, j, a| entries.extend((i >= j).then_some(a)));
        (lower_triangle(&self.pattern), entries)
    }

    fn each(&self, mut of: impl FnMut(usize, usize, f64)) {
        for j in 0..self.pattern.size() {
            let (rows, entries) = self.column(j);
            rows.iter().zip(entries).for_each(|(&i, &a)| of(i, j, a));
        }
    }

    fn place(&self, i: usize, j: usize) -> Option<usize> {
        self.column(j).0.binary_search(&i).ok().map(|k| self.pattern.start[j] + k)
    }
}

fn lower_triangle(whole: &Pattern) -> Pattern {
    let mut lower = Pattern { start: vec![0], rows: Vec::with_capacity(whole.rows.len() / 2 + whole.size()) };
    for (j, range) in whole.start.windows(2).enumerate() {
        lower.rows.extend(whole.rows[range[0]..range[1]].iter().filter(|&&i| i >= j));
        lower.start.push(lower.rows.len());
    }
    lower
}
