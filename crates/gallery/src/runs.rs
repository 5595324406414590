//! The runs of the command for the figures, each made once.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use serde_json::{Value, json};
use steklov_document::Document;
use steklov_model::error::SolveError;
use steklov_model::grid::OnGrid;
use steklov_model::run::adaptive_loop::run;
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::stochastic::OutcomesWatch;
use steklov_model::summary::available_memory_bytes;
use steklov_picture::Picture;
use steklov_plan::plan;
use steklov_problem::Scene;
use steklov_result::keep::Keep;
use steklov_result::record::Record;
use steklov_study::convergence::{self, Strategy};
use steklov_study::{Draw, Options, Report, StudyKind, Watch};

/// The scenes by name.
const SCENES: [(&str, &str); 6] = [
    ("15-block-on-floor", include_str!("../scenes/15-block-on-floor.toml")),
    ("17-wedge-gap", include_str!("../scenes/17-wedge-gap.toml")),
    ("29-random-modulus", include_str!("../scenes/29-random-modulus.toml")),
    ("32-bar-on-a-grid", include_str!("../scenes/32-bar-on-a-grid.toml")),
    ("33-bar-of-random-cells", include_str!("../scenes/33-bar-of-random-cells.toml")),
    ("42-stiff-inclusion-of-random-cells", include_str!("../scenes/42-stiff-inclusion-of-random-cells.toml")),
];

/// The task of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Task {
    /// `solve`.
    Solve,
    /// `study` of strategies, each with each of these multipliers; without multipliers, with the scene's own.
    Compare(&'static [&'static str], &'static [&'static str]),
    /// `study --what`.
    Study(StudyKind),
}

/// A run of the command.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Run {
    /// Its name among the runs.
    pub name: &'static str,
    /// Its description in the progress.
    pub what: &'static str,
    scene: &'static str,
    task: Task,
    set: &'static [&'static str],
}

/// The results of a run.
#[derive(Default)]
pub(crate) struct Made {
    /// The JSON object of the command.
    pub json: Value,
    /// The record of a solve.
    pub record: Option<Record>,
    /// The strategies of a comparison.
    pub strategies: Vec<Strategy>,
    /// The pictures of a study by the names of their files.
    pub pictures: BTreeMap<String, Picture>,
    /// Wall seconds.
    pub seconds: f64,
}

const fn of(
    name: &'static str,
    what: &'static str,
    scene: &'static str,
    task: Task,
    set: &'static [&'static str],
) -> Run {
    Run { name, what, scene, task, set }
}

const BLOCK: &str = "15-block-on-floor";
const WEDGE: &str = "17-wedge-gap";
const PRESSED: &str = "29-random-modulus";
const BAR: &str = "32-bar-on-a-grid";
const CELLS: &str = "33-bar-of-random-cells";
const MEDIUM: &str = "42-stiff-inclusion-of-random-cells";
const RESIDUAL: &str = "method.indicator=\"residual\"";
const TO_600: &str = "method.max_dofs=600";
const TO_520: &str = "method.max_dofs=520";
const UNIFORM: Task = Task::Compare(&["uniform-h"], &[]);
const BOTH: &[&str] = &["biorthogonal", "stabilised"];
const NEWTON: &[&str] = &["method.solver=\"newton\"", "method.refine=\"uniform-h\"", TO_520];

