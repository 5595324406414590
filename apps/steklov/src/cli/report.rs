//! The subcommand `report`, and the page of `solve --report`.

use std::path::{Path, PathBuf};

use clap::Args;
use steklov_io::open;

use super::show::no_scene;
use super::{Failure, say};

#[derive(Args)]
pub(super) struct ReportArgs {
    /// Result file, or the HDF5 file of a study
    file: PathBuf,
    /// Folder for the page, index.html
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Write into a folder that is not empty, over an older page
    #[arg(long)]
    force: bool,
}

/// Writes the page of a stored result or study.
pub(super) fn report(args: &ReportArgs) -> Result<u8, Failure> {
    check_place("--out", &args.out, args.force)?;
    no_scene(&args.file, "report")?;
    let page = written(&args.file, &args.out)?;
    say(&format!("page        {}", page.display()));
    Ok(0)
}

/// A folder that is a file, or has files of its own that are not to be mixed with a page.
pub(super) fn check_place(option: &str, folder: &Path, force: bool) -> Result<(), Failure> {
    super::check_folder(option, Some(folder))?;
    if !force && folder.is_dir() && std::fs::read_dir(folder)?.next().is_some() {
        let remedy = format!("choose another {option}, or --force to write into it");
        return Err(Failure(format!("error: the folder {} is not empty; {remedy}", folder.display())));
    }
    Ok(())
}

/// The page of a result file in a folder.
pub(super) fn written(file: &Path, folder: &Path) -> Result<PathBuf, Failure> {
    Ok(steklov_report::write(&open(file)?, file, folder)?)
}
