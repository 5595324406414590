//! `study --what stability`.

use std::sync::atomic::Ordering;

use steklov_study::Watch;
use steklov_study::stability::{
    POISSON, Stability, incompressible, pictures, read_beside, report, settings, single_layer, stabilisation,
};

use super::super::{Failure, interrupts};
use super::{Bar, StudyArgs, boundary_only, document, finish, folder, unreferenced};

/// Looks for trouble where such methods may have it.
pub(super) fn stability(args: &StudyArgs) -> Result<u8, Failure> {
    let document = document(args, |method| settings(method, &args.overrides))?;
    let scene = &document.scene;
    boundary_only(scene)?;
    let beside = args.beside.as_deref().map_or(Ok(Vec::new()), read_beside)?;
    let out = folder(args, &document, "stability")?;
    let stop = interrupts(args.quiet)?;
    let bar = Bar::new(args.quiet, POISSON.len() + 3);
    let tell = &mut |what: &str, detail: &str| bar.show(what, detail);
    let watch = &mut Watch::new(&stop, tell);
    let incompressible = incompressible(scene, watch).map_err(|error| unreferenced(&document, error))?;
    let single_layer = single_layer(scene, watch)?;
    let stabilisation = stabilisation(scene, watch);
    let interrupted = stop.load(Ordering::Relaxed) > 0;
    let study = Stability {
        scene,
        source: &document.source,
        incompressible: &incompressible,
        beside: &beside,
        single_layer: &single_layer,
        stabilisation: stabilisation.as_ref(),
        interrupted,
    };
    finish(args, &out, "stability", &bar, &report(&study), &|out| pictures(&study, out))
}
