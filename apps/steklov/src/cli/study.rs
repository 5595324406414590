//! The subcommand `study`.

mod coupling;
mod inf_sup;
mod multiscale;
mod stability;
mod stochastic;

use std::cell::Cell;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Instant;

use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use steklov_io::{IoError, create_atomically};
use steklov_model::run::adaptive_loop::Event;
use steklov_model::stage::Stage;
use steklov_picture::{self as picture, PictureError};
use steklov_plan::plan;
use steklov_problem::{Method, Multiplier, Refine, Scene};
use steklov_scene::Document;
use steklov_study::convergence::{MULTIPLIERS, NAMES, Study, for_truth, pictures, report, strategy};
use steklov_study::reference::{Reference, ReferenceError};
use steklov_study::{Report, Watch, contact_sides, settings};

use super::{Failure, NOT_REACHED, explained, interrupts, read_scene, say, stem};
use crate::explain::too_many_dofs;

#[derive(Args)]
pub(super) struct StudyArgs {
    /// Scene file (TOML)
    scene: PathBuf,
    /// Strategies to compare, separated by commas; default: all
    #[arg(long, value_name = "NAMES", value_enum, value_delimiter = ',')]
    strategies: Vec<Name>,
    /// Multipliers of contact to compare, separated by commas: every strategy is run with each; default: the scene's own
    #[arg(long, value_name = "NAMES", value_enum, value_delimiter = ',')]
    multipliers: Vec<MultiplierName>,
    /// What to study
    #[arg(long, value_enum, default_value = "convergence")]
    what: What,
    /// With --what stability: results of other methods for the same scene, drawn beside; JSON, a list of
    /// {"name", "poisson", "energy"}
    #[arg(long, value_name = "FILE")]
    beside: Option<PathBuf>,
    /// Runs of each strategy, of which the seconds are medians
    #[arg(long, value_name = "N", default_value = "3", value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeat: u16,
    /// Folder for the files; default: the scene's name with -study (-stability, -inf-sup, -stochastic, -multiscale, -coupling) in the current folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Change a key of the scene, the value typed as TOML; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Number of threads, at most four a processor; default: one a processor
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
    /// No progress on stderr
    #[arg(long)]
    quiet: bool,
    /// Write into a folder that is not empty, over the files of an older study
    #[arg(long)]
    force: bool,
}

impl StudyArgs {
    /// Threads to use; none for as many as there are processors.
    pub(super) fn threads(&self) -> Option<u16> {
        self.threads
    }

