//! The largest eigenpairs of a symmetric operator.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, Par};
use rayon::prelude::*;
use steklov_algebra::dot;

use crate::StochasticError;
use crate::sampling::uniform;
use crate::spectrum::eigen;

/// Vectors of a block: eigenvalues of this multiplicity, as symmetric bodies have them, are found together.
const BLOCK: usize = 2;
/// Residual of an eigenpair over the largest eigenvalue.
const RESIDUAL: f64 = 1e-12;
/// Vectors this much shorter than the operator made them lie in the span of those before.
const DEPENDENT: f64 = 1e-13;
/// Rows of the basis that are taken together.
const ROWS: usize = 2048;

/// The `wanted` largest eigenpairs of a symmetric, positive semi-definite operator on vectors of length `size`, the largest first:
/// eigenvalues and vectors of length 1. `apply` writes the operator's product with its first argument into the second.
///
/// Block Lanczos with blocks of two vectors, each made orthogonal to all before it, and no restart; it stops when every wanted
/// pair has a residual below 1e-12 λ_1.
///
/// *Use when* the operator is fast to apply and a few of its eigenvalues are wanted. *Fails when* most of them are: then the
/// basis is the whole space, and a dense solver is faster. *Cost*: with m vectors of the basis, 2 to 4 `wanted`, m products,
/// 8 m² `size` operations, 8 m `size` bytes.
///
/// Same bits for any number of threads.
///
/// Source: Golub and Underwood (1977); Saad, Numerical Methods for Large Eigenvalue Problems (2011), section 6.4.
pub(crate) fn largest_eigenpairs(
    size: usize,
    wanted: usize,
    apply: impl Fn(&[f64], &mut [f64]) + Sync,
) -> Result<(Vec<f64>, Vec<Vec<f64>>), StochasticError> {
    let wanted = wanted.min(size);
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut fresh = 0;
    // one column of Vᵀ A V after the other, as long as the basis was then
    let mut projected: Vec<Vec<f64>> = Vec::new();
    let mut next: Vec<Vec<f64>> = (0..BLOCK.min(size)).map(|_| random(size, &mut fresh)).collect();
    orthonormalise(&basis, &mut next, &mut fresh, &[f64::INFINITY; BLOCK]);
    let mut check = wanted + wanted / 2 + 8;
    loop {
        let from = basis.len();
        basis.append(&mut next);
        let mut products: Vec<Vec<f64>> = basis[from..]
            .par_iter()
            .map(|v| {
                let mut product = vec![0.0; size];
                apply(v, &mut product);
                product
            })
            .collect();
        for product in &products {
            projected.push(coefficients(&basis, product));
        }
        let lengths: Vec<f64> = products.iter().map(|w| dot(w, w).sqrt()).collect();
        let complete = basis.len() == size;
        products.truncate(size - basis.len());
        let coupling = orthonormalise(&basis, &mut products, &mut fresh, &lengths);
        next = products;
        if !complete && basis.len() < check {
            continue;
        }
        let (values, vectors) = eigen(&symmetric(&projected))?;
        let order: Vec<usize> = (0..values.len()).rev().take(wanted).collect();
        let largest = values[order[0]].abs();
        let residual = |k: &usize| {
            let last = |j: usize| vectors[(from + j, *k)];
            let row = |r: &Vec<f64>| r.iter().enumerate().map(|(j, r)| r * last(j)).sum::<f64>();
            coupling.iter().map(|r| row(r).powi(2)).sum::<f64>().sqrt()
        };
        if complete || order.iter().all(|k| residual(k) <= RESIDUAL * largest) {
            let chosen = Mat::from_fn(basis.len(), order.len(), |i, k| vectors[(i, order[k])]);
            rotate(&mut basis, &chosen);
            return Ok((order.iter().map(|&k| values[k]).collect(), basis));
        }
        check = (basis.len() + basis.len() / 12 + BLOCK).min(size);
    }
}

