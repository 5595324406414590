//! Arrays come back with the same bits, and other objects are refused with a message.

use crate::common::{bits, dense_bits, sparse, written};
use faer::Mat;
use proptest::prelude::*;
use sprs::CsMat;
use steklov_io::{
    IoError, Label, StoredLabel, create_group, load_dense, load_integers, load_label, load_number, load_pairs,
    load_points, load_sparse, load_text, load_texts, load_vector, save_dense, save_integers, save_number, save_pairs,
    save_points, save_rows, save_sparse, save_text, save_texts, save_vector,
};

const ONE: Label<'_> = Label { unit: "length", meaning: "numbers", axes: &["entry"] };
const TWO: Label<'_> = Label { unit: "stress", meaning: "table", axes: &["row", "column"] };

/// Any bits at all: NaN with a payload, infinities, subnormal numbers, both zeros.
fn any_bits() -> impl Strategy<Value = f64> {
    prop_oneof![any::<u64>().prop_map(f64::from_bits), Just(-0.0), Just(f64::INFINITY), Just(f64::from_bits(1))]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn vectors_and_points_keep_their_bits(v in prop::collection::vec(any_bits(), 0..300)) {
        let points: Vec<[f64; 2]> = v.chunks_exact(2).map(|p| [p[0], p[1]]).collect();
        let (_folder, file) = written(|f| {
            save_vector(f, "v", &v, &ONE)?;
            save_points(f, "p", &points, &TWO)
        });
        prop_assert_eq!(bits(&load_vector(&file, "v").unwrap()), bits(&v));
        prop_assert_eq!(bits(load_points(&file, "p").unwrap().as_flattened()), bits(points.as_flattened()));
    }

    #[test]
    fn dense_matrices_keep_their_bits(n in 0_usize..20, m in 0_usize..20, v in prop::collection::vec(any_bits(), 400)) {
        let a = Mat::from_fn(n, m, |i, j| v[20 * i + j]);
        let (_folder, file) = written(|f| save_dense(f, "a", a.as_ref(), &TWO));
        prop_assert_eq!(dense_bits(&load_dense(&file, "a").unwrap()), dense_bits(&a));
    }

    /// Rows written in pieces give the same dataset as all rows at once, also over many blocks.
    #[test]
    fn tables_by_rows_are_those_at_once(m in 0_usize..7, cuts in prop::collection::vec(0_usize..9000, 0..9)) {
        let (n, wide) = (cuts.iter().sum::<usize>(), 3 * m);
        let a = Mat::from_fn(n, wide, |i, j| (i * wide + j) as f64 - 0.5);
        let (_folder, file) = written(|f| {
            save_dense(f, "whole", a.as_ref(), &TWO)?;
            let mut rows = save_rows(f, "rows", [n, wide], &TWO)?;
            let mut first = 0;
            for count in &cuts {
                let part: Vec<f64> = (first * wide..(first + count) * wide).map(|k| k as f64 - 0.5).collect();
                rows.push(&part)?;
                first += count;
            }
            rows.finish()
        });
        prop_assert_eq!(dense_bits(&load_dense(&file, "rows").unwrap()), dense_bits(&a));
        prop_assert_eq!(dense_bits(&load_dense(&file, "whole").unwrap()), dense_bits(&a));
    }

    #[test]
    fn integers_and_pairs_come_back(v in prop::collection::vec(0..=i64::MAX as usize, 0..100)) {
        let pairs: Vec<[usize; 2]> = v.chunks_exact(2).map(|p| [p[0], p[1]]).collect();
        let (_folder, file) = written(|f| {
            save_integers(f, "v", &v, &ONE)?;
            save_pairs(f, "p", &pairs, &TWO)
        });
        prop_assert_eq!(load_integers(&file, "v").unwrap(), v);
        prop_assert_eq!(load_pairs(&file, "p").unwrap(), pairs);
    }

    #[test]
    fn texts_come_back(texts in prop::collection::vec("[^\0]{0,40}", 0..12)) {
        let whole = texts.concat();
        let (_folder, file) = written(|f| {
            save_text(f, "one", &whole, "a text")?;
            save_texts(f, "many", &texts, "texts", "text")
        });
        prop_assert_eq!(load_text(&file, "one").unwrap(), whole);
        prop_assert_eq!(load_texts(&file, "many").unwrap(), texts);
    }

    #[test]
    fn sparse_matrices_come_back(n in 0_usize..12, m in 0_usize..12, filled in prop::collection::vec(any::<bool>(), 144)) {
        let mut triplets = sprs::TriMat::new((n, m));
        for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))).filter(|&(i, j)| filled[12 * i + j]) {
            triplets.add_triplet(i, j, (i * 31 + j) as f64 - 7.5);
        }
        let a: CsMat<f64> = triplets.to_csr();
        let (_folder, file) = written(|f| {
            save_sparse(f, "csr", &a, &TWO)?;
            save_sparse(f, "csc", &a.to_csc(), &TWO)
        });
        prop_assert_eq!(&load_sparse(&file, "csr").unwrap(), &a);
        prop_assert_eq!(&load_sparse(&file, "csc").unwrap(), &a);
    }
}

