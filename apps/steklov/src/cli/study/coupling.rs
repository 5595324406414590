//! `study --what coupling`.

use std::sync::atomic::Ordering;

use steklov_problem::DataError;
use steklov_study::coupling::{
    CouplingStudy, conditioning, convergence, costs, csv, effectivity, json, largest, levels, pairs, pictures,
    settings, text, write, wrongs,
};

use super::super::{Failure, NOT_REACHED, interrupts};
use super::{StudyArgs, Watch, document, folder, store, tell_results};

/// Most unknowns on the boundary of grids: for errors, for eigenvalues, for indicators.
const TRACE: [usize; 3] = [1100, 560, 280];

/// Tells what the coupling of a body with a medium around it is worth.
pub(super) fn coupling(args: &StudyArgs) -> Result<u8, Failure> {
    let document = document(args, |method| settings(method, &args.overrides))?;
    let scene = &document.scene;
    let refused = |error: DataError| Failure(document.error(error).render());
    let pairs = pairs(scene).map_err(refused)?;
    let most = scene.method.max_dofs;
    let at_most = |trace: usize| levels(scene, most, trace).map_err(refused);
    let (fine, middle, coarse) = (at_most(TRACE[0])?, at_most(TRACE[1])?, at_most(TRACE[2])?);
    let mut all = levels(scene, most, usize::MAX).map_err(refused)?;
    let dofs = all.last().map_or(0, |level| level.grid.dofs());
    all.extend(largest(scene, most, dofs).map_err(refused)?);
    let out = folder(args, &document, "coupling")?;
    let repeat = usize::from(args.repeat);
    let stop = interrupts(args.quiet)?;
    let watch = Watch::new(args.quiet, pairs.len() + 5);
    let tell = &mut |what: &str, detail: &str| watch.show(what, detail);
    let (polygon, own) = (&scene.body().outline, &pairs[pairs.len() - 1]);
    let convergence = convergence(polygon, &pairs, &fine, repeat, &stop, tell);
    let effectivity = effectivity(polygon, &pairs, &coarse, &stop, tell);
    let costs = costs(polygon, own, &all, repeat, &stop, tell);
    let conditioning = conditioning(polygon, &pairs, &middle, &stop, tell);
    let wrongs = wrongs(polygon, &pairs[0], &middle, &stop, tell);
    watch.show("files", "");
    let interrupted = stop.load(Ordering::Relaxed) > 0;
    let study = CouplingStudy {
        scene,
        source: &document.source,
        pairs: &pairs,
        convergence: &convergence,
        effectivity: &effectivity,
        costs: &costs,
        conditioning: &conditioning,
        wrongs: &wrongs,
        repeat,
        interrupted,
    };
    let files = store(&out, "coupling", &|file| write(file, &study), &csv(&study), &|out| pictures(&study, out))?;
    watch.finish();
    tell_results(args, &out, &files, || json(&study), || text(&study))?;
    Ok(if study.complete() { 0 } else { NOT_REACHED })
}