fn random(size: usize, fresh: &mut u64) -> Vec<f64> {
    *fresh += 1;
    (0..size as u64).map(|i| uniform(0x006c_616e_637a_6f73, i, *fresh) - 0.5).collect()
}

/// Vᵀ w.
fn coefficients(basis: &[Vec<f64>], w: &[f64]) -> Vec<f64> {
    basis.par_iter().map(|v| dot(v, w)).collect()
}

/// w - V c.
fn subtract(basis: &[Vec<f64>], c: &[f64], w: &mut [f64]) {
    w.par_chunks_mut(ROWS).enumerate().for_each(|(chunk, w)| {
        let rows = chunk * ROWS..chunk * ROWS + w.len();
        for (v, c) in basis.iter().zip(c) {
            w.iter_mut().zip(&v[rows.clone()]).for_each(|(w, v)| *w -= c * v);
        }
    });
}

/// Makes the vectors orthogonal to the basis and to each other, and of length 1. Row i of the result has the parts of the given
/// vectors along new vector i. A vector that depends on those before it, `lengths` being what the operator made of them, gives
/// way to a random one, along which no given vector has a part.
fn orthonormalise(basis: &[Vec<f64>], vectors: &mut [Vec<f64>], fresh: &mut u64, lengths: &[f64]) -> Vec<Vec<f64>> {
    let count = vectors.len();
    let mut parts = vec![vec![0.0; lengths.len()]; count];
    for k in 0..count {
        let (done, rest) = vectors.split_at_mut(k);
        let w = &mut rest[0];
        let mut given = true;
        loop {
            // twice is enough
            for _ in 0..2 {
                subtract(basis, &coefficients(basis, w), w);
                for (i, v) in done.iter().enumerate() {
                    let c = dot(v, w);
                    w.iter_mut().zip(v).for_each(|(w, v)| *w -= c * v);
                    if given {
                        parts[i][k] += c;
                    }
                }
            }
            let length = dot(w, w).sqrt();
            let independent = !given || length > DEPENDENT * lengths[k].min(f64::MAX) || lengths[k].is_infinite();
            if independent && length > 0.0 {
                w.iter_mut().for_each(|w| *w /= length);
                // shorter vectors have lost digits of their direction
                subtract(basis, &coefficients(basis, w), w);
                let length_again = dot(w, w).sqrt();
                w.iter_mut().for_each(|w| *w /= length_again);
                if given {
                    parts[k][k] = length;
                }
                break;
            }
            given = false;
            *w = random(w.len(), fresh);
        }
    }
    parts
}

/// The symmetric matrix whose columns down to the diagonal's block are given.
fn symmetric(columns: &[Vec<f64>]) -> Mat<f64> {
    let size = columns.len();
    let mut matrix = Mat::zeros(size, size);
    for (j, column) in columns.iter().enumerate() {
        for (i, value) in column.iter().enumerate() {
            if i <= j {
                matrix[(i, j)] = *value;
                matrix[(j, i)] = *value;
            }
        }
    }
    matrix
}

/// V Q in the place of V.
fn rotate(basis: &mut Vec<Vec<f64>>, rotation: &Mat<f64>) {
    let (size, count) = (basis[0].len(), rotation.ncols());
    for from in (0..size).step_by(ROWS) {
        let rows = ROWS.min(size - from);
        let part = Mat::from_fn(rows, basis.len(), |i, j| basis[j][from + i]);
        let mut turned = vec![0.0; rows * count];
        let into = MatMut::from_column_major_slice_mut(&mut turned, rows, count);
        matmul(into, Accum::Replace, part.as_ref(), rotation.as_ref(), 1.0, Par::Seq);
        for (v, turned) in basis.iter_mut().zip(turned.chunks(rows)) {
            v[from..from + rows].copy_from_slice(turned);
        }
    }
    basis.truncate(count);
}
