//! Common parts of the tests of this crate.

use std::path::PathBuf;
use std::process::Command;

use faer::Mat;
use hdf5::OpenMode;
use hdf5::plist::file_access::{FileAccessBuilder, LibraryVersion};
use sprs::CsMat;
use steklov_io::*;

/// A new folder and a file name in it; the folder is removed when the first is dropped.
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

/// Stores a value, reads it and stores what was read: the bytes of both files are the same.
pub fn stored_twice<T: Persist>(value: &T) -> T {
    let (folder, path) = place();
    create_atomically(&path, false, |file| save(file, "value", value)).unwrap();
    let back: T = load(&open(&path).unwrap(), "value").unwrap();
    let again = folder.path().join("again.vtkhdf");
    create_atomically(&again, false, |file| save(file, "value", &back)).unwrap();
    assert!(std::fs::read(&path).unwrap() == std::fs::read(&again).unwrap(), "the bytes differ");
    back
}

/// As [`stored_twice`]; the value must also print the same (which distinguishes -0 from 0, and all different f64).
pub fn check_round_trip<T: Persist + std::fmt::Debug>(value: &T) -> T {
    let back = stored_twice(value);
    assert_eq!(format!("{value:?}"), format!("{back:?}"));
    back
}

/// Writes `value`, replaces one of its parts and reads: returns the error.
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

/// Paths of the datasets in a group and its subgroups.
fn datasets(group: &Group) -> Vec<String> {
    let mut paths = Vec::new();
    for name in group.member_names().unwrap() {
        match group.group(&name) {
            Ok(inner) => paths.extend(datasets(&inner).iter().map(|path| format!("{name}/{path}"))),
            Err(_) => paths.push(name),
        }
    }
    paths
}

/// A way to change a dataset.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Damage {
    /// It is missing.
    Missing,
    /// It has one more row, or a text is different.
    Longer,
    /// An entry is NaN, or 2^40.
    NoNumber,
    /// An entry is larger, by a thousandth of itself and of the largest, or by 1.
    Larger,
}

/// Changes a dataset; returns whether it was changed.
fn damage(group: &Group, name: &str, damage: Damage) -> bool {
    let (dataset, wrong) =
        (group.dataset(name).unwrap(), Label { unit: "1", meaning: "wrong", axes: &["row", "column"] });
    let list = Label { axes: &["row"], ..wrong };
    let (kind, rank) = (dataset.dtype().unwrap().to_descriptor().unwrap(), dataset.ndim());
    let shape = dataset.shape();
    drop(dataset);
    let columns = if rank == 2 { shape[1] } else { 1 };
    let at = shape.iter().product::<usize>() / 2;
    if shape.contains(&0) && damage != Damage::Missing && damage != Damage::Longer {
        return false;
    }
    match kind {
        _ if damage == Damage::Missing => group.unlink(name).unwrap(),
        hdf5::types::TypeDescriptor::Float(_) => {
            let mut values: Vec<f64> = if rank == 1 {
                load_vector(group, name).unwrap()
            } else {
                let a = load_dense(group, name).unwrap();
                (0..shape[0]).flat_map(|i| (0..columns).map(move |j| (i, j))).map(|(i, j)| a[(i, j)]).collect()
            };
            let largest = values.iter().fold(1e-3f64, |m, v| if v.is_finite() { m.max(v.abs()) } else { m });
            match damage {
                Damage::NoNumber => values[at] = f64::NAN,
                Damage::Larger => values[at] += 1e-3 * (values[at].abs() + largest),
                _ => values.extend(vec![1.0; columns]),
            }
            group.unlink(name).unwrap();
            if rank == 1 {
                save_vector(group, name, &values, &list).unwrap();
            } else {
                let rows = values.len() / columns.max(1);
                let matrix = Mat::from_fn(rows.max(1), columns, |i, j| values[i * columns + j]);
                save_dense(group, name, matrix.as_ref(), &wrong).unwrap();
            }
        }
        hdf5::types::TypeDescriptor::Integer(_) if rank == 1 => {
            let mut values = load_integers(group, name).unwrap();
            match damage {
                Damage::NoNumber => values[at] = 1 << 40,
                Damage::Larger => values[at] += 1,
                _ => values.push(1),
            }
            group.unlink(name).unwrap();
            save_integers(group, name, &values, &list).unwrap();
        }
        _ if rank == 0 && damage == Damage::Longer => {
            group.unlink(name).unwrap();
            save_text(group, name, "no word of this", "wrong").unwrap();
        }
        _ => return false,
    }
    true
}

/// Without a lock, which processes that other tests start meanwhile would inherit and keep.
fn unlocked(access: &mut FileAccessBuilder) -> &mut FileAccessBuilder {
    access.libver_bounds(LibraryVersion::V110, LibraryVersion::V110).file_locking(false)
}

/// Stores `value` and changes each of its datasets in turn, in each way: reading must refuse the file with an error
/// that names it and the group. `free` are the datasets of which an entry may have any finite value, or that may be any
/// text. Returns the number of damaged files.
pub fn check_damage_is_refused<T: Persist>(value: &T, free: &[&str]) -> usize {
    let (folder, file) = written(|f| save(f, "value", value));
    let paths = datasets(&file.group("value").unwrap());
    let sound = std::fs::read(file.filename()).unwrap();
    let path_of_damaged = folder.path().join("a damaged result.vtkhdf");
    let mut count = 0;
    for path in &paths {
        for kind in [Damage::Missing, Damage::Longer, Damage::NoNumber, Damage::Larger] {
            let (parent, name) = path.rsplit_once('/').unwrap_or(("", path));
            let is_text = || file.group("value").unwrap().dataset(path).unwrap().ndim() == 0;
            if free.contains(&path.as_str()) && (kind == Damage::Larger || kind == Damage::Longer && is_text()) {
                continue;
            }
            std::fs::write(&path_of_damaged, &sound).unwrap();
            let damaged =
                hdf5::File::with_options().with_fapl(unlocked).open_as(&path_of_damaged, OpenMode::ReadWrite).unwrap();
            let changed = damage(&damaged.group(&format!("value/{parent}")).unwrap(), name, kind);
            damaged.close().unwrap();
            if !changed {
                continue;
            }
            count += 1;
            let loaded = load::<T>(&open(&path_of_damaged).unwrap(), "value");
            let Err(error) = loaded else { panic!("{path} {kind:?} went unnoticed") };
            let text = error.to_string();
            assert!(text.contains("a damaged result.vtkhdf") && text.contains("/value"), "{path} {kind:?}: {text}");
            match kind {
                Damage::Missing => assert!(matches!(error, IoError::Missing { .. }) && text.contains(path), "{text}"),
                _ => {
                    let typed =
                        matches!(error, IoError::Invalid { .. } | IoError::Mismatch { .. } | IoError::Missing { .. });
                    assert!(typed, "{path} {kind:?}: {error:?}");
                }
            }
        }
    }
    assert!(count >= 2 * paths.len(), "{count} files of {} datasets", paths.len());
    count
}
