//! `study --what stability`.

use std::sync::atomic::Ordering;

use steklov_study::stability::{
    POISSON, Stability, csv, incompressible, json, pictures, read_beside, settings, single_layer, stabilisation, text,
    write,
};

use super::super::{Failure, NOT_REACHED, interrupts};
use super::{StudyArgs, Watch, boundary_only, document, folder, store, tell_results, unreferenced};

/// Looks for trouble where such methods may have it.
pub(super) fn stability(args: &StudyArgs) -> Result<u8, Failure> {
    let document = document(args, |method| settings(method, &args.overrides))?;
    let scene = &document.scene;
    boundary_only(scene)?;
    let beside = args.beside.as_deref().map_or(Ok(Vec::new()), read_beside)?;
    let out = folder(args, &document, "stability")?;
    let stop = interrupts(args.quiet)?;
    let watch = Watch::new(args.quiet, POISSON.len() + 3);
    let tell = &mut |what: &str, detail: &str| watch.show(what, detail);
    let incompressible = incompressible(scene, &stop, tell).map_err(|error| unreferenced(&document, error))?;
    let single_layer = single_layer(scene, &stop, tell)?;
    let stabilisation = stabilisation(scene, &stop, tell);
    watch.show("files", "");
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
    let files = store(&out, "stability", &|file| write(file, &study), &csv(&study), &|out| pictures(&study, out))?;
    watch.finish();
    tell_results(args, &out, &files, || json(&study), || text(&study))?;
    Ok(if study.complete() { 0 } else { NOT_REACHED })
}
