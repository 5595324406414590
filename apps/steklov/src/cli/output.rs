//! Whether the result file can be written where it is wanted.

use std::path::Path;

use steklov_io::{IoError, is_special};
use steklov_model::error::SolveError;
use steklov_result::store::unfinished;

use super::Failure;

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
