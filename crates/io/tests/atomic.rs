//! A result file appears whole or not at all, and never harms another file.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::common::place;
use steklov_io::{IoError, Label, create_atomically, load_vector, open, save_vector};

const LABEL: Label<'_> = Label { unit: "1", meaning: "numbers", axes: &["entry"] };

fn save(path: &Path, overwrite: bool, values: &[f64]) -> Result<(), IoError> {
    create_atomically(path, overwrite, |f| save_vector(f, "v", values, &LABEL))
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn an_existing_file_is_replaced_only_on_demand() {
    let (folder, path) = place();
    save(&path, false, &[1.0]).unwrap();
    let error = save(&path, false, &[2.0]).unwrap_err();
    assert!(matches!(error, IoError::Exists { .. }) && error.to_string().contains("a result.vtkhdf"), "{error}");
    assert_eq!(load_vector(&open(&path).unwrap(), "v").unwrap(), [1.0]);
    save(&path, true, &[3.0]).unwrap();
    assert_eq!(load_vector(&open(&path).unwrap(), "v").unwrap(), [3.0]);
    assert_eq!(names(folder.path()), ["a result.vtkhdf"]);
}

/// Another file appears under the name while a file is written: the other one is kept, unless it may be replaced.
#[test]
fn a_file_that_appears_meanwhile_is_kept() {
    let (folder, path) = place();
    let fill = |f: &hdf5::File| {
        fs::write(&path, b"somebody else's").unwrap();
        save_vector(f, "v", &[1.0], &LABEL)
    };
    assert!(matches!(create_atomically(&path, false, fill), Err(IoError::Exists { .. })));
    assert_eq!(fs::read(&path).unwrap(), b"somebody else's");
    assert_eq!(names(folder.path()), ["a result.vtkhdf"]);
    create_atomically(&path, true, fill).unwrap();
    assert_eq!(load_vector(&open(&path).unwrap(), "v").unwrap(), [1.0]);
}

/// Half-written files of killed programs are removed when the next file of that name is written; a file that a program
/// holds, a file of another name and one that is not regular stay.
#[cfg(unix)]
#[test]
fn half_written_files_that_nobody_holds_are_removed() {
    let (folder, path) = place();
    let at = |name: &str| folder.path().join(name);
    let (left, held) = (".a result.vtkhdf.aB3xyZ.part", ".a result.vtkhdf.aB3xyY.part");
    let others = [
        ".a result.vtkhdf.aB3x.yZ.part",
        ".a result.vtkhdf.aB3xyZ.part.part",
        ".a result.vtkhdf.part",
        ".another result.vtkhdf.aB3xyZ.part",
        "a result.vtkhdf.aB3xyZ.part",
    ];
    for name in [left, held].iter().chain(&others) {
        fs::write(at(name), b"half").unwrap();
    }
    let (link, inner) = (".a result.vtkhdf.linked.part", ".a result.vtkhdf.folder.part");
    std::os::unix::fs::symlink(at(others[0]), at(link)).unwrap();
    fs::create_dir(at(inner)).unwrap();
    let holder = fs::File::open(at(held)).unwrap();
    holder.lock().unwrap();
    save(&path, false, &[1.0]).unwrap();
    let mut kept: Vec<&str> = others.into_iter().chain([held, link, inner, "a result.vtkhdf"]).collect();
    kept.sort_unstable();
    assert_eq!(names(folder.path()), kept);
    drop(holder);
    save(&path, true, &[2.0]).unwrap();
    kept.retain(|name| *name != held);
    assert_eq!(names(folder.path()), kept);
}

/// Two writers of one name: neither removes the other's file as abandoned, and the last to finish wins.
#[test]
fn two_writers_of_one_file_do_not_meet() {
    let (folder, path) = place();
    create_atomically(&path, true, |f| {
        save(&path, true, &[1.0])?;
        let inner = open(&path)?;
        assert_eq!(load_vector(&inner, "v")?, [1.0]);
        save_vector(f, "v", &[2.0], &LABEL)
    })
    .unwrap();
    assert_eq!(load_vector(&open(&path).unwrap(), "v").unwrap(), [2.0]);
    assert_eq!(names(folder.path()), ["a result.vtkhdf"]);
}

#[test]
fn an_error_or_panic_on_the_way_leaves_everything_as_it_was() {
    let (folder, path) = place();
    fs::write(&path, b"old").unwrap();
    let stop = |f: &hdf5::File| -> Result<(), IoError> {
        save_vector(f, "v", &[1.0; 100_000], &LABEL)?;
        Err(steklov_io::invalid(f, "v", "enough"))
    };
    assert!(matches!(create_atomically(&path, true, stop), Err(IoError::Invalid { .. })));
    let panics = || create_atomically(&path, true, |f| save_vector(f, "v", &[1.0], &LABEL).map(|()| panic!("enough")));
    assert!(std::panic::catch_unwind(panics).is_err());
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["a result.vtkhdf"]);
}

