//! Dense products and triangular solves on as many threads as they are worth.
//!
//! The library cuts a product into tiles whose threads wait for each other again and again: of some hundred unknowns two
//! threads then take up to twice the processor time of one. Matrices of that size are cut once, into groups of columns that know
//! nothing of each other, and what is smaller still stays on one thread. Sizes alone decide, and each entry is summed in the same order
//! in all three ways: the same bits for any number of threads.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::prelude::*;
use faer::{Accum, Par};
use rayon::prelude::*;

use crate::Fault;
use crate::fault::threads;
use crate::operand::{Operand, lower, lower_transposed, symmetric, whole};
use crate::probe::{Last, probe};
use crate::spoil::spoil;

/// Parts into which the library cuts dense products and factorisations, whatever the number of threads: the order in which
/// their sums are taken depends on this number. More threads than parts do not help.
pub const PARTS: usize = 16;

/// Number of multiplications up to which one thread is as fast as two: about a quarter of a millisecond.
const SMALL: usize = 3_000_000;

/// Number of unknowns from which the library's own parallelism is better: its threads share packed data.
const LARGE: usize = 1024;

/// Approximate number of columns in a group: enough of them for the fastest kernels, few enough to keep all threads busy.
const GROUP: usize = 48;

/// Number of columns in each group; the last group has slightly fewer. Single columns would be summed in another order.
fn group(columns: usize) -> usize {
    columns.div_ceil((columns / GROUP).max(1))
}

/// How a product is computed, by its number of multiplications and the size of its matrices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    OneThread,
    Columns,
    Library,
}

fn way(multiplications: usize, size: usize) -> Way {
    match size {
        _ if multiplications <= SMALL || threads(Par::rayon(PARTS)) == Par::Seq => Way::OneThread,
        LARGE.. => Way::Library,
        _ => Way::Columns,
    }
}

/// The library's parallelism for matrices with this many unknowns.
pub fn parts(unknowns: usize) -> Par {
    if unknowns < LARGE { Par::Seq } else { threads(Par::rayon(PARTS)) }
}

/// The product of a matrix, as it stands, with the probe vector. The check of the next operation on the matrix need not read
/// it again.
#[derive(Debug, Clone)]
pub struct Image(Vec<f64>);

/// The known image, or else that of the matrix.
fn image(known: Option<&Image>, a: Operand<'_>, probe: &[f64]) -> Vec<f64> {
    known.map_or_else(|| a.times(probe), |image| image.0.clone())
}

/// B := L⁻¹ B, L lower triangular. `of_b` is the image of B, if it is known; returns the image of the result.
///
/// # Errors
/// A fault: L times the result is not B.
pub fn solve_lower(l: MatRef<'_, f64>, b: MatMut<'_, f64>, of_b: Option<&Image>) -> Result<Image, Fault> {
    solve(lower(l), b, of_b, |b| lower_solve(l, b))
}

/// B := L⁻ᵀ B, L lower triangular, with images as those of [`solve_lower`].
///
/// # Errors
/// A fault: Lᵀ times the result is not B.
pub fn solve_lower_transposed(l: MatRef<'_, f64>, b: MatMut<'_, f64>, of_b: Option<&Image>) -> Result<Image, Fault> {
    let upper = |b: MatMut<'_, f64>| solve_upper_triangular_in_place(l.transpose(), b, threads(Par::rayon(PARTS)));
    solve(lower_transposed(l), b, of_b, upper)
}