/// All runs, in the order of the figures.
pub(crate) const RUNS: [Run; 31] = [
    of("block", "block on a floor", BLOCK, Task::Solve, &[]),
    of(
        "block-strategies",
        "block on a floor, strategies of refinement",
        BLOCK,
        Task::Compare(&["uniform-h", "h", "hp-decay", "hp"], &[]),
        &[TO_600],
    ),
    of(
        "block-residual",
        "block on a floor, residual indicators",
        BLOCK,
        Task::Compare(&["uniform-h", "h", "hp-decay"], &[]),
        &[RESIDUAL, TO_600],
    ),
    of("block-newton", "block on a floor, Newton's method", BLOCK, Task::Solve, NEWTON),
    of("wedge-newton", "block on a wedge, Newton's method", WEDGE, Task::Solve, NEWTON),
    of("wedge", "block on a wedge", WEDGE, Task::Solve, &[]),
    of(
        "wedge-multipliers",
        "block on a wedge, both multipliers",
        WEDGE,
        Task::Compare(&["uniform-h", "hp"], BOTH),
        &[TO_600],
    ),
    of(
        "wedge-gamma",
        "block on a wedge, a smaller stabilisation",
        WEDGE,
        UNIFORM,
        &["method.multiplier=\"stabilised\"", "method.gamma=5e-4", TO_600],
    ),
    of(
        "wedge-residual",
        "block on a wedge, residual indicators",
        WEDGE,
        Task::Compare(&["uniform-h"], BOTH),
        &[RESIDUAL, TO_520],
    ),
    of("inf-sup", "inf-sup constants", WEDGE, Task::Study(StudyKind::InfSup), &[]),
    of("stability", "stability", WEDGE, Task::Study(StudyKind::Stability), &[]),
    of("block-solvers", "block on a floor, contact solvers", BLOCK, Task::Study(StudyKind::Solvers), &[]),
    of("solvers", "block on a wedge, contact solvers", WEDGE, Task::Study(StudyKind::Solvers), &[]),
    of("pressed", "pressed block", PRESSED, Task::Solve, &[]),
    of("pressed-uzawa", "pressed block, Uzawa", PRESSED, Task::Solve, &["method.solver=\"uzawa\""]),
    of("chance", "pressed block, rules in chance", PRESSED, Task::Study(StudyKind::Stochastic), &[]),
    of("pressed-residual", "pressed block, residual indicators", PRESSED, UNIFORM, &[RESIDUAL, TO_520]),
    of("bar-12", "bar, 12 by 2 coarse cells", BAR, Task::Solve, &["grid.coarse=[12,2]", "grid.fine=[16,16]"]),
    of("bar-24", "bar, 24 by 4 coarse cells", BAR, Task::Solve, &["grid.coarse=[24,4]", "grid.fine=[8,8]"]),
    of("bar-48", "bar, 48 by 8 coarse cells", BAR, Task::Solve, &["grid.coarse=[48,8]", "grid.fine=[4,4]"]),
    of("bar-96", "bar, 96 by 16 coarse cells", BAR, Task::Solve, &["grid.coarse=[96,16]", "grid.fine=[2,2]"]),
    of(
        "bar-fem",
        "bar, finite elements",
        BAR,
        Task::Solve,
        &["grid.coarse=[96,16]", "grid.fine=[2,2]", "method.model=\"fem\""],
    ),
    of(
        "cells-12",
        "random cells, 12 by 2 coarse cells",
        CELLS,
        Task::Solve,
        &["grid.coarse=[12,2]", "grid.fine=[16,16]"],
    ),
    of(
        "cells-24",
        "random cells, 24 by 4 coarse cells",
        CELLS,
        Task::Solve,
        &["grid.coarse=[24,4]", "grid.fine=[8,8]"],
    ),
    of(
        "cells-48",
        "random cells, 48 by 8 coarse cells",
        CELLS,
        Task::Solve,
        &["grid.coarse=[48,8]", "grid.fine=[4,4]"],
    ),
    of(
        "cells-96",
        "random cells, 96 by 16 coarse cells",
        CELLS,
        Task::Solve,
        &["grid.coarse=[96,16]", "grid.fine=[2,2]"],
    ),
    of(
        "cells-fem",
        "random cells, finite elements",
        CELLS,
        Task::Solve,
        &["grid.coarse=[96,16]", "grid.fine=[2,2]", "method.model=\"fem\""],
    ),
    of(
        "cells-fine",
        "random cells, 790,000 unknowns",
        CELLS,
        Task::Solve,
        &["method.model=\"fem\"", "grid.coarse=[192,32]", "grid.fine=[8,8]", "method.max_dofs=2000000"],
    ),
    of("bases", "multiscale bases, resonance, contrast", CELLS, Task::Study(StudyKind::Multiscale), &[]),
    of("inclusion", "stiff inclusion in a medium", MEDIUM, Task::Solve, &[]),
    of("coupling", "body and medium", MEDIUM, Task::Study(StudyKind::Coupling), &[]),
];

impl Run {
    /// The run of a name.
    pub(crate) fn named(name: &str) -> Option<&'static Self> {
        RUNS.iter().find(|run| run.name == name)
    }

    /// The command that does the same by hand, in a folder with the scenes, with `range` as the ends of the colours.
    pub(crate) fn command(&self, range: Option<[f64; 2]>) -> String {
        let scene = format!("scenes/{}.toml", self.scene);
        let list = |key: &str, names: &[&str]| match names.is_empty() {
            true => String::new(),
            false => format!(" {key} {}", names.join(",")),
        };
        let mut command = match self.task {
            Task::Solve => {
                let range = range.map_or(String::new(), |[low, high]| format!(" --range {low}:{high}"));
                let cells = if [BAR, CELLS, MEDIUM].contains(&self.scene) { " --hide-cells" } else { "" };
                format!("steklov solve {scene} --plots .{range}{cells}")
            }
            Task::Compare(strategies, multipliers) => {
                let what = format!("{}{}", list("--strategies", strategies), list("--multipliers", multipliers));
                format!("steklov study {scene}{what} --repeat 1")
            }
            Task::Study(kind) => format!("steklov study {scene} --what {} --repeat 1", kind.word()),
        };
        for set in self.set {
            command += &format!(" --set '{set}'");
        }
        command
    }

    /// Makes the run; the error says in words why it failed.
    pub(crate) fn make(&self, watch: &mut Watch<'_>) -> Result<Made, String> {
        let clock = Instant::now();
        let (_, text) = SCENES.iter().find(|(name, _)| *name == self.scene).ok_or("there is no such scene")?;
        let set: Vec<String> = self.set.iter().map(|&set| set.to_owned()).collect();
        let mut document = Document::parse(text, self.scene, &set).map_err(|e| e.render())?;
        let made = match self.task {
            Task::Solve if document.scene.is_on_grid() => solve::<OnGrid>(&document.scene, watch.interrupts()),
            Task::Solve => solve::<BoundaryElements>(&document.scene, watch.interrupts()),
            Task::Compare(strategies, multipliers) => {
                StudyKind::Convergence.prepare(&mut document).map_err(|e| e.message)?;
                compare(&document, strategies, multipliers, watch)
            }
            Task::Study(kind) => {
                kind.prepare(&mut document).map_err(|e| e.message)?;
                study(&document, kind, watch)
            }
        };
        made.map(|made| Made { seconds: clock.elapsed().as_secs_f64(), ..made })
    }
}