    /// Whether stderr is for errors only.
    pub(super) fn quiet(&self) -> bool {
        self.quiet
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Name {
    UniformH,
    UniformP,
    H,
    HpDecay,
    Hp,
}

impl Name {
    fn strategy(self) -> (&'static str, Refine) {
        NAMES[self as usize]
    }
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
enum MultiplierName {
    Biorthogonal,
    Stabilised,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum What {
    /// Errors of strategies of refinement over unknowns and seconds
    Convergence,
    /// Inf-sup constants of contact multipliers, with and without stabilisation
    InfSup,
    /// Errors as the material becomes incompressible; the single layer at degenerate sizes of the body
    Stability,
    /// Errors of means and variances of a scene with random input, in chance and in space; iterations of contact solvers
    Stochastic,
    /// Errors of multiscale bases on a scene with a grid, of resonance and of high contrast, beside the fine grid's own
    Multiscale,
    /// Errors, seconds and conditions of a body on a grid coupled with the unbounded medium around it
    Coupling,
}

/// Studies a scene and stores what comes out.
pub(super) fn study(args: &StudyArgs) -> Result<u8, Failure> {
    match args.what {
        What::Convergence | What::InfSup | What::Stochastic | What::Multiscale | What::Coupling
            if args.beside.is_some() =>
        {
            Err(Failure("error: --beside belongs to --what stability".into()))
        }
        What::Convergence => convergence(args),
        _ if !args.multipliers.is_empty() => Err(Failure("error: --multipliers belongs to --what convergence".into())),
        What::Stability | What::InfSup | What::Stochastic | What::Multiscale | What::Coupling
            if !args.strategies.is_empty() =>
        {
            Err(Failure(
                "error: --strategies belongs to --what convergence: the others are studied on uniform meshes".into(),
            ))
        }
        What::Stability => stability::stability(args),
        What::InfSup => inf_sup::inf_sup(args),
        What::Stochastic => stochastic::stochastic(args),
        What::Multiscale => multiscale::multiscale(args),
        What::Coupling => coupling::coupling(args),
    }
}

/// Studies of boundary elements are not of bodies on grids.
pub(super) fn boundary_only(scene: &Scene) -> Result<(), Failure> {
    if !scene.is_on_grid() {
        return Ok(());
    }
    let other = if scene.problem.medium().is_some() { "coupling" } else { "multiscale" };
    let message = format!(
        "error: the model of the scene is \"{}\", and this study is of boundary elements: take --what {other}, or \
         --set 'method.model=\"bem\"' if the body is of one material",
        scene.model().word()
    );
    Err(Failure(message))
}

/// Compares strategies on a scene.
fn convergence(args: &StudyArgs) -> Result<u8, Failure> {
    let document = document(args, |method| settings(method, &args.overrides))?;
    let scene = &document.scene;
    boundary_only(scene)?;
    let out = folder(args, &document, "study")?;
    let mut names: Vec<(&str, Refine)> = args.strategies.iter().map(|n| n.strategy()).collect();
    if names.is_empty() {
        names = NAMES.to_vec();
    }
    names.sort_by_key(|n| NAMES.iter().position(|m| m == n));
    names.dedup();
    let chosen = multipliers(args, scene)?;
    let repeat = usize::from(args.repeat);
    let stop = interrupts(args.quiet)?;
    let bar = Bar::new(args.quiet, 1 + names.len() * chosen.len() * (repeat + 1));
    let reference = Reference::new(&for_truth(scene), &stop, &mut |step, event| {
        if let Event::Stage(Stage::Progress(part, _)) = event {
            bar.show("reference", &format!("step {}, {part}", step + 1));
        }
        Ok(())
    });
    let reference = reference.map_err(|error| unreferenced(&document, error))?;
    let mut strategies = Vec::new();
    for ((name, refine), (suffix, multiplier)) in names.iter().flat_map(|n| chosen.iter().map(move |m| (n, m))) {
        if stop.load(Ordering::Relaxed) == 0 {
            let mut scene = scene.clone();
            scene.method.multiplier = *multiplier;
            let tell = &mut |what: &str, detail: &str| bar.show(what, detail);
            let watch = &mut Watch::new(&stop, tell);
            strategies.push(strategy(&scene, (&format!("{name}{suffix}"), *refine), &reference, repeat, watch));
        }
    }
    let interrupted = stop.load(Ordering::Relaxed) > 0;
    let study =
        Study { scene, source: &document.source, reference: &reference, strategies: &strategies, repeat, interrupted };
    finish(args, &out, "study", &bar, &report(&study), &|out| pictures(&study, out))
}

/// The multipliers, each with what it adds to the name of a strategy.
fn multipliers(args: &StudyArgs, scene: &Scene) -> Result<Vec<(String, Multiplier)>, Failure> {
    if args.multipliers.is_empty() {
        return Ok(vec![(String::new(), scene.method.multiplier)]);
    }
    if contact_sides(scene).is_empty() {
        return Err(Failure("error: --multipliers compares multipliers of contact, and no side of the scene is in contact: leave it out".into()));
    }
    let mut chosen = args.multipliers.clone();
    chosen.sort_unstable();
    chosen.dedup();
    let named = |m: &MultiplierName| {
        let (name, multiplier) = MULTIPLIERS[*m as usize];
        (format!(", {name}"), multiplier)
    };
    Ok(chosen.iter().map(named).collect())
}

/// The scene with the settings of a study, which follow from its text; first as it is, so that its own faults are told at
/// their places.
fn document(args: &StudyArgs, settings: impl Fn(&Method) -> Vec<String>) -> Result<Document, Failure> {
    let Document { scene, source } = read_scene(&args.scene, &args.overrides)?;
    Document::parse(&source.text, &source.name, &settings(&scene.method)).map_err(|e| Failure(e.render()))
}

/// Why there is nothing to measure errors against.
fn unreferenced(document: &Document, error: ReferenceError) -> Failure {
    match error {
        ReferenceError::Solve(error) => explained(document, error),
        error @ ReferenceError::NotSolved { .. } => error.into(),
    }
}

/// The folder of the files, which is checked, and the size of the first mesh, before anything is solved.
fn folder(args: &StudyArgs, document: &Document, what: &str) -> Result<PathBuf, Failure> {
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}-{what}", stem(&args.scene))));
    check_folder(&out, args.force)?;
    match too_many_dofs(&document.scene, plan(&document.scene).cost.dofs) {
        Some(error) => Err(Failure(document.error(error).render())),
        None => Ok(out),
    }
}

/// A folder that cannot take the files is said.
fn check_folder(out: &Path, force: bool) -> Result<(), Failure> {
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
    Failure(format!("error: the study cannot be written into {}: {why}", out.display()))
}

/// Writes NAME.h5, the tables and the pictures of a study, and tells what it found and where it is.
fn finish(
    args: &StudyArgs,
    out: &Path,
    name: &str,
    bar: &Bar,
    report: &Report<'_>,
    pictures: &dyn Fn(&Path) -> Result<Vec<PathBuf>, PictureError>,
) -> Result<u8, Failure> {
    bar.show("files", "");
    let failed = |e: std::io::Error| not_written(out, &e);
    std::fs::create_dir_all(out).map_err(failed)?;
    let mut files = vec![out.join(format!("{name}.h5"))];
    create_atomically(&files[0], true, |file| report.write(file))?;
    for (table, content) in &report.tables {
        let path = out.join(table);
        picture::replace(out, &path, content.as_bytes()).map_err(failed)?;
        files.push(path);
    }
    files.extend(pictures(out)?);
    bar.finish();
    if args.json {
        let mut object = report.json();
        object["files"] = files.iter().map(|f| f.display().to_string()).collect();
        say(&serde_json::to_string_pretty(&object)?);
    } else {
        say(report.text().trim_end());
        say(&format!("files       {} in {}", files.len(), out.display()));
    }
    Ok(if report.complete { 0 } else { NOT_REACHED })
}

/// A bar on a terminal; elsewhere a line for each run; nothing when quiet.
struct Bar {
    bar: Option<ProgressBar>,
    start: Instant,
    quiet: bool,
    /// What was shown last.
    last: Cell<String>,
}

impl Bar {
    /// For so many runs and measurements.
    fn new(quiet: bool, number: usize) -> Self {
        let bar = (!quiet && std::io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::with_draw_target(Some(number as u64), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{elapsed:>4} {bar:20} {msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar
        });
        Self { bar, start: Instant::now(), quiet, last: Cell::default() }
    }

    fn show(&self, what: &str, detail: &str) {
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

    fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
