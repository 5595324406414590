//! The subcommand `study`.

use std::cell::Cell;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use steklov_document::Document;
use steklov_io::IoError;
use steklov_plan::{plan, too_many_dofs};
use steklov_report::format::csv_table;
use steklov_study::convergence::{MULTIPLIERS, NAMES};
use steklov_study::{Draw, Options, Report, StudyError, StudyKind, Watch, stability};

use super::told::TableFormat;
use super::{Failure, NOT_REACHED, STEP, explained, interrupts, read_scene, say, stem};

#[derive(Args)]
pub(super) struct StudyArgs {
    /// Scene file (TOML)
    scene: PathBuf,
    /// Strategies to compare, separated by commas; default: all
    #[arg(long, value_name = "NAMES", value_parser = one_of(&NAMES), value_delimiter = ',')]
    strategies: Vec<String>,
    /// Multipliers of contact to compare, separated by commas: every strategy is run with each; default: the scene's own
    #[arg(long, value_name = "NAMES", value_parser = one_of(&MULTIPLIERS), value_delimiter = ',')]
    multipliers: Vec<String>,
    /// What to study
    #[arg(long, value_parser = kind(), default_value = "convergence")]
    what: StudyKind,
    /// With --what stability: results of other methods for the same scene, drawn beside; JSON, a list of
    /// {"name", "poisson", "energy"}
    #[arg(long, value_name = "FILE")]
    beside: Option<PathBuf>,
    /// Steps whose meshes are drawn, separated by commas, 0 the first; default: some of each strategy
    #[arg(long, value_name = "STEPS", value_delimiter = ',')]
    steps: Vec<usize>,
    /// Runs of each strategy, of which the seconds are medians
    #[arg(long, value_name = "N", default_value = "3", value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeat: u16,
    /// Folder for the files; default: the scene's name with -study (-stability, -inf-sup, -solvers, -stochastic, -multiscale, -coupling, -quantities) in the current folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Change a key of the scene, the value typed as TOML; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Number of threads, at most four a processor; default: one a processor
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
    /// Print the tables in the format of a document
    #[arg(long, value_enum, conflicts_with = "json")]
    format: Option<TableFormat>,
    /// No progress on stderr
    #[arg(long)]
    pub(super) quiet: bool,
    /// Write into a folder that is not empty, over the files of an older study
    #[arg(long)]
    force: bool,
}

