//! Scenes on grids: the run, and what is told of it.

use std::path::Path;
use std::sync::atomic::AtomicUsize;
use std::time::Instant;

use steklov_io::{File, create_atomically};
use steklov_model::grid::{BLIND, FAILING, GridProgress, run_grid};
use steklov_model::summary::{GridSummary, peak_memory_bytes};
use steklov_plan::Plan;
use steklov_result::record::Record;
use steklov_result::store;
use steklov_scene::Document;

use super::bar::Bar;
use super::{Attempt, Failure, SolveArgs, same_scene};

/// Solves by finite elements on a grid.
pub(super) fn solve_on_grid(
    args: &SolveArgs,
    document: &Document,
    plan: Plan,
    out: &Path,
    old: Option<&File>,
    (interrupts, bar): (&AtomicUsize, &Bar),
    reading: f64,
) -> Result<Attempt, Failure> {
    let Document { scene, source } = document;
    let stored = old.map_or(Ok(Vec::new()), |old| {
        same_scene(old, document)?;
        store::read_grid_steps(old, scene)
    })?;
    let held = stored.len();
    let record = create_atomically(out, args.force || args.resume, |file| -> Result<Record, store::Unsolved> {
        let progress = GridProgress::new(scene, stored)?;
        if let Some(old) = old {
            store::copy_matrices(old, file, if args.save.is_some() { progress.steps.len() } else { held })?;
        }
        let run = run_grid(scene, progress, interrupts, &mut |number, stage| {
            bar.show(number, &stage);
            if args.save.is_some() { store::save_stage(file, number, &stage).map_err(store::observed) } else { Ok(()) }
        })?;
        let (mut record, writing) = (Record::of_grid(scene, plan, run, out, reading), Instant::now());
        record.summary.peak_memory_bytes = peak_memory_bytes();
        store::write(file, &record, source)?;
        record.summary.seconds.write += writing.elapsed().as_secs_f64();
        Ok(record)
    });
    Ok((record.map_err(|unsolved| unsolved.0), held))
}

/// What is told of the grid of finite elements.
pub(super) fn grid_lines(grid: &GridSummary) -> Vec<String> {
    let mut lines = Vec::new();
    let parts = [
        (grid.estimate_multiscale, "by the coarse cells"),
        (grid.estimate_fine_grid, "by the fine grid itself"),
        (grid.estimate_medium, "by the boundary elements around it"),
    ];
    let parts: Vec<String> =
        parts.into_iter().filter_map(|(part, of)| part.map(|part| format!("{part:.3e} {of}"))).collect();
    if parts.len() > 1 {
        lines.push(format!("            of it {}", parts.join(", ")));
    }
    let [nx, ny] = grid.cells;
    lines.push(match (&grid.basis, grid.coarse_cells, grid.patterns) {
        (Some(basis), Some(coarse), Some(patterns)) => format!(
            "grid        {nx} by {ny} fine cells, {} unknowns; {coarse} coarse cells, basis {basis}, {patterns} local problem(s)",
            grid.fine_dofs
        ),
        _ => format!("grid        {nx} by {ny} cells"),
    });
    lines.extend(grid.boundary_elements.map(|n| format!("            {n} boundary elements of the medium around it")));
    lines.push(format!("            contrast of the moduli {:.4}", grid.contrast));
    lines.extend(crossing_warning(grid).map(|warning| format!("warning     {warning}")));
    lines
}

/// Where multiscale bases fail.
pub(super) fn crossing_warning(grid: &GridSummary) -> Option<String> {
    let (contrast, [x, y], share) = (grid.crossing_contrast?, grid.crossing_at?, grid.crossing_share?);
    (contrast >= FAILING).then(|| {
        format!(
            "moduli differ by {contrast:.1e} along a coarse edge at ({x}, {y}), and by 100 or more on {:.0} % of them: \
             multiscale elements fail there{}; align the coarse cells with the inclusions, or use model = \"fem\"",
            100.0 * share,
            if contrast >= BLIND { ", and their estimate is too small" } else { "" }
        )
    })
}