/// Several chunks, the last one short; more columns than a chunk holds.
#[test]
fn large_arrays_cross_chunks() {
    let v: Vec<f64> = (0..300_001).map(|i| (i as f64).sqrt()).collect();
    let tall = Mat::from_fn(1001, 300, |i, j| 1.0 / (1.0 + (300 * i + j) as f64));
    let wide = Mat::from_fn(3, 140_001, |i, j| (i * 140_001 + j) as f64);
    let text: String = (0..40_000).map(|i| char::from_u32(0x4e00 + i % 500).unwrap()).collect();
    let (_folder, file) = written(|f| {
        save_vector(f, "v", &v, &ONE)?;
        save_dense(f, "tall", tall.as_ref(), &TWO)?;
        save_dense(f, "wide", wide.as_ref(), &TWO)?;
        save_text(f, "text", &text, "a long text")
    });
    assert!(load_vector(&file, "v").unwrap() == v);
    assert!(load_dense(&file, "tall").unwrap() == tall);
    assert!(load_dense(&file, "wide").unwrap() == wide);
    assert!(load_text(&file, "text").unwrap() == text);
}

#[test]
fn a_transposed_view_is_stored_as_it_is_indexed() {
    let a = Mat::from_fn(3, 5, |i, j| (10 * i + j) as f64);
    let (_folder, file) = written(|f| save_dense(f, "t", a.as_ref().transpose(), &TWO));
    let t = load_dense(&file, "t").unwrap();
    assert_eq!((t.nrows(), t.ncols(), t[(4, 2)]), (5, 3, 24.0));
}

#[test]
fn labels_come_back() {
    let label = Label { unit: "N/m²", meaning: "λ_n ≥ 0", axes: &["узел", "Komponente"] };
    let (_folder, file) = written(|f| {
        save_points(f, "full", &[[1.0, 2.0]], &label)?;
        save_points(f, "empty", &[], &label)
    });
    for name in ["full", "empty"] {
        let StoredLabel { unit, meaning, axes } = load_label(&file, name).unwrap();
        assert_eq!((unit.as_str(), meaning.as_str()), (label.unit, label.meaning));
        assert_eq!(axes, label.axes);
    }
}

