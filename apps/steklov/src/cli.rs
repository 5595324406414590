//! Arguments, messages and exit statuses of the command.

mod bar;
mod compare;
mod failure;
mod gallery;
mod help;
mod manual;
mod output;
mod report;
mod scenes;
mod show;
mod study;
mod sweep;
mod told;
mod view;

use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use clap::{Args, Parser, Subcommand, ValueEnum};
use steklov_algebra::PARTS;
use steklov_bem_operators::Edge;
use steklov_document::Document;
use steklov_figures::{StepMesh, View, stochastic};
use steklov_io::{File, IoError, create_atomically, open};
use steklov_model::error::SolveError;
use steklov_model::grid::OnGrid;
use steklov_model::run::adaptive_loop::{Event, Reason, Step, run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::run::expect::check_expect;
use steklov_model::stochastic::{OutcomeStage, OutcomesWatch};
use steklov_model::summary::{available_memory_bytes, peak_memory_bytes};
use steklov_plan::{Plan, explain, largest_mesh, plan, plan_with_mesh, refused, too_large_basis, without_memory};
use steklov_problem::{Refine, grid_of, moduli};
use steklov_report::summary::expectation;
use steklov_report::told::{advice, crossing_warning};
use steklov_result::keep::Keep;
use steklov_result::record::Record;
use steklov_result::stages::{SAVED, Saved, SavedOutcomes, copy_outcomes, copy_saved, save_stage};
use steklov_result::store;

use self::bar::Bar;
use self::failure::{Failure, say};
use self::output::{appeared, check_folder, check_output};
use self::told::{TableFormat, cautions, say_result};
use self::view::{ViewArgs, check_window};

/// Exit status: the scene or a file is wrong, or the problem has no solution.
const WRONG: u8 = 1;
/// Exit status: the tolerance, the solver's criterion or an entry of `[expect]` was not met, or the run was interrupted; the result is
/// stored.
const NOT_REACHED: u8 = 3;

/// Frictional contact of 2D elastic bodies by boundary elements.
#[derive(Parser)]
#[command(name = "steklov", version, arg_required_else_help = true, after_help = help::STEKLOV)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Solve a scene and store the result
    #[command(after_help = help::SOLVE)]
    Solve(SolveArgs),
    /// Say what would be modelled and why, what is left out, what it costs; solve nothing
    #[command(after_help = help::PLAN)]
    Plan(PlanArgs),
    /// Study a scene: strategies of refinement compared by true errors, or where such methods could fail
    #[command(after_help = help::STUDY)]
    Study(study::StudyArgs),
    /// Solve a scene at many values of its keys, several at once
    #[command(after_help = help::SWEEP)]
    Sweep(sweep::SweepArgs),
    /// Compare two results: a table of all numbers, pictures of both
    #[command(after_help = help::COMPARE)]
    Compare(compare::CompareArgs),
    /// Join the files of parts of a sweep
    #[command(after_help = help::MERGE)]
    Merge(sweep::MergeArgs),
    /// Make the figures of the source again, each judged, as one page
    #[command(after_help = help::GALLERY)]
    Gallery(gallery::GalleryArgs),
    /// Show a stored result: summary, pictures, tables
    #[command(after_help = help::SHOW)]
    Show(show::ShowArgs),
    /// Make one page of a stored result: numbers with their errors, doubts, pictures, the body to look into
    #[command(after_help = help::REPORT)]
    Report(report::ReportArgs),
    /// Print a commented scene to start from
    #[command(after_help = help::NEW)]
    New(scenes::NewArgs),
    /// List the scenes of the gallery, or print one
    #[command(after_help = help::SCENES)]
    Scenes(scenes::ScenesArgs),
    /// Print the JSON schema of scenes, by which editors complete and check keys
    #[command(after_help = help::SCHEMA)]
    Schema,
    /// Print completions of a shell
    #[command(after_help = help::COMPLETIONS)]
    Completions(manual::CompletionsArgs),
    /// Print a man page
    #[command(after_help = help::MAN)]
    Man(manual::ManArgs),
}

