//! What the tests of this crate share.
#![allow(dead_code)] // each test file uses a part of it

use std::path::PathBuf;
use std::process::Command;

use faer::Mat;
use sprs::CsMat;
use steklov_io::{File, Group, IoError, Persist, create_atomically, load, open, save};

/// A new folder and a file name in it; the folder goes when the first is dropped.
pub fn place() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a result.vtkhdf");
    (folder, path)
}

/// Writes a file by `fill` and opens it.
pub fn written(fill: impl FnOnce(&File) -> Result<(), IoError>) -> (tempfile::TempDir, File) {
    let (folder, path) = place();
    create_atomically(&path, false, fill).unwrap();
    (folder, open(&path).unwrap())
}

/// Stores `value`, reads it, and demands that it prints the same (which tells -0 from 0, and every number of f64 from
/// every other) and that the value read is stored as the same bytes. Gives the value read.
pub fn check_round_trip<T: Persist + std::fmt::Debug>(value: &T) -> T {
    let (folder, path) = place();
    create_atomically(&path, false, |file| save(file, "value", value)).unwrap();
    let back: T = load(&open(&path).unwrap(), "value").unwrap();
    assert_eq!(format!("{value:?}"), format!("{back:?}"));
    let again = folder.path().join("again.vtkhdf");
    create_atomically(&again, false, |file| save(file, "value", &back)).unwrap();
    assert!(std::fs::read(&path).unwrap() == std::fs::read(&again).unwrap(), "the bytes differ");
    back
}

/// Writes `value`, replaces one of its parts and reads: the error that comes.
pub fn spoiled<T: Persist>(value: &T, part: &str, replace: impl FnOnce(&Group) -> Result<(), IoError>) -> String {
    let (_folder, file) = written(|f| {
        save(f, "value", value)?;
        let group = f.group("value").unwrap();
        group.unlink(part).unwrap();
        replace(&group)
    });
    let error = load::<T>(&file, "value").map(drop).expect_err(part);
    assert!(matches!(error, IoError::Invalid { .. } | IoError::Mismatch { .. }), "{part}: {error:?}");
    error.to_string()
}

pub fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

pub fn dense_bits(a: &Mat<f64>) -> (usize, usize, Vec<u64>) {
    let all = (0..a.nrows()).flat_map(|i| (0..a.ncols()).map(move |j| (i, j)));
    (a.nrows(), a.ncols(), all.map(|(i, j)| a[(i, j)].to_bits()).collect())
}

/// A pseudo-random sparse matrix without a pattern that hides mistakes: rectangular, with an empty row.
pub fn sparse(rows: usize, columns: usize) -> CsMat<f64> {
    let (mut indptr, mut indices, mut data) = (vec![0], vec![], vec![]);
    for i in 0..rows {
        for j in 0..columns {
            if i != 1 && (3 * i + 5 * j) % 7 < 3 {
                indices.push(j);
                data.push(1.0 / (1.0 + i as f64 + 10.0 * j as f64));
            }
        }
        indptr.push(indices.len());
    }
    CsMat::new((rows, columns), indptr, indices, data)
}

/// Runs a script of this folder in the private Python environment, which must be there.
pub fn python(script: &str, argument: &std::path::Path) {
    let here = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let python =
        std::env::var_os("STEKLOV_PYTHON").map_or_else(|| here.join("../../target/python/bin/python"), PathBuf::from);
    let run = Command::new(&python).arg(here.join("tests").join(script)).arg(argument).output();
    let run = run.unwrap_or_else(|e| {
        panic!("no Python at {}: {e}; run `scripts/python-env target/python numpy h5py vtk`", python.display())
    });
    let (out, err) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success(), "{script} failed\n{out}\n{err}");
}