fn solve<M: Keep>(scene: &Scene, interrupts: &AtomicUsize) -> Result<Made, String> {
    let told = |e: SolveError| e.to_string();
    let plan = plan(scene);
    if let Some(left) = available_memory_bytes().filter(|left| plan.cost.memory_bytes > *left) {
        let [needed, left] = [plan.cost.memory_bytes, left].map(|bytes| bytes as f64 / f64::from(1 << 30));
        return Err(format!("it needs about {needed:.1} GiB of memory, and {left:.1} GiB are left"));
    }
    let first = M::resume(scene, Vec::new(), None).map_err(told)?;
    let mut run = run(scene, first, interrupts, &mut |_, _| Ok(())).map_err(told)?;
    let stopped = || interrupts.load(Ordering::Relaxed) > 0;
    let watch = OutcomesWatch { stopped: &stopped, ..OutcomesWatch::NONE };
    let outcomes = M::outcomes(scene, &mut run, &watch, &mut |_| Ok(())).map_err(told)?;
    let record = Record::new(scene, plan, &run, outcomes, Path::new(""), 0.0);
    let mut json = serde_json::to_value(&record.summary).map_err(|e| e.to_string())?;
    let steps = run.progress.steps.iter().map(|step| json!({ "dofs": step.dofs, "history": step.history }));
    json["histories"] = steps.collect();
    Ok(Made { json, record: Some(record), ..Made::default() })
}

fn compare(
    document: &Document,
    strategies: &[&str],
    multipliers: &[&str],
    watch: &mut Watch<'_>,
) -> Result<Made, String> {
    let Document { scene, source } = document;
    let all = convergence::strategies(scene, strategies, multipliers);
    let study = convergence::study(scene, source, &all, 1, watch).map_err(|e| e.to_string())?;
    let json = finished(&convergence::report(&study))?;
    Ok(Made { json, strategies: study.strategies, ..Made::default() })
}

fn study(document: &Document, kind: StudyKind, watch: &mut Watch<'_>) -> Result<Made, String> {
    let options = Options { repeat: 1, ..Options::default() };
    let told = |report: &Report<'_>, pictures: Draw<'_>| {
        let json = finished(report)?;
        let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
        let files = pictures(folder.path()).map_err(|e| e.to_string())?;
        Ok(Made { json, pictures: read(&files)?, ..Made::default() })
    };
    kind.carry_out(document, options, watch, told).map_err(|e| e.to_string())?
}

/// The JSON object of a study that nobody stopped.
fn finished(report: &Report<'_>) -> Result<Value, String> {
    if report.complete { Ok(report.json()) } else { Err("it was interrupted, or a part of it failed".into()) }
}

/// Pictures by the names of their files.
fn read(files: &[PathBuf]) -> Result<BTreeMap<String, Picture>, String> {
    let bytes = |file: &Path| std::fs::read(file).map_err(|e| e.to_string());
    let picture = |svg: &PathBuf| {
        let name = svg.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let text = String::from_utf8_lossy(&bytes(svg)?).into_owned();
        Ok((name, Picture { svg: text, png: bytes(&svg.with_extension("png"))? }))
    };
    files.iter().filter(|file| file.extension().is_some_and(|ending| ending == "svg")).map(picture).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A package holds its own copies.
    #[test]
    fn the_scenes_are_those_of_the_gallery() {
        for (name, text) in SCENES {
            let path = format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text, "copy {path} into crates/gallery/scenes");
        }
    }

    #[test]
    fn every_run_can_be_read_and_has_a_command() {
        for run in &RUNS {
            let (_, text) = SCENES.iter().find(|(name, _)| *name == run.scene).unwrap();
            let set: Vec<String> = run.set.iter().map(|&set| set.to_owned()).collect();
            Document::parse(text, run.scene, &set).unwrap_or_else(|e| panic!("{}: {}", run.name, e.render()));
            assert!(run.command(None).contains(run.scene), "{}", run.command(None));
        }
        assert_eq!(
            Run::named("block-residual").unwrap().command(Some([0.0, 1.0])),
            "steklov study scenes/15-block-on-floor.toml --strategies uniform-h,h,hp-decay --repeat 1 \
             --set 'method.indicator=\"residual\"' --set 'method.max_dofs=600'"
        );
    }
}