/// Takes one of these names.
fn one_of<T>(all: &[(&'static str, T)]) -> PossibleValuesParser {
    all.iter().map(|(name, _)| *name).into()
}

/// Takes the word of a study.
fn kind() -> impl TypedValueParser<Value = StudyKind> {
    let values = StudyKind::ALL.map(|(_, word, about)| PossibleValue::new(word).help(about));
    PossibleValuesParser::new(values).try_map(|word| StudyKind::of_word(&word).ok_or("there is no such study"))
}

/// Studies a scene and stores what comes out.
pub(super) fn study(args: &StudyArgs) -> Result<u8, Failure> {
    check_options(args)?;
    let document = document(args)?;
    let scene = &document.scene;
    let mut options =
        args.what.options(scene, &args.strategies, &args.multipliers).map_err(|e| failure(&document, e))?;
    (options.repeat, options.steps) = (usize::from(args.repeat), args.steps.clone());
    if args.what == StudyKind::Stability {
        options.beside = args.beside.as_deref().map_or(Ok(Vec::new()), stability::read_beside)?;
    }
    carry_out(args, &document, options)
}

/// Options that belong to one study only.
fn check_options(args: &StudyArgs) -> Result<(), Failure> {
    let is_other = args.what != StudyKind::Convergence;
    let misplaced = [
        (args.beside.is_some() && args.what != StudyKind::Stability, "--beside belongs to --what stability"),
        (is_other && !args.steps.is_empty(), "--steps belongs to --what convergence"),
        (is_other && !args.multipliers.is_empty(), "--multipliers belongs to --what convergence"),
        (is_other && !args.strategies.is_empty(), "--strategies belongs to --what convergence"),
    ];
    let first = misplaced.iter().find(|(is_misplaced, _)| *is_misplaced);
    first.map_or(Ok(()), |(_, message)| Err(Failure(format!("error: {message}"))))
}

/// The scene with the settings of the study, where the user sets nothing else; first without them, so that its own faults
/// are told at their places.
fn document(args: &StudyArgs) -> Result<Document, Failure> {
    let mut document = read_scene(&args.scene, &args.overrides)?;
    args.what.prepare(&mut document).map_err(|error| Failure(document.error(error).render()))?;
    Ok(document)
}

/// What a study refuses, at its place in the scene where it has one.
fn failure(document: &Document, error: StudyError) -> Failure {
    match error {
        StudyError::Data(error) => Failure(document.error(error).render()),
        StudyError::Solve(error) => explained(document, error),
        error => Failure(format!("error: {error}")),
    }
}

/// Studies, stores and tells the report, and draws the pictures.
fn carry_out(args: &StudyArgs, document: &Document, options: Options) -> Result<u8, Failure> {
    let parts = args.what.parts(&document.scene, &options).map_err(|error| failure(document, error.into()))?;
    let out = folder(args, document)?;
    let stop = interrupts(args.quiet, STEP)?;
    let bar = Bar::new(args.quiet, parts);
    let tell = &mut |what: &str, detail: &str| bar.show(what, detail);
    let told = |report: &Report<'_>, pictures: Draw<'_>| {
        bar.show("files", "");
        let files = report.store(&out, args.what.file_name(), pictures).map_err(|error| failure(document, error))?;
        bar.finish();
        say_report(args, report, &files, &out)?;
        Ok(if report.complete { 0 } else { NOT_REACHED })
    };
    let studied = args.what.carry_out(document, options, &mut Watch::new(&stop, tell), told);
    studied.map_err(|error| failure(document, error))?
}

/// Prints a report: as one JSON object, as tables of a document under their names, or as text.
fn say_report(args: &StudyArgs, report: &Report<'_>, files: &[PathBuf], out: &Path) -> Result<(), Failure> {
    if let Some(format) = args.format {
        for (name, table) in &report.tables {
            let failed = |e| Failure(format!("error: {name}: {e}"));
            say(&format!("{name}\n\n{}", csv_table(table, format.format()).map_err(failed)?));
        }
    } else if args.json {
        let mut object = report.json();
        object["files"] = files.iter().map(|f| f.display().to_string()).collect();
        say(&serde_json::to_string_pretty(&object)?);
    } else {
        say(report.text().trim_end());
        say(&format!("files       {} in {}", files.len(), out.display()));
    }
    Ok(())
}

/// The folder of the files, which is checked, and the size of the first mesh, before anything is solved.
fn folder(args: &StudyArgs, document: &Document) -> Result<PathBuf, Failure> {
    let name = || PathBuf::from(format!("{}-{}", stem(&args.scene), args.what.file_name()));
    let out = args.out.clone().unwrap_or_else(name);
    check_folder(&out, args.force)?;
    match too_many_dofs(&document.scene, plan(&document.scene).cost.dofs) {
        Some(error) => Err(Failure(document.error(error).render())),
        None => Ok(out),
    }
}

/// A folder that cannot take the files is said.
pub(super) fn check_folder(out: &Path, force: bool) -> Result<(), Failure> {
    let here = Path::new(".");
    let existing = out.ancestors().find(|a| a.symlink_metadata().is_ok()).unwrap_or(here);
    if existing == out && !out.is_dir() {
        return Err(Failure(format!("error: {} is not a folder; name another one with --out", out.display())));
    }
    tempfile::tempfile_in(existing).map_err(|e| not_written(out, &e))?;
    if !force && existing == out && std::fs::read_dir(out)?.next().is_some() {
        let error = IoError::Exists { path: out.to_owned() };
        return Err(Failure(format!("error: {error}; choose another --out, or --force to replace what is in it")));
    }
    Ok(())
}

fn not_written(out: &Path, why: &std::io::Error) -> Failure {
    Failure(format!("error: nothing can be written into {}: {why}", out.display()))
}

/// A bar on a terminal; elsewhere a line for each run; nothing when quiet.
pub(super) struct Bar {
    bar: Option<ProgressBar>,
    start: Instant,
    quiet: bool,
    /// What was shown last.
    last: Cell<String>,
}

impl Bar {
    /// For so many runs and measurements.
    pub(super) fn new(quiet: bool, number: usize) -> Self {
        let bar = (!quiet && std::io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::with_draw_target(Some(number as u64), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{elapsed:>4} {bar:20} {msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar
        });
        Self { bar, start: Instant::now(), quiet, last: Cell::default() }
    }

    pub(super) fn show(&self, what: &str, detail: &str) {
        let last = self.last.take();
        let new = last != what;
        if let Some(bar) = &self.bar {
            if new && !last.is_empty() {
                bar.inc(1);
            }
            bar.set_message(format!("{what}: {detail}"));
        } else if new && !self.quiet {
            eprintln!("{:6.1} s  {what}", self.start.elapsed().as_secs_f64());
        }
        self.last.set(what.to_owned());
    }

    pub(super) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
