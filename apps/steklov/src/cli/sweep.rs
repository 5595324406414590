//! The subcommands `sweep` and `merge`.

use std::num::NonZero;
use std::path::{Path, PathBuf};

use clap::Args;
use steklov_document::Document;
use steklov_sweep::{
    Journal, Observer, Outcome, Points, Sweep, SweepError, charts, read, solve_points, write, write_table,
};

use super::bar::Bar;
use super::output::{check_folder, check_output};
use super::{Failure, NOT_REACHED, interrupts, read_scene, say, stem};

#[derive(Args)]
pub(super) struct SweepArgs {
    /// Scene file (TOML)
    scene: PathBuf,
    /// A key and its values, N from FROM to TO or a list; may be repeated: then all combinations are solved
    #[arg(long, value_name = "KEY=FROM:TO:N|KEY=a,b,c", required_unless_present = "points")]
    vary: Vec<String>,
    /// The first values of all keys, the second ones, and so on, instead of all combinations
    #[arg(long)]
    zip: bool,
    /// A CSV table of the points: a line of keys, then a line of values for each point
    #[arg(long, value_name = "FILE", conflicts_with_all = ["vary", "zip"])]
    points: Option<PathBuf>,
    /// File of the sweep (HDF5), with a table of the same name and the ending .csv; default: the scene's name with -sweep.h5
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Solve the I-th of N parts of the points only, for `steklov merge`
    #[arg(long, value_name = "I/N", value_parser = part)]
    part: Option<[usize; 2]>,
    /// Change a key of the scene at all points, the value typed as TOML; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Draw charts of the quantities into this folder
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    /// Number of threads, at most four a processor; default: one a processor
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
    /// Print one JSON object instead of a summary
    #[arg(long)]
    json: bool,
    /// No progress on stderr
    #[arg(long)]
    pub(super) quiet: bool,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
    /// Go on with a sweep that was stopped: points that are finished are kept
    #[arg(long)]
    resume: bool,
}

#[derive(Args)]
pub(super) struct MergeArgs {
    /// Files of parts of one sweep
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// File of the whole sweep (HDF5), with a table of the same name and the ending .csv
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Draw charts of the quantities into this folder
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    /// Print one JSON object instead of a summary
    #[arg(long)]
    json: bool,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
}

/// The number of a part, from 1, and the number of parts.
fn part(text: &str) -> Result<[usize; 2], String> {
    let numbers = text.split_once('/').and_then(|(i, n)| Some([i.trim().parse().ok()?, n.trim().parse().ok()?]));
    match numbers {
        Some([i, n]) if (1..=n).contains(&i) => Ok([i, n]),
        _ => Err("write I/N, as 1/4 for the first of four parts".to_owned()),
    }
}

/// Solves a scene at many points.
pub(super) fn sweep(args: &SweepArgs) -> Result<u8, Failure> {
    let document = read_scene(&args.scene, &args.overrides)?;
    let points = points(args)?;
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}-sweep.h5", stem(&args.scene))));
    let replace = args.force || args.resume;
    check_output(&out, &args.scene, replace)?;
    check_table(&out, replace, args.points.as_deref())?;
    check_folder("--plots", args.plots.as_deref())?;
    let mut sweep = Sweep::new(&document, points);
    if args.resume && out.exists() {
        sweep.take(read(&out)?, ["the sweep", &out.display().to_string()])?;
    }
    let mut journal = Journal::begin(&out, &mut sweep, args.resume, args.force)?;
    if let Err(error) = solve(args, &document, &mut sweep, &mut journal) {
        if journal.kept() == 0 {
            journal.end()?;
        }
        return Err(error);
    }
    write(&sweep, &out, replace)?;
    let table = write_table(&sweep, &out)?;
    journal.end()?;
    let complete = sweep.missing(args.part.unwrap_or(WHOLE)).is_empty();
    tell(&sweep, [&out, &table], args.plots.as_deref(), (args.json, complete))
}

/// The first of one part.
const WHOLE: [usize; 2] = [1, 1];

/// The points that the options name.
fn points(args: &SweepArgs) -> Result<Points, Failure> {
    Ok(match &args.points {
        None => Points::vary(&args.vary, args.zip)?,
        Some(file) => {
            let failed = |e: std::io::Error| Failure(format!("error: --points {}: {e}", file.display()));
            Points::from_csv(&std::fs::read_to_string(file).map_err(failed)?, &file.display().to_string())?
        }
    })
}

