//! Half-written files of killed runs. A program locks the file that it writes, so an unlocked one is abandoned.

use std::fs::{self, File};
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use crate::file::SUFFIX;

/// Letters and digits between prefix and suffix.
pub(crate) const RANDOM: usize = 6;

/// Locks a file that this program has just made, and returns whether it is still there: another program may have
/// removed it as abandoned before it was locked. On a file system without locks no file counts as abandoned.
pub(crate) fn hold(made: &File) -> bool {
    use std::fs::TryLockError::WouldBlock;
    !matches!(made.try_lock(), Err(WouldBlock)) && made.metadata().map_or(true, |made| made.nlink() > 0)
}

/// Removes half-written files of this name that no program holds and that belong to the user of `own`; files that cannot be
/// examined or removed stay.
pub(crate) fn remove(folder: &Path, prefix: &str, own: &File) {
    let (Ok(own), Ok(entries)) = (own.metadata(), fs::read_dir(folder)) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let random = name.to_str().and_then(|name| name.strip_prefix(prefix)?.strip_suffix(SUFFIX));
        let is_ours = random.is_some_and(|r| r.len() == RANDOM && r.bytes().all(|b| b.is_ascii_alphanumeric()));
        let path = entry.path();
        // links are not followed, and a pipe is not opened
        let same_user = |found: fs::Metadata| found.is_file() && found.uid() == own.uid() && found.ino() != own.ino();
        if !is_ours || !path.symlink_metadata().is_ok_and(same_user) {
            continue;
        }
        if let Ok(left) = File::open(&path)
            && left.try_lock().is_ok()
        {
            let _ = fs::remove_file(&path);
        }
    }
}
