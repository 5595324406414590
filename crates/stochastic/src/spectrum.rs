//! Eigenpairs of symmetric matrices that commute with mirror images.

use faer::Mat;
use rayon::prelude::*;
use steklov_algebra::symmetric_eigen_on_one_thread;

use crate::StochasticError;

/// Eigenvalues in descending order and their eigenvectors of length 1.
pub(crate) struct Spectrum {
    pub values: Vec<f64>,
    pub vectors: Vec<Vec<f64>>,
}

/// Eigenpairs of a symmetric matrix A that commutes with the mirror images of a group of 1, 2 or 4 elements.
///
/// `images[k][g]` are the place and the sign to which element g takes unknown k, for one k of every orbit; element 0 is the
/// identity, element 3 is 1 and 2 together. The matrix splits into one small matrix for each character χ_c(g) = (-1)^|c ∧ g|,
/// so that every vector is exactly even or odd and the modes of a square are not mixed.
pub(crate) fn folded_spectrum(
    images: &[Vec<(usize, f64)>],
    entry: impl Fn(usize, usize) -> f64 + Sync,
) -> Result<Spectrum, StochasticError> {
    let (half, group) = (images.len(), images[0].len());
    let size = half * group;
    let character = |c: usize, g: usize| if (c & g).count_ones().is_multiple_of(2) { 1.0 } else { -1.0 };
    let classes: Vec<_> = (0..group)
        .into_par_iter()
        .map(|c| {
            let mut small = Mat::zeros(half, half);
            for j in 0..half {
                for i in j..half {
                    let (row, own) = images[i][0];
                    let terms = images[j].iter().enumerate();
                    small[(i, j)] = terms.map(|(g, &(k, sign))| own * character(c, g) * sign * entry(row, k)).sum();
                }
            }
            eigen(&small)
        })
        .collect::<Result<_, _>>()?;
    let mut order: Vec<(usize, usize)> = (0..group).flat_map(|c| (0..half).map(move |m| (c, m))).collect();
    order.sort_by(|&(c, m), &(d, n)| classes[d].0[n].total_cmp(&classes[c].0[m]).then((c, m).cmp(&(d, n))));
    let vector = |&(c, m): &(usize, usize)| {
        let mut full = vec![0.0; size];
        for (k, images) in images.iter().enumerate() {
            for (g, &(place, sign)) in images.iter().enumerate() {
                full[place] = character(c, g) * sign * classes[c].1[(k, m)] / (group as f64).sqrt();
            }
        }
        full
    };
    Ok(Spectrum {
        values: order.iter().map(|&(c, m)| classes[c].0[m]).collect(),
        vectors: order.iter().map(vector).collect(),
    })
}

/// Eigenvalues, ascending, and eigenvectors from the lower half, with the same bits for any number of threads.
pub(crate) fn eigen(matrix: &Mat<f64>) -> Result<(Vec<f64>, Mat<f64>), StochasticError> {
    let eigen = symmetric_eigen_on_one_thread(matrix.as_ref())
        .map_err(|_| StochasticError::Decomposition { size: matrix.nrows() })?;
    Ok((eigen.values, eigen.vectors))
}
