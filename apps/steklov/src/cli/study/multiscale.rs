//! `study --what multiscale`.

use std::sync::atomic::Ordering;

use steklov_problem::{DataError, DataErrorKind, grid_of};
use steklov_study::Watch;
use steklov_study::multiscale::{
    BASES, MOST_DOFS, MultiscaleStudy, coarse_cells, contrast, convergence, fine_grid, laminates, pictures, report,
};

use super::super::{Failure, interrupts, read_scene};
use super::{Bar, StudyArgs, finish, folder, unreferenced};

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
    if dofs > scene.method.max_dofs().max(MOST_DOFS) {
        let message = format!(
            "the fine grid has {dofs} dofs, and the study solves all of them at once: {MOST_DOFS} at most, or method.max_dofs"
        );
        let help = "take fewer fine cells, or raise method.max_dofs as far as the memory allows";
        return Err(refused(DataError::at(DataErrorKind::Value, &[vec!["grid", "fine"]], message, help)));
    }
    let out = folder(args, &document, "multiscale")?;
    let repeat = usize::from(args.repeat);
    let stop = interrupts(args.quiet)?;
    let bar = Bar::new(args.quiet, 4 + BASES.len());
    let tell = &mut |what: &str, detail: &str| bar.show(what, detail);
    let watch = &mut Watch::new(&stop, tell);
    let fine = fine_grid(scene, repeat, watch).map_err(|error| unreferenced(&document, error))?;
    let convergence = convergence(scene, &fine, &sizes, repeat, watch);
    let laminates = laminates(watch);
    let contrast = contrast(watch);
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
    finish(args, &out, "multiscale", &bar, &report(&study), &|out| pictures(&study, out))
}