#[test]
fn what_cannot_be_written_is_refused() {
    let wrong_axes = |f: &hdf5::File| save_vector(f, "v", &[1.0], &TWO);
    let too_large = |f: &hdf5::File| save_integers(f, "v", &[usize::MAX], &ONE);
    let with_nul = |f: &hdf5::File| save_text(f, "v", "a\0b", "text");
    let twice = |f: &hdf5::File| save_vector(f, "v", &[1.0], &ONE).and_then(|()| save_vector(f, "v", &[1.0], &ONE));
    type Fill<'a> = &'a dyn Fn(&hdf5::File) -> Result<(), IoError>;
    let cases: [(Fill<'_>, &str); 4] =
        [(&wrong_axes, "1 axes and 2 names"), (&too_large, "63 bits"), (&with_nul, "NUL"), (&twice, "/v")];
    for (fill, wanted) in cases {
        let (folder, path) = crate::common::place();
        let error = steklov_io::create_atomically(&path, false, fill).unwrap_err();
        assert!(matches!(error, IoError::Write { .. }) && error.to_string().contains(wanted), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "something stayed");
    }
}

#[test]
fn another_type_or_shape_is_refused_by_name() {
    let (_folder, file) = written(|f| {
        let g = create_group(f, "group")?;
        save_vector(&g, "v", &[1.0, 2.0], &ONE)?;
        save_integers(&g, "i", &[1, 2], &ONE)?;
        save_dense(&g, "a", Mat::zeros(2, 3).as_ref(), &TWO)?;
        save_text(&g, "t", "text", "text")
    });
    let g = file.group("group").unwrap();
    let errors = [
        ("integers as numbers", load_vector(&g, "i").map(drop).unwrap_err()),
        ("numbers as integers", load_integers(&g, "v").map(drop).unwrap_err()),
        ("table as vector", load_vector(&g, "a").map(drop).unwrap_err()),
        ("vector as table", load_dense(&g, "v").map(drop).unwrap_err()),
        ("three columns as points", load_points(&g, "a").map(drop).unwrap_err()),
        ("two numbers as one", load_number(&g, "v").map(drop).unwrap_err()),
        ("numbers as text", load_text(&g, "v").map(drop).unwrap_err()),
        ("text as texts", load_texts(&g, "t").map(drop).unwrap_err()),
        ("group as numbers", load_vector(&file, "group").map(drop).unwrap_err()),
        ("numbers as group", load_sparse(&g, "v").map(drop).unwrap_err()),
    ];
    for (what, error) in errors {
        let text = error.to_string();
        assert!(matches!(error, IoError::Mismatch { .. }), "{what}: {error:?}");
        assert!(text.contains("/group") && text.contains("a result.vtkhdf"), "{what}: {text}");
    }
    let error = load_vector(&g, "none").unwrap_err();
    assert!(matches!(&error, IoError::Missing { object, .. } if object == "/group/none"), "{error:?}");
    assert_eq!(load_number(&g, "v").map_err(|e| e.to_string().contains("2 numbers")), Err(true));
}

#[test]
fn a_number_comes_back() {
    let (_folder, file) = written(|f| save_number(f, "x", 0.1 + 0.2, "J", "energy"));
    assert_eq!(load_number(&file, "x").unwrap().to_bits(), (0.1_f64 + 0.2).to_bits());
    assert_eq!(load_label(&file, "x").unwrap().unit, "J");
}

/// The error of a wrong CSR matrix names the wrong part.
#[test]
fn a_wrong_sparse_structure_is_refused() {
    type Parts = (Vec<usize>, Vec<usize>, Vec<usize>, Vec<f64>);
    let good: Parts = (vec![3, 4], vec![0, 2, 2, 4], vec![0, 3, 1, 2], vec![1.0, 2.0, 3.0, 4.0]);
    let store = |(shape, indptr, indices, data): &Parts| {
        written(|f| {
            let g = create_group(f, "a")?;
            save_integers(&g, "shape", shape, &ONE)?;
            save_integers(&g, "indptr", indptr, &ONE)?;
            save_integers(&g, "indices", indices, &ONE)?;
            save_vector(&g, "data", data, &ONE)
        })
    };
    let (_folder, file) = store(&good);
    assert_eq!(load_sparse(&file, "a").unwrap().get(2, 1), Some(&3.0));
    type Spoil<'a> = &'a dyn Fn(&mut Parts);
    let wrong: [(&str, &str, Spoil<'_>); 10] = [
        ("three extents", "shape", &|p| p.0.push(1)),
        ("huge row count", "indptr", &|p| p.0[0] = i64::MAX as usize),
        ("a row too many", "indptr", &|p| p.0[0] = 4),
        ("no row pointers", "indptr", &|p| p.1.clear()),
        ("start above 0", "indptr", &|p| p.1[0] = 1),
        ("end below the count", "indptr", &|p| p.1[3] = 3),
        ("falling row pointers", "indptr", &|p| p.1[1] = 3),
        ("falling columns", "indices", &|p| p.2.swap(0, 1)),
        ("a column too large", "indices", &|p| p.2[1] = 4),
        ("a value too many", "indices", &|p| p.3.push(0.0)),
    ];
    for (what, part, spoil) in wrong {
        let mut parts = good.clone();
        spoil(&mut parts);
        let (_folder, file) = store(&parts);
        let error = load_sparse(&file, "a").map(drop).expect_err(what).to_string();
        assert!(error.contains(&format!("/a/{part}")), "{what}: {error}");
    }
    assert_eq!(
        sparse(5, 4).nnz(),
        load_sparse(&written(|f| save_sparse(f, "s", &sparse(5, 4), &TWO)).1, "s").unwrap().nnz()
    );
}

/// Matrices are stored row by row. Square ones are checked in the file, since writing and reading columns would agree.
#[test]
fn dense_matrices_are_stored_by_rows() {
    for (n, m) in [(2, 2), (3, 3), (2, 3), (3, 2)] {
        let a = Mat::from_fn(n, m, |i, j| (10 * i + j) as f64);
        let (_folder, file) = written(|f| save_dense(f, "a", a.as_ref(), &TWO));
        let rows: Vec<f64> = (0..n).flat_map(|i| (0..m).map(move |j| (10 * i + j) as f64)).collect();
        assert_eq!(file.dataset("a").unwrap().read_raw::<f64>().unwrap(), rows, "{n} by {m}");
    }
}

/// A table with too many or too few rows, or with a part of a row, is refused.
#[test]
fn rows_that_do_not_fill_their_table_are_refused() {
    for (pushed, why) in
        [(&[1.0; 9][..], "9 numbers for 2 rows of 3"), (&[1.0; 4], "4 numbers"), (&[1.0; 3], "1 of 2 rows")]
    {
        let (folder, path) = crate::common::place();
        let written = steklov_io::create_atomically(&path, false, |f| {
            let mut rows = save_rows(f, "rows", [2, 3], &TWO)?;
            rows.push(pushed)?;
            rows.finish()
        });
        let told = written.unwrap_err().to_string();
        assert!(told.contains(why) && told.contains("rows"), "{told}");
        drop(folder);
    }
}
