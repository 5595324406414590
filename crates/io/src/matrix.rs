//! Dense and sparse matrices.

use faer::{Mat, MatRef};
use hdf5::Group;
use sprs::CsMat;

use crate::array::{load_integers, load_vector, save_integers};
use crate::dataset::{Label, Rows, read_rows, write_numbers, write_rows};
use crate::deflated::Storage;
use crate::error::{IoError, invalid, mismatch};
use crate::persist::{create_group, open_group};

/// Writes a matrix as a 2-D array, row-major: numpy's `A[i, j]` is `a[(i, j)]`. Either extent may be 0.
///
/// # Errors
/// [`IoError::Write`].
pub fn save_dense(at: &Group, name: &str, a: MatRef<'_, f64>, label: &Label<'_>) -> Result<(), IoError> {
    write_rows(at, name, [a.nrows(), a.ncols()], label, |rows| {
        rows.flat_map(|i| (0..a.ncols()).map(move |j| a[(i, j)])).collect()
    })
}

/// Begins an n×m array with the layout of [`save_dense`]; [`Rows::push`] adds rows in order, and [`Rows::finish`] ends
/// it.
///
/// # Errors
/// [`IoError::Write`].
pub fn save_rows(at: &Group, name: &str, shape: [usize; 2], label: &Label<'_>) -> Result<Rows, IoError> {
    Rows::new(at, name, shape, label)
}

/// Reads what [`save_dense`] wrote, the same bits.
///
/// # Errors
/// [`IoError::Missing`], [`IoError::Mismatch`] for another type or rank, [`IoError::Damaged`] when the checksum fails.
pub fn load_dense(at: &Group, name: &str) -> Result<Mat<f64>, IoError> {
    read_rows(at, name, Mat::zeros, |a, i, values| {
        for (j, &value) in values.iter().enumerate() {
            a[(i, j)] = value;
        }
    })
}

/// Writes a sparse matrix as scipy's CSR: a group of `indptr` (rows+1), `indices`, `data` (nonzeros) and `shape` (2),
/// read by `csr_matrix((data, indices, indptr), shape)`. A CSC matrix is converted.
///
/// Indices are deflated if there are many, and values if there are many and they recur.
///
/// `label.axes` names rows and columns and becomes the label of `shape`.
///
/// # Errors
/// [`IoError::Write`].
pub fn save_sparse(at: &Group, name: &str, a: &CsMat<f64>, label: &Label<'_>) -> Result<(), IoError> {
    let a = a.to_csr();
    let group = create_group(at, name)?;
    let indptr = a.proper_indptr();
    let (rows_and_columns, axes) = (format!("extents: {}", label.axes.join(", ")), &["axis"]);
    let index = |meaning, axes| Label { unit: "1", meaning, axes };
    save_integers(&group, "shape", &[a.rows(), a.cols()], &index(&rows_and_columns, axes))?;
    save_integers(&group, "indptr", &indptr, &index("start of each row in indices and data", &["row"]))?;
    save_integers(&group, "indices", a.indices(), &index("column of each nonzero, rising in a row", &["nonzero"]))?;
    let label = Label { axes: &["nonzero"], ..*label };
    write_numbers(&group, "data", &[a.nnz()], a.data(), &label, Storage::of(a.data()))
}

/// Reads what [`save_sparse`] or scipy wrote (in scipy `sort_indices` and `sum_duplicates` first).
///
/// # Errors
/// [`IoError::Invalid`] when the structure is not CSR with rising columns in each row; else as [`load_dense`].
pub fn load_sparse(at: &Group, name: &str) -> Result<CsMat<f64>, IoError> {
    let group = open_group(at, name)?;
    let shape = load_integers(&group, "shape")?;
    let [rows, columns] = shape[..] else {
        return Err(mismatch(&group, "shape", "two extents", format!("{} of them", shape.len())));
    };
    let (indptr, indices) = (load_integers(&group, "indptr")?, load_integers(&group, "indices")?);
    let data = load_vector(&group, "data")?;
    if indices.len() != data.len() {
        return Err(invalid(&group, "indices", format!("{} columns for {} values", indices.len(), data.len())));
    }
    // `rows + 1` could overflow.
    if indptr.len().checked_sub(1) != Some(rows) {
        return Err(invalid(&group, "indptr", format!("{} entries for {rows} rows", indptr.len())));
    }
    if indptr[0] != 0 || indptr[rows] != data.len() || indptr.windows(2).any(|w| w[0] > w[1]) {
        return Err(invalid(&group, "indptr", format!("it does not rise from 0 to {}", data.len())));
    }
    for (row, ends) in indptr.windows(2).enumerate() {
        let row_indices = &indices[ends[0]..ends[1]];
        if row_indices.windows(2).any(|w| w[0] >= w[1]) || row_indices.last().is_some_and(|&last| last >= columns) {
            return Err(invalid(&group, "indices", format!("row {row} does not rise strictly below {columns}")));
        }
    }
    CsMat::try_new((rows, columns), indptr, indices, data).map_err(|(_, _, _, e)| invalid(&group, "", e))
}
