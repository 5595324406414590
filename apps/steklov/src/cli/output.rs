//! Whether the result file can be written where it is wanted.

use std::path::Path;

use steklov_io::{IoError, is_special};
use steklov_model::error::SolveError;
use steklov_result::store::unfinished;

use super::failure::Failure;

/// What users hope for who give a result file such an ending, and how to have it.
const ENDINGS: [(&[&str], &str); 4] = [
    (&["json"], "the numbers are printed as JSON by --json: --json > FILE.json"),
    (&["csv", "txt", "dat", "xlsx"], "tables come from the result: steklov show RESULT.vtkhdf --csv DIR"),
    (&["svg", "png", "pdf", "jpg"], "pictures are drawn by --plots DIR"),
    (&["vtk", "vtu", "pvd", "toml", "npy", "mat"], "ParaView and h5py open .vtkhdf"),
];

/// A folder to be that is a file.
pub(super) fn check_folder(option: &str, folder: Option<&Path>) -> Result<(), Failure> {
    match folder.filter(|folder| folder.exists() && !folder.is_dir()) {
        Some(file) => Err(Failure(format!("error: {option} needs a folder, and {} is a file", file.display()))),
        None => Ok(()),
    }
}

/// An output that cannot be written is said before anything is solved.
pub(super) fn check_output(out: &Path, scene: &Path, replace: bool) -> Result<(), Failure> {
    if let (Ok(a), Ok(b)) = (out.canonicalize(), scene.canonicalize())
        && a == b
    {
        return Err(Failure(format!("error: {} is the scene itself; name another file with --out", out.display())));
    }
    if out.is_dir() {
        return Err(Failure(format!("error: {} is a folder; name a file with --out", out.display())));
    }
    let ending = out.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    if let Some((_, help)) = ENDINGS.iter().find(|(endings, _)| endings.contains(&ending.as_str())) {
        return Err(Failure(format!(
            "error: --out {}: the result is one HDF5 file, name it .vtkhdf, .h5 or .hdf5; {help}",
            out.display()
        )));
    }
    let folder = out.parent().filter(|folder| *folder != Path::new(""));
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        let (is, remedy) = match folder.symlink_metadata() {
            Ok(_) => ("is no folder", "name another one with --out"),
            Err(_) => ("does not exist", "create it, or name another one with --out"),
        };
        return Err(Failure(format!("error: the folder {} of the result file {is}: {remedy}", folder.display())));
    }
    if is_special(out) {
        let error = IoError::NotRegular { path: out.to_owned() };
        return Err(Failure(format!("error: {error} with --out")));
    }
    if !replace && out.symlink_metadata().is_ok() {
        let file = out.display();
        return Err(Failure(match unfinished(out) {
            Some(reason) => format!(
                "error: {file} exists and holds a run that is not finished ({reason}): --resume goes on from its last step; \
                 or choose another --out, or --force to replace it"
            ),
            None => format!("error: {file} exists; choose another --out, or --force to replace it"),
        }));
    }
    Ok(())
}

/// The message about a file that was made under the name of the output while the run went on.
pub(super) fn appeared(out: &Path, error: &SolveError) -> Option<Failure> {
    let exists = |error: &(dyn std::error::Error + Send + Sync + 'static)| {
        matches!(error.downcast_ref(), Some(IoError::Exists { .. }))
    };
    matches!(error, SolveError::Observer(error) if exists(error.as_ref())).then(|| {
        Failure(format!(
            "error: {} exists now: another program made it while this run went on, whose result is not stored; \
             choose another --out, or --force to replace it",
            out.display()
        ))
    })
}