/// Solves, and checks that the matrix times the result is B.
fn solve(
    a: Operand<'_>,
    mut b: MatMut<'_, f64>,
    of_b: Option<&Image>,
    of: impl FnOnce(MatMut<'_, f64>),
) -> Result<Image, Fault> {
    let probe = probe(b.ncols());
    let wanted = image(of_b, whole(b.rb()), &probe);
    of(b.rb_mut());
    spoil(b.rb_mut(), false);
    let solved = whole(b.rb());
    let inner = solved.times(&probe);
    let check = Last { inner: &inner, terms: || solved.terms(&probe), row: |i, x: &[f64]| a.terms_of(i, x) };
    check.same("a triangular solve", &a.times(&inner), &wanted)?;
    Ok(Image(inner))
}

/// C := C + α A B. `of_b` is the image of B, if it is known; returns the image of C.
///
/// # Errors
/// A fault: C does not change by α A B.
pub fn add_product(
    c: MatMut<'_, f64>,
    a: MatRef<'_, f64>,
    b: MatRef<'_, f64>,
    alpha: f64,
    of_b: Option<&Image>,
) -> Result<Image, Fault> {
    gain(c, (whole, "a product"), (a, b, alpha), of_b, |c| product(c, a, b, alpha))
}

/// The lower triangle of C := C + α A B of a symmetric product, with images as those of [`add_product`].
///
/// # Errors
/// A fault: C does not change by α A B.
pub fn add_to_lower(
    c: MatMut<'_, f64>,
    a: MatRef<'_, f64>,
    b: MatRef<'_, f64>,
    alpha: f64,
    of_b: Option<&Image>,
) -> Result<Image, Fault> {
    gain(c, (symmetric, "a symmetric product"), (a, b, alpha), of_b, |c| lower_product(c, a, b, alpha))
}

/// Checks that C gains α A B in the part of it that is read.
fn gain(
    mut c: MatMut<'_, f64>,
    (read, what): (for<'a> fn(MatRef<'a, f64>) -> Operand<'a>, &'static str),
    (a, b, alpha): (MatRef<'_, f64>, MatRef<'_, f64>, f64),
    of_b: Option<&Image>,
    of: impl FnOnce(MatMut<'_, f64>),
) -> Result<Image, Fault> {
    let (probe, left, right) = (probe(c.ncols()), whole(a), whole(b));
    let mut wanted = read(c.rb()).times(&probe);
    let inner = image(of_b, right, &probe);
    wanted.iter_mut().zip(left.times(&inner)).for_each(|(c, gained)| *c += alpha * gained);
    of(c.rb_mut());
    spoil(c.rb_mut(), what != "a product");
    let c = read(c.rb());
    let row = |i: usize, x: &[f64]| alpha.abs() * left.terms_of(i, x) + c.terms_of(i, &probe);
    let gained = c.times(&probe);
    Last { inner: &inner, terms: || right.terms(&probe), row }.same(what, &gained, &wanted)?;
    Ok(Image(gained))
}

pub(crate) fn lower_solve(l: MatRef<'_, f64>, b: MatMut<'_, f64>) {
    let (n, columns) = (b.nrows(), b.ncols());
    match way(n * n / 2 * columns, n.max(columns)) {
        Way::OneThread => solve_lower_triangular_in_place(l, b, Par::Seq),
        Way::Library => solve_lower_triangular_in_place(l, b, Par::rayon(PARTS)),
        Way::Columns => {
            b.par_col_chunks_mut(group(columns)).for_each(|group| solve_lower_triangular_in_place(l, group, Par::Seq));
        }
    }
}

fn product(c: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>, alpha: f64) {
    let (m, inner, n) = (a.nrows(), a.ncols(), b.ncols());
    match way(m * inner * n, m.max(inner).max(n)) {
        Way::OneThread => matmul(c, Accum::Add, a, b, alpha, Par::Seq),
        Way::Library => matmul(c, Accum::Add, a, b, alpha, Par::rayon(PARTS)),
        Way::Columns => c
            .par_col_chunks_mut(group(n))
            .zip(b.par_col_chunks(group(n)))
            .for_each(|(c, b)| matmul(c, Accum::Add, a, b, alpha, Par::Seq)),
    }
}

pub(crate) fn lower_product(c: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>, alpha: f64) {
    let (n, inner) = (a.nrows(), a.ncols());
    match way(n * n / 2 * inner, n.max(inner)) {
        Way::OneThread => triangle(c, a, b, alpha, Par::Seq),
        Way::Library => triangle(c, a, b, alpha, Par::rayon(PARTS)),
        Way::Columns => {
            let size = group(n);
            let groups = c.par_col_chunks_mut(size).zip(b.par_col_chunks(size)).enumerate();
            groups.for_each(|(k, (c, b))| {
                let start = k * size;
                let (_, from_diagonal) = c.split_at_row_mut(start);
                let (diagonal, below) = from_diagonal.split_at_row_mut(b.ncols());
                let (at_diagonal, at_below) = a.subrows(start, n - start).split_at_row(b.ncols());
                triangle(diagonal, at_diagonal, b, alpha, Par::Seq);
                matmul(below, Accum::Add, at_below, b, alpha, Par::Seq);
            });
        }
    }
}

fn triangle(c: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>, alpha: f64, par: Par) {
    let whole = BlockStructure::Rectangular;
    triangular::matmul(c, BlockStructure::TriangularLower, Accum::Add, a, whole, b, whole, alpha, par);
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;

    fn matrix(rows: usize, columns: usize) -> Mat<f64> {
        Mat::from_fn(rows, columns, |i, j| ((7 * i + 3 * j) as f64).sin() + if i == j { rows as f64 } else { 0.0 })
    }

    fn same_bits(a: &Mat<f64>, b: &Mat<f64>) {
        for j in 0..a.ncols() {
            for i in 0..a.nrows() {
                assert_eq!(a[(i, j)].to_bits(), b[(i, j)].to_bits(), "({i}, {j}) of {}×{}", a.nrows(), a.ncols());
            }
        }
    }

    /// Sizes on both sides of the limits, with a column more than whole groups, and with two less.
    const SIZES: [(usize, usize); 4] = [(130, 50), (200, 193), (231, 335), (418, 418)];

    #[test]
    fn groups_of_columns_have_the_bits_of_the_whole() {
        for (n, columns) in SIZES {
            let (l, b, c) = (matrix(n, n), matrix(n, columns), matrix(columns, columns));
            let (mut got, mut want) = (b.clone(), b.clone());
            solve_lower(l.as_ref(), got.as_mut(), None).unwrap();
            solve_lower_triangular_in_place(l.as_ref(), want.as_mut(), Par::Seq);
            same_bits(&got, &want);

            let (mut got, mut want) = (c.clone(), c.clone());
            add_product(got.as_mut(), b.transpose(), b.as_ref(), -1.0, None).unwrap();
            matmul(want.as_mut(), Accum::Add, b.transpose(), b.as_ref(), -1.0, Par::Seq);
            same_bits(&got, &want);

            let (mut got, mut want) = (c.clone(), c);
            add_to_lower(got.as_mut(), b.transpose(), b.as_ref(), 1.0, None).unwrap();
            triangle(want.as_mut(), b.transpose(), b.as_ref(), 1.0, Par::Seq);
            same_bits(&got, &want);
        }
    }

    #[test]
    fn the_sizes_are_done_in_both_ways() {
        let ways = SIZES.map(|(n, columns)| way(n * n / 2 * columns, n.max(columns)));
        assert_eq!(ways, [Way::OneThread, Way::Columns, Way::Columns, Way::Columns]);
        assert_eq!(way(LARGE * LARGE * LARGE, LARGE), Way::Library);
    }
}
