//! `study --what multiscale`.

use std::sync::atomic::Ordering;

use steklov_problem::{DataError, DataErrorKind, grid_of};
use steklov_study::multiscale::{
    BASES, MOST_DOFS, MultiscaleStudy, coarse_cells, contrast, convergence, csv, fine_grid, json, laminates, pictures,
    text, write,
};

use super::super::{Failure, NOT_REACHED, interrupts, read_scene};
use super::{StudyArgs, Watch, folder, store, tell_results, unreferenced};

/// Tells what multiscale elements are worth.
pub(super) fn multiscale(args: &StudyArgs) -> Result<u8, Failure> {
    let document = read_scene(&args.scene, &args.overrides)?;
    let scene = &document.scene;
    let refused = |error: DataError| Failure(document.error(error).render());
    if scene.body().grid.is_none() {
        let message = "the study is about coarse cells on a fine grid, and the scene has no [grid]".to_owned();
        let help =
            "add [grid] coarse = [12, 2], fine = [16, 16] with the numbers of the body, or study --what convergence";
        return Err(refused(DataError::at(DataErrorKind::Unsupported, &[vec!["body"]], message, help)));
    }
    let sizes = coarse_cells(scene).map_err(refused)?;
    let dofs = grid_of(scene).map_err(refused)?.dofs();
    if dofs > scene.method.max_dofs.max(MOST_DOFS) {
        let message = format!(
            "the fine grid has {dofs} dofs, and the study solves all of them at once: {MOST_DOFS} at most, or method.max_dofs"
        );
        let help = "take fewer fine cells, or raise method.max_dofs as far as the memory allows";
        return Err(refused(DataError::at(DataErrorKind::Value, &[vec!["grid", "fine"]], message, help)));
    }
    let out = folder(args, &document, "multiscale")?;
    let repeat = usize::from(args.repeat);
    let stop = interrupts(args.quiet)?;
    let watch = Watch::new(args.quiet, 4 + BASES.len());
    let tell = &mut |what: &str, detail: &str| watch.show(what, detail);
    let fine = fine_grid(scene, repeat, &stop, tell).map_err(|error| unreferenced(&document, error))?;
    let convergence = convergence(scene, &fine, &sizes, repeat, &stop, tell);
    let laminates = laminates(&stop, tell);
    let contrast = contrast(&stop, tell);
    watch.show("files", "");
    let interrupted = stop.load(Ordering::Relaxed) > 0;
    let study = MultiscaleStudy {
        scene,
        source: &document.source,
        fine_grid: &fine,
        convergence: &convergence,
        laminates: &laminates,
        contrast: &contrast,
        repeat,
        interrupted,
    };
    let files = store(&out, "multiscale", &|file| write(file, &study), &csv(&study), &|out| pictures(&study, out))?;
    watch.finish();
    tell_results(args, &out, &files, || json(&study), || text(&study))?;
    Ok(if study.complete() { 0 } else { NOT_REACHED })
}