/// Objects that the caller forgets to close are closed with the file.
#[test]
fn handles_left_open_do_no_harm() {
    let (_folder, path) = place();
    let mut kept = None;
    create_atomically(&path, false, |f| {
        let group = steklov_io::create_group(f, "g")?;
        save_vector(&group, "v", &[1.0], &LABEL)?;
        kept = Some((group.dataset("v").unwrap(), group));
        Ok::<(), IoError>(())
    })
    .unwrap();
    assert_eq!(load_vector(&open(&path).unwrap().group("g").unwrap(), "v").unwrap(), [1.0]);
    drop(kept);
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let (folder, path) = place();
    fs::write(&path, b"a file").unwrap();
    let missing = folder.path().join("none").join("x.vtkhdf");
    let mut cases = vec![missing, path.join("x.vtkhdf"), "/".into(), "".into()];
    if cfg!(target_os = "linux") {
        cases.push("/proc/x.vtkhdf".into()); // closed to root too
    }
    for path in cases {
        let error = save(&path, true, &[1.0]).unwrap_err();
        assert!(matches!(error, IoError::System { .. }), "{}: {error:?}", path.display());
    }
    assert_eq!(names(folder.path()), ["a result.vtkhdf"]);
    // A folder is never replaced.
    fs::create_dir(folder.path().join("d")).unwrap();
    assert!(save(&folder.path().join("d"), true, &[1.0]).is_err());
    assert_eq!(names(folder.path()), ["a result.vtkhdf", "d"]);
}

/// A result file has the permissions of any other file that this user makes.
#[cfg(unix)]
#[test]
fn permissions_follow_the_umask() {
    use std::os::unix::fs::PermissionsExt;
    let (folder, path) = place();
    save(&path, false, &[1.0]).unwrap();
    let plain = folder.path().join("plain");
    fs::write(&plain, b"").unwrap();
    let mode = |p: &Path| fs::metadata(p).unwrap().permissions().mode();
    assert_eq!(mode(&path), mode(&plain));
}

/// A disk that fills up, simulated by a limit on the size of files: this test starts itself under `ulimit -f`.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_nothing() {
    const FOLDER: &str = "STEKLOV_TEST_FULL_DISK";
    if let Some(folder) = std::env::var_os(FOLDER) {
        let path = Path::new(&folder).join("a result.vtkhdf");
        for size in [100_000, 300_000, 1_000_000] {
            for overwrite in [false, true] {
                if overwrite {
                    fs::write(&path, b"old").unwrap();
                }
                let error = save(&path, overwrite, &vec![1.0; size]).unwrap_err();
                assert!(matches!(error, IoError::Write { .. }), "{error:?}");
                let told = error.to_string();
                let parts = ["/a result.vtkhdf: ", "raise the limit of file sizes, or write to another place"];
                assert!(parts.iter().all(|part| told.contains(part)) && !told.contains(".part"), "{told}");
                assert_eq!(names(Path::new(&folder)).len(), usize::from(overwrite));
                if overwrite {
                    assert_eq!(fs::read(&path).unwrap(), b"old");
                    fs::remove_file(&path).unwrap();
                }
            }
        }
        // The library is still usable.
        save(&path, false, &[5.0; 10]).unwrap();
        assert_eq!(load_vector(&open(&path).unwrap(), "v").unwrap(), [5.0; 10]);
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let run = Command::new("sh")
        .args(["-c", "trap '' XFSZ; ulimit -f 200; exec \"$0\" --exact atomic::a_full_disk_leaves_nothing --nocapture"])
        .arg(std::env::current_exe().unwrap())
        .env(FOLDER, folder.path())
        .output()
        .unwrap();
    let (out, err) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success() && out.contains("1 passed"), "{out}\n{err}");
    assert!(!err.contains("HDF5"), "the library printed:\n{err}");
    assert_eq!(names(folder.path()), ["a result.vtkhdf"]);
}
