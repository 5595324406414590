//! The subcommand `show`.

use std::path::{Path, PathBuf};

use clap::Args;
use steklov_document::{Document, HDF5, foreign};
use steklov_io::open;
use steklov_result::store;

use super::output::check_folder;
use super::told::{TableFormat, say_result};
use super::view::{ViewArgs, check_window};
use super::{Failure, pictures, say, stem};

#[derive(Args)]
pub(super) struct ShowArgs {
    /// Result file
    file: PathBuf,
    /// Draw pictures into this folder
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    #[command(flatten)]
    view: ViewArgs,
    /// Write tables as CSV into this folder
    #[arg(long, value_name = "DIR")]
    csv: Option<PathBuf>,
    /// Print one JSON object instead of a summary
    #[arg(long)]
    json: bool,
    /// Print the numbers as a table of a document instead of a summary
    #[arg(long, value_enum, conflicts_with = "json")]
    format: Option<TableFormat>,
    /// Print what was modelled, and why, before the summary
    #[arg(long, conflicts_with_all = ["json", "format"])]
    plan: bool,
}

/// A scene, or a file of another kind, that a command is to show or report.
pub(super) fn no_scene(path: &Path, command: &str) -> Result<(), Failure> {
    let name = path.display();
    if let Ok(text) = std::fs::read_to_string(path)
        && (path.extension().is_some_and(|ending| ending == "toml") || Document::parse(&text, "", &[]).is_ok())
    {
        let result = format!("{}.vtkhdf", stem(path));
        return Err(Failure(format!(
            "error: {name} is a scene and no result: steklov solve {name} makes {result}, which steklov {command} {result} {command}s"
        )));
    }
    match std::fs::read(path).ok().and_then(|bytes| foreign(&bytes)) {
        Some((what, _)) if what != HDF5 => {
            Err(Failure(format!("error: {name} is {what} and no result of steklov solve")))
        }
        _ => Ok(()),
    }
}

/// Shows a stored result.
pub(super) fn show(args: &ShowArgs) -> Result<u8, Failure> {
    check_folder("--plots", args.plots.as_deref())?;
    let view = args.view.view(args.plots.is_some())?;
    check_folder("--csv", args.csv.as_deref())?;
    no_scene(&args.file, "show")?;
    let mut stored = store::read(&open(&args.file)?)?;
    check_window(&view, stored.grid.points.iter().copied())?;
    stored.summary.file = args.file.display().to_string();
    let mut files = Vec::new();
    if let Some(folder) = &args.plots {
        files.extend(pictures(&stored, &view, &args.view.steps, folder, &args.file)?);
    }
    if let Some(folder) = &args.csv {
        files.extend(
            steklov_figures::tables(&stored, folder, &stem(&args.file))
                .map_err(|e| Failure(format!("error: the tables cannot be written into {}: {e}", folder.display())))?,
        );
    }
    if args.plan {
        say(&stored.plan.to_string());
    }
    let files = files.iter().map(|f| format!("wrote       {}", f.display()));
    say_result(&stored, args.json, args.format, files)?;
    Ok(0)
}
