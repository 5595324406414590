//! The subcommand `gallery`.

use std::path::PathBuf;

use clap::Args;
use steklov_study::Watch;

use super::study::{Bar, check_folder};
use super::{Failure, NOT_REACHED, STEP, interrupts, say};

#[derive(Args)]
pub(super) struct GalleryArgs {
    /// Folder for the page, its numbers and its pictures
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Make this figure, or all whose names begin so; may be repeated
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Number of threads, at most four a processor; default: one a processor
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
    /// No progress on stderr
    #[arg(long)]
    pub(super) quiet: bool,
    /// Write into a folder that is not empty, over the files of an older gallery
    #[arg(long)]
    force: bool,
}

/// Makes the figures and writes the page; the status is 3 where a number is off or missing.
pub(super) fn gallery(args: &GalleryArgs) -> Result<u8, Failure> {
    steklov_gallery::check(&args.only)?;
    check_folder(&args.out, args.force)?;
    let stop = interrupts(args.quiet, STEP)?;
    let bar = Bar::new(args.quiet, steklov_gallery::number_of_runs(&args.only));
    let tell = &mut |what: &str, detail: &str| bar.show(what, detail);
    let gallery = steklov_gallery::make(&args.only, &mut Watch::new(&stop, tell))?;
    let files = gallery.write(&args.out).map_err(|e| Failure(format!("error: {e}")))?;
    bar.finish();
    for (name, why) in gallery.failures() {
        say(&format!("{name}: {why}"));
    }
    say(&format!("page        {}", files[0].display()));
    Ok(if gallery.holds() { 0 } else { NOT_REACHED })
}
