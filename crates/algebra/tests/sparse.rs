//! Sums of overlapping blocks without their zeros, and their factors, against the same sums in full storage.

use faer::{Mat, Par};
use steklov_algebra::{NoSparseFactor, Pattern, SparseSymmetric, Structure, Symmetric, llt};
use steklov_quadrature::unit_uniform;

/// Number of unknowns, number of blocks, and number of unknowns of each.
const SIZES: [[usize; 3]; 4] = [[1, 1, 1], [9, 5, 4], [60, 40, 5], [300, 200, 8]];

type Block = (Vec<usize>, Mat<f64>);

/// Random symmetric blocks, whose unknowns are near each other and in any order; each unknown is in one at least.
fn blocks([size, count, each]: [usize; 3]) -> Vec<Block> {
    let random = |seed: usize, k: usize| unit_uniform((1000 * size + seed) as u64, k as u64);
    let block = |b: usize| {
        let first = b * size / count;
        let mut unknowns: Vec<usize> = (0..each).map(|k| (first + k * k) % size).collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        let by = b % unknowns.len();
        unknowns.rotate_left(by);
        unknowns.reverse();
        let n = unknowns.len();
        (unknowns, Mat::from_fn(n, n, |i, j| random(b, i.min(j) * n + i.max(j)) - 0.5))
    };
    (0..count).map(block).collect()
}

/// The blocks R Rᵀ of others, with ½ on the diagonal, of which each sum is positive definite.
fn definite(sizes: [usize; 3]) -> Vec<Block> {
    let mut blocks = blocks(sizes);
    for (unknowns, matrix) in &mut blocks {
        *matrix = &*matrix * matrix.transpose() + Mat::<f64>::identity(unknowns.len(), unknowns.len()) * 0.5;
    }
    blocks
}

fn sparse(size: usize, blocks: &[Block]) -> SparseSymmetric {
    SparseSymmetric::sum(size, blocks.iter().map(|(unknowns, matrix)| (&unknowns[..], matrix.as_ref()))).expect("a sum")
}

fn dense(size: usize, blocks: &[Block]) -> Mat<f64> {
    let mut sum = Mat::zeros(size, size);
    for (unknowns, matrix) in blocks {
        for (b, &j) in unknowns.iter().enumerate() {
            unknowns.iter().enumerate().for_each(|(a, &i)| sum[(i, j)] += matrix[(a, b)]);
        }
    }
    sum
}

fn vector(size: usize) -> Vec<f64> {
    (0..size).map(|i| unit_uniform(77, i as u64) - 0.5).collect()
}

#[test]
fn sums_of_blocks_are_those_in_full_storage() {
    for sizes in SIZES {
        let [size, ..] = sizes;
        let blocks = blocks(sizes);
        let full = dense(size, &blocks);
        let (mut one, mut other) = (Symmetric::from(full.clone()), Symmetric::Sparse(sparse(size, &blocks)));
        for changed in [false, true] {
            if changed {
                one.add_to_diagonal(size / 2, -7.5);
                other.add_to_diagonal(size / 2, -7.5);
                assert_eq!(one[(size / 2, size / 2)], full[(size / 2, size / 2)] - 7.5);
            }
            assert_eq!([one.size(), other.size()], [size; 2]);
            assert_eq!(one.full(), other.full());
            assert!((0..size).all(|i| (0..size).all(|j| one[(i, j)] == other[(i, j)])));
            assert_eq!(one.norm_max(), other.norm_max());
            assert_eq!(one.times(&vector(size)), other.times(&vector(size)));
            for j in 0..size {
                let mut column = vec![0.0; size];
                other.each_of_column(j, |i, a| column[i] = a);
                let mut all = Vec::new();
                one.each_of_column(j, |i, a| all.push((i, a)));
                assert!(all.iter().enumerate().all(|(k, &(i, a))| k == i && a == column[i]));
            }
        }
        assert_eq!(*Symmetric::from(full.clone()).full(), full);
        // A x of its columns
        let times = Symmetric::Sparse(sparse(size, &blocks)).times(&vector(size));
        for i in 0..size {
            let sum: f64 = (0..size).map(|j| full[(i, j)] * vector(size)[j]).sum();
            assert!((times[i] - sum).abs() < 1e-13, "{size}: {} for {sum}", times[i]);
        }
    }
}

/// The lower triangle has the entries of that half, the first of each column on the diagonal, and no others.
#[test]
fn the_lower_triangle_is_half_of_the_matrix() {
    for sizes in SIZES {
        let [size, ..] = sizes;
        let blocks = blocks(sizes);
        let (full, sum) = (dense(size, &blocks), sparse(size, &blocks));
        let (pattern, entries) = sum.lower();
        assert_eq!((pattern.size(), pattern.rows.len()), (size, entries.len()));
        assert_eq!(2 * entries.len(), sum.entries.len() + size);
        let mut lower = Mat::zeros(size, size);
        for j in 0..size {
            let range = pattern.start[j]..pattern.start[j + 1];
            assert_eq!(pattern.rows[range.start], j);
            assert!(pattern.rows[range.clone()].is_sorted_by(|a, b| a < b));
            range.for_each(|k| lower[(pattern.rows[k], j)] = entries[k]);
        }
        assert!((0..size).all(|j| (0..size).all(|i| lower[(i, j)] == if i < j { 0.0 } else { full[(i, j)] })));
    }
}