#[derive(Args)]
struct SolveArgs {
    /// Scene file (TOML)
    scene: PathBuf,
    /// Result file; default: the scene's name with .vtkhdf in the current folder
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Change a key of the scene, the value typed as TOML; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Store stages of each step as well, separated by commas
    #[arg(long, value_name = "NAMES", value_enum, value_delimiter = ',')]
    save: Vec<Save>,
    /// Draw pictures into this folder
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    #[command(flatten)]
    view: ViewArgs,
    /// Write a page of the result into this folder, index.html
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Number of threads, at most four a processor; default: one a processor
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Print one JSON object instead of a summary
    #[arg(long)]
    json: bool,
    /// Print the numbers as a table of a document instead of a summary
    #[arg(long, value_enum, conflicts_with = "json")]
    format: Option<TableFormat>,
    /// No progress on stderr
    #[arg(long)]
    quiet: bool,
    /// Replace an existing result file
    #[arg(long)]
    force: bool,
    /// Go on from the last step of the result file, if there is one
    #[arg(long)]
    resume: bool,
}

impl SolveArgs {
    /// What is to be stored besides the result.
    fn saved(&self) -> Vec<Saved> {
        self.save.iter().flat_map(|save| save.stages()).copied().collect()
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum Save {
    /// V, K, W, M and S, of grids K and what it is reduced to
    Matrices,
    /// The condensed contact problem of biorthogonal multipliers, and its solution
    Contact,
    /// Stabilised multipliers, the forms of their stabilisation and the equations they obey
    Stabilisation,
    /// Multiscale bases of grids, coarse and fine cells, the prolongation and the fine stiffness matrix
    Basis,
    /// Every outcome of random input, stochastic bases and mass matrices, eigenpairs of random fields
    Stochastic,
    /// All of these
    All,
}

impl Save {
    fn stages(self) -> &'static [Saved] {
        match self {
            Self::Matrices => &[Saved::Matrices],
            Self::Contact => &[Saved::Contact],
            Self::Stabilisation => &[Saved::Stabilisation],
            Self::Basis => &[Saved::Basis],
            Self::Stochastic => &[Saved::Stochastic],
            Self::All => &SAVED,
        }
    }
}

#[derive(Args)]
struct PlanArgs {
    /// Scene file (TOML)
    scene: PathBuf,
    /// Change a key of the scene, the value typed as TOML; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

impl Cli {
    /// Runs the command and returns its exit status.
    pub fn run(self) -> u8 {
        let status = match self.command {
            Command::Solve(args) => on_threads(args.threads, args.quiet, || solve_scene(&args)),
            Command::Plan(args) => show_plan(&args),
            Command::Study(args) => on_threads(args.threads, args.quiet, || study::study(&args)),
            Command::Sweep(args) => on_threads(args.threads, args.quiet, || sweep::sweep(&args)),
            Command::Compare(args) => compare::compare(&args),
            Command::Merge(args) => sweep::merge(&args),
            Command::Gallery(args) => on_threads(args.threads, args.quiet, || gallery::gallery(&args)),
            Command::Show(args) => show::show(&args),
            Command::Report(args) => report::report(&args),
            Command::New(args) => scenes::new(&args),
            Command::Scenes(args) => scenes::scenes(&args),
            Command::Schema => schema(),
            Command::Completions(args) => manual::completions(&args),
            Command::Man(args) => manual::man(&args),
        };
        status.unwrap_or_else(|Failure(message)| {
            eprintln!("{}", message.trim_end());
            WRONG
        })
    }
}

fn schema() -> Result<u8, Failure> {
    say(&serde_json::to_string_pretty(&steklov_document::schema())?);
    Ok(0)
}

fn read_scene(path: &Path, overrides: &[String]) -> Result<Document, Failure> {
    Document::read(path, overrides).map_err(|e| Failure(e.render()))
}

/// A scene that is to be solved here: unless it gives method.max_dofs(), matrices of boundary elements may take what is left of
/// the memory.
fn read_scene_within_memory(path: &Path, overrides: &[String]) -> Result<Document, Failure> {
    let mut document = read_scene(path, overrides)?;
    if document.scene.method.max_dofs.is_none() && !document.scene.is_on_grid() {
        document.scene.method.memory = available_memory_bytes();
    }
    Ok(document)
}

fn show_plan(args: &PlanArgs) -> Result<u8, Failure> {
    let document = read_scene_within_memory(&args.scene, &args.overrides)?;
    let scene = &document.scene;
    check_expect(scene).map_err(|e| Failure(document.error(e).render()))?;
    cautions(scene).iter().for_each(|text| eprintln!("warning: {text}"));
    let mut plan = plan(scene);
    if scene.method.refine != Refine::None {
        plan.modelled.push(largest_mesh(scene));
    }
    if scene.body().cells().is_some() {
        // a plan for moduli that cannot be had is none
        grid_of(scene).and_then(|grid| moduli(scene, &grid)).map_err(|e| Failure(document.error(e).render()))?;
    }
    say(&if args.json { serde_json::to_string_pretty(&plan)? } else { format!("{}\n{plan}", scene.title) });
    Ok(0)
}

fn solve_scene(args: &SolveArgs) -> Result<u8, Failure> {
    let clock = Instant::now();
    let document = read_scene_within_memory(&args.scene, &args.overrides)?;
    let scene = &document.scene;
    let out = args.out.clone().unwrap_or_else(|| {
        let mut name = args.scene.file_stem().unwrap_or(args.scene.as_os_str()).to_owned();
        name.push(".vtkhdf"); // not with_extension: that would cut "a.b" to "a"
        PathBuf::from(name)
    });
    check_output(&out, &args.scene, args.force || args.resume)?;
    check_folder("--plots", args.plots.as_deref())?;
    let view = args.view.view(args.plots.is_some())?;
    // a medium has no end
    if scene.problem.bodies.iter().all(|body| body.far.is_none()) {
        check_window(&view, scene.problem.outline.edges().iter().flat_map(Edge::extent))?;
    }
    if scene.is_on_grid() && !args.view.steps.is_empty() {
        return Err(Failure(NO_MESHES.into()));
    }
    if let Some(folder) = &args.report {
        report::check_place("--report", folder, args.force || args.resume)?;
    }
    check_expect(scene).map_err(|e| Failure(document.error(e).render()))?;
    let (plan, layout) = plan_with_mesh(scene);
    let refused =
        refused(scene, &plan.cost).or_else(|| too_large_basis(scene).filter(|_| args.saved().contains(&Saved::Basis)));
    if let Some(error) = refused {
        return Err(Failure(document.error(error).render()));
    }
    if !args.quiet {
        cautions(scene).iter().for_each(|text| eprintln!("warning: {text}"));
    }
    let interrupts = interrupts(args.quiet, STEP)?;
    let bar = Bar::new(args.quiet);
    let reading = clock.elapsed().as_secs_f64();
    let old = old_result(&out, args.resume)?;
    let (record, held) = match scene.is_on_grid() {
        true => solve_by::<OnGrid>(args, &document, (plan, None), &out, old.as_ref(), (&interrupts, &bar), reading)?,
        false => {
            let begin = (plan, layout);
            solve_by::<BoundaryElements>(args, &document, begin, &out, old.as_ref(), (&interrupts, &bar), reading)?
        }
    };
    bar.finish();
    let stored = match (record, &old) {
        (Ok(mut record), _) => {
            record.summary.seconds.total = clock.elapsed().as_secs_f64();
            record
        }
        (Err(SolveError::Interrupted), Some(old)) => unchanged(old, &out, held, args.quiet)?,
        (Err(error), _) => return Err(appeared(&out, &error).unwrap_or_else(|| explained(&document, error))),
    };
    let files = match &args.plots {
        Some(folder) => pictures(&stored, &view, &args.view.steps, folder, &out)?,
        None => Vec::new(),
    };
    let page = args.report.as_deref().map(|folder| report::written(&out, folder)).transpose()?;
    let Record { summary, plan, .. } = &stored;
    // the summary says all of this itself
    if (args.json || args.format.is_some()) && !args.quiet {
        advice(summary, plan).iter().for_each(|advice| eprintln!("{advice}"));
        if let Some(result) = &stored.stochastic {
            let texts = stochastic::shortfall(result).into_iter().chain(stochastic::overlooked(result));
            texts.for_each(|text| eprintln!("{text}"));
        }
        let crossing = summary.grid.as_ref().and_then(crossing_warning);
        crossing.iter().for_each(|text| eprintln!("warning: {text}"));
        summary.expect.iter().filter(|e| !e.holds).for_each(|e| eprintln!("{}", expectation(e)));
    }
    let kind = |f: &Path| if f.extension().is_some_and(|e| e == "csv") { "table" } else { "picture" };
    let files = files.iter().map(|f| format!("{:<11} {}", kind(f), f.display()));
    let pages = page.iter().map(|f| format!("page        {}", f.display()));
    say_result(&stored, args.json, args.format, files.chain(pages))?;
    let holds = summary.expect.iter().all(|e| e.holds);
    Ok(if summary.converged && holds { 0 } else { NOT_REACHED })
}

/// What a solve gives: a record or an error, and how many steps were held already.
type Attempt = (Result<Record, SolveError>, usize);

/// Solves by a model, and keeps what it gives in a file.
fn solve_by<M: Keep>(
    args: &SolveArgs,
    document: &Document,
    (mut plan, layout): (Plan, Option<M::Layout>),
    out: &Path,
    old: Option<&File>,
    (interrupts, bar): (&AtomicUsize, &Bar),
    reading: f64,
) -> Result<Attempt, Failure> {
    let Document { scene, source } = document;
    let stored = old.map_or(Ok(Vec::new()), |old| {
        same_scene(old, document)?;
        M::read_steps(old, scene)
    })?;
    let held = stored.len();
    let saved = args.saved();
    let saving = !saved.is_empty();
    let record = create_atomically(out, args.force || args.resume, |file| -> Result<Record, store::Unsolved> {
        let first = M::resume(scene, stored, layout)?;
        if let Some(old) = old {
            // those of the last step are made anew if they are wanted
            copy_saved(old, file, if saving { first.steps.len() } else { held })?;
        }
        let queue = store::StepQueue::<M>::new(file);
        let record = rayon::scope_fifo(|scope| {
            let put = |step: &Step<M>| {
                queue.push(step.clone());
                // the stages that are saved go into the file in between: equal content has to give equal bytes
                if saving { queue.write_next() } else { scope.spawn_fifo(|_| queue.write_next()) }
            };
            first.steps.iter().for_each(put);
            let mut run = run(scene, first, interrupts, &mut |number, event| {
                match event {
                    Event::Done { step, .. } => put(step),
                    Event::Stage(stage) => {
                        bar.show(number, &stage);
                        save_stage(file, number, &stage, &saved).map_err(store::observed)?;
                    }
                }
                Ok(())
            })?;
            plan.left_out.extend(M::lack(scene, &run).map(without_memory));
            let mut all = SavedOutcomes::new(file);
            let wanted = saved.contains(&Saved::Stochastic);
            let mut keep = |stage: OutcomeStage<'_>| match wanted {
                true => all.take(&stage).map_err(store::observed),
                false => Ok(()),
            };
            let progress = |done, count| bar.outcomes(done, count);
            let stopped = || interrupts.load(Ordering::Relaxed) > 0;
            let watch = OutcomesWatch { progress: &progress, stopped: &stopped, elsewhere: None };
            let outcomes = M::outcomes(scene, &mut run, &watch, &mut keep)?;
            Ok::<_, store::Unsolved>(Record::new(scene, plan, &run, outcomes, out, reading))
        })?;
        queue.finish()?;
        let (mut record, writing) = (record, Instant::now());
        record.summary.peak_memory_bytes = peak_memory_bytes();
        store::write(file, &record, source)?;
        if let Some(old) = old {
            copy_outcomes(old, file)?;
        }
        record.summary.seconds.write += writing.elapsed().as_secs_f64();
        Ok(record)
    });
    Ok((record.map_err(|unsolved| unsolved.0), held))
}

/// Whether a result file is of this scene: of the overrides only the tolerance and the limits may differ.
fn same_scene(old: &File, document: &Document) -> Result<(), IoError> {
    store::check_scene(old, &document.source.text, |overrides| document.differing_key(overrides))
}

/// The result file from which a run goes on, if it is to and there is one.
fn old_result(out: &Path, resume: bool) -> Result<Option<File>, Failure> {
    if resume && out.symlink_metadata().is_ok() { Ok(Some(open(out)?)) } else { Ok(None) }
}

/// The result of a run that was stopped before the last stored step was solved again: what the file holds.
fn unchanged(old: &File, out: &Path, steps: usize, quiet: bool) -> Result<Record, Failure> {
    if !quiet {
        eprintln!("{} is unchanged and holds {steps} step(s): --resume goes on from them", out.display());
    }
    let mut stored = store::read(old)?;
    stored.summary.file = out.display().to_string();
    (stored.summary.converged, stored.summary.reason) = (false, Reason::Interrupted.word().to_owned());
    Ok(stored)
}

/// Counts the user's wishes to stop; `what` is finished after the first.
fn interrupts(quiet: bool, what: &'static str) -> Result<Arc<AtomicUsize>, Failure> {
    let interrupts = Arc::new(AtomicUsize::new(0));
    let presses = Arc::clone(&interrupts);
    ctrlc::set_handler(move || {
        let before = presses.fetch_add(1, Ordering::Relaxed);
        if !quiet {
            match before {
                0 => eprintln!("finishing {what}; again to stop at once"),
                _ => eprintln!("stopping"),
            }
        }
    })?;
    Ok(interrupts)
}

/// What a run finishes before it stops.
const STEP: &str = "this step";

/// An error of the solver, told with the text of the scene that causes it.
fn explained(document: &Document, error: SolveError) -> Failure {
    match explain(&document.scene, error) {
        Ok(error) => Failure(document.error(error).render()),
        Err(error) => error.into(),
    }
}

/// Stack of each thread, as large as that of a process usually is.
const STACK: usize = 8 << 20;

/// Most threads for each processor: more of them wait for each other for minutes.
const CROWD: usize = 4;

/// Does work on one of so many threads (as many as there are processors): from outside of them, every parallel loop would
/// have to wake two.
fn on_threads(
    threads: Option<u16>,
    quiet: bool,
    work: impl FnOnce() -> Result<u8, Failure> + Send,
) -> Result<u8, Failure> {
    let wanted = threads.map_or(0, usize::from);
    let processors = std::thread::available_parallelism().map_or(1, NonZero::get);
    let threads = wanted.min(CROWD * processors);
    if threads < wanted && !quiet {
        eprintln!("--threads {wanted} is more than {CROWD} for each of {processors} processor(s): {threads} are used");
    }
    // the same bits for any number of threads, in products without a parallelism of their own too
    faer::set_global_parallelism(faer::Par::rayon(PARTS));
    rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK).build_global()?;
    rayon::scope(|_| work())
}

fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "result".into(), |s| s.to_string_lossy().into_owned())
}

const NO_MESHES: &str = "error: --steps draws meshes of boundary elements, and this is on a grid: leave it out";

/// Draws a result that is in a file, and the meshes of some of its steps, into a folder.
fn pictures(
    stored: &Record,
    view: &View,
    steps: &[usize],
    folder: &Path,
    file: &Path,
) -> Result<Vec<PathBuf>, Failure> {
    let mut files = steklov_figures::pictures(stored, view, folder, &stem(file))?;
    if steps.is_empty() {
        return Ok(files);
    }
    let meshes = steklov_result::steps::meshes(&open(file)?)?;
    let Some(last) = meshes.len().checked_sub(1) else {
        return Err(Failure(NO_MESHES.into()));
    };
    if let Some(step) = steps.iter().find(|step| **step > last) {
        let file = file.display();
        return Err(Failure(format!("error: {file} has steps 0 to {last}, and --steps asks for {step}")));
    }
    let of_step = |&step: &usize| StepMesh { step, dofs: meshes[step].0, mesh: &meshes[step].1 };
    let chosen: Vec<StepMesh<'_>> = steps.iter().map(of_step).collect();
    files.extend(steklov_figures::mesh_pictures(&stored.summary.title, &chosen, folder, &stem(file))?);
    Ok(files)
}