/// A table that is there already is not replaced unless it may be, and the table of the points never.
fn check_table(out: &Path, replace: bool, points: Option<&Path>) -> Result<(), Failure> {
    let table = out.with_extension("csv");
    let same =
        |points: &Path| table.canonicalize().is_ok_and(|path| points.canonicalize().is_ok_and(|own| own == path));
    if points.is_some_and(same) {
        let table = table.display();
        return Err(Failure(format!(
            "error: the table {table} of the sweep would replace that of its points: choose another --out"
        )));
    }
    match !replace && table.symlink_metadata().is_ok() {
        true => {
            Err(Failure(format!("error: {} exists; choose another --out, or --force to replace it", table.display())))
        }
        false => Ok(()),
    }
}

/// Solves the points that are missing, each kept in the journal when it is finished.
fn solve(args: &SweepArgs, document: &Document, sweep: &mut Sweep, journal: &mut Journal) -> Result<(), Failure> {
    let wanted = sweep.missing(args.part.unwrap_or(WHOLE));
    let interrupts = interrupts(args.quiet, "the points that run")?;
    let bar = Bar::new(args.quiet);
    let threads = match args.threads {
        Some(_) => rayon::current_num_threads(),
        None => std::thread::available_parallelism().map_or(1, NonZero::get),
    };
    let (mut done, count) = (0, wanted.len());
    let (points, outcomes) = (&sweep.points, &mut sweep.outcomes);
    let mut keep = |point: usize, outcome: &Outcome| {
        journal.add(point, outcome)?;
        outcomes[point] = Some(outcome.clone());
        done += 1;
        bar.points(done, count);
        Ok(())
    };
    let solved =
        solve_points(document, points, &wanted, threads, Observer { interrupts: &interrupts, keep: &mut keep });
    bar.finish();
    solved.map_err(|error| match error {
        SweepError::Scene(error) => Failure(error.render()),
        error => error.into(),
    })
}

/// Joins the parts of a sweep.
pub(super) fn merge(args: &MergeArgs) -> Result<u8, Failure> {
    let out = &args.out;
    check_output(out, &args.files[0], args.force)?;
    check_table(out, args.force, None)?;
    check_folder("--plots", args.plots.as_deref())?;
    let mut sweep = read(&args.files[0])?;
    for file in &args.files[1..] {
        sweep.take(read(file)?, [&args.files[0].display().to_string(), &file.display().to_string()])?;
    }
    write(&sweep, out, args.force)?;
    let table = write_table(&sweep, out)?;
    let complete = sweep.missing(WHOLE).is_empty();
    tell(&sweep, [out, &table], args.plots.as_deref(), (args.json, complete))
}

/// Most failed points that the summary tells.
const FAILURES: usize = 5;

/// Draws the charts and tells what became of the points; `complete`: no point is missing that was wanted.
fn tell(
    sweep: &Sweep,
    [out, table]: [&Path; 2],
    plots: Option<&Path>,
    (json, complete): (bool, bool),
) -> Result<u8, Failure> {
    let pictures = plots.map_or(Ok(Vec::new()), |folder| charts(sweep, folder, &stem(out)))?;
    let [converged, below, failed, missing] = sweep.counts();
    let all = sweep.outcomes.len();
    let shown = |files: &[PathBuf]| files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>();
    if json {
        let object = serde_json::json!({
            "title": sweep.title, "file": out.display().to_string(), "table": table.display().to_string(), "points": all,
            "converged": converged, "not_converged": below, "failed": failed, "missing": missing, "pictures": shown(&pictures),
        });
        say(&serde_json::to_string_pretty(&object)?);
    } else {
        say(&sweep.title);
        let parts = [(below, "solved without reaching their aim"), (failed, "failed"), (missing, "not solved yet")];
        let parts = parts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!(", {n} {what}")).collect::<String>();
        say(&format!("{all} point(s): {converged} solved{parts}"));
        let failures = sweep.outcomes.iter().enumerate().filter_map(|(point, outcome)| match outcome {
            Some(Outcome::Failed(why)) => {
                Some(format!("point {point:<5} {}: {why}", sweep.points.settings(point).join(", ")))
            }
            _ => None,
        });
        failures.take(FAILURES).for_each(|line| say(&line));
        if failed > FAILURES {
            say(&format!("            {} more in the table", failed - FAILURES));
        }
        shown(&pictures).iter().for_each(|file| say(&format!("picture     {file}")));
        say(&format!("table       {}", table.display()));
        say(&format!("result      {}", out.display()));
    }
    Ok(if complete && below == 0 && failed == 0 { 0 } else { NOT_REACHED })
}