/// In each of three orders the factor solves, and its diagonal and last block are those of the matrix so permuted, by dense
/// factorisation.
#[test]
fn factors_are_those_of_the_permuted_matrix() {
    for sizes in SIZES {
        let [size, ..] = sizes;
        let blocks = definite(sizes);
        let (full, sum) = (dense(size, &blocks), sparse(size, &blocks));
        let (pattern, entries) = sum.lower();
        let structures = [
            Structure::by_minimum_degree(pattern.clone()),
            Structure::new(pattern.clone(), &sum.order),
            Structure::new(pattern, &(0..size).rev().collect::<Vec<usize>>()),
        ];
        for (structure, checked) in structures.into_iter().zip([true, false, true]) {
            let structure = structure.expect("a structure");
            let order = structure.order();
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..size), "an order of all unknowns");
            let factor = match checked {
                true => structure.factorise_checked(&entries, Par::Seq),
                false => structure.factorise(&entries, Par::Seq),
            };
            let factor = factor.expect("a factor");
            let (x, mut b) = (Mat::from_fn(size, 2, |i, k| vector(2 * size)[i + k * size]), Mat::zeros(size, 2));
            for k in 0..2 {
                b.col_as_slice_mut(k).copy_from_slice(&Symmetric::Sparse(sum.clone()).times(x.col_as_slice(k)));
            }
            factor.solve(b.as_mut(), Par::Seq);
            assert!((&b - &x).norm_max() < 1e-11, "{size}: {:e}", (&b - &x).norm_max());

            let permuted = llt(&Mat::from_fn(size, size, |i, j| full[(order[i], order[j])])).expect("a factor");
            let l = permuted.lower();
            let diagonal = factor.diagonal();
            for (i, &unknown) in order.iter().enumerate() {
                assert!((diagonal[unknown] / l[(i, i)] - 1.0).abs() < 1e-12, "{size}: pivot {i}");
            }
            let count = size.min(7);
            let (last, first) = (factor.last_block(count), size - count);
            for j in 0..count {
                for i in j..count {
                    assert!((last[(i, j)] - l[(first + i, first + j)]).abs() < 1e-12, "{size}: {i} {j}");
                }
            }
        }
    }
}

/// The centre of a star, which has the first number here, comes last or last but one: before, it would fill the whole factor.
#[test]
fn the_centre_of_a_star_is_eliminated_late() {
    let n = 50;
    let arms: Vec<Block> =
        (1..n).map(|i| (vec![0, i], Mat::from_fn(2, 2, |i, j| if i == j { 1.0 } else { -0.5 }))).collect();
    let order = sparse(n, &arms).order;
    assert!(order[n - 2..].contains(&0), "{order:?}");
}

/// The unknown of the pivot that is not positive is told, in the numbers of the matrix.
#[test]
fn what_is_not_positive_definite_has_no_factor() {
    for sizes in SIZES {
        let [size, ..] = sizes;
        let mut sum = Symmetric::Sparse(sparse(size, &definite(sizes)));
        let wrong = size / 3;
        let pivot = {
            let Symmetric::Sparse(sum) = &sum else { unreachable!() };
            // with the unknown last in the order its pivot alone is wrong
            let (pattern, entries) = sum.lower();
            let order: Vec<usize> = (0..size).filter(|&i| i != wrong).chain([wrong]).collect();
            let structure = Structure::new(pattern, &order).expect("a structure");
            structure.factorise(&entries, Par::Seq).expect("a factor").diagonal()[wrong].powi(2)
        };
        for (factor, definite) in [(0.99, true), (1.01, false)] {
            sum.add_to_diagonal(wrong, -factor * pivot);
            let Symmetric::Sparse(less) = &sum else { unreachable!() };
            let (pattern, entries) = less.lower();
            let order: Vec<usize> = (0..size).filter(|&i| i != wrong).chain([wrong]).collect();
            let last = Structure::new(pattern.clone(), &order).expect("a structure").factorise(&entries, Par::Seq);
            let other = Structure::by_minimum_degree(pattern).expect("a structure").factorise(&entries, Par::Seq);
            match definite {
                true => assert!(last.is_ok() && other.is_ok(), "{size}"),
                false => {
                    assert_eq!(last.expect_err("no factor"), NoSparseFactor::Pivot(wrong), "{size}");
                    assert!(matches!(other, Err(NoSparseFactor::Pivot(_))), "{size}");
                }
            }
            sum.add_to_diagonal(wrong, factor * pivot);
        }
    }
}

/// A matrix of two entries on the diagonal alone, one of them negative.
#[test]
fn patterns_may_be_given_by_hand() {
    let pattern = Pattern { start: vec![0, 1, 2], rows: vec![0, 1] };
    for structure in [Structure::new(pattern.clone(), &[1, 0]), Structure::by_minimum_degree(pattern)] {
        let structure = structure.expect("a structure");
        assert_eq!(structure.factorise(&[4.0, 9.0], Par::Seq).expect("a factor").diagonal(), [2.0, 3.0]);
        for (entries, unknown) in [([-4.0, 9.0], 0), ([4.0, -9.0], 1), ([0.0, 9.0], 0)] {
            let none = structure.factorise_checked(&entries, Par::Seq).expect_err("no factor");
            assert_eq!(none, NoSparseFactor::Pivot(unknown));
        }
    }
}
