//! `study --what coupling`.

use std::sync::atomic::Ordering;

use steklov_problem::DataError;
use steklov_study::Watch;
use steklov_study::coupling::{
    CouplingStudy, conditioning, convergence, costs, effectivity, largest, levels, pairs, pictures, report, settings,
    wrongs,
};

use super::super::{Failure, interrupts};
use super::{Bar, StudyArgs, document, finish, folder};

/// Most unknowns on the boundary of grids: for errors, for eigenvalues, for indicators.
const TRACE: [usize; 3] = [1100, 560, 280];

/// Tells what the coupling of a body with a medium around it is worth.
pub(super) fn coupling(args: &StudyArgs) -> Result<u8, Failure> {
    let document = document(args, |method| settings(method, &args.overrides))?;
    let scene = &document.scene;
    let refused = |error: DataError| Failure(document.error(error).render());
    let pairs = pairs(scene).map_err(refused)?;
    let most = scene.method.max_dofs();
    let at_most = |trace: usize| levels(scene, most, trace).map_err(refused);
    let (fine, middle, coarse) = (at_most(TRACE[0])?, at_most(TRACE[1])?, at_most(TRACE[2])?);
    let mut all = levels(scene, most, usize::MAX).map_err(refused)?;
    let dofs = all.last().map_or(0, |level| level.grid.dofs());
    all.extend(largest(scene, most, dofs).map_err(refused)?);
    let out = folder(args, &document, "coupling")?;
    let repeat = usize::from(args.repeat);
    let stop = interrupts(args.quiet)?;
    let bar = Bar::new(args.quiet, pairs.len() + 5);
    let tell = &mut |what: &str, detail: &str| bar.show(what, detail);
    let watch = &mut Watch::new(&stop, tell);
    let (polygon, own) = (&scene.problem.outline, &pairs[pairs.len() - 1]);
    let convergence = convergence(polygon, &pairs, &fine, repeat, watch);
    let effectivity = effectivity(polygon, &pairs, &coarse, watch);
    let costs = costs(polygon, own, &all, repeat, watch);
    let conditioning = conditioning(polygon, &pairs, &middle, watch);
    let wrongs = wrongs(polygon, &pairs[0], &middle, watch);
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
    finish(args, &out, "coupling", &bar, &report(&study), &|out| pictures(&study, out))
}
